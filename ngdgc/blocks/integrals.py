"""Integrals of shape functions over elements and their sides, for all elements of one type at once.

Letters as in docs/conventions.md: n elements, q points, i k components, m t directions of the reference element, a b p
functions of V_h, F_h and Q_h, c basis matrices.  Displacements are ordered component by component, v = e_i phi_a -> (i a); so
are facet functions (i b) and, with the basis E_c of the symmetric matrices, liftings (c p).  An array over n elements and their
local degrees of freedom is a batch of element matrices, computed by one matrix product for all elements whose vertex numbers
are ordered alike.

Geometry and C enter at quadrature points; where neither varies in an element, the shape functions are integrated first and the
points disappear.  Where they are of degree 1 in an element (`revolved` module) its vertices take the place of the points.
"""

from __future__ import annotations

from typing import cast

import numpy as np

from ..contracts import Array
from ..tools.parallel import Cached
from .contractions import Contractions, Functions, Table
from .reference import ReferenceElement, Shapes


def SymmetricBasis(dim: int) -> Array:
    """E_c, (components, d, d): the matrices that NGSolve's MatrixValued(symmetric=True) multiplies its functions by."""
    pairs = [(i, j) for i in range(dim) for j in range(i, dim)]
    basis = np.zeros((len(pairs), dim, dim))
    for c, (i, j) in enumerate(pairs):
        basis[c, i, j] = basis[c, j, i] = 1
    return basis


