"""PETSc, which only this storey needs, and what ranks have to agree on."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable
from types import TracebackType
from typing import Any, TypeVar

import numpy as np

from ..contracts import Array
from ..exceptions import ProblemError
from ..tools import sparse as sp

Result = TypeVar("Result")


def Petsc() -> Any:
    """The module petsc4py.PETSc; ProblemError where it is not installed."""
    try:
        from petsc4py import PETSc
    except ImportError as error:
        raise ProblemError("DistributedMesh needs petsc4py and mpi4py, which are not installed here; see the page 'Beyond one "
                           "machine', or take an ngsolve.Mesh") from error
    return PETSc


def World() -> Any:
    """The communicator of all ranks, of mpi4py; from now on an error that nobody catches on one of them ends all.

    `-m mpi4py` would do that as well, but only at the end of the process, where PETSc waits for the other ranks before.
    """
    Petsc()
    from mpi4py import MPI
    if MPI.COMM_WORLD.size > 1:
        sys.excepthook = _EndAll
    return MPI.COMM_WORLD


def _EndAll(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    sys.__excepthook__(kind, error, trace)
    sys.stderr.flush()
    World().Abort(1)


def OnFirst(comm: Any, Ask: Callable[[], Result]) -> Result:
    """What rank 0 alone computes, on all ranks; its ProblemError is raised by all of them."""
    cause: ProblemError | None = None
    answer: tuple[str | None, Any] = None, None
    if comm.rank == 0:
        try:
            answer = None, Ask()
        except ProblemError as error:
            cause, answer = error, (str(error), None)
    words, result = comm.bcast(answer)
    if words is not None:
        raise ProblemError(words) from cause
    return result


def OnAll(comm: Any, Ask: Callable[[], Result]) -> Result:
    """What every rank computes by itself; the first ProblemError among them is raised by all of them."""
    cause, result = None, None
    try:
        result = Ask()
    except ProblemError as error:
        cause = error
    for words in comm.allgather(cause and str(cause)):
        if words is not None:
            raise ProblemError(words) from cause
    return result   # type: ignore[return-value]


def Largest(comm: Any, value: float) -> float:
    """Of all ranks."""
    from mpi4py import MPI
    return float(comm.allreduce(float(value), op=MPI.MAX))


def Summed(comm: Any, values: Array) -> Array:
    """Arrays of one shape, added over the ranks."""
    total = np.array(values, dtype=float)
    from mpi4py import MPI
    comm.Allreduce(MPI.IN_PLACE, total, op=MPI.SUM)
    return total


def Rows(matrix: sp.csr_matrix, own: int, columns: int, comm: Any, blocks: tuple[int, int]) -> Any:
    """PETSc's matrix of the rows that each rank owns, scipy CSR with columns in the numbering of all ranks.

    own, columns : rows and columns of this rank;  blocks : how many rows, and columns, belong together
    """
    PETSc = Petsc()
    matrix.sort_indices()
    return PETSc.Mat().createAIJ(((own, None), (columns, None)), bsize=blocks, comm=comm, csr=(
        matrix.indptr.astype(PETSc.IntType), matrix.indices.astype(PETSc.IntType), matrix.data))


def TripleProduct(matrix: Any, embedding: Any) -> Any:
    """E' A E, PETSc's; A may be one of blocks, which PETSc has no such product of: it is there as rows for that long."""
    rows = AsRows(matrix)
    product = rows.PtAP(embedding)
    alone = product.copy()      # a product keeps its factors
    product.destroy()
    if rows is not matrix:
        rows.destroy()
        GiveBack()
    return alone


def Plus(matrix: Any, added: Any) -> Any:
    """PETSc's matrix A + B of the type of A, which has all entries of B."""
    rows = AsRows(matrix)
    total = matrix.copy() if rows is matrix else rows
    total.axpy(1.0, added, Petsc().Mat.Structure.SUBSET)
    if rows is matrix:
        return total
    blocks = total.convert(matrix.getType(), Petsc().Mat())     # a copy of blocks would know no Gauss-Seidel
    total.destroy()
    GiveBack()
    return blocks


def GiveBack() -> None:
    """Let go of PETSc's objects that nobody has any more, which only all ranks together can, and of memory that is free.

    Otherwise petsc4py keeps those for ever, and each library for itself what only one needs at a time.
    """
    Petsc().garbage_cleanup()
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)


def AsRows(matrix: Any) -> Any:
    """PETSc's matrix itself, or if it is one of blocks the same by rows."""
    return matrix.convert(Petsc().Mat.Type.AIJ, Petsc().Mat()) if "baij" in matrix.getType() else matrix


class Applied:
    """The products of PETSc's matrix with vectors of which every rank has its own entries."""

    def __init__(self, matrix: Any, *, transposed: bool = False) -> None:
        self._source, self._target = matrix.createVecs()
        self._Multiply = matrix.mult
        if transposed:
            self._Multiply, self._source, self._target = matrix.multTranspose, self._target, self._source

    def __call__(self, vector: Array) -> Array:
        self._source.setArray(vector)
        self._Multiply(self._source, self._target)
        return self._target.getArray().copy()
