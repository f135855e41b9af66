"""X_h on all ranks: continuous and piecewise linear away from Gamma_C, all of V_h on the elements that touch it."""

from __future__ import annotations

from copy import copy
from typing import Any

import numpy as np

from ..contracts import Array
from ..linear.equations import LinearEquations
from ..tools import sparse as sp
from ..tools.calls import ByKeyword
from .cycle import FactorsInverse
from .petsc import Petsc, Rows
from .rows import Gathered, RowNumbering


@ByKeyword
class DistributedSubspace(LinearEquations):
    """`solvers.newton.subspace.Subspace` of a DistributedProblem: displacements u_0 + P x, solved by the factors of MUMPS."""

    prescribed, unresisted, resultant = 0.0, None, None

    def __init__(self, disc: Any) -> None:
        super().__init__()
        self.disc, self.mesh, self.problem, self.order = disc, disc.mesh, disc.problem, disc.order
        self._prolongation = NearContact(disc)
        self._small, self._large = self._prolongation.createVecRight(), self._prolongation.createVecLeft()
        self.contact = disc.contact.Through(self._Prolonged, self._Restricted)
        self.inverse = self.FactoriseSum(None)
        self._Correct(np.zeros(len(disc.load)))

    @property
    def unknowns(self) -> int:
        return int(self._prolongation.getSize()[1])

    def Moved(self, vector: Array) -> DistributedSubspace:
        """The problem in the same X_h that corrects another displacement u_0."""
        other = copy(self)
        other._Correct(vector)
        return other

    def Whole(self, vector: Array) -> Array:
        """u_0 + P x, from x."""
        return self.vector + self._Prolonged(vector)

    def FactoriseSum(self, added: sp.csr_matrix | None) -> FactorsInverse:
        """The inverse of P' (A + added) P; added scipy, as `ReplicatedContact.Stiffness` has it."""
        return self.Factorise(self.disc.Sum(added).PtAP(self._prolongation))    # type: ignore[return-value]

    def MakeInverse(self, matrix: Any) -> FactorsInverse:
        return FactorsInverse(matrix)

    def ApplyInverse(self, inverse: Any, load: Array) -> Array:
        self.solves += 1
        return inverse.Solve(load)

    def _Correct(self, vector: Array) -> None:
        self.vector, self.shift = vector, self.disc.contact.Displacement(vector)
        self.load = self._Restricted(self.disc.load - self.disc.Multiply(vector))

    def _Prolonged(self, vector: Array) -> Array:
        self._small.setArray(vector)
        self._prolongation.mult(self._small, self._large)
        return self._large.getArray().copy()

    def _Restricted(self, vector: Array) -> Array:
        self._large.setArray(vector)
        self._prolongation.multTranspose(self._large, self._small)
        return self._small.getArray().copy()


def NearContact(disc: Any) -> Any:
    """P as PETSc's matrix; of each rank first the functions of its vertices, then those of its elements near Gamma_C."""
    numbering: RowNumbering = disc.numbering
    local, dim, block = numbering.local, numbering.local.dim, numbering.block
    elements = disc.local.facets.vertices
    corners = disc.local.facets.boundary[2][:, :dim][disc.local.facets.On(disc.contactregions)[disc.local.facets.boundary[0]]]
    near = _Marked(local, corners)[elements].any(axis=1)[numbering.own]
    beyond = _Marked(local, elements[numbering.own][~near])
    nodes, wide = int((beyond & local.ownvertices).sum()), int(near.sum())
    size = dim * nodes + block * wide
    first = local.comm.scan(size) - size
    own = -np.ones(int(local.ownvertices.sum()))
    own[beyond[local.ownvertices]] = first + dim * np.arange(nodes)
    number = Gathered(own, local.vertices, local.comm).astype(np.int64)     # of the first component at each vertex
    embedding = numbering.Embedding().tocoo()
    vertex, component = np.divmod(embedding.col, dim)
    vertex = np.searchsorted(local.vertices, vertex)
    kept = beyond[vertex]
    rows = (np.flatnonzero(near)[:, None] * block + np.arange(block)).ravel()
    columns = first + dim * nodes + np.arange(len(rows))
    entries = np.concatenate([embedding.data[kept], np.ones(len(rows))])
    places = (np.concatenate([embedding.row[kept], rows]), np.concatenate([(number[vertex] + component)[kept], columns]))
    matrix = sp.csr_matrix((entries, places), shape=(numbering.size, int(max(places[1], default=0)) + 1))
    return Rows(matrix, numbering.size, size, local.comm)


def _Marked(local: Any, vertices: np.ndarray) -> np.ndarray:
    """True for the vertices of a local mesh that any rank has among its own."""
    PETSc, chosen = Petsc(), np.unique(vertices)
    marks = PETSc.Vec().createMPI((int(local.ownvertices.sum()), None), comm=local.comm)
    marks.setValues(local.vertices[chosen].astype(PETSc.IntType), np.ones(len(chosen)), addv=True)
    marks.assemble()
    return Gathered(marks.getArray(), local.vertices, local.comm) > 0
