"""Which inverse solves the linear equations: chosen by symmetry, dimension, size, material and memory.

sparsecholesky : NGSolve's factorisation, the usual choice
pardisospd : the factorisation of the library MKL, where it is installed (`pip install ngdgc[mkl]`)
umfpack : for unsymmetric matrices, of which a Cholesky factorisation would be wrong without a word
iterative : preconditioned conjugate gradients (`conjugategradients` module), in 3D for discontinuous methods whose factors
    would take long and much memory
"""

from functools import cache

from ngsolve.la import SparseMatrixd

from ..exceptions import ProblemError
from ..tools.memory import CheckMemory
from ..tools.values import Among
from .conjugategradients import DirectMemory, IterativeInverse
from .solenoidal import NeedsSolenoidal, Swelling

SYMMETRIC = "sparsecholesky", "pardisospd", "iterative"
LIKEFACTORS = 1e-11         # relative residual of solutions that take the place of a factorisation's
# Bytes of factors in 3D (`DirectMemory`) from which a whole solution takes less time with conjugate gradients: between 5e7 and
# 2e8 on boxes of orders 1 to 3, IP, Bassi and LDG; with the levels for nearly incompressible materials between 5e8 and 8e8.
LARGE, HUGE = 1.5e8, 7.5e8
SWOLLEN = 15        # largest ratio of volumetric to shear stiffness for which they are without: nu = 0.45 in 3D
LU = 2.5            # memory of an unsymmetric factorisation in units of that of a symmetric one


def Kind(disc, wanted):
    """The inverse for the matrix of a Discretization: the one that is wanted, or the best one for "auto".

    Raises ProblemError for an unknown inverse, one that is not installed, and Cholesky's of an unsymmetric matrix.
    """
    if not Among(wanted, ("auto", *SYMMETRIC, "umfpack")):
        raise ProblemError(f"inverse is {wanted!r}; choose auto, {', '.join(SYMMETRIC)} or umfpack")
    if wanted == "auto":
        if not disc.symmetric:
            return "umfpack"
        if disc.mesh.dim == 3 and disc.method.discontinuous and Iterated(disc):
            return "iterative"
        return Direct()
    if wanted in SYMMETRIC and not disc.symmetric:
        raise ProblemError(f"inverse={wanted!r} is for symmetric matrices, and this form is not; take inverse='auto'")
    if wanted == "iterative" and not disc.method.discontinuous:
        raise ProblemError(f"inverse='iterative' is for discontinuous methods, and {disc.method.name} is continuous; take "
                           "inverse='auto'")
    if wanted == "pardisospd" and not HasPardiso():
        raise ProblemError("inverse='pardisospd' needs the library MKL and NGSolve 6.2.2608 or newer; install them, "
                           "pip install --upgrade ngdgc[mkl] ngsolve, or take inverse='auto'")
    return wanted


def Direct():
    """The name of the fastest factorisation of symmetric matrices that is installed."""
    return "pardisospd" if HasPardiso() else "sparsecholesky"


def Iterated(disc):
    """True if in 3D conjugate gradients and what they need take less time than a factorisation and its solves."""
    swollen = NeedsSolenoidal(disc)
    return (swollen or Swelling(disc) < SWOLLEN) and FactorMemory(disc) > (HUGE if swollen else LARGE)


def FactorMemory(disc):
    """Bytes of the Cholesky factors of a Discretization's matrix, estimated."""
    # Unknowns of neighbouring elements, or of neighbouring vertices, are eliminated together.
    nodes = disc.mesh.ne if disc.method.discontinuous else disc.mesh.nv
    return DirectMemory(nodes, disc.matrix.nze, disc.mesh.dim)


def Inverse(disc, matrix, kind):
    """The inverse of a matrix on the free dofs of a Discretization.

    Raises ProblemError, before it is begun, for a factorisation that would not fit into the memory that is free.
    """
    if kind == "iterative":
        return IterativeInverse(disc, matrix, tol=LIKEFACTORS)
    CheckMemory(FactorMemory(disc) * (LU if kind == "umfpack" else 1), f"the factors of {disc.space.ndof} unknowns",
                "inverse='iterative', " if disc.symmetric and disc.method.discontinuous else
                "a discontinuous method with inverse='iterative', ")
    return Factorised(matrix, disc.space.FreeDofs(), kind, disc.mesh.dim)


def Factorised(matrix, freedofs, kind, dim):
    """NGSolve's factorisation of a matrix on the free dofs."""
    if kind == "pardisospd":
        # That the matrix is symmetric has to be said.  Nested dissection fills less in 3D, minimum degree in 2D.
        matrix.inverse_flags = {"symmetric": True, "ordering": "metis" if dim == 3 else "minimum_degree"}
    return matrix.Inverse(freedofs, inverse=kind)


@cache
def HasPardiso():
    """True if MKL's Pardiso can be used: NGSolve lists it even where it is missing.

    Before 6.2.2608 NGSolve's matrices have no flags, and that they are symmetric cannot be said.
    """
    try:
        Factorised(SparseMatrixd.CreateFromCOO([0], [0], [1.0], 1, 1), None, "pardisospd", 2)
    except (AttributeError, RuntimeError):
        return False
    return True
