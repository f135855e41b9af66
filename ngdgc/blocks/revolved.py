"""Elements of a body of revolution: what its frame makes of geometry, measures and C at quadrature points.

The hoop strain u_r/r is treated as one more derivative.  Beside the reference gradients d_1 phi, d_2 phi stands the value phi
as d_3 phi, and G_33 = 1/r beside the Jacobian's inverse: with directions j, l in (r, z, theta) and components i, k in (r, z),

    G_tl d_t u_k  =  [ d_r u_r   d_z u_r   u_r/r ]        of which C_ijkl, the derivative in direction theta of u_r standing for
                     [ d_r u_z   d_z u_z   u_z/r ]        the entry (theta, theta), uses all but the last one.

Measures contain 2 pi r, so that every integral of the blocks is one over the body.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..contracts import Array
from ..problem.frames import AXIS, TURN

Pair = tuple[Array, Array]


def Revolved(radii: Sequence[Array], geometry: Sequence[Pair], boundary: Sequence[Pair],
             stiffness: Sequence[Array]) -> tuple[list[Pair], list[Pair], list[Array]]:
    """(geometry, boundary, stiffness) of `GroupGeometry` for the body, from those of its section and C in space.

    radii : r at the points (n, q) of the elements and of each of their sides
    """
    largest = max(r.max() for r in radii)
    turned = [(_Derivatives(G, r, largest), volume * TURN * r) for r, (G, volume) in zip(radii, geometry)]
    # A side on the axis has no area, and takes part in nothing; its mass is divided by.
    around = [TURN * np.where((r <= AXIS * largest).all(axis=1, keepdims=True), largest, r) for r in radii[1:]]
    sides = [(n + 0 * r[..., None], measure * r) for r, (n, measure) in zip(around, boundary)]
    return turned, sides, [_Hoop(C) for C in stiffness]


def _Derivatives(G: Array, r: Array, largest: float) -> Array:
    """G_tl (n, q, t, l) with the hoop direction; 0 on the axis."""
    turned = np.zeros((*r.shape, 3, 3))
    turned[..., :2, :2] = G
    turned[..., 2, 2] = np.where(r > AXIS * largest, 1 / np.maximum(r, AXIS * largest), 0)
    return turned


def _Hoop(C: Array) -> Array:
    """C_ijkl (..., i, j, k, l) with i, k = r, z and j, l = r, z, theta, from that in space in the order r, z, theta."""
    turned = np.zeros((*C.shape[:-4], 2, 3, 2, 3))
    turned[..., :, :2, :, :2] = C[..., :2, :2, :2, :2]
    turned[..., 0, 2, :, :2] = C[..., 2, 2, :2, :2]
    turned[..., :, :2, 0, 2] = C[..., :2, :2, 2, 2]
    turned[..., 0, 2, 0, 2] = C[..., 2, 2, 2, 2]
    return turned


def HoopEnergy(G: Array, C: Array) -> Array:
    """G_mj C_ijkl G_tl, (n, q, i, k, m, t), of what `Revolved` makes of G and C, whose zeros are left out."""
    plane, hoop = G[..., :2, :2], G[..., 2, 2]
    density = np.empty((*G.shape[:2], 2, 2, 3, 3))
    stress = C[..., :2, :, :2].transpose(0, 1, 3, 5, 2, 4).reshape(*C.shape[:2], 4, 4)      # n q (j l) (i k)
    pairs = (plane[:, :, :, None, :, None] * plane[:, :, None, :, None, :]).reshape(*G.shape[:2], 4, 4)     # n q (m t) (j l)
    density[..., :2, :2] = np.swapaxes(pairs @ stress, 2, 3).reshape(*G.shape[:2], 2, 2, 2, 2)
    # C is symmetric, and of u_z there is no hoop strain.
    coupled = hoop[..., None, None] * (C[..., 0, 2, :, :2] @ np.swapaxes(plane, 2, 3))      # n q k t
    density[..., 2, :], density[..., :, 2] = 0, 0
    density[:, :, 0, :, 2, :2] = coupled
    density[:, :, :, 0, :2, 2] = coupled
    density[:, :, 0, 0, 2, 2] = C[..., 0, 2, 0, 2] * hoop ** 2
    return density
