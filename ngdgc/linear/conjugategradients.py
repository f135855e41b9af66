"""The inverse of a symmetric positive definite matrix of a discontinuous method by preconditioned conjugate gradients.

Hestenes, Stiefel 1952 with the fixed V-cycle of the `multigrid` module: memory and time grow like the number of unknowns,
in 3D those of a factorisation like its powers 4/3 and 2.  With the matrix it takes 50 bytes for each entry at the peak.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from ngsolve import BaseMatrix, InnerProduct, Norm

from ..contracts import Array
from ..exceptions import ProblemError
from ..mesh.facets import Threads
from .multigrid import Preconditioner

TOL = 1e-8
MAXITER = 500
ROUNDOFF = 10 * np.finfo(float).eps


class IterativeInverse(BaseMatrix):
    """A^-1 for the matrix A of a symmetric discontinuous method, or A + T' W D T, to be used like `disc.Factorise(matrix)`.

    Parameters
    ----------
    disc : Discretization with a symmetric discontinuous method
    matrix : NGSolve matrix on disc.space; it is kept, and must not change
    tol : of the Euclidean norm of the residual, |b - A x| <= tol |b|, also changed by setting the attribute or with each solve
    maxiter : largest number of steps of one solve

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

    def __init__(self, disc: Any, matrix: Any, *, tol: float = TOL, maxiter: int = MAXITER) -> None:
        super().__init__()
        if not (disc.method.discontinuous and disc.symmetric):
            raise ProblemError(f"conjugate gradients need a symmetric discontinuous method, {disc.method.name} is none; take "
                               "inverse='auto'")
        self.mesh, self.matrix, self.tol, self.maxiter = disc.mesh, matrix, tol, maxiter
        self.iterations, self.solves, self.residual = 0, 0, 0.0
        # Not in NGSolve's threads, which those of LAPACK would disturb.
        self.preconditioner = Preconditioner(disc, matrix)
        self._b, self._x, self._r, self._z, self._p, self._q = (matrix.CreateColVector() for _ in range(6))
        self._diagonal = sp.csr_matrix(matrix.CSR(), shape=matrix.shape).diagonal()

    def Height(self):
        return self.matrix.height

    def Width(self):
        return self.matrix.width

    def CreateVector(self, colvector):
        return self.matrix.CreateColVector()

    def Mult(self, b, x):
        """x = A^-1 b, NGSolve vectors."""
        self._b.data = b
        self._x[:] = 0
        self._Iterate(self.tol)
        x.data = self._x

    def Solve(self, load: Array, *, tol: float | None = None, start: Array | None = None) -> Array:
        """A^-1 load, (ndof,) -> (ndof,), to another tolerance, or from a start (ndof,) near the solution."""
        self._b.FV().NumPy()[:] = load
        self._x.FV().NumPy()[:] = 0 if start is None else start
        with Threads(self.mesh):
            self._Iterate(self.tol if tol is None else tol)
        return self._x.FV().NumPy().copy()

    def _Iterate(self, tol):
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
                raise ProblemError(
                    f"conjugate gradients came to a relative residual of {self.residual:.1e} instead of {tol:.1e} in "
                    f"{self.maxiter - left} steps; likely causes are a nearly incompressible material, a body that nothing "
                    "holds or distorted elements; take inverse='sparsecholesky'")
            before, left = norm, left - self._Steps(tol * size, left)

    def _Steps(self, target, most):
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
            if not (energy > 0 and curvature > 0):
                raise ProblemError("the matrix is not positive definite (a direction of conjugate gradients has an energy of "
                                   f"{curvature:.1e}): nothing holds the body, or the penalty is too small; add dirichlet, "
                                   "roller or contact stiffness, or take a larger penalty")
            x.data += (energy / curvature) * p
            r.data -= (energy / curvature) * q
            steps += 1
            self.iterations += 1
        return steps


def DirectMemory(elements: int, entries: int, dim: int) -> int:
    """Bytes that the sparse Cholesky factorisation of a matrix needs at its peak, from its elements and entries (nnz).

    Nested dissection (George 1973): separators of about elements^(2/3) in 3D, elements^(1/2) in 2D, so
    11 entries elements^(1/3) and 4 entries log2(elements) bytes.  The factors were measured as the growth of the resident
    memory while NGSolve's sparsecholesky works, for orders 1 to 3, tetrahedra, hexahedra, triangles and quads, IP and LDG:
    between 4 and 11 in 3D, 2 and 4 in 2D, the larger ones at the larger sizes, which are those that matter.
    """
    return int(entries * (11 * elements ** (1 / 3) if dim == 3 else 4 * np.log2(max(elements, 2))))
