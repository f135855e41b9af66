"""Raviart-Thomas elements by moments, on any cell that is the image of a reference cell.

On the reference cell RT_k has rows tau with tau.N in the traces of V_h on every facet; Piola's map tau -> dF tau/|det dF|
brings it to the cell and keeps every moment

    int_e (s n).mu  on facets, mu in F_h,     int_K s:q  in the cell, q = q_hat dF^-1, q_hat in the reference gradients of V_h,

which together determine s: one small matrix on the reference cell serves all cells of a type, curved ones too.

    cell                     RT_k, direction m                          interior moments, direction m
    triangle, tetrahedron    P_k^d + x P_k                              P_(k-1)
    quadrilateral, hexahedron  degree k + 1 along m, k across           degree k - 1 along m, k across
    prism                    RT_k x P_k, P_k x P_(k+1)                  P_(k-1) x P_k, P_k x P_(k-1)

Source: Brezzi, Fortin, Mixed and Hybrid Finite Element Methods, Springer 1991, III.3.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
from ngsolve import ET

from ..blocks.reference import ReferenceElement
from ..contracts import Array

# Directions of the reference cell in sets that share a total degree; a segment for each other direction.
FACTORS = {ET.TRIG: ((0, 1),), ET.TET: ((0, 1, 2),), ET.QUAD: ((0,), (1,)), ET.HEX: ((0,), (1,), (2,)),
           ET.PRISM: ((0, 1), (2,))}


class PiolaElement:
    """RT_k on the reference cell of a ReferenceElement `shape`, whose quadrature has degree 2 k, seen at the points of another.

    Letters: q points, m directions, N functions of RT_k, I interior moments, b functions of F_h.

    values (q, m, N), divergences (q, N) : of RT_k at the points of `fine`, whose quadrature has degree 2 k + 2
    inner (q, m, I), inneron [(q, m, I)] : q_hat at the points of the cell and of its facets
    coefficients (N, moments) : from moments, facet by facet and then interior ones, to coefficients
    onfacets (moments, N), pairs (q, I, N) : the moments on facets, and what interior ones are sums of, at the points of `shape`
    """

    def __init__(self, et: Any, order: int, shape: ReferenceElement, fine: ReferenceElement) -> None:
        self._factors, self._order, self._dim, self.shape = FACTORS[et], order, shape.dim, shape
        values, divergences = self._Functions(fine.points)
        # Orthonormal in the cell: products of one degree in a corner of the square are nearly dependent.
        weighted = np.sqrt(fine.weights)[:, None, None] * values
        change = np.linalg.inv(np.linalg.qr(weighted.reshape(-1, weighted.shape[2]), mode="r"))
        self.values, self.divergences = values @ change, divergences @ change
        self.inner, self.inneron = self._Inner(shape.points), [self._Inner(facet.points) for facet in shape.facets]
        moments = []
        for facet in shape.facets:
            normal = np.einsum("qmN,m->qN", self._Functions(facet.points)[0], facet.normal) @ change
            moments.append(np.einsum("q,qb,qN->bN", facet.weights, facet.mu, normal))
        inside = self._Functions(shape.points)[0] @ change
        self.onfacets, self.pairs = np.concatenate(moments), np.einsum("qmI,qmN->qIN", self.inner, inside)
        moments.append(np.einsum("q,qmI,qmN->IN", shape.weights, self.inner, inside))
        self.coefficients = np.linalg.inv(np.concatenate(moments))

    def _Exponents(self, excess: tuple[int, ...]) -> list[tuple[int, ...]]:
        """Degrees in all directions of the products whose total in every factor is at most k + its excess."""
        sets = []
        for directions, more in zip(self._factors, excess):
            degrees = range(self._order + more + 1)
            sets.append([one for one in product(degrees, repeat=len(directions)) if sum(one) <= self._order + more])
        return [sum(parts, ()) for parts in product(*sets)]

    def _Excess(self, direction: int, more: int) -> tuple[int, ...]:
        return tuple(more if direction in directions else 0 for directions in self._factors)

    def _Inner(self, points: Array) -> Array:
        columns = []
        for m in range(self._dim):
            for values, _ in self._Products(points, self._Exponents(self._Excess(m, -1))):
                columns.append(np.eye(self._dim)[m] * values[:, None])
        return np.stack(columns, axis=2)

    def _Functions(self, points: Array) -> tuple[Array, Array]:
        """(values (q, m, N), divergences (q, N))."""
        values, divergences = [], []
        for directions in self._factors:
            single = len(directions) == 1
            for m in directions:
                for function, gradient in self._Products(points, self._Exponents(self._Excess(m, 1 if single else 0))):
                    values.append(np.eye(self._dim)[m] * function[:, None])
                    divergences.append(gradient[:, m])
            if not single:
                for value, divergence in self._Radial(points, directions):
                    values.append(value)
                    divergences.append(divergence)
        return np.stack(values, axis=2), np.stack(divergences, axis=1)

    def _Radial(self, points: Array, directions: tuple[int, ...]) -> Any:
        """x p, p homogeneous of degree k, times polynomials of degree k in the other factors."""
        x = 2 * points[:, list(directions)] - 1
        centred = np.zeros((len(points), self._dim))
        centred[:, list(directions)] = x
        others = self._Exponents(tuple(-self._order if factor == directions else 0 for factor in self._factors))
        for degrees in product(range(self._order + 1), repeat=len(directions)):
            if sum(degrees) == self._order:
                homogeneous = np.prod(x ** degrees, axis=1)
                for other, _ in self._Products(points, others):
                    function = homogeneous * other
                    # d/dx of x p in the variables 2 x - 1.
                    yield centred * function[:, None], 2 * (len(directions) + self._order) * function

    def _Products(self, points: Array, exponents: list[tuple[int, ...]]) -> Any:
        """(values (q,), gradients (q, m)) of products of Legendre polynomials in 2 x - 1."""
        x, most = 2 * points[:, :self._dim] - 1, max(map(max, exponents), default=0)
        basis = [np.polynomial.legendre.Legendre.basis(degree) for degree in range(most + 1)]
        table = np.array([one(x) for one in basis])                            # degree, q, m
        slopes = np.array([2 * one.deriv()(x) for one in basis])
        for degrees in exponents:
            factors = [table[degree, :, m] for m, degree in enumerate(degrees)]
            gradient = [np.prod([slopes[degrees[m], :, m] if other == m else factors[other] for other in range(self._dim)],
                                axis=0) for m in range(self._dim)]
            yield np.prod(factors, axis=0), np.stack(gradient, axis=1)


@lru_cache(maxsize=256)
def Piola(et: Any, order: int, shape: ReferenceElement, fine: ReferenceElement) -> PiolaElement:
    """The PiolaElement of these arguments; made once."""
    return PiolaElement(et, order, shape, fine)
