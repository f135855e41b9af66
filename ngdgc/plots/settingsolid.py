"""The setting of a problem in space: sides in colours of what acts on them, with values, loads and motions as arrows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from ngsolve import QUAD, TRIG, IntegrationRule

from ..contracts import Array
from ..data.coefficients import EntriesAt, ValuesAt, VectorsAt
from ..discrete.problem import DiscreteProblem
from ..mesh.facets import VolumePoints
from .canvas import BLUE, GREEN, PURPLE, RED, VERMILION
from .curves import Literal
from .regions import SurfaceFaces
from .surface import BODY, VIEWS, Surface, Towards
from .words import Prescribed, Span

KINDS = {"dirichlet": "#888888", "roller": GREEN, "traction": BLUE, "force": BLUE, "spring": PURPLE, "foundation": RED,
         "free": BODY}
ARROW = 0.2         # length of the longest arrow, relative to the body
FEW = 12            # arrows of a side, about
MIDDLES = {TRIG: IntegrationRule([(1 / 3, 1 / 3)], [0.5]), QUAD: IntegrationRule([(0.5, 0.5)], [1.0])}
CORNERS = {TRIG: IntegrationRule([(0, 0), (1, 0), (0, 1)], [1.0] * 3),
           QUAD: IntegrationRule([(0, 0), (1, 0), (1, 1), (0, 1)], [1.0] * 4)}


def SettingSurface(disc: DiscreteProblem, view: Sequence[float] | None) -> Figure:
    """The boundary of the undeformed body in colours of what acts on it; tractions and prescribed motions as arrows."""
    mesh, problem, surface = disc.mesh, disc.problem, SurfaceFaces(disc)
    roles: dict[str, tuple[str, str]] = {}
    for kind, region in problem.Regions():
        roles |= {name: (kind, region) for name, found in zip(mesh.GetBoundaries(), mesh.Boundaries(region).Mask()) if found}
    shown = dict.fromkeys(surface.regions.tolist())
    words = {name: f"{name}\n" + (Prescribed(roles[name][0], _Values(disc, CORNERS, name, *roles[name])[1]) if name in roles
                                  else "free") for name in shown}
    kinds = [roles.get(name, ("free",))[0] for name in surface.regions.tolist()]
    present = {kind: colour for kind, colour in KINDS.items() if kind in kinds}
    arrows = []
    for drawn, colour in ((("traction", "force"), "#003B5C"), (("dirichlet",), "black")):
        arrows += _Arrows(surface, [_Values(disc, MIDDLES, name, *roles[name], spread=True) for name in shown
                                    if name in roles and roles[name][0] in drawn], colour)
    title = "setting"
    title += "".join(f", joint {region!r} inside" for region in problem.joints)
    if problem.bodyforce is not None:
        forces = VectorsAt(problem.bodyforce, VolumePoints(mesh, disc.order), "bodyforce")
        title += f", body force {Span('$f_1$', forces)}"
        arrows += _BodyForce(disc, forces.mean(axis=0), view)
    return Surface(surface.corners, [KINDS[kind] for kind in kinds], title, present, view=view, regions=surface, words=words,
                   arrows=arrows)


def _Values(disc: DiscreteProblem, rules: Any, name: str, kind: str, region: str, *, spread: bool = False) -> tuple[Any, Array]:
    """(boundary elements of a name, values there, (n,) or (n, d)) at points of rules; forces as totals, or `spread`."""
    problem, boundary = disc.problem, disc.mesh.Boundaries(Literal(name))
    points = disc.mesh.MapToAllElements(rules, boundary)
    if kind == "foundation":
        gap = next(foundation.gap for foundation in problem.foundation if foundation.boundary == region)
        return points["nr"], ValuesAt(gap, points, "gap", boundary)
    value = disc.tractions[kind, region] if spread and kind == "force" else getattr(problem, kind)[region]
    return points["nr"], EntriesAt(value, points, kind, boundary)


def _Arrows(surface: SurfaceFaces, values: list[tuple[Any, Array]], colour: str) -> list[tuple[Array, Array, Array, str]]:
    """Arrows of vectors on faces, of a length proportional to them; those into the body end at it, others begin there."""
    largest = max((np.linalg.norm(vectors, axis=1).max() for _, vectors in values), default=0)
    arrows = []
    for numbers, vectors in values:
        order = np.flatnonzero(np.isin(surface.numbers, numbers))
        of = dict(zip(numbers.tolist(), vectors))
        for face in order[::max(1, len(order) // FEW)]:
            vector = ARROW * surface.size * of[int(surface.numbers[face])] / (largest or 1)
            if np.linalg.norm(vector) > 0.02 * ARROW * surface.size:
                normal = surface.normals[face]
                tail = surface.middles[face] - (vector if vector @ normal < 0 else 0)
                arrows.append((tail + 0.01 * surface.size * normal, vector, normal, colour))
    return arrows


def _BodyForce(disc: DiscreteProblem, mean: Array, view: Sequence[float] | None) -> list[tuple[Array, Array, Array, str]]:
    """An arrow beside the body, in every view."""
    points = disc.mesh.ngmesh.Coordinates()
    vector = ARROW * np.ptp(points, axis=0).max() * mean / (np.linalg.norm(mean) or 1)
    tail = points.max(axis=0) + 0.15 * np.ptp(points, axis=0).max() - vector / 2
    # Each of them is seen in its own view alone: VIEWS are opposite.
    return [(tail, vector, Towards(angles), VERMILION) for angles in (VIEWS if view is None else (view,))]