class ElementGroup(Contractions):
    """Batches of element matrices for all elements of one type; sides are numbered by s = 0 ... nf-1, n is outward."""

    @property
    def basis(self) -> Array:
        return SymmetricBasis(self.dim)

    def _Contract(self, pairs: Array, number: int) -> Array:
        """sum_jl pairs[n, q, x, j, l] C_ijkl -> (n, q, x, i, k), in the element (0) or on side number - 1; x any number."""
        C, d = self.Stiffness(number), self.dim
        C = C.transpose(0, 1, 3, 5, 2, 4).reshape(*C.shape[:2], d * d, d * d)   # nqijkl -> n q (j l) (i k)
        pairs = pairs.reshape(*pairs.shape[:3], d * d)                          # n q x (j l)
        if C.shape[:2] == (1, 1):       # one product for all
            return (pairs.reshape(-1, d * d) @ C[0, 0]).reshape(*pairs.shape[:3], d, d)
        contracted = pairs @ C
        return contracted.reshape(*contracted.shape[:3], d, d)

    def _StressGradient(self) -> Array:
        """C_ijkl G_tl, that maps reference gradients of u_k to stresses in the element, (n, q, i, j, k, t)."""
        C, (G, _), d = self.Stiffness(), self.Geometry(), self.dim
        stress = C.reshape(*C.shape[:2], d ** 3, d) @ np.swapaxes(G, 2, 3)      # n q (i j k) l  @  n q l t
        return stress.reshape(*stress.shape[:2], d, d, d, d)

    def _EnergyDensity(self, number: int = 0) -> Array:
        """G_mj C_ijkl G_tl, the energy of reference gradients, (n, q, i, k, m, t)."""
        (G, _), d = self.Geometry(number), self.dim
        pairs = G[:, :, :, None, :, None] * G[:, :, None, :, None, :]           # G_mj G_tl, n q m t j l
        density = self._Contract(pairs.reshape(*G.shape[:2], d * d, d, d), number)      # n q (m t) i k
        return density.reshape(*density.shape[:2], d, d, d, d).transpose(0, 1, 4, 5, 2, 3)

    def _Side(self, s: int, name: str) -> Functions:
        return lambda shape: (shape.facets[s], getattr(shape.facets[s], name))

    def _LiftFunctions(self, shape: ReferenceElement) -> tuple[Shapes, Array]:
        return shape, shape.p

    def _GradientProducts(self, shapes: Shapes) -> Array:
        """w_q d_m phi_a d_t phi_b, (q, (m t), (a b)), of a ReferenceElement or of its FacetShapes."""
        products = self._Gathered(np.einsum("q,qma,qtb->qmtab", shapes.weights, shapes.dv, shapes.dv), shapes)
        return products.reshape(len(products), self.dim ** 2, -1)

    @Cached
    def energy(self) -> Array:
        """K = int C eps(u):eps(v), (n, (i a), (k b))."""
        return self._Energy()

    def _Energy(self) -> Array:
        _, volume = self.Geometry()
        return self._Gradients(self._EnergyDensity() * volume[..., None, None, None, None], self._GradientProducts)

    @Cached
    def rotations(self) -> Array:
        """int (d_i u_k - d_k u_i), i < k, as functionals, (n, (k a), pairs); none where no rotation is free of strain."""
        return self._Rotations()

    def _Rotations(self) -> Array:
        G, volume = self.Geometry()
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
        if measure.shape[1] > 1 and not self._Traced(s):
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

    def _Traced(self, s: int) -> bool:
        """True if traces on the side are in F_h, whatever the measure there is."""
        return False

    def Traction(self, s: int) -> Array:
        """int_e {C eps(u) n}.mu with the transmitted part of the traction, (n, (i b), (k a))."""
        stress = self._StressOnNormal(s) * self.Boundary(s)[1][..., None, None, None]
        return self._Mixed(self._Transmit(s, stress), lambda shape: shape.facets[s].mu, s)

    def _StressOnNormal(self, s: int) -> Array:
        """n_j C_ijkl G_tl, (n, q, i, k, t)."""
        (n, _), (G, _) = self.Boundary(s), self.Geometry(1 + s)
        return self._Contract(n[:, :, None, :, None] * G[:, :, :, None, :], 1 + s).transpose(0, 1, 3, 4, 2)

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
        """The inverse of sum_q w_q measure[n, q] f_a f_b, (n, a, b)."""
        if measure.shape[1] > 1:
            return cast(Array, np.linalg.inv(self._Pairs(measure[..., None, None], functions, functions)))

        def Inverse(shape: ReferenceElement) -> Array:
            here, values = functions(shape)
            return np.linalg.inv(np.einsum("q,qa,qb->ab", here.weights, values, values)).reshape(1, 1, -1)

        size = functions(self.reference)[1].shape[1]
        return self._Sum(1 / measure[:, :, None], Inverse).reshape(len(measure), size, size)

    def ElasticJump(self, s: int) -> Array:
        """int_e {C sym(mu (x) n)} n.nu between transmitted parts, (n, (i b), (k b))."""
        n, measure = self.Boundary(s)
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
            return cast(Array, sum(self._Gradients(self._EnergyDensity(1 + s) * scale[..., None, None, None, None],
                                                   self._OnSide(s)) for s, scale in enumerate(scaled)))
        # One product for all sides, which take the place of the quadrature points.
        return self._Gradients(self._EnergyDensity() * np.concatenate(scaled, axis=1)[..., None, None, None, None],
                               lambda shape: np.stack([self._GradientProducts(facet).sum(axis=0) for facet in shape.facets]))

    def PlainPencil(self, weights: Array) -> Array:
        """sum_s weights[n, s] int_e 2 a.b - (a.n)(b.n), a = C eps(u) n and b = C eps(v) n, (n, (i a), (k b))."""
        return cast(Array, sum(self._PlainPencil(s, weights[:, s, None]) for s in self.sides))

    def _PlainPencil(self, s: int, weight: Array) -> Array:
        n, measure = self.Boundary(s)
        measure = weight * measure
        traction = self._StressOnNormal(s)      # n q i k t
        dual = (2 * np.eye(self.dim) - n[..., :, None] * n[..., None, :]) * measure[..., None, None]    # n q i j
        weighted = np.einsum("nqij,nqjkt->nqikt", dual, traction)
        return self._Gradients(np.einsum("nqjim,nqjkt->nqikmt", traction, weighted), self._OnSide(s))

    def _OnSide(self, s: int) -> Table:
        return lambda shape: self._GradientProducts(shape.facets[s])

    @Cached
    def stress(self) -> Array:
        """R = int C eps(u):q, (n, (c p), (k a))."""
        return self._Stress()

    def _Stress(self) -> Array:
        _, volume = self.Geometry()
        coefficient = np.einsum("cij,nqijkt->nqckt", self.basis, self._StressGradient() * volume[..., None, None, None, None])
        return self._Mixed(coefficient, lambda shape: shape.p)

    @Cached
    def inverseliftmass(self) -> Array:
        """M_Q^-1, (n, (c p), (c p))."""
        inverse = self._InverseLiftMass()
        components = np.linalg.inv(np.einsum("cij,dij->cd", self.basis, self.basis))
        size = len(components) * self.nl
        return (components[:, None, :, None] * inverse[:, None, :, None, :]).reshape(-1, size, size)

    def _InverseLiftMass(self) -> Array:
        """The inverse of int p q, scalar, (n, p, p)."""
        return self._InverseMass(self.Geometry()[1], self._LiftFunctions)

    @Cached
    def weightedliftmass(self) -> Array:
        """M_C, (n, (c p), (c p))."""
        _, volume = self.Geometry()
        weighted = np.einsum("cij,nqijkl,dkl->nqcd", self.basis, self.Stiffness(), self.basis) * volume[..., None, None]
        return self._Pairs(weighted, self._LiftFunctions, self._LiftFunctions)
