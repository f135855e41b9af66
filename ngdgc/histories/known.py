"""What is known of the compliance operator on Gamma_C from few products, for a symmetric matrix.

With V an orthonormal basis in L2(Gamma_C) of the tractions whose products have been paid for, B blocks at the points and
E = (S_D - B) V,

    S_V = B + E V' + V E' - V (V' E) V',

which is S_D on their span and, since S_D is symmetric, against it; only (1 - V V')(S_D - B)(1 - V V') is missing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import cast

import numpy as np

from ..contracts import Array
from ..discrete.response import Apply
from ..tools.parallel import Batched

FEW = 4         # directions are few if so many times their number are less than the components of a traction


class KnownResponse:
    """S_V of the `Product` of a `ContactResponse`.

    weights (n,) of the contact points;  blocks : B (n, d, d), symmetric [length/stress]
    """

    def __init__(self, Product: Callable[[Array], Array], weights: Array, blocks: Array) -> None:
        self.Product, self.blocks = Product, blocks
        self.root = np.repeat(np.sqrt(weights), blocks.shape[1])
        self.V = self.E = np.empty((len(self.root), 0))
        self.coupling = np.empty((0, 0))        # V' E, symmetric

    @property
    def complete(self) -> bool:
        """True if the products of all tractions are known."""
        return self.V.shape[1] >= len(self.root)

    def Outside(self, s: Array) -> Array:
        """The part of s (n, d) that is orthogonal to the span."""
        scaled = self.root * s.ravel()
        for _ in range(2):
            scaled = scaled - self.V @ (self.V.T @ scaled)
        return (scaled / self.root).reshape(s.shape)

    def Times(self, s: Array) -> Array:
        """S_V s, (n, d) -> (n, d)."""
        scaled = self.root * s.ravel()
        along = self.V.T @ scaled
        change = self.E @ along + self.V @ (self.E.T @ scaled - self.coupling @ along)
        return Apply(self.blocks, s) + (change / self.root).reshape(s.shape)

    def Learn(self, s: Array) -> float:
        """Add the direction of what is outside of the span of s, by one application of the inverse.

        Returns how much larger S_D of it is than what S_V was there, less 1, both in L2(Gamma_C).
        """
        scaled = self.root * self.Outside(s).ravel()
        scaled /= np.linalg.norm(scaled) or 1.0
        scaled -= self.V @ (self.V.T @ scaled)
        scaled /= np.linalg.norm(scaled)
        direction = (scaled / self.root).reshape(s.shape)
        expected = self.root * self.Times(direction).ravel()
        image = self.root * self.Product(direction).ravel()
        E = image - self.root * Apply(self.blocks, direction).ravel()
        beside, own = self.V.T @ E, scaled @ E
        self.V, self.E = np.column_stack([self.V, scaled]), np.column_stack([self.E, E])
        self.coupling = np.block([[self.coupling, beside[:, None]], [beside[None], np.array([[own]])]])
        return float(np.linalg.norm(image - expected) / (np.linalg.norm(expected) or 1.0))

    @Batched
    def Solve(self, local: Array, shifted: Array, b: Array) -> Array:
        """x (n, d) with local x + S_V shifted x = b, for blocks (n, d, d); nan if that is singular."""
        try:
            return self._Solution(local, shifted, b)
        except np.linalg.LinAlgError:
            return np.full_like(b, np.nan)

    def _Solution(self, local: Array, shifted: Array, b: Array) -> Array:
        n, dim = b.shape
        diagonal = local + self.blocks @ shifted
        left, right = self._Factors(shifted)
        if FEW * left.shape[1] > 2 * n * dim:
            matrix = left @ right
            rows = np.arange(n * dim).reshape(n, dim)
            matrix[rows[:, :, None], rows[:, None, :]] += diagonal
            return cast(Array, np.linalg.solve(matrix, b.ravel())).reshape(n, dim)
        inverse = cast(Array, np.linalg.inv(diagonal))
        first = Apply(inverse, b)
        if not left.shape[1]:
            return first
        spread = np.einsum("nij,njk->nik", inverse, left.reshape(n, dim, -1)).reshape(left.shape)
        small = np.eye(left.shape[1]) + right @ spread
        return first - (spread @ np.linalg.solve(small, right @ first.ravel())).reshape(n, dim)

    def _Factors(self, shifted: Array) -> tuple[Array, Array]:
        """(left, right) with left right = (S_V - B) shifted, in coordinates without weights."""
        n, dim = shifted.shape[:2]
        left = np.column_stack([self.E - self.V @ self.coupling, self.V]) / self.root[:, None]
        weighted = (np.column_stack([self.V, self.E]) * self.root[:, None]).reshape(n, dim, -1)
        right = np.einsum("nij,nik->njk", shifted, weighted).reshape(n * dim, -1).T
        return left, right


def Spread(coordinates: Array, weights: Array, groups: int) -> Iterator[Array]:
    """Tractions (n, d) that are constant on groups of neighbouring points and 0 elsewhere, for each component."""
    n, dim = coordinates.shape
    parts = [np.arange(n)]
    while len(parts) < groups:
        largest = max(parts, key=lambda part: weights[part].sum() if len(part) > 1 else 0.0)
        if len(largest) < 2:
            break
        parts = [part for part in parts if part is not largest]
        axis = np.argmax(np.ptp(coordinates[largest], axis=0))
        order = largest[np.argsort(coordinates[largest, axis], kind="stable")]
        half = int(np.clip(np.searchsorted(np.cumsum(weights[order]), 0.5 * weights[order].sum()), 1, len(order) - 1))
        parts += [order[:half], order[half:]]
    for part in parts:
        for component in range(dim):
            direction = np.zeros((n, dim))
            direction[part, component] = 1.0
            yield direction
