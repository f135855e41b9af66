"""The methods a problem can be discretised with: what space, and where the displacement is coupled weakly."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from ngsolve import H1, L2, Mesh, VectorH1, VectorL2

from ..blocks.operators import FacetOperators
from ..exceptions import ProblemError
from ..problem.problem import ContactProblem
from ..tools.calls import ByKeyword
from ..tools.parallel import Batched
from ..tools.values import Among, HIGHEST, Integer, PositiveNumber
from .blockform import FacetForm
from .lifting import WeakFacets
from .penalty import MARGIN, LargestEigenvalues, Penalty
from .symbolform import Clamped, Interior, Roller, SkeletonForm
from .symbollifting import LiftedSkeletonForm

@ByKeyword
@dataclass(frozen=True, kw_only=True, repr=False)
class DiscontinuousGalerkin:
    """What the discontinuous methods share; a method is one row of class variables.

    penalty : "auto" or a number > 0, whose meaning is the row's
    weighting : of the jump penalty, "mu" for the paper's eta/h [u]:[v] with eta = penalty mu order^2, or "C" for
        penalty order^2/h {C}[u]:[v]; by default "mu" for a number and "C" for "auto"
    form : "edge", B^(1)_h with averages of C eps(u) on the facets, or "lifting", B^(2)_h with C eps(u) against r_0([v])
    liftorder : degree l >= 0 of the lifting space Q_h, by default the order k.  The forms agree where C eps(V_h) lies in Q_h:
        simplices with l >= k - 1 and parallelograms with l = k, for constant C.
    singular : True admits liftorder=0 for r_e, to look at a singular matrix; no such problem is solved

    Rows: `globallift`, the term (C r_0[u], r_0[v]); `stabilisation`, "jump" for the jump penalty and "lifting" for
    eta C r_e[u]:r_e[v]; `theta`, the factor of -<[u],{C eps(v)}>, 1 for a symmetric form.
    """

    penalty: Any = "auto"
    weighting: str | None = None
    form: str = "edge"
    liftorder: int | None = None
    singular: bool = False
    name: ClassVar[str]
    globallift: ClassVar[bool]
    stabilisation: ClassVar[str]
    theta: ClassVar[int] = 1
    discontinuous: ClassVar[bool] = True

    if TYPE_CHECKING:
        def __init__(self, *, penalty: float | Literal["auto"] = "auto", weighting: Literal["mu", "C"] | None = None,
                     form: Literal["edge", "lifting"] = "edge", liftorder: int | None = None,
                     singular: bool = False) -> None: ...

    def __post_init__(self) -> None:
        if not (isinstance(self.penalty, str) and self.penalty == "auto"):
            object.__setattr__(self, "penalty", PositiveNumber(self.penalty, "penalty", "give 'auto' or a positive number"))
        if not Among(self.weighting, (None, "mu", "C")):
            raise ProblemError(f"weighting is {self.weighting!r}; choose 'mu' or 'C'")
        if self.weighting is not None and self.stabilisation == "lifting":
            raise ProblemError(f"weighting={self.weighting!r} does not apply to {self.name}: r_e is weighted by C; "
                               "leave it out")
        if not Among(self.form, ("edge", "lifting")):
            raise ProblemError(f"form is {self.form!r}; choose 'edge' or 'lifting'")
        self._CheckLifting()

    def _CheckLifting(self):
        if not isinstance(self.singular, bool):
            raise ProblemError(f"singular is {self.singular!r}; give True or False")
        if self.liftorder is not None:
            object.__setattr__(self, "liftorder", Integer(
                self.liftorder, "liftorder", f"it must be an integer of at least 0, at most {HIGHEST[2]}", least=0,
                most=HIGHEST[2]))
        liftless = self.form == "edge" and self.stabilisation == "jump" and not self.globallift
        if self.liftorder is not None and liftless:
            raise ProblemError(f"liftorder={self.liftorder} does not apply to the edge form of {self.name}: it lifts nothing; "
                               "leave it out or take form='lifting'")
        if self.liftorder == 0 and self.stabilisation == "lifting" and not self.singular:
            raise ProblemError(f"liftorder=0 makes {self.name} singular for every penalty: r_e with constants sees only the "
                               "mean of a jump, so jumps of mean zero cost nothing; take liftorder >= 1, by default the order "
                               "(singular=True admits it, to look at the matrix)")

    def __repr__(self):
        """The class with the arguments that are not the defaults."""
        given = [f"{field.name}={getattr(self, field.name)!r}" for field in fields(self)
                 if getattr(self, field.name) != field.default]
        return f"{type(self).__name__}({', '.join(given)})"

    @property
    def symmetric(self) -> bool:
        """True if B_h(u, v) = B_h(v, u)."""
        return self.theta == 1

    def Space(self, mesh: Mesh, order: int, clamped: str) -> Any:
        space = VectorL2(mesh, order=order, dgjumps=True)
        # Functions of L2 have no values on boundary elements; NGSolve, asked to integrate there, may end the process.
        space.SetDefinedOn(~mesh.Boundaries(".*"))
        space.FinalizeUpdate()
        return space

    def ScalarSpace(self, mesh: Mesh, order: int) -> Any:
        return L2(mesh, order=order)

    @Batched
    def Form(self, problem: ContactProblem, facets: Any, space: Any, order: int, assembly: str) -> Any:
        """B_h with E0 = interior facets, Gamma_D and rollers."""
        share, rollers = WeakFacets(problem, facets)
        liftorder, most = order if self.liftorder is None else self.liftorder, HIGHEST[facets.mesh.dim]
        Integer(liftorder, "liftorder", f"in {facets.mesh.dim}D it must be at most {most}, up to which forms are tested",
                least=0, most=most)
        operators = FacetOperators(problem.material, facets, order, liftorder, share, rollers)
        rule = eta = None
        if self.stabilisation == "jump":
            rule = Penalty(self.penalty, self.weighting, operators)
            # |(1 + theta) <[u],{C eps(u)}>| is what Young's inequality has to bound.
            bound = rule.bound * ((1 + self.theta) / 2) ** 2
            if self.form == "lifting" and self.theta != -1 and not operators.contains:
                bound = np.inf      # the form has another coupling than the one that was estimated
        else:
            facetcount, needed = _NeededLifting(operators, self.form)
            eta = self.penalty
            if self.penalty == "auto":
                eta = MARGIN * (needed if np.isfinite(needed) else facetcount)
            bound = needed / eta
        if self.globallift and (self.form == "lifting" or bound >= 1 and operators.contains):
            # A square, g + 2 (C eps, r_0) + (C r_0, r_0): coercive for any penalty, if (C eps, r_0) is what the form has.
            bound = 0
        if self.stabilisation == "lifting" and liftorder == 0:
            bound = np.inf      # singular, which only eigenvalues see
        terms = {"lifted": self.form == "lifting", "globallift": self.globallift, "theta": self.theta, "bound": bound}
        if assembly == "facet":
            return FacetForm(problem, space, operators, rule=rule, eta=eta, **terms)
        parts = _Parts(problem, facets, rule)
        if self.form == "edge" and not self.globallift and eta is None:
            return SkeletonForm(problem, space, parts, theta=self.theta, bound=bound)
        return LiftedSkeletonForm(problem, space, parts, facets, liftorder=liftorder, eta=eta, **terms)


class InteriorPenalty(DiscontinuousGalerkin):
    """Symmetric interior penalty (Arnold 1982; Tables 1 and 2, first row).

    B_h(u,v) = int C eps_h(u):eps_h(v) - <[u],{C eps(v)}> - <[v],{C eps(u)}> + penalty;  flux {C eps(u)} - eta/h [u].

    penalty : "auto", C-weighted and computed on every element so that the form is coercive with margin
        (`penalty.ElasticPenalty`); or a number, the paper's eta = penalty * mu * order^2 in
        alpha(u,v) = sum_e int_e eta_e/h_e [u]:[v], coercive only while it is large enough for order and lam/mu.

    >>> InteriorPenalty(penalty=30).name
    'IP'
    """

    name, globallift, stabilisation = "IP", False, "jump"


class NonsymmetricInteriorPenalty(DiscontinuousGalerkin):
    """NIPG (Riviere, Wheeler, Girault 1999): + <[u],{C eps(v)}> in place of -, coercive for any penalty, not symmetric.

    Its L2 error is of order k + 1 for odd k only, if at all: the form is not adjoint consistent.

    >>> NonsymmetricInteriorPenalty().symmetric
    False
    """

    name, globallift, stabilisation, theta = "NIPG", False, "jump", -1


class IncompleteInteriorPenalty(DiscontinuousGalerkin):
    """IIPG (Dawson, Sun, Wheeler 2004): without <[u],{C eps(v)}>, not symmetric; needs a quarter of IP's penalty.

    >>> IncompleteInteriorPenalty().theta
    0
    """

    name, globallift, stabilisation, theta = "IIPG", False, "jump", 0


class BassiEtAl(DiscontinuousGalerkin):
    """Bassi et al. (Tables 1 and 2, second row): flux {C eps(u)} + eta {C r_e[u]}.

    penalty : eta in beta(u,v) = sum_e int eta C r_e([u]):r_e([v]), coercive above the number of facets of an element at most;
        "auto" is twice that.  In the edge form, where the stress is not in Q_h, an eigenvalue problem on every element takes
        the place of that number; with l < k - 1 there may be no such eta, and the form is refused.

    >>> BassiEtAl(form="lifting").form
    'lifting'
    """

    name, globallift, stabilisation = "Bassi", False, "lifting"


class BrezziEtAl(DiscontinuousGalerkin):
    """Brezzi et al. (Tables 1 and 2, third row): flux {C eps(u)} + {C r_0[u]} + eta {C r_e[u]}.

    penalty : eta in beta, coercive for any eta > 0 in the lifting form and where the forms agree; "auto" as for BassiEtAl.

    >>> BrezziEtAl().globallift
    True
    """

    name, globallift, stabilisation = "Brezzi", True, "lifting"


class LDG(DiscontinuousGalerkin):
    """Local discontinuous Galerkin (Tables 1 and 2, fourth row): flux {C eps(u)} + {C r_0[u]} - eta/h [u].

    penalty : as for InteriorPenalty, coercive for any number > 0 in the lifting form and where the forms agree.

    >>> LDG(penalty=1e-3).stabilisation
    'jump'
    """

    name, globallift, stabilisation = "LDG", True, "jump"


@ByKeyword
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
    symmetric: ClassVar[bool] = True

    def Space(self, mesh: Mesh, order: int, clamped: str) -> Any:
        # Boundary elements that are no sides of elements would bring unknowns that nothing determines.
        return VectorH1(mesh, order=order, dirichlet=clamped, definedon=mesh.Materials(".*"))

    def ScalarSpace(self, mesh: Mesh, order: int) -> Any:
        return H1(mesh, order=order, definedon=mesh.Materials(".*"))

    @Batched
    def Form(self, problem: ContactProblem, facets: Any, space: Any, order: int, assembly: str) -> Any:
        """a(u, v), with the terms of E0 = rollers; `assembly` makes no difference."""
        _, rollers = WeakFacets(problem, facets)
        if not rollers.any():
            return SkeletonForm(problem, space, [])
        operators = FacetOperators(problem.material, facets, order, order, rollers.astype(float), rollers)
        rule = Penalty("auto", None, operators)
        return SkeletonForm(problem, space, [Roller(problem, facets, rule, region) for region in problem.roller])


def _NeededLifting(operators, form):
    """(largest number of facets of an element, an eta above which the form with eta sum_e (C r_e, r_e) is coercive)."""
    facets = max(int((operators.share[group.facets] > 0).sum(axis=1).max()) for group in operators.groups)
    if form == "lifting" or operators.contains:
        # |r_0|^2 <= N_K sum_e |r_e|^2 on an element with N_K facets in E0.
        return facets, facets
    couplings = [operators.EdgeCoupling(group) for group in operators.groups]
    if any(coupling is None for coupling in couplings):
        return facets, np.inf
    return facets, max(LargestEigenvalues(coupling, group).max() for coupling, group in zip(couplings, operators.groups))


def _Parts(problem, facets, rule):
    """The sets of facets of E0 in symbols, with one penalty for all."""
    return [Interior(problem.material, facets.mesh, rule),
            *(Clamped(problem, facets, rule, region) for region in problem.dirichlet),
            *(Roller(problem, facets, rule, region) for region in problem.roller)]


METHODS: dict[str, Any] = {
    "ip": InteriorPenalty, "bassi": BassiEtAl, "brezzi": BrezziEtAl, "ldg": LDG, "nipg": NonsymmetricInteriorPenalty,
    "iipg": IncompleteInteriorPenalty, "h1": Conforming}
