"""What an estimate of the error in the energy norm tells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

from ..contracts import Array
from ..tools.calls import ByKeyword


@ByKeyword
@dataclass(frozen=True, kw_only=True)
class ErrorEstimate:
    """The error of a solution in the energy norm, sqrt(int C eps(u - u_h):eps(u - u_h)) [sqrt(stress length^d)], estimated.

    value : the estimate, without a constant to choose;  relative : value/sqrt(int C eps(u_h):eps(u_h)), no unit
    parts : {name: its share}, value = sqrt(sum of their squares)
    indicators : (elements,) squares of the elements' shares [stress length^d], of sum value^2
    bound : an upper bound, or None where theory has none;  reason : what it holds for, or why there is none; both computed when
        they are asked for
    Theory : () -> (bound, reason)
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
        parts = ", ".join(f"{name} {share:.3g}" for name, share in self.parts.items())
        bound = "no bound" if self.bound is None else f"bound {self.bound:.4g}"
        return f"energy error {self.value:.4g} ({self.relative:.3g} of the solution), {bound}: {self.reason}; parts: {parts}"
