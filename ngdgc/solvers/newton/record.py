"""What a run has done so far, and whether that gets anywhere."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...contracts import Array
from ..driver import LawResidual
from .stiffened import NewtonState

PATIENCE = 8        # steps in which the merit function must halve
SMALL = 1e-8        # law residuals below this that do not shrink are round-off


@dataclass(frozen=True, kw_only=True, eq=False)
class Taken:
    """A Newton step that was taken: its length, the merit before, that after it relative to this, and the zones it led to.

    least : part of what holds the body to which dt/dq was raised, or None
    """

    length: float
    merit: float
    ratio: float
    least: float | None
    zones: Array


class Record:
    """The steps of a run and its last state.

    Attributes
    ----------
    taken : list of all `Taken`, of which those from the number `begun` on belong together;  state : the last one
    """

    def __init__(self) -> None:
        self.taken: list[Taken] = []
        self.begun = 0
        self.state: Any = None      # a NewtonState from the first one on

    def Begin(self, state: NewtonState) -> NewtonState:
        """Another stretch of steps, from this state."""
        self.begun, self.state = len(self.taken), state
        return state

    def Move(self, state: NewtonState) -> NewtonState:
        """The last state, seen with another matrix."""
        self.state = state
        return state

    def Add(self, state: NewtonState, taken: Taken) -> None:
        self.taken.append(taken)
        self.state = state

    @property
    def steps(self) -> list[Taken]:
        """Those of the present stretch."""
        return self.taken[self.begun:]

    @property
    def largest(self) -> float:
        """The largest merit before any step."""
        return max((step.merit for step in self.taken), default=0.0)

    def Stalled(self, patience: int) -> bool:
        """True if this number of steps have not halved the merit."""
        recent = [step.ratio for step in self.steps[-patience:]]
        return len(recent) == patience and bool(np.prod(recent) > 0.5)

    def Roundoff(self) -> bool:
        """True if the last two steps brought nothing and hardly anything is left."""
        recent = [step.ratio for step in self.steps[-2:]]
        return len(recent) == 2 and min(recent) > 0.5 and self.residual < SMALL

    @property
    def residual(self) -> float:
        """Law residual of the last state."""
        return LawResidual(self.state.body.setting.contact, self.state.equilibrium)

    def Period(self) -> int:
        """Smallest number of steps > 1 after which the zones come back, twice; 0 if they do not."""
        zones = [step.zones for step in self.taken]
        for period in range(2, PATIENCE + 1):
            recent = zones[-2 * period - 1:]
            if len(recent) == 2 * period + 1 and all(np.array_equal(a, b) for a, b in zip(recent[:-period], recent[period:])):
                return 0 if np.array_equal(recent[-1], recent[-2]) else period
        return 0
