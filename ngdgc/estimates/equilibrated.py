"""A stress in equilibrium with the loads, from the numerical fluxes: explicit, no equation on any patch.

With s_h = C eps(u_h), sigma_hat n the numerical flux (`fluxes` module) and [u] the jump on the facets, u_h of the element minus
that beyond, which counts by its share, 1/2 between elements and 1 on Gamma_D and rollers, every row of s lies in RT_k (`piola`
module) and

    int_e s n.mu = int_e sigma_hat n.mu,        mu in F_h,
    int_K s:q = int_K s_h:q - theta sum_e share int_e [u].(C q n)        edge form
    int_K s:q = int_K (s_h + theta C r_0[u]):q                           lifting form

for all q whose rows are reference gradients of V_h.  With q = grad v this is B_h(u_h, v) = load: for all v in V_h(K)

    int_K div s.v = - int_K f_1.v,    s n continuous,    s n = -t_h on Gamma_C.

Source: for Poisson's equation Ainsworth, A posteriori error estimation for discontinuous Galerkin finite element approximation,
SIAM J. Numer. Anal. 45 (2007); Ern, Nicaise, Vohralik, C. R. Acad. Sci. Paris 345 (2007).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from ngsolve import GridFunction, specialcf

from ..blocks.integrals import ElementGroup, SymmetricBasis
from ..blocks.operators import FacetOperators
from ..blocks.reference import ReferenceElement
from ..contracts import Array
from ..data.coefficients import VectorsAt
from ..methods.lifting import WeakFacets
from .piola import Piola, PiolaElement

EXTRA = 2       # degrees of quadrature: squares of polynomials of degree k + 1 are exact


@dataclass(frozen=True)
class StressBatch:
    """n elements with q points: what was computed there.

    group : the elements;  points (n, q) of NGSolve;  weights (n, q) [length^d]
    computed s_h, equilibrated s (n, q, d, d) [stress];  divergence (n, q, d) of s [stress/length];  diameters (n,) [length]
    """

    group: ElementGroup
    points: Array
    weights: Array
    computed: Array
    equilibrated: Array
    divergence: Array
    diameters: Array

    @property
    def C(self) -> Array:
        """C_ijkl of these stresses, (n or 1, q or 1, d, d, d, d)."""
        return self.group.Stiffness()

    def Integral(self, density: Array) -> Array:
        """The integrals (n,) of values (n, q) over the elements."""
        return np.einsum("nq,nq->n", self.weights, density)

    def BodyForce(self, problem: Any) -> Array:
        """f_1 at the points, (n, q, d) [stress/length]."""
        if problem.bodyforce is None:
            return np.zeros_like(self.divergence)
        return VectorsAt(problem.bodyforce, self.points.ravel(), "bodyforce").reshape(self.divergence.shape)


class EquilibratedStress:
    """The equilibrated stress of a solution of a discontinuous method, in batches of elements."""

    def __init__(self, solution: Any) -> None:
        disc = solution.disc
        self.disc, self.form = disc, disc.facetform
        # Moments are taken with the quadrature of the form, for which alone u_h is in equilibrium; norms with a finer one.
        self.operators = self.form.operators
        share, rollers = WeakFacets(disc.problem, disc.facets)
        self._fine = FacetOperators(disc.problem.material, disc.facets, disc.order, disc.order, share, rollers, EXTRA)
        self._vector, gfu = solution.vector, solution.gfu
        # As the operators count: on a named interface `fluxes.Flux` may have turned the normal.
        turned = np.tile(np.repeat(disc.facets.interfaces.sign, self.operators.facetsizes), disc.mesh.dim)
        self._flux = solution.flux.vec.FV().NumPy() * turned
        self._theta = self.form.theta if self.form.consistent else 0
        self._jump: Any = self.form.Jump(gfu) if self._theta else None
        self._added: Any = None

    def With(self, added: Any) -> EquilibratedStress:
        """s and a CoefficientFunction (d d,) without divergence, and without traction off Gamma_D."""
        other = copy(self)
        other._added = added
        return other

    def Batches(self, Seen: Callable[[ElementGroup], ElementGroup | None] = lambda group: None) -> Iterator[StressBatch]:
        """All elements, each once.

        Seen : gives the elements of a group at other points than those of a quadrature for norms, or None for these
        """
        for number, (group, usual) in enumerate(zip(self.operators.groups, self._fine.groups)):
            fine = Seen(group) or usual
            signs = self.operators.Signs(number)
            lifted = self._Liftings(number) if self._theta and self.form.lifted else None
            points = fine.MeshPoints(self.disc.mesh, fine.reference)
            for rows, part in fine.Parts(12 * group.dim * group.dim * len(fine.reference.weights)):
                own = None if lifted is None else lifted[rows]
                yield self._Batch(group.Part(rows), part, points[rows], signs[rows], own)

    def _Batch(self, part: ElementGroup, fine: ElementGroup, points: Array, signs: Array, lifted: Array | None) -> StressBatch:
        """What is known of the elements of a part, at the points of the same elements `fine`."""
        reference = np.empty((*points.shape, part.dim, part.dim))       # n q i m
        divergence = np.empty((*points.shape, part.dim))
        pulled = self._Pulled(part, lifted)
        for (rows, shape), (_, other) in zip(part.rows, fine.rows):
            element = Piola(part.et, self.disc.order, shape, other)
            moments = [self._OnFacet(part, s, shape, rows, signs) for s in part.sides]
            inner = _Sum(pulled[rows], shape.weights, element.inner)
            if self._theta and lifted is None:
                for s in part.sides:
                    inner -= self._theta * self._Consistency(part, s, shape, rows, signs, element.inneron[s])
            known = np.concatenate([*moments, inner], axis=2)
            coefficients = self._Coefficients(element, part, rows, known)       # n i N
            reference[rows] = np.swapaxes(_Values(coefficients, element.values), 1, 2)
            divergence[rows] = np.swapaxes(coefficients @ element.divergences.T, 1, 2)
        G, volume = self._Plane(fine)
        equilibrated = reference @ np.swapaxes(np.linalg.inv(G), 2, 3) / volume[..., None, None]
        if self._added is not None:
            equilibrated += np.asarray(self._added(points.ravel())).reshape(equilibrated.shape)
        return self._Whole(fine, points, equilibrated, divergence / volume[..., None], self._Diameters(part))

    def _Whole(self, fine: Any, points: Array, equilibrated: Array, divergence: Array, diameters: Array) -> StressBatch:
        return StressBatch(fine, points, self._Measure(fine) * fine.reference.weights, self._Computed(fine), equilibrated,
                           divergence, diameters)

    def _Coefficients(self, element: PiolaElement, part: Any, rows: np.ndarray, moments: Array) -> Array:
        """Coefficients (n, i, N) of the elements with these rows from the moments (n, i, moments)."""
        return moments @ element.coefficients.T

    def _Plane(self, part: ElementGroup) -> tuple[Array, Array]:
        """(G, |det dF|) of the map from the reference element."""
        return part.Geometry()

    def _Measure(self, part: ElementGroup, number: int = 0) -> Array:
        """What integrals over the body have, of the element (0) or of side number - 1, (n, q or 1)."""
        return part.Boundary(number - 1)[1] if number else part.Geometry()[1]

    def _SideMeasure(self, part: ElementGroup, s: int) -> Array:
        """Of the facet itself, (n, q or 1)."""
        return part.Boundary(s)[1]

    def _Pulled(self, part: ElementGroup, lifted: Array | None) -> Array:
        """What is tested in the elements, by Piola's map on the reference element, (n, q, i, m)."""
        tested = self._Computed(part)
        if lifted is not None:
            tested = tested + self._theta * self._Lifted(part, lifted)
        return tested @ np.swapaxes(part.Geometry()[0], 2, 3) * self._Measure(part)[..., None, None]

    def _Diameters(self, part: ElementGroup) -> Array:
        vertices = self.disc.facets.vertices[part.elements]
        corners = self.disc.mesh.ngmesh.Coordinates()[vertices[:, :(vertices[0] >= 0).sum()]][..., :part.dim]   # n, corners, i
        return np.sqrt(np.square(corners[:, :, None] - corners[:, None]).sum(axis=3).max(axis=(1, 2)))

    def Traction(self, quadrature: Any) -> Array:
        """s n at the points of a BoundaryQuadrature on the boundary of the body, (m, d) [stress]."""
        dim = self.disc.mesh.dim
        jacobian = specialcf.JacobianMatrix(dim, dim - 1)(quadrature.points).reshape(-1, dim, dim - 1)
        measure = np.sqrt(np.linalg.det(np.swapaxes(jacobian, 1, 2) @ jacobian))
        return np.asarray(self._normal(quadrature.points)).reshape(-1, dim) / measure[:, None]

    @cached_property
    def _normal(self) -> Any:
        """s n measure on the boundary, a function of F_h on the reference facets."""
        function = GridFunction(self.operators.facetspace)
        values = function.vec.FV().NumPy()
        for number, group in enumerate(self.operators.groups):
            signs = self.operators.Signs(number)
            for s in group.sides:
                outer = self.disc.facets.neighbours[group.facets[:, s]] == 1
                for rows, shape in group.rows:
                    rows = rows[outer[rows]]
                    if len(rows):
                        facet = shape.facets[s]
                        mass = np.einsum("q,qb,qc->bc", facet.weights, facet.mu, facet.mu)
                        moments = self._OnFacet(group, s, shape, rows, signs) @ np.linalg.inv(mass)
                        values[self.operators.FacetDofs(group.facets[rows, s])] = moments.reshape(len(rows), -1)
        return function

    def _Computed(self, part: Any) -> Array:
        """C eps(u_h), (n, q, i, j)."""
        local = self._vector[self.operators.Dofs(part.elements[:, None])].reshape(len(part.elements), part.dim, -1)
        return Stress(part.Stiffness(), part.AtPoints(lambda shape: shape.dv, local) @ part.Geometry()[0])

    def _Liftings(self, number: int) -> Array:
        """r_0[u] of the elements of a group, coefficients in Q_h (n, c, p)."""
        group, operators = self.operators.groups[number], self.operators
        found = np.zeros((len(group.elements), len(group.basis), group.nl))
        for star in operators.Stars():
            if star.number == number:
                for lift, (_, facets, _) in zip(operators.Liftings(star), star.arms):
                    jump = self._jump[operators.FacetDofs(facets)]
                    found[star.rows] += (lift @ jump[..., None]).reshape(len(facets), *found.shape[1:])
        return found

    def _Lifted(self, part: ElementGroup, lifted: Array) -> Array:
        """C r_0[u], (n, q, i, j), from coefficients (n, c, p)."""
        values = part.AtPoints(lambda shape: shape.p[:, None], lifted)[..., 0]        # n q c
        return Stress(part.Stiffness(), np.einsum("nqc,cij->nqij", values, part.basis))

    def _OnFacet(self, part: Any, s: int, shape: ReferenceElement, rows: np.ndarray, signs: Array) -> Array:
        """Moments of the traction on side s, (n, i, b)."""
        facets = part.facets[rows, s]
        coefficients = self._flux[self.operators.FacetDofs(facets)].reshape(len(rows), part.dim, -1)
        facet, measure = shape.facets[s], self._SideMeasure(part, s)
        mass = np.einsum("nq,qb,qc->nbc", measure[rows] * facet.weights, facet.mu, facet.mu, optimize=True)
        return signs[rows, s, None, None] * (coefficients @ mass)

    def _Consistency(self, part: ElementGroup, s: int, shape: ReferenceElement, rows: np.ndarray, signs: Array,
                     inner: Array) -> Array:
        """share int_e [u].(C q n), (n, i, I)."""
        facet, jump = shape.facets[s], self._SideJump(part, s, shape, rows, signs)
        normal, measure = part.Boundary(s)[0], self._Measure(part, 1 + s)
        G, _ = part.Geometry(1 + s)
        C = part.Stiffness(1 + s)
        stress = Stress(C[rows] if len(C) > 1 else C, jump[..., :, None] * normal[rows][..., None, :])
        pulled = stress @ np.swapaxes(G[rows], 2, 3) * measure[rows][..., None, None]
        return _Sum(pulled, facet.weights, inner)

    def _SideJump(self, part: Any, s: int, shape: ReferenceElement, rows: np.ndarray, signs: Array) -> Array:
        """share [u] on side s, (n, q, i)."""
        facets = part.facets[rows, s]
        jump = self._jump[self.operators.FacetDofs(facets)].reshape(len(rows), part.dim, -1)
        share = (self.operators.share[facets] * signs[rows, s])[:, None, None]
        return np.asarray(np.swapaxes(jump @ shape.facets[s].mu.T, 1, 2) * share)


