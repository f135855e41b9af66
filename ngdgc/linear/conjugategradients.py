"""The inverse of a symmetric positive definite matrix of a discontinuous method by preconditioned conjugate gradients.

Hestenes, Stiefel 1952 with the fixed V-cycle of the `multigrid` module: memory and time grow like the number of unknowns,
in 3D those of a factorisation like its powers 4/3 and 2.  With the matrix it takes 50 bytes for each entry at the peak.

All is done by one thread: what bounds it is memory, and threads that wait for each other take longer on a busy machine.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ..contracts import Array, Preconditioner, PreconditionerMaker
from ..exceptions import ProblemError
from ..tools import sparse as sp
from ..tools.calls import ByKeyword
from ..tools.names import NameOf
from ..tools.parallel import Batched
from .multigrid import VCycle

TOL = 1e-8
LIKEFACTORS = 1e-11         # relative residual of solutions that take the place of a factorisation's
MAXITER = 500
ROUNDOFF = 10 * np.finfo(float).eps


@ByKeyword
@dataclass(frozen=True, kw_only=True)
class ConjugateGradients:
    """`IterativeInverse`s to a relative residual of 1e-11, to be given as inverse=ConjugateGradients(preconditioner=...).

    preconditioner : what keeps `contracts.Preconditioner`, called with the matrix, its free dofs and the Discretization; None:
        the V-cycle of the `multigrid` module, which is inverse="iterative"

    >>> from ngdgc.linear.conjugategradients import ConjugateGradients
    >>> ConjugateGradients(preconditioner=lambda matrix, free, disc: matrix.CreateSmoother(free)).iterates
    True
    """

    preconditioner: PreconditionerMaker | None = None
    symmetric = True
    iterates = True

    def __post_init__(self) -> None:
        if not (self.preconditioner is None or callable(self.preconditioner)):
            raise ProblemError(f"preconditioner is {self.preconditioner!r}; give a function of the matrix, its free dofs and "
                               "the Discretization, or None")

    @property
    def name(self) -> str:
        return "iterative" if self.preconditioner is None else f"iterative with {NameOf(self.preconditioner)}"

    def __call__(self, matrix: Any, free: Any, disc: Any) -> IterativeInverse:
        return IterativeInverse(disc, matrix, tol=LIKEFACTORS, preconditioner=self.preconditioner)


class IterativeInverse:
    """A^-1 for the matrix A of a symmetric discontinuous method, or A + T' W D T, which keeps `contracts.InexactInverse`.

    Parameters
    ----------
    disc : Discretization with a symmetric discontinuous method
    matrix : NGSolve matrix on disc.space; the default preconditioner has a copy, another one needs it as it is
    tol : of the Euclidean norm of the residual, |b - A x| <= tol |b|, also changed by setting the attribute or with each solve
    maxiter : largest number of steps of one solve
    preconditioner : as for `ConjugateGradients`

    A residual at the level of its rounding, |b - A x| <= 10 eps |diag(A) x|, is accepted also if it is above tol |b|: with a
    stiff foundation (D of 1e9 moduli) no method comes further than to about 1e-8.

    Raises ProblemError for other methods, here; for a matrix that is not positive definite and for a residual that does not
    get small, when it is applied.

    Attributes
    ----------
    iterations : number of steps in all solves;  solves : number of solves
    residual : |b - A x| / |b| of the last solve, computed from x

    >>> from ngsolve import CF
    >>> from ngdgc import *
    >>> from ngdgc.linear.conjugategradients import IterativeInverse
    >>> from ngdgc.meshes import BoxMesh
    >>> problem = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("bottom", NormalCompliance(1)),
    ...                          dirichlet={"top": CF((0, 0, 0))}, bodyforce=(0, 0, -1))
    >>> disc = Discretization(problem, InteriorPenalty(), BoxMesh(2))
    >>> inverse = IterativeInverse(disc, disc.matrix)
    >>> u = inverse.Solve(disc.load)
    >>> inverse.residual < 1e-8, inverse.iterations < 45
    (True, True)
    """

    def __init__(self, disc: Any, matrix: Any, *, tol: float = TOL, maxiter: int = MAXITER,
                 preconditioner: PreconditionerMaker | None = None) -> None:
        if not (disc.method.iterative and disc.symmetric):
            raise ProblemError(f"conjugate gradients need a symmetric discontinuous method, {disc.method.name} is none; take "
                               "inverse='auto'")
        self.tol, self.maxiter = tol, maxiter
        self.iterations, self.solves, self.residual = 0, 0, 0.0
        # Not in NGSolve's threads, which those of LAPACK would disturb.
        free = disc.space.FreeDofs()
        self.own = preconditioner and NameOf(preconditioner)
        self.equations: Equations = (VCycle(matrix, free, disc) if preconditioner is None else
                                     Preconditioned(matrix, preconditioner(matrix, free, disc)))

    @Batched
    def Solve(self, load: Array, *, tol: float | None = None, start: Array | None = None) -> Array:
        """A^-1 load, (ndof,) -> (ndof,), to another tolerance, or from a start (ndof,) near the solution."""
        b = self.equations.To(load)
        x = np.zeros_like(b) if start is None else self.equations.To(start)
        self._Iterate(b, x, self.tol if tol is None else tol)
        return self.equations.From(x)

    def _Iterate(self, b: Array, x: Array, tol: float) -> None:
        """Steps until the residual of x, computed afresh, is small: that of the recursion drifts away from it."""
        size, before, left = float(np.linalg.norm(b)), np.inf, self.maxiter
        self.solves += 1
        if not np.isfinite(size):
            raise ProblemError("the load is not finite; look for a division by zero in what it is made of")
        while True:
            r = b - self.equations.Product(x)
            norm = float(np.linalg.norm(r))
            self.residual = norm / size if size else norm
            if norm <= max(tol * size, ROUNDOFF * np.linalg.norm(self.equations.diagonal * x)):
                return
            if left == 0 or not norm < 0.5 * before:
                causes = "a nearly incompressible material, a body that nothing holds or distorted elements"
                if self.own:
                    causes = f"that {self.own} is poor or not symmetric (conformance.CheckPreconditioner tells), or {causes}"
                raise ProblemError(
                    f"conjugate gradients came to a relative residual of {self.residual:.1e} instead of {tol:.1e} in "
                    f"{self.maxiter - left} steps; likely causes are {causes}; take inverse='sparsecholesky'")
            before, left = norm, left - self._Steps(x, r, tol * size, left)

    def _Steps(self, x: Array, r: Array, target: float, most: int) -> int:
        """Conjugate gradients from x with residual r until |r| <= target; the number of steps."""
        energy, steps = float("inf"), 0
        p, q = np.zeros_like(r), np.zeros_like(r)
        while np.linalg.norm(r) > target and steps < most:
            z, product = self.equations.Precondition(r)
            new = float(r @ z)
            # Not a product of A with p, but the combination of what the preconditioner knows of it.
            for vector, last in ((z, p), (product, q)):
                last *= new / energy
                last += vector
            energy, curvature = new, p @ q
            # Written so that a NaN is caught as well.
            if self.own and not energy > 0:
                raise ProblemError(f"the preconditioner {self.own} is not positive definite, r' P r is {energy:.1e}; it must "
                                   "be, and symmetric: conformance.CheckPreconditioner looks at it; take another one, or "
                                   "inverse='iterative'")
            if not (energy > 0 and curvature > 0):
                raise ProblemError("the matrix is not positive definite (a direction of conjugate gradients has an energy of "
                                   f"{curvature:.1e}): nothing holds the body, or the penalty is too small; add dirichlet, "
                                   "roller or contact stiffness, or take a larger penalty")
            x += (energy / curvature) * p
            r -= (energy / curvature) * q
            steps += 1
            self.iterations += 1
        return steps


class Equations(Protocol):
    """A x = b with a preconditioner P, for vectors in an order of its own.

    diagonal : of A, in that order
    """

    diagonal: Array

    def To(self, vector: Array, /) -> Array:
        """A vector (ndof,) in that order, a new one."""
        ...

    def From(self, ordered: Array, /) -> Array:
        """The vector (ndof,) of one in that order."""
        ...

    def Product(self, x: Array, /) -> Array:
        """A x."""
        ...

    def Precondition(self, b: Array, /) -> tuple[Array, Array]:
        """(z, A z) with z = P b."""
        ...


class Preconditioned:
    """`Equations` with NGSolve's matrix and a preconditioner from outside, in the order of the space."""

    def __init__(self, matrix: Any, preconditioner: Preconditioner) -> None:
        self.matrix, self.preconditioner = matrix, preconditioner
        self.diagonal = sp.csr_matrix(matrix.CSR(), shape=matrix.shape).diagonal()
        self._source, self._target = matrix.CreateColVector(), matrix.CreateColVector()

    def To(self, vector: Array) -> Array:
        return np.array(vector, dtype=float)

    def From(self, ordered: Array) -> Array:
        return ordered

    def Product(self, x: Array) -> Array:
        self._source.FV().NumPy()[:] = x
        self._target.data = self.matrix * self._source
        return self._target.FV().NumPy().copy()

    def Precondition(self, b: Array) -> tuple[Array, Array]:
        self._source.FV().NumPy()[:] = b
        self.preconditioner.Mult(self._source, self._target)
        z = self._target.FV().NumPy().copy()
        return z, self.Product(z)
