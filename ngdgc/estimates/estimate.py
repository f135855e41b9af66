"""What an estimate of the error in the energy norm tells."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..contracts import Array


@dataclass(frozen=True, kw_only=True)
class ErrorEstimate:
    """The error of a solution in the energy norm, sqrt(int C eps(u - u_h):eps(u - u_h)) [sqrt(stress length^d)], estimated.

    value : the estimate, without a constant to choose;  relative : value/sqrt(int C eps(u_h):eps(u_h)), no unit
    bound : an upper bound, or None where theory has none;  reason : what the bound holds for, or why there is none
    parts : {name: its share}, value = sqrt(sum of their squares)
    indicators : (elements,) squares of the elements' shares [stress length^d], of sum value^2
    """

    value: float
    relative: float
    parts: dict[str, float]
    indicators: Array = field(repr=False)
    bound: float | None = None
    reason: str = ""

    def __str__(self) -> str:
        parts = ", ".join(f"{name} {share:.3g}" for name, share in self.parts.items())
        bound = f"bound {self.bound:.4g}" if self.bound is not None else "no bound"
        return f"energy error {self.value:.4g} ({self.relative:.3g} of the solution), {bound}: {self.reason}; parts: {parts}"
