"""Gamma_C on a finer space, linearised at a computed solution, such that stiff laws and stick lock nothing.

With s(u) = -C eps(u) n, q = s(u) + gamma u and t(q) the traction of the graph of the law (`contact.graph`), every solution of
the contact problem obeys, in Nitsche's symmetric form (Chouly, Hild, Renard 2015),

    a(u, v) - int_GammaC s(u).s(v)/gamma + int_GammaC t(q(u)).(s(v) + gamma v)/gamma = (f, v).

The law holds weakly, at as many points as a quadrature wants: u_t = 0 at more points than there are traces, or on one part of a
facet, would make u_t vanish on all of it.  For gamma large enough the form is stable; its derivative is symmetric if dt/dq is.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import CF, VOL, ElementId, GridFunction, Integrate, specialcf

from ..contact.boundary import ContactBoundary
from ..contact.graph import ContactGraph
from ..contracts import Array
from ..discrete.problem import DiscreteProblem
from ..mesh.pieces import Pieces
from ..problem.materials import Strain, StiffnessAt
from ..tools import sparse as sp
from .zoneends import Levels, ZonePieces

DEGREE = {2: 12, 3: 4}      # of the quadrature, beyond 2 k, by dimension: between its points zones end
STABLE = 5          # gamma over C_nnnn k^2 |e|/|K|


class LinearisedContact:
    """The terms of Gamma_C above and their derivative at a function of V_h.

    fine : DiscreteProblem;  vector : coefficients (ndof,)

    Attributes
    ----------
    contact : its ContactBoundary, whose quadrature is divided where zones end;  graph : ContactGraph with the scale gamma
    stress, traction : s(u) and t(q(u)) at its points (n, d);  slope : dt/dq (n, d, d)
    tractions : sparse ((n i), ndof), that maps coefficients to s
    """

    def __init__(self, fine: DiscreteProblem, vector: Array) -> None:
        self.fine = fine
        function = GridFunction(fine.space)
        function.vec.FV().NumPy()[:] = vector
        computed = fine.problem.material.Stress(Strain(function))
        degree, pieces = 2 * fine.order + DEGREE[fine.mesh.dim], None
        graph, stress, q = self._Coordinates(vector, computed, degree, pieces)
        if pieces := ZonePieces(fine.facets, graph.contact, Levels(graph, q), degree):
            graph, stress, q = self._Coordinates(vector, computed, degree, pieces)
        point = graph.At(q)
        self.graph, self.contact, self.stress = graph, graph.contact, stress
        self.traction, self.slope = point.traction, point.derivative
        self.tractions = TractionMatrix(fine, self.contact)

    def _Coordinates(self, vector: Array, computed: Any, degree: int,
                     pieces: Pieces | None) -> tuple[ContactGraph, Array, Array]:
        """(graph, s(u), q) on a quadrature."""
        fine = self.fine
        scalar = fine.method.ScalarSpace(fine.mesh, fine.order)
        contact = ContactBoundary(fine.problem, fine.facets, fine.space, scalar, degree, pieces)
        n, inside = contact.outward, contact.inside
        C = StiffnessAt(fine.problem.material, inside, contact.dim)
        volumes = Integrate(CF(1), fine.mesh, VOL, element_wise=True).NumPy()[inside["nr"]]
        graph = ContactGraph(contact, STABLE * fine.order ** 2 * contact.measures / volumes
                             * np.einsum("ni,nj,nijkl,nk,nl->n", n, n, C, n, n))
        stress = -np.einsum("nij,nj->ni", np.asarray(computed(inside)).reshape(-1, contact.dim, contact.dim), n)
        return graph, stress, graph.Coordinates(contact.Displacement(vector), stress)

    def _Sum(self, values: Array) -> Any:
        """The sparse matrix of w/gamma values (n, d, d) at the points."""
        n, dim = self.contact.normals.shape
        weighted = (self.contact.weights / self.graph.scale)[:, None, None] * values
        return sp.bsr_matrix((weighted, np.arange(n), np.arange(n + 1)), shape=(n * dim, n * dim)).tocsr()

    @property
    def coordinates(self) -> Any:
        """The sparse matrix that maps coefficients to q."""
        return self.tractions + sp.diags(np.repeat(self.graph.scale, self.contact.dim)) @ self.contact.trace

    def Matrix(self) -> Any:
        """The derivative of the terms, sparse (ndof, ndof)."""
        q, unit = self.coordinates, np.broadcast_to(np.eye(self.contact.dim), self.slope.shape)
        return q.T @ self._Sum(self.slope) @ q - self.tractions.T @ self._Sum(unit) @ self.tractions

    def Derivative(self, weights: Array) -> Array:
        """The derivative of int_GammaC t(q(u)).j at coefficients, (ndof,), for j at the points (n, d)."""
        pulled = self.contact.weights[:, None] * np.einsum("nij,ni->nj", self.slope, weights)
        return self.coordinates.T @ pulled.ravel()

    def Parts(self, vector: Array) -> Array:
        """What the points contribute to int s(u).s(v)/gamma - t(q(u)).(s(v) + gamma v)/gamma, (n,), v by coefficients."""
        contact, scale = self.contact, self.graph.scale
        stress = (self.tractions @ vector).reshape(self.stress.shape)
        parts = (self.stress - self.traction) * stress / scale[:, None] - self.traction * contact.Displacement(vector)
        return contact.weights * parts.sum(axis=1)


def TractionMatrix(fine: DiscreteProblem, contact: ContactBoundary) -> Any:
    """The sparse matrix that maps coefficients in V_h to s(u) = -C eps(u) n at contact points, row n d + i for component i."""
    dim, inside, space = contact.dim, contact.inside, fine.space
    scalar = fine.method.ScalarSpace(fine.mesh, fine.order)
    C = StiffnessAt(fine.problem.material, inside, dim)
    mapping = np.linalg.inv(np.asarray(specialcf.JacobianMatrix(dim, dim)(inside)).reshape(-1, dim, dim))   # dxi_m/dx_l
    onreference = -np.einsum("nj,nijkl,nml->nikm", contact.outward, C, mapping)
    rows, columns, entries, last = [], [], [], None
    for number, (x, y, z, element) in enumerate(zip(inside["x"], inside["y"], inside["z"], inside["nr"])):
        if element != last:
            here, last = ElementId(VOL, int(element)), element
            function, dofs = scalar.GetFE(here), np.array(space.GetDofNrs(here))
        shape = np.array(function.CalcDShape(x, y, z)).reshape(-1, dim)
        for i in range(dim):
            rows.append(np.full(len(dofs), number * dim + i))
            columns.append(dofs)
            entries.append((onreference[number, i] @ shape.T).ravel())
    return sp.csr_matrix((np.concatenate(entries), (np.concatenate(rows), np.concatenate(columns))),
                         shape=(len(inside) * dim, space.ndof))
