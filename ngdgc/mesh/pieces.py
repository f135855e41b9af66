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
