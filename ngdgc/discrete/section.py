"""The mesh of a body of revolution: half of its section, x = r >= 0."""

from __future__ import annotations

import numpy as np
from ngsolve import Mesh, x

from ..exceptions import ProblemError
from ..mesh.facets import Facets, Vertices, VolumePoints
from ..problem.frames import AXIS

NEAR = 1e-6     # radius that is meant to be 0, relative to that of the body
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


def OnAxis(facets: Facets) -> np.ndarray:
    """True for the facets on the axis x = 0, over facets."""
    number, _, vertices = facets.boundary
    r = np.asarray(facets.mesh.ngmesh.Coordinates())[:, 0]
    axis = np.zeros(len(facets.neighbours), dtype=bool)
    axis[number[(r[vertices[:, :2]] <= AXIS * r.max()).all(axis=1)]] = True
    return axis
