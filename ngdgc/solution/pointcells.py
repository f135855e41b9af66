"""A cell around every point of a quadrature on sides of elements, as large as the weight of the point: power diagrams."""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import ET, QUAD, SEGM, TRIG, IntegrationRule

from ..contact.boundary import ContactBoundary
from ..contracts import Array
from ..discrete.problem import DiscreteProblem
from ..mesh.facets import TYPES, Facets
from ..mesh.pieces import Area
from ..mesh.quadrature import BoundaryQuadrature, ContactRules
from ..problem.foundation import Foundation

EQUAL = 1e-13       # of areas, relative to the side
CLOSE = 1e-9        # corners of a cell that are one
STEPS = 60          # of Newton's method; it needs fewer than ten
SIDES = {TRIG: np.array([(0.0, 0), (1, 0), (0, 1)]), QUAD: np.array([(0.0, 0), (1, 0), (1, 1), (0, 1)])}


def PointCells(et: ET, rule: IntegrationRule) -> list[Array]:
    """Corners (m, d) of the cells, one a point of the rule, into which a reference side is cut, counter-clockwise.

    On a segment they follow each other.  In the plane they are the power diagram of the points whose areas are the weights, on
    squares the product of two such cuts: all convex, no hole, no overlap.
    """
    points, weights = np.array(rule.points), np.array(rule.weights)
    if et == SEGM:
        order = np.argsort(points[:, 0])
        ends = np.concatenate([[0], np.cumsum(weights[order])])
        cells = np.empty((len(points), 2, 1))
        cells[order, :, 0] = np.column_stack([ends[:-1], ends[1:]])
        return list(cells)
    return _PowerCells(SIDES[et], points[:, :2], weights)


def _PowerCells(domain: Array, points: Array, weights: Array) -> list[Array]:
    """Newton's method for the heights of the points, damped so that no cell vanishes (Kitagawa, Merigot, Thibert 2019)."""
    heights = np.zeros(len(points))
    cells, areas, slope = _Diagram(domain, points, heights)
    least = min(areas.min(), weights.min()) / 2
    for _ in range(STEPS):
        if np.abs(areas - weights).max() <= EQUAL * weights.sum():
            break
        # The matrix of a graph, whose kernel are the constants.
        step = np.linalg.lstsq(slope, weights - areas, rcond=None)[0]
        damping = 1.0
        while True:
            tried = _Diagram(domain, points, heights + damping * step)
            if damping < EQUAL or (tried[1].min() >= least and np.linalg.norm(tried[1] - weights)
                                   <= (1 - damping / 2) * np.linalg.norm(areas - weights) + EQUAL * weights.sum()):
                break
            damping /= 2
        heights, (cells, areas, slope) = heights + damping * step, tried
    # Four cells that meet in a point do so up to round-off.
    return [cell[np.linalg.norm(np.roll(cell, -1, axis=0) - cell, axis=1) > CLOSE] for cell in cells]


def _Diagram(domain: Array, points: Array, heights: Array) -> tuple[list[Array], Array, Array]:
    """Cells {x : |x - y_i|^2 - h_i <= |x - y_j|^2 - h_j for all j}, their areas (n,), and those's derivative by h (n, n)."""
    cells, slope = [], np.zeros((len(points), len(points)))
    lengths = (points ** 2).sum(axis=1) - heights
    for i in range(len(points)):
        polygon, labels = domain, np.full(len(domain), -1)      # of the edge that begins at a corner
        for j in range(len(points)):
            if j != i:
                polygon, labels = _Clipped(polygon, labels, 2 * (points[j] - points[i]), lengths[j] - lengths[i], j)
        edges = np.linalg.norm(np.roll(polygon, -1, axis=0) - polygon, axis=1)
        for length, j in zip(edges, labels):
            if j >= 0:
                rate = length / (2 * float(np.linalg.norm(points[i] - points[j])))
                slope[i, i] += rate
                slope[i, j] -= rate
        cells.append(polygon)
    return cells, np.array([Area(cell) for cell in cells]), slope


