"""Answers that estimate errors, graded by their effectivity: the estimate divided by the true error, along series of solutions.

A right estimator stays near 1 wherever it is tried.  One that is wrong on purpose has to look right on one series and to go to
0 on another.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..contracts import Array
from ..estimates.estimate import ErrorEstimate
from .checker import Called, Compare

STEADY = 3.0                # factor between first and last effectivity of a series that goes nowhere
RANGE = 0.4, 4.0            # of effectivities that are near 1
SAME = 1e-6                 # relative difference of effectivities that are those of a known mistake
TRENDS = {"steady": "stays where it is", "falls": "goes to 0", "grows": "goes to infinity"}


@dataclass(frozen=True, kw_only=True)
class Series:
    """Solutions with known errors, from one to the next of which something changes.

    words : what changes;  Samples : function that returns [(ErrorEstimate, true error), ...];  wanted : "steady" or "falls"
    """

    words: str
    Samples: Callable[[], Sequence[tuple[ErrorEstimate, float]]]
    wanted: str


@dataclass(frozen=True, kw_only=True)
class Estimator:
    """A function that returns an estimate, a number; each `Series` asks where its effectivity goes.

    Given : ErrorEstimate -> the argument of the function, a new one every time;  words : what to call the function
    mistakes : {hint: wrong function};  insight : said of a correct answer
    """

    series: Sequence[Series]
    Given: Callable[[ErrorEstimate], Any]
    insight: str
    mistakes: Mapping[str, Callable[..., Any]] = field(default_factory=dict)
    words: str = "your estimator"

    def Hint(self, answer: Any) -> str | None:
        found = []
        for estimate, true in (sample for series in self.series for sample in series.Samples()):
            value, trouble = Called(answer, (self.Given(estimate),), self.words)
            trouble = trouble or Compare(value, true, [], "", np.inf)      # any number will do
            if trouble or float(value) < 0:
                return trouble or "An error is not negative: mind the signs."
            found.append(float(value) / true)
        missed = [(series, ratios) for series, ratios in self._Split(found) if not Wanted(series.wanted, ratios)]
        if not missed:
            return None
        for hint, Mistake in self.mistakes.items():
            if np.allclose(found, self._Ratios(Mistake), rtol=SAME, atol=0):
                return hint
        series, ratios = missed[0]
        where = "it stays, but far from 1" if series.wanted == Trend(ratios) else f"it {TRENDS[Trend(ratios)]}"
        return (f"{series.words} the estimate divided by the true error is {', '.join(f'{ratio:.2g}' for ratio in ratios)}: "
                f"{where}.  It should {'stay near 1' if series.wanted == 'steady' else 'go to 0'}.")

    def _Ratios(self, Mistake: Callable[..., Any]) -> list[float]:
        return [Mistake(self.Given(estimate)) / true for series in self.series for estimate, true in series.Samples()]

    def _Split(self, ratios: list[float]) -> Iterator[tuple[Series, Array]]:
        """Each series with its part of the effectivities."""
        begin = 0
        for series in self.series:
            end = begin + len(series.Samples())
            yield series, np.array(ratios[begin:end])
            begin = end


def Trend(ratios: Array) -> str:
    """Where effectivities go: "steady", "falls" or "grows"."""
    if ratios[-1] * STEADY < ratios[0] or not ratios[-1]:
        return "falls"
    return "grows" if ratios[-1] > STEADY * ratios[0] else "steady"


def Wanted(trend: str, ratios: Array) -> bool:
    """Do effectivities go there, and if they are to be steady, are they near 1?"""
    return Trend(ratios) == trend and (trend != "steady" or bool(np.all((RANGE[0] <= ratios) & (ratios <= RANGE[1]))))
