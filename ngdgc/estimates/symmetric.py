"""The equilibrated stress of simplices and parallelograms made symmetric, its divergence and normal parts kept.

With q_c = e_cij s_ij, the skew part of s, of mean 0 in every element, psi_c in H^1_0(K) with div psi_c = q_c, and

    Phi_ic = psi_c,i - delta_ic tr/2,  tr = sum_l psi_l,l;      tau_ij = e_jab d_a Phi_ib     (in the plane tau_i = curl psi_i)

s + tau is symmetric, div tau = 0 and tau n = 0 on dK.  psi_c are piecewise polynomials on the split of K from its centre, one
degree above s, where the divergence has a right inverse onto polynomials of mean 0; on the reference element it is the one of
smallest gradient, a small matrix, which Piola's map carries to every affine image K.

Source: the identity is that of Arnold, Falk, Winther, Acta Numerica 15 (2006), section 11; the right inverse that of Guzman
and Neilan, SIAM J. Numer. Anal. 56 (2018).
"""

from __future__ import annotations

from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import (ET, L2, TET, TRIG, VOL, BilinearForm, ElementId, Grad, GridFunction, InnerProduct, IntegrationRule, Mesh,
                     VectorH1, div, dx)

from ..blocks.reference import FACETS, Gradients, ReferenceElement
from ..contracts import Array
from ..mesh.facets import REFERENCE_VERTICES, Coordinates, Csr, Free
from .equilibrated import StressBatch

DEGREES = 2     # of quadrature beyond products of two components of s, on every part of the split


class SplitElement:
    """A reference cell seen at the points of quadratures on the simplices of its split from the centre.

    shape : the ReferenceElement, whose functions and order of vertices these are;  k : order
    points (q, 3), weights (q,), dv (q, m, a) : as those of a ReferenceElement;  mesh, dim : its
    p (q, N) : orthonormal polynomials that contain the components of s
    inverse (q, m, t, N) : d psi_m/d xi_t, div psi = p - its mean
    """

    def __init__(self, et: Any, order: int, shape: ReferenceElement) -> None:
        self.mesh, self.dim, self.facets = shape.mesh, shape.dim, shape.facets
        exponents = [one for one in product(range(order + 2), repeat=self.dim) if et == ET.QUAD or sum(one) <= order + 1]
        most = max(map(sum, exponents))
        split, rule = _Split(et), IntegrationRule(TRIG if self.dim == 2 else TET, 2 * most + DEGREES)
        at = split.MapToAllElements({TRIG if self.dim == 2 else TET: rule}, VOL)
        self.points = np.zeros((len(at), 3))
        self.points[:, :self.dim] = np.asarray(Coordinates(self.dim)(at)).reshape(-1, self.dim)
        # All parts have the same size.
        self.weights = np.tile(rule.weights, split.ne) * (shape.weights.sum() / np.sum(rule.weights) / split.ne)
        self.dv = Gradients(L2(self.mesh, order=order).GetFE(ElementId(VOL, 0)), self.points, self.dim)
        self.constant = False
        space, pressures = VectorH1(split, order=most + 1, dirichlet="side"), L2(split, order=most)
        u, v = space.TnT()
        free = Free(space)
        stiffness = Csr(BilinearForm(InnerProduct(Grad(u), Grad(v)) * dx).Assemble().mat).toarray()[np.ix_(free, free)]
        divergence = BilinearForm(trialspace=space, testspace=pressures)
        divergence += div(u) * pressures.TestFunction() * dx
        divergence = Csr(divergence.Assemble().mat).toarray()[:, free]
        lifted = np.linalg.solve(stiffness, divergence.T)
        smallest = lifted @ np.linalg.pinv(divergence @ lifted, rcond=1e-10, hermitian=True)
        legendre = [np.polynomial.legendre.Legendre.basis(degree) for degree in range(order + 2)]
        table = np.array([one(2 * self.points[:, :self.dim] - 1) for one in legendre])     # degree, q, m
        plain = np.stack([np.prod([table[e, :, m] for m, e in enumerate(one)], axis=0) for one in exponents], axis=1)
        self.p = np.linalg.qr(np.sqrt(self.weights)[:, None] * plain)[0] / np.sqrt(self.weights)[:, None]
        q = _Values(pressures, at)       # q, functions of the split
        moments = q.T @ (self.weights[:, None] * (self.p - self.weights @ self.p / self.weights.sum()))
        coefficients = smallest @ moments
        function, numbers = GridFunction(space), np.flatnonzero(free)
        columns = []
        for column in coefficients.T:
            function.vec.FV().NumPy()[numbers] = column
            columns.append(np.asarray(Grad(function)(at)).reshape(-1, self.dim, self.dim))
        self.inverse = np.stack(columns, axis=3)


