"""Is B_h coercive?  Decided by an element-wise bound where that suffices, by an eigenvalue computation where it does not.

The extreme eigenvalues lambda of B x = lambda N x come from Lanczos' method in the inner product of N: sparse, with one
factorisation of N.  The spectra met here are bounded whatever the mesh, so the number of steps does not grow with it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import BaseMatrix

from ..contracts import Array, Form
from ..exceptions import ProblemError
from ..mesh.facets import Csr, Native
from ..tools import sparse as sp

TOL = 1e-3      # of the residual of an eigenvector; eigenvalues, also clustered ones, come out to a relative 1e-4
START = 1       # seed of the first Lanczos vector: the same numbers in every run


def FreePart(matrix: BaseMatrix, freedofs: Any) -> sp.csr_matrix:
    """The block of an NGSolve matrix that belongs to the free dofs, as scipy CSR."""
    free = np.flatnonzero(list(freedofs))
    return Csr(matrix)[free][:, free]


def Symmetric(matrix: sp.csr_matrix) -> sp.csr_matrix:
    """(B + B')/2, which has the same values v' B v."""
    return (matrix + matrix.T) / 2


class SparseInverse:
    """N^-1 for a sparse symmetric positive definite scipy matrix N, by NGSolve's sparse Cholesky factorisation."""

    def __init__(self, norm: sp.csr_matrix) -> None:
        self._native = Native(norm)
        self._inverse = self._native.Inverse(inverse="sparsecholesky")
        self._source, self._target = self._native.CreateColVector(), self._native.CreateColVector()

    def __call__(self, vector: Array) -> Array:
        """(n,) -> (n,)."""
        self._source.FV().NumPy()[:] = np.ravel(vector)
        self._target.data = self._inverse * self._source
        return self._target.FV().NumPy().copy()


def ExtremeEigenvalue(operator: Any, norm: sp.csr_matrix, inverse: SparseInverse, which: str) -> float:
    """Smallest (which="SA") or largest (which="LA") lambda with B x = lambda N x.

    operator : B, sparse symmetric or a function x -> B x;  norm : N, sparse;  inverse : `SparseInverse` of N

    Raises ProblemError if Lanczos' method does not converge, as for a B of very different scales.
    """
    import scipy.sparse.linalg as spla      # slow to import and rarely needed

    B = spla.LinearOperator(norm.shape, operator, dtype=float) if callable(operator) else operator
    solve = spla.LinearOperator(norm.shape, inverse, dtype=float)
    start = np.random.default_rng(START).standard_normal(norm.shape[0])
    try:
        return float(spla.eigsh(B, k=1, M=norm, Minv=solve, which=which, tol=TOL, v0=start, ncv=min(40, norm.shape[0]),
                                return_eigenvectors=False)[0])
    except spla.ArpackNoConvergence as error:
        raise ProblemError(f"no eigenvalue of the form against its norm was found ({error}); look for coefficients of "
                           "extreme size and for degenerate elements") from None


def SmallestEigenvalue(matrix: BaseMatrix, norm: sp.csr_matrix, freedofs: Any, held: sp.csr_matrix | None = None) -> float:
    """Smallest lambda with B_h u = lambda N u, N = g_h + penalty: the coercivity constant of B_h in its own energy norm.

    `matrix` and `norm` are NGSolve matrices on one space; of an unsymmetric form the symmetric part counts.  `held`, scipy CSR,
    is added to both where rigid motions leave N singular: lambda = 1 there, and no lambda below 1 falls.
    """
    B, N = FreePart(matrix, freedofs), FreePart(norm, freedofs)
    if held is not None:
        free = np.flatnonzero(list(freedofs))
        held = held[free][:, free]
        B, N = B + held, N + held
    return ExtremeEigenvalue(Symmetric(B), N, SparseInverse(N), "SA")


def CheckCoercivity(form: Form, matrix: BaseMatrix, freedofs: Any, held: sp.csr_matrix | None = None) -> None:
    """Raise ProblemError if the bilinear form is not coercive.

    Only where nothing guarantees that it is, lambda_min > 0 of `SmallestEigenvalue` decides.
    """
    if form.guarantee.holds:
        return
    smallest = SmallestEigenvalue(matrix, form.Norm(), freedofs, held)
    if smallest <= 1e-6:        # zero up to round-off in a spectrum of size 1
        raise ProblemError(f"{form.guarantee.culprit} loses coercivity on this mesh, order and material (smallest eigenvalue "
                           f"{smallest:.3g} of the form against its energy norm); {form.guarantee.remedy}")


def CheckSum(form: Form, matrix: BaseMatrix, freedofs: Any, held: sp.csr_matrix | None = None) -> None:
    """Raise ProblemError if B_h with added forms, whose matrix is given, is not coercive."""
    smallest = SmallestEigenvalue(matrix, form.Norm(), freedofs, held)
    if smallest <= 1e-6:
        raise ProblemError(f"with the forms that were added B_h is not coercive (smallest eigenvalue {smallest:.3g} against "
                           "g_h + penalty); look at their sign and size, or take a larger penalty")
