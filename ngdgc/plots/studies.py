"""Errors of studies, one colour and marker per method: against the mesh size, and against lam."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from ..tools.calls import ByKeyword
from .canvas import BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION

# Colour, marker and its size: curves of different methods lie on each other, so smaller markers sit in larger ones.
STYLES = {"IP": (BLUE, "s", 9), "Bassi": (GREEN, "^", 7.5), "Brezzi": (ORANGE, "D", 5), "LDG": (VERMILION, "o", 3.5),
          "NIPG": (SKY, "v", 6), "IIPG": (PURPLE, "<", 6), "H1": ("black", "x", 5)}
NORMS = (("energy", 0, r"energy error $|u-u_h|_{1,h}$  [(stress length$^d$)$^{1/2}$]"),
         ("l2", 1, r"$L^2$ error $|u-u_h|_0$  [length$^{1+d/2}$]"))


@ByKeyword
def ConvergenceFigure(series: Any) -> Figure:
    """Errors of `convergence.Series` against h = 1/n, double logarithmic, with triangles of the slopes k and k + 1.

    Edge forms are drawn solid with open markers, lifting forms dashed with small filled ones, which fit into the open ones.

    >>> from ngdgc import LDG
    >>> from ngdgc.exact import SmoothSlip
    >>> from ngdgc.studies import convergence
    >>> figure = ConvergenceFigure([convergence.Study(SmoothSlip(), LDG(), order=1, n=(2, 4))])
    """
    figure = Figure(figsize=(9, 5.2), layout="constrained")
    for axes, (norm, gain, label) in zip(figure.subplots(1, 2), NORMS):
        for one in series:
            axes.plot(1 / np.array(one.n), getattr(one, norm), **_Style(one.label))
        for order in sorted({one.order for one in series}):
            _Slope(axes, [one for one in series if one.order == order], norm, order + gain)
        sizes = sorted({n for one in series for n in one.n})
        axes.set(xscale="log", yscale="log", xlabel="h = 1/n [length]", ylabel=label)
        axes.xaxis.set_major_locator(FixedLocator([1 / n for n in sizes]))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.set_xticklabels([f"1/{n}" for n in sizes])
        _Finish(axes)
    cells = ", ".join(dict.fromkeys(one.cells for one in series))
    figure.suptitle(f"Smooth slip, cells: {cells}; the numbers at the triangles are the slopes", fontsize=10)
    _Legend(figure)
    return figure


@ByKeyword
def AccuracyFigure(series: Any) -> Figure:
    """Relative strain errors of `accuracy.Series` against seconds, double logarithmic, one picture per order."""
    orders = sorted({one.order for one in series})
    figure = Figure(figsize=(2.9 * max(len(orders), 1.6), 3.8), layout="constrained")
    for axes, order in zip(figure.subplots(1, len(orders), squeeze=False, sharex=True, sharey=True)[0], orders):
        for one in series:
            if one.order == order:
                axes.plot(one.seconds, one.error, **_Style(one.label))
            else:
                axes.plot(one.seconds, one.error, color="#CCCCCC", linewidth=0.8, zorder=0)
        axes.set(xscale="log", yscale="log", xlabel="seconds", title=f"order k = {order}")
        _Finish(axes)
    figure.axes[0].set_ylabel(r"$|\varepsilon_h(u-u_h)|_0\,/\,|\varepsilon(u)|_0$  [no unit]")
    _Legend(figure)
    return figure


@ByKeyword
def LockingFigure(sweeps: Any) -> Figure:
    """Relative strain errors of `locking.Sweep`s against lam/mu, mu = 2, double logarithmic, one picture per order.

    >>> from ngdgc import LDG
    >>> from ngdgc.studies import locking
    >>> figure = LockingFigure([locking.Study(LDG(), order=1, n=2, lam=(1, 100))])
    """
    orders = sorted({sweep.order for sweep in sweeps})
    figure = Figure(figsize=(4.5 * max(len(orders), 1.3), 4.6), layout="constrained")
    for axes, order in zip(figure.subplots(1, len(orders), squeeze=False, sharey=True)[0], orders):
        own = [sweep for sweep in sweeps if sweep.order == order]
        for sweep in own:
            axes.plot(np.array(sweep.lam) / 2, sweep.errors, **_Style(sweep.label))
        axes.set(xscale="log", yscale="log", xlabel=r"$\lambda/\mu$ [no unit]", title=f"order k = {order}, h = 1/{own[0].n}")
        _Finish(axes)
    figure.axes[0].set_ylabel(r"$|\varepsilon_h(u-u_h)|_0\,/\,|\varepsilon(u)|_0$  [no unit]")
    _Legend(figure)
    return figure


def _Style(label: str) -> dict[str, Any]:
    colour, marker, size = STYLES[label.split()[0]]
    lifting = label.endswith("lifting")
    return {"color": colour, "marker": marker, "markersize": size / 2 if lifting else size, "linewidth": 1.2,
            "linestyle": "--" if lifting else "-", "markerfacecolor": colour if lifting else "none", "label": label}


def _Slope(axes: Any, series: Any, norm: str, slope: float) -> None:
    """A right-angled triangle with hypotenuse of the slope, below the curves at their two finest meshes."""
    coarse, fine = (1 / n for n in series[0].n[-2:])
    fine = np.sqrt(coarse * fine)       # half the way: steep ones stay clear of the next order's curves
    top = 0.55 * min(getattr(one, norm)[-2] for one in series)
    bottom = top * (fine / coarse) ** slope
    axes.plot([fine, coarse, coarse, fine], [bottom, bottom, top, bottom], color="#555555", linewidth=0.9, gid="slope")
    axes.annotate(str(slope), (coarse, np.sqrt(bottom * top)), xytext=(4, 0), textcoords="offset points", va="center",
                  fontsize=9, color="#555555")


def _Finish(axes: Any) -> None:
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(color="#DDDDDD", linewidth=0.6)


def _Legend(figure: Figure) -> None:
    """Every label once, below the pictures."""
    handles = {handle.get_label(): handle for axes in figure.axes for handle in axes.get_legend_handles_labels()[0]}
    figure.legend(handles=list(handles.values()), loc="outside lower center", ncols=5, frameon=False, fontsize=9)
