"""Where the work of a history goes: the energy of the foundation, and what friction dissipates."""

from __future__ import annotations

import numpy as np

from ..contact.boundary import ContactBoundary
from ..contracts import Array

NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)


def FoundationEnergy(contact: ContactBoundary, displacement: Array) -> float:
    """int_GammaC int_0^r p_n [stress length^d]; exact for p_n = k r^m with m a multiple of 1/2 up to 18."""
    density = _Stored(contact, contact.Penetration(displacement))
    if np.any(contact.tension):
        density -= _Stored(contact, np.zeros_like(density))
    return float(contact.weights @ density)


def _Stored(contact: ContactBoundary, r: Array) -> Array:
    """int p_n from where bonds have opened to r, (n,), of foundations and joints without a bond from 0."""
    deep = np.maximum(r + contact.depth, 0)
    # With the depth r x^2 roots of r become polynomials of x.
    density = np.zeros_like(deep)
    for x, weight in zip((NODES + 1) / 2, WEIGHTS / 2):
        density += weight * 2 * x * deep * (contact.Pressure(deep * x ** 2 - contact.depth) + contact.tension)
    return density - contact.tension * (r + contact.depth)


def Dissipation(contact: ContactBoundary, displacement: Array, traction: Array) -> float:
    """-int_GammaC sigma_t.(u_t since the origin of slip), what friction takes in an increment [stress length^d]."""
    slip = contact.Tangential(contact.SinceOrigin(displacement))
    return float(contact.weights @ np.sum(contact.Tangential(traction) * slip, axis=1))
