"""Files for VTK and ParaView (.vtu): elements cut into linear cells with points of their own, or single points.

NGSolve's VTKOutput writes tetrahedra and hexahedra with corners in another order than VTK's, so that their volumes are wrong.
"""

from __future__ import annotations

from itertools import permutations, product
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from ngsolve import HEX, PYRAMID, TET, TRIG, VOL, IntegrationRule, specialcf
from ngsolve import QUAD as SQUARE

from ..contracts import Array
from ..mesh.facets import TYPES, VOLUME_TYPES, Coordinates, Facets

# VTK's numbers of cells; and for the corners of a mirrored cell the order in which it is right.
LINE, TRIANGLE, POLYGON, QUAD, TETRA, HEXAHEDRON, WEDGE = 3, 5, 7, 9, 10, 12, 13
MIRRORED = {TRIANGLE: [0, 2, 1], QUAD: [0, 3, 2, 1], TETRA: [0, 1, 3, 2], HEXAHEDRON: [0, 3, 2, 1, 4, 7, 6, 5],
            WEDGE: [0, 2, 1, 3, 5, 4]}
CORNERS = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])     # of a square, in VTK's order
# Simplices into which VTK cuts a cell to integrate over it; sides need not be flat.
SIMPLICES: dict[int, Any] = {TRIANGLE: [(0, 1, 2)], QUAD: [(0, 1, 2), (0, 2, 3)], TETRA: [(0, 1, 2, 3)],
                             HEXAHEDRON: [(0, 1, 3, 4), (1, 2, 3, 6), (1, 4, 5, 6), (3, 4, 6, 7), (1, 3, 4, 6)],
                             WEDGE: [(0, 2, 1, 3), (1, 3, 5, 4), (1, 2, 5, 3)]}
DTYPES = {"Float64": "<f8", "Int64": "<i8", "UInt8": "<u1", "UInt32": "<u4", "UInt64": "<u8"}


def _Kuhn(n: int, dim: int) -> Any:
    """Corners (cells, dim + 1, dim) of the n^dim simplices that fill n >= a >= b >= ... >= 0, by Kuhn's cut of cubes."""
    steps = np.array([np.cumsum(np.vstack([np.zeros(dim, int), np.eye(dim, dtype=int)[list(order)]]), axis=0)
                      for order in permutations(range(dim))])
    cells = (np.array(list(product(range(n), repeat=dim)))[:, None, None] + steps).reshape(-1, dim + 1, dim)
    return cells[np.all(np.diff(cells, axis=2) <= 0, axis=(1, 2))]


def _Corners(et: Any, n: int) -> tuple[int, Any]:
    """(VTK's number, corners (cells, corners, d) in units of 1/n) of the cells of NGSolve's reference element."""
    if et in (TRIG, TET):
        # Of a >= b >= ... the differences are coordinates in the element.
        return ((TRIANGLE, 2), (TETRA, 3))[et == TET][0], np.diff(_Kuhn(n, 2 + (et == TET))[..., ::-1], axis=2, prepend=0)
    if et == PYRAMID:
        a, b, c = np.moveaxis(_Kuhn(n, 3), 2, 0)
        return TETRA, np.concatenate([np.stack(half, axis=2) for half in ((b, c, a - b), (c, b, a - b))])
    if et == SQUARE:
        return QUAD, np.array(list(product(range(n), repeat=2)))[:, None] + CORNERS
    kind, plane = (HEXAHEDRON, _Corners(SQUARE, n)[1]) if et == HEX else (WEDGE, _Upright(*_Corners(TRIG, n)))
    layers = [np.concatenate([np.insert(plane, 2, height, axis=2) for height in (k, k + 1)], axis=1) for k in range(n)]
    return kind, np.concatenate(layers)


def _Upright(kind: int, cells: Any) -> Any:
    """Simplices (cells, dim + 1, dim) with the mirrored ones in their right order."""
    mirrored = np.linalg.det(np.diff(cells, axis=1).astype(float)) < 0
    return np.where(mirrored[:, None, None], cells[:, MIRRORED[kind]], cells)


def Pattern(et: Any, n: int) -> tuple[Array, Any, int]:
    """How n cells along every edge cut NGSolve's reference element: points (m, 3) in it, cells (c, corners), VTK's number."""
    kind, corners = _Corners(et, n)
    if kind in (TRIANGLE, TETRA):
        corners = _Upright(kind, corners)
    dim = corners.shape[2]
    points, cells = np.unique(corners.reshape(-1, dim), axis=0, return_inverse=True)
    return np.pad(points / n, ((0, 0), (0, 3 - dim))), cells.reshape(corners.shape[:2]), kind


