"""Shape functions at the quadrature points of a reference element, evaluated by NGSolve on a mesh of one element.

NGSolve's functions depend on the element type and on the order of its global vertex numbers, and on nothing else; elements that
share both share these arrays.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from netgen.meshing import Element1D, Element2D
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import BND, ET, L2, VOL, ElementId, FacetFESpace, IntegrationRule, Mesh

from ..contracts import Array
from ..mesh.facets import REFERENCE_VERTICES
from ..mesh.quadrature import ReferenceNormal, VertexFunctions

# Vertices of the facets of an element type, in any order.
FACETS: dict[ET, list[tuple[int, ...]]] = {
    ET.TRIG: [(0, 1), (1, 2), (2, 0)],
    ET.QUAD: [(0, 1), (1, 2), (2, 3), (3, 0)],
    ET.TET: [(1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2)],
    ET.HEX: [(0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (3, 2, 6, 7), (0, 3, 7, 4)],
    ET.PRISM: [(0, 1, 2), (3, 4, 5), (0, 3, 5, 2), (0, 3, 4, 1), (1, 4, 5, 2)],
    ET.PYRAMID: [(0, 1, 2, 3), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
}


@dataclass(frozen=True)
class FacetShapes:
    """On one facet of the reference element, with q points.

    points (q, 3), weights (q,); normal (m,), outward, as long as the facet's measure over that of the weights' domain;
    v (q, a), dv (q, m, a) shape functions of V_h and their reference gradients; p (q, p) of Q_h; mu (q, b) of F_h
    """

    points: np.ndarray
    weights: np.ndarray
    normal: np.ndarray
    v: np.ndarray
    dv: np.ndarray
    p: np.ndarray
    mu: np.ndarray


class ReferenceElement:
    """Scalar shape functions of V_h (order k), Q_h (order l) and F_h (order k) on a reference element.

    et : element type;  rank : order of its global vertex numbers, a permutation of 0, 1, ...
    points (q, 3), weights (q,), v (q, a), dv (q, m, a), p (q, p);  facets : FacetShapes in NGSolve's local order
    constant : True if all gradients are constant;  mesh : NGSolve's mesh of one element
    """

    def __init__(self, et: ET, rank: np.ndarray, order: int, liftorder: int, bonus: int) -> None:
        self.dim = 2 if et in (ET.TRIG, ET.QUAD) else 3
        self._vertices = np.array(REFERENCE_VERTICES[et], dtype=float).reshape(len(rank), -1)
        self.mesh = mesh = self._Mesh(et, rank)
        degree = 2 * max(order, liftorder) + bonus
        rule = IntegrationRule(et, degree)
        self.points, self.weights = _Points(rule)
        spaces = L2(mesh, order=order), L2(mesh, order=liftorder)
        v, p = (space.GetFE(ElementId(VOL, 0)) for space in spaces)
        self.v, self.dv, self.p = Values(v, self.points), Gradients(v, self.points, self.dim), Values(p, self.points)
        traces = FacetFESpace(mesh, order=order)
        numbers = [facet.nr for facet in mesh[ElementId(VOL, 0)].facets]
        facets = {}
        for element in mesh.Elements(BND):
            slot = numbers.index((element.edges if self.dim == 2 else element.faces)[0].nr)
            facets[slot] = self._Facet(element, rank, degree, v, p, traces.GetFE(ElementId(BND, element.nr)))
        self.facets = [facets[slot] for slot in range(len(numbers))]
        gradients = np.concatenate([self.dv, *(facet.dv for facet in self.facets)])
        self.constant = bool(np.ptp(gradients, axis=0).max() <= 1e-14 * np.abs(gradients).max())

    def _Mesh(self, et: ET, rank: np.ndarray) -> Mesh:
        mesh = NetgenMesh()
        mesh.dim = self.dim
        points = np.zeros((len(rank), 3))
        points[rank, :self._vertices.shape[1]] = self._vertices
        mesh.AddPoints(points)
        cell, side = mesh.AddRegion("cell", dim=self.dim), mesh.AddRegion("side", dim=self.dim - 1)
        mesh.AddElements(dim=self.dim, index=cell, data=np.array([rank], dtype=np.int32), base=0)
        for corners in FACETS[et]:
            # One by one: in NGSolve 6.2.2604 edges that AddElements brings have no region.
            vertices = (rank[list(corners)] + 1).tolist()
            mesh.Add({2: Element1D, 3: Element2D}[self.dim](index=side, vertices=vertices))
        return Mesh(mesh)

    def _Facet(self, element: Any, rank: np.ndarray, degree: int, v: Any, p: Any, mu: Any) -> FacetShapes:
        rule = IntegrationRule(element.type, degree)
        points, weights = _Points(rule)
        corners = self._vertices[[list(rank).index(vertex.nr) for vertex in element.vertices]]
        inside = VertexFunctions(element.type, points[:, 0], points[:, 1]) @ corners
        inside = np.pad(inside, ((0, 0), (0, 3 - inside.shape[1])))
        return FacetShapes(inside, weights, ReferenceNormal(corners, self._vertices.mean(axis=0), self.dim), Values(v, inside),
                           Gradients(v, inside, self.dim), Values(p, inside), Values(mu, points))


Shapes = ReferenceElement | FacetShapes


@lru_cache(maxsize=256)
def Reference(et: ET, rank: tuple[int, ...], order: int, liftorder: int, bonus: int) -> ReferenceElement:
    """The ReferenceElement of these arguments, `rank` as a tuple; made once."""
    return ReferenceElement(et, np.array(rank), order, liftorder, bonus)


def _Points(rule: IntegrationRule) -> tuple[Array, Array]:
    points = np.array(rule.points, dtype=float).reshape(len(rule.weights), -1)
    return np.pad(points, ((0, 0), (0, 3 - points.shape[1]))), np.array(rule.weights)


def Values(element: Any, points: Array) -> Array:
    """(q, functions)"""
    return np.array([np.array(element.CalcShape(*map(float, point))) for point in points])


def Gradients(element: Any, points: Array, dim: int) -> Array:
    """(q, m, functions)"""
    values = [np.array(element.CalcDShape(*map(float, point))).reshape(element.ndof, dim).T for point in points]
    return np.array(values)
