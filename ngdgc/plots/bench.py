"""Seconds against unknowns."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ..tools.calls import ByKeyword
from .canvas import BLUE, GREEN, ORANGE, VERMILION

COLOURS = BLUE, VERMILION, GREEN, ORANGE
MARKERS = "o", "s", "^", "D"


@ByKeyword
def GrowthFigure(panels: Any) -> Figure:
    """Total time and that of the reference, factorisation and one solve, against the number of unknowns.

    panels : {title: {label: list of `bench.solutions.Cost` of growing size}}
    """
    figure = Figure(figsize=(3.6 * len(panels) + 0.4, 4.5), layout="constrained")
    for axes, (title, series) in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels.items()):
        for (label, costs), colour, marker in zip(series.items(), COLOURS, MARKERS):
            axes.loglog([cost.dofs for cost in costs], [np.median(cost.total) for cost in costs], color=colour, marker=marker,
                        markerfacecolor="none", label=label)
        known = {cost.dofs: np.median(cost.reference) for costs in series.values() for cost in costs if len(cost.reference)}
        axes.loglog(sorted(known), [known[dofs] for dofs in sorted(known)], color="black", linestyle="--", marker="x",
                    label="factorisation and one solve")
        axes.set(title=title, xlabel="unknowns", ylabel="seconds, from mesh to solution")
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(color="#DDDDDD", linewidth=0.6)
        # Outside: growth fills the picture from corner to corner.
        axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.16))
    return figure
