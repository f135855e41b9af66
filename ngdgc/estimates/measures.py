"""What an adaptive run makes accurate: how far a solution is from it, and which elements are to blame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ..contracts import Array
from ..exceptions import ProblemError
from ..methods.blockform import FacetForm
from ..solution.solution import ContactSolution
from .error import EstimateError
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
    if goal != "energy":
        raise ProblemError(f"goal is {goal!r}; what can be made accurate is 'energy', the error in the energy norm: give that")
    return Energy


def Energy(solution: ContactSolution) -> Measured:
    """By `EstimateError`, or by `ResidualEstimate`, some 4 times as large, where a method has no equilibrated stress."""
    disc = solution.disc
    equilibrated = disc.method.conservative and isinstance(disc.facetform, FacetForm)
    estimate = EstimateError(solution) if equilibrated else ResidualEstimate(solution)
    return Measured(error=estimate.relative, indicators=estimate.indicators, power=2, estimate=estimate)
