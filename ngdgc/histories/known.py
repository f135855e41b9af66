"""What is known of the compliance operator on Gamma_C from few products, for a symmetric matrix.

With B positive definite blocks at the points and V tractions whose products Y = S_D V have been paid for, made such that
V' W Y = 1, the guess of S_D is that of the BFGS method (Nocedal, Wright: Numerical Optimization, 2006, (6.17)),

    S_V = Y Y' W + (1 - Q)* B (1 - Q),     Q = V Y' W,

which is S_D on their span, against it, and as S_D is positive: what is missing, (1 - Q)* (S_D - B) (1 - Q), sees s - Q s alone.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import cast

import numpy as np

from ..contracts import Array
from ..discrete.response import Apply
from ..tools.parallel import Batched

DENSE = 1500    # components of a traction up to which S_V is kept as a matrix
VOID = 1e-8     # of what S_V says of a traction: less is none, as that of one that no displacement on Gamma_C sees


class KnownResponse:
    """S_V of the `Product` of a `ContactResponse`.

    weights (n,) of the contact points;  blocks : B (n, d, d), symmetric [length/stress]
    """

    def __init__(self, Product: Callable[[Array], Array], weights: Array, blocks: Array) -> None:
        self.Product, self.blocks = Product, blocks
        self.root = np.repeat(np.sqrt(weights), blocks.shape[1])
        # All in coordinates root s, in which S_D is symmetric.
        self.V = self.Y = self.Z = np.empty((len(self.root), 0))    # Z: S_V V before V was known
        self.a = np.empty(0)                                        # S_V = B + Y diag(a) Y' - Y Z' - Z Y'
        self.matrix = _Diagonal(blocks) if len(self.root) <= DENSE else None

    @property
    def complete(self) -> bool:
        """True if the products of all tractions are known."""
        return self.V.shape[1] >= len(self.root)

    def Outside(self, s: Array) -> Array:
        """(1 - Q) s, (n, d): the part of s of which S_D is not known."""
        return (self._Outside(self.root * s.ravel()) / self.root).reshape(s.shape)

    def _Outside(self, scaled: Array) -> Array:
        for _ in range(2):
            scaled = scaled - self.V @ (self.Y.T @ scaled)
        return scaled

    def Times(self, s: Array) -> Array:
        """S_V s, (n, d) -> (n, d)."""
        return (self._Times(self.root * s.ravel()) / self.root).reshape(s.shape)

    def _Times(self, scaled: Array) -> Array:
        if self.matrix is not None:
            return cast(Array, self.matrix @ scaled)
        along = self.Y.T @ scaled
        return (Apply(self.blocks, scaled.reshape(len(self.blocks), -1)).ravel()
                + self.Y @ (self.a * along - self.Z.T @ scaled) - self.Z @ along)

    def Learn(self, s: Array) -> float:
        """Add what is outside of the span of s, by one application of the inverse.

        Returns how far S_D of it is from what S_V was there, relative, in L2(Gamma_C).
        """
        v = self._Outside(self.root * s.ravel())
        v = v / (np.linalg.norm(v) or 1.0)
        y = self.root * self.Product((v / self.root).reshape(s.shape)).ravel()
        z = self._Times(v)
        off = float(np.linalg.norm(y - z) / (np.linalg.norm(z) or 1.0))
        energy, guess = v @ y, v @ z
        if energy > VOID * guess:
            size = np.sqrt(energy)
            v, y, z = v / size, y / size, z / size
            v, y = v - self.V @ (self.Y.T @ v), y - self.Y @ (self.Y.T @ v)
            a = 1.0 + v @ z
        else:       # S_D v = 0: Q is the projection on v, and S_V v shall be 0
            y, a = v, guess
        self.V, self.Y, self.Z = (np.column_stack(pair) for pair in ((self.V, v), (self.Y, y), (self.Z, z)))
        self.a = np.append(self.a, a)
        if self.matrix is not None:
            change = np.outer(y, 0.5 * a * y - z)
            self.matrix += change + change.T
        return off

    @Batched
    def Solve(self, local: Array, shifted: Array, b: Array) -> Array:
        """x (n, d) with local x + S_V shifted x = b, for blocks (n, d, d); nan if that is singular."""
        try:
            return self._Solution(local, shifted, b)
        except np.linalg.LinAlgError:
            return np.full_like(b, np.nan)

    def _Solution(self, local: Array, shifted: Array, b: Array) -> Array:
        n, dim = b.shape
        root = self.root.reshape(n, dim)[:, :1, None]
        if self.matrix is not None:
            matrix = np.einsum("anj,njk->ank", self.matrix.reshape(-1, n, dim), shifted * root).reshape(n * dim, n * dim)
            matrix /= self.root[:, None]
            rows = np.arange(n * dim).reshape(n, dim)
            matrix[rows[:, :, None], rows[:, None, :]] += local
            return cast(Array, np.linalg.solve(matrix, b.ravel())).reshape(n, dim)
        inverse = cast(Array, np.linalg.inv(local + self.blocks @ shifted))
        first = Apply(inverse, b)
        left = np.column_stack([self.Y * self.a - self.Z, self.Y]) / self.root[:, None]
        weighted = np.column_stack([self.Y, -self.Z]).reshape(n, dim, -1)
        right = np.einsum("nij,nik->njk", shifted * root, weighted).reshape(n * dim, -1).T
        spread = np.einsum("nij,njk->nik", inverse, left.reshape(n, dim, -1)).reshape(left.shape)
        small = np.eye(left.shape[1]) + right @ spread
        return first - (spread @ np.linalg.solve(small, right @ first.ravel())).reshape(n, dim)


def _Diagonal(blocks: Array) -> Array:
    """The matrix with these blocks on its diagonal."""
    n, dim = blocks.shape[:2]
    matrix = np.zeros((n * dim, n * dim))
    rows = np.arange(n * dim).reshape(n, dim)
    matrix[rows[:, :, None], rows[:, None, :]] = blocks
    return matrix
