"""The rows of Table 2, discontinuous methods with a penalty: interior penalty, Bassi et al., Brezzi et al., LDG, NIPG, IIPG."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal, cast

import numpy as np
from ngsolve import Mesh

from ..blocks.operators import FacetOperators
from ..contracts import Array
from ..exceptions import ProblemError
from ..tools.calls import ByKeyword
from ..tools.values import Among, HIGHEST, Integer, PositiveNumber
from .discontinuous import DiscontinuousGalerkin
from .guarantee import ALWAYS, UNKNOWN, Bounded, Guarantee
from .penalty import MARGIN, ElasticPenalty, LargestEigenvalues, Penalty, ScalarPenalty


@ByKeyword
@dataclass(frozen=True, kw_only=True, repr=False)
class PenalisedRow(DiscontinuousGalerkin):
    """A discontinuous method with a penalty.

    penalty : "auto" or a number > 0, whose meaning is the row's
    weighting : of the jump penalty, "mu" for the paper's eta/h [u]:[v] with eta = penalty mu order^2, or "C" for
        penalty order^2/h {C}[u]:[v]; by default "mu" for a number and "C" for "auto"
    form : "edge", B^(1)_h with averages of C eps(u) on the facets, or "lifting", B^(2)_h with C eps(u) against r_0([v])
    liftorder : degree l >= 0 of the lifting space Q_h, by default the order k.  The forms agree where C eps(V_h) lies in Q_h:
        simplices with l >= k - 1 and parallelograms with l = k, for constant C.
    singular : True admits liftorder=0 for r_e, to look at a singular matrix; no such problem is solved

    Rows: `stabilisation`, "jump" for the jump penalty and "lifting" for eta C r_e[u]:r_e[v].

    >>> isinstance(InteriorPenalty(penalty=30), PenalisedRow), InteriorPenalty(penalty=30).penalty
    (True, 30)
    """

    penalty: Any = "auto"
    weighting: str | None = None
    form: str = "edge"
    liftorder: int | None = None
    singular: bool = False
    stabilisation: ClassVar[str]

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
        self._CheckForm()
        self._CheckLifting()

    def _CheckLifting(self) -> None:
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

    def _Stabilised(self, lifting: Callable[[int], FacetOperators], material: Any, mesh: Mesh,
                   order: int) -> tuple[FacetOperators, Any, float | None, Guarantee]:
        liftorder, most = order if self.liftorder is None else self.liftorder, HIGHEST[mesh.dim]
        operators = lifting(Integer(liftorder, "liftorder", f"in {mesh.dim}D it must be at most {most}, up to which forms are "
                                    "tested", least=0, most=most))
        rule = eta = None
        if self.stabilisation == "jump":
            rule = Penalty(self.penalty, self.weighting, operators)
            guarantee = self._OfJumps(rule, operators)
        else:
            facetcount, needed = _NeededLifting(operators, self.form)
            eta = self.penalty
            if self.penalty == "auto":
                eta = MARGIN * (needed if np.isfinite(needed) else facetcount)
            guarantee = Bounded(needed / eta) if np.isfinite(needed) else UNKNOWN
        if self.globallift and (self.form == "lifting" or not guarantee.holds and operators.contains):
            # A square, g + 2 (C eps, r_0) + (C r_0, r_0): coercive for any penalty, if (C eps, r_0) is what the form has.
            guarantee = ALWAYS
        if self.stabilisation == "lifting" and operators.liftorder == 0:
            guarantee = UNKNOWN     # singular, which only eigenvalues see
        return operators, rule, eta, self._Told(guarantee)

    def _OfJumps(self, rule: ScalarPenalty | ElasticPenalty, operators: FacetOperators) -> Guarantee:
        """What the penalty of the jumps guarantees: |(1 + theta) <[u],{C eps(u)}>| is what Young's inequality has to bound."""
        if self.theta == -1:
            return ALWAYS
        if self.form == "lifting" and not operators.contains:
            return UNKNOWN      # the form has another coupling than the one that was estimated
        return Bounded(rule.kappa * ((1 + self.theta) / 2) ** 2)

    def _Told(self, guarantee: Guarantee) -> Guarantee:
        """A guarantee with words, where it may not hold: an automatic penalty keeps its bound."""
        if guarantee.holds or self.penalty == "auto" and guarantee.kappa is not None:
            return guarantee
        value = self.penalty if isinstance(self.penalty, str) else f"{self.penalty:g}"
        return replace(guarantee, culprit=f"penalty={value}", remedy=self._Remedy(guarantee.kappa))

    def _Remedy(self, kappa: float | None) -> str:
        """What to do about a lost coercivity."""
        if kappa is not None:
            # The bound is inversely proportional to the penalty; one per cent more than needed survives the rounding.
            return f"penalty={1.01 * self.penalty * kappa:.3g} is safe, and so is penalty='auto'"
        other = "lifting" if self.form == "edge" else "edge"
        return (f"take form={other!r}, a larger liftorder or a larger penalty: the stress is not in the lifting space and no "
                "bound known for this form")


