"""Inverses by factorisations, NGSolve's own and those of libraries that it calls."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from ngsolve import BaseMatrix
from ngsolve.la import SparseMatrixd

from ..contracts import Array
from ..mesh.facets import Threads
from ..tools.memory import CheckMemory

LU = 2.5            # memory of an unsymmetric factorisation in units of that of a symmetric one


@dataclass(frozen=True)
class Factorisation:
    """NGSolve's factorisations by their names, an `Inverter`; symmetric : True if they are for symmetric matrices alone."""

    name: str
    symmetric: bool = True
    iterates = False

    def __call__(self, matrix: Any, free: Any, disc: Any) -> Operator:
        """Raises ProblemError, before it is begun, for a factorisation that would not fit into the memory that is free."""
        CheckMemory(FactorMemory(disc) * (1 if self.symmetric else LU), f"the factors of {disc.space.ndof} unknowns",
                    "inverse='iterative', " if disc.symmetric and disc.method.iterative else
                    "a discontinuous method with inverse='iterative', ")
        return Operator(Factorised(matrix, free, self.name, disc.mesh.dim), disc.mesh)


class Operator:
    """What NGSolve makes and applies, such as matrix.Inverse(free), as an `Inverse`.

    mesh : for whose size threads may pay; None: one thread
    """

    def __init__(self, operator: Any, mesh: Any = None) -> None:
        self.operator, self.mesh = operator, mesh

    def Solve(self, load: Array) -> Array:
        source, target = self.operator.CreateRowVector(), self.operator.CreateColVector()
        source.FV().NumPy()[:] = load
        with Threads(self.mesh) if self.mesh else nullcontext():
            target.data = self.operator * source
        return target.FV().NumPy().copy()


def Factorised(matrix: BaseMatrix, freedofs: Any, kind: str, dim: int) -> BaseMatrix:
    """NGSolve's factorisation of a matrix on the free dofs."""
    if kind == "pardisospd":
        # That the matrix is symmetric has to be said.  Nested dissection fills less in 3D, minimum degree in 2D.
        matrix.inverse_flags = {"symmetric": True, "ordering": "metis" if dim == 3 else "minimum_degree"}
    return matrix.Inverse(freedofs, inverse=kind)


@cache
def HasPardiso() -> bool:
    """True if MKL's Pardiso can be used: NGSolve lists it even where it is missing.

    Before 6.2.2608 NGSolve's matrices have no flags, and that they are symmetric cannot be said.
    """
    try:
        Factorised(SparseMatrixd.CreateFromCOO([0], [0], [1.0], 1, 1), None, "pardisospd", 2)
    except (AttributeError, RuntimeError):
        return False
    return True


def FactorMemory(disc: Any) -> float:
    """Bytes of the Cholesky factors of a Discretization's matrix, estimated."""
    # Unknowns of neighbouring elements, or of neighbouring vertices, are eliminated together.
    nodes = disc.mesh.ne if disc.method.discontinuous else disc.mesh.nv
    return DirectMemory(nodes, disc.matrix.nze, disc.mesh.dim)


def DirectMemory(elements: int, entries: int, dim: int) -> int:
    """Bytes that the sparse Cholesky factorisation of a matrix needs at its peak, from its elements and entries (nnz).

    Nested dissection (George 1973): separators of about elements^(2/3) in 3D, elements^(1/2) in 2D, so
    11 entries elements^(1/3) and 4 entries log2(elements) bytes.  The factors were measured as the growth of the resident
    memory while NGSolve's sparsecholesky works, for orders 1 to 3, tetrahedra, hexahedra, triangles and quads, IP and LDG:
    between 4 and 11 in 3D, 2 and 4 in 2D, the larger ones at the larger sizes, which are those that matter.
    """
    return int(entries * (11 * elements ** (1 / 3) if dim == 3 else 4 * np.log2(max(elements, 2))))
