"""Linear equations of a body: a matrix, its inverse, and what they have cost."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from threading import RLock
from typing import Any

import numpy as np

from ..contracts import Array, Inverse, InexactInverse
from ..exceptions import ProblemError
from ..mesh.facets import Threads
from ..tools import sparse as sp
from ..tools.calls import ByKeyword
from ..tools.kinds import Short
from .sums import Sum


@ByKeyword
class LinearEquations(ABC):
    """A x = b with symmetric or unsymmetric sparse matrices on one space, solved by what `MakeInverse` makes.

    Who inherits has `mesh`, and `matrix`, NGSolve's A.

    Attributes
    ----------
    solves : how often an inverse was applied;  factorisation : seconds that factorisations, or preconditioners, took
    cycles : steps of conjugate gradients in `Iterate`
    lock : held while an inverse is made or applied, and by a solver for all its run: threads wait for each other
    """

    mesh: Any
    matrix: Any
    result: Any = None      # what makes a solution of a problem; None: ContactSolution
    alone = False           # True: no other mesh predicts for a problem, and an iteration that is stopped leaves no solution

    def __init__(self) -> None:
        self.solves, self.factorisation, self.cycles = 0, 0.0, 0
        self.lock = RLock()

    @abstractmethod
    def MakeInverse(self, matrix: Any) -> Inverse:
        """The inverse of a matrix on the free dofs, which nobody counts."""

    def Factorise(self, matrix: Any) -> Inverse:
        """The inverse of a matrix on the free dofs; symmetric if A is."""
        with self.lock, Threads(self.mesh):
            start = time.perf_counter()
            inverse = self.MakeInverse(matrix)
            self.factorisation += time.perf_counter() - start
        return inverse

    def FactoriseSum(self, added: sp.csr_matrix) -> Inverse:
        """The inverse of A and a few entries more, scipy CSR, such as those of Gamma_C."""
        if not sp.issparse(added) or added.shape != (self.matrix.height, self.matrix.width):
            raise ProblemError(f"what is added to the matrix is {Short(added)}; give a sparse matrix of scipy of the shape "
                               f"{(self.matrix.height, self.matrix.width)}, such as contact.Stiffness returns")
        with Threads(self.mesh):
            return self.Factorise(Sum(self.matrix, added))

    @property
    def unknowns(self) -> int:
        """The number of equations."""
        return int(self.matrix.height)

    @property
    def diagonal(self) -> Array:
        """That of A, (ndof,)."""
        return np.asarray(sp.csr_matrix(self.matrix.CSR(), shape=self.matrix.shape).diagonal())

    def Norm(self, vector: Array) -> float:
        """The Euclidean norm of coefficients, or of some of them."""
        return float(np.linalg.norm(vector))

    def Product(self, one: Array, other: Array) -> float:
        """That of two vectors of coefficients."""
        self._CheckShape(one)
        self._CheckShape(other)
        return float(one @ other)

    def Multiply(self, vector: Array) -> Array:
        """A x, (ndof,) -> (ndof,)."""
        self._CheckShape(vector)
        source, target = self.matrix.CreateColVector(), self.matrix.CreateRowVector()
        source.FV().NumPy()[:] = vector
        with Threads(self.mesh):
            target.data = self.matrix * source
        return target.FV().NumPy().copy()

    def ApplyInverse(self, inverse: Inverse, load: Array) -> Array:
        """An inverse of `Factorise` times a load, (ndof,) -> (ndof,), counted in `solves`."""
        self._CheckShape(load)
        with self.lock:
            self.solves += 1
            return inverse.Solve(load)

    def Iterate(self, inverse: InexactInverse, load: Array, *, tol: float, start: Array) -> Array:
        """The same from a start (ndof,) and to a tolerance."""
        with self.lock:
            before = inverse.iterations
            vector = inverse.Solve(load, tol=tol, start=start)
            self.solves, self.cycles = self.solves + 1, self.cycles + inverse.iterations - before
            return vector

    def _CheckShape(self, vector: Array) -> None:
        if np.shape(vector) != (self.matrix.width,):
            raise ProblemError(f"a vector of shape {np.shape(vector)} is given; give the {self.matrix.width} coefficients of a "
                               "function in the space")


def CheckDiscretization(disc: Any) -> None:
    """Raise ProblemError unless it is a Discretization."""
    if not isinstance(disc, LinearEquations) or not hasattr(disc, "problem"):
        raise ProblemError(f"disc is {disc!r}; give Discretization(problem, method, mesh, order=1), that of a solution is "
                           "solution.disc")
