"""Newton's method that stops at one tolerance and, if that proves to be too large, goes on from there."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import chain
from typing import Any

from ...contact.equilibrium import Equilibrium
from ...contracts import Array
from ...discrete.problem import DiscreteProblem
from ...solution.history import Step
from ...solution.solution import ContactSolution
from ..driver import Current, Drive
from .correction import MOST, CorrectedRun
from .run import NewtonRun
from .solver import MakeRun, SemismoothNewtonSolver

CARRIED = 1e-3      # of the tolerance of the law, what conjugate gradients may leave of the loads on the way


class PausedNewton:
    """A SemismoothNewtonSolver whose last run is kept, with its factors, as long as this object is.

    Where the inverse is an iteration it is one run: contact in the subspace, its matrix and the levels of the preconditioner
    serve to the end, and conjugate gradients stop early until then.  Other runs begin again, with the stiffness of the zones
    that are known by then in their matrix.
    """

    def __init__(self, solver: SemismoothNewtonSolver) -> None:
        self.solver = solver
        self._run: NewtonRun | CorrectedRun | None = None
        self._iterates: Iterator[Equilibrium] = iter(())

    def Solve(self, disc: DiscreteProblem, *, start: tuple[Array, Array] | None = None,
              callback: Callable[[Step], object] | None = None) -> ContactSolution:
        """As `SemismoothNewtonSolver.Solve`."""
        with Current(disc) as disc:
            self._run = run = MakeRun(disc, start, self.solver.tol)
            if isinstance(run, CorrectedRun):
                run.most = max(MOST, CARRIED * run.tol)
            self._iterates = run.Iterates()
            return Drive(self.solver, disc, self._iterates, callback, run.Diagnose, window=None)

    def GoOn(self, solver: SemismoothNewtonSolver, found: ContactSolution, callback: Any) -> ContactSolution:
        """The solution to the tolerance of another solver, after that which `Solve` has found."""
        run = self._run
        if not isinstance(run, CorrectedRun):
            return solver.Solve(found.disc, start=(found.displacement - found.disc.contact.found, found.traction),
                                callback=callback)
        with Current(found.disc) as disc:
            run.tol, run.most = solver.tol, MOST
            reached = Equilibrium(vector=found.vector, displacement=found.displacement, traction=found.traction)
            return Drive(solver, disc, chain([reached], self._iterates), callback, run.Diagnose, window=None)
