"""The three ways in which a computation ends without a solution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .tools.calls import ByKeyword
from .tools.failures import Failure, ProblemError

__all__ = ["LastIterate", "NotConvergedError", "ProblemError", "SolveInterrupted"]


@dataclass(frozen=True, eq=False)
class LastIterate:
    """What a copy of an error keeps of a ContactSolution, plain data: the solution belongs to a mesh and a matrix.

    vector : coefficients of u_h (ndof,);  traction : (n, d) at the contact points [stress];  history : list of Step
    """

    vector: Any
    traction: Any
    history: list[Any]
    converged: bool
    solver: str


def _CheckHistory(solution: Any) -> None:
    if not isinstance(getattr(solution, "history", None), list):
        raise ProblemError(f"solution is {solution!r}; give a ContactSolution, whose history the error tells")


def _Plain(solution: Any) -> LastIterate:
    return LastIterate(solution.vector.copy(), solution.traction.copy(), list(solution.history), solution.converged,
                       solution.solver)


@ByKeyword
class NotConvergedError(Failure, RuntimeError):
    """An iteration that did not reach its tolerance.  Copies, as processes hand them on, keep plain data, a `LastIterate`.

    Attributes
    ----------
    solution : ContactSolution
        The last iterate, with its history; `solution.converged` is False.
    history : list of Step
        One entry per iteration.
    contraction : Contraction or None
        The estimated contraction numbers at the last iterates.
    states : LoadHistory or None
        The states before, of `SolveHistory`; copies have none.

    >>> from ngdgc import *
    >>> from ngdgc.exact import AffinePatch
    >>> from ngdgc.meshes import RectangleMesh
    >>> exact = AffinePatch("slip")
    >>> disc = Discretization(exact.problem, LDG(), RectangleMesh(2))
    >>> try:
    ...     solution = UzawaSolver(maxiter=2).Solve(disc)
    ... except NotConvergedError as error:
    ...     print(len(error.history), error.solution.converged)
    2 False
    """

    def __init__(self, message: str, solution: Any, contraction: Any = None, *, states: Any = None) -> None:
        super().__init__(message)
        _CheckHistory(solution)
        self.states = states
        self.solution = solution
        self.history = solution.history
        self.contraction = contraction

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), _Plain(self.solution), self.contraction)


@ByKeyword
class SolveInterrupted(KeyboardInterrupt):
    """Ctrl-C during an iteration; `solution` is the last iterate, in copies as in those of NotConvergedError.

    states : of `SolveHistory` the LoadHistory of the states before, else None

    >>> issubclass(SolveInterrupted, KeyboardInterrupt)
    True
    """

    def __init__(self, solution: Any, *, states: Any = None) -> None:
        _CheckHistory(solution)
        count = len(states) if states is not None else 0
        words = {0: f"{len(solution.history)} iterations; the last iterate is its attribute solution",
                 1: "1 state; it is in its attribute states"}
        super().__init__(f"interrupted after {words.get(count, f'{count} states; they are its attribute states')}")
        self.solution, self.states = solution, states

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (_Plain(self.solution),)
