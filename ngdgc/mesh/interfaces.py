"""Named boundaries inside the body, between two elements: which side's outward normal is theirs."""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import Mesh

from .components import Connected


class Interfaces:
    """One normal all along every connected piece of a named boundary inside the body.

    facets : the facets of the mesh

    Pieces hang together at vertices in 2D and at edges in 3D where exactly two facets of one name meet, so they end where an
    interface branches.  The normal is outward of the side whose material comes first in mesh.GetMaterials(), read at the
    first boundary element of the piece that has two materials; in one material it is outward of the element with the smaller
    number at the first boundary element.  A one-sided band, of which no side can be told, falls into its facets.

    Attributes, over facets
    -----------------------
    sign : 1 if the normal is outward of the element with the smaller number, as everywhere off interfaces, else -1
    piece : number of the piece, -1 off interfaces
    materials : (facets, 2) places in mesh.GetMaterials() of the materials on the normal's own side and beyond, -1 where there
        is none or the facet has no name
    """

    def __init__(self, facets: Any) -> None:
        self.facets, count = facets, len(facets.neighbours)
        self.sign, self.piece = np.ones(count), np.full(count, -1)
        self.materials = np.full((count, 2), -1)
        facet, region, vertices = facets.boundary
        ranks, known = _MaterialRanks(facets.mesh), facets.neighbours[facet] > 0    # others are sides of no element
        facet, region, vertices = facet[known], region[known], vertices[known]
        self.materials[facet, 0] = ranks[facets.incidence.indices[facets.incidence.indptr[facet]]]
        inside = np.flatnonzero(facets.neighbours[facet] > 1)
        inside = inside[np.sort(np.unique(facet[inside], return_index=True)[1])]
        if not len(inside):
            return
        names = np.unique(np.array(facets.mesh.GetBoundaries())[region[inside]], return_inverse=True)[1].ravel()
        facet, vertices = facet[inside], vertices[inside]
        sides = facets.incidence.indices[facets.incidence.indptr[facet][:, None] + np.arange(2)]
        materials = ranks[sides]
        piece, turn = _Pieces(vertices, names)
        # Times the sign of the outward normal of the first element this is one normal all along a piece.
        along = turn * self._Behind(vertices, sides[:, 0])
        wanted = np.where(materials[:, 0] <= materials[:, 1], 1, -1)
        order = np.lexsort((np.arange(len(facet)), materials[:, 0] == materials[:, 1], piece))
        leader = order[np.searchsorted(piece[order], piece)]
        sign = along * along[leader] * wanted[leader]
        self.sign[facet], self.piece[facet] = sign, piece
        self.materials[facet] = np.where(sign[:, None] > 0, materials, materials[:, ::-1])

    def _Behind(self, vertices: np.ndarray, elements: np.ndarray) -> np.ndarray:
        """1 where the element lies behind the facet (on the left in 2D) as its vertices are ordered, else -1."""
        dim, facets = self.facets.mesh.dim, self.facets
        points = facets.mesh.ngmesh.Coordinates()[:, :dim]
        around = facets.vertices[elements]
        centre = np.where(around[..., None] >= 0, points[around], 0).sum(axis=1) / (around >= 0).sum(axis=1)[:, None]
        corner = points[vertices[:, 0]]
        if dim == 2:
            along = points[vertices[:, 1]] - corner
            normal = np.stack([along[:, 1], -along[:, 0]], axis=1)
        else:
            last = np.where(vertices[:, -1] >= 0, vertices[:, -1], vertices[:, 0])
            normal = np.cross(points[vertices[:, 2]] - corner, points[last] - points[vertices[:, 1]])
        return np.where(np.einsum("ni,ni->n", centre - corner, normal) < 0, 1, -1)


def _MaterialRanks(mesh: Mesh) -> np.ndarray:
    """Place of every element's material in mesh.GetMaterials(), (ne,); parts of one name have one place."""
    names = list(mesh.GetMaterials())
    elements = mesh.ngmesh.Elements2D() if mesh.dim == 2 else mesh.ngmesh.Elements3D()
    return np.array([names.index(name) for name in names])[elements.NumPy()["index"].astype(int) - 1]


def _Pieces(vertices: np.ndarray, names: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(piece, turn) of n facets given by their vertices in order (n, most, filled with -1) and the numbers of their names.

    turn is 1 or -1: facets of a piece have coherent orders of vertices after those with -1 are reversed.
    """
    n, corners = len(vertices), (vertices >= 0).sum(axis=1)
    if vertices.shape[1] == 2:
        owner, ends, direction = np.tile(np.arange(n), 2), vertices.T.reshape(-1, 1), np.repeat([-1, 1], n)
    else:
        owner = np.repeat(np.arange(n), corners)
        local = np.arange(len(owner)) - np.repeat(np.cumsum(corners) - corners, corners)
        a, b = vertices[owner, local], vertices[owner, (local + 1) % corners[owner]]
        ends, direction = np.sort(np.stack([a, b], axis=1), axis=1), np.where(a < b, 1, -1)
    _, place, uses = np.unique(np.column_stack([names[owner], ends]), axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(place.ravel(), kind="stable")
    pairs = order[uses[place.ravel()[order]] == 2].reshape(-1, 2)
    i, j = owner[pairs].T
    coherent = direction[pairs].prod(axis=1) < 0
    # Every facet stands twice, in its order and reversed: a piece whose two copies hang together is one-sided.
    rows, columns = np.concatenate([i, i + n]), np.concatenate([np.where(coherent, j, j + n), np.where(coherent, j + n, j)])
    labels = Connected(2 * n, rows, columns)
    forward, reverse = labels[:n], labels[n:]
    piece = np.where(forward == reverse, 2 * n + np.arange(n), np.minimum(forward, reverse))
    return np.unique(piece, return_inverse=True)[1].ravel(), np.where(forward <= reverse, 1, -1)
