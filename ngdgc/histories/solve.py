"""Load histories: a body led along a time, friction remembering where it was."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ..discrete.problem import DiscreteProblem
from ..exceptions import NotConvergedError, ProblemError, SolveInterrupted
from ..linear.equations import CheckDiscretization
from ..solution.solution import ContactSolution
from ..solvers.driver import CheckCallback
from ..solvers.nested import NestedNewtonSolver
from ..solvers.newton.solver import SemismoothNewtonSolver
from ..tools.calls import ByKeyword
from ..tools.values import Finite, PositiveNumber
from .energies import Dissipation, FoundationEnergy
from .history import LoadHistory
from .increments import Increments
from .loading import Abrasion, Loading, Instant, Work
from .recall import Recall, Restoring
from .start import CheckParameter, CheckStart
from .states import Increment, LoadState
from .steps import LESS, Steps

HALVINGS = 6    # of an increment that fails


@ByKeyword
def SolveHistory(disc: Any, *, parameter: Any, times: Any, solver: Any = None, change: float | None = None,
                 callback: Callable[[Increment], object] | None = None, start: LoadHistory | None = None) -> LoadHistory:
    """The states of a Discretization at the times, each an increment from the one before; the LoadHistory.

    In an increment friction acts against the change of u_t since the last state, sticking points do not move: the rate form of
    the law by backward Euler.  The first state is one from rest, as Solve(disc) gives it.  Where the path of the loads does not
    matter (proportional loads, Coulomb friction, no gap, exponent 1) all this is the same as one step.

    parameter : the NGSolve Parameter that is the time; displacements, loads, gap and laws may depend on it, the material not.
        It is set here, and in the end what it was
    times : t_1 < ... < t_m
    solver : `NestedNewtonSolver` or `SemismoothNewtonSolver`, for the first state and with its tol for the others
    change : largest part of the points in contact, by their weights, that may come to another zone, of separation, stick and
        slip, in an increment, 0 < change < 1; None: any
    callback : gets every `Increment`
    start : a LoadHistory that this one goes on from; the states are the new ones, work and dissipation go on

    An increment is halved, up to 64 parts, on which Newton's method fails, which changes more zones, or where a fifth of what
    would take the pressure away is worn off.  Each part is an increment; states are those at the times.

    Raises ProblemError for data that are none;
    NotConvergedError if the smallest part fails, SolveInterrupted on Ctrl-C when there is a state or an iterate of the first
    one: `states` is the LoadHistory up to there.

    >>> from ngsolve import CF, Parameter
    >>> from ngdgc import *
    >>> from ngdgc.meshes import RectangleMesh
    >>> t = Parameter(0)
    >>> foundation = Foundation("bottom", NormalCompliance(1e4), friction=CoulombFriction(0.3))
    >>> problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, dirichlet={"top": CF((0.04 * t * (2 - t), -0.02))})
    >>> history = SolveHistory(Discretization(problem, LDG(), RectangleMesh(4)), parameter=t, times=[0, 0.5, 1, 1.5, 2])
    >>> [round(float(force)) for force in history.forces["bottom"][:, 0]]       # back at the start, with a force
    [0, -6, -6, -4, 4]
    """
    CheckDiscretization(disc)
    CheckCallback(callback)
    solver = NestedNewtonSolver() if solver is None else solver
    if not isinstance(solver, (NestedNewtonSolver, SemismoothNewtonSolver)):
        raise ProblemError(f"solver is {solver!r}; give NestedNewtonSolver() or SemismoothNewtonSolver(), which start from the "
                           "last state")
    CheckParameter(disc, parameter)
    if change is not None:
        change = PositiveNumber(change, "change", "it is a part of the contact zone between 0 and 1, such as 0.1", below=1)
    run = _Run(disc, parameter, solver, Steps(change), callback)
    if start is not None:
        CheckStart(start, run.recall)
    return run.Along(_Times(times, start), start)


def _Times(times: Any, start: LoadHistory | None) -> list[float]:
    """The times as floats; ProblemError unless they are numbers that increase."""
    remedy = "give numbers that increase, such as np.linspace(0, 1, 21)"
    try:
        found = [Finite(time, "a time", remedy) for time in times]
    except TypeError as error:
        raise ProblemError(f"times is {times!r}; {remedy}") from error
    if not found:
        raise ProblemError(f"times is empty; {remedy}")
    if back := [(a, b) for a, b in zip(found[:-1], found[1:]) if not a < b]:
        raise ProblemError(f"times run backwards or stand still, {back[0][1]:g} comes after {back[0][0]:g}; {remedy}: a body "
                           "that goes back is data that depend on the time")
    if start is not None and found[0] < start.times[-1]:
        raise ProblemError(f"times begin at {found[0]:g}, and start ends at {start.times[-1]:g}; give times from there on")
    return found


def _Kept(count: int) -> str:
    """What a failure says of the states before."""
    words = {0: "it is the first state", 1: "the state before is kept in `states`"}
    return words.get(count, f"the {count} states before are kept in `states`")


class _Run:
    """One run of `SolveHistory`."""

    def __init__(self, disc: Any, parameter: Any, solver: Any, steps: Steps, callback: Any) -> None:
        self.disc, self.parameter, self.solver, self.steps, self.callback = disc.Current(), parameter, solver, steps, callback
        self.recall = Recall(self.disc, parameter)
        self.current: DiscreteProblem = self.disc
        self.increments: Increments | None = None

    def Along(self, times: list[float], start: LoadHistory | None) -> LoadHistory:
        """The history at the times."""
        history = LoadHistory(self.disc, self.parameter, (), self.recall)
        last, moment = None, None
        if start is not None:
            last = start.Last()
            moment = self.recall.Instant(last)
        try:
            with self.disc.lock, Restoring(self.parameter):
                for time in times:
                    moment, last = self._To(time, moment, last)
                    history.states = (*history.states, last)
                    if self.callback is not None:
                        self.callback(last.increment)
        except NotConvergedError as error:
            raise NotConvergedError(f"at time {time:g}: {error}; {_Kept(len(history))}",
                                    error.solution, error.contraction, states=history) from error
        except ProblemError as error:
            raise ProblemError(f"at time {time:g}: {error}") from error
        except KeyboardInterrupt as stop:
            solution = history[-1] if len(history) else getattr(stop, "solution", None)
            if solution is None:
                raise
            raise SolveInterrupted(solution, states=history) from stop
        return history

    def _To(self, time: float, moment: Instant | None, last: LoadState | None) -> tuple[Instant, LoadState]:
        """The state at a time, and what is kept of it."""
        begin, before, parts = clock.perf_counter(), self.current.solves, 0
        work, dissipation, abrasion = (last.work, last.dissipation, last.abrasion) if last else (0.0, 0.0, 0.0)
        for old, new in self._Parts(moment, last.time if last else time, time):
            contact, parts = new.disc.contact, parts + 1
            work += Work(old, new)
            abrasion += Abrasion(old, new)
            dissipation += Dissipation(contact, new.displacement, new.traction)
        increment = Increment(time, parts, new.disc.solves - before, new.residual, clock.perf_counter() - begin)
        energy = new.elastic + FoundationEnergy(contact, new.displacement)
        return new, LoadState(time=time, displacement=new.displacement, traction=new.traction, before=new.disc.memory,
                              after=new.memory, work=work, energy=energy, dissipation=dissipation, abrasion=abrasion,
                              increment=increment, vector=new.vector, punches=new.disc.punches)

    def _Parts(self, old: Instant | None, begin: float, end: float) -> Iterator[tuple[Instant | None, Instant]]:
        """(state before, state) of every part of an increment, halved where it fails or changes too much."""
        done, part, before = 0.0, 1.0, np.inf
        while done < 1:
            time = end if done + part == 1 else begin + (done + part) * (end - begin)
            try:
                new = self._At(time, old)
            except NotConvergedError:
                part /= 2
                if old is None or part < 0.5 ** HALVINGS:
                    raise
                continue
            size = 0.0 if old is None or part == 0.5 ** HALVINGS else self.steps.Size(old, new)
            if 1 < size < LESS * before:
                part, before = part / 2, size
                if self.increments is not None:
                    self.increments.Back()
                continue
            done, before = 1 if old is None else done + part, np.inf
            yield old, new
            old = new

    def _At(self, time: float, old: Instant | None) -> Instant:
        """The state at a time, from the one before, or from rest."""
        if old is not None and self.increments is None and self._Remembers(old):
            self.increments = Increments(old, self.solver.tol)
            self.recall.response = self.increments.response
        self.parameter.Set(time)
        self.current = disc = self.current.Current() if old is None else self.current.Current().After(*old.memory)
        if self.increments is not None and disc.elastic is self.disc.elastic:
            found = self.increments.Next(disc)
            if found is not None:
                return found
        self.increments = None
        solution = self._Solved(disc, old)
        self.current = solution.disc
        return Instant(disc=solution.disc, loading=Loading.Of(solution.disc), displacement=solution.displacement,
                      traction=solution.traction, vector=solution.vector, residual=solution.history[-1].residual)

    def _Remembers(self, old: Instant) -> bool:
        """Do `Increments` serve after a state?  Contact tells which stiffness is in the matrix, which has to be symmetric."""
        disc = old.disc
        return bool(np.any(old.traction)) and disc.symmetric and not disc.iterates and disc.elastic is self.disc.elastic

    def _Solved(self, disc: DiscreteProblem, old: Instant | None) -> ContactSolution:
        if old is None:
            return self.solver.Solve(disc)
        newton = self.solver if isinstance(self.solver, SemismoothNewtonSolver) else SemismoothNewtonSolver(tol=self.solver.tol)
        return newton.Solve(disc, start=(old.displacement - old.disc.contact.found, old.traction))
