"""Rows of the own elements in one numbering of all ranks: element after element, component after component of its functions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from ngsolve import H1, L2, ConvertOperator

from ..contracts import Array
from ..linear.cycles import Entries
from ..tools import sparse as sp
from .local import LocalMesh
from .petsc import Petsc, Rows

CHUNK = 1 << 21     # entries that are brought into order at a time


class RowNumbering:
    """The dofs of a local vector-valued L2 of order k: dof d na e + na i + a of function a, component i, element e of all.

    Attributes
    ----------
    block : dofs of an element;  own : elements of this rank, (n,)
    dofs : for each entry of a vector of the own elements its dof in the local space;  size : how many
    """

    def __init__(self, local: LocalMesh, order: int) -> None:
        self.local, self.order, ne = local, order, local.mesh.ne
        self.functions = L2(local.mesh, order=order).ndof // ne
        self.block = local.dim * self.functions
        element, component, function = np.indices((ne, local.dim, self.functions))
        self._all = ((component * ne + element) * self.functions + function).ravel()
        self.own = np.flatnonzero(local.own)
        self.dofs = self._all.reshape(ne, -1)[self.own].ravel()
        self.size = len(self.dofs)

    def Matrix(self, matrix: Any) -> Any:
        """PETSc's matrix of blocks of elements, of NGSolve's on the local space, of which the own rows are right."""
        PETSc, dim, functions = Petsc(), self.local.dim, self.functions
        values, columns, starts = (np.asarray(part) for part in matrix.CSR())
        firsts = (np.arange(dim) * self.local.mesh.ne + self.own[:, None]) * functions      # (own, d): rows (i, 0)
        begin = starts[firsts].astype(np.int64)
        count = (starts[firsts[:, 0] + 1] - starts[firsts[:, 0]]).astype(np.int64) // self.block     # elements in a row
        ends = np.cumsum(count)
        # A row is (component, element, function), see `blocks.matrix`.
        place = np.repeat(begin[:, 0] - functions * (ends - count), count) + functions * np.arange(ends[-1] if len(ends) else 0)
        near = columns[place] // functions
        inside = np.add.reduceat(self.local.own[near].astype(np.int64), ends - count) if len(ends) else count
        blocks = PETSc.Mat().createBAIJ(((self.size, None),) * 2, self.block, comm=self.local.comm,
                                        nnz=(inside.astype(PETSc.IntType), (count - inside).astype(PETSc.IntType)))
        blocks.setOption(PETSc.Mat.Option.NO_OFF_PROC_ENTRIES, True)
        number, first = self.local.cells.astype(PETSc.IntType), blocks.getOwnershipRange()[0] // self.block
        for wide in np.unique(count):
            for rows in _Pieces(np.flatnonzero(count == wide), int(wide) * self.block ** 2):
                shape = len(rows), dim, functions, dim, int(wide), functions
                entries = values[begin[rows][:, :, None] + np.arange(functions * int(wide) * self.block)].reshape(shape)
                others = near[(ends - count)[rows][:, None] + np.arange(wide)]
                blocks.setValuesBlockedIJV(np.arange(len(rows) + 1, dtype=PETSc.IntType) * int(wide), number[others].ravel(),
                                           np.moveaxis(entries, 4, 1).ravel(), rowmap=(first + rows).astype(PETSc.IntType))
        blocks.assemble()
        return blocks

    def Added(self, matrix: sp.csr_matrix) -> Any:
        """PETSc's matrix of one that couples the own elements alone, rows and columns as vectors are numbered."""
        return self.OfVectors(matrix, self.block)

    def OfVectors(self, matrix: sp.csr_matrix, block: int) -> Any:
        """PETSc's matrix of one for vectors of the own elements, its rows those of the ranks in their order, in blocks."""
        first = self.local.comm.scan(self.size) - self.size
        rows = len(matrix.indptr) - 1
        shifted = sp.csr_matrix((matrix.data, matrix.indices + first, matrix.indptr), shape=(rows, first + self.size))
        return Rows(shifted, rows, self.size, self.local.comm, (block, self.block))

    def Embedding(self) -> sp.csr_matrix:
        """Own rows of E: V_h from continuous functions of order 1, d j + i component i at vertex j of all, scipy CSR."""
        mesh, dim = self.local.mesh, self.local.dim
        scalar = Entries(ConvertOperator(H1(mesh, order=1), L2(mesh, order=self.order))).tocsr()
        scalar = scalar[(self.own[:, None] * self.functions + np.arange(self.functions)).ravel()].tocoo()
        rows, columns = scalar.row.astype(np.int64), self.local.vertices[scalar.col]
        element, function = np.divmod(rows, self.functions)
        row = np.concatenate([element * self.block + i * self.functions + function for i in range(dim)])
        column = np.concatenate([dim * columns + i for i in range(dim)])
        width = dim * (int(self.local.vertices.max()) + 1)
        return sp.csr_matrix((np.tile(scalar.data, dim), (row, column)), shape=(self.size, width))

    def Everywhere(self, vector: Array) -> Array:
        """Coefficients in the local space, neighbours of other ranks too, of a vector of the own elements."""
        number = (self.local.cells[:, None] * self.block + np.arange(self.block)).ravel()
        local = np.empty(len(self._all))
        local[self._all] = Gathered(vector, number, self.local.comm)
        return local


def _Pieces(rows: np.ndarray, entries: int) -> Iterator[np.ndarray]:
    """Some of the rows after others, so that not all is there twice; entries : of a row."""
    for first in range(0, len(rows), step := max(CHUNK // entries, 1)):
        yield rows[first:first + step]


def Gathered(own: Array, numbers: np.ndarray, comm: Any) -> Array:
    """The entries of these numbers of a vector that is spread over the ranks, given by the own entries."""
    PETSc = Petsc()
    source, target = PETSc.Vec().createWithArray(np.array(own, dtype=float), comm=comm), PETSc.Vec().createSeq(len(numbers))
    wanted = PETSc.IS().createGeneral(numbers.astype(PETSc.IntType), comm=PETSc.COMM_SELF)
    PETSc.Scatter().create(source, wanted, target, None).scatter(source, target)
    return target.getArray().copy()