class InteriorPenalty(PenalisedRow):
    """Symmetric interior penalty (Arnold 1982; Tables 1 and 2, first row).

    B_h(u,v) = int C eps_h(u):eps_h(v) - <[u],{C eps(v)}> - <[v],{C eps(u)}> + penalty;  flux {C eps(u)} - eta/h [u].

    penalty : "auto", C-weighted and computed on every element so that the form is coercive with margin
        (`penalty.ElasticPenalty`); or a number, the paper's eta = penalty * mu * order^2 in
        alpha(u,v) = sum_e int_e eta_e/h_e [u]:[v], coercive only while it is large enough for order and lam/mu.

    >>> InteriorPenalty(penalty=30).name
    'IP'
    """

    name, globallift, stabilisation = "IP", False, "jump"


class NonsymmetricInteriorPenalty(PenalisedRow):
    """NIPG (Riviere, Wheeler, Girault 1999): + <[u],{C eps(v)}> in place of -, coercive for any penalty, not symmetric.

    Its L2 error is of order k + 1 for odd k only, if at all: the form is not adjoint consistent.

    >>> NonsymmetricInteriorPenalty().symmetric
    False
    """

    name, globallift, stabilisation, theta = "NIPG", False, "jump", -1


class IncompleteInteriorPenalty(PenalisedRow):
    """IIPG (Dawson, Sun, Wheeler 2004): without <[u],{C eps(v)}>, not symmetric; needs a quarter of IP's penalty.

    >>> IncompleteInteriorPenalty().theta
    0
    """

    name, globallift, stabilisation, theta = "IIPG", False, "jump", 0


class BassiEtAl(PenalisedRow):
    """Bassi et al. (Tables 1 and 2, second row): flux {C eps(u)} + eta {C r_e[u]}.

    penalty : eta in beta(u,v) = sum_e int eta C r_e([u]):r_e([v]), coercive above the number of facets of an element at most;
        "auto" is twice that.  In the edge form, where the stress is not in Q_h, an eigenvalue problem on every element takes
        the place of that number; with l < k - 1 there may be no such eta, and the form is refused.

    >>> BassiEtAl(form="lifting").form
    'lifting'
    """

    name, globallift, stabilisation = "Bassi", False, "lifting"


class BrezziEtAl(PenalisedRow):
    """Brezzi et al. (Tables 1 and 2, third row): flux {C eps(u)} + {C r_0[u]} + eta {C r_e[u]}.

    penalty : eta in beta, coercive for any eta > 0 in the lifting form and where the forms agree; "auto" as for BassiEtAl.

    >>> BrezziEtAl().globallift
    True
    """

    name, globallift, stabilisation = "Brezzi", True, "lifting"


class LDG(PenalisedRow):
    """Local discontinuous Galerkin (Tables 1 and 2, fourth row): flux {C eps(u)} + {C r_0[u]} - eta/h [u].

    penalty : as for InteriorPenalty, coercive for any number > 0 in the lifting form and where the forms agree.

    >>> LDG(penalty=1e-3).stabilisation
    'jump'
    """

    name, globallift, stabilisation = "LDG", True, "jump"


def _NeededLifting(operators: FacetOperators, form: str) -> tuple[int, float]:
    """(largest number of facets of an element, an eta above which the form with eta sum_e (C r_e, r_e) is coercive)."""
    whole = operators.facets
    facets = int(whole.Largest(np.array([(operators.share[group.facets] > 0).sum(axis=1).max() for group in operators.groups])))
    if form == "lifting" or operators.contains:
        # |r_0|^2 <= N_K sum_e |r_e|^2 on an element with N_K facets in E0.
        return facets, facets
    couplings = [operators.EdgeCoupling(group) for group in operators.groups]
    if any(coupling is None for coupling in couplings):
        return facets, np.inf
    return facets, whole.Largest(np.array([LargestEigenvalues(cast(Array, coupling), group).max()
                                           for coupling, group in zip(couplings, operators.groups)]))
