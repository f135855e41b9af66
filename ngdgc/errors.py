"""Norms of the error and their rates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import InnerProduct, Integrate

from .exact import ExactStrain
from .protocols import Array, Coefficient

if TYPE_CHECKING:
    from .solution import ContactSolution

EXTRA = 6       # quadrature degree beyond 2 k: smooth exact solutions are integrated to round-off on unit-size problems


def L2Error(solution: ContactSolution, displacement: Coefficient) -> float:
    """|u - u_h| in L2(Omega) for a CoefficientFunction u [length^(1 + d/2)].

    >>> from ngdgc import *
    >>> from ngdgc.exact import AffinePatch
    >>> from ngdgc.meshes import RectangleMesh
    >>> exact = AffinePatch("slip")
    >>> disc = Discretization(exact.problem, LDG(), RectangleMesh(2))
    >>> L2Error(Solve(disc), exact.displacement) < 1e-8
    True
    """
    difference = solution.gfu - displacement
    return _Norm(InnerProduct(difference, difference), solution)


def EnergyError(solution: ContactSolution, displacement: Coefficient) -> float:
    """Square root of int C eps_h(u - u_h):eps_h(u - u_h), the paper's |.|_{1,h} [sqrt(stress length^d)]."""
    difference = solution.strain - ExactStrain(displacement)
    return _Norm(InnerProduct(solution.disc.problem.material.Stress(difference), difference), solution)


def StrainError(solution: ContactSolution, displacement: Coefficient) -> float:
    """|eps_h(u - u_h)|/|eps(u)| in L2(Omega), no unit: the broken H1 error without C, which lam does not weight."""
    strain = ExactStrain(displacement)
    difference = solution.strain - strain
    return _Norm(InnerProduct(difference, difference), solution) / _Norm(InnerProduct(strain, strain), solution)


def _Norm(square, solution):
    return float(np.sqrt(max(Integrate(square, solution.disc.mesh, order=2 * solution.disc.order + EXTRA), 0)))


def Rates(errors: Any, ratio: float = 2) -> Array:
    """Observed orders log(e_i/e_(i+1))/log(ratio) of errors on meshes refined by `ratio`, a number or one per refinement.

    >>> [float(rate) for rate in Rates([4.0, 1.0])]
    [2.0]
    """
    errors = np.asarray(errors, dtype=float)
    return np.log(errors[:-1] / errors[1:]) / np.log(ratio)
