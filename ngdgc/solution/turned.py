"""A body of revolution in space, three quarters of it, for pictures: a surface with the values of its section."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from netgen.meshing import FaceDescriptor
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import BND, ET, H1, VOL, CoefficientFunction, GridFunction, IntegrationRule, Mesh

from ..contracts import Array
from ..exceptions import ProblemError
from ..mesh.facets import ByType, Coordinates
from .fields import Field
from .vtkfiles import Pattern

ANGLE, STEPS = 1.5 * np.pi, 36      # of the part that is shown, and facets along it
SAME = 1e-9         # distance of two points that are one, relative to the body
LIGHT = {"ambient": 1.2, "diffuse": 0.8, "specularity": 0}  # of surfaces the viewer takes half: so colours are those of the bar
PEAK, SHARE = 2, 0.99       # a range of values so many times that of this share of the surface would take all colours


@dataclass(frozen=True)
class _Section:
    """Triangles over points in the elements: points (n,) of NGSolve, coordinates (n, 2), triangles (m, 3), sides (e, 2).

    sides : pairs of points on the surface of the body, without those on its axis
    """

    points: Any
    coordinates: Array
    triangles: Any
    sides: Any

    @classmethod
    def Of(cls, disc: Any) -> _Section:
        points, triangles, start = [], [], 0
        parts = max(disc.order, disc.mesh.GetCurveOrder())
        for et, elements in ByType(disc.facets.vertices, 2):
            lattice, cells, _ = Pattern(et, parts)
            if et == ET.QUAD:
                cells = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
            rule = IntegrationRule([tuple(point) for point in np.asarray(lattice)[:, :2].tolist()], [0.0] * len(lattice))
            rules = {ET.TRIG: rule, ET.QUAD: rule}
            mapped = disc.mesh.MapToAllElements(rules, VOL).reshape(-1, len(lattice))[elements]
            points.append(mapped.ravel())
            triangles.append((start + len(lattice) * np.arange(len(elements))[:, None, None] + cells).reshape(-1, 3))
            start += mapped.size
        together, over = np.concatenate(points), np.concatenate(triangles).astype(int)
        coordinates = np.asarray(Coordinates(2)(together)).reshape(-1, 2)
        return cls(together, coordinates, over, _Surface(coordinates, over))


def _Surface(coordinates: Array, triangles: Any) -> Any:
    """The sides of triangles that no other one has, off the axis, as pairs of points (e, 2)."""
    pairs = np.concatenate([triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
    size = np.ptp(coordinates, axis=0).max()
    middle = np.rint(coordinates[pairs].mean(axis=1) / (SAME * size)).astype(np.int64) // 10
    _, number, count = np.unique(middle, axis=0, return_inverse=True, return_counts=True)
    alone = count[number.ravel()] == 1
    return pairs[alone & (coordinates[pairs, 0].max(axis=1) > SAME * size)]


def CheckTurned(solution: Any, turned: Any) -> bool:
    """Raise ProblemError unless it is False, or True for a body of revolution."""
    if not isinstance(turned, bool) or turned and not solution.disc.problem.axisymmetric:
        raise ProblemError(f"turned is {turned!r}; give True for a body of revolution, whose problem has axisymmetric=True, "
                           "else False")
    return turned


def DrawTurned(solution: Any, field: Field, scale: float, *, colors: Any) -> Any:
    """What NGSolve's viewer draws of it, with a camera that sees the cuts."""
    from ngsolve.webgui import Draw     # slow to import

    mesh, function, displacement = Turned(solution, field.function)
    points = np.asarray(mesh.ngmesh.Coordinates())
    camera = {"center": points.mean(axis=0).tolist(), "radius": 0.6 * float(np.linalg.norm(np.ptp(points, axis=0)))}
    state = Draw(function, mesh, field.plain, deformation=scale * displacement, show=False, order=1, colors=colors,
                 settings={"Objects": {"Edges": False, "Wireframe": False}, "Light": LIGHT}, draw_vol=False,
                 euler_angles=[-60, 0, 30], **camera).GetData()
    return state | ColourLimits(*Shown(mesh, function))


