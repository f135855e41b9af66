"""The deformed mesh over its foundations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from ..contracts import Array
from ..data.coefficients import ValuesAt
from ..mesh.facets import Coordinates
from ..solution.magnification import Magnification
from ..solution.pictured import Pictured
from ..solution.solution import ContactSolution
from ..tools.calls import ByKeyword
from ..tools.units import WithUnits
from .canvas import RED, DrawBlock, Frame, Labels, PlaneAxes, Thickness, Unconverged
from .curves import Curves, ElementOutlines, FoundationCurves, Left, SplitByElement
from .surface import DeformedSurface


@ByKeyword
@WithUnits
def DeformedFigure(solution: ContactSolution, *, scale: float | Literal["auto"] = 1,
                   view: Sequence[float] | None = None) -> Figure:
    """The deformed mesh over the foundations, as figures 2 and 4 of the paper.

    scale : displacement and gap are drawn at `scale` times their values, so that what overlaps is in contact; 1 is real,
        "auto" one at which the displacement of a stiff body is seen (`Magnification`); the title says it
    view : (elevation, azimuth) in degrees from which a solid is seen; None: from below and, beside, from above and behind

    Every element moves with its own one-sided displacement, so the jumps of a DG solution show.  A foundation is drawn pale
    beyond Gamma_C, as far as the body has slid, and a rigid punch where it has moved to; a joint is a red line where it was.
    In 3D the surface of the body, without the foundations.

    >>> from ngdgc.cases import example_4_2
    >>> figure = DeformedFigure(example_4_2.Main(n=4))
    """
    solution = Pictured(solution)
    scale = Magnification(solution, scale)
    disc, contact = solution.disc, solution.disc.contact
    if disc.mesh.dim == 3:
        return DeformedSurface(solution, scale, view)
    _, axes = PlaneAxes()
    for foundation in (part.foundation for part in contact.parts):
        for curve in () if foundation.kind == "joint" else FoundationCurves(disc, foundation):
            if contact.punches is not None:
                punched = contact.punches.At(foundation, disc.motion, curve.coordinates)
                curve = replace(curve, coordinates=curve.coordinates + scale * punched)
            mine = np.unique(contact.members[np.isin(contact.boundaryelements, curve.points["nr"])])
            moved = (contact.coordinates + scale * solution.displacement)[mine]
            deepest = scale * solution.penetration[mine].max()
            thickness = max(Thickness(disc, curve), 1.3 * deepest)
            flush = contact.normals[mine] @ curve.normals[[0, -1]].T > 0.8
            reach = [np.max(sign * (moved - curve.coordinates[end]) @ Left(curve.normals[end]), where=flush[:, end], initial=0)
                     for end, sign in ((0, -1), (-1, 1))]
            margin = 0.15 * thickness
            gap = ValuesAt(foundation.gap, curve.points, "gap", curve.region)
            DrawBlock(axes, curve, scale * gap, thickness, [
                length + margin if length > margin and not curve.closed else 0 for length in reach])
    u = DrawElements(axes, solution, scale)
    magnified = "displacement x 1" if scale == 1 else f"displacement and gap x {scale:g}"
    axes.set_title(f"{disc.method.name}, order {disc.order}, {disc.mesh.ne} elements\n{magnified}, "
                   f"max |u| = {np.linalg.norm(u, axis=1).max():.3g}{Unconverged(solution)}", fontsize=10)
    return Frame(axes, *Labels(disc))


def DrawElements(axes: Any, solution: ContactSolution, scale: float) -> Array:
    """The elements, each moved by its own u_h times `scale`, outline and joints undeformed; returns u_h (n, 2) around them."""
    points = ElementOutlines(solution.disc)
    u = np.asarray(solution.gfu(points))
    axes.add_collection(PolyCollection(SplitByElement(points, np.asarray(Coordinates(2)(points)) + scale * u), gid="elements",
                                       facecolors=(0.85, 0.9, 0.95, 0.6), edgecolors="#222222", linewidths=0.5))
    for region, colour in ((".*", "#555555"), *((joint, RED) for joint in solution.disc.problem.joints)):
        for curve in Curves(solution.disc, region):
            axes.plot(*curve.coordinates.T, "--", color=colour, linewidth=1, gid="joint" if colour == RED else "outline")
    return u
