"""The quadratures of a foundation, and those of both sides of a joint."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..exceptions import ProblemError
from ..mesh.facets import ByType, Facets
from ..mesh.pieces import Pieces
from ..mesh.quadrature import BoundaryQuadrature, VertexFunctions
from ..problem.foundation import Foundation

END = 1e-9      # of the functions of vertices that are doubled, at points where both sides are one


def Faces(facets: Facets, foundation: Foundation, rules: Any, pieces: Pieces | None = None) -> list[BoundaryQuadrature]:
    """The quadrature of a foundation, or of the first and of the second side of a joint, whose points are the same.

    rules, pieces : as for `BoundaryQuadrature.On`

    Where nodes are doubled the ends of a joint, which no displacement opens, are none of its points.  Raises ProblemError if
    there is no other one.
    """
    if foundation.kind != "joint":
        quadrature = BoundaryQuadrature.On(facets, foundation.boundary, rules, pieces=pieces)
        # On the axis of a body of revolution a point stands for no area.
        return [quadrature if quadrature.weights.all() else quadrature.At(np.flatnonzero(quadrature.weights))]
    if facets.doubled is None:
        first = np.where(facets.interfaces.sign > 0, 0, 1)
        return [BoundaryQuadrature.On(facets, foundation.boundary, rules, side=side, pieces=pieces)
                for side in (first, 1 - first)]
    both = BoundaryQuadrature.On(facets, foundation.boundary, rules, pieces=pieces)
    number = both.boundaryelements
    pairs = facets.doubled[:, np.isin(facets.doubled[0], number)]
    first, second = (np.flatnonzero(np.isin(number, side)) for side in pairs)
    # Both sides have their elements in one order, and these their corners and points.
    apart = _Apart(facets, both.At(first), dict(zip(*pairs.tolist()))) & (both.weights[first] > 0)
    if not apart.any():
        raise ProblemError(f"joint {foundation.boundary!r} has no vertex between its ends at which continuous displacements "
                           "could jump; take smaller elements there, or a discontinuous method such as LDG()")
    return [both.At(rows[apart]) for rows in (first, second)]


def _Apart(facets: Facets, quadrature: BoundaryQuadrature, partner: dict[int, int]) -> np.ndarray:
    """True for the points of first sides at which the second side has nodes of its own."""
    corners, number = facets.boundary[2], quadrature.boundaryelements
    differ = corners[number] != corners[[partner[int(one)] for one in number]]
    apart = np.zeros(len(number), dtype=bool)
    for et, rows in ByType(corners[number], facets.mesh.dim - 1):
        functions = VertexFunctions(et, quadrature.points["x"][rows], quadrature.points["y"][rows])
        apart[rows] = np.sum(functions * differ[rows][:, :functions.shape[1]], axis=1) > END
    return apart
