"""Integrals of shape functions over elements and their sides, for all elements of one type at once.

Letters as in docs/conventions.md: n elements, q points, i k components, m t directions of the reference element, a b p
functions of V_h, F_h and Q_h, c basis matrices.  Displacements are ordered component by component, v = e_i phi_a -> (i a); so
are facet functions (i b) and, with the basis E_c of the symmetric matrices, liftings (c p).  An array over n elements and their
local degrees of freedom is a batch of element matrices, computed by one matrix product for all elements whose vertex numbers
are ordered alike.

Geometry and C enter at quadrature points; where neither varies in an element, the shape functions are integrated first and the
points disappear.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import cast

import numpy as np

from ..contracts import Array
from ..tools.parallel import Cached
from .elements import GroupGeometry
from .reference import ReferenceElement, Shapes
from .revolved import HoopEnergy

Table = Callable[[ReferenceElement], Array]                      # (q, ..., functions) at the points of a reference element
Functions = Callable[[ReferenceElement], tuple[Array, Array]]    # weights (q,) and values (q, functions)


def SymmetricBasis(dim: int) -> Array:
    """E_c, (components, d, d): the matrices that NGSolve's MatrixValued(symmetric=True) multiplies its functions by."""
    pairs = [(i, j) for i in range(dim) for j in range(i, dim)]
    basis = np.zeros((len(pairs), dim, dim))
    for c, (i, j) in enumerate(pairs):
        basis[c, i, j] = basis[c, j, i] = 1
    return basis


