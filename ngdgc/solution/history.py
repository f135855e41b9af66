"""What is recorded of an iteration: its steps, its rates, and what every mesh of a nested one took."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Step:
    """What is recorded of an iteration.

    change : |u^i - u^(i-1)| / |u^i|, maximum norm over the quadrature points of Gamma_C, no unit
    residual : distance of (u^i, t^i) to the graph of the law, no unit (`solvers.driver.LawResidual`)
    solves : applications of A^-1 so far;  seconds : since the start
    """

    number: int
    change: float
    residual: float
    solves: int
    seconds: float


@dataclass(frozen=True)
class Prediction(Step):
    """A Step on a coarser mesh of a nested iteration, with this number of unknowns; it is in no history."""

    unknowns: int


@dataclass(frozen=True)
class ContractionRates:
    """Factors by which an iteration shrinks its error per step, no unit, None where there is none.

    predicted : spectral radius of the derivative of the step at the solution; 1 - predicted is at most a tenth too large for
        the sizes stated in `solvers.contraction.ContractionFactor`.  Only iterations with one and the same step have it
    observed : geometric mean of the quotients of the last changes, at most ten and at most half of them all
    """

    predicted: float | None
    observed: float | None


def ObservedRate(history: Sequence[Step]) -> float | None:
    """`Rates.observed` of a list of Steps."""
    changes = [step.change for step in history]
    count = min(10, len(changes) // 2)
    if count == 0 or changes[-1] == 0 or changes[-1 - count] == 0:
        return None
    return float((changes[-1] / changes[-1 - count]) ** (1 / count))


@dataclass(frozen=True)
class Level:
    """What one mesh of a nested or adaptive iteration took: its size, iterations, applications of an inverse, and seconds.

    cycles : steps of conjugate gradients, where they take the place of a factorisation
    factorisation : seconds of it that factorised;  seconds : in all, with the matrix where that was not there before
    error : estimated there, relative to the solution or to what the goal is relative to, no unit; None: not estimated
    If it has not converged the next mesh started from rest.
    """

    elements: int
    dofs: int
    points: int
    iterations: int
    solves: int
    cycles: int
    factorisation: float
    seconds: float
    converged: bool = True
    error: float | None = None
