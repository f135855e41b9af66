"""Where zones end within a facet of Gamma_C: the traction has a kink there, and a quadrature across it is poor.

On a line of points q = t + gamma u, the coordinate of the graph of the law (`contact.graph`), is smooth, and a zone ends where

    separation    q_n - gamma g = 0
    stick         |q_t| = p_t(r, p, 0)

In 2D the zeros between neighbouring points are found by linear interpolation, which misses by the square of their distance, and
the integral by the fourth power; in 3D facets that have several zones are divided into equal parts.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import SEGM, IntegrationRule

from ..contact.graph import SEPARATION, STICK, ContactGraph
from ..contact.parts import ContactPart, OverParts
from ..contracts import Array
from ..mesh.facets import Facets
from ..mesh.pieces import Interval, Pieces, Quarters

NARROW = 1e-4       # part of a facet that is not divided off
DEPTH = 2           # how often facets with several zones are divided in 3D


def ZonePieces(facets: Facets, graph: ContactGraph, q: Array, degree: int) -> Pieces:
    """The parts of the boundary elements in which zones end, for the q (n, d) at points of NGSolve's rule of this degree."""
    contact, point = graph.contact, graph.At(q)
    if contact.dim == 3:
        spread = [np.ptp(point.zones[run]) > 0 for run in _Runs(contact.boundaryelements)]
        numbers = [contact.boundaryelements[run[0]] for run in _Runs(contact.boundaryelements)]
        corners = (facets.boundary[2] >= 0).sum(axis=1)
        return {int(number): Quarters(corners[number], DEPTH) for number, wide in zip(numbers, spread) if wide}
    levels = _Levels(graph, q, point)
    places = np.array([point[0] for point in IntegrationRule(SEGM, degree).points])
    found = {}
    for run in _Runs(contact.boundaryelements):
        ends = _Ends(places, *(level[run] for level in levels))
        if len(ends) > 2:
            found[int(contact.boundaryelements[run[0]])] = [Interval(*pair) for pair in zip(ends, ends[1:])]
    return found


def _Runs(numbers: Any) -> Any:
    """Indices of the points of each boundary element."""
    return np.split(np.arange(len(numbers)), np.flatnonzero(np.diff(numbers)) + 1)


def _Levels(graph: ContactGraph, q: Array, point: Any) -> tuple[Array, Array, Array, Array]:
    """(label, q_n - gamma g, q_t - p_t, q_t + p_t) at the points, (n,) each, q_t along the tangent; labels tell zones apart,
    and the two directions of friction."""
    contact, scale = graph.contact, graph.scale
    above = contact.Normal(q) - scale * contact.gap
    along = np.einsum("ni,ni->n", q, np.column_stack([-contact.normals[:, 1], contact.normals[:, 0]]))
    r, p, _ = OverParts(contact.parts, ContactPart.NormalPoint, scale, above)
    bound = OverParts(contact.parts, ContactPart.Bound, r, p)
    label = np.where(point.zones == SEPARATION, 0, np.where(point.zones == STICK, 1, 3 + np.sign(along) * (bound > 0)))
    return label, above, along - bound, along + bound


def _Ends(places: Array, label: Array, above: Array, *bounds: Array) -> list[float]:
    """0, where zones end in ascending order, 1."""
    found = []
    for i in np.flatnonzero(np.diff(label)):
        for level in [above] if 0 in label[i:i + 2] else bounds:
            here, there = level[i], level[i + 1]
            if here * there < 0:
                found.append(places[i] + (places[i + 1] - places[i]) * here / (here - there))
    ends = [0.0]
    for end in sorted(found):
        if end - ends[-1] > NARROW and 1 - end > NARROW:
            ends.append(float(end))
    return [*ends, 1.0]
