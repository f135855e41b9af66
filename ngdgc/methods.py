"""The methods a problem can be discretised with: what space, and where the displacement is coupled weakly."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from ngsolve import H1, L2, VectorH1, VectorL2

from .coefficients import IsNumber
from .exceptions import ProblemError
from .penalty import ElasticPenalty, ScalarPenalty
from .skeleton import Clamped, Interior, Roller, SkeletonForm


@dataclass(frozen=True, kw_only=True)
class InteriorPenalty:
    """Symmetric interior penalty (Arnold 1982; Table 1, first row), edge form B^(1)_{1,h}.

    B_h(u,v) = int C eps_h(u):eps_h(v) - <[u],{C eps(v)}> - <[v],{C eps(u)}> + penalty, on V_h = piecewise P_k.

    penalty : "auto", C-weighted and computed on every element so that the form is coercive with margin
        (`penalty.ElasticPenalty`); or a number > 0, the paper's eta = penalty * mu * order^2 in
        alpha(u,v) = sum_e int_e eta_e/h_e [u]:[v], coercive only while it is large enough for order and lam/mu.

    >>> InteriorPenalty(penalty=30).name
    'IP'
    """

    penalty: Any = "auto"
    name: ClassVar[str] = "IP"
    discontinuous: ClassVar[bool] = True

    def __post_init__(self):
        if self.penalty != "auto" and not (IsNumber(self.penalty) and 0 < self.penalty < np.inf):
            raise ProblemError(f"penalty is {self.penalty!r}; give 'auto' or a positive number")

    def Space(self, mesh, order, clamped):
        return VectorL2(mesh, order=order, dgjumps=True)

    def ScalarSpace(self, mesh, order):
        return L2(mesh, order=order)

    def Form(self, problem, facets, space, order):
        """B_h with E0 = interior facets, Gamma_D and rollers."""
        return SkeletonForm(problem, space, _Parts(problem, facets, order, self.penalty, True, problem.dirichlet))


@dataclass(frozen=True)
class Conforming:
    """H1-conforming finite elements of order k, the reference.

    Displacements prescribed on all components are imposed strongly; normal ones (rollers, inclined or curved) by the boundary
    terms of the interior penalty method with its computed penalty, as in Nitsche 1971.

    >>> Conforming().name
    'H1'
    """

    name: ClassVar[str] = "H1"
    discontinuous: ClassVar[bool] = False

    def Space(self, mesh, order, clamped):
        return VectorH1(mesh, order=order, dirichlet=clamped)

    def ScalarSpace(self, mesh, order):
        return H1(mesh, order=order)

    def Form(self, problem, facets, space, order):
        """a(u, v), with the terms of E0 = rollers."""
        return SkeletonForm(problem, space, _Parts(problem, facets, order, "auto", False, {}))


METHODS = {"ip": InteriorPenalty, "h1": Conforming}


def _Parts(problem, facets, order, penalty, interior, clamped):
    """The sets of facets of E0, with one penalty for all."""
    share = np.where(facets.neighbours > 1, 0.5, 0.0) if interior else np.zeros(len(facets.neighbours))
    for region in (*clamped, *problem.roller):
        share[facets.On(region)] = 1
    if not np.any(share):
        return []
    material, mesh = problem.material, facets.mesh
    rule = (ElasticPenalty(material, facets, order, share) if penalty == "auto"
            else ScalarPenalty(penalty, material, facets, order, share))
    sets = [Interior(material, mesh, rule)] if interior else []
    sets += [Clamped(material, mesh, rule, region, value) for region, value in clamped.items()]
    sets += [Roller(material, mesh, rule, region, value) for region, value in problem.roller.items()]
    return sets
