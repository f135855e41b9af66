"""A run of the semismooth Newton method: equations, line search, renewed matrices, load continuation, diagnosis."""

import time
from dataclasses import dataclass
from itertools import islice

import numpy as np

from ...contact.equilibrium import Equilibrium
from ...contact.graph import ContactGraph, Scales
from ...contact.response import Apply, Compliance
from ...contact.stiffness import CAP, BodyStiffness, LawStiffness
from ..driver import LawResidual
from .holding import Holding
from .pathfollowing import FEW, Path
from .pointwise import PointwiseEquation
from .recycling import Recycled
from .reduced import ReducedCompliance

FLOOR = 1e-4        # smallest D where nothing but the foundation holds the body, in units of what holds it (`Holding`)
STICKING = 0.003    # least stiffness of stick there, in units of gamma: much more hides what a soft foundation does
TIMES = 10          # stiffness of stick there, in units of that of the foundation, between STICKING and CAP
HOLD = 0.01         # part of the slope that holds it which every point has at first
NEAR = 0.35         # S at one point, in units of 1/gamma; met within a factor of 3 on all meshes tried
FORCING = 3e-3      # relative residual of the linear equations
ROUGH = 0.1         # the largest one, for tolerances that are near
ACCURATE = 1e-9     # the smallest one that is asked for
SAMEPIECE = 0.1     # change of dt/dq, which is between 0 and 1, that tells pieces of the graph apart
GOAL = 0.1          # part of the tolerance at which the last linear equation aims
LINEAR = 200        # applications of an inverse for one linear equation
HALVINGS = 8        # of a Newton step
REDUCED = 8         # reduced problems for one Newton step
GAIN = 0.6          # of the merit function, that asks for one more
DECREASE = 1e-4     # relative decrease of the merit function that a full step must bring
RENEW = 20          # applications of an inverse that a factorisation without prediction serves at least
SETTLED = 1e-3      # ratio of merits after a step that hardly changed the zones
PATIENCE = 8        # steps in which the merit function must halve
HASTE = 4           # the same where nothing but the foundation holds the body, as long as the load has not been raised in steps
SMALL = 1e-8        # law residuals below this that do not shrink are round-off
LOADSTEP = 1 / 32   # smallest step of the load continuation
CORRECTIONS = 12    # Newton steps for one load
TRIALS = 30         # Newton steps before a path is followed instead
WORK = 500          # applications of an inverse for the load continuation
SECONDS = 15.0      # for the load continuation


@dataclass(frozen=True)
class State:
    """A point of the graph with F there (n, d), its merit (`_Merit`), and the iterate in equilibrium with it."""

    point: object
    F: np.ndarray
    merit: float
    iterate: Equilibrium


