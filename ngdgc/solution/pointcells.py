"""A cell around every point of a quadrature on sides of elements, as large as the weight of the point: power diagrams."""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import ET, QUAD, SEGM, TRIG, IntegrationRule

from ..contracts import Array
from ..discrete.problem import DiscreteProblem
from ..mesh.facets import TYPES
from ..mesh.quadrature import BoundaryQuadrature, ContactRules

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
    return cells, np.array([_Area(cell) for cell in cells]), slope


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


def _Area(polygon: Array) -> float:
    a, b = polygon.T
    return float(a @ np.roll(b, -1) - b @ np.roll(a, -1)) / 2 if len(polygon) else 0.0


class ContactCells:
    """Cells on Gamma_C, one for every pair of a contact point and a side on which it lies, in the order of `members`.

    points : NGSolve's mesh points inside the elements, at the corners;  coordinates (m, d);  corners : list of their numbers
    weights : (pairs,), of the quadrature, which are the areas of the cells where the sides are flat parallelograms or triangles
    """

    def __init__(self, disc: DiscreteProblem) -> None:
        dim, rules = disc.mesh.dim, ContactRules(disc.method, disc.mesh.dim, disc.order)
        kinds = {et: rules[et] if isinstance(rules, dict) else IntegrationRule(et, rules) for et in TYPES[dim - 1].values()}
        cells = {et: PointCells(et, rule) for et, rule in kinds.items()}
        corners = {et: np.concatenate(parts) for et, parts in cells.items()}
        at = {et: IntegrationRule([tuple(corner) for corner in places.tolist()], [0.0] * len(places))
              for et, places in corners.items()}
        foundations = [part.foundation.boundary for part in disc.contact.parts]
        rows = [(BoundaryQuadrature.On(disc.facets, region, at), BoundaryQuadrature.On(disc.facets, region, rules))
                for region in foundations]
        self.points = np.concatenate([row.inside for row, _ in rows])
        self.coordinates = np.concatenate([row.coordinates for row, _ in rows])
        self.weights = np.concatenate([row.weights for _, row in rows])
        # The sides are the same in both, in the same order, each with the points of its rule in a row.
        sizes = []
        for _, quadrature in rows:
            starts = np.flatnonzero(np.diff(quadrature.boundaryelements, prepend=-1))
            for number in quadrature.boundaryelements[starts]:
                et = TYPES[dim - 1][int((disc.facets.boundary[2][number] >= 0).sum())]
                sizes += [len(cell) for cell in cells[et]]
        ends = np.cumsum(sizes)
        self.corners = [np.arange(end - size, end) for end, size in zip(ends, sizes)]
