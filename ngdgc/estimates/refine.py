"""Meshes with some elements bisected, and what cannot be."""

from __future__ import annotations

from typing import Any

from netgen.geom2d import SplineGeometry
from ngsolve import HEX, PRISM, PYRAMID, VOL, ElementId, Mesh

from ..contracts import Array
from ..exceptions import ProblemError
from ..mesh.coarsening import Geometry
from ..mesh.facets import SecondOrder

# Prisms are bisected across their axis alone, so that errors along it stay.
REFUSED = {HEX: "hexahedra", PYRAMID: "pyramids", PRISM: "prisms"}


def Refined(mesh: Mesh, marked: Array) -> Mesh:
    """A copy of a mesh that can be refined, in which the marked elements (a mask) are bisected.

    In the plane until their sides are; tetrahedra once, for all edges would take three times, and with the neighbours the mesh
    would grow too fast.  Neighbours are bisected as far as it takes for no node to hang, a row of quadrilaterals as a whole.
    Regions keep their names, and boundaries are curved again: refinement leaves straight elements.
    """
    copy = mesh.ngmesh.Copy()
    if _Lost(mesh):
        copy.SetGeometry(None)
    fine = Mesh(copy)
    for number in range(fine.ne):
        # Also False: elements are marked at first.
        fine.SetRefinementFlag(ElementId(VOL, number), bool(marked[number]))
    fine.Refine(onlyonce=mesh.dim == 3)
    if mesh.GetCurveOrder() > 1:
        fine.Curve(mesh.GetCurveOrder())
    return fine


def CheckRefinable(mesh: Mesh) -> None:
    """Raise ProblemError for a mesh that Netgen's bisection does not refine, or would make another body of."""
    refused = {element.type for element in mesh.Elements(VOL)} & set(REFUSED)
    if refused:
        raise ProblemError(f"the mesh has {' and '.join(sorted(REFUSED[kind] for kind in refused))}, which Netgen does not "
                           "bisect in all directions; take tetrahedra, or finer meshes without adaptivity")
    if mesh.deformation is not None:
        raise ProblemError("the mesh has a deformation, a function on it, which a refined mesh has not; make a mesh of the "
                           "deformed body")
    if SecondOrder(mesh):
        raise ProblemError("the mesh has elements of second order, whose nodes on edges are not refined; take one of "
                           "first order and Curve(2)")
    if mesh.GetCurveOrder() > 1 and _Lost(mesh):
        raise ProblemError("the SplineGeometry of the mesh is gone, along which new elements would be curved; keep it in a "
                           "variable, or take ngdgc.meshes.ShapeMesh, whose meshes keep their geometry")


def _Lost(mesh: Any) -> bool:
    """True if the mesh names a geometry that is no longer there, which Netgen would ask all the same."""
    # Without a variable for it, whose reference would count.
    return isinstance(mesh.ngmesh.GetGeometry(), SplineGeometry) and Geometry(mesh) is None
