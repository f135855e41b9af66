"""A continuous displacement near u_h that keeps what is prescribed.

    v in H1, the average of u_h of the elements around, on Gamma_D the prescribed values, v_n on rollers, and on Gamma_C the
    average of the elements at Gamma_C alone, so that what penetrates the foundation is not averaged with the inside.

Of a nearly incompressible body, or one of very different materials, an average has stresses that are far off: there sweeps of
Gauss and Seidel over the stars of vertices follow, for the least |C eps(v) - C eps(u_h)|.
"""

from __future__ import annotations

from collections.abc import Iterator
from copy import copy
from functools import lru_cache
from typing import Any

import numpy as np
from ngsolve import (BND, EDGE, H1, VERTEX, VOL, BilinearForm, BitArray, BoundaryFromVolumeCF, ElementId, GridFunction,
                     InnerProduct, LinearForm, NodeId, Region, VectorH1, dx, specialcf)

from ..blocks.integrals import ElementGroup
from ..blocks.reference import Gradients, ReferenceElement, Values
from ..blocks.revolved import RevolvedGroup
from ..contracts import Array
from ..data.inside import OnBoundary
from ..discrete.section import OnAxis
from ..linear.solenoidal import Swelling
from ..mesh.facets import Facets, Threads, VolumePoints
from ..problem.frames import AXIS

SWOLLEN, VERY = 5, 100      # `Swelling` from which one sweep, and two, are made: nu = 0.4 and 0.495
CONTRAST = 10               # of shear moduli, from which one is


class Potential:
    """v of a solution, of order k + 1, with sweeps k + 2.

    gfu : GridFunction in VectorH1
    """

    def __init__(self, solution: Any) -> None:
        disc = solution.disc
        self.mesh, problem, self._frame = disc.mesh, disc.problem, disc.problem.frame
        sweeps = Sweeps(problem.material, self.mesh)
        self.order = disc.order + (2 if sweeps else 1)
        fixed = "|".join([*problem.dirichlet, *problem.roller, *(foundation.boundary for foundation in problem.foundation)])
        self.gfu = GridFunction(VectorH1(self.mesh, order=self.order, dirichlet=fixed))
        self._scalar = H1(self.mesh, order=self.order)
        self._axis = AxisDofs(disc.facets, self._scalar) if problem.axisymmetric else []
        with Threads(self.mesh):
            self.gfu.Set(solution.gfu)
            self._Impose(solution)
            self._OffAxis()
            if sweeps:
                self._Sweep(solution, sweeps)

    def _OffAxis(self) -> None:
        """v_r = 0 on the axis, where v_r/r would have no energy."""
        self.gfu.vec.FV().NumPy()[self._axis] = 0

    def _Impose(self, solution: Any) -> None:
        problem, n = solution.disc.problem, specialcf.normal(self.mesh.dim)
        for foundation in problem.foundation:
            self._Set(BoundaryFromVolumeCF(solution.gfu), self.mesh.Boundaries(foundation.boundary))
        for region, value in problem.roller.items():
            # Face by face: on edges between them each sees what the ones before have made of v, and changes its own part.
            for boundary in self._Faces(region):
                given = OnBoundary(value * specialcf.normal(self.mesh.dim), boundary, f"roller[{region!r}]")
                self._Set(self.gfu - InnerProduct(self.gfu, n) * n + given, boundary)
        for region, value in problem.dirichlet.items():
            boundary = self.mesh.Boundaries(region)
            self._Set(OnBoundary(value, boundary, f"dirichlet[{region!r}]"), boundary)

    def _Faces(self, region: str) -> Iterator[Region]:
        """The faces of a region of the boundary, as many as have a number of their own."""
        mask = self.mesh.Boundaries(region).Mask()
        for number in np.flatnonzero(list(mask)).tolist():
            face = BitArray(len(mask))
            face.Clear()
            face.Set(number)
            yield Region(self.mesh, BND, face)

    def _Set(self, value: Any, boundary: Region) -> None:
        other = GridFunction(self.gfu.space)
        other.Set(value, definedon=boundary)        # elsewhere it is 0
        there = np.array(self.gfu.space.GetDofs(boundary), dtype=bool)
        self.gfu.vec.FV().NumPy()[there] = other.vec.FV().NumPy()[there]

    def _Sweep(self, solution: Any, sweeps: int) -> None:
        space, material = self.gfu.space, solution.disc.problem.material
        (u, v), frame = space.TnT(), self._frame
        energy = InnerProduct(material.Stress(frame.Strain(u)), frame.Strain(v))
        matrix = BilinearForm(frame.Integral(energy, dx)).Assemble().mat
        load = LinearForm(frame.Integral(InnerProduct(solution.stress, frame.Strain(v)), dx)).Assemble().vec
        blocks = [list(block) for block in space.CreateSmoothingBlocks(blocktype="vertexpatch")]
        if held := set(self._axis):
            blocks = [[dof for dof in block if dof not in held] for block in blocks]
        smoother = matrix.CreateBlockSmoother(blocks)
        for _ in range(sweeps):
            smoother.Smooth(self.gfu.vec, load)
            smoother.SmoothBack(self.gfu.vec, load)

    def Moved(self, displacements: Array) -> Potential:
        """The potential and hat functions with these values (vertices, d) at the vertices."""
        other = copy(self)
        other.gfu = GridFunction(self.gfu.space)
        values = other.gfu.vec.FV().NumPy()
        values[:] = self.gfu.vec.FV().NumPy()
        # The functions of the vertices come first in every component, and are those of order 1.
        values.reshape(self.mesh.dim, -1)[:, :self.mesh.nv] += displacements.T
        return other

    def Gradient(self, part: ElementGroup) -> Array:
        """grad v at the points of a part, (n, q, i, j), of a body of revolution that in space."""
        G, _ = part.Geometry()
        dofs = np.array([self._scalar.GetDofNrs(ElementId(VOL, int(element))) for element in part.elements])
        vector = self.gfu.vec.FV().NumPy().reshape(part.dim, -1)
        local = np.swapaxes(vector[:, dofs], 0, 1)      # n i a
        plane = part.AtPoints(lambda shape: _Gradients(part.et, self.order, shape), local) @ G
        if not isinstance(part, RevolvedGroup):
            return plane
        whole = np.zeros((*plane.shape[:2], 3, 3))
        radial = part.AtPoints(lambda shape: _Values(part.et, self.order, shape)[:, None], local[:, :1])[..., 0, 0]
        whole[..., :2, :2], whole[..., 2, 2] = plane, radial / part.Radii()
        return whole


