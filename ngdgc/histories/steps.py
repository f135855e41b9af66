"""Increments that are too large, though there is a state at their end: zones that change too much, and wear that does."""

from __future__ import annotations

from typing import cast

import numpy as np

from ..contact.graph import SEPARATION
from ..contact.stiffness import BodyStiffness
from ..contracts import Array
from ..solvers.newton.stiffened import NEAR
from .loading import Instant

WORN = 0.2      # of what would take the pressure of a point away is worn off in an increment at most
LESS = 0.9      # Half of an increment must change less than this part of what the whole has, else halving does not help.


class Steps:
    """How much an increment changes, in units of what it may.

    change : largest part of the points in contact, by their weights, that may come to another zone; None: any
    """

    def __init__(self, change: float | None) -> None:
        self.change = change

    def Size(self, old: Instant, new: Instant) -> float:
        """More than 1 for an increment that is too large."""
        zones = 0.0 if self.change is None else _ZoneChange(old, new) / self.change
        return max(zones, _WearChange(new) / WORN)


def _ZoneChange(old: Instant, new: Instant) -> float:
    """The part of the points in contact, before or after, that are in another zone."""
    weights, before, after = new.disc.contact.weights, old.law.zones, new.law.zones
    touching = (before != SEPARATION) | (after != SEPARATION)
    return float(weights @ (before != after) / (weights @ touching or 1.0))


def _WearChange(new: Instant) -> float:
    """Largest depth worn off at a point, over what takes its pressure away: what law and body yield together."""
    contact, pressure = new.disc.contact, new.law.pressure
    if not contact.wears:
        return 0.0
    yielding = np.maximum(contact.Penetration(new.displacement), 0) + NEAR * pressure / BodyStiffness(new.disc)
    there = pressure > 0
    worn = cast(Array, new.memory.worn) - contact.worn
    return float(np.max(worn[there] / yielding[there], initial=0))
