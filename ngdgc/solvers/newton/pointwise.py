"""Newton's equation at a point of the graph of the law, without the unknowns that can be eliminated point by point."""

import numpy as np

from ...discrete.response import Apply


class PointwiseEquation:
    """dU/dq dq + S_D (dt/dq - D dU/dq) dq = -F in terms of s = (dt/dq - D dU/dq) dq.

    Eliminating dq with S_D replaced by its blocks B at the points leaves s + P (S_D - B) s = -P F, which concerns only the
    points where D misses the slope of the law.

    point : `graph.GraphPoint`;  scale (n,) of the graph, stiffness D and blocks B (n, d, d);  P (n, d, d)
    least : (n, d, d), below which dt/dq is raised to it; None: nothing is raised
    """

    def __init__(self, point, scale, stiffness, blocks, *, least=None):
        slope = point.derivative if least is None else _Raised(point.derivative, least)
        relief = (np.eye(slope.shape[1]) - slope) / scale[:, None, None]    # dU/dq
        shifted = slope - stiffness @ relief                                # ds/dq
        self.blocks = blocks
        self.inverse = np.linalg.inv(relief + blocks @ shifted)
        self.P = shifted @ self.inverse

    def Local(self, image, s):
        """P (S_D - B) s of image = S_D s, (n, d)."""
        return Apply(self.P, image - Apply(self.blocks, s))

    def Step(self, F, rest):
        """dq (n, d) of rest = (S_D - B) s."""
        return -Apply(self.inverse, rest + F)


def _Raised(slope, least):
    """Matrices (n, d, d) whose symmetric parts are nowhere below those of `least`."""
    values, vectors = np.linalg.eigh(least - (slope + np.swapaxes(slope, 1, 2)) / 2)
    return slope + (vectors * np.maximum(values, 0)[:, None, :]) @ np.swapaxes(vectors, 1, 2)
