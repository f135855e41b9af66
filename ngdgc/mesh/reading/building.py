"""A mesh of what a file holds: oriented cells, regions with the names of the file, nodes of second order in Netgen's places."""

from __future__ import annotations

from typing import Any

import numpy as np
from netgen.meshing import Element3D, MeshPoint, Pnt, PointId
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import Mesh

from ...contracts import Array
from ...exceptions import ProblemError
from ..checks import CheckElements
from .shapes import CORNERS, DIM, SIDES, Cell, Content

REST = "default"        # Netgen's own name for what has none
CLOSE = 1e-8            # of the size of the body: round-off of files with ten digits
# Corners of a mirrored cell in the order in which it is right.
MIRRORED = {"triangle": (0, 2, 1), "quad": (0, 3, 2, 1), "tet": (0, 2, 1, 3), "hex": (0, 3, 2, 1, 4, 7, 6, 5),
            "prism": (0, 2, 1, 3, 5, 4), "pyramid": (0, 3, 2, 1, 4)}
# Three edges that say how a cell is turned: the corner they have in common, and their ends.
TURN = {"triangle": (0, 1, 2), "quad": (0, 1, 3), "tet": (0, 1, 2, 3), "hex": (0, 1, 3, 4), "prism": (0, 1, 2, 3),
        "pyramid": (0, 1, 3, 4)}
# Corners of the edges on which Netgen's elements of second order have their nodes, in its order, by the number of all nodes.
# What is STRAIGHT is not here: in Netgen's hexahedra of second order no point can be searched.
EDGES: dict[int, dict[int, tuple[tuple[int, int], ...]]] = {
    2: {6: ((1, 2), (0, 2), (0, 1)), 8: ((0, 1), (2, 3), (0, 3), (1, 2))},
    3: {10: ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))}}

STRAIGHT = ("hex", "prism", "pyramid")

Names = tuple[str, ...]


def BuildMesh(content: Content, file: str) -> Mesh:
    """The ngsolve.Mesh of what a file holds.

    Raises ProblemError for cells that are none, groups without elements, and elements or sides in two groups.
    """
    dim = max((DIM[cell.shape] for cell, _, _ in content.blocks), default=0)
    if dim < 2 or not np.isfinite(content.points).all():
        raise ProblemError(f"{file} has no elements of a body, or nodes that are no numbers; mesh a surface in the plane or a "
                           "volume, and write its elements")
    size = float(np.ptp(content.points, axis=0).max())
    if dim == 2 and np.ptp(content.points[:, 2]) > CLOSE * size:
        raise ProblemError(f"{file} has a surface in space, no body; mesh the volume, or a plane z = constant")
    volumes = [_Oriented(content.points, *block) for block in content.blocks if DIM[block[0].shape] == dim]
    _CheckOnce(file, [names for _, _, names in volumes], "elements")
    sides = _Sides(content, volumes, dim, file)
    _CheckFull(content, volumes, sides, dim, file)
    used = np.unique(np.concatenate([corners.ravel() for _, corners, _ in volumes]))
    mesh = _Linear(content.points, used, volumes, sides, dim)
    middles = _Middles(content, dim, size, file)
    if middles:
        _Bend(mesh, content.points, used, *middles)
    result = Mesh(mesh)
    CheckElements(result)
    return result


def _Oriented(points: Array, cell: Cell, rows: Array, names: Names) -> tuple[str, Array, Names]:
    """(shape, corners in Netgen's orientation, names) of a block; Netgen's tetrahedra are the mirrored ones of all others."""
    corners = rows[:, :CORNERS[cell.shape]].copy()
    start, *ends = TURN[cell.shape]
    edges = points[corners[:, ends]] - points[corners[:, [start]]]
    turned = np.linalg.det(edges[:, :len(ends), :len(ends)]) < 0
    if cell.shape == "tet":
        turned = ~turned
    corners[turned] = corners[turned][:, MIRRORED[cell.shape]]
    return cell.shape, corners, names


def _CheckOnce(file: str, names: list[Names], what: str) -> None:
    for group in names:
        if len(group) > 1:
            raise ProblemError(f"{file} has {what} that are in {group[0]!r} and in {group[1]!r}; give each one region, another "
                               "name for what they have in common")


def _Sides(content: Content, volumes: list[tuple[str, Array, Names]], dim: int, file: str) -> dict[tuple[int, ...], str]:
    """{corners: region} of all sides that are named or bound the body; in 2D with it on the left, in 3D turning outwards."""
    around: dict[frozenset[int], tuple[int, ...]] = {}
    count: dict[frozenset[int], int] = {}
    for shape, corners, _ in volumes:
        for side in SIDES[shape]:
            # Faces turn inwards by the right hand; tetrahedra are mirrored, and so are their sides.
            for row in corners[:, side if dim == 2 or shape == "tet" else side[::-1]].tolist():
                key = frozenset(row)
                around.setdefault(key, tuple(row))
                count[key] = count.get(key, 0) + 1
    given = [(names, rows[:, :CORNERS[cell.shape]].tolist()) for cell, rows, names in content.blocks
             if DIM[cell.shape] == dim - 1]
    given += [((name,), rows) for name, rows in content.sides.items()]
    found: dict[frozenset[int], Names] = {}
    for names, rows in given:
        for row in rows:
            key = frozenset(row)
            if key not in around:
                raise ProblemError(f"{file} has sides in {names[0] if names else REST!r} that bound no element, with nodes at "
                                   f"{np.round(content.points[list(row)], 6).tolist()}; remove them, or mesh what they bound")
            found[key] = tuple(dict.fromkeys(found.get(key, ()) + names))
    _CheckOnce(file, list(found.values()), "sides")
    return {row: (*found.get(key, ()), REST)[0] for key, row in around.items() if count[key] == 1 or found.get(key)}


