"""Quadrature on boundary regions, with outward normals and the points in the elements inside."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from ngsolve import ET, QUAD, SEGM, TRIG, IntegrationRule, specialcf

from ..contracts import Array, Method
from ..exceptions import ProblemError
from .checks import Sides
from .facets import REFERENCE_VERTICES, TYPES, Coordinates, Facets
from .pieces import Divided, Pieces

SAME = 1e-9     # distance of two points that are one, relative to the largest coordinate


@dataclass(frozen=True)
class BoundaryQuadrature:
    """Points of a quadrature rule on a boundary region, n points in d dimensions.

    `points` are NGSolve mesh points on the boundary and `inside` the same points in the adjacent volume elements;
    `coordinates` (n, i), `normals` (n, i) outward, `weights` (n,) contain the surface measure of the body; `elements` (n,) is
    the number of the adjacent volume element, `boundaryelements` (n,) of the boundary element.
    """

    points: np.ndarray
    inside: np.ndarray
    coordinates: np.ndarray
    normals: np.ndarray
    weights: np.ndarray

    @property
    def elements(self) -> np.ndarray:
        return self.inside["nr"]

    @property
    def boundaryelements(self) -> np.ndarray:
        return self.points["nr"]

    @classmethod
    def On(cls, facets: Facets, region: str, rules: Any, *, side: Any = 0, pieces: Pieces | None = None) -> BoundaryQuadrature:
        """The quadrature by `rules`: {boundary element type: IntegrationRule}, or the degree of NGSolve's rules.

        side : of two elements at a facet inside the body 0 takes the one with the smaller number as adjacent, 1 the other;
            one for all, or one for each facet
        pieces : {number of a boundary element: its parts}, on each of which the rule is applied; the other ones are whole

        Every side of an element counts once, however often the mesh has it; boundary elements that are none do not count.
        Raises ProblemError for boundary elements that are curved otherwise than the elements.
        """
        dim = facets.mesh.dim
        points, shares = _Applied(facets, region, rules, pieces)                # n; the q points of an element in a row
        jacobian = specialcf.JacobianMatrix(dim, dim - 1)(points).reshape(len(points), dim, dim - 1)        # n i m
        measure = np.sqrt(np.linalg.det(np.swapaxes(jacobian, 1, 2) @ jacobian))                            # n
        weights, inside, normals = measure * shares, points.copy(), np.empty((len(points), dim))
        inside["VorB"] = 0
        starts = np.flatnonzero(np.diff(points["nr"], prepend=-1))              # e: first points of the boundary elements
        facet, _, vertices = (array[points["nr"][starts]] for array in facets.boundary)
        chosen = np.minimum(side if np.ndim(side) == 0 else side[facet], facets.neighbours[facet] - 1)
        volumes = facets.incidence.indices[facets.incidence.indptr[facet] + chosen]
        around = facets.vertices[volumes]           # vertices of the elements inside, (e, most); `vertices` those of the sides
        # Number of each corner among the vertices of the element inside, and how many vertices that has: few combinations.
        corner = np.where(vertices >= 0, (vertices[:, :, None] == around[:, None]).argmax(axis=2), -1)
        kinds, kind = np.unique(np.column_stack([corner, (around >= 0).sum(axis=1)]), axis=0, return_inverse=True)
        kind, volumes = (np.repeat(array.ravel(), np.diff(starts, append=len(points))) for array in (kind, volumes))
        for number, (*local, count) in enumerate(kinds):
            here = np.flatnonzero(kind == number)
            et = TYPES[dim - 1][sum(one >= 0 for one in local)]
            reference = np.array(REFERENCE_VERTICES[TYPES[dim][count]], dtype=float)
            corners = reference[[one for one in local if one >= 0]]
            normals[here] = ReferenceNormal(corners, reference.mean(axis=0), dim)
            inside["nr"][here] = volumes[here]
            at = VertexFunctions(et, points["x"][here], points["y"][here]) @ corners
            for axis, values in zip("xyz", at.T):
                inside[axis][here] = values
        # NGSolve's normal at boundary points follows the orientation of the boundary element, which may point into the body
        # (holes, mirrored meshes); the reference normal of the adjacent element, mapped as a covector, always points outward.
        mapping = specialcf.JacobianMatrix(dim, dim)(inside).reshape(-1, dim, dim)      # n i m
        normals = np.linalg.solve(np.swapaxes(mapping, 1, 2), normals[..., None])[..., 0]
        coordinates, beside = (np.asarray(Coordinates(dim)(at)).reshape(-1, dim) for at in (points, inside))
        apart = np.abs(coordinates - beside).max(initial=0)
        if apart > SAME * np.abs(coordinates).max(initial=0):
            raise ProblemError(f"boundary elements of region {region!r} lie up to {apart:.3g} off the sides of their elements; "
                               "both must have the same points in the middle of edges: make the mesh again, or take Curve")
        trapezoidal = isinstance(rules, dict) and dim == 2 and len(rules[SEGM]) == 2
        weights = facets.frame.Weights(weights, coordinates, trapezoidal)
        return cls(points=points, inside=inside, weights=weights, coordinates=coordinates,
                   normals=normals / np.linalg.norm(normals, axis=1)[:, None])

    def At(self, rows: np.ndarray) -> BoundaryQuadrature:
        """The points of these numbers, in their order."""
        return BoundaryQuadrature(points=self.points[rows], inside=self.inside[rows], coordinates=self.coordinates[rows],
                                  normals=self.normals[rows], weights=self.weights[rows])


def _Applied(facets: Facets, region: str, rules: Any, pieces: Pieces | None) -> tuple[Any, Array]:
    """Mesh points on the boundary elements of a region and their weights on the reference elements, (n,), by rules."""
    mesh, dim = facets.mesh, facets.mesh.dim
    rules = {et: rules[et] if isinstance(rules, dict) else IntegrationRule(et, rules) for et in TYPES[dim - 1].values()}
    points = mesh.MapToAllElements(rules, mesh.Boundaries(region))
    points = points[Sides(facets, region)[points["nr"]]]
    corners, weights = (facets.boundary[2][points["nr"]] >= 0).sum(axis=1), np.empty(len(points))
    for count in np.unique(corners):
        here, rule = corners == count, rules[TYPES[dim - 1][count]]
        weights[here] = np.tile(rule.weights, here.sum() // len(rule))
    return Divided(points, weights, pieces) if pieces else (points, weights)


def NodalRules(order: int) -> dict[ET, IntegrationRule]:
    """Rules for traces of continuous functions of degree k, {boundary element type: IntegrationRule}.

    On edges and quadrilaterals Gauss-Lobatto's k + 1 points in each direction, of degree 2 k - 1; on triangles the vertices for
    k = 1 and NGSolve's rule of degree 2 k - 2 else, which for k = 2 are the midpoints of the edges.
    """
    legendre = np.polynomial.legendre.Legendre.basis(order)
    nodes = np.concatenate([[-1], legendre.deriv().roots(), [1]])
    weights = 1 / (order * (order + 1) * legendre(nodes) ** 2)
    nodes = (1 + nodes) / 2
    vertices = IntegrationRule([(0, 0), (1, 0), (0, 1)], [1 / 6] * 3)
    return {SEGM: IntegrationRule([(s,) for s in nodes], weights.tolist()),
            QUAD: IntegrationRule([(s, t) for s in nodes for t in nodes], np.outer(weights, weights).ravel().tolist()),
            TRIG: vertices if order == 1 else IntegrationRule(TRIG, 2 * order - 2)}


def ReferenceNormal(corners: Array, centre: Array, dim: int) -> Array:
    """Normal of a facet of the reference element, (dim,), pointing away from its centre; any length."""
    edges = (corners - corners[0])[1:, :dim]
    normal = np.array([edges[0][1], -edges[0][0]]) if dim == 2 else np.cross(edges[0], edges[1])
    return normal * np.sign(normal @ (corners[0] - centre)[:dim])


def VertexFunctions(et: ET, s: Array, t: Array) -> Array:
    """Values of the vertex functions of a facet's reference element, (points, vertices)."""
    if et == ET.SEGM:
        return np.stack([s, 1 - s], axis=1)
    if et == ET.TRIG:
        return np.stack([s, t, 1 - s - t], axis=1)
    return np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t], axis=1)


def ContactRules(method: Method, dim: int, order: int) -> dict[ET, IntegrationRule] | int:
    """Rules of the quadrature on Gamma_C, as for `BoundaryQuadrature.On`.

    With more points than traces u_t = 0 at the points of a sticking facet would over-determine u, and t not be unique.  Fewer
    suffice, but Gauss' k points on edges of conforming elements do not: tractions of alternating sign would
    hardly load any node, and S have eigenvalues of O(h^3) where O(h) is natural.
    """
    if not method.discontinuous:
        return NodalRules(order)
    # NGSolve's rule of degree 6 for triangles has 12 points for 10 traces.
    return 2 * order if dim == 2 or order != 3 else 2 * order - 2
