"""Which inverse solves the linear equations: chosen by symmetry, dimension, size, material and memory, or given by a user.

sparsecholesky : NGSolve's factorisation, the usual choice
pardisospd : the factorisation of the library MKL, in 3D the usual choice where it is installed (`pip install ngdgc[mkl]`)
umfpack : for unsymmetric matrices, of which a Cholesky factorisation would be wrong without a word
iterative : preconditioned conjugate gradients (`conjugategradients` module), in 3D for discontinuous methods whose factors
    would take long and much memory

Each name stands for an Inverter of the package (`contracts`); any other one may be given in its place (`outside` module).
"""

from __future__ import annotations

from typing import Any

from ..contracts import Inverter
from ..exceptions import ProblemError
from ..tools.kinds import Short
from ..tools.names import NameOf
from ..tools.values import Among
from .conjugategradients import ConjugateGradients
from .factorisations import FactorMemory, Factorisation, HasPardiso
from .solenoidal import NeedsSolenoidal, Swelling

INVERTERS = {inverter.name: inverter for inverter in (
    Factorisation("sparsecholesky"), Factorisation("pardisospd"), ConjugateGradients(),
    Factorisation("umfpack", symmetric=False))}
# Bytes of factors in 3D (`DirectMemory`) from which a whole solution takes less time with conjugate gradients: between 5e7 and
# 2e8 on boxes of orders 1 to 3, IP, Bassi and LDG; with the levels for nearly incompressible materials between 5e8 and 8e8.
LARGE, HUGE = 1.5e8, 7.5e8
SWOLLEN = 15        # largest ratio of volumetric to shear stiffness for which they are without: nu = 0.45 in 3D


def CheckInverter(wanted: str | Inverter) -> None:
    """Raise ProblemError unless it is "auto", the name of an Inverter, or one itself."""
    if not (Among(wanted, ("auto", *INVERTERS)) or callable(wanted)):
        *names, last = INVERTERS
        raise ProblemError(f"inverse is {Short(wanted)}; choose auto, {', '.join(names)} or {last}, or give a function that "
                           "makes an inverse of a matrix, its free dofs and the Discretization (contracts.Inverter)")


def Chosen(disc: Any, wanted: str | Inverter) -> Inverter:
    """The Inverter for the matrix of a Discretization: the one that is wanted, or the best one for "auto".

    Raises ProblemError for one that is not installed, or not for this matrix: Cholesky's of an unsymmetric one.
    """
    if isinstance(wanted, str) and wanted == "auto":
        return INVERTERS[Best(disc)]
    inverter = INVERTERS[wanted] if isinstance(wanted, str) else wanted
    symmetric, iterates = (getattr(inverter, name, False) for name in ("symmetric", "iterates"))
    name = NameOf(inverter)
    if (symmetric or iterates) and not disc.symmetric:
        raise ProblemError(f"inverse={name!r} is for symmetric matrices, and this form is not; take inverse='auto'")
    if iterates and not disc.method.iterative:
        raise ProblemError(f"inverse={name!r} is for discontinuous methods that conjugate gradients solve, and "
                           f"{disc.method.name} is none; take inverse='auto'")
    if name == "pardisospd" and not HasPardiso():
        raise ProblemError("inverse='pardisospd' needs the library MKL and NGSolve 6.2.2608 or newer; install them, "
                           "pip install --upgrade ngdgc[mkl] ngsolve, or take inverse='auto'")
    return inverter


def Best(disc: Any) -> str:
    """The name of the Inverter for the matrix of a Discretization that costs least."""
    if not disc.symmetric:
        return "umfpack"
    punches = disc.contact.punches      # those whose motions are unknowns need a factorisation
    if disc.mesh.dim == 3 and disc.method.iterative and not (punches and punches.count) and Iterated(disc):
        return "iterative"
    return Direct(disc.mesh.dim)


def Direct(dim: int) -> str:
    """The name of the fastest factorisation of symmetric matrices that is installed: MKL's takes longer in 2D."""
    return "pardisospd" if dim == 3 and HasPardiso() else "sparsecholesky"


def Iterated(disc: Any) -> bool:
    """True if in 3D conjugate gradients and what they need take less time than a factorisation and its solves."""
    swollen, swelling = NeedsSolenoidal(disc), Swelling(disc.problem.material, disc.mesh)
    return (swollen or swelling < SWOLLEN) and FactorMemory(disc) > (HUGE if swollen else LARGE)
