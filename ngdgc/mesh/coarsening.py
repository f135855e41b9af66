"""Coarser meshes of the same body, for nested iteration: from the geometry a mesh comes from, or from its own outline.

Boundary and material regions keep their names and numbers, so that the data of a problem mean the same on every mesh.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from netgen.geom2d import SplineGeometry
from netgen.meshing import Element1D, Element2D, FaceDescriptor, NetgenGeometry
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import BND, Integrate, Mesh
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh

from ..contracts import Array
from .facets import Curved

COARSER = 0.6       # a mesh with more than this part of the elements is no help
FLAT = 1e-9         # relative deviation of vertices from a line or plane that is round-off


def CoarserMesh(mesh: Mesh, factor: float = 2.0) -> Mesh | None:
    """A mesh of the same body with elements larger by a factor, or None where there is no way to make one.

    Meshes that come from a Netgen geometry are generated anew; without one, boxes along the axes and, in 2D, polygons of one
    material are recognised by their boundary.
    """
    geometry = Geometry(mesh)
    if geometry is not None:
        coarse = Mesh(geometry.GenerateMesh(maxh=factor * MeshSize(mesh)))
    else:
        coarse = _Box(mesh, factor) or (_Polygon(mesh, factor) if mesh.dim == 2 else None)
    if coarse is None or coarse.ne > COARSER * mesh.ne:
        return None
    # Data may be given by the numbers of regions, as MaterialCF does, so names in another order would not do.
    if coarse.GetMaterials() != mesh.GetMaterials() or coarse.GetBoundaries() != mesh.GetBoundaries():
        return None
    if mesh.GetCurveOrder() > 1:
        coarse.Curve(mesh.GetCurveOrder())
    return coarse


def Geometry(mesh: Mesh) -> Any:
    """The geometry that a mesh was generated from, or None if it has none, or one that is gone."""
    geometry = mesh.ngmesh.GetGeometry()
    if geometry is None or type(geometry) is NetgenGeometry:
        return None
    # A mesh does not keep its SplineGeometry: once that has gone out of scope its memory may be anything, and the only
    # references are the one made here and that of the argument.
    if isinstance(geometry, SplineGeometry) and sys.getrefcount(geometry) <= 2:
        return None
    return geometry


def _Polygon(mesh: Mesh, factor: float) -> Mesh | None:
    """A mesh of the outline, made of new entities: Netgen makes a region of every side, and the mesh's own may have several."""
    outline = Outline(mesh)
    if outline is None:
        return None
    geometry, regions = outline
    sides = geometry.GenerateMesh(maxh=factor * MeshSize(mesh))
    coarse = NetgenMesh(dim=2)
    coarse.Add(FaceDescriptor(surfnr=1, domin=1, bc=1))
    coarse.SetMaterial(1, mesh.GetMaterials()[0])
    numbers = [coarse.Add(point) for point in sides.Points()]
    for element in sides.Elements2D():
        coarse.Add(Element2D(1, [numbers[vertex.nr - 1] for vertex in element.vertices]))
    for element in sides.Elements1D():
        coarse.Add(Element1D([numbers[vertex.nr - 1] for vertex in element.vertices], index=regions[element.index - 1] + 1))
    for number, name in enumerate(mesh.GetBoundaries()):
        coarse.SetBCName(number, name)
    return Mesh(coarse)


def MeshSize(mesh: Mesh) -> float:
    """Edge length of the equilateral triangles or regular tetrahedra that would fill the body in the same number [length]."""
    volume = Integrate(1, mesh) / mesh.ne
    if mesh.dim == 2:
        return float(np.sqrt(4 / np.sqrt(3) * volume))
    return float((6 * np.sqrt(2) * volume) ** (1 / 3))


