"""Continuous piecewise linear functions on some of the vertices, fine where they are wanted and coarse elsewhere.

Vertices whose functions are kept are those that are wanted, and of the others a maximal independent set, in which no two are
ends of one edge, and each vertex that is left out has a neighbour (Luby 1986; of each row of a mesh of cubes every second one).
The value at a vertex that is left out is linear in a tetrahedron (2D: triangle) of Delaunay's of vertices that are kept and at
most two edges away.  Vertices around which there is none, on curved sides or at a crack, are kept as well: so all linear
functions are among these functions, and rigid motions with them.
"""

from __future__ import annotations

import numpy as np

from ..contracts import Array
from ..tools import sparse as sp
from .multigrid import PartlyContinuous

ROUNDOFF = 1e-9     # of barycentric coordinates
MOVED = 0.01        # part of the distance of neighbours by which points are moved before they are joined to simplices
THIN = 1e-3         # least size of a body across, over the largest, by which points are moved
FLAT = 1e-3         # volume of simplices that are none, over the product of their edges


class VertexGraph:
    """Which vertices of W_1 are in one element, as a graph.

    Attributes
    ----------
    incidence : elements x vertices, scipy CSR with ones;  neighbours : vertices x vertices, with the vertex itself
    """

    def __init__(self, space: PartlyContinuous) -> None:
        corner = space.dofs < space.mesh.nv
        elements, vertices = space.elements[corner], space.copies[corner]
        self.incidence = sp.csr_matrix((np.ones(len(elements)), (elements, vertices)),
                                       shape=(space.mesh.ne, len(space.vertex)))
        self.neighbours = sp.csr_matrix(self.incidence.T @ self.incidence)

    def Around(self, elements: np.ndarray, rings: int) -> np.ndarray:
        """True for the vertices of some elements, and of so many rings of elements around them; elements is a mask."""
        vertices = self.incidence.T @ elements > 0
        for _ in range(rings):
            vertices = self.neighbours @ vertices > 0
        return vertices

    def Independent(self, wanted: np.ndarray) -> np.ndarray:
        """True for the wanted vertices, a mask, and for a maximal independent set of the others: corners and edges first."""
        starts, ends = self.neighbours.indptr, self.neighbours.indices
        kept, free = wanted.copy(), ~wanted
        for vertex in np.argsort(self.incidence.T @ np.ones(self.incidence.shape[0]), kind="stable"):
            if free[vertex]:
                kept[vertex] = True
                free[ends[starts[vertex]:starts[vertex + 1]]] = False
        return kept


def Thinned(points: Array, graph: VertexGraph, wanted: np.ndarray) -> sp.csr_matrix:
    """Values at all vertices, with coordinates (n, d), of the functions that are kept, scipy CSR (n, kept vertices)."""
    kept = graph.Independent(wanted)
    targets, corners, weights = _Inside(points, graph.neighbours, kept)
    if len(targets):
        close = sp.csr_matrix(graph.neighbours @ graph.neighbours)
        near = np.asarray(close[np.repeat(targets, corners.shape[1]), corners.ravel()]).reshape(corners.shape) > 0
        inside = np.all(near | (weights == 0), axis=1)
        targets, corners, weights = targets[inside], corners[inside], weights[inside]
    own = np.ones(len(points), dtype=bool)
    own[targets] = False
    column = np.cumsum(own) - 1
    rows = np.concatenate([np.flatnonzero(own), np.repeat(targets, corners.shape[1])])
    columns = np.concatenate([column[own], column[corners.ravel()]])
    return sp.csr_matrix((np.concatenate([np.ones(int(own.sum())), weights.ravel()]), (rows, columns)),
                         shape=(len(points), int(own.sum())))


def _Inside(points: Array, neighbours: sp.csr_matrix, kept: np.ndarray) -> tuple[np.ndarray, np.ndarray, Array]:
    """Vertices (m,) that are not kept, the kept ones of the simplex that contains each (m, d + 1), and barycentric coordinates.

    The simplices are those of Delaunay's that have a neighbour as a corner: who walks through all of them gets lost among the
    flat ones of regular meshes.
    """
    others, left, dim = np.flatnonzero(kept), np.flatnonzero(~kept), points.shape[1]
    corners = points[others]
    simplices = _Simplices(corners)
    ends = sp.csr_matrix((np.ones(simplices.size), (simplices.ravel(), np.repeat(np.arange(len(simplices)), dim + 1))),
                         shape=(len(others), len(simplices)))
    tried = sp.csr_matrix(neighbours[left][:, others] @ ends).tocoo()
    base = corners[simplices[:, -1]]
    edges = np.moveaxis(corners[simplices[:, :-1]] - base[:, None], 1, 2)
    flat = np.abs(np.linalg.det(edges)) <= FLAT * np.linalg.norm(edges, axis=1).prod(axis=1)
    inverses = np.linalg.inv(np.where(flat[:, None, None], np.eye(dim), edges))
    first = np.einsum("mij,mj->mi", inverses[tried.col], points[left[tried.row]] - base[tried.col])
    weights = np.concatenate([first, 1 - first.sum(axis=1, keepdims=True)], axis=1)
    weights[np.abs(weights) < ROUNDOFF] = 0
    lowest = np.where(flat[tried.col], -1, weights.min(axis=1))
    order = np.lexsort((-lowest, tried.row))
    best = order[np.unique(tried.row[order], return_index=True)[1]]
    best = best[lowest[best] >= 0]
    return left[tried.row[best]], others[simplices[tried.col[best]]], weights[best]


def _Simplices(points: Array) -> np.ndarray:
    """Delaunay's of points (n, d) nearby, (m, d + 1); flat ones are among them.

    Where many points lie on one sphere, as in regular meshes, Qhull takes very long: so all of them are moved a little.
    """
    from scipy.spatial import Delaunay  # slow to import

    dim, size = points.shape[1], np.ptp(points, axis=0)
    if len(points) <= dim:
        return np.empty((0, dim + 1), dtype=np.int64)
    reach = MOVED * np.maximum(size, THIN * size.max()) / len(points) ** (1 / dim)
    moved = points + reach * np.random.default_rng(0).uniform(-1, 1, points.shape)
    return Delaunay(moved).simplices.astype(np.int64)
