"""Bodies of revolution: their mesh, half of the section x = r >= 0, and what their material must not do."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from ngsolve import Mesh, x

from ..data.coefficients import CheckRange, ValuesAt
from ..exceptions import ProblemError
from ..mesh.facets import Facets, Vertices, VolumePoints
from ..problem.frames import AXIS, NEAR
from ..problem.materials import AnisotropicMaterial, HookeMaterial, MaterialWords, StiffnessAt

ORDER = 4       # of the quadrature at whose points r is looked at


def CheckSection(mesh: Mesh) -> None:
    """Raise ProblemError unless a mesh is half of the section of a body of revolution."""
    if mesh.dim != 2:
        raise ProblemError(f"the mesh has dimension {mesh.dim} and the body is one of revolution; give a plane mesh of half of "
                           "its section, x = r and y = z, or leave axisymmetric out")
    vertices = Vertices(mesh, 2)
    r = np.asarray(mesh.ngmesh.Coordinates())[vertices[vertices >= 0], 0]
    least = min(r.min(), np.asarray(x(VolumePoints(mesh, ORDER))).min())
    if least < -AXIS * np.abs(r).max():
        raise ProblemError(f"the mesh reaches to r = {least:.3g}, beyond the axis x = 0 of the body; give half of its section, "
                           "x = r >= 0")
    near = r[(r > AXIS * r.max()) & (r < NEAR * r.max())]
    if len(near):
        raise ProblemError(f"the mesh has corners of elements at r = {near.min():.3g}, nearly on the axis of the body; a full "
                           "body has them at x = 0, a hole is larger: round their coordinates")


def CheckSpatial(material: HookeMaterial | AnisotropicMaterial, mesh: Mesh, points: Any) -> None:
    """Raise ProblemError unless a material is positive definite in space at the points, and twists no section."""
    if isinstance(material, HookeMaterial):     # whose check is that of the plane
        least = 3 * ValuesAt(material.lam, points, "lam") + 2 * ValuesAt(material.mu, points, "mu")
        CheckRange(least, "3*lam + 2*mu", above=0, Where=partial(MaterialWords, mesh, points))
        return
    C = StiffnessAt(material, points if material.bonus else points[:1], 3)
    inside = np.array([[True, True, False], [True, True, False], [False, False, True]])
    # Strains in the section and around it, against shear across it.
    twist = np.abs(C[:, inside][:, :, ~inside]).max()
    if twist > 1e-12 * np.abs(C).max():
        raise ProblemError(f"the material couples strains in the section with shear across it, by entries up to {twist:.3g} in "
                           "columns 4 and 5 of voigt, so that the body would twist, and one of revolution does not; let these "
                           "be 0, or take the body in space")


def OnAxis(facets: Facets) -> np.ndarray:
    """True for the facets on the axis x = 0, over facets."""
    number, _, vertices = facets.boundary
    r = np.asarray(facets.mesh.ngmesh.Coordinates())[:, 0]
    axis = np.zeros(len(facets.neighbours), dtype=bool)
    axis[number[(r[vertices[:, :2]] <= AXIS * r.max()).all(axis=1)]] = True
    return axis
