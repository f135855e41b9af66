"""The atlas of solvers: what they take against stiffness, friction coefficient and mesh size, one line per solver."""

from __future__ import annotations

import math
from typing import Any

from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullFormatter, NullLocator

from ..tools.calls import ByKeyword
from .canvas import BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION

# Colour, marker and line: Uzawa's explicit iterations dotted, implicit ones dashed, Newton's solid.
STYLES = {"Uzawa": ("black", "x", ":"), "Uzawa, Anderson": (PURPLE, "+", ":"), "implicit": (SKY, "v", "--"),
          "implicit, adaptive": (ORANGE, "D", "--"), "implicit, Anderson": (GREEN, "^", "--"),
          "Newton": (VERMILION, "o", "-"), "nested Newton": (BLUE, "s", "-")}
LABELS = {"iterations": "iterations", "solves": "applications of $A^{-1}$", "seconds": "seconds"}
VARIABLES = {"stiffness": "$k_n/E$ [1/length]", "coefficient": "friction coefficient [no unit]", "n": "h = 1/n [length]"}


@ByKeyword
def AtlasFigure(panels: Any, variable: str, quantities: Any) -> Figure:
    """Rows of the atlas against an attribute of their points, double logarithmic.

    panels : {title: list of `atlas.solvers.Row`}, one column of pictures each
    variable : "stiffness", "coefficient" or "n", which is drawn as h = 1/n
    quantities : of "iterations", "solves" (applications of an inverse on the finest mesh) and "seconds", one line of pictures
        each

    Above each column a strip shows where which solver gave up.
    """
    figure = Figure(figsize=(3.1 * len(panels) + 0.6, 2.5 * len(quantities) + 1.7), layout="constrained")
    heights = [0.42, *[1] * len(quantities)]
    grid = figure.subplots(len(heights), len(panels), squeeze=False, height_ratios=heights, sharex="col", sharey="row")
    for column, (title, rows) in zip(grid.T, panels.items()):
        column[0].set_title(title, fontsize=10)
        for number, (solver, (colour, marker, line)) in enumerate(STYLES.items()):
            own = sorted((row for row in rows if row.solver == solver), key=lambda row: _At(row, variable))
            failed = [_At(row, variable) for row in own if not row.converged and row.iterations]
            column[0].plot(failed, [-number] * len(failed), linestyle="none", **_Marker(solver, colour, marker))
            for axes, quantity in zip(column[1:], quantities):
                axes.plot([_At(row, variable) for row in own], [_Amount(row, quantity) for row in own], linestyle=line,
                          linewidth=1.3, **_Marker(solver, colour, marker))
        _Finish(column, variable, sorted({_At(row, variable) for row in rows}))
    grid[0, 0].set_ylabel("gave\nup", fontsize=9)
    for axes, quantity in zip(grid[1:, 0], quantities):
        axes.set_ylabel(LABELS[quantity])
    handles = {handle.get_label(): handle for handle in grid[1, 0].lines}
    figure.legend(handles=list(handles.values()), loc="outside lower center", ncols=2 if len(panels) == 1 else 4,
                  frameon=False, fontsize=9)
    return figure


def _At(row: Any, variable: str) -> float:
    value = getattr(row.point, variable)
    return 1 / value if variable == "n" else value


def _Amount(row: Any, quantity: str) -> float:
    """The number drawn; NaN, which interrupts the line, where the solver gave up."""
    return getattr(row, quantity) if row.converged else math.nan


def _Marker(solver: str, colour: str, marker: str) -> dict[str, Any]:
    return {"color": colour, "marker": marker, "markersize": 5, "markerfacecolor": "none", "label": solver}


def _Finish(column: Any, variable: str, places: Any) -> None:
    strip, *pictures = column
    strip.set(ylim=(-len(STYLES) + 0.3, 0.7), yticks=[], xscale="log")
    strip.set_facecolor("#F2F2F2")
    strip.spines[["top", "right", "left", "bottom"]].set_visible(False)
    strip.tick_params(bottom=False, which="both")
    for axes in pictures:
        axes.set(xscale="log", yscale="log")
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(color="#DDDDDD", linewidth=0.6)
    pictures[-1].set_xlabel(VARIABLES[variable])
    if variable != "stiffness":
        pictures[-1].xaxis.set_major_locator(FixedLocator(places))
        pictures[-1].xaxis.set_minor_locator(NullLocator())
        texts = [f"1/{1 / place:.0f}" if variable == "n" else f"{place:g}" for place in places]
        pictures[-1].set_xticklabels(texts, fontsize=8)
