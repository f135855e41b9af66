"""Joints whose sides hold each other: a law moved so that it pulls before it opens."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..contracts import Array
from ..exceptions import ProblemError

DOUBLINGS, HALVINGS = 300, 200      # in search of a penetration
REACHED = 1e-9                      # of the pressure there, relative


@dataclass(frozen=True, eq=False)
class Bond:
    """The law of `part` moved by (depth, tension), p_n(depth) = tension: p(r) = p_n(r + depth) - tension, p(0) = 0.

    part : ContactPart with the laws as they were given;  depth [length], tension [stress] : (m,)
    """

    part: Any
    depth: Array
    tension: Array

    @classmethod
    def Of(cls, part: Any, tension: Array, name: str) -> Bond:
        """The Bond of a part for tensions (m,) >= 0; ProblemError if its pressure never is that large."""
        low, high = np.zeros_like(tension), np.full_like(tension, np.finfo(float).tiny ** 0.25)

        def Short(r: Array) -> np.ndarray:
            with np.errstate(all="ignore"):
                return np.asarray(part.Pressure(r)) < tension
        for _ in range(DOUBLINGS):
            if not np.any(short := Short(high)):
                break
            high = np.where(short, 2 * high, high)
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            short = Short(middle)
            low, high = np.where(short, middle, low), np.where(short, high, middle)
        depth = np.where(tension > 0, high, 0)
        with np.errstate(all="ignore"):
            reached = part.Pressure(depth)
        if not np.all(np.abs(reached - tension) <= REACHED * tension):
            raise ProblemError(f"{name}: tension is {tension.max():g}, which the pressure of its law reaches at no "
                               "penetration: make the tension less than the largest pressure of the law, of which it is a part")
        return cls(part, depth, reached)
