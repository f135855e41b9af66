"""X_h on all ranks: continuous and piecewise linear away from Gamma_C, all of V_h on the elements that touch it."""

from __future__ import annotations

from copy import copy
from typing import Any

import numpy as np

from ..contracts import Array
from ..linear.equations import LinearEquations
from ..tools import sparse as sp
from ..tools.calls import ByKeyword
from .cycle import CycleInverse, FactorsInverse
from .petsc import Applied, Petsc, Plus, Rows, TripleProduct
from .rows import Gathered, RowNumbering

FACTORISED = 150_000        # unknowns of X_h up to which its factors take less time than conjugate gradients


@ByKeyword
class DistributedSubspace(LinearEquations):
    """`solvers.newton.subspace.Subspace` of a DistributedProblem: displacements u_0 + P x.

    It is solved by the factors of MUMPS, where there are more than FACTORISED unknowns by conjugate gradients.
    """

    prescribed, unresisted, resultant = 0.0, None, None

    def __init__(self, disc: Any) -> None:
        super().__init__()
        self.disc, self.mesh, self.problem, self.order = disc, disc.mesh, disc.problem, disc.order
        self._prolongation, self._embedding, self.matrix = disc.reduced
        self._Prolong, self._Restrict = Applied(self._prolongation), Applied(self._prolongation, transposed=True)
        # As products with P itself, which is as long as V_h, they would take most of the time.
        trace = disc.numbering.OfVectors(disc.contact.trace, self.mesh.dim).matMult(self._prolongation)
        self.contact = disc.contact.Through(Applied(trace), Applied(trace, transposed=True))
        self.inverse = self.Factorise(None)
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
        return self.vector + self._Prolong(vector)

    def FactoriseSum(self, added: sp.csr_matrix) -> Any:
        """The inverse of P' (A + added) P; added scipy, as `ReplicatedContact.Stiffness` has it."""
        return self.Factorise(self.disc.numbering.Added(added))

    def MakeInverse(self, matrix: Any) -> FactorsInverse | CycleInverse:
        """That of P' A P and PETSc's matrix on V_h, or None, that is added to A."""
        whole = self.matrix if matrix is None else Plus(self.matrix, TripleProduct(matrix, self._prolongation))
        if self.unknowns <= FACTORISED:
            return FactorsInverse(whole)
        return CycleInverse(whole, self.disc.Continuous(matrix), self._embedding)

    def ApplyInverse(self, inverse: Any, load: Array) -> Array:
        self.solves += 1
        return inverse.Solve(load)

    def _Correct(self, vector: Array) -> None:
        self.vector, self.shift = vector, self.disc.contact.Displacement(vector)
        self.load = self._Restrict(self.disc.load - self.disc.Multiply(vector))


def NearContact(disc: Any) -> tuple[Any, Any]:
    """P, and Q with E = P Q from continuous functions of order 1 to X_h, PETSc's matrices.

    Of each rank first the functions of its vertices, then those of its elements near Gamma_C.
    """
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
    place = np.zeros(numbering.size, dtype=np.int64)        # in X_h, of this rank
    place[rows] = inside = dim * nodes + np.arange(len(rows))
    prolongation = _Entries((embedding.data[kept], embedding.row[kept], (number[vertex] + component)[kept]),
                            (np.ones(len(rows)), rows, first + inside), numbering.size)
    corner = (dim * local.vertices[beyond & local.ownvertices][:, None] + np.arange(dim)).ravel()
    rest = ~kept & near[embedding.row // block]
    restored = _Entries((np.ones(len(corner)), np.arange(len(corner)), corner),
                        (embedding.data[rest], place[embedding.row[rest]], embedding.col[rest]), size)
    vertices = dim * int(local.ownvertices.sum())
    return (Rows(prolongation, numbering.size, size, local.comm, (block, dim)),
            Rows(restored, size, vertices, local.comm, (dim, dim)))


def _Entries(some: tuple[Any, ...], others: tuple[Any, ...], height: int) -> sp.csr_matrix:
    """The matrix of two sets of (values, rows, columns)."""
    values, rows, columns = (np.concatenate(parts) for parts in zip(some, others))
    return sp.csr_matrix((values, (rows, columns)), shape=(height, int(columns.max(initial=0)) + 1))


def _Marked(local: Any, vertices: np.ndarray) -> np.ndarray:
    """True for the vertices of a local mesh that any rank has among its own."""
    PETSc, chosen = Petsc(), np.unique(vertices)
    marks = PETSc.Vec().createMPI((int(local.ownvertices.sum()), None), comm=local.comm)
    marks.setValues(local.vertices[chosen].astype(PETSc.IntType), np.ones(len(chosen)), addv=True)
    marks.assemble()
    return Gathered(marks.getArray(), local.vertices, local.comm) > 0