def _Split(et: Any) -> Mesh:
    """The reference cell split from its centre into simplices, its boundary named "side"."""
    reference = np.array(REFERENCE_VERTICES[et], dtype=float)
    dim, count = (2 if et in (ET.TRIG, ET.QUAD) else 3), len(reference)
    corners = np.concatenate([reference, reference.mean(axis=0, keepdims=True)])
    faces, parts = [list(face) for face in FACETS[et]], []
    for face in faces:
        part = [*face, count]
        edges = corners[part[1:], :dim] - corners[part[0], :dim]
        parts.append(part if np.linalg.det(edges) > 0 else [part[1], part[0], *part[2:]])
    mesh = NetgenMesh()
    mesh.dim = dim
    mesh.AddPoints(np.pad(corners, ((0, 0), (0, 3 - corners.shape[1]))))
    mesh.AddElements(dim=dim, index=mesh.AddRegion("cell", dim=dim), data=np.array(parts, dtype=np.int32), base=0)
    mesh.AddElements(dim=dim - 1, index=mesh.AddRegion("side", dim=dim - 1), data=np.array(faces, dtype=np.int32), base=0)
    return Mesh(mesh)


def _Values(space: Any, points: Any) -> Array:
    """Values of all functions of a scalar space at mesh points, (q, ndof)."""
    function, columns = GridFunction(space), []
    for dof in range(space.ndof):
        function.vec.FV().NumPy()[:] = 0
        function.vec[dof] = 1
        columns.append(np.asarray(function(points)).ravel())
    return np.stack(columns, axis=1)


@lru_cache(maxsize=64)
def Split(et: Any, order: int, shape: ReferenceElement) -> SplitElement:
    """The SplitElement of these arguments; made once."""
    return SplitElement(et, order, shape)


def Symmetrised(batch: StressBatch, order: int) -> Array:
    """s + tau, (n, q, i, j), for a batch at the points of `Split` of affine elements."""
    group, (G, _) = batch.group, batch.group.Geometry()
    permutation = _Permutations(group.dim)
    skew = np.einsum("cij,nqij->nqc", permutation, batch.equilibrated)
    gradients = np.empty((*skew.shape, group.dim, group.dim))       # n q c m t
    shape: Any
    for rows, shape in group.rows:
        coefficients = np.einsum("q,qN,nqc->nNc", shape.weights, shape.p, skew[rows], optimize=True)
        gradients[rows] = np.einsum("qmtN,nNc->nqcmt", shape.inverse, coefficients, optimize=True)
    psi = np.einsum("npim,nqcmt,npta->nqcia", np.linalg.inv(G), gradients, G, optimize=True)     # d_a psi_c,i
    if group.dim == 2:
        return batch.equilibrated + np.stack([psi[:, :, 0, :, 1], -psi[:, :, 0, :, 0]], axis=3)
    trace = np.einsum("nqlla->nqa", psi) / 2
    phi = np.swapaxes(psi, 2, 3) - np.eye(3)[:, :, None] * trace[:, :, None, None, :]      # d_a Phi_ib, n q i b a
    return batch.equilibrated + np.einsum("jab,nqiba->nqij", permutation, phi)


def _Permutations(dim: int) -> Array:
    """e_cij of 3 dimensions, (3, 3, 3), or e_ij of the plane, (1, 2, 2)."""
    if dim == 2:
        return np.array([[[0.0, 1.0], [-1.0, 0.0]]])
    e = np.zeros((3, 3, 3))
    for c in range(3):
        e[c, (c + 1) % 3, (c + 2) % 3], e[c, (c + 2) % 3, (c + 1) % 3] = 1, -1
    return e
