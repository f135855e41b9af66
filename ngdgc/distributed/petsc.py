"""PETSc, which only this storey needs, and what ranks have to agree on."""

from __future__ import annotations

from collections.abc import Callable
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
    """The communicator of all ranks, of mpi4py."""
    Petsc()
    from mpi4py import MPI
    return MPI.COMM_WORLD


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


def Rows(matrix: sp.csr_matrix, own: int, columns: int, comm: Any, block: int = 1) -> Any:
    """PETSc's matrix of the rows that each rank owns, scipy CSR with columns in the numbering of all ranks.

    own, columns : rows and columns of this rank;  block : size of the blocks in which it is numbered
    """
    PETSc = Petsc()
    matrix.sort_indices()
    return PETSc.Mat().createAIJ(((own, None), (columns, None)), bsize=block, comm=comm, csr=(
        matrix.indptr.astype(PETSc.IntType), matrix.indices.astype(PETSc.IntType), matrix.data))
