"""The course of an iteration."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from .canvas import BLUE, VERMILION


def HistoryFigure(solution):
    """Change and law residual of every iteration, logarithmic; zeros, which have no logarithm, are left out.

    Takes a ContactSolution or its history, a list of Step.
    """
    history = getattr(solution, "history", solution)
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.add_subplot(yscale="log")
    number = [step.number for step in history]
    for name, colour, style, label in (("change", BLUE, "-o", "change $|u^i - u^{i-1}| / |u^i|$"),
                                       ("residual", VERMILION, "--s", "law residual")):
        values = np.array([getattr(step, name) for step in history], dtype=float)
        axes.plot(number, np.where(values > 0, values, np.nan), style, color=colour, markersize=3, linewidth=1.2, label=label)
    axes.set(xlabel="iteration", ylabel="no unit", xlim=(0.5, max(number, default=1) + 0.5))
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(color="#DDDDDD", linewidth=0.6)
    axes.legend(frameon=False)
    return figure
