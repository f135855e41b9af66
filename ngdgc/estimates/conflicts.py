"""Prescribed displacements that contradict each other where their regions meet: no displacement of finite energy has both."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
from ngsolve import ET, IntegrationRule

from ..contracts import Array
from ..data.coefficients import VectorsAt
from ..mesh.facets import REFERENCE_VERTICES, TYPES, Coordinates

APART = 1e-6        # of values, relative to the largest one


def Conflict(disc: Any) -> str:
    """Words for the two regions whose values differ most at a vertex that both have; none if all agree."""
    found = [_AtVertices(disc, region, value) for region, value in disc.problem.dirichlet.items()]
    largest = max((np.abs(values).max(initial=0) for _, values in found), default=0.0)
    worst, words = APART * largest, ""
    for (one, (places, values)), (other, (others, theirs)) in combinations(zip(disc.problem.dirichlet, found), 2):
        _, first, second = np.intersect1d(places, others, return_indices=True)
        apart = np.linalg.norm(values[first] - theirs[second], axis=1)
        if apart.max(initial=0) > worst:
            worst = apart.max()
            at = disc.mesh.ngmesh.Coordinates()[places[first[apart.argmax()]], :disc.mesh.dim]
            place = ", ".join(f"{x:.4g}" for x in at)
            words = f"the displacements of {one!r} and {other!r} differ by {worst:.3g} at ({place}), where they meet"
    return words


def _AtVertices(disc: Any, region: str, value: Any) -> tuple[np.ndarray, Array]:
    """The vertices (n,) of a region, each once, and the values (n, d) there."""
    mesh, vertices = disc.mesh, disc.facets.boundary[2]
    corners = {et: [(0,), (1,)] if et == ET.SEGM else [vertex[:2] for vertex in REFERENCE_VERTICES[et]]
               for et in TYPES[mesh.dim - 1].values()}
    rules = {et: IntegrationRule(places, [1.0] * len(places)) for et, places in corners.items()}
    boundary = mesh.Boundaries(region)
    points = mesh.MapToAllElements(rules, boundary)
    # Which vertex of its element a point is the coordinates tell.  In place of a fourth vertex stands -1, the last of the mesh,
    # behind the vertices of its own.
    places, own = np.asarray(Coordinates(mesh.dim)(points)).reshape(-1, 1, mesh.dim), vertices[points["nr"]]
    away = np.linalg.norm(mesh.ngmesh.Coordinates()[own, :mesh.dim] - places, axis=2)
    own = own[np.arange(len(own)), away.argmin(axis=1)]
    own, first = np.unique(own, return_index=True)
    return own, VectorsAt(value, points, f"dirichlet[{region!r}]", boundary)[first]
