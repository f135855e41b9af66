"""The inverse of a symmetric positive definite matrix of a discontinuous method by preconditioned conjugate gradients.

Hestenes, Stiefel 1952 with the fixed V-cycle of the `multigrid` module: memory and time grow like the number of unknowns,
in 3D those of a factorisation like its powers 4/3 and 2.  With the matrix it takes 50 bytes for each entry at the peak.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from ngsolve import InnerProduct, Norm

from ..contracts import Array, PreconditionerMaker
from ..exceptions import ProblemError
from ..mesh.facets import Threads
from ..tools.calls import ByKeyword
from ..tools.names import NameOf
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
    matrix : NGSolve matrix on disc.space; it is kept, and must not change
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
        self.mesh, self.matrix, self.tol, self.maxiter = disc.mesh, matrix, tol, maxiter
        self.iterations, self.solves, self.residual = 0, 0, 0.0
        # Not in NGSolve's threads, which those of LAPACK would disturb.
        self.preconditioner = (preconditioner or VCycle)(matrix, disc.space.FreeDofs(), disc)
        self.own = preconditioner and NameOf(preconditioner)
        self._b, self._x, self._r, self._z, self._p, self._q = (matrix.CreateColVector() for _ in range(6))
        self._diagonal = sp.csr_matrix(matrix.CSR(), shape=matrix.shape).diagonal()

    def Solve(self, load: Array, *, tol: float | None = None, start: Array | None = None) -> Array:
        """A^-1 load, (ndof,) -> (ndof,), to another tolerance, or from a start (ndof,) near the solution."""
        self._b.FV().NumPy()[:] = load
        self._x.FV().NumPy()[:] = 0 if start is None else start
        with Threads(self.mesh):
            self._Iterate(self.tol if tol is None else tol)
        return self._x.FV().NumPy().copy()

    def _Iterate(self, tol: float) -> None:
        """Steps until the residual of x, computed afresh, is small: that of the recursion drifts away from it."""
        b, x, r = self._b, self._x, self._r
        size, before, left = Norm(b), np.inf, self.maxiter
        self.solves += 1
        if not np.isfinite(size):
            raise ProblemError("the load is not finite; look for a division by zero in what it is made of")
        while True:
            r.data = b - self.matrix * x
            norm = Norm(r)
            self.residual = norm / size if size else norm
            if norm <= max(tol * size, ROUNDOFF * np.linalg.norm(self._diagonal * x.FV().NumPy())):
                return
            if left == 0 or not norm < 0.5 * before:
                causes = "a nearly incompressible material, a body that nothing holds or distorted elements"
                if self.own:
                    causes = f"that {self.own} is poor or not symmetric (conformance.CheckPreconditioner tells), or {causes}"
                raise ProblemError(
                    f"conjugate gradients came to a relative residual of {self.residual:.1e} instead of {tol:.1e} in "
                    f"{self.maxiter - left} steps; likely causes are {causes}; take inverse='sparsecholesky'")
            before, left = norm, left - self._Steps(tol * size, left)

    def _Steps(self, target: float, most: int) -> int:
        """Conjugate gradients from x with residual r until |r| <= target; the number of steps."""
        x, r, z, p, q = self._x, self._r, self._z, self._p, self._q
        energy, steps = None, 0
        while Norm(r) > target and steps < most:
            self.preconditioner.Mult(r, z)
            new = InnerProduct(r, z)
            p.data = z if energy is None else z + (new / energy) * p
            energy = new
            q.data = self.matrix * p
            curvature = InnerProduct(p, q)
            # Written so that a NaN is caught as well.
            if self.own and not energy > 0:
                raise ProblemError(f"the preconditioner {self.own} is not positive definite, r' P r is {energy:.1e}; it must "
                                   "be, and symmetric: conformance.CheckPreconditioner looks at it; take another one, or "
                                   "inverse='iterative'")
            if not (energy > 0 and curvature > 0):
                raise ProblemError("the matrix is not positive definite (a direction of conjugate gradients has an energy of "
                                   f"{curvature:.1e}): nothing holds the body, or the penalty is too small; add dirichlet, "
                                   "roller or contact stiffness, or take a larger penalty")
            x.data += (energy / curvature) * p
            r.data -= (energy / curvature) * q
            steps += 1
            self.iterations += 1
        return steps
