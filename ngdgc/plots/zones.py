"""Zones of contact where they are: along the curve Gamma_C of a plane body, on the surface of a solid."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ..contact.graph import ZONES
from ..contracts import Array
from ..solution.pictured import Pictured
from ..solution.solution import ContactSolution
from ..tools.calls import ByKeyword
from ..tools.units import WithUnits
from .canvas import WIDTH, ZONE_COLOURS, Frame, Labels, PlaneAxes, Unconverged
from .curves import GAP, Along, Curve, Curves, OutlinePoints
from .solid import DrawMap, TangentFrame, TangentLabel

COMB = 0.2      # height of the largest pressure, relative to the body
EDGE = "#222222"


@ByKeyword
@WithUnits
def ZonesFigure(solution: ContactSolution) -> Figure:
    """Separation, stick and slip on Gamma_C, with the pressure p_n [stress], on the undeformed body [length].

    2D: the curve in the colours of the zones, curved and closed ones as they are, and the pressure as a comb along the outward
    normals, one tooth at each contact point; its largest value is written down.  3D: a map of the zones and one of the pressure
    for each foundation, seen along its mean normal; a point stands for the part of its face that is nearest to it.  The legend
    has the length or area of every zone.

    >>> from ngdgc.cases import example_4_2
    >>> figure = ZonesFigure(example_4_2.Main(n=4))
    """
    solution = Pictured(solution)
    if solution.disc.mesh.dim == 3:
        return _Maps(solution)
    disc = solution.disc
    figure, axes = PlaneAxes()
    for curve in Curves(disc, ".*"):
        axes.plot(*curve.coordinates.T, color="#999999", linewidth=1)
    pressure, largest = solution.pressure, solution.pressure.max(initial=0)
    height = COMB * np.ptp(OutlinePoints(disc), axis=0).max() / (largest or 1)
    colours = np.array(ZONE_COLOURS)[solution.zones]
    for part in disc.contact.parts:
        start = 0.0
        for s, numbers, curve in Along(disc, part.foundation.boundary):
            axes.plot(*curve.coordinates.T, color=EDGE, linewidth=7, solid_capstyle="butt")
            axes.add_collection(LineCollection([*_Stretches(curve, s - start)], colors=colours[numbers], linewidths=5,
                                               capstyle="butt", gid="zones"))
            start += GAP * curve.s[-1]
            feet = disc.contact.coordinates[numbers]
            tips = feet + height * pressure[numbers, None] * disc.contact.normals[numbers]
            axes.add_collection(LineCollection([*np.stack([feet, tips], axis=1)], colors=colours[numbers],
                                               linewidths=1.2, gid="comb"))
            axes.plot(*tips.T, color=EDGE, linewidth=0.8)
    axes.set_title(f"largest pressure $p_n$ = {largest:.4g} [stress]{Unconverged(solution)}", fontsize=10)
    _Legend(figure, solution)
    return Frame(axes, *Labels(disc))


def _Stretches(curve: Curve, s: Array) -> Iterator[Any]:
    """The polylines (m, 2) of which each point at s stands for one: up to the middles to its neighbours."""
    ends = np.concatenate([[0], (s[1:] + s[:-1]) / 2, [curve.s[-1]]])
    for low, high in zip(ends[:-1], ends[1:]):
        at = np.concatenate([[low], curve.s[(curve.s > low) & (curve.s < high)], [high]])
        yield np.stack([np.interp(at, curve.s, column) for column in curve.coordinates.T], axis=1)


def _Maps(solution: ContactSolution) -> Figure:
    contact = solution.disc.contact
    figure = Figure(figsize=(WIDTH, 2.7 * len(contact.parts) + 0.7), layout="constrained")
    grid = figure.subplots(len(contact.parts), 2, squeeze=False, sharex="row", sharey="row")
    for row, part in zip(grid, contact.parts):
        frame = np.array(TangentFrame(contact.normals[part.points].mean(axis=0)))
        DrawMap(row[0], solution, part.points, frame, array=solution.zones, clim=(-0.5, 2.5), cmap=ListedColormap(ZONE_COLOURS),
                gid="zones")
        pressure = DrawMap(row[1], solution, part.points, frame, array=solution.pressure, cmap="viridis", gid="pressure")
        figure.colorbar(pressure, ax=row[1], label="pressure $p_n$ [stress]")
        for axes in row:
            axes.set_xlabel(TangentLabel(frame[0]))
        row[0].set_ylabel(TangentLabel(frame[1]))
        row[0].set_title(f"zones, {part.foundation.boundary!r}{Unconverged(solution)}", fontsize=10)
    _Legend(figure, solution)
    return figure


def _Legend(figure: Figure, solution: ContactSolution) -> None:
    sizes, flat = solution.ZoneLengths(), solution.disc.mesh.dim == 2 and not solution.disc.problem.axisymmetric
    words = "length" if flat else "area"
    figure.legend(handles=[Patch(facecolor=colour, edgecolor=EDGE, label=f"{zone} {sizes[zone]:.3g}")
                           for colour, zone in zip(ZONE_COLOURS, ZONES)],
                  loc="outside lower center", ncols=len(ZONES), frameon=False,
                  title=f"{words} of the zones", title_fontsize=10)