def Turned(solution: Any, function: CoefficientFunction) -> tuple[Mesh, GridFunction, GridFunction]:
    """(surface mesh, values of a scalar function, displacement) of three quarters of the body, both linear on triangles."""
    section = _Section.Of(solution.disc)
    n, angles = len(section.points), np.linspace(0, ANGLE, STEPS + 1)
    ends, place = np.unique(section.sides, return_inverse=True)
    a, b = place.reshape(-1, 2).T
    # Points of both cuts, then those of the surface at all angles, which are its own: it may have other values.
    owner = np.concatenate([np.arange(n), np.arange(n), np.tile(ends, STEPS + 1)])
    angle = np.concatenate([np.zeros(n), np.full(n, ANGLE), np.repeat(angles, len(ends))])
    ring = 2 * n + len(ends) * np.arange(STEPS)[:, None]
    after = ring + len(ends)
    quads = [np.stack(corners, axis=-1).reshape(-1, 3) for corners in ((ring + a, ring + b, after + b),
                                                                        (ring + a, after + b, after + a))]
    triangles = np.concatenate([section.triangles[:, ::-1], section.triangles + n, *quads])
    mesh = _Mesh(_Round(section.coordinates[owner], angle), triangles)
    values = np.asarray(function(section.points)).ravel()
    displacement = _Round(np.asarray(solution.gfu(section.points)).reshape(-1, 2)[owner], angle)
    return mesh, _Linear(mesh, values[owner][:, None]), _Linear(mesh, displacement)


def Shown(mesh: Mesh, function: GridFunction) -> tuple[Array, Array]:
    """(values (m,), areas (m,)) of the triangles of a surface."""
    corners = np.array([[vertex.nr for vertex in element.vertices] for element in mesh.Elements(BND)])
    points = np.asarray(mesh.ngmesh.Coordinates())[corners]
    areas = np.linalg.norm(np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]), axis=1) / 2
    return function.vec.FV().NumPy()[corners].mean(axis=1), areas


def ColourLimits(values: Array, areas: Array) -> dict[str, Any]:
    """Limits of the colours, and words for the bar, if few of the values (m,), by their areas, would take most colours."""
    order = np.argsort(values)
    share = np.cumsum(areas[order]) / areas.sum()
    low, high = (float(values[order][np.searchsorted(share, part)]) for part in (1 - SHARE, SHARE))
    if np.ptp(values) <= PEAK * (high - low):
        return {}
    words = f", colours for {100 * (2 * SHARE - 1):.0f} % of the surface, {values.min():.3g} to {values.max():.3g} in all"
    return {"funcmin": low, "funcmax": high, "cut": words}


def _Round(vectors: Array, angle: Array) -> Array:
    """(r, z) at angles about the axis, as (x, y, z)."""
    return np.stack([vectors[:, 0] * np.cos(angle), vectors[:, 0] * np.sin(angle), vectors[:, 1]], axis=1)


def _Mesh(points: Array, triangles: Any) -> Mesh:
    mesh = NetgenMesh()
    mesh.dim = 3
    mesh.AddPoints(points)
    mesh.Add(FaceDescriptor(surfnr=1, domin=1, bc=1))
    mesh.AddElements(dim=2, index=1, data=triangles.astype(np.int32), base=0)
    return Mesh(mesh)


def _Linear(mesh: Mesh, values: Array) -> GridFunction:
    """The continuous function of order 1 with these values (n, components) at the vertices."""
    space = H1(mesh, order=1)
    function = GridFunction(space if values.shape[1] == 1 else space ** values.shape[1])
    function.vec.FV().NumPy()[:] = values.T.ravel()
    return function