def Stress(C: Array, gradient: Array) -> Array:
    """C_ijkl g_kl, (n, q, i, j), for C (n or 1, q or 1, i, j, k, l)."""
    d = gradient.shape[-1]
    matrix = C.reshape(*C.shape[:2], d * d, d * d)
    flat = gradient.reshape(*gradient.shape[:2], d * d)
    if matrix.shape[:2] == (1, 1):
        return (flat.reshape(-1, d * d) @ matrix[0, 0].T).reshape(gradient.shape)
    return np.einsum("nqxy,nqy->nqx", np.broadcast_to(matrix, (*flat.shape[:2], d * d, d * d)), flat).reshape(gradient.shape)


def Complementary(C: Array, stress: Array) -> Array:
    """C^-1 s:s, (n, q), of symmetric s (n, q, d, d)."""
    basis = SymmetricBasis(stress.shape[-1])
    basis = basis / np.sqrt(np.square(basis).sum(axis=(1, 2)))[:, None, None]      # orthonormal
    inverse = np.linalg.inv(np.einsum("cij,nqijkl,dkl->nqcd", basis, C, basis, optimize=True))
    components = np.einsum("nqij,cij->nqc", stress, basis, optimize=True)
    return np.einsum("nqc,nqc->nq", components @ inverse[0, 0] if inverse.shape[:2] == (1, 1)
                     else (inverse @ components[..., None])[..., 0], components)


def _Sum(values: Array, weights: Array, functions: Array) -> Array:
    """sum_q w_q values[n, q, i, m] functions[q, m, I] -> (n, i, I)."""
    n, q, i, m = values.shape
    weighted = (weights[:, None, None] * functions).reshape(q * m, -1)
    return (values.transpose(0, 2, 1, 3).reshape(n * i, q * m) @ weighted).reshape(n, i, -1)


def _Values(coefficients: Array, functions: Array) -> Array:
    """sum_N coefficients[n, i, N] functions[q, m, N] -> (n, i, q, m)."""
    (n, i, N), (q, m, _) = coefficients.shape, functions.shape
    return (coefficients.reshape(n * i, N) @ functions.reshape(q * m, N).T).reshape(n, i, q, m)
