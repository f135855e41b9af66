"""Maps of Gamma_C of bodies in space, seen along its mean normal."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ..contact.graph import ZONES
from ..contracts import Array
from ..mesh.pieces import Cut
from ..solution.solution import ContactSolution
from .canvas import ZONE_COLOURS
from .regions import BoundaryFunction

ARROWS = 100        # of friction in a map, about
WIDTH = 3.5         # of a map [inch]
HEIGHTS = 0.8, 3.0  # of a map, the least and the largest
BESIDE = 1.6        # for title, labels and the bar of colours


def ContactMaps(solution: ContactSolution) -> Figure:
    """Pressure, friction, zones and what is worn off at the points of Gamma_C, along its mean normal, a row a foundation."""
    contact = solution.disc.contact
    frames = [np.array(TangentFrame(contact.normals[part.points].mean(axis=0))) for part in contact.parts]
    heights = [_Height(contact.coordinates[part.points] @ frame.T) for part, frame in zip(contact.parts, frames)]
    columns = 4 if contact.wears else 3
    figure = Figure(figsize=(4 * columns, sum(heights) + BESIDE * len(heights)), layout="constrained")
    grid = figure.subplots(len(contact.parts), columns, squeeze=False, height_ratios=[BESIDE + height for height in heights])
    size = np.linalg.norm(solution.friction, axis=1)
    for row, part, frame in zip(grid, contact.parts, frames):
        here = part.points
        maps = [(row[0], solution.pressure, "pressure $p_n$ [stress]"), (row[1], size, "friction $|\\sigma_t|$ [stress]")]
        for axes, values, label in maps + [(axes, solution.worn, "worn off $w$ [length]") for axes in row[3:]]:
            drawn = DrawMap(axes, solution, here, frame, array=values, cmap="viridis",
                            clim=(0, values[here].max() or 1))
            # Beneath, since beside a map of a long foundation it would be higher than the map.
            figure.colorbar(drawn, ax=axes, label=label, location="bottom", aspect=30)
        along = solution.friction[here] @ frame.T
        few = slice(None, None, max(1, len(along) // ARROWS))
        if size[here].max() > 1e-12 * (np.abs(solution.traction).max() or 1):
            row[1].quiver(*(contact.coordinates[here] @ frame.T)[few].T, *along[few].T, color="white", edgecolor="black",
                          linewidth=0.5, width=0.006)
        DrawMap(row[2], solution, here, frame, array=solution.zones, cmap=ListedColormap(ZONE_COLOURS), clim=(-0.5, 2.5))
        for axes, name in zip(row, ("pressure", "friction on the body", "zones", "worn off")):
            axes.set(xlabel=TangentLabel(frame[0]), ylabel=TangentLabel(frame[1]))
            axes.set_title(f"{name}, {part.foundation.boundary!r}", fontsize=10)
    figure.legend(handles=[Patch(facecolor=colour, label=zone) for colour, zone in zip(ZONE_COLOURS, ZONES)],
                  loc="outside lower right", ncols=len(ZONES), frameon=False)
    return figure


def _Height(points: Array) -> float:
    """Of a map of WIDTH with these points (n, 2) on equal axes [inch]."""
    width, height = np.ptp(points, axis=0)
    return float(np.clip(WIDTH * height / width, *HEIGHTS))


def DrawMap(axes: Any, solution: ContactSolution, here: slice, frame: Array, *, array: Any, **style: Any) -> Any:
    """A foundation (`here`, the slice of its points) seen along its normal, coloured by the values (n,) at contact points.

    A point stands for the part of its face that is nearest to it.  `frame` (2, 3) are the axes; returns the collection.
    """
    contact, (corners, _) = solution.disc.contact, BoundaryFunction(solution.disc.facets, solution.gfu)
    faces, cells, members = [], [], []
    for facet in np.unique(contact.boundaryelements[(contact.members >= here.start) & (contact.members < here.stop)]):
        mine = contact.members[contact.boundaryelements == facet]
        faces.append(corners[facet] @ frame.T)
        cells += Cells(faces[-1], contact.coordinates[mine] @ frame.T)
        members += mine.tolist()
    drawn = axes.add_collection(PolyCollection(cells, array=array[members], edgecolors="face", linewidths=0.3, **style))
    axes.add_collection(PolyCollection(faces, facecolors="none", edgecolors="#777777", linewidths=0.4))
    axes.set(aspect="equal")
    axes.autoscale_view()
    return drawn


def Cells(polygon: Array, points: Array) -> list[Array]:
    """The parts of a convex polygon (m, 2) that are nearest to each of the points (n, 2), a list of n polygons."""
    cells = []
    for point in points:
        cell = polygon
        for other in points[np.any(points != point, axis=1)]:
            cell = Cut(cell, (cell - (point + other) / 2) @ (point - other))[0]
        cells.append(cell)
    return cells


def TangentFrame(normal: Array) -> tuple[Array, Array]:
    """Two orthonormal tangents, the first along the coordinate axis that is most nearly tangential.

    A normal within 8 degrees of a coordinate axis is taken for it: the mean of a mesh of a symmetric surface is a bit off.
    """
    normal = normal / np.linalg.norm(normal)
    if np.abs(normal).max() > 0.99:
        normal = np.round(normal)
    first = np.eye(3)[np.abs(normal).argmin()]
    first = first - (first @ normal) * normal
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    return first, second * np.sign(second[np.abs(second).argmax()])


def TangentLabel(axis: Array) -> str:
    for name, unit in zip("xyz", np.eye(3)):
        if np.allclose(axis, unit):
            return f"{name} [length]"
    return f"along ({', '.join(f'{c:.2g}' for c in axis)}) [length]"
