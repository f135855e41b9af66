"""What solves a case on meshes that follow from its error."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..tools.values import HIGHEST


@dataclass(frozen=True, kw_only=True)
class Adaptive:
    """`SolveAdaptive` as a solver that a case can be given, which makes the first mesh.

    error : estimated, relative to the solution;  tol : of the law residual
    """

    error: float
    tol: float

    def Solve(self, disc: Any, *, callback: Any = None) -> Any:
        """The ContactSolution on the last mesh, with the errors of its forces; ProblemError if the case has added forms."""
        from ..estimates.adaptive import MOST, Adapt
        from ..estimates.force import EstimateForce

        solution = Adapt(disc, tol=self.error, goal="energy", most=MOST, callback=callback, law=self.tol)
        if disc.order < HIGHEST[disc.mesh.dim]:
            solution.forceerrors = EstimateForce(solution)
        return solution
