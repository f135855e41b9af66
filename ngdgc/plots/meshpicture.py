"""A mesh with the names of its regions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from ngsolve import Mesh

from ..exceptions import ProblemError
from ..mesh.facets import Coordinates, Facets
from ..tools.calls import ByKeyword
from ..tools.kinds import Short
from .canvas import BLUE, GREEN, ORANGE, PURPLE, RED, SKY, VERMILION, Frame, LabelAt, PlaneAxes
from .curves import Curves, ElementOutlines, Literal, OutlinePoints, SplitByElement
from .regions import SurfaceFaces
from .setting import DrawMaterials
from .surface import BODY, Surface

COLOURS = (BLUE, ORANGE, GREEN, VERMILION, PURPLE, SKY, RED)
REST = "default"        # Netgen's name for what has none


@dataclass(frozen=True)
class _Shown:
    """What curves and faces are made of, where there is no problem yet."""

    mesh: Mesh
    facets: Facets
    order: int = 1


@ByKeyword
def MeshFigure(mesh: Mesh, *, view: Sequence[float] | None = None) -> Figure:
    """The elements of a mesh, and its boundary regions in colours with their names; of a solid its surface.

    view : (elevation, azimuth) in degrees from which a solid is seen; None: from below and, beside, from above and behind

    >>> from ngdgc.meshes import RectangleMesh
    >>> MeshFigure(RectangleMesh(2)).axes[0].get_title()
    '8 elements'
    """
    if not isinstance(mesh, Mesh):
        raise ProblemError(f"mesh is {Short(mesh)}; give an ngsolve.Mesh, such as ReadMesh(file) returns")
    shown: Any = _Shown(mesh, Facets(mesh))
    names = list(dict.fromkeys(mesh.GetBoundaries()))
    colours = {name: BODY if name == REST else COLOURS[number % len(COLOURS)] for number, name in enumerate(names)}
    title = f"{mesh.ne} elements"
    if mesh.dim == 3:
        surface = SurfaceFaces(shown)
        return Surface(surface.corners, [colours[name] for name in surface.regions.tolist()], title, {}, view=view,
                       regions=surface)
    if view is not None:
        raise ProblemError(f"view is {view!r}, but the mesh is plane; leave it out")
    _, axes = PlaneAxes()
    DrawMaterials(axes, shown)
    points = ElementOutlines(shown)
    outlines = SplitByElement(points, np.asarray(Coordinates(2)(points)))
    axes.add_collection(PolyCollection(outlines, facecolors="none", edgecolors="#555555", linewidths=0.3, gid="outlines"))
    size = np.ptp(OutlinePoints(shown), axis=0).max()
    for name in names:
        curves = Curves(shown, Literal(name))
        axes.add_collection(LineCollection([curve.coordinates for curve in curves], linewidths=2.5,
                                           colors="black" if name == REST else colours[name]))
        if curves:
            LabelAt(axes, max(curves, key=lambda curve: curve.s[-1]), 0.03 * size, name)
    axes.set_title(title, fontsize=10)
    return Frame(axes)
