"""Responses to the loads of all times, from those to the few of which they are combinations."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..contracts import Array

NEW = 1e-14     # part of a load that is outside of the span, from which on it is a new one
MOST = 12       # loads that are remembered


class SpannedLoads:
    """Linear responses V x of loads x (ndof,), by an application of the inverse only for loads outside of the span so far."""

    def __init__(self, Respond: Callable[[Array], Array]) -> None:
        self.Respond = Respond
        self.loads: list[Array] = []
        self.responses: list[Array] = []

    def Response(self, load: Array) -> Array:
        """The response (ndof,) to a load (ndof,)."""
        size = np.linalg.norm(load)
        rest, found = load, np.zeros_like(load)
        for _ in range(2):
            for known, response in zip(self.loads, self.responses):
                part = known @ rest
                rest, found = rest - part * known, found + part * response
        left = np.linalg.norm(rest)
        if left > NEW * size:
            if len(self.loads) == MOST:         # of loads that travel each one is new
                self.loads, self.responses = [], []
                return self.Response(load)
            self.loads.append(rest / left)
            self.responses.append(self.Respond(rest / left))
            found = found + left * self.responses[-1]
        return found
