"""The course of an iteration."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ..solution.history import Level, Step
from ..solution.solution import ContactSolution
from ..tools.calls import ByKeyword
from .canvas import BLUE, GREEN, VERMILION, WIDTH, Panel


@ByKeyword
def HistoryFigure(solution: ContactSolution | Sequence[Step]) -> Figure:
    """Change and law residual of every iteration [1], logarithmic; zeros, which have no logarithm, are left out.

    Takes a ContactSolution or its history, a list of Step.  Of a nested iteration this is the last mesh; a second panel has
    the iterations on every mesh, from the coarsest on, hatched where the mesh did not converge and the next began from rest.

    >>> from ngdgc.cases import example_4_2
    >>> figure = HistoryFigure(example_4_2.Main(n=4))
    """
    history: Any = getattr(solution, "history", solution)
    levels: Sequence[Level] = getattr(solution, "levels", [])
    nested = len(levels) > 1
    figure = Figure(figsize=(WIDTH, 3.4), layout="constrained")
    left, *right = figure.subplots(1, 2, width_ratios=[3, 2]) if nested else [figure.subplots()]
    number = [step.number for step in history]
    for name, colour, style, label in (("change", BLUE, "-o", "change $|u^i - u^{i-1}| / |u^i|$"),
                                       ("residual", VERMILION, "--s", "law residual")):
        values: Any = np.array([getattr(step, name) for step in history], dtype=float)
        left.plot(number, np.where(values > 0, values, np.nan), style, color=colour, linewidth=1.2, label=label,
                  markersize=4 if len(history) <= 100 else 0)
    Panel(left, xlabel="iteration, last mesh" if nested else "iteration", ylabel="no unit [1]", yscale="log",
          xlim=(0.5, max(number, default=1) + 0.5)).xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
    if not history:
        left.text(0.5, 0.5, "no iteration recorded", transform=left.transAxes, ha="center")
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False)
    for axes in right:
        _DrawLevels(axes, levels)
    return figure


def _DrawLevels(axes: Any, levels: Sequence[Level]) -> None:
    bars = axes.barh(range(len(levels)), [level.iterations for level in levels], color=GREEN, height=0.6)
    for bar, level in zip(bars, levels):
        bar.set_hatch("" if level.converged else "//")
    Panel(axes, xlabel="iterations", ylabel="unknowns of the mesh").xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_yticks(range(len(levels)), [level.dofs for level in levels])
    axes.invert_yaxis()
