"""What an adaptive run makes accurate: how far a solution is from it, and which elements are to blame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from ..contracts import Array
from ..exceptions import ProblemError
from ..methods.blockform import FacetForm
from ..solution.solution import ContactSolution
from .error import EstimateError
from .force import EstimateForce
from .residual import ResidualEstimate


@dataclass(frozen=True, kw_only=True, eq=False)
class Measured:
    """How far a solution is from a goal.

    error : relative, no unit;  indicators : (elements,) >= 0, whose sum goes with error^power
    estimate : what tells more, for `solution.estimate`
    """

    error: float
    indicators: Array
    power: int
    estimate: Any


def Measure(goal: Any) -> Callable[[ContactSolution], Measured]:
    """The function that measures how far a solution is from a goal; ProblemError for a goal that there is not."""
    if isinstance(goal, str) and goal == "energy":
        return Energy
    kind = goal[0] if isinstance(goal, tuple) and len(goal) == 2 else goal
    if not isinstance(kind, str) or kind not in ("force", "pressure", "displacement") or (kind == "force") != (kind is goal):
        raise ProblemError(f"goal is {goal!r}; choose 'energy', 'force', ('pressure', region) or ('displacement', point)")
    return partial(Quantity, goal)


def Energy(solution: ContactSolution) -> Measured:
    """By `EstimateError`, or by `ResidualEstimate`, some 4 times as large, where a method has no equilibrated stress."""
    disc = solution.disc
    equilibrated = disc.method.conservative and isinstance(disc.facetform, FacetForm)
    estimate = EstimateError(solution) if equilibrated else ResidualEstimate(solution)
    return Measured(error=estimate.relative, indicators=estimate.indicators, power=2, estimate=estimate)


def Quantity(goal: Any, solution: ContactSolution) -> Measured:
    """By `EstimateForce`."""
    estimate = EstimateForce(solution, goal)
    return Measured(error=estimate.relative, indicators=estimate.indicators, power=1, estimate=estimate)
