"""Sums over quadrature points: from coefficients at the points and tables of shape functions to batches of element matrices.

Letters as in `integrals`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import cast

import numpy as np

from ..contracts import Array
from .elements import GroupGeometry
from .reference import ReferenceElement, Shapes

Table = Callable[[ReferenceElement], Array]                      # (q, ..., functions) at the points of a reference element
Functions = Callable[[ReferenceElement], tuple[Shapes, Array]]   # where the points are, and values (q, functions) there


class Contractions(GroupGeometry):
    """A group whose coefficients, given at the points, are integrated with shape functions."""

    def _Gathered(self, products: Array, shapes: Shapes) -> Array:
        """Products (q, ...) at the points as what belongs to the values of coefficients, at these points or other ones."""
        return products

    def _Sum(self, coefficient: Array, integrand: Table) -> Array:
        """sum_qx coefficient[n, ..., q, x] integrand[q, x, y] -> (n, ..., y); integrand(ReferenceElement) contains weights.

        A coefficient with one point varies in no element: the integrand is then summed over its points first.
        """
        lead = coefficient.shape[1:-2]
        result: Array | None = None
        for rows, shape in self.rows:
            values = integrand(shape)
            part = coefficient[rows] if len(self.rows) > 1 else coefficient
            if coefficient.shape[-2] == 1:
                values = values.sum(axis=0, keepdims=True)
            # (n ...) (q x)  @  (q x) y
            part = part.reshape(len(rows) * int(np.prod(lead)), -1) @ values.reshape(-1, values.shape[-1])
            part = part.reshape(len(rows), *lead, -1)
            if len(self.rows) == 1:
                return part
            if result is None:
                result = np.empty((len(self.elements), *part.shape[1:]))
            result[rows] = part
        return cast(Array, result)

    def _Gradients(self, coefficient: Array, products: Table) -> Array:
        """sum_q coefficient[n, q, i, k, m, t] products[q, (m t), (a b)] -> (n, (i, a), (k, b)), for products as below."""
        n, q, d = *coefficient.shape[:2], self.dim
        # n i k q (m t) -> n i k (a b) -> n (i a) (k b)
        values = self._Sum(coefficient.transpose(0, 2, 3, 1, 4, 5).reshape(n, d, d, q, -1), products)
        return values.reshape(n, d, d, self.na, self.na).transpose(0, 1, 3, 2, 4).reshape(n, d * self.na, d * self.na)

    def _Pairs(self, coefficient: Array, left: Functions, right: Functions) -> Array:
        """sum_q w_q coefficient[n, q, i, k] left_a right_b -> (n, (i, a), (k, b)); left and right give (q, functions)."""
        (n, _, rows, columns), sample = coefficient.shape, self.reference

        def Products(shape: ReferenceElement) -> Array:
            (here, a), (_, b) = left(shape), right(shape)
            products = self._Gathered(np.einsum("q,qa,qb->qab", here.weights, a, b), here)
            return products.reshape(len(products), 1, -1)

        values = self._Sum(coefficient.transpose(0, 2, 3, 1)[..., None], Products)     # n i k (a b)
        a, b = left(sample)[1].shape[1], right(sample)[1].shape[1]
        return values.reshape(n, rows, columns, a, b).transpose(0, 1, 3, 2, 4).reshape(n, rows * a, columns * b)

    def _Mixed(self, coefficient: Array, left: Table, s: int | None = None) -> Array:
        """sum_q w_q coefficient[n, q, i, k, t] left_b d_t phi_a -> (n, (i, b), (k, a))."""
        (n, q, rows, d, _) = coefficient.shape

        def Products(shape: ReferenceElement) -> Array:
            here = shape if s is None else shape.facets[s]
            values = self._Gathered(np.einsum("q,qb,qta->qtba", here.weights, left(shape), here.dv), here)
            return values.reshape(len(values), self.dim, -1)

        values = self._Sum(coefficient.transpose(0, 2, 3, 1, 4), Products)     # n i k (b a)
        b = left(self.reference).shape[1]
        return values.reshape(n, rows, d, b, self.na).transpose(0, 1, 3, 2, 4).reshape(n, rows * b, d * self.na)

    def AtPoints(self, functions: Table, local: Array) -> Array:
        """sum_a local[n, i, a] functions(shape)[q, m, a], (n, q, i, m), for values at the q points of the elements."""
        (n, d, _), sample = local.shape, functions(self.reference)
        values = np.empty((n, d, *sample.shape[:2]))
        for rows, shape in self.rows:
            table = functions(shape)
            values[rows] = (local[rows].reshape(-1, table.shape[2]) @ table.reshape(-1, table.shape[2]).T).reshape(
                len(rows), d, *table.shape[:2])
        return np.swapaxes(values, 1, 2)
