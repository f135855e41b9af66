"""NGSolve's sparse matrix of a broken space, filled from batches of dense blocks.

NGSolve numbers the dofs of a vector L2 space component by component, and in one component element by element.  The row of dof
(k, element, a) therefore has, for each component, the blocks of the element's neighbours side by side, by element number:

    dof (k, element, a) = k starts[-1] + starts[element] + a;   a row is  (component, neighbour, function)
"""

from __future__ import annotations

import numpy as np
from ngsolve import BaseMatrix, BilinearForm, FESpace, L2

from ..contracts import Array
from ..exceptions import ProblemError
from ..tools import sparse as sp


def Numbers(starts: np.ndarray, patches: np.ndarray, dim: int) -> np.ndarray:
    """Dofs (n, v), v = (k e a), on patches (n, e) of elements or facets, of sizes that are the same in all rows."""
    sizes = np.diff(starts)[patches[0]]                                             # e
    slot = np.tile(np.repeat(np.arange(len(sizes)), sizes), dim)                    # v -> e
    within = np.tile(np.concatenate([np.arange(size) for size in sizes]), dim)      # v -> a
    return np.repeat(np.arange(dim), sizes.sum()) * starts[-1] + starts[patches[:, slot]] + within


class BlockMatrix:
    """A native sparse matrix on a vector L2 space, with full blocks for pairs of elements, to be filled by `Add`.

    space : VectorL2(dgjumps=True);  starts (ne + 1,) : scalar dofs of element e are starts[e] ... starts[e+1]-1
    neighbours : sparse (ne, ne), pairs of elements across a facet
    reach : 1 for blocks of neighbours, 2 for blocks of neighbours of neighbours as well
    """

    def __init__(self, space: FESpace, starts: np.ndarray, neighbours: sp.csr_matrix, reach: int) -> None:
        self.starts, self.dim = starts, space.mesh.dim
        self.native = _Neighbours(space=space) if reach == 1 else _NeighboursOfNeighbours(space)
        graph = (neighbours != 0).astype(np.int32) + sp.identity(neighbours.shape[0], dtype=np.int32, format="csr")
        if reach == 2:
            graph = graph @ graph
        graph.sort_indices()
        self._values, _, rows = (np.asarray(part) for part in self.native.CSR())
        self._rows = rows.astype(np.int64)
        sizes = np.diff(starts)
        self._keys = np.repeat(np.arange(len(sizes)), np.diff(graph.indptr)) * len(sizes) + graph.indices
        # Scalar columns that precede a block in the rows of its element, which are sorted.
        before = np.concatenate([[0], np.cumsum(sizes[graph.indices])])
        self._offsets = before[:-1] - np.repeat(before[graph.indptr[:-1]], np.diff(graph.indptr))
        self._width = before[graph.indptr[1:]] - before[graph.indptr[:-1]]
        if self._width @ sizes * self.dim ** 2 != self.native.nze:
            raise ProblemError("NGSolve's matrix has another pattern than the elements' neighbours; take "
                               "assembly='skeleton', which leaves it to NGSolve")

    def _Offsets(self, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Scalar columns before the block of element `columns` in the rows of element `rows`, arrays of one shape."""
        return self._offsets[np.searchsorted(self._keys, (rows * (len(self.starts) - 1) + columns).ravel())].reshape(rows.shape)

    def Put(self, rows: np.ndarray, columns: np.ndarray, blocks: Array, *, add: bool = False) -> None:
        """Set blocks (n, (i a), (k b)), or add to them, of distinct pairs of elements (rows, columns); faster than `Add`.

        For one i a block is runs (a k) of `width` values b, each of which begins `length` after the one before: the matrix row
        of (i, a) consists of dim stretches k of this length, and that of (i, a + 1) follows.
        """
        height, width = (int(self.starts[one[0] + 1] - self.starts[one[0]]) for one in (rows, columns))     # of a, of b
        first = self._rows[self.starts[rows][:, None] + np.arange(self.dim) * self.starts[-1]]      # n i, begin of row (i, 0)
        first += self._Offsets(rows, columns)[:, None]
        blocks = blocks.reshape(len(rows), self.dim, height * self.dim, width)                      # n i (a k) b
        # All positions of such windows on the values, of which `first` chooses.
        lengths = self._width[rows]
        for length in np.unique(lengths):
            members = slice(None) if np.all(lengths == length) else lengths == length
            shape = len(self._values) - (height * self.dim - 1) * length - width + 1, height * self.dim, width
            (step,) = self._values.strides
            windows = np.lib.stride_tricks.as_strided(self._values, shape, (step, int(length) * step, step))
            if add:
                windows[first[members]] += blocks[members]
            else:
                windows[first[members]] = blocks[members]

    def Add(self, elements: np.ndarray, blocks: Array) -> None:
        """Add blocks (n, v, v), v = (k e a), of the displacements on patches of elements (n, e)."""
        sizes = np.diff(self.starts)[elements[0]]                                           # e
        slot = np.tile(np.repeat(np.arange(len(sizes)), sizes), self.dim)                   # v -> e
        within = np.tile(np.concatenate([np.arange(size) for size in sizes]), self.dim)     # v -> a
        component = np.repeat(np.arange(self.dim), sizes.sum())                             # v -> k
        offsets = self._Offsets(*np.broadcast_arrays(elements[:, :, None], elements[:, None, :]))   # n e e
        dofs = Numbers(self.starts, elements, self.dim)                                     # n v
        # Position of the entry: start of the row, columns of lower components, columns of lower elements, column in the block.
        row = self._rows[dofs]
        column = offsets[:, slot[:, None], slot] + within       # n v v
        column += component * self._width[elements[:, slot]][:, :, None]
        column += row[:, :, None]
        np.add.at(self._values, column.ravel(), blocks.ravel())


def _Neighbours(**spaces: FESpace) -> BaseMatrix:
    """A native matrix of zeros with full blocks for pairs of elements across a facet; the spaces have dgjumps=True."""
    return BilinearForm(**spaces, check_unused=False).Assemble().mat


def _NeighboursOfNeighbours(space: FESpace) -> BaseMatrix:
    """The same for neighbours of neighbours as well: a small product, since one row per element stands for all in between."""
    elements = L2(space.mesh, order=0, dgjumps=True)
    return _Neighbours(trialspace=elements, testspace=space) @ _Neighbours(trialspace=space, testspace=elements)
