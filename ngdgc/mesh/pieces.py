"""Sides of elements that are divided, so that a quadrature can be good where a function is smooth on the parts alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..contracts import Array


@dataclass(frozen=True, eq=False)
class Piece:
    """A part of a reference element, its image under xi -> origin + matrix xi; (d - 1,) and (d - 1, d - 1)."""

    origin: Array
    matrix: Array


Pieces = Mapping[int, Sequence[Piece]]      # of the boundary elements, by their numbers, that are divided


def Interval(start: float, end: float) -> Piece:
    """A part of the reference segment."""
    return Piece(np.array([start]), np.array([[end - start]]))


def Quarters(corners: int, depth: int) -> list[Piece]:
    """4^depth equal parts of a triangle (3 corners) or quadrilateral (4)."""
    half = np.eye(2) / 2
    if corners == 3:
        origins, signs = [(0, 0), (0.5, 0), (0, 0.5), (0.5, 0.5)], [1, 1, 1, -1]
    else:
        origins, signs = [(0, 0), (0.5, 0), (0, 0.5), (0.5, 0.5)], [1, 1, 1, 1]
    pieces = [Piece(np.zeros(2), np.eye(2))]
    for _ in range(depth):
        pieces = [Piece(piece.origin + piece.matrix @ origin, piece.matrix @ (sign * half))
                  for piece in pieces for origin, sign in zip(origins, signs)]
    return pieces


def Triangles(polygons: Sequence[Array]) -> list[Piece]:
    """Convex polygons (m, 2) in the reference triangle as triangles that share their first corner."""
    return [Piece(corners[0], np.column_stack([corners[i] - corners[0], corners[i + 1] - corners[0]]))
            for corners in polygons for i in range(1, len(corners) - 1)]


def Cut(polygon: Array, level: Array) -> list[Array]:
    """The parts of a convex polygon (m, 2) on either side of a line, where a linear function is zero, (m,) at the corners."""
    parts: list[list[Array]] = [[], []]
    for here, there, value, after in zip(polygon, np.roll(polygon, -1, axis=0), level, np.roll(level, -1)):
        for part, sign in zip(parts, (1, -1)):
            if sign * value >= 0:
                part.append(here)
            if value * after < 0:
                part.append(here + value / (value - after) * (there - here))
    return [np.array(part) for part in parts if len(part) > 2]


def Area(polygon: Array) -> float:
    """Of a convex polygon (m, 2)."""
    x, y = polygon.T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2


def Divided(points: Any, weights: Array, pieces: Pieces) -> tuple[Any, Array]:
    """Points and reference weights (n,) of a quadrature with those of every divided boundary element on each of its pieces.

    points : structured array of mesh points on boundary elements, those of an element in a row
    """
    found = []
    ends = np.flatnonzero(np.diff(points["nr"])) + 1
    for run, shares in zip(np.split(points, ends), np.split(weights, ends)):
        for piece in pieces.get(int(run["nr"][0]), [None]):
            found.append((run, shares) if piece is None else _Mapped(run, shares, piece))
    return np.concatenate([run for run, _ in found]), np.concatenate([shares for _, shares in found])


def _Mapped(points: Any, weights: Array, piece: Piece) -> tuple[Any, Array]:
    mapped, axes = points.copy(), "xy"[:len(piece.origin)]
    at = piece.origin + np.column_stack([points[axis] for axis in axes]) @ piece.matrix.T
    for axis, values in zip(axes, at.T):
        mapped[axis] = values
    return mapped, abs(np.linalg.det(piece.matrix)) * weights


def PiecesArray(pieces: Pieces, dim: int) -> Array:
    """Pieces as an array (m, 1 + (d - 1) + (d - 1)^2): number of the boundary element, origin, matrix."""
    rows = [np.concatenate([[number], piece.origin, piece.matrix.ravel()])
            for number, parts in pieces.items() for piece in parts]
    return np.array(rows).reshape(-1, 1 + (dim - 1) * dim)


def PiecesOf(array: Array, dim: int) -> dict[int, list[Piece]]:
    """The pieces of a `PiecesArray`."""
    pieces: dict[int, list[Piece]] = {}
    for number, *rest in array:
        origin, matrix = np.split(np.array(rest), [dim - 1])
        pieces.setdefault(int(number), []).append(Piece(origin, matrix.reshape(dim - 1, dim - 1)))
    return pieces
