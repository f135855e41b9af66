"""Levels of the preconditioner for nearly incompressible materials, that is for divergence-free displacements.

As lam grows, all that costs little in V_h is u with div u = 0 in elements and [u].n = 0 on facets, which no block of an element
and no continuous function of low order reproduces.  Under V_h come therefore

    X_k         normally continuous functions of order k (Brezzi, Douglas, Marini 1985), Gauss-Seidel over the stars of
                vertices: all dofs of the facets and elements around, among which are the curls of local potentials
    W_1         continuous functions of order 1, factorised
    curl W_1    curls of continuous potentials of order 1, factorised and OVER times the Galerkin correction

after the decomposition u = z + curl psi + local parts with |z|_1 <= c |div u| and |psi|_2 <= c |u|_1 (Hiptmair, Xu, SIAM J.
Numer. Anal. 45, 2007); that blocks have to contain the kernel is Schoeberl's condition (thesis, Linz 1999).

The curl of psi_h is constant in elements, so that what it costs are its jumps: several times what the smooth field costs
that it stands for, and the Galerkin correction is too small by that factor.  Hence OVER (as Braess, Computing 55, 1995, for
aggregates).  With Pi the projection in the middle of the symmetric cycle and S all that comes before it, 1 - P A = S' (1 -
OVER Pi) S <= S' S < 1 in the inner product of A: P stays positive definite whatever OVER is.

Only the two last levels are factorised, with d and 1 or 3 unknowns for each vertex, together a twelfth of those of V_1 on
tetrahedra.  Most of the memory are the inverses of the stars: all levels take about 64 bytes for each entry of A, measured at
72 000 unknowns of order 1.  The number of steps is bounded in lam, order and number of elements, but grows with the aspect
ratio: W_1 and the potentials are continuous across weak facets, too.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import (CF, ET, VOL, BaseVector, CoefficientFunction, ConvertOperator, FESpace, Grad, H1, HDiv, Mesh, VectorH1,
                     VectorL2, grad)

from ..contracts import Preconditioner
from ..mesh.facets import Facets, Native, VolumePoints
from ..problem.materials import StiffnessAt
from ..tools import sparse as sp
from .cycles import Correction, Corners, Cycle, Entries, Galerkin, Groups

SWOLLEN = 10        # ratio of volumetric to shear stiffness from which three solves take less time so, nu = 0.43 in 3D
OVER = 6
SHIFT = 1e-10       # of potentials whose curl vanishes, against the diagonal


def NeedsSolenoidal(disc: Any) -> bool:
    """True if lam is so large that the levels for divergence-free displacements pay, and the mesh one that they are made for.

    NGSolve interpolates normally continuous functions on simplices only.
    """
    return Swelling(disc.problem.material, disc.mesh) > SWOLLEN and Simplicial(disc.mesh)


def Simplicial(mesh: Mesh) -> bool:
    """True for triangles and tetrahedra."""
    return all(element.type in (ET.TRIG, ET.TET) for element in mesh.Elements(VOL))


def Swelling(material: Any, mesh: Mesh) -> float:
    """Largest ratio of volumetric to shear stiffness, (I : C : I)/d over 2 mu; 1 + d lam/(2 mu) for isotropic materials."""
    points, dim = VolumePoints(mesh, 0), getattr(material, "dim", mesh.dim)     # 3 of a body of revolution
    volumetric = np.einsum("niijj->n", StiffnessAt(material, points, dim)) / dim
    return float(np.max(volumetric / (2 * material.ShearAt(points))))


def VertexStars(space: FESpace, facets: Facets) -> list[list[int]]:
    """Blocks: for each vertex all dofs of the facets and elements that contain it."""
    corners = [(facet.vertices, space.GetDofNrs(facet)) for facet in space.mesh.facets]
    vertices, dofs = (np.fromiter(values, dtype=np.int64) for values in zip(*(
        (vertex.nr, dof) for vertices, inside in corners for vertex in vertices for dof in inside)))
    elements, inner = Corners(space)
    mine = ~np.isin(inner, dofs)
    elements, inner = elements[mine], inner[mine]
    around = facets.vertices[elements]
    present = around >= 0
    vertices = np.concatenate([vertices, around[present]])
    dofs = np.concatenate([dofs, np.broadcast_to(inner[:, None], around.shape)[present]])
    order = np.lexsort((dofs, vertices))
    return Groups(vertices[order], dofs[order])


def Curl(space: FESpace) -> CoefficientFunction:
    """The curl of a potential, of three components in 3D and one in 2D, whose functions a space contains."""
    psi = space.TrialFunction()
    if space.mesh.dim == 2:
        dx, dy = grad(psi)
        return CF((dy, -dx))
    D = Grad(psi)
    return CF((D[2, 1] - D[1, 2], D[0, 2] - D[2, 0], D[1, 0] - D[0, 1]))


class Factors:
    """C = factor (A + shift diag(A))^-1 of a scipy matrix."""

    def __init__(self, matrix: sp.csr_matrix, *, factor: float = 1, shift: float = 0.0) -> None:
        self.factor = factor
        self.inverse = Native(matrix + shift * sp.diags(matrix.diagonal())).Inverse(inverse="sparsecholesky")

    def Mult(self, b: BaseVector, x: BaseVector) -> None:
        x.data = self.factor * (self.inverse * b)


def SolenoidalLevels(disc: Any, matrix: sp.csr_matrix) -> tuple[sp.csr_matrix, Preconditioner]:
    """(E, C): the embedding of X_k in V_h, and the cycle on it, for a scipy matrix on V_h."""
    mesh = disc.mesh
    space, continuous = HDiv(mesh, order=disc.order), VectorH1(mesh, order=1)
    potentials = H1(mesh, order=1) if mesh.dim == 2 else continuous
    embedding = Entries(ConvertOperator(space, VectorL2(mesh, order=disc.order)))
    inner = Galerkin(matrix, embedding)
    native = Native(inner)
    linear = Entries(ConvertOperator(continuous, space))
    curls = Entries(ConvertOperator(potentials, space, trial_cf=Curl(potentials)))
    cycle = Cycle(native.CreateBlockSmoother(VertexStars(space, disc.facets)),
                  Correction(native, linear, Factors(Galerkin(inner, linear))),
                  Correction(native, curls, Factors(Galerkin(inner, curls), factor=OVER, shift=SHIFT)))
    return embedding, cycle
