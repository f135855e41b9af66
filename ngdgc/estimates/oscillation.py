"""What of the data the functions of a mesh do not contain."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..contracts import Array
from ..data.coefficients import ValuesAt, VectorsAt
from ..mesh.quadrature import BoundaryQuadrature
from .equilibrated import EquilibratedStress, StressBatch
from .facetsizes import FacetSizes
from .potential import Potential

DEGREE = 6          # of quadrature beyond 2 k
ROUNDOFF = 1e-9     # of data, relative to the largest: what polynomials of the order contain


def BodyOscillation(disc: Any, batch: StressBatch, shear: Array) -> Array:
    """(h/(pi (k + 1)))^2/(2 mu) |f_1 + div s|^2 over the elements: f_1 + div s is orthogonal to V_h, w - Pi_k w is small."""
    rest = batch.BodyForce(disc.problem) + batch.divergence
    return (batch.diameters / (np.pi * (disc.order + 1))) ** 2 * batch.Integral(np.square(rest).sum(axis=2) / (2 * shear))


def TractionOscillation(disc: Any, stress: EquilibratedStress) -> Iterator[tuple[Any, Array]]:
    """(elements (m,), h/(2 mu (k + 1)) |f_2 - s n|^2 times weights) at m points of a quadrature on Gamma_F, by regions."""
    for quadrature, rest in _Tractions(disc, stress):
        shear = disc.problem.material.ShearAt(quadrature.inside)
        price = FacetSizes(disc, quadrature) / (2 * shear * (disc.order + 1))
        yield quadrature.elements, quadrature.weights * price * np.square(rest).sum(axis=1)


def _Tractions(disc: Any, stress: EquilibratedStress) -> Iterator[tuple[BoundaryQuadrature, Array]]:
    """(quadrature on Gamma_F, f_2 - s n (m, d) there); on rollers the tangential part, which alone is given."""
    for (kind, region), value in disc.tractions.items():
        quadrature = BoundaryQuadrature.On(disc.facets, region, 2 * disc.order + DEGREE)
        name = f"{kind}[{region!r}]"
        rest = VectorsAt(value, quadrature.points, name, disc.mesh.Boundaries(region)) - stress.Traction(quadrature)
        rolling = np.zeros(len(disc.facets.neighbours), dtype=bool)
        for roller in disc.problem.roller:
            rolling |= disc.facets.On(roller)
        there, n = rolling[disc.facets.boundary[0][quadrature.boundaryelements]], quadrature.normals
        yield quadrature, rest - np.where(there, np.einsum("mi,mi->m", rest, n), 0)[:, None] * n


def Contained(disc: Any, stress: EquilibratedStress, potential: Potential) -> str:
    """Words for data that the polynomials of the order do not contain: tractions those of s n, displacements those of v."""
    for quadrature, rest in _Tractions(disc, stress):
        if np.abs(rest).max(initial=0) > ROUNDOFF * max(np.abs(stress.Traction(quadrature)).max(initial=0), np.abs(rest).max()):
            return "a traction is no polynomial of degree k on the sides"
    for kind in ("dirichlet", "roller"):
        for region, value in getattr(disc.problem, kind).items():
            quadrature = BoundaryQuadrature.On(disc.facets, region, 2 * disc.order + DEGREE)
            v = np.asarray(potential.gfu(quadrature.points)).reshape(-1, disc.mesh.dim)
            given = quadrature.points, f"{kind}[{region!r}]", disc.mesh.Boundaries(region)
            if kind == "dirichlet":
                rest = v - VectorsAt(value, *given)
            else:
                rest = np.einsum("mi,mi->m", v, quadrature.normals) - ValuesAt(value, *given)
            if np.abs(rest).max(initial=0) > ROUNDOFF * np.abs(potential.gfu.vec.FV().NumPy()).max():
                return ("a prescribed displacement is no polynomial of degree k + 1 on the sides, or rollers of one face meet "
                        "at an angle")
    return ""
