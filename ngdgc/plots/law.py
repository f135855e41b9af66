"""The law plot: does the solution obey its law of contact?"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from ..contact.boundary import ContactBoundary
from ..contact.graph import LEAST, ContactGraph, Distance, GraphPoint, Scales
from ..contact.parts import ContactPart, OverParts
from ..contracts import Array
from ..solution.pictured import Pictured
from ..solution.solution import ContactSolution
from ..tools.calls import ByKeyword
from ..tools.units import WithUnits
from .canvas import FOUNDATION_COLOURS, VERMILION, WIDTH, Panel, Unconverged
from .curves import Left

OFF = 1e-6          # distance to the law (`graph.Distance`) from which a point is marked, no unit
SAMPLES = 200       # of the graph of p_n
SPREAD = 30         # widest gap over deepest penetration from which the axis of penetrations becomes logarithmic
STEEP = 5           # friction over its bound from which that axis becomes logarithmic
TICKS = 4           # at most, along an axis: small numbers are long
LAW = "#999999"


@ByKeyword
@WithUnits
def LawFigure(solution: ContactSolution) -> Figure:
    """Pressure over penetration and friction over slip at every contact point, on the graphs of the laws.

    Left p_n [stress] over r = u_n - g [length], one colour for each foundation; where data vary along Gamma_C the graphs fill
    a band.  Right the friction, over its bound p_t at that point [1], over the slip [length]: both along the tangent
    (-n_y, n_x) in 2D, along t_t + gamma u_t in 3D, so that friction in a wrong direction shows there too; points without a
    bound are left out if they obey the law.  A point further than 1e-6 from its law (`graph.Distance`, no unit) is crossed,
    counted in the title, and tied to a point of its own graph: no band hides it.

    >>> from ngdgc.cases import example_4_2
    >>> figure = LawFigure(example_4_2.Main(n=4))
    """
    solution = Pictured(solution)
    contact, displacement, traction = solution.disc.contact, solution.displacement, solution.traction
    distance = Distance(contact, displacement, traction).distance
    off = distance > OFF
    uscale, tscale = Scales(contact, displacement, traction)
    graph = ContactGraph(contact, tscale / uscale).At(traction + tscale / uscale * displacement)
    figure = Figure(figsize=(WIDTH, 3.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    _DrawNormal(left, solution, graph, off)
    _DrawTangential(right, solution, graph, off, LEAST * tscale)
    verdict = f"{off.sum()} of {len(off)} points off the law" if np.any(off) else f"all {len(off)} points on the law"
    figure.suptitle(f"{verdict}, largest distance {distance.max(initial=0):.1e}{Unconverged(solution)}", fontsize=10)
    handles = [Line2D([], [], color=colour, marker="o", markersize=4, linestyle="none", label=part.foundation.boundary)
               for part, colour in zip(contact.parts, _Colours(contact))]
    handles.append(Line2D([], [], color=LAW, linewidth=3, label="law"))
    if np.any(off):
        handles.append(Line2D([], [], color=VERMILION, marker="x", label="off the law"))
    figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 4), frameon=False)
    return figure


def _Colours(contact: ContactBoundary) -> list[str]:
    return [FOUNDATION_COLOURS[number % len(FOUNDATION_COLOURS)] for number in range(len(contact.parts))]


def _DrawNormal(axes: Any, solution: ContactSolution, graph: GraphPoint, off: Any) -> None:
    contact, r = solution.disc.contact, solution.penetration
    p = contact.Normal(solution.traction)       # `pressure` is 0 where the law is, even where the traction is not
    deepest, widest = max(r.max(initial=0), 0), max(-r.min(initial=0), 0)
    for part, colour in zip(contact.parts, _Colours(contact)):
        # Finer near 0, where laws with a small exponent rise at once.
        depths = deepest * np.linspace(0, 1, SAMPLES)**2
        values = np.array([part.Pressure(np.full_like(r[part.points], depth)) for depth in depths])
        low, high = values.min(axis=1, initial=np.inf), values.max(axis=1, initial=0)
        if np.allclose(low, high, rtol=1e-9, atol=0):
            axes.plot(depths, high, color=LAW, linewidth=3, gid="law")
        else:
            axes.fill_between(depths, low, high, color=colour, alpha=0.25, linewidth=1, gid="law")
    axes.plot([-widest, 0], [0, 0], color=LAW, linewidth=3)
    _DrawPoints(axes, contact, r, p, contact.Penetration(graph.displacement), contact.Normal(graph.traction), off,
                np.full(len(r), True))
    if widest > SPREAD * deepest > 0:
        digit = 10.0**np.floor(np.log10(deepest))
        unit = digit * np.ceil(deepest / digit)
        axes.set_xscale("symlog", linthresh=unit, linscale=2)
        axes.set_xticks([-10.0**np.floor(np.log10(widest)), 0, unit])
        axes.xaxis.set_major_formatter(lambda x, _: f"{x:.0e}" if x else "0")
    else:
        axes.xaxis.set_major_locator(MaxNLocator(TICKS))
    Panel(axes, xlabel="penetration $u_n - g$ [length]", ylabel="pressure $p_n$ [stress]")
    if np.abs(p).max(initial=0) == 0:
        axes.set_ylim(-0.1, 1)


def _DrawTangential(axes: Any, solution: ContactSolution, graph: GraphPoint, off: Any, least: float) -> None:
    contact, dim = solution.disc.contact, solution.disc.mesh.dim
    direction = Left(contact.normals) if dim == 2 else _Unit(contact.Tangential(graph.q))
    slips, frictions = ([np.sum(contact.Tangential(vectors) * direction, axis=1) for vectors in pair]
                        for pair in ((solution.displacement, graph.displacement), (solution.traction, graph.traction)))
    # With the pressure that is reported: of a stiff law p_n(u_n - g) would be round-off.
    bound = OverParts(contact.parts, ContactPart.Bound, solution.penetration, solution.pressure)
    bound = bound * OverParts(contact.parts, ContactPart.SlipFactor, contact.Slip(solution.displacement))[0]
    shown = (bound > least) | off
    scale = np.maximum(bound, least)
    if not np.any(shown):
        axes.text(0.5, 0.5, "no friction", transform=axes.transAxes, ha="center")
        axes.set_axis_off()
        return
    low, high = min(slips[0][shown].min(initial=0), 0), max(slips[0][shown].max(initial=0), 0)
    reach = 0.1 * (max(-low, high) or 1)
    if dim == 2:
        axes.plot([low - reach, 0, 0, high + reach], [-1, -1, 1, 1], color=LAW, linewidth=3, gid="law")
    else:
        axes.plot([0, 0, high + reach], [0, 1, 1], color=LAW, linewidth=3, gid="law")
    _DrawPoints(axes, contact, slips[0], frictions[0] / scale, slips[1], frictions[1] / scale, off, shown)
    if np.abs(axes.get_ylim()).max() > STEEP:
        axes.set_yscale("symlog", linthresh=1, linscale=1.5)
        axes.autoscale()
    axes.xaxis.set_major_locator(MaxNLocator(TICKS))
    along = "along s" if dim == 2 else "$|u_t|$"
    Panel(axes, xlabel=f"slip {along} [length]", ylabel="friction / bound $p_t$ [1]")


def _DrawPoints(axes: Any, contact: ContactBoundary, x: Array, y: Array, lawx: Array, lawy: Array, off: Any,
                shown: Any) -> None:
    """Points (x, y), crossed where they are off, and tied to (lawx, lawy) on the graph."""
    for part, colour in zip(contact.parts, _Colours(contact)):
        mine = np.flatnonzero((shown & ~off)[part.points]) + part.points.start
        axes.plot(x[mine], y[mine], "o", color=colour, markersize=3.5, markerfacecolor="none", gid="points")
    axes.add_collection(LineCollection(np.stack([np.stack([x, y], axis=1), np.stack([lawx, lawy], axis=1)], axis=1)[off],
                                       color=VERMILION, linewidth=0.8), autolim=False)
    axes.plot(x[off], y[off], "x", color=VERMILION, markersize=6, gid="off")


def _Unit(vectors: Array) -> Array:
    length = np.linalg.norm(vectors, axis=1)
    return vectors / np.where(length > 0, length, 1)[:, None]
