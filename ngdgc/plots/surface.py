"""Surfaces of bodies in space: faces in colours, names where their sides are seen, from two views."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.text import Text
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import proj3d
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from ..contact.graph import ZONES
from ..contracts import Array
from ..solution.solution import ContactSolution
from ..tools.values import Vectors
from .canvas import APART, PLACED, ZONE_COLOURS, Unconverged
from .regions import SEEN, BoundaryFunction, SurfaceFaces

VIEWS = ((-25, -60), (25, 120))     # elevation and azimuth [degrees]: between them all six sides of a box are seen
WIDE = 10           # of a figure with two views [inch]
ZOOM = 0.9          # of axes; there is room for their words
FLATTEST = 0.3      # extent of the axes in a direction, relative to the largest
BODY = "#D9E5F0"


def Surface(faces: Any, colours: Any, title: str, legend: Mapping[str, str], *, view: Sequence[float] | None = None,
            regions: SurfaceFaces | None = None, words: Mapping[str, str] = MappingProxyType({}),
            arrows: Sequence[tuple[Array, Array, Array, str]] = (), outlined: bool = True) -> Figure:
    """Faces (vertices, 3) in space, seen from below, where foundations are, and from above and behind; or from one `view`.

    words : {region: words}, written on the `regions` where they are seen
    arrows : (tail, vector, outward normal, colour), drawn where that side is seen
    outlined : draw the edges of the faces
    """
    views: Any = VIEWS if view is None else (Vectors(view, (2,), "view", "give (elevation, azimuth) in degrees"),)
    figure = Figure(figsize=(WIDE if len(views) > 1 else 7, 5.2), layout="constrained")
    for number, angles in enumerate(views, start=1):
        axes: Any = figure.add_subplot(1, len(views), number, **SPACE)
        DrawFaces(axes, faces, colours, angles, outlined)
        towards = Towards(angles)
        for tail, vector, normal, colour in arrows:
            if normal @ towards > SEEN:
                axes.quiver(*tail, *vector, color=colour, linewidth=1.4, arrow_length_ratio=0.3, zorder=50)
        if regions is not None:
            _Write(axes, regions, words, towards)
    figure.suptitle(title, fontsize=10)
    if legend:
        figure.legend(handles=[Patch(facecolor=colour, label=label) for label, colour in legend.items()],
                      loc="outside lower center", ncols=len(legend), frameon=False)
    figure.draw_without_rendering()     # which places the axes
    _Fit(figure)
    for axes in figure.axes:
        _Part(axes)
    figure.set_gid(PLACED)
    return figure


# What is painted later is in front: names and arrows of sides that are seen.
# A background would cover the names of the axes on the left.
SPACE: dict[str, Any] = {"projection": "3d", "proj_type": "ortho", "computed_zorder": False, "facecolor": "none"}


def DrawFaces(axes: Any, faces: Any, colours: Any, view: Sequence[float], outlined: bool = True) -> None:
    """Faces (vertices, 3) in space on axes made with `SPACE`, with equal scales."""
    points = np.concatenate(faces)
    extents = np.maximum(np.ptp(points, axis=0), FLATTEST * np.ptp(points, axis=0).max())
    middle = (points.max(axis=0) + points.min(axis=0)) / 2
    axes.add_collection3d(Poly3DCollection(faces, facecolors=colours, edgecolors="#222222" if outlined else colours,
                                           linewidths=0.4 if outlined else 0.3))
    axes.set(**{f"{name}lim": (m - extent / 2, m + extent / 2) for name, m, extent in zip("xyz", middle, extents)},
             **{f"{name}label": f"{name} [length]" for name in "xyz"})
    axes.set_box_aspect(tuple(extents), zoom=ZOOM)
    for axis, extent in zip((axes.xaxis, axes.yaxis, axes.zaxis), extents):
        # The lowest would meet the highest of the next axis in a corner.
        axis.set_major_locator(MaxNLocator(2 if extent < 0.5 * extents.max() else 4, prune="lower"))
        axis.labelpad = 8       # below the numbers
    axes.view_init(elev=view[0], azim=view[1])


def Towards(view: Sequence[float]) -> Array:
    """The direction (3,) from the body to the eye."""
    elevation, azimuth = np.radians(np.asarray(view, dtype=float))
    return np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])


def _Write(axes: Any, regions: SurfaceFaces, words: Mapping[str, str], towards: Array) -> None:
    for name, (place, normal) in regions.Places(towards).items():
        axes.text(*(place + 0.05 * regions.size * (normal + towards)), words.get(name, name), ha="center", va="center",
                  fontsize=9, zorder=100, bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1})


def _Part(axes: Any) -> None:
    """Move texts up or down in the picture, as little as possible, so that they lie on no earlier one."""
    up = np.array([0.0, 0, 1]) - np.sin(np.radians(axes.elev)) * Towards((axes.elev, axes.azim))
    up /= np.linalg.norm(up)
    ends = [axes.transData.transform(proj3d.proj_transform(*point, axes.get_proj())[:2]) for point in (np.zeros(3), up)]
    pixels, placed = ends[1][1] - ends[0][1], list[Any]()
    for text in axes.texts:
        own = TextBox(axes, text)
        ways = [0.0, *(way for taken in placed for way in (taken.y1 + APART - own.y0, taken.y0 - APART - own.y1))]
        free = [way for way in ways if not any(own.translated(0, way).overlaps(taken.padded(APART - 1)) for taken in placed)]
        way = min(free, key=abs)
        placed.append(own.translated(0, way))
        text.set_position_3d(np.array(text.get_position_3d()) + way / pixels * up)


def TextBox(axes: Any, text: Any) -> Any:
    """Where a text in space is drawn [pixel]: its own extent takes its coordinates for those of the picture."""
    place = text.get_position_3d()
    try:
        Text.set_position(text, proj3d.proj_transform(*place, axes.get_proj())[:2])
        return text.get_window_extent()
    finally:
        Text.set_position(text, place[:2])


def _Fit(figure: Figure) -> None:
    """Make axes smaller whose names are beyond the rim of the figure, as those of a flat body are, and place them anew."""
    width, tight = figure.bbox.width - APART, False
    solids: list[Any] = figure.axes
    for axes in solids:
        middle = axes.get_window_extent().intervalx.mean()
        names = [axis.label.get_window_extent() for axis in (axes.xaxis, axes.yaxis, axes.zaxis)]
        room = min((width - middle) / (max(box.x1 for box in names) - middle),
                   (middle - APART) / max(middle - min(box.x0 for box in names), 1))
        if room < 1:
            extents = np.ptp([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()], axis=1)
            axes.set_box_aspect(tuple(extents), zoom=ZOOM * room)
            tight = True
    if tight:
        figure.draw_without_rendering()


def DeformedFaces(solution: ContactSolution, scale: float) -> tuple[list[Array], list[str], float]:
    """(faces of the boundary moved by their own one-sided displacements, their colours, largest |u|); Gamma_C as its zones."""
    disc = solution.disc
    corners, moved = BoundaryFunction(disc.facets, solution.gfu)
    shown = [number for number, u in enumerate(moved) if np.all(np.isfinite(u))]
    touching, members = disc.contact.boundaryelements, disc.contact.members
    zone = {number: ZONE_COLOURS[solution.zones[members[touching == number]].max()] for number in np.unique(touching)}
    largest = max(np.linalg.norm(moved[number], axis=1).max() for number in shown)
    return [corners[number] + scale * moved[number] for number in shown], [zone.get(number, BODY) for number in shown], largest


def DeformedSurface(solution: ContactSolution, scale: float, view: Sequence[float] | None) -> Figure:
    """The deformed boundary of the body, Gamma_C in the colours of zones."""
    disc, (faces, colours, largest) = solution.disc, DeformedFaces(solution, scale)
    title = (f"{disc.method.name}, order {disc.order}, {disc.mesh.ne} elements\ndisplacement x {scale:g}, "
             f"max |u| = {largest:.3g}{Unconverged(solution)}")
    return Surface(faces, colours, title, dict(zip(ZONES, ZONE_COLOURS)), view=view)