class ElementGroup(GroupGeometry):
    """Batches of element matrices for all elements of one type; sides are numbered by s = 0 ... nf-1, n is outward."""

    @property
    def basis(self) -> Array:
        return SymmetricBasis(self.dim)

    def _Contract(self, pairs: Array, number: int) -> Array:
        """sum_jl pairs[n, q, x, j, l] C_ijkl -> (n, q, x, i, k), in the element (0) or on side number - 1; x any number."""
        C, d, e = self.Stiffness(number), self.dim, self.directions
        C = C.transpose(0, 1, 3, 5, 2, 4).reshape(*C.shape[:2], e * e, d * d)   # nqijkl -> n q (j l) (i k)
        pairs = pairs.reshape(*pairs.shape[:3], e * e)                          # n q x (j l)
        if C.shape[:2] == (1, 1):       # one product for all
            return (pairs.reshape(-1, e * e) @ C[0, 0]).reshape(*pairs.shape[:3], d, d)
        contracted = pairs @ C
        return contracted.reshape(*contracted.shape[:3], d, d)

    def _StressGradient(self) -> Array:
        """C_ijkl G_tl, that maps reference gradients of u_k to stresses in the element, (n, q, i, j, k, t)."""
        C, (G, _), d, e = self.Stiffness(), self.Geometry(), self.dim, self.directions
        stress = C.reshape(*C.shape[:2], d * e * d, e) @ np.swapaxes(G, 2, 3)   # n q (i j k) l  @  n q l t
        return stress.reshape(*stress.shape[:2], d, e, d, e)[:, :, :, :d]

    def _EnergyDensity(self, number: int = 0) -> Array:
        """G_mj C_ijkl G_tl, the energy of reference gradients, (n, q, i, k, m, t)."""
        (G, _), d = self.Geometry(number), self.dim
        if self.directions > d:
            return HoopEnergy(G, self.Stiffness(number))
        pairs = G[:, :, :, None, :, None] * G[:, :, None, :, None, :]           # G_mj G_tl, n q m t j l
        density = self._Contract(pairs.reshape(*G.shape[:2], d * d, d, d), number)      # n q (m t) i k
        return density.reshape(*density.shape[:2], d, d, d, d).transpose(0, 1, 4, 5, 2, 3)

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
        (n, q), d, e = coefficient.shape[:2], self.dim, self.directions
        # n i k q (m t) -> n i k (a b) -> n (i a) (k b)
        values = self._Sum(coefficient.transpose(0, 2, 3, 1, 4, 5).reshape(n, d, d, q, e * e), products)
        return values.reshape(n, d, d, self.na, self.na).transpose(0, 1, 3, 2, 4).reshape(n, d * self.na, d * self.na)

    def _Pairs(self, coefficient: Array, left: Functions, right: Functions) -> Array:
        """sum_q w_q coefficient[n, q, i, k] left_a right_b -> (n, (i, a), (k, b)); left and right give (q, functions)."""
        (n, _, rows, columns), sample = coefficient.shape, self.reference

        def Products(shape: ReferenceElement) -> Array:
            weights, a, b = left(shape)[0], left(shape)[1], right(shape)[1]
            return np.einsum("q,qa,qb->qab", weights, a, b).reshape(len(weights), 1, -1)

        values = self._Sum(coefficient.transpose(0, 2, 3, 1)[..., None], Products)     # n i k (a b)
        a, b = left(sample)[1].shape[1], right(sample)[1].shape[1]
        return values.reshape(n, rows, columns, a, b).transpose(0, 1, 3, 2, 4).reshape(n, rows * a, columns * b)

    def _Mixed(self, coefficient: Array, left: Table, s: int | None = None) -> Array:
        """sum_q w_q coefficient[n, q, i, k, t] left_b d_t phi_a -> (n, (i, b), (k, a))."""
        (n, q, rows, d, _) = coefficient.shape

        def Products(shape: ReferenceElement) -> Array:
            here = shape if s is None else shape.facets[s]
            values = np.einsum("q,qb,qta->qtba", here.weights, left(shape), here.dv)
            return values.reshape(len(here.weights), self.directions, -1)

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

    def _Side(self, s: int, name: str) -> Functions:
        return lambda shape: (shape.facets[s].weights, getattr(shape.facets[s], name))

    @Cached
    def energy(self) -> Array:
        """K = int C eps(u):eps(v), (n, (i a), (k b))."""
        _, volume = self.Geometry()
        return self._Gradients(self._EnergyDensity() * volume[..., None, None, None, None], _GradientProducts)

    @Cached
    def rotations(self) -> Array:
        """int (d_i u_k - d_k u_i), i < k, as functionals, (n, (k a), pairs); none where no rotation is free of strain."""
        G, volume = self.Geometry()
        if self.directions > self.dim:
            return np.zeros((len(G), self.dim * self.na, 0))
        pairs = [(i, k) for i in range(self.dim) for k in range(i + 1, self.dim)]
        curl = np.zeros((len(pairs), self.dim, self.dim))
        for number, (i, k) in enumerate(pairs):
            curl[number, k, i], curl[number, i, k] = 1, -1
        coefficient = np.einsum("rkl,nqtl,nq->nqrkt", curl, G, volume)
        return np.swapaxes(self._Mixed(coefficient, lambda shape: np.ones((len(shape.weights), 1))), 1, 2)

    def Trace(self, s: int) -> Array:
        """int_e u.mu with the transmitted part of u, (n, (i b), (k a))."""
        _, measure = self.Boundary(s)
        transmitted = self._Transmitted(s)
        transmitted = np.eye(self.dim)[None, None] if transmitted is None else transmitted
        return self._Pairs(measure[..., None, None] * transmitted, self._Side(s, "mu"), self._Side(s, "v"))

    def TraceValue(self, s: int) -> Array:
        """M_F^-1 times `Trace`: the transmitted part of u on the side as coefficients in F_h, (n, (i b), (k a))."""
        _, measure = self.Boundary(s)
        # A body of revolution is given in the plane, where traces are functions of F_h, whatever they are weighted with.
        if measure.shape[1] > 1 and (self.directions == self.dim or self.rollers[:, s].any()):
            inverse, trace = self.InverseFacetMass(s), self.Trace(s)
            return (inverse[:, None] @ trace.reshape(len(trace), self.dim, self.nb(s), -1)).reshape(trace.shape)
        values = np.empty((len(measure), self.dim, self.nb(s), self.dim, self.na))
        for rows, shape in self.rows:
            facet = shape.facets[s]
            mass, trace = (np.einsum("q,qb,qa->ba", facet.weights, facet.mu, other) for other in (facet.mu, facet.v))
            values[rows] = np.eye(self.dim)[:, None, :, None] * np.linalg.solve(mass, trace)[:, None, :]
        transmitted = self._Transmitted(s)
        if transmitted is not None:
            values = np.einsum("nij,njbka->nibka", transmitted[:, 0], values)
        return values.reshape(len(measure), self.dim * self.nb(s), -1)

    def Traction(self, s: int) -> Array:
        """int_e {C eps(u) n}.mu with the transmitted part of the traction, (n, (i b), (k a))."""
        stress = self._StressOnNormal(s) * self.Boundary(s)[1][..., None, None, None]
        return self._Mixed(self._Transmit(s, stress), lambda shape: shape.facets[s].mu, s)

    def _StressOnNormal(self, s: int) -> Array:
        """n_j C_ijkl G_tl, (n, q, i, k, t)."""
        (n, _), (G, _) = self.Boundary(s), self.Geometry(1 + s)
        return self._Contract(self._Directed(n)[:, :, None, :, None] * G[:, :, :, None, :], 1 + s).transpose(0, 1, 3, 4, 2)

    def _Transmit(self, s: int, coefficient: Array) -> Array:
        transmitted = self._Transmitted(s)
        return coefficient if transmitted is None else np.einsum("nqij,nqj...->nqi...", transmitted, coefficient)

    def LiftedTraction(self, s: int) -> Array:
        """int_e q n.mu with the transmitted part of the traction, (n, (i b), (c p))."""
        n, measure = self.Boundary(s)
        coefficient = self._Transmit(s, np.einsum("nqj,cij->nqic", n * measure[..., None], self.basis))
        return self._Pairs(coefficient, self._Side(s, "mu"), self._Side(s, "p"))

    def InverseFacetMass(self, s: int) -> Array:
        """The inverse of int_e mu nu, scalar, (n, b, b)."""
        return self._InverseMass(self.Boundary(s)[1], self._Side(s, "mu"))

    def _InverseMass(self, measure: Array, functions: Functions) -> Array:
        """The inverse of sum_q w_q measure[n, q] f_a f_b, (n, a, b); functions(shape) gives (w, f)."""
        if measure.shape[1] > 1:
            return cast(Array, np.linalg.inv(self._Pairs(measure[..., None, None], functions, functions)))

        def Inverse(shape: ReferenceElement) -> Array:
            weights, values = functions(shape)
            return np.linalg.inv(np.einsum("q,qa,qb->ab", weights, values, values)).reshape(1, 1, -1)

        size = functions(self.reference)[1].shape[1]
        return self._Sum(1 / measure[:, :, None], Inverse).reshape(len(measure), size, size)

    def ElasticJump(self, s: int) -> Array:
        """int_e {C sym(mu (x) n)} n.nu between transmitted parts, (n, (i b), (k b))."""
        n, measure = self.Boundary(s)
        n = self._Directed(n)
        pairs = n[..., :, None] * (n * measure[..., None])[..., None, :]        # n_j n_l, n q j l
        return self._JumpMass(s, self._Contract(pairs[:, :, None], 1 + s)[:, :, 0])

    def PlainJump(self, s: int) -> Array:
        """int_e {sym(mu (x) n)} n.nu between transmitted parts, (n, (i b), (k b))."""
        n, measure = self.Boundary(s)
        tensor = (np.eye(self.dim) + n[..., :, None] * n[..., None, :]) / 2
        return self._JumpMass(s, tensor * measure[..., None, None])

    def _JumpMass(self, s: int, tensor: Array) -> Array:
        transmitted = self._Transmitted(s)
        if transmitted is not None:
            tensor = transmitted @ tensor @ transmitted
        return self._Pairs(tensor, self._Side(s, "mu"), self._Side(s, "mu"))

    def SurfaceRatios(self, weights: Array) -> Array:
        """sum_s weights[n, s] |e_s| / |K|, (n,), where geometry is uniform."""
        surface = cast(Array, sum(weights[:, s] * self.Boundary(s)[1][:, 0] * facet.weights.sum()
                                  for s, facet in enumerate(self.reference.facets)))
        return surface / (self.Geometry()[1][:, 0] * self.reference.weights.sum())

    def ElasticPencil(self, weights: Array) -> Array:
        """sum_s weights[n, s] int_e C eps(u):eps(v), (n, (i a), (k b))."""
        scaled = [weights[:, s, None] * self.Boundary(s)[1] for s in self.sides]
        if not self.uniform:
            return cast(Array, sum(self._Gradients(self._EnergyDensity(1 + s) * scale[..., None, None, None, None], _OnSide(s))
                                   for s, scale in enumerate(scaled)))
        # One product for all sides, which take the place of the quadrature points.
        return self._Gradients(self._EnergyDensity() * np.concatenate(scaled, axis=1)[..., None, None, None, None],
                               lambda shape: np.stack([_GradientProducts(facet).sum(axis=0) for facet in shape.facets]))

    def PlainPencil(self, weights: Array) -> Array:
        """sum_s weights[n, s] int_e 2 a.b - (a.n)(b.n), a = C eps(u) n and b = C eps(v) n, (n, (i a), (k b))."""
        return cast(Array, sum(self._PlainPencil(s, weights[:, s, None]) for s in self.sides))

    def _PlainPencil(self, s: int, weight: Array) -> Array:
        n, measure = self.Boundary(s)
        measure = weight * measure
        traction = self._StressOnNormal(s)      # n q i k t
        dual = (2 * np.eye(self.dim) - n[..., :, None] * n[..., None, :]) * measure[..., None, None]    # n q i j
        weighted = np.einsum("nqij,nqjkt->nqikt", dual, traction)
        return self._Gradients(np.einsum("nqjim,nqjkt->nqikmt", traction, weighted), _OnSide(s))

    @Cached
    def stress(self) -> Array:
        """R = int C eps(u):q, (n, (c p), (k a))."""
        _, volume = self.Geometry()
        coefficient = np.einsum("cij,nqijkt->nqckt", self.basis, self._StressGradient() * volume[..., None, None, None, None])
        return self._Mixed(coefficient, lambda shape: shape.p)

    @Cached
    def inverseliftmass(self) -> Array:
        """M_Q^-1, (n, (c p), (c p))."""
        inverse = self._InverseMass(self.Geometry()[1], _LiftFunctions)
        components = np.linalg.inv(np.einsum("cij,dij->cd", self.basis, self.basis))
        size = len(components) * self.nl
        return (components[:, None, :, None] * inverse[:, None, :, None, :]).reshape(-1, size, size)

    @Cached
    def weightedliftmass(self) -> Array:
        """M_C, (n, (c p), (c p))."""
        _, volume = self.Geometry()
        plane = self.Stiffness()[:, :, :, :self.dim, :, :self.dim]
        weighted = np.einsum("cij,nqijkl,dkl->nqcd", self.basis, plane, self.basis) * volume[..., None, None]
        return self._Pairs(weighted, _LiftFunctions, _LiftFunctions)


def _LiftFunctions(shape: ReferenceElement) -> tuple[Array, Array]:
    return shape.weights, shape.p


def _GradientProducts(shapes: Shapes) -> Array:
    """w_q d_m phi_a d_t phi_b, (q, (m t), (a b)), of a ReferenceElement or of its FacetShapes."""
    products = np.einsum("q,qma,qtb->qmtab", shapes.weights, shapes.dv, shapes.dv)
    return products.reshape(len(shapes.weights), shapes.dv.shape[1] ** 2, -1)


def _OnSide(s: int) -> Table:
    return lambda shape: _GradientProducts(shape.facets[s])
