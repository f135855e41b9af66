"""Norms of the error and their rates."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from ngsolve import InnerProduct, Integrate

from .contracts import Array, Coefficient
from .data.coefficients import Vector
from .exact import ExactStrain
from .exceptions import ProblemError
from .solution.solution import CheckSolution, ContactSolution
from .tools.calls import ByKeyword

EXTRA = 6       # quadrature degree beyond 2 k: smooth exact solutions are integrated to round-off on unit-size problems


@ByKeyword
def L2Error(solution: ContactSolution, displacement: Coefficient) -> float:
    """|u - u_h| in L2(Omega) for a CoefficientFunction u [length^(1 + d/2)], which may be the GridFunction of another solution.

    Of GridFunctions on different meshes the finer mesh is that of the solution, in whose elements is integrated.
    Raises ProblemError for what is no displacement of the dimension of the mesh.

    >>> from ngdgc import *
    >>> from ngdgc.exact import AffinePatch
    >>> from ngdgc.meshes import RectangleMesh
    >>> exact = AffinePatch("slip")
    >>> disc = Discretization(exact.problem, LDG(), RectangleMesh(2))
    >>> L2Error(Solve(disc), exact.displacement) < 1e-8
    True
    """
    difference = solution.gfu - _Displacement(solution, displacement)
    return _Norm(InnerProduct(difference, difference), solution)


@ByKeyword
def EnergyError(solution: ContactSolution, displacement: Coefficient) -> float:
    """Square root of int C eps_h(u - u_h):eps_h(u - u_h), the paper's |.|_{1,h} [sqrt(stress length^d)]; u as for `L2Error`.

    Raises ProblemError for a u that has no symbolic derivative, too.

    >>> from ngdgc import LDG, Discretization, Solve
    >>> from ngdgc.exact import AffinePatch
    >>> from ngdgc.meshes import RectangleMesh
    >>> exact = AffinePatch("slip")
    >>> EnergyError(Solve(Discretization(exact.problem, LDG(), RectangleMesh(2))), exact.displacement) < 1e-8
    True
    """
    difference = solution.strain - _Strain(solution, displacement)
    return _Norm(InnerProduct(solution.disc.problem.material.Stress(difference), difference), solution)


@ByKeyword
def StrainError(solution: ContactSolution, displacement: Coefficient) -> float:
    """|eps_h(u - u_h)|/|eps(u)| in L2(Omega), no unit: the broken H1 error without C, which lam does not weight.

    u as for `EnergyError`, and not rigid: ProblemError if eps(u) = 0.

    >>> from ngdgc import LDG, Discretization, Solve
    >>> from ngdgc.exact import AffinePatch
    >>> from ngdgc.meshes import RectangleMesh
    >>> exact = AffinePatch("slip")
    >>> StrainError(Solve(Discretization(exact.problem, LDG(), RectangleMesh(2))), exact.displacement) < 1e-8
    True
    """
    strain = _Strain(solution, displacement)
    difference, size = solution.strain - strain, _Norm(InnerProduct(strain, strain), solution)
    if size == 0:
        raise ProblemError("displacement has no strain, and an error relative to it no meaning; take EnergyError")
    return _Norm(InnerProduct(difference, difference), solution) / size


def _Strain(solution: Any, displacement: Any) -> Any:
    """eps(u) of a CoefficientFunction in the frame of the solution."""
    u = _Displacement(solution, displacement)
    return solution.disc.problem.frame.Spatial(ExactStrain(u), u)


def _Displacement(solution: Any, displacement: Any) -> Any:
    """The CoefficientFunction u of the dimension of the solution's mesh, else ProblemError."""
    CheckSolution(solution)
    if isinstance(displacement, ContactSolution):
        raise ProblemError("displacement is a ContactSolution; give a CoefficientFunction: that of a solution is solution.gfu")
    displacement, dim = Vector(displacement, "displacement"), solution.disc.mesh.dim
    if displacement.dim != dim:
        raise ProblemError(f"displacement has {displacement.dim} components on a mesh of dimension {dim}; give {dim}")
    return displacement


def _Norm(square: Any, solution: ContactSolution) -> float:
    square = solution.disc.problem.frame.Weighted(square)
    return float(np.sqrt(max(Integrate(square, solution.disc.mesh, order=2 * solution.disc.order + EXTRA), 0)))


@ByKeyword
def Rates(errors: Sequence[float] | Array, ratio: float | Sequence[float] | Array = 2) -> Array:
    """Observed orders log(e_i/e_(i+1))/log(ratio) of errors on meshes refined by `ratio`, a number or one per refinement.

    >>> [float(rate) for rate in Rates([4.0, 1.0])]
    [2.0]
    """
    errors = np.asarray(errors, dtype=float)
    return np.log(errors[:-1] / errors[1:]) / np.log(ratio)
