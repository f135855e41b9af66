"""Korn's constant of elements: the least c with |skew grad w - its mean| <= c |eps(w)| in L2 for all w on the element.

The greatest quotient over polynomials of a degree on the reference element is c from below; of a square it is 2.27 at degree
4 and 2.52 at degree 6, of a right-angled isosceles triangle 4.39 and 4.98.

Source: Horgan, Korn's inequalities and their applications in continuum mechanics, SIAM Review 37 (1995).
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from ngsolve import VOL, IntegrationRule, Mesh, specialcf

from ..blocks.batches import Batches
from ..contracts import Array
from ..mesh.facets import VOLUME_TYPES

DEGREE = 4          # of the polynomials
MARGIN = 1.25       # on their constant
ALIKE = 8           # digits to which elements are images of each other by a similarity
RIGID = 1e-10       # energies, relative to the largest, of motions that are none


def KornConstants(mesh: Mesh, et: Any, elements: np.ndarray) -> Array:
    """MARGIN times the constants (n,) of elements of one type, no unit."""
    rule, dim = IntegrationRule(et, 2 * DEGREE + 2), mesh.dim
    weights = np.array(rule.weights)
    points = mesh.MapToAllElements({one: rule if one == et else IntegrationRule(one, 0) for one in VOLUME_TYPES[dim]}, VOL)
    points = points[np.isin(points["nr"], elements)]
    maps = np.asarray(specialcf.JacobianMatrix(dim, dim)(points)).reshape(len(elements), len(weights), dim, dim)
    size = np.abs(np.linalg.det(maps[:, :1])) ** (1 / dim)
    _, chosen, same = np.unique(np.round((maps / size[..., None, None]).reshape(len(elements), -1), ALIKE), axis=0,
                                return_index=True, return_inverse=True)
    gradients = _Gradients(np.array(rule.points)[:, :dim], dim)
    found = np.empty(len(chosen))
    for rows in Batches(np.arange(len(chosen)), gradients.size * dim ** 2):
        found[rows] = _Largest(maps[chosen[rows]], weights, gradients)
    return MARGIN * found[same.ravel()]


def _Gradients(points: Array, dim: int) -> Array:
    """Reference gradients (q, m, a) of the products of Legendre polynomials of total degree 1 to DEGREE."""
    basis = [np.polynomial.legendre.Legendre.basis(degree) for degree in range(DEGREE + 1)]
    table, slopes = (np.array([one(2 * points - 1) for one in functions])
                     for functions in (basis, [2 * one.deriv() for one in basis]))
    exponents = [one for one in product(range(DEGREE + 1), repeat=dim) if 0 < sum(one) <= DEGREE]
    columns = [[np.prod([(slopes if m == other else table)[degree, :, m] for m, degree in enumerate(one)], axis=0)
                for other in range(dim)] for one in exponents]
    return np.array(columns).transpose(2, 1, 0)


def _Largest(maps: Array, weights: Array, gradients: Array) -> Array:
    """The largest quotients (n,) on elements with maps (n, q, j, m)."""
    dim, measure = maps.shape[2], np.abs(np.linalg.det(maps)) * weights
    g = np.swapaxes(np.swapaxes(np.linalg.inv(maps), 2, 3) @ gradients, 2, 3)         # n q a j
    n, q, a, _ = g.shape
    full = np.zeros((n, q, dim, a, dim, dim))                                         # of component i the row i
    for i in range(dim):
        full[:, :, i, :, i] = g
    full = full.reshape(n, q, dim * a, dim, dim)
    strain, skew = ((full + sign * np.swapaxes(full, 3, 4)) / 2 for sign in (1, -1))
    skew = skew - np.einsum("nq,nqAij->nAij", measure / measure.sum(axis=1, keepdims=True), skew)[:, None]
    energy, rotation = (_Products(measure, values.reshape(n, q, dim * a, dim * dim)) for values in (strain, skew))
    values, vectors = np.linalg.eigh(energy)
    scale = np.where(values > RIGID * values[:, -1:], 1 / np.sqrt(np.abs(values) + (values == 0)), 0)
    vectors = vectors * scale[:, None]
    return np.sqrt(np.linalg.eigvalsh(np.swapaxes(vectors, 1, 2) @ rotation @ vectors)[:, -1])


def _Products(measure: Array, values: Array) -> Array:
    weighted = (np.sqrt(measure)[..., None, None] * values).transpose(0, 2, 1, 3).reshape(len(values), values.shape[2], -1)
    return weighted @ np.swapaxes(weighted, 1, 2)
