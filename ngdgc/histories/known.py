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
NOTHING = 1e-14 # of a block is round-off
VOID = 1e-12    # of what S_V says of a traction: less is round-off of one that no displacement on Gamma_C sees


class KnownResponse:
    """S_V of the `Product` of a `ContactResponse`.

    weights (n,) of the contact points;  blocks : B (n, d, d), symmetric [length/stress]
    """

    def __init__(self, Product: Callable[[Array], Array], weights: Array, blocks: Array) -> None:
        self.Product, self.blocks = Product, blocks
        self.root = np.repeat(np.sqrt(weights), blocks.shape[1])
        # All in coordinates root s, in which S_D is symmetric.
        self.V = self.Y = self.Z = np.empty((len(self.root), 0))    # Z: S_V V before V was known
        self.seen = self.a = np.empty(0)        # 1 or, for S_D V = 0, 0; S_V = B + Y diag(a) Y' - Y Z' - Z Y'
        self.change = np.zeros((len(self.root),) * 2) if len(self.root) <= DENSE else None      # S_V - B

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
        # In this order what is known does not carry the round-off of what is not.
        along = self.Y.T @ scaled
        rest = Apply(self.blocks, (scaled - self.V @ along).reshape(len(self.blocks), -1)).ravel()
        return rest + self.Y @ (self.seen * along - self.V.T @ rest)

    def Learn(self, s: Array) -> float:
        """Add what is outside of the span of s, by one application of the inverse.

        Returns how far S_D of it is from what S_V was there, relative, in L2(Gamma_C).
        """
        v = self._Outside(self.root * s.ravel())
        v = v / (np.linalg.norm(v) or 1.0)
        y = self.root * self.Product((v / self.root).reshape(s.shape)).ravel()
        z = self._Times(v)
        off = float(np.linalg.norm(y - z) / (np.linalg.norm(z) or 1.0))
        energy, seen = v @ y, float(np.linalg.norm(y) > VOID * np.linalg.norm(z) and v @ y > 0)
        if seen:
            v, y, z = (part / np.sqrt(energy) for part in (v, y, z))
            v, y = v - self.V @ (self.Y.T @ v), y - self.Y @ (self.Y.T @ v)
        else:       # S_D v = 0, so S_V v shall be 0, and Q v = v
            y = v - self.Y @ (self.V.T @ v)
        self.V, self.Y, self.Z = (np.column_stack(pair) for pair in ((self.V, v), (self.Y, y), (self.Z, z)))
        self.seen, self.a = np.append(self.seen, seen), np.append(self.a, seen + v @ z)
        if self.change is not None:
            change = np.outer(y, 0.5 * self.a[-1] * y - z)
            self.change += change + change.T
        return off

    @Batched
    def Solve(self, local: Array, shifted: Array, b: Array) -> Array:
        """x (n, d) with local x + S_V shifted x = b, for blocks (n, d, d); nan if that is singular."""
        try:
            return self._Solution(local, shifted, b)
        except np.linalg.LinAlgError:
            return np.full_like(b, np.nan)

    def _Solution(self, local: Array, shifted: Array, b: Array) -> Array:
        """From y = shifted x: y + G (S_V - B) y = G b with blocks G, in coordinates root b."""
        n, dim = b.shape
        inverse = cast(Array, np.linalg.inv(local + self.blocks @ shifted))
        G, scaled = shifted @ inverse, self.root.reshape(n, dim) * b
        right = Apply(G, scaled).ravel()
        if self.change is None:
            left = np.column_stack([self.Y * self.a - self.Z, -self.Y])
            other = np.column_stack([self.Y, self.Z])
            small = np.eye(left.shape[1]) + other.T @ np.einsum("nij,njk->nik", G, left.reshape(n, dim, -1)).reshape(left.shape)
            moved = left @ np.linalg.solve(small, other.T @ right)
        else:
            # Of a law like that in D y is 0, so there are fewer unknowns.
            sizes = np.abs(G).max(axis=2).ravel()
            rows = np.flatnonzero(sizes > NOTHING * sizes.max(initial=0))
            matrix = np.einsum("nij,njk->nik", G, self.change[:, rows].reshape(n, dim, -1)).reshape(n * dim, -1)[rows]
            matrix[np.diag_indices(len(rows))] += 1
            moved = self.change[:, rows] @ np.linalg.solve(matrix, right[rows])
        return Apply(inverse, scaled - moved.reshape(n, dim)) / self.root.reshape(n, dim)
