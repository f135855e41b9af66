"""A field along a straight line through the body."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ..contracts import Array
from ..exceptions import ProblemError
from ..solution.fields import FieldOf
from ..solution.numbers import LineEnds, LinePoints
from ..solution.pictured import Pictured
from ..solution.solution import ContactSolution
from ..tools.calls import ByKeyword
from ..tools.units import WithUnits
from .canvas import BLUE, WIDTH, Panel, Unconverged

POINTS = 801        # along a line


@ByKeyword
@WithUnits
def LineFigure(solution: ContactSolution, a: Sequence[float], b: Sequence[float], *, field: Any = "vonmises") -> Figure:
    """A field along the straight line from a to b, over the distance from a [length]; broken at every element, so jumps show.

    a, b : ends, (d,) [length];  field : as for `FieldFigure`

    Outside of the body, in a hole say, nothing is drawn.  On a line along sides of elements all values are those of one side.
    Raises ProblemError for a line that meets no element, and for fields as `FieldFigure`.

    >>> from ngdgc.cases import example_4_2
    >>> figure = LineFigure(example_4_2.Main(n=4), (0, 0.1), (1, 0.1), field="uy")
    >>> figure.axes[0].get_ylabel()
    '$u_y$ [length]'
    """
    solution = Pictured(solution)
    disc, dim, shown = solution.disc, solution.disc.mesh.dim, FieldOf(solution, field)
    start, end = LineEnds(a, b, dim)
    length = float(np.linalg.norm(end - start))
    s = np.linspace(0, 1, POINTS)
    points = LinePoints(disc.mesh, start + s[:, None] * (end - start), end - start)
    inside = points["nr"] >= 0
    if not inside.any():
        corners = disc.mesh.ngmesh.Coordinates()[:, :dim]
        raise ProblemError(f"the line from {tuple(start.tolist())} to {tuple(end.tolist())} meets no element of the mesh, "
                           f"which extends from {tuple(corners.min(axis=0).tolist())} to {tuple(corners.max(axis=0).tolist())};"
                           " give one through the body")
    values = np.full(POINTS, np.nan)
    values[inside] = shown.At(points[inside])
    # Lines end where an element ends: not a number breaks them.
    breaks = np.flatnonzero(np.diff(points["nr"])) + 1
    figure = Figure(figsize=(WIDTH, 3.4), layout="constrained")
    axes = Panel(figure.subplots(), ylabel=shown.label, xlabel=f"distance from {_Place(start)} to {_Place(end)} [length]")
    axes.plot(np.insert(length * s, breaks, np.nan), np.insert(values, breaks, np.nan), color=BLUE, linewidth=1.4)
    axes.set_xlim(0, length)
    axes.set_title(f"{disc.method.name}, order {disc.order}, {disc.mesh.ne} elements{Unconverged(solution)}\n"
                   f"{np.nanmin(values):.4g} to {np.nanmax(values):.4g}", fontsize=10)
    return figure


def _Place(point: Array) -> str:
    return f"({', '.join(f'{coordinate:.3g}' for coordinate in point)})"
