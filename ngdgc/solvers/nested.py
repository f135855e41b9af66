"""Nested iteration: coarser problems whose only gift to the next is (u, t) along Gamma_C."""

import numpy as np
from scipy.spatial import cKDTree

from ..coarsening import CoarserMesh
from ..discretization import Discretization

NEIGHBOURS = {2: 4, 3: 9}       # points from which values are carried over, by dimension


def Coarser(disc, mesh=None, *, factor=2.0):
    """The problem of a Discretization on a coarser mesh, made if none is given; None where there is none.

    Forms that were added to `disc` are left out: the coarse problem only predicts.
    """
    mesh = mesh or CoarserMesh(disc.mesh, factor)
    if mesh is None:
        return None
    return Discretization(disc.problem, disc.method, mesh, order=disc.order, assembly=disc.assembly)


def Transfer(coarse, contact):
    """Displacement and traction (n, d) at the points of a finer ContactBoundary, predicted from a coarse ContactSolution.

    Each foundation by itself: a linear function is fitted to the values at the nearest coarse points, near ones counting more.
    """
    old = coarse.disc.contact
    displacement, traction = np.empty_like(contact.normals), np.empty_like(contact.normals)
    values = np.concatenate([coarse.displacement, old.TraceProjection(coarse.traction)], axis=1)
    for (_, source, *_), (_, target, *_) in zip(old.parts, contact.parts):
        fitted = LocalFit(old.coordinates[source], values[source], contact.coordinates[target], contact.normals[target])
        displacement[target], traction[target] = np.split(fitted, 2, axis=1)
    return displacement, traction


def LocalFit(points, values, targets, normals):
    """Values (m, c) at targets (m, d) on a surface with these normals, from values (n, c) at points (n, d)."""
    dim = points.shape[1]
    count = min(NEIGHBOURS[dim], len(points))
    distances, nearest = cKDTree(points).query(targets, k=np.arange(1, count + 1))
    size = distances.max(axis=1)
    offsets = (points[nearest] - targets[:, None]) / size[:, None, None]
    offsets -= np.einsum("mkd,md->mk", offsets, normals)[..., None] * normals[:, None]
    weights = 1 / ((distances / size[:, None]) ** 2 + 1e-4)
    model = np.concatenate([np.ones((*nearest.shape, 1)), offsets], axis=2)
    gram = np.einsum("mki,mk,mkj->mij", model, weights, model)
    # The slope across the surface is not determined, nor are those along it by points that lie on a line.
    gram[:, range(1, dim + 1), range(1, dim + 1)] += 1e-3 * gram[:, :1, 0]
    moments = np.einsum("mki,mk,mkc->mic", model, weights, values[nearest])
    return np.linalg.solve(gram, moments)[:, 0]