class NewtonRun:
    """One run of the method on one discretisation.

    Attributes
    ----------
    steps : list of (length, applications of the inverse, merit after/before), one for each Newton step
    state : the last State
    """

    def __init__(self, solver, disc, start):
        self.solver, self.disc, self.contact = solver, disc, disc.contact
        self.scale = BodyStiffness(disc)
        self.graph = ContactGraph(disc.contact, self.scale)
        self.weights = disc.contact.weights[:, None]
        self.held = not disc.unresisted
        self.holding = None if self.held else Holding(disc, self.scale)
        self.few = self.held and disc.contact.normals.size <= FEW
        self.given = start is not None
        self.patience = PATIENCE if self.held or self.given else HASTE
        self.start = self.graph.At(self._Rest() if start is None else self.graph.Coordinates(*start))
        self.steps, self.zones, self.reached = [], [], 0.0
        self.least, self.largest = None, 0.0
        self.recycled, self.base = Recycled(None, self.contact.weights), None
        self._Factorise(self.start, predicted=start is not None)

    def _Factorise(self, point, *, predicted):
        """Make the compliance operator; the stiffness of the law at the point goes into the matrix if that is a prediction."""
        self.predicted = predicted
        self.compliance = Compliance(self.disc, self.Stiffness(point) if predicted or not self.held else None)
        self.recycled.compliance = self.compliance
        n, dim = self.contact.normals.shape
        self.stiffness = np.zeros((n, dim, dim)) if self.compliance.stiffness is None else self.compliance.stiffness
        self.blocks = np.linalg.inv(self.stiffness + (self.scale / NEAR)[:, None, None] * np.eye(dim))

    def _Rest(self):
        return np.zeros_like(self.contact.normals) if self.held else self.holding.Rest()

    def Stiffness(self, point):
        """D (n, d, d) of the law at a point of the graph; it holds the body where nothing else does."""
        if self.held:
            return LawStiffness(point, self.scale, self.contact.normals)
        sticking = np.clip(TIMES * self.holding.stiffness / self.scale, STICKING, CAP)
        return (LawStiffness(point, self.scale, self.contact.normals, sticking=sticking[:, None])
                + FLOOR * self.scale[:, None, None] * self.holding.slope)

    def Iterates(self):
        state = self._Evaluate(self.start)
        yield state.iterate
        # Few points have a sure way, which need not wait until slow steps come to an end.
        yield from islice(self._Newton(state), TRIALS if self.few and not self.given else None)
        # Continuation starts from rest whatever the start was; who gave one has his own next choice.
        if self._Roundoff() or self.given:
            return
        self.patience = PATIENCE
        for Approach in (self._AlongPath, self._Continuation):
            state = Approach()
            if state is not None:
                self.steps.clear()
                yield from self._Newton(state)

    def _Newton(self, state):
        """Iterates under full load until the steps bring no more."""
        while not self._Stalled():
            state = self._Step(state)
            yield state.iterate
            near = self.steps[-1][2] < SETTLED or self._Roundoff()
            if near and not self.predicted and len(self.recycled.images) > RENEW:
                # The zones are nearly known now: with their stiffness in the matrix round-off and the work that is left shrink.
                self._Factorise(state.point, predicted=True)
                state = self._Evaluate(state.point)
            elif self._Roundoff():
                return

    def Resume(self, *, renew):
        """Iterates from the last point of the graph on, after the right-hand side of the equations has changed, nothing else.

        renew : put the stiffness of the law at that point into the matrix first
        """
        self.base, self.patience = None, PATIENCE
        self.steps.clear()
        if renew:
            self._Factorise(self.state.point, predicted=True)
        state = self._Evaluate(self.state.point)
        yield state.iterate
        yield from self._Newton(state)

    def _Evaluate(self, point, load=1.0):
        """The state at a point of the graph, by one application of the inverse."""
        # From the last equilibrium round-off would add up, and be kept from where the iteration had gone far astray.
        found, s, response = self.compliance.Meet(point.displacement, point.traction, load=load, near=self.base)
        if s is None:
            self.base = found
        else:
            self.recycled.Remember(s, response)
        F = point.displacement - found.displacement
        self.state = State(point, F, self._Merit(F), found)
        return self.state

    def _Merit(self, F):
        """|F|^2 in L2(Gamma_C); where nothing but the foundation holds the body, the energy of F in it and in D, over gamma.

        A soft foundation lets the body move by far more than it slips: of |F|^2 the slip would be round-off.  In tractions
        slip would weigh so much that no motion is let through.  A large D hides in F what is out of balance.
        """
        if self.held:
            return float(np.sum(self.weights * F ** 2))
        holding = self.holding.slope + self.stiffness / self.scale[:, None, None]
        return float(np.sum(self.weights * F * Apply(holding, F)))

    def _Step(self, state, load=1.0):
        """One Newton step, shortened until the merit falls; the best state found."""
        if state.merit == 0:
            return state
        if not self.held:
            # Where all points slip, or none touches, nothing would hold the body: its step would be a flight.
            self.largest = max(self.largest, state.merit)
            self.least = HOLD * np.sqrt(state.merit / self.largest)
        before = self.disc.solves
        enough = GOAL * self.solver.tol / self._Error(state)
        step, chosen = self._Direction(state, float(np.clip(enough, FORCING, ROUGH))), 1.0
        trial = self.graph.At(state.point.q + step)
        if enough < FORCING and np.abs(trial.derivative - state.point.derivative).max() < SAMEPIECE:
            # The step stays on one smooth piece, so its equation is the last one that matters, and worth solving well.
            step = self._Direction(state, max(enough, ACCURATE))
        applications = self.disc.solves - before
        best = self._Corrected(state, state.point.q + step, load)
        if best.merit > GAIN * state.merit:
            best, chosen = self._Shortened(state, step, load, best)
        self.state = best
        self.steps.append((chosen, applications, best.merit / state.merit))
        self.zones.append(best.point.zones)
        return best

    def _Shortened(self, state, step, load, best):
        """(best state, its length) of steps halved until the merit falls; `best` competes as a full one."""
        chosen = length = 1.0
        for _ in range(HALVINGS + 1):
            trial = self._Evaluate(self.graph.At(state.point.q + length * step), load)
            if trial.merit < best.merit:
                best, chosen = trial, length
            if best.merit <= (1 - DECREASE * length) * state.merit:
                break
            length /= 2
        return best, chosen

    def _Corrected(self, state, q, load):
        """The best of the states to which problems with a `ReducedCompliance` lead from q.

        One application of the inverse each; they know the zones that change on the way, which a linear equation cannot.
        """
        best = None
        for _ in range(REDUCED):
            q = ReducedCompliance(self.recycled, self.blocks).Minimise(self.graph, self._Equation, self._Merit, state, q)
            trial = self._Evaluate(self.graph.At(q), load)
            if best is None or trial.merit < best.merit:
                best = trial
            if trial.merit > GAIN * state.merit or LawResidual(self.contact, best.iterate) <= self.solver.tol:
                break
            state = trial
        return best

    def _Error(self, state):
        """Largest difference between the point of the graph and the iterate, in displacement and traction, no unit."""
        uscale, tscale = Scales(self.contact, state.iterate.displacement, state.iterate.traction)
        return max(np.abs(state.F).max() / uscale, np.abs(Apply(self.stiffness, state.F)).max() / tscale)

    def _Direction(self, state, forcing):
        """Newton's step in q, (n, d), from the `PointwiseEquation`."""
        equation = self._Equation(state.point)
        s, image = self.recycled.Solve(equation.Local, -Apply(equation.P, state.F), tol=forcing, maxiter=LINEAR)
        return equation.Step(state.F, image - Apply(self.blocks, s))

    def _Equation(self, point):
        least = None if self.least is None else self.least * self.holding.slope
        return PointwiseEquation(point, self.scale, self.stiffness, self.blocks, least=least)

    def _Stalled(self):
        recent = [ratio for _, _, ratio in self.steps[-self.patience:]]
        return len(recent) == self.patience and np.prod(recent) > 0.5

    def _Roundoff(self):
        """True if the last two steps brought nothing and hardly anything is left."""
        recent = [ratio for _, _, ratio in self.steps[-2:]]
        return len(recent) == 2 and min(recent) > 0.5 and LawResidual(self.contact, self.state.iterate) < SMALL

    def _AlongPath(self):
        """The state at the end of a `Path`, where the body is held and has few contact points; or None."""
        if not self.few:
            return None
        point = Path(Compliance(self.disc), self.scale).Follow()
        return None if point is None else self._Evaluate(point)

    def _Continuation(self):
        """The state under full load, reached from rest by raising the load in steps that adapt; None if that fails as well."""
        state, load, increment, before = self._Evaluate(self.graph.At(self._Rest()), 0.0), 0.0, 0.25, self.disc.solves
        end = time.perf_counter() + SECONDS
        while load < 1:
            self.reached = load
            if self.disc.solves - before > WORK or time.perf_counter() > end:
                return None
            increment = min(increment, 1 - load)
            self.steps.clear()
            trial = self._Evaluate(state.point, load + increment)
            goal, count = 1e-6 * trial.merit, 0
            while trial.merit > goal and count < CORRECTIONS:
                trial, count = self._Step(trial, load + increment), count + 1
            if trial.merit <= goal:
                state, load = trial, load + increment
                increment *= 2 if count <= CORRECTIONS // 2 else 1
            elif increment / 2 < LOADSTEP:
                return None
            else:
                increment /= 2
        return state

    def Diagnose(self, reason):
        """Cause and remedy of a failure."""
        if reason == "slow":
            return "Newton reached its limit of steps while still making progress; raise maxiter", None
        if LawResidual(self.contact, self.state.iterate) < SMALL:
            return f"tol={self.solver.tol:g} is below what round-off allows here; take a larger tol", None
        period = self._Period()
        if period:
            changing = int(np.sum(np.any(np.array(self.zones[-period:]) != self.zones[-1], axis=0)))
            what = f"Newton cycles with period {period} between states that differ in the zones of {changing} points"
        else:
            what = f"Newton stagnates, its last step shortened to {self.steps[-1][0] if self.steps else 1:.2g}"
        if not self.given:
            what += f", and raising the load in steps was given up at {self.reached:.0%} of it"
        if self.disc.unresisted:
            return (f"{what}.  The foundation alone resists {self.disc.unresisted}: there is no equilibrium if the loads pull "
                    "the body off or push it along harder than friction holds.  Remedy: other loads, dirichlet or roller"), None
        return (f"{what}.  With strong friction that grows with the pressure, or a law that is not monotone, there may be "
                "several solutions or none nearby.  Remedy: a smaller friction coefficient, other starts (MultiStart), or a "
                "finer mesh at the ends of the zones"), None

    def _Period(self):
        """Smallest number of steps > 1 after which the zones come back, twice; 0 if they do not."""
        for period in range(2, PATIENCE + 1):
            recent = self.zones[-2 * period - 1:]
            if len(recent) == 2 * period + 1 and all(np.array_equal(a, b) for a, b in zip(recent[:-period], recent[period:])):
                return 0 if np.array_equal(recent[-1], recent[-2]) else period
        return 0
