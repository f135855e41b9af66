"""The Uzawa iteration of Xiao, Wang, Han 2018, section 4, (4.3)-(4.8)."""

from dataclasses import dataclass
from numbers import Integral
from typing import Any

import numpy as np

from ..coefficients import IsNumber
from ..discretization import Discretization
from ..exceptions import ProblemError
from .contraction import EstimateContraction
from .driver import Drive, Iterate


@dataclass(frozen=True, kw_only=True)
class UzawaSolver:
    """Uzawa's iteration with the normal compliance explicit: one solve with the unchanged matrix per step.

        u^0:       B_h(u^0, v) = (f, v),  lambda^0 = 0
        lambda^i = P(lambda^(i-1) + rho p_t u_t^(i-1)),   P the projection onto the unit ball
        u^i:       B_h(u^i, v) = (f, v) - int_GammaC p_n(u_n^(i-1) - g) v_n - int_GammaC p_t lambda^i.v_t

    For the reduced law p_t = k_t this is the paper's iteration; a bound that depends on the penetration is lagged,
    p_t = p_t(u_n^(i-1) - g).

    tol : stops when the change |u^i - u^(i-1)| / |u^i| in the maximum norm over the points of Gamma_C and the law residual
        (`driver.LawResidual`) are both at most tol.  The second guards against a small rho, for which u changes little
        although lambda is far from its limit.
    maxiter : limit of iterations
    rho : step of lambda [1/(stress length)], a number > 0 or "auto".

    The rule for "auto".  The friction traction p_t lambda moves by the step s = rho p_t^2 [stress/length].  In the variables p
    and p_t lambda the iteration is the projection, onto p >= 0 and |p_t lambda| <= p_t, of diag(0, I) - D^(1/2) S D^(1/2) with
    D = diag(p_n', s), symmetric in L2(Gamma_C).  Its eigenvalues lie below 1 because S is positive, and above -1 as soon as
    D^(1/2) S D^(1/2) < diag(I, 2 I), for which

        |p_n' S_nn| + s |S_tt| / 2 < 1

    is sufficient.  So the right thing to keep constant is s, not rho: rho = s/p_t^2 at each point, one number if p_t is
    constant.  With both norms estimated at u^0 (`EstimateContraction`), where the zone in contact is largest,

        s = 1.8 max(1 - |p_n' S_nn|, 1/10) / |S_tt|

    stays a tenth below the limit.  If nothing is left no rho helps, and `NotConvergedError` says so.

    >>> UzawaSolver(tol=1e-8).rho
    'auto'
    """

    tol: float = 1e-10
    maxiter: int = 10000
    rho: Any = "auto"

    def __post_init__(self):
        if not (isinstance(self.rho, str) and self.rho == "auto" or IsNumber(self.rho) and 0 < self.rho < np.inf):
            raise ProblemError(f"rho is {self.rho!r}; give 'auto' or a positive number")
        if not IsNumber(self.tol) or not 0 < self.tol < 1:
            raise ProblemError(f"tol is {self.tol!r}; give a number between 0 and 1")
        if not isinstance(self.maxiter, Integral) or self.maxiter < 1:
            raise ProblemError(f"maxiter is {self.maxiter!r}; give a positive integer")

    def Solve(self, disc, *, callback=None):
        """Return the ContactSolution of a Discretization; `callback(step)` is called with every `Step`.

        Raises NotConvergedError, with history, estimated contraction numbers and remedy, when the iterates cycle or the limit
        of iterations is reached; SolveInterrupted, with the last iterate, on Ctrl-C.
        """
        if not isinstance(disc, Discretization):
            raise ProblemError(f"disc is {disc!r}; give Discretization(problem, method, mesh, order=1)")
        run = _Run(self, disc)
        return Drive(self, disc, run.Iterates(), callback, run.Diagnose)


class _Run:
    """One run of the iteration on one discretisation."""

    def __init__(self, solver, disc):
        self.solver, self.disc, self.contact = solver, disc, disc.contact
        self.step = None        # s of rho="auto"
        self.recent = []        # penetrations of the last steps

    def Iterates(self):
        contact = self.contact
        free = self.disc.FreeSolution()
        u = contact.Displacement(free)
        yield Iterate(free, np.zeros_like(u), u)
        if self.solver.rho == "auto":
            self.step = self._AutomaticStep(contact.Penetration(u), contact.Slip(u))
        multiplier = np.zeros_like(u)
        while True:
            r, slip = contact.Penetration(u), contact.Slip(u)
            self.recent = self.recent[-1:] + [(r, slip)]
            bound = contact.Bound(r, slip)
            multiplier = _OntoUnitBall(multiplier + (self._Rho(bound) * bound)[:, None] * contact.Tangential(u))
            traction = contact.Pressure(r)[:, None] * contact.normals + bound[:, None] * multiplier
            vector = free - self.disc.Response(traction)
            u = contact.Displacement(vector)
            yield Iterate(vector, traction, u)

    def _Rho(self, bound):
        """rho at every point, (n,); where there is no friction lambda does not matter and rests."""
        if self.step is None:
            return np.full(len(bound), self.solver.rho)
        return np.where(bound > 0, self.step / np.where(bound > 0, bound, 1) ** 2, 0)

    def _AutomaticStep(self, r, slip):
        unit = EstimateContraction(self.disc, r, step=np.where(self.contact.Bound(r, slip) > 0, 1.0, 0.0))
        return 0.9 * max(1 - unit.normal, 0.1) / unit.friction if unit.friction else 1.0

    def _Contraction(self, r, slip):
        bound = self.contact.Bound(r, slip)
        return EstimateContraction(self.disc, r, step=self._Rho(bound) * bound ** 2)

    def Diagnose(self, reason):
        """Cause and remedy of a failure, and the contraction numbers at the last iterates."""
        # A cycle visits zones that are never active together; the zone of one iterate tells more than their union.
        number = max((self._Contraction(*state) for state in self.recent), key=lambda found: found.normal)
        if number.normal < 1 and reason == "cycle":
            number = self._Contraction(*np.max(self.recent, axis=0))
        numbers = f"normal {number.normal:.3g}, friction {number.friction:.3g}, together they must be below 1"
        rho = f"rho={self.solver.rho!r}"
        if reason == "roundoff":
            return f"tol={self.solver.tol:g} is below what round-off allows here; take a larger tol", number
        if reason == "slow":
            remedy = "" if self.step is not None else ", or take rho='auto'"
            return (f"Uzawa converges too slowly with {rho} ({numbers}); large sticking zones are slow for every rho.  Remedy: "
                    f"raise maxiter or tol{remedy}"), number
        if number.normal >= 1:
            return (f"Uzawa cannot converge for any rho: the contraction number |p_n' S_nn| is {number.normal:.3g} and must be "
                    "below 1, so the iterates cycle instead of settling.  Remedy: a foundation that is softer by this factor, "
                    "a stiffer body, or a solver that treats the normal compliance implicitly"), number
        if number.normal + number.friction >= 1:
            factor = (1 - number.normal) / number.friction
            return f"Uzawa cycles because {rho} is too large ({numbers}).  Remedy: {factor:.2g} of it, or rho='auto'", number
        return (f"Uzawa cycles although its numbers predict convergence ({numbers}): the friction bound depends on the "
                "penetration and is lagged.  Remedy: a smaller friction coefficient, or a smaller rho"), number


def _OntoUnitBall(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1), 1)[:, None]
