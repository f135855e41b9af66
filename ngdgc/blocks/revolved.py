"""Elements of a body of revolution: those of its section, with the weight 2 pi r in every integral, and the hoop strain u_r/r.

With T_ij = C_ijtt, H = C_tttt and what C does in the plane alone, integrals over the section,

    int C eps(u):eps(v)  =  int C grad u:grad v 2 pi r + int 2 pi (T:grad u v_r + u_r T:grad v) + int H u_r v_r 2 pi/r
    int C eps(u) n.mu    =  int C grad u n.mu 2 pi r + int 2 pi u_r T n.mu

Only the last term of the first line is no polynomial.  Where elements are affine and C is constant in them r is of degree 1 and
nothing else varies: then measures are given at the vertices of an element, in place of its quadrature points, and what has no
r in it at one point.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import Mesh, x

from ..contracts import Array
from ..mesh.facets import REFERENCE_VERTICES
from ..problem.frames import AXIS, TURN
from ..tools.parallel import Cached
from .integrals import ElementGroup
from .reference import ReferenceElement, Shapes

if TYPE_CHECKING:       # of Python 3.11
    from typing import Self


class RevolvedGroup(ElementGroup):
    """Batches of element matrices of a body of revolution, sides on its axis with a measure to divide by: they have no area."""

    @property
    def _directions(self) -> int:
        return 3

    def _Finish(self, mesh: Mesh, vertices: np.ndarray, points: Sequence[np.ndarray]) -> None:
        self._steady, self.uniform, spatial = self.uniform, False, self._stiffness
        self._stiffness = [C[..., :2, :2, :2, :2] for C in spatial]
        self._ties = [(C[..., :2, :2, 2, 2], C[..., 2, 2, 2, 2]) for C in spatial]
        corners = np.asarray(mesh.ngmesh.Coordinates())[vertices, 0]        # n, corners
        shapes: list[Shapes] = [self.reference, *self.reference.facets]
        if points:
            radii = [np.asarray(x(at.ravel())).reshape(at.shape) for at in points]
        else:
            radii = [corners @ self._Hats(shape).T for shape in shapes]
        largest = max(r.max() for r in radii)
        axis = [np.zeros((1, 1), dtype=bool), *((r <= AXIS * largest).all(axis=1, keepdims=True) for r in radii[1:])]
        self._radii = [np.where(on, largest, r) for on, r in zip(axis, radii)]
        weights = [np.where(on, largest, corners) for on in axis] if self._steady else self._radii
        self._plain = [self._geometry[0][1], *(measure for _, measure in self._boundary)]
        (G, volume), *sides = self._geometry
        self._geometry = [(G, volume * TURN * weights[0]), *sides]
        self._boundary = [(n, measure * TURN * r) for (n, measure), r in zip(self._boundary, weights[1:])]
        self._all = self

    def Part(self, rows: np.ndarray) -> Self:
        part = super().Part(rows)
        part._steady, part._ties, part._radii, part._plain = self._steady, self._ties, self._radii, self._plain
        part._all = self._all
        return part

    def Radii(self, number: int = 0) -> Array:
        """r at the quadrature points of the element (0) or of side number - 1, (n, q)."""
        return self._Chosen(self._radii[number])

    def Plain(self, number: int = 0) -> Array:
        """|det dF|, or the measure of a side, in the plane, (n, q or 1)."""
        return self._Chosen(self._plain[number])

    def Tie(self, number: int) -> tuple[Array, Array]:
        """(T, H), (n or 1, q or 1, i, j) and (n or 1, q or 1)."""
        T, H = self._ties[number]
        return self._Chosen(T), self._Chosen(H)

    def _Hats(self, shapes: Shapes) -> Array:
        """(q, corners): the functions of the vertices, of degree 1 or bilinear."""
        corners = np.array(REFERENCE_VERTICES[self.et], dtype=float)[:, :2]

        def Monomials(x: Array, y: Array) -> Array:
            return np.stack([1 + 0 * x, x, y, x * y][:len(corners)], axis=1)

        return Monomials(*shapes.points[:, :2].T) @ np.linalg.inv(Monomials(*corners.T))

    def _Gathered(self, products: Array, shapes: Shapes) -> Array:
        return np.tensordot(self._Hats(shapes), products, axes=(0, 0)) if self._steady else products

    def _Traced(self, s: int) -> bool:
        # The facets are lines; only where a roller is curved its normal parts are no polynomials.
        return self.Boundary(s)[0].shape[1] == 1 or not self.rollers[:, s].any()

    def _Rotations(self) -> Array:
        return np.zeros((len(self.elements), self.dim * self.na, 0))

    def _Energy(self) -> Array:
        return super()._Energy() + self._Hoop({0: 1.0})

    def _Hoop(self, scales: dict[int, Any]) -> Array:
        """The terms of u_r/r in the energy, (n, (i a), (k b)), over element (0) and sides (number - 1), times scales (n, 1)."""
        a, n = self.na, len(self.elements)
        tied, squares = [], []
        for number, scale in scales.items():
            (T, H), (G, _), measure = self.Tie(number), self.Geometry(number), TURN * scale * self.Plain(number)
            tied.append((G @ np.swapaxes(T, 2, 3)) * measure[..., None, None])      # T_kl G_tl, n q t k
            squares.append(H * measure / self.Radii(number))

        def Products(shape: ReferenceElement, derivatives: bool) -> Array:
            found = []
            for part, number in zip(tied, scales):
                here = shape.facets[number - 1] if number else shape
                products = np.einsum("q,qa,qtb->qtab", here.weights, here.v, here.dv if derivatives else here.v[:, None])
                found.append(products.sum(axis=0, keepdims=True) if derivatives and part.shape[1] == 1 else products)
            together = np.concatenate(found)
            return together.reshape(*together.shape[:2], -1)

        def Sum(coefficient: Array, derivatives: bool) -> Array:
            return self._Sum(coefficient, lambda shape: Products(shape, derivatives)).reshape(n, -1, a, a)

        mixed = Sum(np.concatenate(tied, axis=1).transpose(0, 3, 1, 2), True)
        square = Sum(np.concatenate(squares, axis=1)[..., None], False)
        found = np.zeros((n, 2, a, 2, a))
        found[:, 0, :, 0] = square[:, 0]
        for k in range(2):
            found[:, 0, :, k] += mixed[:, k]
            found[:, k, :, 0] += np.swapaxes(mixed[:, k], 1, 2)
        return found.reshape(n, 2 * a, 2 * a)

    def _InverseLiftMass(self) -> Array:
        return self._all._inverses[self._chosen]

    @Cached
    def _inverses(self) -> Array:
        """Of all elements: in the plane they are multiples of one, here it takes as long as all the rest to find them."""
        return super()._InverseLiftMass()

    def Traction(self, s: int) -> Array:
        found = super().Traction(s)
        pull = TURN * self.Pull(s) * self.Plain(1 + s)[..., None]
        found[..., :self.na] += self._Pairs(self._Transmit(s, pull)[..., None],
                                            self._Side(s, "mu"), self._Side(s, "v"))
        return found

    def Pull(self, s: int) -> Array:
        """T n, (n, q, i)."""
        return (self.Tie(1 + s)[0] @ self.Boundary(s)[0][..., None])[..., 0]

    def _Stress(self) -> Array:
        found = super()._Stress()
        tie = np.einsum("cij,nqij->nqc", self.basis, self.Tie(0)[0])
        found[..., :self.na] += self._Pairs((TURN * tie * self.Plain()[..., None])[..., None],
                                            self._LiftFunctions, lambda shape: (shape, shape.v))
        return found

    def ElasticPencil(self, weights: Array) -> Array:
        hoop = self._Hoop({1 + s: weights[:, s, None] for s in self.sides})
        if not self._steady:
            return super().ElasticPencil(weights) + hoop
        scaled = np.concatenate([weights[:, s, None] * self.Boundary(s)[1] for s in self.sides], axis=1)
        return hoop + self._Gradients(self._EnergyDensity() * scaled[..., None, None, None, None],
                                      lambda shape: np.concatenate([self._GradientProducts(facet) for facet in shape.facets]))

    def _PlainPencil(self, s: int, weight: Array) -> Array:
        # Of a square of tractions that have 1/r in them, which only the quadrature points know.
        n, r = self.Boundary(s)[0], self.Radii(1 + s)
        traction = np.zeros((*r.shape, 2, 2, 3))        # n q i k t
        traction[..., :2] = self._StressOnNormal(s)
        traction[..., 0, 2] = self.Pull(s) / r[..., None]
        measure = weight * TURN * r * self.Plain(1 + s)
        dual = (2 * np.eye(2) - n[..., :, None] * n[..., None, :]) * measure[..., None, None]

        def Products(shape: ReferenceElement) -> Array:
            facet = shape.facets[s]
            with_values = np.concatenate([facet.dv, facet.v[:, None]], axis=1)
            return np.einsum("q,qma,qtb->qmtab", facet.weights, with_values, with_values).reshape(len(r[0]), 9, -1)

        weighted = np.einsum("nqij,nqjkt->nqikt", dual, traction)
        return self._Gradients(np.einsum("nqjim,nqjkt->nqikmt", traction, weighted), Products)
