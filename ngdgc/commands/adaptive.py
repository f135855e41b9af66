"""What solves a case on meshes that follow from its error."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Adaptive:
    """`SolveAdaptive` as a solver that a case can be given, which makes the first mesh.

    error : estimated, relative to the solution;  tol : of the law residual
    """

    error: float
    tol: float

    def Solve(self, disc: Any, *, callback: Any = None) -> Any:
        """The ContactSolution on the last mesh; ProblemError if the case has added forms."""
        from ..estimates.adaptive import MOST, Adapt

        return Adapt(disc, tol=self.error, goal="energy", most=MOST, callback=callback, law=self.tol)
