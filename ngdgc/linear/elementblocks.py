"""Symmetric matrices of discontinuous spaces as dense blocks of elements, split for Gauss-Seidel over elements.

With the dofs in the order of the elements A = L + D + L', D block diagonal and L below it.  From x = 0 one sweep leaves

    (D + L) x = b,                      b - A x = -L' x,

and one backwards, after x has been corrected, gives z with r = b - L x

    (D + L') z = r,                     A z = r + L z,

so that a symmetric cycle and the product of A with its result read A two and a half times, where smoother, residual, smoother
and product would each read all of it.  One thread reads blocks at the speed of the memory.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from ngsolve import BaseMatrix, FESpace

from ..contracts import Array
from ..tools import sparse as sp
from .cycles import Corners

CHUNK = 1 << 22     # entries of A that are brought into order at a time


class ElementOrder:
    """The dofs of a vector-valued discontinuous space element after element, each with as many as the largest has.

    scalar : the space of one component;  dim : components

    Attributes
    ----------
    block : dofs of an element;  length : those of all, (length,) are the vectors in this order
    place : where each dof of the space goes, (ndof,)
    """

    def __init__(self, scalar: FESpace, dim: int) -> None:
        elements, dofs = Corners(scalar)
        counts = np.bincount(elements)
        most = int(counts.max())
        self.block, self.length = dim * most, dim * most * len(counts)
        first = self.block * elements + np.arange(len(dofs)) - (np.cumsum(counts) - counts)[elements]
        self.place = np.empty(dim * len(dofs), dtype=np.int64)
        for i in range(dim):
            self.place[i * len(dofs) + dofs] = first + i * most

    def To(self, vector: Array) -> Array:
        """A vector (ndof,) in this order, 0 where no dof is."""
        ordered = np.zeros(self.length)
        ordered[self.place] = vector
        return ordered

    def From(self, ordered: Array) -> Array:
        """The vector (ndof,) of one in this order."""
        return ordered[self.place]

    def Rows(self, matrix: sp.csr_matrix) -> sp.csr_matrix:
        """A scipy matrix whose rows belong to the space, its rows in this order, CSR."""
        entries = matrix.tocoo()
        return sp.csr_matrix((entries.data, (self.place[entries.row], entries.col)), shape=(self.length, matrix.shape[1]))


class ElementBlocks:
    """NGSolve's symmetric A in an `ElementOrder`: its products and the sweeps over elements, for vectors in this order."""

    def __init__(self, matrix: BaseMatrix, order: ElementOrder) -> None:
        self.order, elements = order, order.length // order.block
        pieces = list(_Pieces(matrix, order))
        self.lower, self.diagonal, self.upper = (_Joined([piece.pop(0) for piece in pieces], order) for _ in range(3))
        blocks = self.diagonal.data
        filled = np.setdiff1d(np.arange(order.length), order.place)
        blocks[filled // order.block, filled % order.block, filled % order.block] = 1
        try:
            self._inverses = np.linalg.inv(blocks).ravel()
        except np.linalg.LinAlgError:       # of a matrix that is not definite, as conjugate gradients will find out
            self._inverses = np.linalg.pinv(blocks, hermitian=True).ravel()
        self._forwards, self._backwards = (0, elements, 1), (elements - 1, -1, -1)

    def Product(self, x: Array) -> Array:
        """A x."""
        return self.lower @ x + self.diagonal @ x + self.upper @ x

    def Forwards(self, b: Array) -> Array:
        """(D + L)^-1 b."""
        return self._Sweep(self.lower, b, self._forwards)

    def Backwards(self, b: Array) -> Array:
        """(D + L')^-1 b."""
        return self._Sweep(self.upper, b, self._backwards)

    def _Sweep(self, part: sp.bsr_matrix, b: Array, rows: tuple[int, int, int]) -> Array:
        from pyamg.amg_core import block_gauss_seidel   # slow to import

        x = np.zeros_like(b)
        block_gauss_seidel(part.indptr, part.indices, part.data.ravel(), x, b, self._inverses, *rows, self.order.block)
        return x


def _Pieces(matrix: BaseMatrix, order: ElementOrder) -> Iterator[list[sp.bsr_matrix]]:
    """Some block rows of L, D and L' after others: as little as can be is there twice."""
    entries = sp.csr_matrix(matrix.CSR(), shape=matrix.shape)
    source = np.full(order.length, -1)
    source[order.place] = np.arange(len(order.place))
    step = max(CHUNK * order.length // (order.block * max(entries.nnz, 1)), 1) * order.block
    for first in range(0, order.length, step):
        rows = source[first:first + step]
        some = entries[rows[rows >= 0]]
        starts = np.zeros(len(rows) + 1, dtype=some.indptr.dtype)
        np.cumsum(rows >= 0, out=starts[1:])
        ordered = sp.csr_matrix((some.data, order.place[some.indices], some.indptr[starts]), shape=(len(rows), order.length))
        blocks = ordered.tobsr((order.block, order.block))
        blocks.sort_indices()
        row = np.repeat(np.arange(len(rows) // order.block), np.diff(blocks.indptr))
        side = np.sign(blocks.indices - row - first // order.block)
        yield [_Some(blocks, row, side == which) for which in (-1, 0, 1)]


def _Some(blocks: sp.bsr_matrix, row: np.ndarray, kept: np.ndarray) -> sp.bsr_matrix:
    starts = np.searchsorted(row[kept], np.arange(len(blocks.indptr)))
    return sp.bsr_matrix((blocks.data[kept], blocks.indices[kept], starts), shape=blocks.shape)


def _Joined(pieces: list[sp.bsr_matrix], order: ElementOrder) -> sp.bsr_matrix:
    """One matrix of block rows."""
    ends = np.cumsum([0] + [len(piece.data) for piece in pieces])
    starts = [end + piece.indptr[:-1] for end, piece in zip(ends, pieces)]
    return sp.bsr_matrix((np.concatenate([piece.data for piece in pieces]), np.concatenate([piece.indices for piece in pieces]),
                          np.concatenate([*starts, ends[-1:]])), shape=(order.length, order.length))
