"""Newton's equation at a point of the graph of the law, without the unknowns that can be eliminated point by point."""

from __future__ import annotations

from typing import cast

import numpy as np

from ...contact.graph import GraphPoint
from ...contracts import Array
from ...discrete.response import Apply


class PointwiseEquation:
    """dU/dq dq + S_D (dt/dq - D dU/dq) dq = -F in terms of s = (dt/dq - D dU/dq) dq.

    Eliminating dq with S_D replaced by its blocks B at the points leaves s + P (S_D - B) s = -P F, which concerns only the
    points where D misses the slope of the law.

    point : `graph.GraphPoint`;  scale (n,) of the graph, stiffness D and blocks B (n, d, d);  P (n, d, d)
    least : (n, d, d), below which dt/dq is raised to it; None: nothing is raised
    """

    def __init__(self, point: GraphPoint, scale: Array, stiffness: Array, blocks: Array, *, least: Array | None = None) -> None:
        slope = point.derivative if least is None else _Raised(point.derivative, least)
        relief = (np.eye(slope.shape[1]) - slope) / scale[:, None, None]    # dU/dq
        shifted = slope - stiffness @ relief                                # ds/dq
        self.blocks = blocks
        self.inverse = cast(Array, np.linalg.inv(relief + blocks @ shifted))
        self.P = shifted @ self.inverse

    def Local(self, image: Array, s: Array) -> Array:
        """P (S_D - B) s of image = S_D s, (n, d)."""
        return Apply(self.P, image - Apply(self.blocks, s))

    def Step(self, F: Array, rest: Array) -> Array:
        """dq (n, d) of rest = (S_D - B) s."""
        return -Apply(self.inverse, rest + F)


def _Raised(slope: Array, least: Array) -> Array:
    """Matrices (n, d, d) whose symmetric parts are nowhere below those of `least`."""
    values, vectors = np.linalg.eigh(least - (slope + np.swapaxes(slope, 1, 2)) / 2)
    return slope + (vectors * np.maximum(values, 0)[:, None, :]) @ np.swapaxes(vectors, 1, 2)
