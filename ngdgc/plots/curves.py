"""Boundary regions of a plane mesh as curves, and outlines of its elements: what the figures are drawn from."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from ngsolve import BND, QUAD, SEGM, TRIG, VOL, ElementId, IntegrationRule, Region, specialcf

from ..contact.directions import Unit
from ..contracts import Array
from ..data.coefficients import VectorsAt
from ..data.inside import OnBoundary
from ..discrete.problem import DiscreteProblem
from ..mesh.facets import REFERENCE_VERTICES, Coordinates
from ..problem.foundation import Foundation

GAP = 1.1   # pieces of Gamma_C follow each other in a plot at this multiple of their length


@dataclass(frozen=True)
class Curve:
    """A connected piece of the outer boundary, passed with the body on its left; or of a joint, with its first side there.

    points : NGSolve mesh points on it;  coordinates, normals : (n, 2), outward;  s : arc length (n,) [length]
    region : NGSolve's Region that it is a piece of
    """

    points: np.ndarray
    coordinates: np.ndarray
    normals: np.ndarray
    region: Region

    @property
    def s(self) -> Array:
        return np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(self.coordinates, axis=0), axis=1))])

    @property
    def closed(self) -> bool:
        return np.allclose(self.coordinates[0], self.coordinates[-1], rtol=0, atol=1e-9 * self.s[-1])

    def Spaced(self, distance: float, *arrays: Array) -> list[Array]:
        """Coordinates, normals and further arrays (n, m) at the middles of equal parts of about this length [length]."""
        s = self.s
        number = max(round(s[-1] / distance), 1)
        at = (np.arange(number) + 0.5) * s[-1] / number
        return [np.stack([np.interp(at, s, column) for column in np.transpose(array)], axis=1)
                for array in (self.coordinates, self.normals, *arrays)]


def Curves(disc: DiscreteProblem, region: str) -> list[Curve]:
    """The `Curve`s of a boundary region, of its outer part if it has one, curved edges and edges of order > 1 subdivided."""
    mesh, facets = disc.mesh, disc.facets
    outer = facets.On(region) & (facets.neighbours == 1) & ~facets.cut
    wanted = outer if outer.any() else facets.On(region) & facets.cut & ~facets.beyond
    second = (facets.neighbours > 1) & (facets.interfaces.sign < 0)
    number = Intervals(disc) + 1
    rule = IntegrationRule(points=[(t,) for t in np.linspace(0, 1, number)], weights=[1] * number)
    boundary = mesh.Boundaries(region)
    points = mesh.MapToAllElements({SEGM: rule}, boundary).reshape(-1, number)
    coordinates = np.asarray(Coordinates(2)(points.ravel())).reshape(-1, number, 2)
    normals = np.asarray(OnBoundary(specialcf.normal(2), boundary, "normal")(points.ravel())).reshape(-1, number, 2)
    vertices = mesh.ngmesh.Coordinates()
    following: dict[int, list[Any]] = {}
    edge: Sequence[Any]
    for edge in zip(points, coordinates, normals):
        element = mesh[ElementId(BND, int(edge[0]["nr"][0]))]
        facet = facets.space.GetDofNrs(element)[0]
        if not wanted[facet]:
            continue
        ends = [vertex.nr for vertex in element.vertices][::-1]
        neighbour = mesh[ElementId(VOL, int(facets.incidence.indices[facets.incidence.indptr[facet] + second[facet]]))]
        inner = vertices[[vertex.nr for vertex in neighbour.vertices]].mean(axis=0)[:2] - edge[1].mean(axis=0)
        if inner @ Left(edge[1][-1] - edge[1][0]) < 0:
            ends, edge = ends[::-1], [array[::-1] for array in edge]
        if facets.cut[facet] and np.sum(edge[2] @ Left(edge[1][-1] - edge[1][0])) > 0:      # the normal of the second side
            edge = edge[0], edge[1], -edge[2]
        following.setdefault(ends[0], []).append((ends[1], edge))
    return [Curve(*[np.concatenate(arrays) for arrays in zip(*edges)], boundary)    # type: ignore[call-arg]
            for edges in _Chains(following)]


def FoundationCurves(disc: DiscreteProblem, foundation: Foundation) -> list[Curve]:
    """The `Curve`s of a foundation; `normals` are those along which its law acts."""
    found = Curves(disc, foundation.boundary)
    if foundation.normal is None:
        return found
    return [replace(curve, normals=Unit(VectorsAt(foundation.normal, curve.points, "normal", curve.region))) for curve in found]


def Along(disc: DiscreteProblem, region: str) -> Iterator[tuple[Array, Any, Curve]]:
    """(s, numbers of the contact points, curve) sorted along each piece of a foundation; pieces follow each other in s."""
    contact, start = disc.contact, 0.0
    for curve in Curves(disc, region):
        s = np.full(len(contact.weights), np.nan)
        for facet in np.unique(curve.points["nr"]):
            edge = curve.points["nr"] == facet
            mine = contact.members[contact.boundaryelements == facet]
            chord = curve.coordinates[edge][-1] - curve.coordinates[edge][0]
            s[mine] = np.interp(contact.coordinates[mine] @ chord, curve.coordinates[edge] @ chord, curve.s[edge])
        numbers = np.argsort(s)[:np.sum(~np.isnan(s))]
        yield start + s[numbers], numbers, curve
        start += GAP * curve.s[-1]


def _Chains(following: dict[int, list[Any]]) -> Iterator[list[Any]]:
    """Edges {start: [(end, edge)]} joined into lists, first those that begin somewhere, then closed ones."""
    ends = {end for edges in following.values() for end, _ in edges}
    for vertex in sorted(following, key=lambda start: start in ends):
        chain = []
        while following.get(vertex):
            vertex, edge = following[vertex].pop()
            chain.append(edge)
        if chain:
            yield chain


def Left(vectors: Array) -> Array:
    return np.stack([-vectors[..., 1], vectors[..., 0]], axis=-1)


def Literal(name: str) -> str:
    """The regular expression that matches this name only."""
    return "".join(character if character.isalnum() or character == "_" else f"[{character}]" for character in name)


def Intervals(disc: DiscreteProblem) -> int:
    degree = max(disc.order, disc.mesh.GetCurveOrder())
    return 1 if degree == 1 else 2 * degree + 2


def ElementOutlines(disc: DiscreteProblem) -> Any:
    """Mesh points around every element."""
    number, rules = Intervals(disc), {}
    for et in (TRIG, QUAD):
        corners = np.array(REFERENCE_VERTICES[et], float)[:, None]
        t = np.linspace(0, 1, number, endpoint=False)[:, None]
        outline = (corners + t * (np.roll(corners, -1, axis=0) - corners)).reshape(-1, 3)
        rules[et] = IntegrationRule(points=[tuple(point[:2]) for point in outline], weights=[1] * len(outline))
    return disc.mesh.MapToAllElements(rules, VOL)


def SplitByElement(points: Any, values: Array) -> list[Array]:
    """Values at mesh points, element by element."""
    return np.split(values, np.flatnonzero(np.diff(points["nr"])) + 1)


def OutlinePoints(disc: DiscreteProblem) -> Array:
    return np.concatenate([curve.coordinates for curve in Curves(disc, ".*")])
