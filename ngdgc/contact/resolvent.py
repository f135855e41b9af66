"""One scalar equation at every point of Gamma_C: where a line meets the graph of a law, however steep that is."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..contracts import Array

STEPS = 200     # of the safeguarded iteration for one scalar equation; bisection alone needs 60
MISSED = 1e-9   # of the scalar equation, relative: more is no round-off, its value jumps


def Share(slope: Array, gamma: Array) -> Array:
    """slope/(gamma + slope), the share of q that is traction, also for a slope that is infinite: nothing cancels."""
    with np.errstate(divide="ignore"):
        return 1 / (1 + gamma / slope)


def Resolvent(Value: Callable[[Array], Array], Derivative: Callable[[Array], Array], gamma: Array,
              q: Array) -> tuple[Array, np.ndarray]:
    """(x, ended): x >= 0 with Value(x) + gamma x = q where q > Value(0), else min(q, 0)/gamma.

    By Newton's iteration inside a bracket.  Arguments and results are arrays (n,); Value >= 0.  A value that is not finite
    counts as too large: a law may end somewhere.
    Where that decides, x is the last point at which Value is finite, and `ended` True.  Finite nowhere gives nan.
    """
    start = np.zeros_like(q)
    with np.errstate(all="ignore"):
        free = ~(q <= Value(start))
        low, high = start, np.maximum(q, 0) / gamma
        x = high.copy()
        for _ in range(STEPS):
            excess = Value(x) + gamma * x - q
            low, high = np.where(excess <= 0, x, low), np.where(excess <= 0, high, x)
            new = x - excess / (gamma + Derivative(x))
            new = np.where((new > low) & (new < high), new, 0.5 * (low + high))
            # A Newton step that leaves the bracket by round-off has converged.
            done = (np.abs(excess) <= 4e-16 * q) | (high - low <= 4e-16 * high) | ~free
            if np.all(done):
                break
            x = np.where(done, x, new)
        else:
            excess = Value(x) + gamma * x - q
        ended = free & ~(np.abs(excess) <= MISSED * q)
        if np.any(ended):
            ended &= ~np.isfinite(Value(high))
            x = np.where(np.isfinite(excess), x, np.where(low > 0, low, np.nan))
    return np.where(free, x, np.minimum(q, 0) / gamma), ended
