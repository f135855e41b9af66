"""A field on the elements in colours: of a plane body, on the surface of a solid and on a plane cut through it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from ..contracts import Array
from ..exceptions import ProblemError
from ..solution.fields import Field, FieldOf
from ..solution.pictured import Pictured
from ..solution.solution import ContactSolution
from ..tools.calls import ByKeyword
from ..tools.units import WithUnits
from ..tools.values import Vectors
from .canvas import Frame, LabelAt, LabelBeside, Labels, PlaneAxes, Unconverged
from .curves import Curve, Curves, Literal, OutlinePoints
from .patches import CutPatches, ColourPatches, PlanePatches, SurfacePatches
from .regions import SurfaceFaces
from .solid import TangentFrame, TangentLabel
from .surface import Surface

COLOURS = "viridis"
LINES = 2000        # elements up to which their outlines are drawn
FLAT = 1e-12        # range of values that is round-off, relative to the largest


@ByKeyword
@WithUnits
def FieldFigure(solution: ContactSolution, field: Any = "vonmises", *, cut: Sequence[Any] | None = None,
                limits: Sequence[float] | None = None, view: Sequence[float] | None = None) -> Figure:
    """A field in colours on the undeformed body, each element with its own values: jumps between elements show.

    field : a name (`FieldOf`: vonmises, meanstress, sxx, ..., displacement, ux, ...) or any scalar CoefficientFunction
    cut : (point, normal) of a plane through a solid, whose section is drawn; None: its surface
    limits : (lowest, highest) value of the colours; None: those of the field.  Stresses at corners may be infinite
    view : (elevation, azimuth) in degrees from which a surface is seen; None: from below and, beside, from above and behind

    Fields are drawn to the order of the solution: an element is cut into triangles, whose corners have the field's values.
    The names of boundary regions stand beside them.

    Raises ProblemError for a name that is none, a field on another mesh, and a plane that does not meet the body.

    >>> from ngdgc.cases import example_4_2
    >>> figure = FieldFigure(example_4_2.Main(n=4), "vonmises")
    >>> figure.axes[1].get_ylabel()
    'von Mises stress [stress]'
    """
    solution = Pictured(solution)
    disc, shown = solution.disc, FieldOf(solution, field)
    for name, value in (("cut", cut), ("view", view)):
        if value is not None and disc.mesh.dim == 2:
            raise ProblemError(f"{name} is {value!r}, but the body is plane; leave it out")
    range_ = None if limits is None else _Limits(limits)
    if disc.mesh.dim == 2:
        return _Plane(solution, shown, range_)
    return _Surface(solution, shown, range_, view) if cut is None else _Section(solution, shown, range_, cut)


def _Limits(limits: Any) -> Array:
    words = "give the lowest and the highest value of the colours, such as limits=(0, 100)"
    pair = Vectors(limits, (2,), "limits", words)
    if not pair[0] < pair[1]:
        raise ProblemError(f"limits is {limits!r}; {words}")
    return pair


def _Colours(values: Array, limits: Array | None) -> ScalarMappable:
    low, high = (values.min(), values.max()) if limits is None else limits
    if high - low <= FLAT * max(abs(low), abs(high)):      # all the same
        low, high = low - (abs(low) or 1) / 2, high + (abs(high) or 1) / 2
    return ScalarMappable(Normalize(low, high), COLOURS)


def _Title(solution: ContactSolution, field: Field, values: Array, where: str = "") -> str:
    disc = solution.disc
    return (f"{disc.method.name}, order {disc.order}, {disc.mesh.ne} elements{Unconverged(solution)}\n"
            f"{field.symbol} {values.min():.4g} to {values.max():.4g}{where}")


def _Draw(figure: Figure, axes: Any, at: Array, patches: ColourPatches, values: Array, field: Field, limits: Array | None,
          elements: int) -> None:
    """Triangles over places (n, 2) in the plane, and the outlines of elements if these are not too many."""
    colours = _Colours(values, limits)
    triangles = Triangulation(at[:, 0], at[:, 1], patches.triangles)
    axes.tripcolor(triangles, values, shading="gouraud", cmap=colours.cmap, norm=colours.norm, gid="field")
    if elements <= LINES:
        axes.add_collection(LineCollection([*at[patches.edges]], colors="black", linewidths=0.25, alpha=0.6, gid="outlines"))
    figure.colorbar(colours, ax=axes, label=field.label, shrink=0.8, extend=_Beyond(values, colours.norm))


def _Beyond(values: Array, norm: Any) -> str:
    """Which ends of a colour bar stand for values beyond its limits."""
    slack = FLAT * max(abs(norm.vmin), abs(norm.vmax))
    low, high = values.min() < norm.vmin - slack, values.max() > norm.vmax + slack
    return ("neither", "min", "max", "both")[low + 2 * high]


def _Plane(solution: ContactSolution, field: Field, limits: Array | None) -> Figure:
    disc, patches = solution.disc, PlanePatches(solution.disc)
    values = field.At(patches.points)
    figure, axes = PlaneAxes()
    _Draw(figure, axes, patches.coordinates, patches, values, field, limits, disc.mesh.ne)
    size = np.ptp(OutlinePoints(disc), axis=0).max()
    for name in dict.fromkeys(disc.mesh.GetBoundaries()):
        curves: list[Curve] = Curves(disc, Literal(name))
        for curve in curves:
            axes.plot(*curve.coordinates.T, color="black", linewidth=1)
        if curves:
            LabelAt(axes, max(curves, key=lambda curve: curve.s[-1]), 0.03 * size, name)
    axes.set_title(_Title(solution, field, values), fontsize=10)
    return Frame(axes, *Labels(disc))


def _Surface(solution: ContactSolution, field: Field, limits: Array | None, view: Any) -> Figure:
    patches, _ = SurfacePatches(solution.disc)
    values = field.At(patches.points)
    colours = _Colours(values, limits)
    figure = Surface(patches.coordinates[patches.triangles], colours.to_rgba(values[patches.triangles].mean(axis=1)),
                     _Title(solution, field, values), {}, view=view, regions=SurfaceFaces(solution.disc), outlined=False)
    figure.colorbar(colours, ax=figure.axes, label=field.label, shrink=0.7, extend=_Beyond(values, colours.norm))
    return figure


def _Section(solution: ContactSolution, field: Field, limits: Array | None, cut: Any) -> Figure:
    words = "give (point, normal) of a plane, such as ((0.5, 0, 0), (1, 0, 0))"
    origin, normal = Vectors(cut, (2, 3), "cut", words)
    if not normal.any():
        raise ProblemError(f"cut is {cut!r}, whose normal is 0; {words}")
    normal = normal / np.linalg.norm(normal)
    disc = solution.disc
    patches = CutPatches(disc, origin, normal)
    if not len(patches.triangles):
        corners = disc.mesh.ngmesh.Coordinates()
        raise ProblemError(f"cut is {cut!r}, a plane that does not meet the body, which extends from "
                           f"{tuple(corners.min(axis=0).tolist())} to {tuple(corners.max(axis=0).tolist())}; give another one")
    values, frame = field.At(patches.points), np.array(TangentFrame(normal))
    figure, axes = PlaneAxes()
    _Draw(figure, axes, patches.coordinates @ frame.T, patches, values, field, limits, len(patches.triangles))
    size = np.ptp(patches.coordinates, axis=0).max()
    for name, (pieces, normals) in SurfaceFaces(disc).Rims(origin, normal).items():
        if disc.mesh.GetCurveOrder() == 1:      # straight pieces are no rim of curved elements
            axes.add_collection(LineCollection([*(pieces @ frame.T)], colors="black", linewidths=1.2))
        middles = pieces.mean(axis=1)
        nearest = np.linalg.norm(middles - middles.mean(axis=0), axis=1).argmin()
        LabelBeside(axes, middles[nearest] @ frame.T, normals[nearest] @ frame.T, 0.03 * size, name)
    where = f"\ncut through ({', '.join(f'{c:.4g}' for c in origin)}), normal ({', '.join(f'{c:.3g}' for c in normal)})"
    axes.set_title(_Title(solution, field, values, where), fontsize=10)
    return Frame(axes, TangentLabel(frame[0]), TangentLabel(frame[1]))