class ElementGrid:
    """All elements of a mesh cut into linear cells; every element has its own points.

    points : NGSolve's mesh points;  coordinates (m, 3);  cells : list of (VTK's number, corners (c, corners))
    elements : of the cells, one after the other, their numbers (cells,)
    """

    def __init__(self, facets: Facets, n: int) -> None:
        mesh, dim, self._frame = facets.mesh, facets.mesh.dim, facets.frame
        patterns = {et: Pattern(et, n) for et in VOLUME_TYPES[dim]}
        rules = {et: IntegrationRule([tuple(point) for point in points], [1.0] * len(points))
                 for et, (points, _, _) in patterns.items()}
        self.points = mesh.MapToAllElements(rules, VOL)
        self.coordinates = np.zeros((len(self.points), 3))
        self.coordinates[:, :dim] = np.asarray(Coordinates(dim)(self.points))
        counts = (facets.vertices >= 0).sum(axis=1)
        sizes = np.zeros(counts.max() + 1, dtype=int)
        for count in np.unique(counts):
            sizes[count] = len(patterns[TYPES[dim][count]][0])
        starts = np.cumsum(sizes[counts]) - sizes[counts]
        # The Jacobian of a pyramid has no limit at the apex.
        jacobian = np.asarray(specialcf.JacobianMatrix(dim, dim)(self.points)).reshape(-1, dim, dim)
        mirrored = np.add.reduceat(np.nan_to_num(np.linalg.det(jacobian)), starts) < 0
        self.cells, elements = [], []
        for count in np.unique(counts):
            _, cells, kind = patterns[TYPES[dim][count]]
            own = counts == count
            for turned, order in ((False, slice(None)), (True, MIRRORED[kind])):
                chosen = starts[own & (mirrored == turned)]
                if len(chosen):
                    self.cells.append((kind, (chosen[:, None, None] + cells[:, order]).reshape(-1, cells.shape[1])))
                    elements.append(np.repeat(np.flatnonzero(own & (mirrored == turned)), len(cells)))
        self.elements = np.concatenate(elements)

    def Sizes(self) -> Array:
        """Areas or volumes of the cells, (cells,), of a body of revolution the volumes around."""
        found = []
        for kind, corners in self.cells:
            simplices = self.coordinates[corners[:, np.array(SIMPLICES[kind])]]     # cells, simplices, corners, 3
            sizes, middles = _Sizes(simplices), simplices.mean(axis=2).reshape(-1, 3)
            found.append(self._frame.Weights(sizes.ravel(), middles).reshape(sizes.shape).sum(axis=1))
        return np.concatenate(found)

    def Of(self, elements: np.ndarray) -> tuple[np.ndarray, list[tuple[int, Any]], np.ndarray]:
        """(points used, cells with their numbers among these, cells kept) of some elements, True in (elements,)."""
        kept = elements[self.elements]
        parts = np.split(kept, np.cumsum([len(corners) for _, corners in self.cells])[:-1])
        cells = [(kind, corners[here]) for (kind, corners), here in zip(self.cells, parts) if here.any()]
        used = np.unique(np.concatenate([corners.ravel() for _, corners in cells]))
        return used, [(kind, np.searchsorted(used, corners)) for kind, corners in cells], kept

    def Means(self, values: Array, integrals: Array) -> Array:
        """Values of the cells (cells, c) that times the sizes are the integrals over the elements (elements, c).

        The means of values at the corners, from those at the points (m, c), with one correction for all cells of an element.
        """
        means = np.concatenate([values[corners].mean(axis=1) for _, corners in self.cells])
        sizes = self.Sizes()
        found = np.column_stack([np.bincount(self.elements, sizes * column, len(integrals)) for column in means.T])
        whole = np.bincount(self.elements, sizes, len(integrals))
        return means + ((integrals - found) / whole[:, None])[self.elements]


def _Sizes(simplices: Array) -> Array:
    """Areas or volumes (cells, simplices) of the simplices of cells (cells, simplices, corners, 3)."""
    edges = simplices[:, :, 1:] - simplices[:, :, :1]
    if edges.shape[2] == 2:
        return np.linalg.norm(np.cross(edges[:, :, 0], edges[:, :, 1]), axis=2) / 2
    return np.abs(np.linalg.det(edges)) / 6


def WriteUnstructured(path: str | PathLike[str], coordinates: Array, cells: list[tuple[int, Any]],
                      fields: dict[str, Array], cellfields: dict[str, Array]) -> Path:
    """Write points (m, 3), cells as `ElementGrid` has them, and {name: values at the points, (m,) or (m, components)}.

    cellfields : the same of the cells, in their order

    path : with or without its suffix .vtu; returns the Path of the file
    """
    path = Path(path)
    if path.suffix != ".vtu":
        path = path.with_name(path.name + ".vtu")
    sizes = np.concatenate([np.full(len(corners), corners.shape[1]) for _, corners in cells])
    kinds = np.concatenate([np.full(len(corners), kind, dtype=np.uint8) for kind, corners in cells])
    topology = {"connectivity": np.concatenate([corners.ravel() for _, corners in cells]), "offsets": np.cumsum(sizes),
                "types": kinds}
    largest = max(array.nbytes for array in (coordinates, *fields.values(), *cellfields.values()))
    header = "UInt32" if largest < 2 ** 32 else "UInt64"
    lines, blocks = list[str](), list[bytes]()
    for section, arrays in (("Points", {"Points": coordinates}), ("Cells", topology), ("CellData", cellfields),
                            ("PointData", fields)):
        lines.append(f"<{section}>")
        for name, array in arrays.items():
            kind = {"f": "Float64", "u": "UInt8", "i": "Int64"}[array.dtype.kind]
            components = array.shape[1] if array.ndim == 2 else 1
            lines.append(f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="appended" '
                         f'offset="{sum(len(block) for block in blocks)}"/>')
            data = np.ascontiguousarray(array, dtype=DTYPES[kind]).tobytes()
            blocks.append(np.array(len(data), dtype=DTYPES[header]).tobytes() + data)
        lines.append(f"</{section}>")
    with open(path, "wb") as file:
        file.write(f'<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
                   f'header_type="{header}">\n<UnstructuredGrid>\n<Piece NumberOfPoints="{len(coordinates)}" '
                   f'NumberOfCells="{len(sizes)}">\n'.encode())
        file.write("\n".join([*lines, "</Piece>", "</UnstructuredGrid>", '<AppendedData encoding="raw">', "_"]).encode())
        for block in blocks:
            file.write(block)
        file.write(b"\n</AppendedData>\n</VTKFile>\n")
    return path
