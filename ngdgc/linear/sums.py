"""The sum of NGSolve's matrix and a few entries, such as those of Gamma_C."""

from __future__ import annotations

import numpy as np
from ngsolve.la import BaseMatrix

from ..mesh.facets import Csr, Native
from ..tools import sparse as sp


def Sum(matrix: BaseMatrix, added: sp.csr_matrix) -> BaseMatrix:
    """Another matrix, the sum of NGSolve's and scipy's; without sorting where the first one has all entries of the second."""
    positions = _Positions(matrix, added)
    if positions is None:
        return Native(Csr(matrix) + added)
    # In a matrix of its own: another thread, or an inverse that is an iteration, goes on using the first one.
    total = matrix.CreateMatrix()
    total.AsVector().data = matrix.AsVector()
    total.AsVector().FV().NumPy()[positions] += added.data
    return total


def _Positions(matrix: BaseMatrix, added: sp.csr_matrix) -> np.ndarray | None:
    """Where among the entries of an NGSolve matrix those of a CSR matrix are, or None."""
    _, columns, starts = (np.asarray(part) for part in matrix.CSR())
    positions = np.empty(added.nnz, dtype=np.int64)
    for row in np.flatnonzero(np.diff(added.indptr)):
        here, first = slice(*added.indptr[row:row + 2]), starts[row]
        own = columns[first:starts[row + 1]]
        found = np.searchsorted(own, added.indices[here])
        if not np.array_equal(own[np.minimum(found, len(own) - 1)], added.indices[here]):
            return None
        positions[here] = first + found
    return positions