def Outline(mesh: Mesh) -> tuple[SplineGeometry, list[int]] | None:
    """(geometry, numbers of the boundary regions of its sides), or None.

    The geometry is the polygon, possibly with holes, that bounds a plane mesh with straight edges and one material.
    """
    if Curved(mesh) or len(mesh.GetMaterials()) > 1:
        return None
    corners: dict[int, int | None] = {}
    following: dict[int, tuple[int, int]] = {}
    points = mesh.ngmesh.Coordinates()[:, :2]
    for element in mesh.Elements(BND):
        neighbours = mesh[element.edges[0]].elements
        if len(neighbours) != 1:
            return None         # an interface inside the body
        a, b = (vertex.nr for vertex in element.vertices)
        inside = np.mean([points[vertex.nr] for vertex in mesh[neighbours[0]].vertices], axis=0)
        if _Cross(points[b] - points[a], inside - points[a]) < 0:
            a, b = b, a
        if a in following:
            return None         # boundaries that touch in a vertex
        following[a] = b, element.index
    if sorted(following) != sorted(b for b, _ in following.values()):
        return None
    before = {b: (a, index) for a, (b, index) in following.items()}
    for vertex, (after, index) in following.items():
        previous, other = before[vertex]
        first, second = points[vertex] - points[previous], points[after] - points[vertex]
        bend = _Cross(first, second) / (np.linalg.norm(first) * np.linalg.norm(second))
        if index != other or abs(bend) > FLAT or first @ second < 0:
            corners[vertex] = None
    geometry = SplineGeometry()
    for vertex in corners:
        corners[vertex] = geometry.AddPoint(*points[vertex])
    for number, vertex in enumerate(corners):
        after, _ = following[vertex]
        while after not in corners:
            after = following[after][0]
        geometry.Append(["line", corners[vertex], corners[after]], leftdomain=1, rightdomain=0, bc=number + 1)
    return geometry, [following[vertex][1] for vertex in corners]


def _Cross(a: Array, b: Array) -> Array:
    return a[0] * b[1] - a[1] * b[0]


def _Box(mesh: Mesh, factor: float) -> Mesh | None:
    """A structured mesh of the box along the axes that a mesh fills, with one boundary region on each side; else None."""
    if Curved(mesh) or len(mesh.GetMaterials()) > 1:
        return None
    points = mesh.ngmesh.Coordinates()[:, :mesh.dim]
    lower, edges = points.min(axis=0), np.ptp(points, axis=0)
    if abs(Integrate(1, mesh) / np.prod(edges) - 1) > FLAT:
        return None
    sides: dict[tuple[int, int], int] = {}
    for element in mesh.Elements(BND):
        corners = (points[[vertex.nr for vertex in element.vertices]] - lower) / edges
        flat = np.flatnonzero(np.ptp(corners, axis=0) < FLAT)
        if len(flat) != 1 or sides.setdefault((flat[0], round(corners[0, flat[0]])), element.index) != element.index:
            return None
    # Structured meshes of the unit box number their sides in this order.
    order = [(1, 0), (0, 1), (1, 1), (0, 0)] if mesh.dim == 2 else [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (2, 1)]
    if [sides.get(side) for side in order] != list(range(len(order))):
        return None
    # Two triangles or six tetrahedra fill a cell.
    size = factor * ((2 if mesh.dim == 2 else 6) * np.prod(edges) / mesh.ne) ** (1 / mesh.dim)
    numbers = [max(1, round(edge / size)) for edge in edges]

    def Mapping(*point: float) -> tuple[float, ...]:
        return tuple(a + t * edge for a, t, edge in zip(lower, point, edges))

    if mesh.dim == 2:
        coarse = MakeStructured2DMesh(quads=False, nx=numbers[0], ny=numbers[1], mapping=Mapping)
    else:
        coarse = MakeStructured3DMesh(hexes=False, nx=numbers[0], ny=numbers[1], nz=numbers[2], mapping=Mapping)
    for number, name in enumerate(mesh.GetBoundaries()):
        coarse.ngmesh.SetBCName(number, name)
    coarse.ngmesh.SetMaterial(1, mesh.GetMaterials()[0])
    return coarse
