"""Elements, their sides and plane cuts through them as small triangles, each with points of its own element."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from ngsolve import ET, HEX, PRISM, QUAD, TRIG, VOL, IntegrationRule

from ..contracts import Array
from ..discrete.problem import DiscreteProblem
from ..mesh.facets import REFERENCE_VERTICES, SIDEVERTICES, VOLUME_TYPES, ByType, Coordinates
from ..solution.vtkfiles import TETRA, Pattern

MOST = {2: 200_000, 3: 16_000}      # triangles of a picture; those in space are sorted and painted one by one
SPLITS = {HEX: ((0, 1, 2, 6), (0, 1, 5, 6), (0, 3, 2, 6), (0, 3, 7, 6), (0, 4, 5, 6), (0, 4, 7, 6)),
          PRISM: ((0, 1, 2, 5), (0, 1, 4, 5), (0, 3, 4, 5))}
# Of a tetrahedron with corners in the order of their heights, by how many are below: its edges that a plane cuts, in order.
CUTS = {1: ((0, 1), (0, 2), (0, 3)), 2: ((0, 2), (0, 3), (1, 3), (1, 2)), 3: ((3, 0), (3, 1), (3, 2))}
ON = 1e-9           # distance of points that count as above a plane on which they lie, relative to the body


class ColourPatches:
    """Triangles over points in elements.

    points : NGSolve's mesh points (n,);  coordinates : (n, d);  triangles : numbers of points (m, 3)
    edges : numbers of points (e, 2), the pieces of the outlines of elements
    """

    def __init__(self, mesh: Any, points: Any, triangles: Any, edges: Any) -> None:
        self.points, self.triangles, self.edges = points, triangles, edges
        self.coordinates = np.asarray(Coordinates(mesh.dim)(points)).reshape(len(points), mesh.dim)


def Divisions(disc: DiscreteProblem, number: int, dim: int) -> int:
    """Parts of an edge that show polynomials of the order of a solution, fewer where `number` faces would be too many."""
    wanted = 2 * max(disc.order, disc.mesh.GetCurveOrder())
    return int(np.clip(np.sqrt(MOST[dim] / max(number, 1)), 1, max(wanted, 2 if dim == 2 else 4)))


def PlanePatches(disc: DiscreteProblem) -> ColourPatches:
    """All elements of a plane mesh."""
    n = Divisions(disc, disc.mesh.ne, 2)
    return _Joined(disc, [_Spread(elements, Corner(et), et, n) for et, elements in ByType(disc.facets.vertices, 2)])


def SurfacePatches(disc: DiscreteProblem) -> tuple[ColourPatches, Any]:
    """The sides of elements on the boundary of a solid, and the number of the facet of every triangle, (m,)."""
    facets = disc.facets
    outer = facets.neighbours[facets.ofelements] == 1
    n, pieces, numbers = Divisions(disc, int(outer.sum()), 3), [], []
    for et, elements in ByType(facets.vertices, 3):
        for side, corners in enumerate(SIDEVERTICES[et]):
            at = facets.starts[elements] + side
            mine = outer[at]
            face = QUAD if len(corners) == 4 else TRIG
            pieces.append(_Spread(elements[mine], Corner(et)[list(corners)], face, n))
            numbers.append(np.repeat(facets.ofelements[at[mine]], len(pieces[-1][2]) // max(int(mine.sum()), 1)))
    return _Joined(disc, pieces), np.concatenate(numbers)


def CutPatches(disc: DiscreteProblem, origin: Array, normal: Array) -> ColourPatches:
    """Where a plane cuts the elements of a solid; no triangle where it does not meet the body.

    What lies in the plane counts to its positive side: of two elements that meet in it the one behind the plane is drawn.
    """
    corners = disc.mesh.ngmesh.Coordinates()
    height = (corners - origin) @ normal
    size = np.ptp(corners, axis=0).max()
    pieces = []
    for et, elements in ByType(disc.facets.vertices, 3):
        at = height[disc.facets.vertices[elements][:, :len(REFERENCE_VERTICES[et])]]
        # Curved elements reach a bit beyond their corners.
        margin = (0.3 * np.ptp(at, axis=1) if disc.mesh.GetCurveOrder() > 1 else 0) + ON * size
        elements = elements[(at.min(axis=1) <= margin) & (at.max(axis=1) >= -margin)]
        if len(elements):
            pieces.append(_Cut(disc, et, elements, origin, normal, ON * size))
    return _Joined(disc, pieces)


def PointsIn(mesh: Any, elements: Any, local: Array) -> Any:
    """NGSolve's mesh points at reference coordinates (n, 3) of elements (n,)."""
    middle = {et: IntegrationRule([tuple(Corner(et).mean(axis=0))], [1.0]) for et in VOLUME_TYPES[mesh.dim]}
    points = mesh.MapToAllElements(middle, VOL)[elements]
    for axis, values in zip("xyz", local.T):
        points[axis] = values
    return points


