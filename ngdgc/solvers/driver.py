"""The driver stops, records and raises; a solver is only its iteration."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from ..contact.boundary import ContactBoundary, Scale
from ..contact.equilibrium import Equilibrium
from ..contact.graph import CheckEnds, Distance, Scales
from ..contracts import Array
from ..discrete.problem import DiscreteProblem
from ..exceptions import NotConvergedError, ProblemError, SolveInterrupted
from ..linear.equations import CheckDiscretization
from ..solution.history import Step
from ..solution.resultants import BALANCE
from ..solution.solution import ContactSolution
from ..tools.values import Integer, PositiveNumber

WINDOW = 10         # iterations over which progress is judged
NOPROGRESS = 0.97   # best value of a window against the best before: 0.997 per iteration
ROUNDOFF = 1e-9     # changes below this that do not shrink are round-off: higher orders and penalties amplify it
BLOWUP = 1e6        # growth of the displacement over two windows that no convergent iteration shows


def LawResidual(contact: ContactBoundary, iterate: Equilibrium) -> float:
    """Distance of displacement and traction to the graph of the contact law (`graph.Distance`), the largest over all points."""
    return float(Distance(contact, iterate.displacement, iterate.traction).distance.max(initial=0))


@contextmanager
def Current(disc: Any) -> Iterator[DiscreteProblem]:
    """The Discretization with the data of now, for a solver alone; ProblemError if they change while it works."""
    CheckDiscretization(disc)
    with disc.lock:
        current = disc.Current()
        yield current
        current.state.CheckFixed()


def SolutionOf(disc: Any, vector: Array, traction: Array, **rest: Any) -> ContactSolution:
    """The solution of a discrete problem: what it says, `DiscreteProblem.result`, else a ContactSolution."""
    return (disc.result or ContactSolution)(disc, vector, traction, **rest)


def CheckLimits(solver: Any) -> None:
    """The solver's tol and maxiter as a float and an integer; ProblemError if they are none."""
    for name, value in (("tol", PositiveNumber(solver.tol, "tol", "give a number between 0 and 1", below=1)),
                        ("maxiter", Integer(solver.maxiter, "maxiter", "give a positive integer"))):
        object.__setattr__(solver, name, value)


def CheckCallback(callback: Any) -> None:
    """Raise ProblemError unless a callback can be called, or is None."""
    if callback is not None and not callable(callback):
        raise ProblemError(f"callback is {callback!r}; give a function of a Step, such as print, or None")


def Drive(solver: Any, disc: DiscreteProblem, iterates: Iterable[Equilibrium], callback: Callable[[Step], object] | None,
          Diagnose: Callable[[str], tuple[str, Any]], *, Predict: Callable[[], float | None] | None = None,
          window: int | None = WINDOW, rest: float = 0.0) -> ContactSolution:
    """Run an iteration to its tolerance and return the ContactSolution.

    `iterates` yields `Equilibrium`s, the first of them the start, and ends if the iteration gives up by itself.
    window : iterations over which the progress of a fixed-point iteration is judged.  It has converged if change <= tol and
        residual <= tol.  None: no fixed-point iteration, residual <= tol is enough
    rest : part of all iterations so far that one that is not monotone may rest, if that is more than the window
    `Diagnose(reason)` returns (message, Contraction or None) for an iteration that has failed: "slow" at the limit of
    iterations, "stalled" when it gave up; for fixed-point iterations "cycle" when over the last window neither change nor
    residual has fallen and the path leads nowhere, "roundoff" when the tolerance is out of reach.  `Predict()` returns the
    contraction factor of the iteration at its last iterate, unless it cycles; the solution calls it when it is asked for.
    """
    CheckCallback(callback)
    history: list[Step] = []
    positions: list[Array] = []
    iterate: Any = None
    start = time.perf_counter()

    def Solution(converged: bool, contracts: bool) -> ContactSolution:
        return SolutionOf(disc.Moved(iterate.motion), iterate.vector, iterate.traction, history=history, converged=converged,
                          solver=repr(solver), Predict=Predict if contracts else None)

    try:
        for number, iterate in enumerate(iterates):
            if positions:
                size, _ = Scales(disc.contact, iterate.displacement, iterate.traction)
                change = Scale(iterate.displacement - positions[-1]) / size
                if np.array_equal(iterate.displacement, positions[-1]):
                    change = 0.0
                history.append(Step(number, float(change), LawResidual(disc.contact, iterate), disc.solves,
                                    time.perf_counter() - start))
                if callback is not None:
                    callback(history[-1])
            positions = positions[-(window or 1):] + [iterate.displacement]
            reason = _Verdict(solver, history, positions, np.abs(disc.contact.gap).max(initial=0), window, rest)
            if reason == "converged":
                CheckEnds(disc.contact, iterate.displacement, iterate.traction)
                solution = Solution(True, True)
                _CheckEquilibrium(solution, Solution)
                return solution
            if reason:
                break
        message, contraction = Diagnose(reason or "stalled")
        raise NotConvergedError(f"{message} ({_Last(history)})", Solution(False, reason == "slow"), contraction)
    except KeyboardInterrupt as interrupt:
        if iterate is None or disc.alone:
            raise
        raise SolveInterrupted(Solution(False, False)) from interrupt


