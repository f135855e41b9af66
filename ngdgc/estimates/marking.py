"""Which elements are refined."""

from __future__ import annotations

import numpy as np

from ..contracts import Array
from ..solution.solution import ContactSolution

SHARE = 0.6     # of the squared error: larger ones need fewer meshes and more unknowns
AIM = 1.2       # of the squared error that is too much: refined elements keep some of theirs


def Marked(solution: ContactSolution, indicators: Array, wanted: float) -> Array:
    """A mask of the elements to be refined, from their shares of the squared error, (elements,) >= 0.

    wanted : error to be reached, relative to the present one.  Near the end fewer are marked, so that it is met and no more
    """
    return Fewest(indicators, min(SHARE, AIM * (1 - wanted ** 2)))


def Fewest(indicators: Array, share: float) -> Array:
    """A mask of the fewest elements whose indicators (elements,) make up this share of the sum (Doerfler 1996)."""
    order = np.argsort(-indicators, kind="stable")
    sums = np.cumsum(indicators[order])
    marked = np.zeros(len(indicators), dtype=bool)
    marked[order[:np.searchsorted(sums, share * sums[-1]) + 1]] = True
    return marked
