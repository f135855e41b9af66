"""Solutions side by side: pressure and friction on common axes, deformed bodies at a common scale."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..contracts import Array
from ..exceptions import ProblemError
from ..solution.magnification import Magnification
from ..solution.pictured import Pictured
from ..solution.solution import ContactSolution
from ..tools.calls import ByKeyword
from ..tools.units import WithUnits
from .canvas import FOUNDATION_COLOURS, VERMILION, WIDTH, HideNoise, Labels, Panel, Unconverged
from .curves import Along, Left
from .deformed import DrawElements
from .solid import DrawMap, TangentFrame, TangentLabel
from .surface import SPACE, VIEWS, DeformedFaces, DrawFaces

COLOURS = (*FOUNDATION_COLOURS, VERMILION, "black")
LINES = ("-", "--", "-.", ":")
MARKERS = "os^vDx+"
FEW = 60        # points of a curve from which on markers would hide it
ROW = 3         # deformed bodies in a row


@ByKeyword
@WithUnits
def ComparisonFigure(solutions: Mapping[str, ContactSolution], *, scale: float | Literal["auto"] = 1) -> Figure:
    """Solutions {label: ContactSolution} of one problem, for example by several methods.

    2D: pressure p_n and friction sigma_t along s, as in `ContactFigure`, on common axes, a column for each foundation; below,
    the deformed bodies with common axes.  3D: maps of pressure and friction, a row for each solution and the same colours for
    all, over the deformed bodies.

    scale : of the displacement in the deformed bodies, 1 is real, "auto" the smallest that is right for one of them

    Raises ProblemError if there is no solution, or if dimension or foundations differ.

    >>> from ngdgc import LDG, Conforming
    >>> from ngdgc.cases import example_4_2
    >>> figure = ComparisonFigure({str(method): example_4_2.Main(method=method, n=4) for method in (LDG(), Conforming())})
    """
    if not isinstance(solutions, dict) or not solutions:
        raise ProblemError(f"solutions is {solutions!r}; give a dictionary of ContactSolutions by their labels, "
                           'such as {"IP": first, "H1": second}')
    # Labels may be orders, say.
    solutions = {str(label): Pictured(solution, f"solution {str(label)!r}") for label, solution in solutions.items()}
    first = next(iter(solutions.values()))
    for label, solution in solutions.items():
        if _Kind(solution) != _Kind(first):
            raise ProblemError(f"solution {label!r} has (dimension, foundations) {_Kind(solution)}, the first one "
                               f"{_Kind(first)}; compare solutions of one problem")
    common = min(Magnification(solution, scale) for solution in solutions.values())
    return _Maps(solutions, common) if first.disc.mesh.dim == 3 else _Curves(solutions, common)


def _Kind(solution: ContactSolution) -> tuple[Any, ...]:
    return solution.disc.mesh.dim, *(part.foundation.boundary for part in solution.disc.contact.parts)


def _Curves(solutions: Mapping[str, ContactSolution], scale: float) -> Figure:
    parts = next(iter(solutions.values())).disc.contact.parts
    rows = -(-len(solutions) // ROW)
    figure = Figure(figsize=(WIDTH, 4.2 + 2.1 * rows), layout="constrained")
    halves: Any = figure.subfigures(2, 1, height_ratios=[4.2, 2.1 * rows])
    upper, lower = halves
    grid = upper.subplots(2, len(parts), squeeze=False, sharex="col", sharey="row")
    handles = []
    for number, (label, solution) in enumerate(solutions.items()):
        colour, line, mark = COLOURS[number % len(COLOURS)], LINES[number % len(LINES)], MARKERS[number % len(MARKERS)]
        style: dict[str, Any] = {"color": colour, "linestyle": line, "marker": mark, "linewidth": 1.2, "markersize": 4,
                                 "fillstyle": "none"}
        handles.append(Line2D([], [], label=label + Unconverged(solution), **style))
        friction = np.sum(solution.friction * Left(solution.normals), axis=1)
        for column, part in zip(grid.T, parts):
            for s, numbers, _ in Along(solution.disc, part.foundation.boundary):
                style |= {"marker": mark if len(s) <= FEW else ""}
                column[0].plot(s, solution.pressure[numbers], **style)
                column[1].plot(s, friction[numbers], **style)
    for column, part in zip(grid.T, parts):
        Panel(column[0], title=f"{part.foundation.kind} of {part.foundation.boundary!r}").title.set_fontsize(10)
        Panel(column[1], xlabel="s [length]").axhline(0, color="#999999", linewidth=0.8, zorder=0)
    for axes in grid[:, 0]:
        HideNoise(axes, solutions.values())
    grid[0, 0].set_ylabel("pressure\n$p_n$ [stress]")
    grid[1, 0].set_ylabel("friction along s\n$\\sigma_t$ [stress]")
    upper.align_ylabels(grid[:, 0])
    upper.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 4), frameon=False)
    _DrawBodies(lower, solutions, scale, rows)
    return figure


def _DrawBodies(figure: Any, solutions: Mapping[str, ContactSolution], scale: float, rows: int) -> None:
    columns = min(len(solutions), ROW)
    grid = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    for axes in grid.ravel()[len(solutions):]:
        axes.set_visible(False)
    for axes, (label, solution) in zip(grid.ravel(), solutions.items()):
        DrawElements(axes, solution, scale)
        axes.set_aspect("equal")
        axes.autoscale_view()
        axes.set_title(label, fontsize=10)
        axes.spines[["top", "right"]].set_visible(False)
    across, up = Labels(next(iter(solutions.values())).disc)
    figure.supxlabel(f"{across}, displacement x {scale:g}", fontsize=10)
    figure.supylabel(up, fontsize=10)


def _Maps(solutions: Mapping[str, ContactSolution], scale: float) -> Figure:
    """Maps of pressure and friction, a row for each solution and one scale for all, over the deformed bodies."""
    parts, rows = next(iter(solutions.values())).disc.contact.parts, -(-len(solutions) // ROW)
    heights = [2.0 * len(solutions), 2.3 * rows]
    figure = Figure(figsize=(max(WIDTH, 2 * 2.9 * len(parts)), sum(heights) + 0.4), layout="constrained")
    halves: Any = figure.subfigures(2, 1, height_ratios=heights)
    upper, lower = halves
    columns = [(number, "pressure $p_n$ [stress]", {label: solution.pressure for label, solution in solutions.items()})
               for number in range(len(parts))]
    columns += [(number, "friction $|\\sigma_t|$ [stress]",
                 {label: np.linalg.norm(solution.friction, axis=1) for label, solution in solutions.items()})
                for number in range(len(parts))]
    for column, (number, words, values) in enumerate(columns):
        _DrawColumn(upper, solutions, column, len(columns), number, words, values)
    for number, (label, solution) in enumerate(solutions.items(), start=1):
        axes: Any = lower.add_subplot(rows, min(len(solutions), ROW), number, **SPACE)
        faces, colours, _ = DeformedFaces(solution, scale)
        DrawFaces(axes, faces, colours, VIEWS[0])
        axes.set_title(label, fontsize=10)
        axes.set(xlabel="", ylabel="", zlabel="")
    lower.supxlabel(f"x, y, z [length], displacement x {scale:g}", fontsize=10)
    return figure


def _DrawColumn(figure: Any, solutions: Mapping[str, ContactSolution], column: int, columns: int, number: int, words: str,
                values: Mapping[str, Array]) -> None:
    """Maps of one quantity on one foundation, one below the other, with one bar of colours."""
    top = max(values[label][solution.disc.contact.parts[number].points].max() for label, solution in solutions.items())
    drawn, stack = None, []
    for row, (label, solution) in enumerate(solutions.items()):
        part = solution.disc.contact.parts[number]
        stack.append(figure.add_subplot(len(solutions), columns, row * columns + column + 1))
        frame = np.array(TangentFrame(solution.normals[part.points].mean(axis=0)))
        drawn = DrawMap(stack[-1], solution, part.points, frame, array=values[label], clim=(0, top or 1), cmap="viridis",
                        gid=words.partition(" ")[0])
        stack[-1].set_title(f"{label}{Unconverged(solution)}, {part.foundation.boundary!r}", fontsize=10)
        stack[-1].set_ylabel(TangentLabel(frame[1]))
    stack[-1].set_xlabel(TangentLabel(frame[0]))
    figure.colorbar(drawn, ax=stack, label=words, location="bottom", aspect=15)