def _CheckEquilibrium(solution: ContactSolution, Failed: Callable[..., ContactSolution]) -> None:
    """Raise NotConvergedError unless the displacement is in equilibrium with loads and tractions, as the iteration believes."""
    residual = solution.EquilibriumResidual()
    # Written so that a NaN is caught as well.
    if not residual <= BALANCE:
        disc = solution.disc
        raise NotConvergedError(
            f"the law of contact holds, but A u - f + T' W t is {residual:.2g} of its terms: inverse={disc.inversekind!r} did "
            "not solve the linear equations.  Remedy: another inverse, or look for coefficients of extreme size and degenerate "
            "elements", Failed(False, False))


def _Verdict(solver: Any, history: Sequence[Step], positions: Sequence[Array], gap: float, window: int | None,
             rest: float) -> str | None:
    """None to go on, "converged", or the reason to give up.

    `gap` is a length by which a foundation may move the body, whatever its loads.
    """
    if not history:
        return None
    last = history[-1]
    if last.residual <= solver.tol and (window is None or last.change <= solver.tol):
        return "converged"
    if window is None:
        return "slow" if last.number >= solver.maxiter else None
    if Scale(positions[-1]) > BLOWUP * max(Scale(positions[0]), gap):
        return "cycle"
    if not _Progresses(history, window) and not _GoesSomewhere(positions[-window - 1:]):
        if max(step.change for step in history[-window:]) < ROUNDOFF:
            return "roundoff"
        if not _Progresses(history, max(window, int(rest * len(history)))):
            return "cycle"
    return "slow" if last.number >= solver.maxiter else None


def _Progresses(history: Sequence[Step], window: int) -> bool:
    """False if over the last window neither the change nor the law residual fell below its best value before.

    The best and not the latest: a point that turns from stick to slip lifts the change of a convergent iteration for a while.
    """
    if len(history) < 2 * window:
        return True
    before, recent = history[:-window], history[-window:]
    return any(min(getattr(step, name) for step in recent) < NOPROGRESS * min(getattr(step, name) for step in before)
               for name in ("change", "residual"))


def _GoesSomewhere(positions: Sequence[Array]) -> bool:
    """False for a path that turns back: a slow monotone iteration also changes by nearly constant amounts, but goes on."""
    steps = [b - a for a, b in zip(positions[:-1], positions[1:])]
    lengths = [np.linalg.norm(step) for step in steps]
    turns = [np.vdot(a, b) for a, b in zip(steps[:-1], steps[1:])]
    return bool(sum(turn < 0 for turn in turns) < len(turns) / 2 and np.linalg.norm(sum(steps)) > 0.5 * sum(lengths))


def _Last(history: Sequence[Step]) -> str:
    if not history:
        return "before its first iteration"
    last = history[-1]
    return f"after {last.number} iterations: change {last.change:.2g}, law residual {last.residual:.2g}"
