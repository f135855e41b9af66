"""A semismooth Newton method on the graph of the contact law."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from ...contact.equilibrium import Equilibrium
from ...contracts import Array
from ...discrete.problem import DiscreteProblem
from ...discrete.punched import Enlarged, PunchedProblem
from ...exceptions import ProblemError
from ...solution.history import Step
from ...solution.solution import ContactSolution
from ...tools.calls import ByKeyword
from ...tools.values import Reals
from ..driver import CheckLimits, Current, Drive
from .correction import CorrectedRun
from .run import NewtonRun

@ByKeyword
@dataclass(frozen=True, kw_only=True)
class SemismoothNewtonSolver:
    """Newton's method for  F(q) = U(q) - u_f + S t(q) = 0  on the graph of the contact law (`graph.ContactGraph`).

    Every iterate obeys the law exactly, stick is u_t = 0, and what vanishes in the limit is the difference between the
    displacement U(q) on the graph and u = u_f - S t(q), the one that its traction causes.  F is Lipschitz with a constant that
    does not depend on the stiffness of the foundation, and piecewise smooth; its generalised derivative dU/dq + S dt/dq
    contains the dependence of the friction bound on the penetration and is not symmetric.

    * Linear equations by conjugate residuals that recycle all products with S (`recycling`) and are preconditioned by d x d
      blocks at the points; to a relative residual of 3e-3, and to the tolerance of the whole where a step stays on one smooth
      piece of the graph.
    * From there the contact problem with all that these products tell of S is solved, which costs nothing (`reduced`), checked
      by one application, and again as long as that helps: zones that change need no further Newton step.
    * Where the inverse is an iteration, all this happens in a subspace, and its corrections in the whole space (`correction`).
    * The stiffness of the law where the start predicts contact is put into the factorised matrix (`stiffened`), also to hold
      a body that nothing but its foundation holds; stick, which no foundation's stiffness measures, only softly there.
    * Where nothing but the foundation holds the body and all points slip or have lifted off, the derivative is singular: dt/dq
      counts as at least 1/100, less as F falls, of what it is where the foundation carries the loads and friction sticks.
    * Globalisation: halved steps for |F|^2 in L2(Gamma_C); where that stalls and no start was given, a path of solutions leads
      to one if the body is held and has few contact points (`pathfollowing`), else the load is raised in steps that adapt.

    tol : of the law residual (`graph.Distance`), no unit
    maxiter : limit of Newton steps

    >>> SemismoothNewtonSolver(tol=1e-8).maxiter
    100
    """

    tol: float = 1e-10
    maxiter: int = 100

    def __post_init__(self) -> None:
        CheckLimits(self)

    def Solve(self, disc: DiscreteProblem, *, start: tuple[Array, Array] | None = None,
              callback: Callable[[Step], object] | None = None) -> ContactSolution:
        """Return the ContactSolution of a Discretization; `callback(step)` is called with every `Step`.

        start : (displacement, traction), both (n, d), at the contact points, such as those of a similar problem; None: rest.
            Displacements are those towards punches that a force presses, solution.displacement - solution.disc.contact.found

        Raises NotConvergedError, with the history and the likely cause, if the iteration stalls, from rest also under
        load steps; SolveInterrupted, with the last iterate, on Ctrl-C.
        """
        with Current(disc) as disc:
            run = MakeRun(disc, start, self.tol)
            return Drive(self, disc, run.Iterates(), callback, run.Diagnose, window=None)


def MakeRun(disc: DiscreteProblem, start: tuple[Array, Array] | None, tol: float) -> NewtonRun | CorrectedRun:
    """A run on a Discretization from a start, as `SemismoothNewtonSolver.Solve` takes it."""
    start = start if start is None else _Start(start, disc.contact.normals.shape)
    equations = Enlarged(disc)
    if isinstance(equations, PunchedProblem):
        return PunchedRun(equations, start, tol)
    return CorrectedRun(disc, start, tol) if disc.iterates else NewtonRun(disc, start, tol)


class PunchedRun(NewtonRun):
    """One run on a body and the rigid punches whose motions are to be found."""

    def Iterates(self) -> Iterator[Equilibrium]:
        """The equilibria of the states, the motions of the punches beside the coefficients of the body."""
        problem = cast(PunchedProblem, self.setting.disc)
        for found in super().Iterates():
            yield replace(found, vector=found.vector[:problem.size], motion=found.vector[problem.size:])


def _Start(start: Any, shape: tuple[int, ...]) -> tuple[Array, Array]:
    """Displacement and traction as arrays of this shape; ProblemError for anything else."""
    remedy = f"give the pair of displacement and traction at the contact points, both {shape} and finite"
    pair = isinstance(start, (tuple, list, np.ndarray)) and len(start) == 2
    if pair and all(isinstance(part, np.ndarray) for part in start) and [part.shape for part in start] != [shape, shape]:
        raise ProblemError(f"start has shapes {[part.shape for part in start]}; {remedy}")
    arrays: list[Any] = [Reals(part, shape) for part in start] if pair else [None]
    if any(array is None for array in arrays):
        raise ProblemError(f"start is {start!r}; {remedy}")
    return arrays[0], arrays[1]
