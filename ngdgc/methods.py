"""The methods a problem can be discretised with: what space, and where the displacement is coupled weakly."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from ngsolve import H1, L2, VectorH1, VectorL2

from .coefficients import IsNumber
from .exceptions import ProblemError
from .facetform import FacetForm
from .lifting import FacetOperators, WeakFacets
from .penalty import MARGIN, Penalty
from .skeleton import Clamped, Interior, Roller, SkeletonForm


@dataclass(frozen=True, kw_only=True)
class DiscontinuousGalerkin:
    """What the discontinuous methods share; a method is one row of class variables.

    penalty : "auto" or a number > 0, whose meaning is the row's
    form : "edge", B^(1)_h with averages of C eps(u) on the facets, or "lifting", B^(2)_h with C eps(u) against r_0([v])
    liftorder : degree l >= 0 of the lifting space Q_h, by default the order k.  The forms agree where C eps(V_h) lies in Q_h:
        simplices with l >= k - 1 and parallelograms with l = k, for constant C.

    Rows: `globallift`, the term (C r_0[u], r_0[v]); `stabilisation`, "jump" for eta_e/h_e [u]:[v] and "lifting" for
    eta C r_e[u]:r_e[v].
    """

    penalty: Any = "auto"
    form: str = "edge"
    liftorder: int | None = None
    name: ClassVar[str]
    globallift: ClassVar[bool]
    stabilisation: ClassVar[str]
    discontinuous: ClassVar[bool] = True

    def __post_init__(self):
        automatic = isinstance(self.penalty, str) and self.penalty == "auto"
        if not automatic and not (IsNumber(self.penalty) and 0 < self.penalty < np.inf):
            raise ProblemError(f"penalty is {self.penalty!r}; give 'auto' or a positive number")
        if self.form not in ("edge", "lifting"):
            raise ProblemError(f"form is {self.form!r}; choose 'edge' or 'lifting'")
        if self.liftorder is not None and (not isinstance(self.liftorder, int) or self.liftorder < 0):
            raise ProblemError(f"liftorder is {self.liftorder!r}; it must be an integer of at least 0")
        liftless = self.form == "edge" and self.stabilisation == "jump" and not self.globallift
        if self.liftorder is not None and liftless:
            raise ProblemError(f"liftorder={self.liftorder} does not apply to the edge form of {self.name}: it lifts nothing")
        if self.liftorder == 0 and self.stabilisation == "lifting":
            raise ProblemError(f"liftorder=0 makes {self.name} singular for every penalty: r_e with constants sees only the "
                               "mean of a jump, so jumps of mean zero cost nothing; take liftorder >= 1, by default the order")

    def Space(self, mesh, order, clamped):
        return VectorL2(mesh, order=order, dgjumps=True)

    def ScalarSpace(self, mesh, order):
        return L2(mesh, order=order)

    def Form(self, problem, facets, space, order):
        """B_h with E0 = interior facets, Gamma_D and rollers."""
        share, rollers = WeakFacets(problem, facets)
        liftorder = order if self.liftorder is None else self.liftorder
        operators = FacetOperators(problem.material, facets, order, liftorder, share, rollers)
        sigma, bound = self._Stabilise(operators, problem.material, facets, order, share)
        if self.globallift:
            sigma = sigma + operators.G
            # A square, g + 2 (C eps, r_0) + (C r_0, r_0): coercive for any penalty, if (C eps, r_0) is what the form has.
            bound = 0 if self.form == "lifting" or operators.contains else bound
        return FacetForm(problem, space, operators, sigma, lifted=self.form == "lifting", bound=bound)

    def _Stabilise(self, operators, material, facets, order, share):
        """(facet matrix, bound) of the stabilisation alone."""
        if self.stabilisation == "jump":
            rule = Penalty(self.penalty, material, facets, order, share)
            known = self.form == "edge" or operators.contains
            return operators.PenaltyMass(rule), rule.bound if known else np.inf
        # |r_0|^2 <= N_K sum_e |r_e|^2 on an element with N_K facets in E0, so eta > max N_K suffices.
        most = float(((facets.incidence != 0).T @ (share > 0).astype(float)).max())
        eta = MARGIN * most if self.penalty == "auto" else self.penalty
        known = self.form == "lifting" or operators.contains
        return eta * operators.localG, most / eta if known else np.inf


class InteriorPenalty(DiscontinuousGalerkin):
    """Symmetric interior penalty (Arnold 1982; Tables 1 and 2, first row).

    B_h(u,v) = int C eps_h(u):eps_h(v) - <[u],{C eps(v)}> - <[v],{C eps(u)}> + penalty;  flux {C eps(u)} - eta/h [u].

    penalty : "auto", C-weighted and computed on every element so that the form is coercive with margin
        (`penalty.ElasticPenalty`); or a number, the paper's eta = penalty * mu * order^2 in
        alpha(u,v) = sum_e int_e eta_e/h_e [u]:[v], coercive only while it is large enough for order and lam/mu.

    The edge form is assembled from NGSolve's symbols (`skeleton` module).

    >>> InteriorPenalty(penalty=30).name
    'IP'
    """

    name, globallift, stabilisation = "IP", False, "jump"

    def Form(self, problem, facets, space, order):
        if self.form == "lifting":
            return super().Form(problem, facets, space, order)
        return SkeletonForm(problem, space, _Parts(problem, facets, order, self.penalty, True, problem.dirichlet))


class BassiEtAl(DiscontinuousGalerkin):
    """Bassi et al. (Tables 1 and 2, second row): flux {C eps(u)} + eta {C r_e[u]}.

    penalty : eta in beta(u,v) = sum_e int eta C r_e([u]):r_e([v]), coercive above the number of facets of an element at most;
        "auto" is twice that.

    >>> BassiEtAl(form="lifting").form
    'lifting'
    """

    name, globallift, stabilisation = "Bassi", False, "lifting"


class BrezziEtAl(DiscontinuousGalerkin):
    """Brezzi et al. (Tables 1 and 2, third row): flux {C eps(u)} + {C r_0[u]} + eta {C r_e[u]}.

    penalty : eta in beta, coercive for any eta > 0; "auto" is twice the number of facets of an element.

    >>> BrezziEtAl().globallift
    True
    """

    name, globallift, stabilisation = "Brezzi", True, "lifting"


class LDG(DiscontinuousGalerkin):
    """Local discontinuous Galerkin (Tables 1 and 2, fourth row): flux {C eps(u)} + {C r_0[u]} - eta/h [u].

    penalty : as for InteriorPenalty, coercive for any number > 0.

    >>> LDG(penalty=1e-3).stabilisation
    'jump'
    """

    name, globallift, stabilisation = "LDG", True, "jump"


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


METHODS = {"ip": InteriorPenalty, "bassi": BassiEtAl, "brezzi": BrezziEtAl, "ldg": LDG, "h1": Conforming}


def _Parts(problem, facets, order, penalty, interior, clamped):
    """The sets of facets of E0, with one penalty for all."""
    share, rollers = WeakFacets(problem, facets)
    if not interior:
        share = np.where(rollers, share, 0)
    if not np.any(share):
        return []
    material, mesh = problem.material, facets.mesh
    rule = Penalty(penalty, material, facets, order, share)
    sets = [Interior(material, mesh, rule)] if interior else []
    sets += [Clamped(material, mesh, rule, region, value) for region, value in clamped.items()]
    sets += [Roller(material, mesh, rule, region, value) for region, value in problem.roller.items()]
    return sets
