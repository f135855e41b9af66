"""The setting of a problem: body, supports, loads and foundations before anything moves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from ngsolve import VOL

from ..contracts import Array
from ..data.coefficients import EntriesAt, ValuesAt, VectorsAt
from ..discrete.problem import DiscreteProblem
from ..exceptions import ProblemError
from ..mesh.facets import Coordinates, VolumePoints
from ..problem.frames import AXIS
from ..tools.calls import ByKeyword
from ..tools.units import WithUnits
from .canvas import BLUE, GREEN, PURPLE, RED, VERMILION, DrawBlock, Frame, LabelAt, Labels, PlaneAxes, Thickness
from .curves import Curve, Curves, ElementOutlines, FoundationCurves, Left, Literal, OutlinePoints, SplitByElement
from .settingsolid import SettingSurface
from .words import Prescribed, Span

ARROW = 0.12        # length of the longest arrow, relative to the body


@ByKeyword
@WithUnits
def SettingFigure(disc: DiscreteProblem, *, view: Sequence[float] | None = None) -> Figure:
    """The undeformed body, its supports and loads, and the foundations at their gap, as in figures 1 and 3 of the paper.

    Clamped boundaries are hatched, rollers stand on circles, springs are zigzags, foundations are red blocks, joints red double
    lines; tractions, and forces over their areas, are arrows of a length proportional to |f_2| that end or begin at the
    boundary.  In 3D the surface of the body, coloured by what acts on it, with the values, and arrows of tractions and
    prescribed displacements.

    view : (elevation, azimuth) in degrees from which a solid is seen; None: from below and, beside, from above and behind

    >>> from ngdgc.cases import example_4_2
    >>> figure = SettingFigure(example_4_2.Main(n=4).disc)
    """
    if not isinstance(disc, DiscreteProblem):
        raise ProblemError(f"disc is {disc!r}; give a Discretization, that of a solution is solution.disc")
    problem, mesh = disc.problem, disc.mesh
    if mesh.dim == 3:
        return SettingSurface(disc, view)
    _, axes = PlaneAxes()
    DrawMaterials(axes, disc)
    for foundation in problem.foundation:
        for curve in () if foundation.kind == "joint" else FoundationCurves(disc, foundation):
            DrawBlock(axes, curve, ValuesAt(foundation.gap, curve.points, "gap", curve.region), Thickness(disc, curve))
    roles = {name: (kind, region) for kind, region in problem.Regions()
             for name, found in zip(mesh.GetBoundaries(), mesh.Boundaries(region).Mask()) if found}
    symbols = _Symbols(axes, disc)
    draw: dict[str | None, Callable[..., tuple[str, float]]] = {
        "dirichlet": symbols.Clamped, "roller": symbols.Roller, "traction": partial(symbols.Traction, "traction"),
        "force": partial(symbols.Traction, "force"), "spring": symbols.Spring,
        "foundation": symbols.Contact, "joint": symbols.Joint, None: symbols.Free}
    for name in dict.fromkeys(mesh.GetBoundaries()):
        kind, region = roles.get(name, (None, None))
        curves = Curves(disc, Literal(name))
        if curves:
            words, clear = draw[kind](region, curves)
            LabelAt(axes, max(curves, key=lambda curve: curve.s[-1]), clear + 0.03 * symbols.size, f"{name}\n{words}")
    if problem.bodyforce is not None:
        symbols.BodyForce()
    return Frame(axes, *Labels(disc))


def _Values(at: Callable[..., Array], value: Any, curves: Sequence[Curve], name: str) -> Array:
    return np.concatenate([at(value, curve.points, name, curve.region) for curve in curves])


def DrawMaterials(axes: Any, disc: DiscreteProblem) -> None:
    """The body, one shade of grey a material."""
    names = disc.mesh.GetMaterials()
    points = ElementOutlines(disc)
    polygons = SplitByElement(points, np.asarray(Coordinates(2)(points)))
    number = np.array([element.index for element in disc.mesh.Elements(VOL)])
    shades = np.linspace(0.92, 0.75, len(names))
    colours = [str(shades[index]) for index in number]
    axes.add_collection(PolyCollection(polygons, facecolors=colours, edgecolors=colours, linewidths=0.4, gid="elements"))
    centres = np.array([polygon.mean(axis=0) for polygon in polygons])
    for index, name in enumerate(names):
        if len(names) > 1 and np.any(number == index):
            from scipy.spatial import cKDTree   # slow to import

            mine = centres[number == index]
            beyond = cKDTree(np.concatenate([OutlinePoints(disc), centres[number != index]]))
            axes.text(*mine[beyond.query(mine)[0].argmax()], name, ha="center", va="center",
                      fontsize=9, style="italic")


class _Symbols:
    """Draws what is prescribed on boundary curves; a method returns words and the distance [length] it needs outside."""

    def __init__(self, axes: Any, disc: DiscreteProblem) -> None:
        self.axes, self.disc, self.problem = axes, disc, disc.problem
        self.size = np.ptp(OutlinePoints(disc), axis=0).max()
        largest = max((np.linalg.norm(VectorsAt(value, curve.points, kind, curve.region), axis=1).max()
                       for (kind, region), value in disc.tractions.items() for curve in Curves(disc, region)), default=0)
        self.arrow = ARROW * self.size / (largest or 1)     # length of arrow per traction

    def _Line(self, curves: Sequence[Curve], colour: str, width: float) -> None:
        for curve in curves:
            self.axes.plot(*curve.coordinates.T, color=colour, linewidth=width, solid_capstyle="round")

    def Free(self, region: None, curves: Sequence[Curve]) -> tuple[str, float]:
        if self.problem.axisymmetric and all(np.abs(curve.coordinates[:, 0]).max() < AXIS * self.size for curve in curves):
            for curve in curves:
                self.axes.plot(*curve.coordinates.T, color="#333333", linewidth=1, linestyle="dashdot")
            return "axis of revolution", 0
        self._Line(curves, "#333333", 1)
        return "free", 0

    def Clamped(self, region: str, curves: Sequence[Curve]) -> tuple[str, float]:
        self._Line(curves, "black", 2)
        length = 0.03 * self.size
        for curve in curves:
            x, n = curve.Spaced(length)
            self.axes.add_collection(LineCollection([*np.stack([x, x + length * (n + Left(n))], axis=1)], colors="black",
                                                    linewidths=0.9))
        value = _Values(VectorsAt, self.problem.dirichlet[region], curves, "dirichlet")
        return Prescribed("dirichlet", value), length

    def Roller(self, region: str, curves: Sequence[Curve]) -> tuple[str, float]:
        self._Line(curves, GREEN, 2)
        radius, turn = 0.012 * self.size, np.linspace(0, 2 * np.pi, 25)
        circle = radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        for curve in curves:
            x, n = curve.Spaced(4 * radius)
            self.axes.add_collection(PolyCollection((x + 1.5 * radius * n)[:, None] + circle, facecolors="white",
                                                    edgecolors=GREEN, linewidths=1))
            self.axes.plot(*(curve.coordinates + 2.8 * radius * curve.normals).T, color=GREEN, linewidth=0.9)
        value = _Values(ValuesAt, self.problem.roller[region], curves, "roller")
        return Prescribed("roller", value), 3 * radius

    def Traction(self, kind: str, region: str, curves: Sequence[Curve]) -> tuple[str, float]:
        self._Line(curves, BLUE, 2)
        clear = 0.015 * self.size
        for curve in curves:
            traction = VectorsAt(self.disc.tractions[kind, region], curve.points, kind, curve.region)
            x, n, f = curve.Spaced(ARROW * self.size, self.arrow * traction)
            inward = np.sum(f * n, axis=1) < 0
            self._Arrows(x + 0.015 * self.size * n - np.where(inward[:, None], f, 0), f, BLUE)
            clear = max(clear, np.abs(np.sum(f * n, axis=1)).max() + 0.015 * self.size)
        return Prescribed(kind, _Values(VectorsAt, getattr(self.problem, kind)[region], curves, kind)), clear

    def Spring(self, region: str, curves: Sequence[Curve]) -> tuple[str, float]:
        self._Line(curves, PURPLE, 2)
        length = 0.05 * self.size
        zigzag = np.array([[0, 0], [1, 0], [1.5, 1], [2.5, -1], [3.5, 1], [4.5, -1], [5, 0], [6, 0]]) / 6
        for curve in curves:
            x, n = curve.Spaced(1.2 * length)
            coils = length * (zigzag[:, :1] * n[:, None] + 0.8 * zigzag[:, 1:] * Left(n)[:, None])
            ends = length * (n[:, None] + 0.3 * np.array([[-1], [1]]) * Left(n)[:, None])
            for lines, colour, gid in ((coils, PURPLE, "springs"), (ends, "black", "ground")):
                self.axes.add_collection(LineCollection([*(x[:, None] + lines)], colors=colour, linewidths=1, gid=gid))
        return Prescribed("spring", _Values(EntriesAt, self.problem.spring[region], curves, "spring")), length

    def Joint(self, region: str, curves: Sequence[Curve]) -> tuple[str, float]:
        for curve in curves:
            for colour, width in ((RED, 5), ("white", 2)):
                self.axes.plot(*curve.coordinates.T, color=colour, linewidth=width, solid_capstyle="butt", gid="joint")
        joint = next(joint for joint in self.problem.foundation if joint.boundary == region)
        return Prescribed("joint", _Values(ValuesAt, joint.gap, curves, "gap")), 0

    def Contact(self, region: str, curves: Sequence[Curve]) -> tuple[str, float]:
        self._Line(curves, "black", 3)
        foundation = next(foundation for foundation in self.problem.foundation if foundation.boundary == region)
        curve = max(FoundationCurves(self.disc, foundation), key=lambda curve: curve.s[-1])
        x, n, g = curve.Spaced(curve.s[-1] / 7, ValuesAt(foundation.gap, curve.points, "gap", curve.region)[:, None])
        if g[1, 0] > 0.035 * self.size:
            middle = x[1] + g[1, 0] / 2 * n[1]
            self.axes.annotate("", x[1], x[1] + g[1, 0] * n[1], arrowprops={
                "arrowstyle": "<->", "shrinkA": 0, "shrinkB": 0, "mutation_scale": 7, "linewidth": 0.9})
            self.axes.text(*(middle + 0.04 * self.size * Left(n[1])), "g", ha="center", va="center", fontsize=9)
        gap = _Values(ValuesAt, foundation.gap, curves, "gap")
        return Prescribed("foundation", gap), g.max() + Thickness(self.disc, curve)

    def BodyForce(self) -> None:
        values = VectorsAt(self.problem.bodyforce, VolumePoints(self.disc.mesh, self.disc.order), "bodyforce")
        mean, largest = values.mean(axis=0), np.linalg.norm(values, axis=1).max()
        corner = self.axes.dataLim.max + [0.08 * self.size, 0]
        force = ARROW * self.size * mean / (largest or 1)
        self._Arrows((corner - force / 2)[None], force[None], VERMILION)
        self.axes.text(*(corner + [0, 0.6 * ARROW * self.size]), f"body force\n{Span('$f_1$', values)}", color=VERMILION,
                       fontsize=9, ha="center", va="bottom")

    def _Arrows(self, tails: Array, vectors: Array, colour: str) -> None:
        self.axes.quiver(*tails.T, *vectors.T, color=colour, angles="xy", scale_units="xy", scale=1, units="inches",
                         width=0.022, headwidth=4.5, headlength=5, headaxislength=4.5, minlength=0.1, zorder=3)
        self.axes.update_datalim(np.concatenate([tails, tails + vectors]))