def Corner(et: ET) -> Array:
    """The vertices of the reference element, (m, 3)."""
    return np.array(REFERENCE_VERTICES[et], dtype=float)


def _Spread(elements: Any, corners: Array, face: ET, n: int) -> tuple[Any, Array, Any, Any]:
    """(elements of the points, their reference coordinates, triangles, edges) of faces with these corners, n parts an edge."""
    points, cells, _ = Pattern(face, n)
    a, b = points.T[:2, :, None]
    shapes = [a, b, 1 - a - b] if face == TRIG else [(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b]
    local = sum(shape * corner for shape, corner in zip(shapes, corners))
    triangles = cells if face == TRIG else np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    start = len(points) * np.arange(len(elements))[:, None, None]
    edges = _Once(np.sort(np.concatenate([triangles[:, pair] for pair in ([0, 1], [1, 2], [0, 2])]), axis=1))
    return (np.repeat(elements, len(points)), np.tile(local, (len(elements), 1)), (start + triangles).reshape(-1, 3),
            (start + edges).reshape(-1, 2))


def _Once(edges: Any) -> Any:
    """The rows of (n, 2) that are there once: edges between two triangles are there twice."""
    found, count = np.unique(edges, axis=0, return_counts=True)
    return found[count == 1]


def _Tetrahedra(et: ET, n: int) -> tuple[Array, Any]:
    """Points (m, 3) in a reference element and tetrahedra (t, 4) over them; those of one element meet in whole faces."""
    points, cells, kind = Pattern(et, n)
    if kind == TETRA:
        return points, cells
    if et == PRISM:     # diagonals from the lower to the higher number of a base
        order = np.argsort(cells[:, :3], axis=1)
        cells = np.take_along_axis(cells, np.concatenate([order, order + 3], axis=1), axis=1)
    return points, cells[:, np.array(SPLITS[et])].reshape(-1, 4)


def _Cut(disc: DiscreteProblem, et: ET, elements: Any, origin: Array, normal: Array, on: float) -> tuple[Any, Array, Any, Any]:
    """As `_Spread`, of the cuts through elements of one type."""
    grid, tetrahedra = _Tetrahedra(et, Divisions(disc, 2 * len(elements), 2))
    local = np.tile(grid, (len(elements), 1))
    owner = np.repeat(elements, len(grid))
    coordinates = np.asarray(Coordinates(3)(PointsIn(disc.mesh, owner, local))).reshape(-1, 3)
    height = (coordinates - origin) @ normal
    height[np.abs(height) < on] = on
    nodes = (len(grid) * np.arange(len(elements))[:, None, None] + tetrahedra).reshape(-1, 4)
    nodes = np.take_along_axis(nodes, np.argsort(height[nodes], axis=1), axis=1)
    below = (height[nodes] < 0).sum(axis=1)
    # A cut point is known by the edge of the grid that it lies on.
    pairs = np.concatenate(list(_Sections(nodes, below))).reshape(-1, 2)
    cuts, number = np.unique(np.sort(pairs, axis=1), axis=0, return_inverse=True)
    number = number.reshape(-1, 3)
    sides = np.concatenate([number[:, pair] for pair in ([0, 1], [1, 2], [0, 2])])
    first, second = cuts.T
    share = (height[first] / (height[first] - height[second]))[:, None]
    return owner[first], local[first] + share * (local[second] - local[first]), number, _Once(np.sort(sides, axis=1))


def _Sections(nodes: Any, below: Any) -> Iterator[Any]:
    """Triangles (t, 3, 2) of edges of the grid, of tetrahedra in the order of heights with so many corners below the plane."""
    for count, edges in CUTS.items():
        corners = nodes[below == count][:, np.array(edges)]
        for last in range(2, len(edges)):
            yield corners[:, [0, last - 1, last]]


def _Joined(disc: DiscreteProblem, pieces: list[tuple[Any, Array, Any, Any]]) -> ColourPatches:
    """Pieces one after the other."""
    starts = np.cumsum([0, *(len(elements) for elements, *_ in pieces)])
    empty = np.zeros((0, 3))
    elements, local = (np.concatenate([piece[part] for piece in pieces] or [default])
                       for part, default in ((0, np.zeros(0, int)), (1, empty)))
    triangles, edges = (np.concatenate([piece[part] + start for piece, start in zip(pieces, starts)] or [default]).astype(int)
                        for part, default in ((2, empty), (3, empty[:, :2])))
    return ColourPatches(disc.mesh, PointsIn(disc.mesh, elements, local), triangles, edges)
