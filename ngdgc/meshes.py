"""Structured meshes of a rectangle and a box, with a choice of cells and diagonal."""

from __future__ import annotations

from numbers import Integral

from ngsolve import Mesh
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh

from .exceptions import ProblemError

CELLS = ("triangle", "triangle-flipped", "quad")
BOXCELLS = ("tet", "hex", "prism")


def RectangleMesh(n: int, *, lower: tuple[float, float] = (0, 0), upper: tuple[float, float] = (1, 1),
                  cells: str = "triangle") -> Mesh:
    """Uniform mesh of a rectangle, n x n squares; boundaries "bottom", "right", "top", "left".

    cells : "quad"; "triangle", diagonals from the lower left to the upper right corner of each square; "triangle-flipped", the
        other diagonals

    Raises ProblemError for n < 1 or unknown cells.

    >>> RectangleMesh(2, cells="triangle").ne
    8
    """
    _Check(n, cells, CELLS)
    (x0, y0), (x1, y1) = lower, upper
    return MakeStructured2DMesh(quads=cells == "quad", nx=int(n), ny=int(n), flip_triangles=cells == "triangle-flipped",
                                mapping=lambda s, t: (x0 + s * (x1 - x0), y0 + t * (y1 - y0)))


def BoxMesh(n: int, *, lower: tuple[float, float, float] = (0, 0, 0), upper: tuple[float, float, float] = (1, 1, 1),
            cells: str = "tet") -> Mesh:
    """Uniform mesh of a box, n x n x n blocks; boundaries "back", "front" (smallest, largest x), "left", "right" (y), "bottom",
    "top" (z).

    cells : "tet", six in each block; "hex"; "prism", two in each block with their axis along z

    Raises ProblemError for n < 1 or unknown cells.

    >>> BoxMesh(2, cells="tet").ne
    48
    """
    _Check(n, cells, BOXCELLS)
    return MakeStructured3DMesh(hexes=cells == "hex", prism=cells == "prism", nx=int(n), ny=int(n), nz=int(n),
                                mapping=lambda *point: tuple(a + t * (b - a) for a, b, t in zip(lower, upper, point)))


def UnitMesh(n: int, cells: str) -> Mesh:
    """Uniform mesh of the unit square or cube, by its cells alone: one of CELLS or BOXCELLS.

    >>> UnitMesh(2, "quad").ne, UnitMesh(2, "hex").ne
    (4, 8)
    """
    _Check(n, cells, CELLS + BOXCELLS)
    return RectangleMesh(n, cells=cells) if cells in CELLS else BoxMesh(n, cells=cells)


def _Check(n, cells, known):
    if isinstance(n, bool) or not isinstance(n, Integral) or n < 1:
        raise ProblemError(f"n is {n!r}; the number of cells per side must be a positive integer")
    if cells not in known:
        raise ProblemError(f"cells is {cells!r}; choose one of {', '.join(known)}")
