"""Moments of the forces on regions of the boundary and on interfaces."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..contracts import Array
from ..exceptions import ProblemError
from ..mesh.quadrature import BoundaryQuadrature
from ..tools.values import Vectors
from .conformingtractions import ContactTractions
from .forces import Signs, SidesOf

BONUS = 4       # quadrature degrees beyond 2 k, as for the tractions of the conforming method


def Moment(solution: Any, region: str, point: Any, material: str | None) -> Array:
    """The moment of the force through a region about a point; see `ContactSolution.Moment`."""
    disc, dim = solution.disc, solution.disc.mesh.dim
    if disc.problem.axisymmetric and point is None:
        raise ProblemError("the moments of a ring's forces cancel all around; give point=(r, z), the circle about which they "
                           "turn its section")
    about = np.zeros(dim) if point is None else Vectors(point, (dim,), "point", f"give its {dim} coordinates, or None")
    on = SidesOf(disc, region)
    signs = np.zeros(len(disc.facets.neighbours))
    signs[on] = Signs(disc, region, on, material)
    facets = disc.facets.boundary[0]
    quadrature = BoundaryQuadrature.On(disc.facets, region, 2 * disc.order + BONUS)
    traction = np.asarray(solution.facettractions.function(quadrature.points)).reshape(-1, dim)
    weights = quadrature.weights * signs[facets[quadrature.boundaryelements]]
    if disc.method.discontinuous:
        return _Sum(quadrature.coordinates - about, traction, weights)
    # Of the conforming method the law's tractions are known at the contact points, whose sum is what its equations have.
    touched = np.zeros(len(signs), dtype=bool)
    contact = list(ContactTractions(solution))
    for there, _ in contact:
        touched[facets[there.boundaryelements]] = True
    total = _Sum(quadrature.coordinates - about, traction, weights * ~touched[facets[quadrature.boundaryelements]])
    for there, t in contact:
        total = total + _Sum(there.coordinates - about, -t, there.weights * signs[facets[there.boundaryelements]])
    return total


def _Sum(arms: Array, tractions: Array, weights: Array) -> Array:
    """sum of weights (n,) times arm x traction, (1,) in 2D, (3,) in 3D."""
    if arms.shape[1] == 2:
        return np.atleast_1d(weights @ (arms[:, 0] * tractions[:, 1] - arms[:, 1] * tractions[:, 0]))
    return weights @ np.cross(arms, tractions)
