"""Figures of bodies in space: maps of Gamma_C, the deformed surface, and the setting."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from ngsolve import BND

from ..contact.graph import ZONES
from ..contracts import Array
from ..discrete.problem import DiscreteProblem
from ..mesh.checks import Sides
from ..mesh.facets import BoundaryFunction
from ..solution.solution import ContactSolution
from ..tools.values import Vectors
from .canvas import BLUE, GREEN, RED, ZONE_COLOURS

VIEWS = ((-25, -60), (25, 120))     # elevation and azimuth [degrees]: between them all six sides of a box are seen
WIDE = 10           # of a figure with two views [inch]
FLATTEST = 0.3      # extent of the axes in a direction, relative to the largest
SEEN = 0.1          # cosine to the eye from which a side is seen


def ContactMaps(solution: ContactSolution) -> Figure:
    """Pressure, friction and zones at the points of Gamma_C, seen along its mean normal, a row for each foundation."""
    contact = solution.disc.contact
    figure = Figure(figsize=(12, 3.9 * len(contact.parts)), layout="constrained")
    grid = figure.subplots(len(contact.parts), 3, squeeze=False)
    size = np.linalg.norm(solution.friction, axis=1)
    for row, part in zip(grid, contact.parts):
        here = part.points
        frame = TangentFrame(contact.normals[here].mean(axis=0))
        s, t = (contact.coordinates[here] @ axis for axis in frame)
        marks = {"s": max(6, 40000 / len(s)), "linewidths": 0}      # that they nearly touch on a square
        for axes, values, label in ((row[0], solution.pressure[here], "pressure $p_n$ [stress]"),
                                    (row[1], size[here], "friction $|\\sigma_t|$ [stress]")):
            figure.colorbar(axes.scatter(s, t, c=values, cmap="viridis", **marks), ax=axes, label=label)
        along = solution.friction[here] @ np.array(frame).T
        few = slice(None, None, max(1, len(s) // 300))
        if size[here].max() > 1e-12 * (np.abs(solution.traction).max() or 1):
            row[1].quiver(s[few], t[few], *along[few].T, color="white", edgecolor="black", linewidth=0.5, width=0.006)
        row[2].scatter(s, t, c=solution.zones[here], cmap=ListedColormap(ZONE_COLOURS), vmin=-0.5, vmax=2.5, **marks)
        for axes, name in zip(row, ("pressure", "friction on the body", "zones")):
            axes.set(aspect="equal", xlabel=TangentLabel(frame[0]), ylabel=TangentLabel(frame[1]))
            axes.set_title(f"{name}, {part.foundation.boundary!r}", fontsize=10)
    figure.legend(handles=[Patch(facecolor=colour, label=zone) for colour, zone in zip(ZONE_COLOURS, ZONES)],
                  loc="outside lower right", ncols=len(ZONES), frameon=False)
    return figure


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
            cell = _HalfPlane(cell, other - point, (point + other) / 2)
        cells.append(cell)
    return cells


def _HalfPlane(polygon: Array, normal: Array, origin: Array) -> Array:
    """The part of a convex polygon where (x - origin).normal <= 0."""
    height, corners = (polygon - origin) @ normal, []
    for a, b, low, high in zip(polygon, np.roll(polygon, -1, axis=0), height, np.roll(height, -1)):
        if low <= 0:
            corners.append(a)
        if low * high < 0:
            corners.append(a + low / (low - high) * (b - a))
    return np.array(corners).reshape(-1, 2)


def DeformedSurface(solution: ContactSolution, scale: float) -> Figure:
    """The boundary of the body with each face moved by its own one-sided displacement; Gamma_C in the colours of zones."""
    disc = solution.disc
    corners, moved = BoundaryFunction(disc.facets, solution.gfu)
    shown = [number for number, u in enumerate(moved) if np.all(np.isfinite(u))]
    faces = [corners[number] + scale * moved[number] for number in shown]
    touching, members = disc.contact.boundaryelements, disc.contact.members
    zone = {number: ZONE_COLOURS[solution.zones[members[touching == number]].max()] for number in np.unique(touching)}
    colours = [zone.get(number, "#D9E5F0") for number in shown]
    largest = max(np.linalg.norm(moved[number], axis=1).max() for number in shown)
    state = "" if solution.converged else ", NOT CONVERGED"
    title = (f"{disc.method.name}, order {disc.order}, {disc.mesh.ne} elements\ndisplacement x {scale:g}, "
             f"max |u| = {largest:.3g}{state}")
    return Surface(faces, colours, title, dict(zip(ZONES, ZONE_COLOURS)))


KINDS = {"dirichlet": "#555555", "roller": GREEN, "traction": BLUE, "foundation": RED, "free": "#D9E5F0"}


def SettingSurface(disc: DiscreteProblem) -> Figure:
    """The boundary of the undeformed body in colours of what acts on it."""
    mesh, points = disc.mesh, disc.mesh.ngmesh.Coordinates()
    kinds = dict.fromkeys(range(len(mesh.GetBoundaries())), "free")
    for kind, region in disc.problem.Regions():
        kinds |= {index: kind for index, found in enumerate(mesh.Boundaries(region).Mask()) if found}
    elements = [element for element, side in zip(mesh.Elements(BND), Sides(disc.facets, ".*")) if side]
    faces = [np.array([points[vertex.nr] for vertex in element.vertices]) for element in elements]
    present = {kind: colour for kind, colour in KINDS.items() if kind in kinds.values()}
    return Surface(faces, [KINDS[kinds[element.index]] for element in elements], "setting", present)


def Surface(faces: Any, colours: Any, title: str, legend: Mapping[str, str], *, view: Sequence[float] | None = None,
            names: Mapping[str, tuple[Array, Array]] = MappingProxyType({}), outlined: bool = True) -> Figure:
    """Faces (vertices, 3) in space, seen from below, where foundations are, and from above and behind; or from one `view`.

    names : {words: (place, outward normal)}, written where that side is seen
    outlined : draw the edges of the faces
    """
    views: Any = VIEWS if view is None else (Vectors(view, (2,), "view", "give (elevation, azimuth) in degrees"),)
    points = np.concatenate(faces)
    extents = np.maximum(np.ptp(points, axis=0), FLATTEST * np.ptp(points, axis=0).max())
    middle = (points.max(axis=0) + points.min(axis=0)) / 2
    figure = Figure(figsize=(WIDE if len(views) > 1 else 7, 5.2), layout="constrained")
    for number, (elevation, azimuth) in enumerate(views, start=1):
        axes: Any = figure.add_subplot(1, len(views), number, projection="3d", proj_type="ortho")
        axes.add_collection3d(Poly3DCollection(faces, facecolors=colours, edgecolors="#222222" if outlined else colours,
                                               linewidths=0.4 if outlined else 0.3))
        axes.set(**{f"{name}lim": (m - extent / 2, m + extent / 2) for name, m, extent in zip("xyz", middle, extents)},
                 **{f"{name}label": f"{name} [length]" for name in "xyz"})
        axes.set_box_aspect(tuple(extents), zoom=0.9)
        for axis, extent in zip((axes.xaxis, axes.yaxis, axes.zaxis), extents):
            axis.set_major_locator(MaxNLocator(2 if extent < 0.5 * extents.max() else 4))
        axes.view_init(elev=elevation, azim=azimuth)
        e, a = np.radians([elevation, azimuth])
        towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        for words, (place, normal) in names.items():
            if normal @ towards > SEEN:
                axes.text(*(place + 0.05 * extents.max() * (normal + towards)), words, ha="center", va="center", fontsize=9,
                          zorder=100, bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1})
    figure.suptitle(title, fontsize=10)
    if legend:
        figure.legend(handles=[Patch(facecolor=colour, label=label) for label, colour in legend.items()],
                      loc="outside lower center", ncols=len(legend), frameon=False)
    return figure


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