def _CheckFull(content: Content, volumes: list[tuple[str, Array, Names]], sides: dict[tuple[int, ...], str], dim: int,
               file: str) -> None:
    full = {dim: {name for _, _, names in volumes for name in names}, dim - 1: set(sides.values())}
    for name, of in content.groups:
        if of in full and name not in full[of]:
            raise ProblemError(f"{file} has a group {name!r} without {'elements' if of == dim else 'sides'}; fill or remove it")


def _Linear(points: Array, used: Array, volumes: list[tuple[str, Array, Names]], sides: dict[tuple[int, ...], str],
            dim: int) -> NetgenMesh:
    """Netgen's mesh of the corners, the points `used`, with regions in the order in which they first occur."""
    mesh = NetgenMesh(dim=dim)
    flat = [1, 1, dim - 2]
    for point in points[used]:
        mesh.Add(MeshPoint(Pnt(*(float(value) for value in point * flat))))
    parts: list[tuple[int, str, Array]] = [(dim, (*names, REST)[0], corners) for _, corners, names in volumes]
    for name in dict.fromkeys(sides.values()):
        for length in (2, 3, 4):
            own = [row for row, region in sides.items() if region == name and len(row) == length]
            if own:
                parts.append((dim - 1, name, np.array(own)))
    numbers: dict[tuple[int, str], int] = {}
    for of, name, rows in parts:
        if (of, name) not in numbers:
            numbers[of, name] = number = mesh.AddRegion(name, dim=of)
            if of == 1:
                # Without a number of its own Netgen takes a side for straight, also where it has a node in the middle.
                mesh.EdgeDescriptor(number).edgenr = number
        index, places = numbers[of, name], np.searchsorted(used, rows)
        if rows.shape[1] in (5, 6):     # Netgen's arrays know no pyramids and prisms
            for row in places.tolist():
                mesh.Add(Element3D(index, [PointId(place + 1) for place in row]))
        else:
            mesh.AddElements(dim=of, index=index, base=0, data=np.ascontiguousarray(places, dtype=np.int32))
    return mesh


def _Middles(content: Content, dim: int, size: float, file: str) -> tuple[Array, Array] | None:
    """(ends (n, 2) of edges, numbers (n,) of the nodes on them), or None of first order, also if all edges are straight."""
    ends, nodes = list[Array](), list[Array]()
    plain = set[str]()
    for cell, rows, _ in content.blocks:
        if DIM[cell.shape] != dim:
            continue
        if not cell.edges or cell.shape in STRAIGHT:
            _CheckStraight(content.points, cell, rows, size, file)
            plain.add(cell.shape)
            continue
        _CheckFaces(content.points, cell, rows, size, file)
        for number, edge in enumerate(cell.edges, CORNERS[cell.shape]):
            ends.append(rows[:, edge])
            nodes.append(rows[:, number])
    if not nodes:
        return None
    pairs, places = np.concatenate(ends), np.concatenate(nodes)
    if not plain:
        return pairs, places
    if np.abs(content.points[pairs].mean(axis=1) - content.points[places]).max() > CLOSE * size:
        raise ProblemError(f"{file} has curved elements of second order, and of first order ({', '.join(sorted(plain))}); mesh "
                           "it with one order")
    return None


def _CheckStraight(points: Array, cell: Cell, rows: Array, size: float, file: str) -> None:
    """Nodes that do not count lie in the middles of edges, faces and cells."""
    for number, corners in enumerate(cell.edges + cell.faces, CORNERS[cell.shape]):
        apart = np.abs(points[rows[:, corners]].mean(axis=1) - points[rows[:, number]]).max()
        if apart > CLOSE * size:
            raise ProblemError(f"{file} has curved {cell.shape} elements, with nodes up to {apart:.3g} off the middles of "
                               "their edges or faces, which are not read; write them with order 1, or mesh with tetrahedra")


def _CheckFaces(points: Array, cell: Cell, rows: Array, size: float, file: str) -> None:
    """Nodes on faces lie where those on their edges have them: Netgen has none."""
    first = CORNERS[cell.shape]
    for number, face in enumerate(cell.faces, first + len(cell.edges)):
        around = [first + next(place for place, edge in enumerate(cell.edges) if set(edge) == set(pair))
                  for pair in zip(face, face[1:] + face[:1])]
        place = points[rows[:, around]].sum(axis=1) / 2 - points[rows[:, list(face)]].sum(axis=1) / 4
        if np.abs(place - points[rows[:, number]]).max() > CLOSE * size:
            raise ProblemError(f"{file} has {cell.shape} elements with nodes off their places on curved faces; write them "
                               "without these nodes: Mesh.SecondOrderIncomplete = 1")


def _Bend(mesh: NetgenMesh, points: Array, used: Array, ends: Array, nodes: Array) -> None:
    """Make the elements those of second order, with the nodes of the file."""
    mesh.SecondOrder()
    places: Any = mesh.Coordinates()
    dim = places.shape[1]
    keys, first = np.unique(_Keys(ends, len(points)), return_index=True)
    table = (mesh.Elements2D() if dim == 2 else mesh.Elements3D()).NumPy()["nodes"].astype(np.int64)
    filled = (table > 0).sum(axis=1)
    for count, edges in EDGES[dim].items():
        rows = table[filled == count] - 1
        if not len(rows):
            continue
        for number, edge in enumerate(edges, count - len(edges)):
            found = np.searchsorted(keys, _Keys(used[rows[:, edge]], len(points)))
            places[rows[:, number]] = points[nodes[first[found]], :dim]


def _Keys(ends: Array, count: int) -> Array:
    """One number for each pair of nodes, whatever their order."""
    return ends.min(axis=1) * count + ends.max(axis=1)
