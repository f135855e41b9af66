"""Which elements are refined."""

from __future__ import annotations

import numpy as np

from ..contracts import Array

SHARE = 0.6     # of the indicators: larger ones need fewer meshes and more unknowns
LEAST = 0.2     # the same near the end
AIM = 2         # of what is too much: elements at corners keep half of theirs


def Marked(indicators: Array, excess: float) -> Array:
    """A mask of the elements to be refined, from their indicators (elements,) >= 0.

    excess : part of the sum that is too much.  Near the end fewer are marked, so that what is wanted is met and no more
    """
    return Fewest(indicators, min(SHARE, max(LEAST, AIM * excess)))


def Fewest(indicators: Array, share: float) -> Array:
    """A mask of the fewest elements whose indicators (elements,) make up this share of the sum (Doerfler 1996)."""
    order = np.argsort(-indicators, kind="stable")
    sums = np.cumsum(indicators[order])
    marked = np.zeros(len(indicators), dtype=bool)
    marked[order[:np.searchsorted(sums, share * sums[-1]) + 1]] = True
    return marked
