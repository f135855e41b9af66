"""Inverses of users: they get loads of their own, and what they return is looked at before it is used."""

from __future__ import annotations

from typing import Any
from zlib import crc32

import numpy as np
from ngsolve import BitArray

from ..contracts import Array, Inverter
from ..exceptions import ProblemError
from ..mesh.facets import Free, Threads
from ..tools import sparse as sp
from ..tools.kinds import Short
from ..tools.names import NameOf

ACCURATE = 1e-10    # residual of one solution relative to its load, at most
ROUNDOFF = 1e3 * np.finfo(float).eps    # the same relative to |diag(A) x|, what pivots let grow


def Made(inverter: Inverter, matrix: Any, disc: Any) -> Any:
    """What an Inverter makes of a matrix of a Discretization; an `OutsideInverse` unless the Inverter is the package's own.

    Raises ProblemError if it raises another error, if it changes the matrix, which is that of the problem, or if what it makes
    is no `contracts.Inverse`.
    """
    free = BitArray(disc.space.FreeDofs())      # a copy: the space itself has the other one
    if type(inverter).__module__.startswith(f"{__package__}."):
        return inverter(matrix, free, disc)
    name, iterates = NameOf(inverter), bool(getattr(inverter, "iterates", False))
    before = _Mark(matrix)
    try:
        inverse = inverter(matrix, free, disc)
    except ProblemError:
        raise
    except Exception as error:
        raise ProblemError(f"inverse={name} raises {type(error).__name__} ({error}); it is called with NGSolve's matrix, its "
                           "free dofs and the Discretization, and must return an object with Solve(load); mend it") from error
    if _Mark(matrix) != before:
        raise ProblemError(f"inverse={name} changes the matrix that it is given, which is that of the problem; work on a copy")
    for member in ("Solve", "iterations") if iterates else ("Solve",):
        if not hasattr(inverse, member):
            raise ProblemError(f"inverse={name} makes {Short(inverse)}, which has no {member}; return an object as "
                               f"contracts.{'InexactInverse' if iterates else 'Inverse'} describes it")
    return OutsideInverse(name, inverse, matrix, disc)


def _Mark(matrix: Any) -> int:
    """A number that tells the entries of an NGSolve matrix from others."""
    return crc32(matrix.AsVector().FV().NumPy())


class OutsideInverse:
    """An Inverse from outside: every solution is a float array (ndof,) of its own that solves A x = b; else ProblemError."""

    def __init__(self, name: str, inverse: Any, matrix: Any, disc: Any) -> None:
        self.name, self.inverse, self.matrix, self.mesh = name, inverse, matrix, disc.mesh
        self.free = Free(disc.space)
        self.diagonal = sp.csr_matrix(matrix.CSR(), shape=matrix.shape).diagonal()

    @property
    def iterations(self) -> int:
        return self.inverse.iterations

    def Solve(self, load: Array, *, tol: float = ACCURATE, **start: Array) -> Array:
        """A^-1 load; tol, and start (ndof,), for those that iterate."""
        vector = self.Unchecked(load, tol=tol, **start)
        self._Check(f"inverse={self.name}: Solve", vector, load, max(tol, ACCURATE))
        return vector

    def Unchecked(self, load: Array, *, tol: float = ACCURATE, **start: Array) -> Array:
        """The same, of the right shape at least."""
        words = f"inverse={self.name}: Solve"
        options = {"tol": tol, **{name: vector.copy() for name, vector in start.items()}} if start else {}
        try:
            vector = self.inverse.Solve(load.copy(), **options)
        except ProblemError:
            raise
        except Exception as error:
            raise ProblemError(f"{words} raises {type(error).__name__} ({error}); it is called with an array (ndof,) and must "
                               "return one; mend it") from error
        found = np.asarray(vector)
        if found.dtype.kind not in "fiu" or found.shape != load.shape:
            raise ProblemError(f"{words} returns shape {found.shape} of type {found.dtype}; give real numbers, an array "
                               f"{load.shape}, zero at the dofs that are not free")
        return np.array(found, dtype=float)

    def _Check(self, words: str, vector: Array, load: Array, tol: float) -> None:
        if not np.all(np.isfinite(vector)):
            raise ProblemError(f"{words} returns numbers that are not finite; look for a matrix that is singular, or one "
                               "that it was not made for, or take inverse='auto'")
        if np.any(vector[~self.free]):
            raise ProblemError(f"{words} returns values at dofs that are not free; make them 0, the matrix counts on free dofs "
                               "alone")
        source, target = self.matrix.CreateColVector(), self.matrix.CreateRowVector()
        source.FV().NumPy()[:] = vector
        with Threads(self.mesh):
            target.data = self.matrix * source
        residual = np.linalg.norm((target.FV().NumPy() - load)[self.free])
        size = np.linalg.norm(load[self.free])
        if not residual <= max(2 * tol * size, ROUNDOFF * np.linalg.norm(self.diagonal * vector)):
            raise ProblemError(f"{words} returns x with |A x - b| = {residual / (size or 1):.1e} |b|, A x = b is to hold to "
                               f"{tol:.0e} on the free dofs; solve more accurately, or take inverse='auto'")
