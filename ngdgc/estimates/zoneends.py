"""Where zones end within a facet of Gamma_C: the traction has a kink there, and a quadrature across it is poor.

On a line of points q = t + gamma u, the coordinate of the graph of the law (`contact.graph`), is smooth, and a zone ends where

    separation    q_n - gamma g = 0
    stick         |q_t| = p_t(r, p, 0)

In 2D the zeros between neighbouring points, and those between the last of them and the ends of the facet, are found by linear
interpolation, which misses by the square of their distance, and the integral by the fourth power.  In 3D a triangle is cut
along the straight lines where linear functions, fitted to these values at its points, are zero; quadrilaterals, whose parts on
either side of a line are none, are divided into equal parts.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from ngsolve import ET, QUAD, SEGM, TRIG, IntegrationRule

from ..contact.boundary import ContactBoundary
from ..contact.graph import ContactGraph
from ..contact.parts import ContactPart, OverParts
from ..contracts import Array
from ..mesh.facets import Facets
from ..mesh.pieces import Area, Cut, Interval, Piece, Pieces, Quarters, Triangles

NARROW = 1e-4       # part of a facet that is not divided off
DEPTH = 2           # how often quadrilaterals with several zones are divided
SEPARATION, STICK, ALONG = 0, 1, 3      # labels of points; ALONG without friction, more or less with slip along or against it
CORNERS = np.array([(1.0, 0.0), (0.0, 1.0), (0.0, 0.0)])    # of the reference triangle
WHOLE = {et: Piece(np.zeros(dim), np.eye(dim)) for et, dim in ((SEGM, 1), (TRIG, 2), (QUAD, 2))}


def ZonePieces(facets: Facets, contact: ContactBoundary, levels: tuple[Array, Array, Array], rules: Any,
               pieces: Pieces | None = None) -> Pieces:
    """The parts of the boundary elements in which zones end; whole ones are not among them.

    contact : whose points are on one element each;  levels : `Levels` at them, or `Openings`
    rules, pieces : of the quadrature of these points, as for `BoundaryQuadrature.On`
    """
    found: dict[int, list[Piece]] = {}
    for run in np.split(np.arange(len(contact.weights)), np.flatnonzero(np.diff(contact.boundaryelements)) + 1):
        number = int(contact.boundaryelements[run[0]])
        et = {2: SEGM, 3: TRIG, 4: QUAD}[int((facets.boundary[2][number] >= 0).sum())]
        rule = rules[et] if isinstance(rules, dict) else IntegrationRule(et, rules)
        points = np.array(rule.points)[:, :contact.dim - 1]
        places = np.concatenate([piece.origin + points @ piece.matrix.T for piece in (pieces or {}).get(number, [WHOLE[et]])])
        parts = PARTS[et](places, *(level[run] for level in levels))
        if len(parts) > 1:
            found[number] = parts
    return found


def Levels(graph: ContactGraph, q: Array) -> tuple[Array, Array, Array]:
    """q_n - gamma g, positive in contact, q_t along the tangent, in 3D |q_t|, and p_t without slip, (n,) each, for q (n, d)."""
    contact, (above, *_) = graph.contact, Openings(graph, q)
    r, p, _ = OverParts(contact.parts, ContactPart.NormalPoint, graph.scale, contact.Normal(q) - graph.scale * contact.gap)
    bound = OverParts(contact.parts, ContactPart.Bound, r, p)
    if contact.dim == 3:
        return above, np.linalg.norm(contact.Tangential(q), axis=1), bound
    return above, np.einsum("ni,ni->n", q, np.column_stack([-contact.normals[:, 1], contact.normals[:, 0]])), bound


def Openings(graph: ContactGraph, q: Array) -> tuple[Array, Array, Array]:
    """The same without friction: of zones contact alone ends."""
    contact, scale = graph.contact, graph.scale
    # A joint with a tension pulls before it opens.
    above = contact.Normal(q) + contact.tension + scale * (contact.depth - contact.gap)
    return above, np.zeros_like(above), np.zeros_like(above)


def _Labels(above: Array, along: Array, bound: Array) -> Array:
    slip = ALONG + np.where(bound > 0, np.sign(along), 0)
    return np.where(above <= 0, SEPARATION, np.where(np.abs(along) < bound, STICK, slip))


def _Intervals(places: Array, *levels: Array) -> list[Piece]:
    """The parts of a segment."""
    inner = places[:, 0]
    s = np.concatenate([[0], inner, [1]])
    above, along, bound = (np.concatenate([[_Line(inner[:2], level[:2], 0)], level, [_Line(inner[-2:], level[-2:], 1)]])
                           for level in levels)
    labels = _Labels(above, along, np.maximum(bound, 0))
    found = []
    for i in np.flatnonzero(np.diff(labels)):
        pair = slice(i, i + 2)
        for level in [above] if SEPARATION in labels[pair] else [along - bound, along + bound]:
            here, there = level[pair]
            if here * there < 0:
                found.append(s[i] + (s[i + 1] - s[i]) * here / (here - there))
    ends = [0.0]
    for end in sorted(found):
        if end - ends[-1] > NARROW and 1 - end > NARROW:
            ends.append(float(end))
    return [Interval(*pair) for pair in zip(ends, [*ends[1:], 1.0])]


def _Line(places: Array, values: Array, at: float) -> float:
    """The value at a place of the line through two."""
    return float(values[0] + (at - places[0]) / (places[1] - places[0]) * (values[1] - values[0]))


def _Triangles(places: Array, above: Array, length: Array, bound: Array) -> list[Piece]:
    """The parts of a triangle: of separation and contact, of stick and slip in contact."""
    labels = _Labels(above, length, bound)
    polygons, touching = _Halves([CORNERS], places, above), labels != SEPARATION
    if touching.sum() > 2 and np.ptp(labels[touching]):
        polygons = _Halves(polygons, places[touching], (length - bound)[touching])
    return Triangles(polygons)


def _Halves(polygons: list[Array], places: Array, values: Array) -> list[Array]:
    """The parts of polygons on either side of the line where the linear function that fits values at places best is zero."""
    slope = np.linalg.lstsq(np.column_stack([np.ones(len(places)), places]), values, rcond=None)[0]
    found = []
    for polygon in polygons:
        parts = Cut(polygon, slope[0] + polygon @ slope[1:])
        wide = len(parts) == 2 and min(map(Area, parts)) > NARROW * Area(CORNERS)
        found += parts if wide else [polygon]
    return found


def _Quarters(places: Array, *levels: Array) -> list[Piece]:
    """The parts of a quadrilateral."""
    return Quarters(4, DEPTH) if np.ptp(_Labels(*levels)) else []


PARTS: Mapping[ET, Callable[..., list[Piece]]] = {SEGM: _Intervals, TRIG: _Triangles, QUAD: _Quarters}
