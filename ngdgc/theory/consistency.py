"""Lemma 3.1 of Xiao, Wang, Han 2018 as a tool: how well the exact solution satisfies the discrete equations."""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import CF, CoefficientFunction, GridFunction, Id, InnerProduct, Integrate, Parameter, ds, dx, specialcf

from ..contracts import Array, Coefficient
from ..data.coefficients import ForFacets, SpringPull, Unfolded
from ..data.inside import FromInside
from ..discretization import Discretization
from ..errors import EXTRA
from ..exact import ExactStrain
from ..exceptions import ProblemError
from ..methods.lifting import Lifting
from ..methods.symbolform import Coefficients
from ..problem.materials import Strain
from ..tools.calls import ByKeyword
from .lemmas import DualNorm

@ByKeyword
def ConsistencyResidual(disc: Discretization, displacement: Coefficient) -> float:
    """sup |B_h(u, v) - (f, v) + int_GammaC t.v|/|||v||| over V_h for the exact solution u (Lemma 3.1), t = -sigma(u) n.

    disc : Discretization;  displacement : u in H^2, a CoefficientFunction of x, y, z with d components [length]

    [sqrt(stress length^d)], as `EnergyError`, which by Strang's lemma it bounds together with the error of approximation.
    Round-off in the edge forms.  The lifting forms pair r_0([v]) with C eps(u), that is with its projection P_Q on Q_h, and
    keep <{C eps(u) - P_Q C eps(u)} n, v+ - v->: a residual of order l + 1 in h unless the stress lies in Q_h.

    The terms come from u itself, see `ConsistencyVector`; integrals are exact to the degree 2 k + 6, facets taken for plane.

    Raises ProblemError for a u that is no such expression or does not take the prescribed values, and for a body that
    only its foundation holds.

    >>> from ngdgc import *
    >>> from ngdgc.exact import AffinePatch
    >>> from ngdgc.meshes import RectangleMesh
    >>> exact = AffinePatch("slip")
    >>> disc = Discretization(exact.problem, LDG(), RectangleMesh(2))
    >>> ConsistencyResidual(disc, exact.displacement) < 1e-8
    True
    """
    return DualNorm(disc, ConsistencyVector(disc, displacement))


@ByKeyword
def ConsistencyVector(disc: Discretization, displacement: Coefficient) -> Array:
    """The coefficients (ndof,) of v -> B_h(u, v) - (f, v) + int_GammaC t.v, arguments as in `ConsistencyResidual`.

    A continuous u with the prescribed values has no jumps, so of B_h and the loads of prescribed values remain

        int C eps(u):eps_h(v) - <v+ - v-, {C eps(u)} n>        edge form,    in the lifting form with P_Q C eps(u),

    minus the body force, tractions of loads and springs, and sigma(u) n on Gamma_C.

    >>> from ngdgc import *
    >>> from ngdgc.exact import AffinePatch
    >>> from ngdgc.meshes import RectangleMesh
    >>> exact = AffinePatch("slip")
    >>> disc = Discretization(exact.problem, LDG(), RectangleMesh(2))
    >>> bool(abs(ConsistencyVector(disc, exact.displacement)).max() < 1e-8)
    True
    """
    problem, mesh, n = disc.problem, disc.mesh, specialcf.normal(disc.mesh.dim)
    problem.frame.Refuse("ConsistencyVector")
    if problem.joints:
        raise ProblemError(f"the problem has joint {problem.joints[0]!r}, across which an exact displacement jumps, and a "
                           "CoefficientFunction u has no jumps; take a problem with foundations alone")
    strain = _ExactStrain(disc, displacement)
    _CheckPrescribed(disc, displacement)
    stress, v = problem.material.Stress(strain), disc.space.TestFunction()

    def On(region: str) -> Any:
        return ds(skeleton=True, definedon=mesh.Boundaries(region), bonus_intorder=EXTRA)

    residual = Coefficients(InnerProduct(stress, Strain(v)) * dx(bonus_intorder=EXTRA))
    if problem.bodyforce is not None:
        residual -= Coefficients(Unfolded(problem.bodyforce) * v * dx(bonus_intorder=EXTRA))
    for (kind, region), value in disc.tractions.items():
        residual -= Coefficients(ForFacets(value, kind, region, mesh) * v * On(region))
    for region in problem.spring:
        residual += Coefficients(SpringPull(problem, region, displacement, mesh) * v * On(region))
    for foundation in problem.foundation:
        residual -= Coefficients((stress * n) * v * On(foundation.boundary))
    if not disc.form.consistent:
        return residual
    if disc.form.lifted:
        return residual + _LiftedConsistency(disc, stress)
    if disc.method.discontinuous:
        mean = 0.5 * (stress + problem.material.OtherStress(strain)) * n
        residual -= Coefficients(mean * (v - v.Other()) * dx(skeleton=True, bonus_intorder=EXTRA))
        for region in problem.dirichlet:
            residual -= Coefficients((stress * n) * v * On(region))
    for region in problem.roller:
        residual -= Coefficients(((stress * n) * n) * (v * n) * On(region))
    return residual


def _LiftedConsistency(disc: Discretization, stress: Any) -> Array:
    """The coefficients of v -> (C eps(u), r_0([v])), for the liftings of the method."""
    lifting = Lifting(disc, order=disc.facetform.operators.liftorder)
    operators, q = lifting.operators, lifting.space.TestFunction()
    projected = operators.inverseMQ @ Coefficients(InnerProduct(stress, q) * dx(bonus_intorder=EXTRA))
    return -(operators.J.T @ (operators.inverseMF @ (operators.N @ projected)))


def _ExactStrain(disc: Discretization, u: Any) -> Any:
    """eps(u) by symbolic differentiation, kept by NGSolve even where it is zero."""
    dim = disc.mesh.dim
    if not isinstance(u, CoefficientFunction) or isinstance(u, GridFunction) or u.dim != dim:
        raise ProblemError(f"displacement is {u!r}; give a CoefficientFunction of x, y, z with {dim} components, which can be "
                           "differentiated")
    return ExactStrain(u) + Parameter(0) * Id(dim)


def _CheckPrescribed(disc: Discretization, u: Any) -> None:
    """Raise ProblemError unless u has the values prescribed on Gamma_D and the normal values of the rollers."""
    problem, mesh, n, one = disc.problem, disc.mesh, specialcf.normal(disc.mesh.dim), disc.facets.space.TestFunction()
    size = np.sqrt(Integrate(u * u, mesh) / Integrate(CF(1), mesh))
    differences = {("dirichlet", region): u - value for region, value in problem.dirichlet.items()}
    differences |= {("roller", region): u * n - value for region, value in problem.roller.items()}
    for (kind, region), difference in differences.items():
        measure = ds(skeleton=True, definedon=mesh.Boundaries(region))
        difference = FromInside(difference, mesh.Boundaries(region), f"{kind}[{region!r}]")
        square, area = (Coefficients(Unfolded(value) * one * measure).sum() for value in (difference * difference, CF(1)))
        if not np.sqrt(max(square, 0) / area) <= 1e-8 * size:       # data are often typed with fewer digits than round-off
            raise ProblemError(f"displacement differs from {kind}[{region!r}] by {np.sqrt(square / area):.3g} in the mean; "
                               "give the exact solution of this problem, which takes the prescribed values")
