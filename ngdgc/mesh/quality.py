"""How good the elements of a mesh are: their shapes, compared with those whose edges are equally long."""

from __future__ import annotations

import numpy as np
from ngsolve import ET, HEX, PRISM, PYRAMID, QUAD, TET, TRIG, Mesh

from ..contracts import Array
from .facets import SIDEVERTICES, ByType, Vertices

HALF = np.sqrt(3) / 2
# The best elements, with corners in NGSolve's order.
IDEAL = {TRIG: [(1, 0), (0.5, HALF), (0, 0)], QUAD: [(0, 0), (1, 0), (1, 1), (0, 1)],
         TET: [(1, 0, 0), (0.5, HALF, 0), (0.5, HALF / 3, np.sqrt(2 / 3)), (0, 0, 0)],
         HEX: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
         PRISM: [(1, 0, 0), (0.5, HALF, 0), (0, 0, 0), (1, 0, 1), (0.5, HALF, 1), (0, 0, 1)],
         PYRAMID: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, np.sqrt(0.5))]}


def ShapeQuality(mesh: Mesh) -> Array:
    """The mean ratio of every element with straight edges, (elements,): 1 is the best shape, 0 is flat.

    d |det T|^(2/d)/|T|^2 with T the map, at a corner, from the best element's edges there; the smallest of all corners (Knupp,
    Algebraic mesh quality metrics, 2001).  Size and position do not count.
    """
    points, vertices = mesh.ngmesh.Coordinates()[:, :mesh.dim], Vertices(mesh, mesh.dim)
    quality = np.ones(len(vertices))
    for et, rows in ByType(vertices, mesh.dim):
        ideal = np.array(IDEAL[et], dtype=float)
        corners = points[vertices[rows][:, :len(ideal)]]
        for corner, ends in _Edges(et).items():
            edges = np.swapaxes(corners[:, ends] - corners[:, [corner]], 1, 2)
            T = edges @ np.linalg.inv((ideal[ends] - ideal[corner]).T)
            ratio = mesh.dim * np.abs(np.linalg.det(T)) ** (2 / mesh.dim) / np.sum(T * T, axis=(1, 2))
            quality[rows] = np.minimum(quality[rows], ratio)
    return quality


def _Edges(et: ET) -> dict[int, list[int]]:
    """{corner: the others that it has an edge with}, of corners with as many edges as dimensions."""
    sides = SIDEVERTICES[et]
    around = [(a, b) for side in sides for a, b in zip(side, side[1:] + side[:1] if len(side) > 2 else side[1:])]
    found: dict[int, set[int]] = {}
    for a, b in around:
        found.setdefault(a, set()).add(b)
        found.setdefault(b, set()).add(a)
    dim = 2 if et in (TRIG, QUAD) else 3
    return {corner: sorted(ends) for corner, ends in sorted(found.items()) if len(ends) == dim}
