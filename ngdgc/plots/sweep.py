"""What a sweep took: Newton steps and applications of an inverse against the stiffness of the foundation."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from ..tools.calls import ByKeyword
from .canvas import BLUE, ORANGE, VERMILION


@ByKeyword
def SweepFigure(records: Any) -> Figure:
    """`sweep.Record`s: steps and applications on the finest mesh against k_n/E; failures at the top."""
    figure = Figure(figsize=(9, 4.2), layout="constrained")
    solved, failed = ([r for r in records if bool(r.error) == lost] for lost in (False, True))
    for axes, name, label in zip(figure.subplots(1, 2), ("steps", "solves"), ("Newton steps", "applications of an inverse")):
        for three, colour, words in ((False, BLUE, "one or two zones"), (True, ORANGE, "all three zones")):
            group = [r for r in solved if r.threezones == three]
            axes.plot([r.stiffness for r in group], [getattr(r, name)[-1] for r in group], "o", color=colour, markersize=3.5,
                      markerfacecolor="none", label=words)
        top = max((getattr(r, name)[-1] for r in solved), default=1)
        axes.plot([r.stiffness for r in failed], [1.1 * top] * len(failed), "x", color=VERMILION, label="failed")
        axes.set(xscale="log", xlabel="$k_n/E$ [1/length]", ylabel=f"{label}, finest mesh")
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(color="#DDDDDD", linewidth=0.6)
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    return figure
