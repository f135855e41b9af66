"""Structured meshes of a rectangle and a box, with a choice of cells and diagonal; meshes of CAD shapes and of files."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from netgen.occ import OCCGeometry
from ngsolve import Mesh
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh

from .exceptions import ProblemError
from .mesh.checks import CheckElements
from .mesh.facets import SecondOrder
from .mesh.reading.abaqus import ReadAbaqus
from .mesh.reading.building import BuildMesh
from .mesh.reading.gmsh import ReadGmsh
from .tools.calls import ByKeyword
from .tools.memory import CheckCells
from .tools.names import Meant
from .tools.values import HIGHEST, Integer, PositiveNumber, Reals

CELLS = ("triangle", "triangle-flipped", "quad")
BOXCELLS = ("tet", "hex", "prism")
MOST = 10 ** 9      # cells per side; fewer are refused by what memory is free
LEAST = 1e-90       # size of elements: the power of a smaller one is 0
# Elements as large as the radius of what they follow, and neighbours of twice the size: with Netgen's own 2 and 0.3 small holes
# and fillets decide the size of all the mesh, whatever maxh.
GRADING = 0.5
CURVATURE = 1, 1.5, 2, 3        # in turn, until curved elements do not fold


@ByKeyword
def RectangleMesh(n: int, *, lower: tuple[float, float] = (0, 0), upper: tuple[float, float] = (1, 1),
                  cells: str = "triangle") -> Mesh:
    """Uniform mesh of a rectangle, n x n squares; boundaries "bottom", "right", "top", "left".

    cells : "quad"; "triangle", diagonals from the lower left to the upper right corner of each square; "triangle-flipped", the
        other diagonals

    Raises ProblemError for n < 1, unknown cells, or corners that span no rectangle.

    >>> RectangleMesh(2, cells="triangle").ne
    8
    """
    n = _Check(n, cells, CELLS)
    (x0, y0), (x1, y1) = _Corners(lower, upper, 2)
    CheckCells(n * n * (1 if cells == "quad" else 2))
    return MakeStructured2DMesh(quads=cells == "quad", nx=n, ny=n, flip_triangles=cells == "triangle-flipped",
                                mapping=lambda s, t: (x0 + s * (x1 - x0), y0 + t * (y1 - y0)))


@ByKeyword
def BoxMesh(n: int, *, lower: tuple[float, float, float] = (0, 0, 0), upper: tuple[float, float, float] = (1, 1, 1),
            cells: str = "tet") -> Mesh:
    """Uniform mesh of a box, n x n x n blocks; boundaries "back", "front" (smallest, largest x), "left", "right" (y), "bottom",
    "top" (z).

    cells : "tet", six in each block; "hex"; "prism", two in each block with their axis along z

    Raises ProblemError for n < 1, unknown cells, or corners that span no box.

    >>> BoxMesh(2, cells="tet").ne
    48
    """
    n = _Check(n, cells, BOXCELLS)
    low, high = _Corners(lower, upper, 3)
    CheckCells(n ** 3 * {"tet": 6, "prism": 2, "hex": 1}[cells])
    return MakeStructured3DMesh(hexes=cells == "hex", prism=cells == "prism", nx=n, ny=n, nz=n,
                                mapping=lambda *point: tuple(a + t * (b - a) for a, b, t in zip(low, high, point)))


@ByKeyword
def UnitMesh(n: int, cells: str) -> Mesh:
    """Uniform mesh of the unit square or cube, by its cells alone: one of CELLS or BOXCELLS.

    >>> UnitMesh(2, "quad").ne, UnitMesh(2, "hex").ne
    (4, 8)
    """
    _Check(n, cells, CELLS + BOXCELLS)
    return RectangleMesh(n, cells=cells) if cells in CELLS else BoxMesh(n, cells=cells)


@ByKeyword
def ShapeMesh(shape: Any, maxh: float, *, order: int = 1) -> Mesh:
    """Mesh of a face (2D) or a solid (3D) of Netgen's OpenCascade geometry, with polynomial boundaries of the given order.

    maxh : largest size of an element [length]; edges and faces of the shape may ask for less by their own `maxh`
    order : of the approximation of curved boundaries; 1 leaves elements with straight edges

    Boundaries and materials have the names that edges, faces and solids have in the shape.

    Where curved elements would fold all those at curved boundaries are made smaller.

    Raises ProblemError for a shape that is empty or no shape, a maxh that is not positive, an order below 1.

    >>> from netgen.occ import Circle
    >>> ShapeMesh(Circle((0, 0), 1).Face(), 0.5, order=3).GetCurveOrder()
    3
    """
    if not hasattr(shape, "faces") or len(shape.faces) == 0:
        raise ProblemError(f"shape is {shape!r}; give a face or a solid of netgen.occ")
    maxh = PositiveNumber(maxh, "maxh", "give the largest size of an element, a positive number")
    order = Integer(order, "order", f"give the order of the geometry, a positive integer of at most {HIGHEST[2]}",
                    most=HIGHEST[2])
    CheckCells(_Elements(shape, maxh))
    folded = None
    for curvature in CURVATURE:
        try:
            geometry = OCCGeometry(shape, dim=3 if len(shape.solids) else 2)
            mesh = Mesh(geometry.GenerateMesh(maxh=maxh, curvaturesafety=curvature, grading=GRADING))
        except Exception as error:      # NgException is no RuntimeError
            raise ProblemError(f"Netgen finds no mesh of the shape with maxh={maxh:g} ({str(error).strip()}); take a smaller "
                               "one, or mend the shape") from error
        if order == 1:
            return mesh
        try:
            CheckElements(mesh.Curve(order))
            return mesh
        except ProblemError as error:
            folded = error
    raise ProblemError(f"maxh={maxh:g} is too large for the curves of the shape: {folded}")


@ByKeyword
def ReadMesh(file: str | PathLike[str]) -> Mesh:
    """The mesh in a file of Gmsh (.msh, format 2.2 or 4.1 in ASCII), Abaqus or CalculiX (.inp), or Netgen (.vol), 2D or 3D.

    First order, and second order of triangles, quadrilaterals and tetrahedra, whose nodes keep their places, of hexahedra,
    prisms and pyramids only if they are straight, as elements of first order.  Elements are turned to have one orientation.
    Names of regions: physical groups of Gmsh; of an .inp the ELSETs of *SOLID SECTION, else of *ELEMENT, are materials,
    *SURFACE and node sets boundaries.  What has no name is "default".

    Raises ProblemError for a file that is no mesh, elements of other types or both orders, curved hexahedra, a group without
    elements or sides, and elements or sides in two groups.

    >>> from tempfile import mkdtemp
    >>> file = mkdtemp() + "/square.vol"
    >>> RectangleMesh(2).ngmesh.Save(file)
    >>> ReadMesh(file).GetBoundaries()
    ('bottom', 'right', 'top', 'left')
    """
    readers = {".msh": ReadGmsh, ".inp": ReadAbaqus}
    if not isinstance(file, str | PathLike) or Path(file).suffix.lower() not in (*readers, ".vol"):
        raise ProblemError(f"file is {file!r}; give the name of a mesh: .msh of Gmsh, .inp of Abaqus or CalculiX, .vol of "
                           "Netgen; meshio makes .msh of others")
    path = Path(file)
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise ProblemError(f"{path} cannot be read ({error.strerror}); give a file that is there") from error
    if path.suffix.lower() == ".vol":
        return _ReadNetgen(path, text)
    return BuildMesh(readers[path.suffix.lower()](text, str(path)), str(path))


def _ReadNetgen(path: Path, text: str) -> Mesh:
    # Netgen takes any file: without these lines it returns an empty mesh, or does not come back.
    if not (text.startswith(("mesh3d", "# Generated by NETGEN")) and "endmesh" in text):
        raise ProblemError(f"{path} is no mesh of Netgen, or is cut off; write it anew with mesh.ngmesh.Save")
    mesh = Mesh(str(path))
    if mesh.dim < 2 or mesh.ne == 0 or SecondOrder(mesh):
        raise ProblemError(f"{path} has no elements of a body, or elements of second order, whose nodes on the boundary are "
                           "not in files of Netgen; save the mesh before SecondOrder(), and Curve(2) it when it is read")
    CheckElements(mesh)
    return mesh


def _Elements(shape: Any, maxh: float) -> float:
    """About how many elements fill a shape, at least those along its faces and edges, which may ask for smaller ones."""
    # Of equal sides: six tetrahedra in a cube of their size, two triangles in a square.
    return max(count * sum(part.mass / max(min(part.maxh, maxh), LEAST) ** dim for part in parts)
               for count, dim, parts in ((6, 3, shape.solids), (2, 2, shape.faces), (1, 1, shape.edges)))


def _Check(n: Any, cells: Any, known: tuple[str, ...]) -> int:
    if not isinstance(cells, str) or cells not in known:
        raise ProblemError(f"cells is {cells!r}; choose one of {', '.join(known)}{Meant(str(cells), known)}")
    return Integer(n, "n", f"the number of cells per side must be a positive integer of at most {MOST}", most=MOST)


def _Corners(lower: Any, upper: Any, dim: int) -> tuple[list[float], list[float]]:
    low, high = (Reals(corner, (dim,)) for corner in (lower, upper))
    # NGSolve takes any corners; with upper below lower the elements are inside out, and so are the normals.
    if low is None or high is None or np.any(low >= high):
        raise ProblemError(f"lower is {lower!r} and upper is {upper!r}; give two corners of {dim} coordinates each, all of "
                           "them larger in upper")
    return low.tolist(), high.tolist()