def _Clipped(polygon: Array, labels: Any, normal: Array, offset: float, label: int) -> tuple[Array, Any]:
    """The part of a convex polygon with normal.x <= offset; its new edge has the label."""
    over = polygon @ normal - offset
    if np.all(over <= 0):
        return polygon, labels
    kept, names = [], []
    for k in range(len(polygon)):
        after = (k + 1) % len(polygon)
        if over[k] <= 0:
            kept.append(polygon[k])
            names.append(labels[k])
        if (over[k] <= 0) != (over[after] <= 0):
            share = over[k] / (over[k] - over[after])
            kept.append(polygon[k] + share * (polygon[after] - polygon[k]))
            names.append(label if over[k] <= 0 else labels[k])
    return np.array(kept).reshape(-1, 2), np.array(names, dtype=int)


class ContactCells:
    """Cells on Gamma_C, one for every pair of a contact point and a side on which it lies, in the order of `members`.

    points : NGSolve's mesh points inside the elements, at the corners;  coordinates (m, d);  corners : list of their numbers
    weights : (pairs,), of the quadrature, which are the areas of the cells where the sides are flat parallelograms or triangles

    Of a joint they are on its first side.
    """

    def __init__(self, disc: DiscreteProblem) -> None:
        dim, facets, contact = disc.mesh.dim, disc.facets, disc.contact
        rules = ContactRules(disc.method, dim, disc.order)
        kinds = {et: rules[et] if isinstance(rules, dict) else IntegrationRule(et, rules) for et in TYPES[dim - 1].values()}
        cells = {et: PointCells(et, rule) for et, rule in kinds.items()}
        at = {et: IntegrationRule([tuple(corner) for cell in parts for corner in cell.tolist()], [0.0] * sum(map(len, parts)))
              for et, parts in cells.items()}
        points, coordinates, weights, sizes = [], [], [], list[int]()
        for part in contact.parts:
            region, side = part.foundation.boundary, _FirstSide(facets, part.foundation)
            corners, quadrature = (BoundaryQuadrature.On(facets, region, rule, side=side, pieces=disc.pieces)
                                   for rule in (at, rules))
            # The sides are the same in both, in the same order, each with the points of its rule in a row, on every piece.
            starts = np.flatnonzero(np.diff(quadrature.boundaryelements, prepend=-1))
            counts = [len(cell) for number in quadrature.boundaryelements[starts]
                      for cell in cells[TYPES[dim - 1][int((facets.boundary[2][number] >= 0).sum())]]
                      * len(disc.pieces.get(int(number), [None]))]
            rows = _Rows(quadrature, contact, part.points)
            ends = np.cumsum(counts)
            chosen = np.concatenate([np.arange(ends[row] - counts[row], ends[row]) for row in rows])
            points.append(corners.inside[chosen])
            coordinates.append(corners.coordinates[chosen])
            weights.append(quadrature.weights[rows])
            sizes += [counts[row] for row in rows]
        self.points, self.coordinates, self.weights = (np.concatenate(parts) for parts in (points, coordinates, weights))
        self.corners = [np.arange(end - size, end) for end, size in zip(np.cumsum(sizes), sizes)]


def _FirstSide(facets: Facets, foundation: Foundation) -> Any:
    """As `BoundaryQuadrature.On` takes it; where nodes are doubled sides are those of one element."""
    return np.where(facets.interfaces.sign > 0, 0, 1) if foundation.kind == "joint" and facets.doubled is None else 0


def _Rows(quadrature: BoundaryQuadrature, contact: ContactBoundary, here: slice) -> Any:
    """The rows of a quadrature that are the pairs of the points of a foundation: of a joint not all of them are."""
    mine = np.flatnonzero((contact.members >= here.start) & (contact.members < here.stop))
    numbers, places = contact.boundaryelements[mine], contact.coordinates[contact.members[mine]]
    if np.array_equal(numbers, quadrature.boundaryelements):
        return np.arange(len(mine))
    rows = {number: np.flatnonzero(quadrature.boundaryelements == number) for number in np.unique(numbers)}
    return np.array([rows[number][np.linalg.norm(quadrature.coordinates[rows[number]] - place, axis=1).argmin()]
                     for number, place in zip(numbers, places)])
