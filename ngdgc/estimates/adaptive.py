"""Solving, estimating, marking and refining, until the error is as small as wanted."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ngsolve import Mesh

from ..contracts import Method
from ..discretization import Discretization
from ..exceptions import NotConvergedError, ProblemError, SolveInterrupted
from ..problem.problem import ContactProblem
from ..solution.history import Level, Step
from ..solution.solution import ContactSolution
from ..solvers.driver import CheckCallback
from ..solvers.nested import FromPrediction, LevelOf, NestedNewtonSolver, Transfer
from ..solvers.newton.paused import PausedNewton
from ..solvers.newton.solver import SemismoothNewtonSolver
from ..tools.calls import ByKeyword
from ..tools.values import Integer, PositiveNumber
from .conflicts import Conflict
from .marking import Marked
from .measures import Measure, Measured
from .refine import CheckRefinable, Refined

MOST = 2_000_000    # unknowns
FULL = 1e-10        # law residual of what is returned
LOOSE = 1e-4        # largest law residual on the way
BALANCE = 1e-2      # law residual on the way, in units of the relative error that is expected there
REDUCTION = 0.5     # of the error by a refinement, before there is experience
WINDOW = 5          # refinements that must reduce the error
STALLED = 0.95      # by this factor at least


@ByKeyword
def SolveAdaptive(problem: ContactProblem, method: Method, mesh: Mesh, *, order: int = 1, tol: float, goal: Any = "energy",
                  most: int = MOST, callback: Callable[[Step], object] | None = None) -> ContactSolution:
    """Solve, estimate the error, refine where it is large, until its estimate is at most tol; the ContactSolution at the end.

    mesh : to begin with, a coarse one; it stays what it is.  Its copies are bisected by Netgen: triangles, tetrahedra, and
        quadrilaterals in whole rows; curved boundaries are curved again
    tol : relative, for the goal "energy" |u - u_h|/|u_h| in the energy norm as `EstimateError` estimates it, of Conforming and
        methods of your own as `ResidualEstimate` does, which is larger
    goal : "energy"; or what `EstimateForce` estimates, "force", ("pressure", region) or ("displacement", point), for which tol
        is relative to the largest force, the pressure or the displacement
    most : unknowns
    callback : gets every Step; if it has a method Reached, as `output.Progress` has, that gets the Level of every mesh

    `solution.estimate` is the last estimate, `solution.levels` lists what every mesh took and its error, `solution.earlier` the
    solutions on the meshes before.  Each mesh starts from the one before (`nested.Transfer`); on the way the law is solved to a
    hundredth of the error that is expected, at the end to 1e-10.

    Raises ProblemError for what cannot be refined; NotConvergedError if tol is not reached with `most` unknowns, with the
    memory that is free, or at all for round-off; SolveInterrupted on Ctrl-C.  Their `solution` is that on the last mesh that
    was finished, if there is one.

    >>> from ngdgc import *
    >>> from ngdgc.cases import example_4_2
    >>> solution = SolveAdaptive(example_4_2.Problem(), InteriorPenalty(), example_4_2.Mesh(4), order=2, tol=0.1)
    >>> solution.estimate.relative < 0.1, solution.levels[-1].dofs < 1000
    (True, True)
    """
    return Adapt(Discretization(problem, method, mesh, order=order), tol=tol, goal=goal, most=most, callback=callback)


def Adapt(disc: Discretization, *, tol: float, goal: Any, most: int, callback: Any, law: float = FULL) -> ContactSolution:
    """`SolveAdaptive` from a Discretization on; law : residual of the law of contact at the end."""
    tol = PositiveNumber(tol, "tol", "give the relative error that is wanted, a number between 0 and 1", below=1)
    most = Integer(most, "most", "give the largest number of unknowns, a positive integer")
    CheckCallback(callback)
    words = f"SolveAdaptive(order={disc.order}, tol={tol:g}, goal={goal!r})"
    run = _Run(tol=tol, law=law, Measure=Measure(goal), most=most, callback=callback, words=words)
    CheckRefinable(disc.mesh)
    if goal != "energy":
        disc.problem.frame.Refuse(f"SolveAdaptive with goal={goal!r}")
    reached = run.First(disc)
    while not run.Tell(reached):
        reached = run.Next(reached)
    return reached.solution


@dataclass(frozen=True, eq=False)
class _Reached:
    """A solution on one of the meshes, how far it is from the goal, and sums of the indicators on all meshes so far."""

    solution: ContactSolution
    measured: Measured
    sums: list[float]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Run:
    """One run, from mesh to mesh."""

    tol: float
    law: float
    Measure: Callable[[ContactSolution], Measured]
    most: int
    callback: Any
    words: str

    def First(self, disc: Discretization) -> _Reached:
        """On the mesh to begin with."""
        begin = time.perf_counter()
        found = NestedNewtonSolver(tol=self.law).Solve(disc, callback=self.callback)
        try:
            return self._Measured(found, None, begin)
        except KeyboardInterrupt as stop:
            raise SolveInterrupted(found) from stop

    def Tell(self, reached: _Reached) -> bool:
        """Is it the goal?  The callback hears of it in any case."""
        tell = getattr(self.callback, "Reached", None)
        try:
            if tell:
                tell(reached.solution.levels[-1])
        except KeyboardInterrupt as stop:
            raise SolveInterrupted(reached.solution) from stop
        return reached.measured.error <= self.tol

    def Next(self, before: _Reached) -> _Reached:
        """On the next mesh; NotConvergedError or SolveInterrupted with the solution before if that is not to be."""
        solution = before.solution
        try:
            _CheckProgress(before.sums, solution.disc)
            begin, disc = time.perf_counter(), self._Finer(before)
            tol = self._LawTolerance(solution.levels)
            _Forget(solution.disc)
            start = Transfer(solution, disc.contact)
            newton = PausedNewton(SemismoothNewtonSolver(tol=tol))
            found, _ = FromPrediction(newton, disc, start, self.callback)
            reached = self._Measured(found, before, begin)
            if reached.measured.error <= self.tol and tol > self.law:      # the last mesh
                steps = found.history
                found = newton.GoOn(SemismoothNewtonSolver(tol=self.law), found, self.callback)
                reached = self._Measured(found, before, begin, steps)
            return reached
        except KeyboardInterrupt as stop:
            raise SolveInterrupted(solution) from stop
        except (ProblemError, NotConvergedError) as error:
            level = solution.levels[-1]
            raise NotConvergedError(f"tol={self.tol:g} was not reached, the estimated error is {level.error:.3g} with "
                                    f"{level.dofs} unknowns: {error}", solution) from error

    def _Finer(self, before: _Reached) -> Discretization:
        """The problem on the next mesh."""
        old, measured = before.solution.disc, before.measured
        excess = 1 - (self.tol / measured.error) ** measured.power
        mesh = Refined(old.mesh, Marked(measured.indicators, excess))
        disc = Discretization(old.problem, old.method, mesh, order=old.order, assembly=old.assembly, inverse=old.wanted)
        if disc.space.ndof > self.most:
            raise ProblemError(f"the next mesh has {disc.space.ndof}, more than most={self.most}; give a larger most, a higher "
                               "order or a larger tol")
        return disc

    def _Measured(self, found: ContactSolution, before: _Reached | None, begin: float, steps: Sequence[Step] = ()) -> _Reached:
        """What was found on a mesh, after these steps and its own, with its estimate, and with what the meshes before took."""
        measured = self.Measure(found)
        history = [*steps, *(replace(step, number=step.number + len(steps)) for step in found.history)]
        level = replace(LevelOf(found.disc, history, time.perf_counter() - begin, True), error=measured.error)
        solution = ContactSolution(found.disc, found.vector, found.traction, history=history, solver=self.words,
                                   levels=[*(before.solution.levels if before else []), level])
        solution.estimate = measured.estimate
        solution.earlier = [*before.solution.earlier, before.solution] if before else []
        total = float(measured.indicators.sum()) ** (1 / measured.power)
        return _Reached(solution, measured, [*(before.sums if before else []), total])

    def _LawTolerance(self, levels: list[Level]) -> float:
        """Of the law residual on the next mesh: no digit that the mesh does not carry."""
        errors = [level.error or 0.0 for level in levels]
        expected = errors[-1] * (errors[-1] / errors[-2] if len(errors) > 1 else REDUCTION)
        return max(min(BALANCE * max(expected, self.tol), LOOSE), self.law)


def _CheckProgress(sums: list[float], disc: Any) -> None:
    """Raise ProblemError if refinement does not help: by the sums of indicators, among which nothing cancels."""
    if len(sums) > WINDOW and not sums[-1] <= STALLED * sums[-1 - WINDOW]:
        if words := Conflict(disc):
            raise ProblemError(f"{WINDOW} refinements have not made it smaller, for {words}, and no displacement of finite "
                               "energy has both; let them agree there")
        raise ProblemError(f"{WINDOW} refinements have not made it smaller, for it is round-off, or comes from data that no "
                           "mesh resolves; give a larger tol")


def _Forget(disc: Any) -> None:
    """Drop matrix and factors of a mesh that is done with; who asks for them has them computed again."""
    for name in ("matrix", "inverse"):
        disc.elastic.pop(name, None)
