"""The three ways in which a computation ends without a solution."""

from __future__ import annotations

from typing import Any


class ProblemError(ValueError):
    """Data that define no problem; the message names the argument at fault and the remedy.

    >>> from ngdgc import NormalCompliance
    >>> NormalCompliance(stiffness=-1)
    Traceback (most recent call last):
    ...
    ngdgc.exceptions.ProblemError: stiffness is -1; it must be at least 0
    """


class NotConvergedError(RuntimeError):
    """An iteration that did not reach its tolerance.

    Attributes
    ----------
    solution : ContactSolution
        The last iterate, with its history; `solution.converged` is False.
    history : list of Step
        One entry per iteration.
    contraction : Contraction or None
        The estimated contraction numbers at the last iterates.

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

    def __init__(self, message: str, solution: Any, contraction: Any = None) -> None:
        super().__init__(message)
        self.solution = solution
        self.history = solution.history
        self.contraction = contraction


class SolveInterrupted(KeyboardInterrupt):
    """Ctrl-C during an iteration; `solution` is the last iterate."""

    def __init__(self, solution: Any) -> None:
        super().__init__(f"interrupted after {len(solution.history)} iterations; the last iterate is its attribute solution")
        self.solution = solution
