"""The Uzawa iteration of Xiao, Wang, Han 2018, section 4, (4.3)-(4.8), with an implicit normal step and accelerated."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, Literal, TypeVar

import numpy as np

from ...contact.equilibrium import Equilibrium
from ...contact.parts import ContactPart, OverParts
from ...contracts import Array
from ...discrete.problem import DiscreteProblem
from ...exceptions import ProblemError
from ...solution.history import Step
from ...solution.solution import ContactSolution
from ...tools.calls import ByKeyword
from ...tools.values import Among, IsNumber, PositiveNumber
from ..driver import CheckLimits, Current, Drive
from .contraction import ComplianceNorm, Contraction, ContractionFactor, EstimateContraction
from .steps import AdaptiveStep, Anderson, ExplicitStep, ImplicitStep

WINDOW = 30         # iterations over which accelerated and adaptive steps are judged
REST = 0.5          # of all iterations so far: adaptive steps rest up to 0.3 of them and converge, failing ones go on resting
PREDICTION = 20     # applications of A^-1 at most for the predicted contraction factor


Kind = TypeVar("Kind", bound=ExplicitStep | ImplicitStep)


@ByKeyword
@dataclass(frozen=True, kw_only=True)
class UzawaSolver:
    """Uzawa's iteration: one solve with the unchanged matrix per step.  By default it is the paper's,

        u^0:       B_h(u^0, v) = (f, v),  lambda^0 = 0
        lambda^i = P(lambda^(i-1) + rho p_t u_t^(i-1)),   P the projection onto the unit ball
        u^i:       B_h(u^i, v) = (f, v) - int_GammaC p_n(u_n^(i-1) - g) v_n - int_GammaC p_t lambda^i.v_t

    with the normal compliance explicit, which converges on soft foundations only.  For the reduced law p_t = k_t this is the
    paper's iteration; a bound that depends on the penetration is lagged, p_t = p_t(u_n^(i-1) - g).  With normal="implicit" the
    traction t = p_n n + p_t lambda makes a proximal gradient step of the dual problem, S: traction -> displacement on Gamma_C,

        t^i + gamma U = t^(i-1) + gamma u^(i-1),  (U, t^i) on the graph of the law,     u^i = u_f - S t^i

    one equation per point of Gamma_C.  If the bound does not depend on the penetration it converges for every gamma < 2/|S| and
    every stiffness of the foundation, p_n' -> infinity included (forward-backward splitting).  Coulomb's friction has no such
    theory; on very stiff foundations coefficients of 1 to 3, and H1 of higher order from 0.5 on, can defeat the fast variants.

    tol : stops when the change |u^i - u^(i-1)| / |u^i| in the maximum norm over the points of Gamma_C and the law residual
        (`driver.LawResidual`) are both at most tol.  The second guards against a small rho, for which u changes little
        although lambda is far from its limit.
    maxiter : limit of iterations
    rho : "auto" or a number > 0.  Explicit: the step of lambda [1/(stress length)].  Implicit: the step gamma of the traction
        [stress/length]; "auto" is 1.8/|S|, |S| computed, and "adaptive" a step that learns from the last one
        (`steps.AdaptiveStep`), which needs no |S|.
    normal : "explicit" or "implicit"
    acceleration : None or "anderson" (`steps.Anderson`), which combines the last steps so that they cancel best

    The explicit rule for "auto".  The friction traction p_t lambda moves by the step s = rho p_t^2 [stress/length].  In the
    variables p and p_t lambda the iteration is the projection, onto p >= 0 and |p_t lambda| <= p_t, of
    diag(0, I) - D^(1/2) S D^(1/2) with D = diag(p_n', s), symmetric in L2(Gamma_C).  Its eigenvalues lie below 1 because S is
    positive, and above -1 as soon as D^(1/2) S D^(1/2) < diag(I, 2 I), for which

        |p_n' S_nn| + s |S_tt| / 2 < 1

    is sufficient.  So the right thing to keep constant is s, not rho: rho = s/p_t^2 at each point, one number if p_t is
    constant.  With both norms estimated at u^0 (`EstimateContraction`), where the zone in contact is largest,

        s = 1.8 max(1 - |p_n' S_nn|, 1/10) / |S_tt|

    stays a tenth below the limit.  If nothing is left no rho helps, and `NotConvergedError` says so.

    Predicted and observed contraction are `solution.rates`.

    >>> UzawaSolver(normal="implicit", acceleration="anderson").rho
    'auto'
    """

    tol: float = 1e-10
    maxiter: int = 10000
    rho: Any = "auto"
    normal: str = "explicit"
    acceleration: str | None = None

    if TYPE_CHECKING:
        def __init__(self, *, tol: float = 1e-10, maxiter: int = 10000, rho: float | Literal["auto", "adaptive"] = "auto",
                     normal: Literal["explicit", "implicit"] = "explicit",
                     acceleration: Literal["anderson"] | None = None) -> None: ...

    def __post_init__(self) -> None:
        if not Among(self.normal, ("explicit", "implicit")):
            raise ProblemError(f"normal is {self.normal!r}; choose 'explicit' or 'implicit'")
        if not Among(self.acceleration, (None, "anderson")):
            raise ProblemError(f"acceleration is {self.acceleration!r}; choose None or 'anderson'")
        if isinstance(self.rho, str) and self.rho == "adaptive":
            if self.normal == "explicit" or self.acceleration:
                raise ProblemError("rho is 'adaptive', which is for normal='implicit' without acceleration: Anderson's needs "
                                   "steps that are all alike; take rho='auto', or change these")
        elif not (isinstance(self.rho, str) and self.rho == "auto"):
            object.__setattr__(self, "rho", PositiveNumber(
                self.rho, "rho", "give 'auto', a positive number, or with normal='implicit' 'adaptive'"))
        CheckLimits(self)

    def Solve(self, disc: DiscreteProblem, *, callback: Callable[[Step], object] | None = None) -> ContactSolution:
        """Return the ContactSolution of a Discretization; `callback(step)` is called with every `Step`.

        Raises NotConvergedError, with history, estimated contraction numbers and remedy, when the iterates cycle or the limit
        of iterations is reached; SolveInterrupted, with the last iterate, on Ctrl-C.
        """
        with Current(disc) as disc:
            run = (_Explicit if self.normal == "explicit" else _Implicit)(self, disc)
            fixed = self.acceleration is None and self.rho != "adaptive"
            if fixed:
                return Drive(self, disc, run.Iterates(), callback, run.Diagnose, Predict=run.Predict)
            return Drive(self, disc, run.Iterates(), callback, run.Diagnose, window=WINDOW, rest=REST)


class _Run(ABC, Generic[Kind]):
    """One run of an iteration on one discretisation."""

    def __init__(self, solver: UzawaSolver, disc: DiscreteProblem) -> None:
        self.solver, self.disc, self.contact = solver, disc, disc.contact
        self.recent: list[Array] = []       # states of the last steps
        self.count = 0

    @abstractmethod
    def Step(self, u: Array) -> Kind:
        """The step that is made, from the displacement (n, d) without contact."""

    @abstractmethod
    def Diagnose(self, reason: str) -> tuple[str, Contraction | None]:
        """Cause and remedy of a failure, and contraction numbers or None."""

    def Iterates(self) -> Iterator[Equilibrium]:
        contact = self.contact
        free = self.disc.FreeSolution()
        self.last = u = contact.Displacement(free)
        yield Equilibrium(vector=free, displacement=u, traction=np.zeros_like(u))
        self.step = self.Step(u)
        state = self.step.Start(u)
        anderson = Anderson(self.step.metric) if self.solver.acceleration else None
        while True:
            self.recent = self.recent[-1:] + [state]
            traction, memory = self.step.At(state)
            vector = free - self.disc.Response(traction)
            self.last = u = contact.Displacement(vector)
            self.count += 1
            yield Equilibrium(vector=vector, displacement=u, traction=traction)
            image = self.step.Next(memory, u)
            state = anderson(state, image) if anderson else image

    def Predict(self) -> float | None:
        """The contraction factor at the last iterate, None if the loads caused no contact at all."""
        if not self.recent or not np.any(self.recent[-1]):
            return None
        return ContractionFactor(self.disc, self.step, self.recent[-1], min(PREDICTION, self.count))

    @property
    def constant(self) -> bool:
        """True if no friction bound depends on penetration, pressure or slip at the last iterate: then there is an energy."""
        r, slip = self.contact.Penetration(self.last), self.contact.Slip(self.last)
        parts = self.contact.parts
        slopes = OverParts(parts, ContactPart.BoundDerivatives, r, OverParts(parts, ContactPart.Pressure, r))
        return not np.any(slopes) and not np.any(OverParts(parts, ContactPart.SlipFactor, slip)[1])

    @property
    def remedies(self) -> str:
        """Solvers that can do more than this one."""
        better = "SemismoothNewtonSolver()"
        if self.solver.normal == "explicit" or not self.solver.acceleration:
            better = f"UzawaSolver(normal='implicit', acceleration='anderson') or {better}"
        return better


class _Explicit(_Run[ExplicitStep]):

    def Step(self, u: Array) -> ExplicitStep:
        if self.solver.rho != "auto":
            return ExplicitStep(self.contact, self.solver.rho, None)
        r, slip = self.contact.Penetration(u), self.contact.Slip(u)
        unit = EstimateContraction(self.disc, r, step=np.where(self.contact.Bound(r, slip) > 0, 1.0, 0.0))
        return ExplicitStep(self.contact, None, 0.9 * max(1 - unit.normal, 0.1) / unit.friction if unit.friction else 1.0)

    def _Contraction(self, r: Array, slip: Array) -> Contraction:
        bound = self.contact.Bound(r, slip)
        return EstimateContraction(self.disc, r, step=self.step.Rho(bound) * bound ** 2)

    def Diagnose(self, reason: str) -> tuple[str, Contraction]:
        """Cause and remedy of a failure, and the contraction numbers at the last iterates."""
        places = [(self.contact.Penetration(u), self.contact.Slip(u)) for u, _ in self.recent]
        # A cycle visits zones that are never active together; the zone of one iterate tells more than their union.
        number = max((self._Contraction(*place) for place in places), key=lambda found: found.normal)
        if number.normal < 1 and reason == "cycle":
            number = self._Contraction(*np.max(places, axis=0))
        numbers = f"normal {number.normal:.3g}, friction {number.friction:.3g}, together they must be below 1"
        rho = f"rho={self.solver.rho!r}"
        if reason == "roundoff":
            return f"tol={self.solver.tol:g} is below what round-off allows here; take a larger tol", number
        if reason == "slow":
            remedy = "" if self.solver.rho == "auto" else "take rho='auto', "
            return (f"Uzawa converges too slowly with {rho} ({numbers}); large sticking zones are slow for every rho.  Remedy: "
                    f"{remedy}raise maxiter or tol, or take {self.remedies}"), number
        if number.normal >= 1:
            return (f"Uzawa cannot converge for any rho: the contraction number |p_n' S_nn| is {number.normal:.3g} and must be "
                    "below 1, so the iterates cycle instead of settling.  Remedy: a foundation that is softer by this factor, "
                    f"a stiffer body, or {self.remedies}, which treat the normal compliance implicitly"), number
        if number.normal + number.friction >= 1:
            factor = (1 - number.normal) / number.friction
            if self.solver.rho == "auto":       # chosen at u^0, where other zones were in contact
                return f"Uzawa cycles because its step is too large ({numbers}).  Remedy: {self.remedies}", number
            return f"Uzawa cycles because {rho} is too large ({numbers}).  Remedy: {factor:.2g} of it, or rho='auto'", number
        if self.constant and self.solver.acceleration:
            return (f"Uzawa's acceleration makes no progress although plain steps contract ({numbers}).  Remedy: "
                    f"acceleration=None, or {self.remedies}"), number
        return (f"Uzawa cycles although its numbers predict convergence ({numbers}): the friction bound depends on "
                "the penetration and is lagged.  Remedy: a smaller friction coefficient, a smaller rho, or "
                f"{self.remedies}"), number


class _Implicit(_Run[ImplicitStep]):

    def Step(self, u: Array) -> ImplicitStep:
        if self.solver.rho == "adaptive":
            # Two steps of Lanczos cost two solves; a norm that is too small only makes the first step too long.
            norm = ComplianceNorm(self.disc, maxiter=2)
            return AdaptiveStep(self.contact, 1 / norm if norm else 1.0)
        if self.solver.rho != "auto":
            return ImplicitStep(self.contact, float(self.solver.rho))
        norm = ComplianceNorm(self.disc)
        return ImplicitStep(self.contact, 1.8 / norm if norm else 1.0)

    def Diagnose(self, reason: str) -> tuple[str, None]:
        """Cause and remedy of a failure; contraction numbers are those of the explicit iteration, so None."""
        rho, number = f"rho={self.solver.rho!r}", self.step.gamma * ComplianceNorm(self.disc)
        if reason == "roundoff":
            return f"tol={self.solver.tol:g} is below what round-off allows here; take a larger tol", None
        if reason == "cycle" and self.solver.rho != "adaptive" and number >= 2:
            return (f"Uzawa with the implicit normal step cycles because {rho} is too large: rho |S| is {number:.3g} and must "
                    f"be below 2.  Remedy: {1.8 / number:.2g} of it, or rho='auto'"), None
        if reason == "slow":
            remedy = "take rho='auto', " if IsNumber(self.solver.rho) and number < 1 else ""
            return (f"Uzawa with the implicit normal step converges too slowly with {rho} (rho |S| is {number:.3g}).  Remedy: "
                    f"{remedy}raise maxiter or tol, or take {self.remedies}"), None
        fast = f"acceleration={self.solver.acceleration!r}" if self.solver.acceleration else rho
        if self.constant and (self.solver.acceleration or self.solver.rho == "adaptive"):
            return (f"Uzawa with the implicit normal step makes no progress with {fast}; friction does not depend on the "
                    "penetration, so plain steps converge.  Remedy: rho='auto' without acceleration, or "
                    "SemismoothNewtonSolver()"), None
        return ("Uzawa with the implicit normal step makes no progress although its step is small enough: friction depends on "
                "the penetration or weakens with the slip, so there is no energy to decrease.  Remedy: a smaller friction "
                f"coefficient, or {self.remedies}"), None
