"""What an estimate of the error in the energy norm tells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ..contracts import Array
from ..exceptions import ProblemError
from ..mesh.facets import VolumePoints
from ..problem.problem import ContactProblem
from ..solution.resultants import ElasticForce
from ..tools.calls import ByKeyword

ROUNDOFF = 1e-9     # of strains, relative to displacements over the size of the body; differences in small elements lose it


@ByKeyword
@dataclass(frozen=True, kw_only=True)
class ErrorEstimate:
    """The error of a solution in the energy norm, sqrt(int C eps(u - u_h):eps(u - u_h)) [sqrt(stress length^d)], estimated.

    value : the estimate, without a constant to choose;  relative : it over sqrt(int C eps(u_h):eps(u_h)), no unit (`Relative`)
    parts : {name: its share}, value = sqrt(sum of their squares)
    indicators : (elements,) squares of the elements' shares [stress length^d], of sum value^2
    bound : an upper bound, or None where theory has none;  reason : what it holds for, or why there is none; both are computed
        when they are asked for, which may take as long as the solution
    Theory : () -> (bound, reason)

    >>> from ngdgc import EstimateError
    >>> from ngdgc.cases import example_4_2
    >>> solution = example_4_2.Main(n=4)
    >>> estimate = EstimateError(solution)
    >>> bool(abs(np.sqrt(estimate.indicators.sum()) / estimate.value - 1) < 1e-12), sorted(estimate.parts)[:2]
    (True, ['data', 'feasibility'])
    """

    value: float
    relative: float
    parts: dict[str, float]
    indicators: Array = field(repr=False)
    Theory: Callable[[], tuple[float | None, str]] = field(repr=False)

    @cached_property
    def _bounded(self) -> tuple[float | None, str]:
        return self.Theory()

    @property
    def bound(self) -> float | None:
        return self._bounded[0]

    @property
    def reason(self) -> str:
        return self._bounded[1]

    def __str__(self) -> str:
        # Without the bound, which may take as long as the solution.
        parts = ", ".join(f"{name} {share:.3g}" for name, share in self.parts.items())
        return f"energy error {self.value:.4g} ({self.relative:.3g} of the solution); parts: {parts}"


def Relative(solution: Any, value: float) -> float:
    """A value over sqrt(int C eps(u_h):eps(u_h)), no unit, or over its round-off if that is more, as of a rigid motion.

    The round-off is ROUNDOFF |u_h| sqrt(mu L^(d-2)), L the size of the body; of a body at rest the result is 0 or inf.
    """
    points = VolumePoints(solution.disc.mesh, 2)
    displacement = np.abs(np.asarray(solution.gfu(points))).max()
    size = max(np.sqrt(2 * solution.energy), ROUNDOFF * np.sqrt(ElasticForce(solution) * displacement))
    return float(value / size if size else value and np.inf)


def RefuseJoints(problem: ContactProblem) -> None:
    """Raise ProblemError for a problem with joints."""
    if problem.joints:
        raise ProblemError(f"the problem has joint {problem.joints[0]!r}, across which displacements jump; errors are "
                           "estimated of bodies that press against foundations alone: compare with a finer mesh")


def RefusePunches(problem: ContactProblem) -> None:
    """Raise ProblemError for a problem with rigid punches."""
    if punched := [foundation.boundary for foundation in problem.foundation if foundation.punch is not None]:
        raise ProblemError(f"the foundation {punched[0]!r} is a rigid punch, whose motion no estimate here knows; compare with "
                           "a finer mesh, or give its displacement as a gap")


def RefuseHistories(disc: Any) -> None:
    """Raise ProblemError for a state of a history that is not its first one."""
    if disc.origin is not None:
        raise ProblemError("the solution is a state of a history, whose slip counts from the state before; errors are "
                           "estimated of solutions from rest: of the first state, or with Solve")


def RefuseSprings(problem: ContactProblem) -> None:
    """Raise ProblemError for a problem with springs."""
    if problem.spring:
        raise ProblemError("the problem has springs, whose share in the energy norm no estimate here knows; "
                           "take EstimateForce, or hold the body with dirichlet or roller")
