"""How stiff body and foundation are at a point of Gamma_C."""

from __future__ import annotations

import numpy as np

from ..contracts import Array, LinearProblem
from .graph import GraphPoint

CAP = 100       # largest stiffness of the foundation that goes into a matrix, in units of the body's at the scale of a facet


def BodyStiffness(disc: LinearProblem) -> Array:
    """gamma (n,) [stress/length]: what the body opposes to a traction on one facet of diameter h, 2 mu k/h."""
    contact = disc.contact
    return 2 * disc.order * contact.shear / contact.measures ** (1 / (contact.dim - 1))


def LawStiffness(point: GraphPoint, scale: Array, normals: Array, *, sticking: float | Array = CAP) -> Array:
    """D (n, d, d) [stress/length]: the slope dt/du of the law at points of its graph, between 0 and CAP gamma.

    Without the coupling of friction to the penetration, which is not symmetric.
    sticking : largest tangential stiffness, that of stick, in units of gamma, a number or (n, 1)
    """
    normal = normals[:, :, None] * normals[:, None, :]
    tangential = np.eye(normals.shape[1]) - normal
    share = np.clip(np.einsum("ni,nij,nj->n", normals, point.derivative, normals), 0, 1)
    slope = tangential @ point.derivative @ tangential
    shares, vectors = np.linalg.eigh((slope + np.swapaxes(slope, 1, 2)) / 2)
    shares = np.clip(shares, 0, 1)      # dt/dq = D/(gamma + D); slip weakening has negative slopes
    stiffness = scale[:, None] * _Capped(shares, sticking)
    along = (vectors * stiffness[:, None, :]) @ np.swapaxes(vectors, 1, 2)
    return (scale * _Capped(share, CAP))[:, None, None] * normal + along


def _Capped(share: Array, cap: float | Array) -> Array:
    """D/gamma of a share dt/dq = D/(gamma + D), at most `cap`."""
    return share / (1 - share + share / cap)
