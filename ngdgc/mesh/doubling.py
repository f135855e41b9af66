"""Meshes whose nodes are doubled along joints, so that continuous functions may jump there."""

from __future__ import annotations

from typing import Any

import numpy as np
from netgen.meshing import Element1D, Element2D, MeshPoint, Pnt
from ngsolve import Mesh

from ..contracts import Array
from ..tools import sparse as sp
from .components import Connected
from .facets import Facets


def Doubled(facets: Facets) -> Facets:
    """The `Facets` of a copy of a mesh that is open along the joints; what it has inside the body is now its boundary.

    Elements around a vertex hang together there if facets that are no joints lead from one to the other; every further group
    has a vertex of its own, and at the end of a joint there is one.  Elements, materials and names keep their numbers; the
    boundary elements of second sides come last.
    """
    mesh, (number, _, corners) = facets.mesh, facets.boundary
    vertex, points = _Copies(facets)
    copy = mesh.ngmesh.Copy()
    for point in points:
        copy.Add(MeshPoint(Pnt(*point)))
    elements = copy.Elements2D() if mesh.dim == 2 else copy.Elements3D()
    sides = copy.Elements1D() if mesh.dim == 2 else copy.Elements2D()
    _Rename(elements.NumPy()["nodes"], vertex[facets.vertices, np.arange(mesh.ne)[:, None]])
    # Sides of no element stay as they are.
    known, cut = facets.neighbours[number] > 0, facets.cut[number]
    turned = cut & (facets.interfaces.sign[number] < 0)
    owners = facets.incidence.indices[(facets.incidence.indptr[number] + turned)[known]]
    _Rename(sides.NumPy()["nodes"], vertex[corners[known], owners[:, None]], np.flatnonzero(known))
    first = np.flatnonzero(cut)
    here, beyond = (vertex[corners[first], facets.incidence.indices[facets.incidence.indptr[number[first]] + side][:, None]]
                    for side in (turned[first], ~turned[first]))
    opened = np.any(here != beyond, axis=1)     # others, all of whose vertices are ends of the joint, stay inside
    first, indices = first[opened], sides.NumPy()["index"][first[opened]].tolist()
    for index, corner in zip(indices, beyond[opened]):
        nodes = [int(one) + 1 for one in corner if one >= 0]
        copy.Add(Element1D(nodes, index=index) if mesh.dim == 2 else Element2D(index, nodes))
    doubled = Mesh(copy)
    if mesh.GetCurveOrder() > 1:
        doubled.Curve(mesh.GetCurveOrder())
    return Facets(doubled, facets.joints, np.array([first, len(number) + np.arange(len(first))]), facets.frame)


def _Copies(facets: Facets) -> tuple[Any, Array]:
    """(vertex, points): the new number of every vertex in the elements around it, and where new ones lie (n, 3)."""
    mesh, (number, _, corners) = facets.mesh, facets.boundary
    there = np.zeros(mesh.nv, dtype=bool)
    there[corners[facets.cut[number]]] = True
    element, local = np.nonzero((facets.vertices >= 0) & there[facets.vertices])
    vertex = facets.vertices[element, local]
    table = sp.csr_matrix((np.arange(1, len(vertex) + 1), (element, vertex)), shape=(mesh.ne, mesh.nv))
    starts = facets.incidence.indptr[:-1][(facets.neighbours > 1) & ~facets.cut]
    first, second = (table[facets.incidence.indices[starts + side]] for side in (0, 1))
    common = first.astype(bool).multiply(second.astype(bool))
    ends = [np.asarray(side.multiply(common).tocoo().data) - 1 for side in (first, second)]
    group = Connected(len(vertex), *ends)
    # Groups of a vertex in the order of their first elements; the first one keeps it.
    groups, place = np.unique(group, return_index=True)
    order = np.lexsort((place, vertex[place]))
    own = np.append(True, np.diff(vertex[place][order]) > 0)
    names = np.empty(len(groups), dtype=np.int64)
    names[order[own]] = vertex[place][order[own]]
    names[order[~own]] = mesh.nv + np.arange(np.sum(~own))
    points = mesh.ngmesh.Coordinates()[vertex[place][order[~own]]]
    return _Numbers(table, names[np.searchsorted(groups, group)]), np.pad(points, ((0, 0), (0, 3 - points.shape[1])))


class _Numbers:
    """The numbers that vertices have in elements, indexed by arrays of vertices (-1: none) and elements."""

    def __init__(self, table: sp.csr_matrix, names: Any) -> None:
        self._table, self._names = table, np.append(-1, names)

    def __getitem__(self, pair: tuple[Any, Any]) -> Any:
        vertices, elements = np.broadcast_arrays(*pair)
        found = np.asarray(self._table[elements.ravel(), np.maximum(vertices, 0).ravel()]).reshape(vertices.shape)
        return np.where((vertices >= 0) & (found > 0), self._names[found], vertices)


def _Rename(nodes: Any, vertices: Any, rows: Any = slice(None)) -> None:
    """Write vertex numbers (n, most), -1 where there is none, into rows of Netgen's nodes, counted from 1."""
    block = nodes[rows]
    block[:, :vertices.shape[1]] = np.where(vertices >= 0, vertices + 1, block[:, :vertices.shape[1]])
    nodes[rows] = block
