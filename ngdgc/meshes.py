"""Structured meshes of a rectangle, with a choice of cells and diagonal."""

from numbers import Integral

from ngsolve.meshes import MakeStructured2DMesh

from .exceptions import ProblemError

CELLS = ("triangle", "triangle-flipped", "quad")


def RectangleMesh(n, *, lower=(0, 0), upper=(1, 1), cells="triangle"):
    """Uniform mesh of a rectangle, n x n squares; boundaries "bottom", "right", "top", "left".

    cells : "quad"; "triangle", diagonals from the lower left to the upper right corner of each square; "triangle-flipped", the
        other diagonals

    Raises ProblemError for n < 1 or unknown cells.

    >>> RectangleMesh(2, cells="triangle").ne
    8
    """
    if isinstance(n, bool) or not isinstance(n, Integral) or n < 1:
        raise ProblemError(f"n is {n!r}; the number of cells per side must be a positive integer")
    if cells not in CELLS:
        raise ProblemError(f"cells is {cells!r}; choose one of {', '.join(CELLS)}")
    (x0, y0), (x1, y1) = lower, upper
    return MakeStructured2DMesh(quads=cells == "quad", nx=int(n), ny=int(n), flip_triangles=cells == "triangle-flipped",
                                mapping=lambda s, t: (x0 + s * (x1 - x0), y0 + t * (y1 - y0)))
