"""Is B_h coercive?  Decided by an element-wise bound where that suffices, by an eigenvalue computation where it does not."""

import numpy as np

from .exceptions import ProblemError
from .facets import Csr


def SmallestEigenvalue(matrix, norm, freedofs):
    """Smallest lambda with B_h u = lambda N u, N = g_h + penalty: the coercivity constant of B_h in its own energy norm.

    `matrix` and `norm` are NGSolve matrices on one space.  The spectrum lies in a bounded interval whatever the mesh, so
    Lanczos needs few steps; it costs one factorisation of N.
    """
    import scipy.sparse.linalg as spla      # slow to import and rarely needed

    free = np.flatnonzero(list(freedofs))
    B, N = (Csr(entries)[free][:, free] for entries in (matrix, norm))
    inverse = norm.Inverse(freedofs, inverse="sparsecholesky")
    full = norm.CreateColVector()
    result = norm.CreateColVector()

    def Apply(vector):
        full.FV().NumPy()[:] = 0
        full.FV().NumPy()[free] = np.ravel(vector)
        result.data = inverse * full
        return result.FV().NumPy()[free].copy()

    operator = spla.LinearOperator(N.shape, Apply, dtype=float)
    start = np.random.default_rng(1).standard_normal(len(free))
    return float(spla.eigsh(B, k=1, M=N, Minv=operator, which="SA", tol=1e-4, v0=start, ncv=min(40, len(free)),
                            return_eigenvectors=False)[0])


def _Words(penalty):
    return penalty if isinstance(penalty, str) else f"{penalty:g}"


def CheckCoercivity(method, form, matrix, freedofs):
    """Raise ProblemError if the bilinear form is not coercive.

    If the largest element bound kappa_K (`penalty` module) is below 1 the form is coercive; only otherwise
    lambda_min > 0 of `SmallestEigenvalue` decides.
    """
    if form.bound < 1:
        return
    smallest = SmallestEigenvalue(matrix, form.Norm(), freedofs)
    if smallest <= 1e-6:        # Lanczos is stopped at a relative accuracy of 1e-4 of a spectrum of size 1
        larger = f"penalty={method.penalty * form.bound:.3g}" if np.isfinite(form.bound) else "a larger penalty"
        raise ProblemError(f"penalty={_Words(method.penalty)} loses coercivity on this mesh, order and material (smallest "
                           f"eigenvalue {smallest:.3g} of the form against its energy norm); {larger} is safe, and so is "
                           "penalty='auto'")
