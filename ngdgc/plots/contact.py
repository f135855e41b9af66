"""Contact quantities along Gamma_C."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ..contact.graph import ZONES
from ..contracts import Array
from ..problem.foundation import Foundation
from ..solution.pictured import Pictured
from ..solution.solution import ContactSolution
from ..tools.calls import ByKeyword
from ..tools.units import WithUnits
from .canvas import BLUE, GREEN, PURPLE, VERMILION, WIDTH, ZONE_COLOURS, HideNoise
from .curves import GAP, Along, Curve, Left
from .solid import ContactMaps


@ByKeyword
@WithUnits
def ContactFigure(solution: ContactSolution, *, slip: bool = False) -> Figure:
    """Pressure, friction and penetration along Gamma_C, what is worn off it, and its zones, a column for each foundation.

    slip : also draw the tangential displacement u_t [length]

    s is the arc length along Gamma_C in the direction of the tangent (-n_y, n_x), the body on the left; tangential components
    are positive in this direction.  Markers are the quadrature points.  In 3D maps of pressure, friction and zones.

    >>> from ngdgc.cases import example_4_2
    >>> figure = ContactFigure(example_4_2.Main(n=4))
    """
    solution = Pictured(solution)
    disc, contact = solution.disc, solution.disc.contact
    if disc.mesh.dim == 3:
        return ContactMaps(solution)
    tangent = Left(solution.normals)
    rows = ["p", "t", *["u"] * slip, "r", *["w"] * contact.wears]
    figure = Figure(figsize=(max(WIDTH, 3.5 * len(contact.parts)), 1 + 1.35 * len(rows)), layout="constrained")
    grid = figure.subplots(len(rows) + 1, len(contact.parts), sharex="col", squeeze=False,
                           height_ratios=[1] * len(rows) + [0.15])
    values = {"p": solution.pressure, "t": np.sum(solution.friction * tangent, axis=1),
              "u": np.sum(solution.slip * tangent, axis=1), "r": solution.penetration,
              "w": solution.worn}
    for column, part in zip(grid.T, contact.parts):
        pieces = list(Along(disc, part.foundation.boundary))
        panels = dict(zip(rows, column))
        for s, numbers, _ in pieces:
            mark = {"marker": "o", "markersize": 3} if len(s) <= 100 else {}
            for sign in (1, -1):
                panels["t"].plot(s, sign * solution.bound[numbers], "--", color="#444444", linewidth=1)
            for name, colour in zip(rows, (BLUE, VERMILION, *["black"] * slip, GREEN, PURPLE)):
                panels[name].plot(s, values[name][numbers], color=colour, linewidth=1.2, **mark)
        _DrawZones(column[-1], pieces, solution.zones)
        for name in "pt":
            HideNoise(panels[name], [solution])
        _DressContact(column, panels, part.foundation, pieces)
    figure.align_ylabels(grid[:-1])
    handles = [Line2D([], [], linestyle="--", color="#444444", linewidth=1, label="bounds $\\pm p_t$ of friction"),
               *(Patch(color=colour, label=zone) for colour, zone in zip(ZONE_COLOURS, ZONES))]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), frameon=False, columnspacing=1)
    return figure


def _DrawZones(axes: Any, pieces: Sequence[tuple[Array, Any, Curve]], zones: Any) -> None:
    """A band of colours; each point stands for the stretch up to the middles to its neighbours."""
    start = 0.0
    for s, numbers, curve in pieces:
        ends = np.concatenate([[start], (s[1:] + s[:-1]) / 2, [start + curve.s[-1]]])
        axes.bar(ends[:-1], 1, np.diff(ends), align="edge", color=[ZONE_COLOURS[zone] for zone in zones[numbers]], linewidth=0)
        start += GAP * curve.s[-1]
    axes.set(ylim=(0, 1), yticks=[])
    axes.set_ylabel("zone", rotation=0, ha="right", va="center")


def _DressContact(column: Any, panels: Mapping[str, Any], foundation: Foundation,
                  pieces: Sequence[tuple[Array, Any, Curve]]) -> None:
    labels = {"p": "pressure\n$p_n$ [stress]", "t": "friction along s\n$\\sigma_t$ [stress]",
              "u": "slip along s\n$u_t$ [length]",
              "r": "penetration\n$u_n - g$ [length]", "w": "worn off\n$w$ [length]"}
    for name, axes in panels.items():
        axes.axhline(0, color="#999999", linewidth=0.8, zorder=0)
        axes.set_ylabel(labels[name])
        axes.margins(x=0)
        axes.spines[["top", "right"]].set_visible(False)
    column[0].set_title(f"{foundation.kind} of {foundation.boundary!r}", fontsize=10)
    first, last = pieces[0][2].coordinates[0], pieces[-1][2].coordinates[-1]
    column[-1].set_xlabel(f"s [length], from ({first[0]:.3g}, {first[1]:.3g}) to ({last[0]:.3g}, {last[1]:.3g})")
