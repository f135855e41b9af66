"""A field along a straight line through the body."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ..contracts import Array
from ..exceptions import ProblemError
from ..solution.fields import FieldOf
from ..solution.solution import CheckSolution, ContactSolution
from ..tools.calls import ByKeyword
from ..tools.units import WithUnits
from ..tools.values import Vectors
from .canvas import BLUE, WIDTH, Panel, Unconverged

POINTS = 801        # along a line
ASIDE = 1e-9        # by which a line is moved off the sides of elements that it may run along, relative to its length


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
    CheckSolution(solution)
    disc, dim, shown = solution.disc, solution.disc.mesh.dim, FieldOf(solution, field)
    start, end = (Vectors(point, (dim,), name, f"give its {dim} coordinates") for name, point in (("a", a), ("b", b)))
    length = float(np.linalg.norm(end - start))
    if not length:
        raise ProblemError(f"a and b are both {tuple(start.tolist())}; give two ends of a line")
    s = np.linspace(0, 1, POINTS)
    points = _Points(disc.mesh, start + s[:, None] * (end - start), (end - start) / length, length)
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


def _Points(mesh: Any, places: Array, direction: Array, length: float) -> Any:
    """NGSolve's mesh points at places (n, d): a bit aside of the line, or on it where that is outside of the body."""
    aside = np.eye(len(direction))[np.abs(direction).argmin()]
    aside = aside - (aside @ direction) * direction
    if len(direction) == 3:     # off planes of a structured mesh, too
        aside = aside + 0.37 * np.cross(direction, aside)
    beside = mesh(*(places + ASIDE * length * aside).T)
    return np.where(beside["nr"] >= 0, beside, mesh(*places.T))


def _Place(point: Array) -> str:
    return f"({', '.join(f'{coordinate:.3g}' for coordinate in point)})"
