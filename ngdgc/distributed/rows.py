"""Rows of the own elements in one numbering of all ranks: element after element, component after component of its functions."""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import H1, L2, ConvertOperator

from ..contracts import Array
from ..linear.cycles import Entries
from ..mesh.facets import Csr
from ..tools import sparse as sp
from .local import LocalMesh
from .petsc import Petsc, Rows


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
        """PETSc's matrix of a matrix on the local space, NGSolve's or scipy's, of which the own rows are right."""
        rows = (matrix if sp.issparse(matrix) else Csr(matrix))[self.dofs][:, self._all].tocsr()
        number = (self.local.cells[:, None] * self.block + np.arange(self.block)).ravel()
        rows = sp.csr_matrix((rows.data, number[rows.indices], rows.indptr), shape=(self.size, int(number.max()) + 1))
        return Rows(rows, self.size, self.size, self.local.comm, self.block)

    def Added(self, matrix: sp.csr_matrix, first: int) -> Any:
        """PETSc's matrix of one that couples the own elements alone, numbered as vectors are from their `first` row on."""
        shifted = sp.csr_matrix((matrix.data, matrix.indices + first, matrix.indptr),
                                shape=(self.size, first + self.size))
        return Rows(shifted, self.size, self.size, self.local.comm, self.block)

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


def Gathered(own: Array, numbers: np.ndarray, comm: Any) -> Array:
    """The entries of these numbers of a vector that is spread over the ranks, given by the own entries."""
    PETSc = Petsc()
    source, target = PETSc.Vec().createWithArray(np.array(own, dtype=float), comm=comm), PETSc.Vec().createSeq(len(numbers))
    wanted = PETSc.IS().createGeneral(numbers.astype(PETSc.IntType), comm=PETSc.COMM_SELF)
    PETSc.Scatter().create(source, wanted, target, None).scatter(source, target)
    return target.getArray().copy()
