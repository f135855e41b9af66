"""The problem on a small part of V_h that knows nearly all about contact.

    X_h = {v in V_h : v is continuous and piecewise linear away from Gamma_C, on coarser elements further away},

all functions of V_h on the elements that touch Gamma_C with a vertex, those of W_1 (`linear.multigrid` module) on the next
ones, and fewer of them beyond (`linear.thinning`): what a traction does falls off with the depth, the faster the shorter its
waves.  On a cube of tetrahedra these are a ninth of a hundred thousand unknowns of order 1, a nineteenth of a million, and the
factors grow like those of a surface.  S_X, the compliance operator of X_h, is a lower bound of that of V_h: on tetrahedra of
order 1, S_X <= S <= 1.17 S_X was measured, with a stiffness of the law in both S <= 1.06 S_X.  So a correction from X_h gets
zones and tractions right, whatever the law, and leaves what is linear (`solvers.correction`).
"""

from __future__ import annotations

from copy import copy
from functools import cached_property

import numpy as np
from ngsolve import BaseMatrix, L2

from ...contracts import Array, Inverse
from ...discrete.problem import DiscreteProblem
from ...linear.choice import Direct
from ...linear.cycles import Corners, Galerkin
from ...linear.equations import LinearEquations
from ...linear.factorisations import DirectMemory, Factorised, Operator
from ...linear.motions import WithResultants
from ...linear.multigrid import PartlyContinuous
from ...linear.thinning import Thinned, VertexGraph
from ...mesh.facets import Native
from ...tools import sparse as sp
from ...tools.memory import CheckMemory

EXACT = 1e-15       # relative residual of functions that are in X_h
FINE = 1            # rings of elements around those that touch Gamma_C, on which all functions of W_1 are in X_h


class Subspace(LinearEquations):
    """The contact problem of a discontinuous Discretization for a displacement u_0 + P x, tested with X_h = range(P).

    It takes the place of a Discretization for `NewtonRun`: the same points of Gamma_C and laws there, the trace T P, the matrix
    P' A P, the load P' (f - A u_0), and on Gamma_C the displacement `shift` = T u_0 that is not its own.

    Attributes
    ----------
    prolongation : P, scipy CSR (ndof, unknowns)
    """

    prescribed = 0.0

    def __init__(self, disc: DiscreteProblem) -> None:
        super().__init__()
        self.disc, self.mesh, self.problem, self.order = disc, disc.mesh, disc.problem, disc.order
        self.unresisted, self.resultant = disc.unresisted, disc.resultant
        basis = Basis(disc)
        self.prolongation, self._nodes = basis.prolongation, basis.nodes
        self._restriction = self.prolongation.T.tocsr()
        self.matrix = Native(basis.Reduced(sp.csr_matrix(disc.matrix.CSR(), shape=disc.matrix.shape)))
        self.contact = disc.contact.Within(self.prolongation)
        self._Correct(np.zeros(disc.space.ndof))

    def Moved(self, vector: Array) -> Subspace:
        """The problem in the same X_h that corrects another displacement u_0 in V_h, given by its coefficients (ndof,)."""
        other = copy(self)
        other._Correct(vector)
        return other

    def _Correct(self, vector: Array) -> None:
        self.vector, self.shift = vector, self.disc.contact.Displacement(vector)
        residual = self.disc.load - self.disc.Multiply(vector)
        if self.disc.unresisted and len(self.disc.motions):
            residual = WithResultants(self.disc.motions, residual, self.disc.load)
        self.load = self._restriction @ residual

    @cached_property
    def motions(self) -> Array:
        """Coefficients (m, unknowns) of the rigid motions that A does not resist: all of them are in X_h."""
        from scipy.sparse.linalg import lsqr        # slow to import

        found = [lsqr(self.prolongation, motion, atol=EXACT, btol=EXACT)[0] for motion in self.disc.motions]
        return np.array(found).reshape(-1, self.matrix.height)

    def Whole(self, vector: Array) -> Array:
        """The coefficients of u_0 + P x in V_h, from x."""
        return self.vector + self.prolongation @ vector

    @cached_property
    def inverse(self) -> Inverse:
        return self.Factorise(self.matrix)

    def MakeInverse(self, matrix: BaseMatrix) -> Inverse:
        CheckMemory(DirectMemory(self._nodes, matrix.nze, self.mesh.dim), f"the factors of {matrix.height} unknowns",
                        "a smaller foundation, ")
        # In one thread, like conjugate gradients: others would take longer to begin than one solution takes.
        return Operator(Factorised(matrix, None, Direct(self.mesh.dim), self.mesh.dim))


class Basis:
    """The functions that span X_h.

    Attributes
    ----------
    prolongation : P, scipy CSR (ndof, unknowns): first functions of W_1, then those of V_h
    nodes : vertices and elements that they belong to
    """

    def __init__(self, disc: DiscreteProblem) -> None:
        dim, near = disc.mesh.dim, Near(disc)
        elements, dofs = Corners(L2(disc.mesh, order=disc.order))
        own = np.zeros(disc.space.ndof // dim, dtype=bool)
        own[dofs] = near[elements]
        self._own = np.tile(own, dim)
        continuous = PartlyContinuous(disc.facets, disc.order)
        self._embedding = continuous.Embedding()[:, :dim * len(continuous.vertex)]
        graph = VertexGraph(continuous)
        points = np.array(disc.mesh.ngmesh.Coordinates())[continuous.vertex, :dim]
        fewer = sp.kron(Thinned(points, graph, graph.Around(near, FINE)), sp.identity(dim), format="csc")
        # Functions that are nothing but functions of the elements near Gamma_C would be there twice.
        beyond = np.diff(self._embedding[~self._own].tocsc().indptr) > 0
        self._fewer = fewer[:, np.diff(fewer[beyond].tocsc().indptr) > 0]
        self.nodes = self._fewer.shape[1] // dim + int(near.sum())
        ones = sp.identity(len(self._own), format="csc")[:, self._own]
        self.prolongation = sp.hstack([self._embedding @ self._fewer, ones], format="csr")

    def Reduced(self, matrix: sp.csr_matrix) -> sp.csr_matrix:
        """P' A P, by way of all functions of W_1, of which each knows few others: A itself is read once."""
        rows = matrix[self._own]
        mixed = self._fewer.T @ (rows @ self._embedding).T
        return sp.bmat([[self._fewer.T @ Galerkin(matrix, self._embedding) @ self._fewer, mixed],
                        [mixed.T, rows[:, self._own]]], format="csr")


def Near(disc: DiscreteProblem) -> np.ndarray:
    """True for the elements that have a vertex on Gamma_C, over elements."""
    facets, mesh = disc.facets, disc.mesh
    numbers, _, corners = facets.boundary
    on = facets.On("|".join(foundation.boundary for foundation in disc.problem.foundation))
    touched = np.zeros(mesh.nv + 1, dtype=bool)
    touched[corners[on[numbers]]] = True
    touched[-1] = False     # what fills up
    return touched[facets.vertices].any(axis=1)