def Sweeps(material: Any, mesh: Any) -> int:
    """How many sweeps the functions of an estimate need."""
    swelling, shear = Swelling(material, mesh), material.ShearAt(VolumePoints(mesh, 0))
    if swelling > VERY:
        return 2
    return int(swelling > SWOLLEN or shear.max() > CONTRAST * shear.min())


@lru_cache(maxsize=256)
def _Gradients(et: Any, order: int, shape: ReferenceElement) -> Array:
    """Reference gradients (q, m, a) of H1 at the points of a ReferenceElement, whose order of vertices it shares."""
    return Gradients(H1(shape.mesh, order=order).GetFE(ElementId(VOL, 0)), shape.points, shape.dim)


@lru_cache(maxsize=256)
def _Values(et: Any, order: int, shape: ReferenceElement) -> Array:
    """Values (q, a) of H1 there."""
    return Values(H1(shape.mesh, order=order).GetFE(ElementId(VOL, 0)), shape.points)


def AxisDofs(facets: Facets, space: Any) -> list[int]:
    """The dofs of a scalar space of continuous functions on the axis of a body of revolution, in ascending order."""
    r = np.asarray(facets.mesh.ngmesh.Coordinates())[:, 0]
    found = {dof for number in np.flatnonzero(r <= AXIS * r.max()) if number < facets.mesh.nv
             for dof in space.GetDofNrs(NodeId(VERTEX, int(number)))}
    for facet in np.flatnonzero(OnAxis(facets)):
        found.update(space.GetDofNrs(NodeId(EDGE, int(facet))))
    return sorted(found)
