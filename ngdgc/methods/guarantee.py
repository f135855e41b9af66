"""What is known of the coercivity of B_h before any eigenvalue is computed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Guarantee:
    """B_h(v, v) > 0 for v != 0: always, if the element bound kappa is below 1, or nobody knows.

    kind : "always", by the structure of the form, whatever the penalty; "bounded", certain if kappa < 1; "unknown"
    kappa : largest element bound kappa_K (`penalty` module) of what is bounded, else None; no unit
    culprit, remedy : if it is not certain, words for who loses coercivity where it is lost, and what to do about it

    >>> Bounded(0.5).holds, Bounded(2).holds, ALWAYS.holds, UNKNOWN.holds
    (True, False, True, False)
    """

    kind: Literal["always", "bounded", "unknown"]
    kappa: float | None = None
    culprit: str = "this form"
    remedy: str = "look for degenerate elements"

    @property
    def holds(self) -> bool:
        """True if the form is coercive for certain."""
        return self.kind == "always" or self.kappa is not None and self.kappa < 1


ALWAYS, UNKNOWN = Guarantee("always"), Guarantee("unknown")


def Bounded(kappa: float) -> Guarantee:
    """Coercive if the element bound is below 1."""
    return Guarantee("bounded", float(kappa))
