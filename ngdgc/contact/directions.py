"""The direction along which a foundation presses: the outward normal of the body, or one that the foundation has of its own."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..contracts import Array
from ..data.coefficients import VectorsAt
from ..exceptions import ProblemError
from ..mesh.quadrature import BoundaryQuadrature
from ..problem.foundation import Foundation

TANGENTIAL = 1e-9   # N.n up to which a foundation beside the body would be touched by sliding along it


def LawNormals(foundation: Foundation, quadrature: BoundaryQuadrature, region: Any) -> Array:
    """N at the points of a BoundaryQuadrature on the foundation's region, unit vectors (n, d): the given ones, or n.

    Raises ProblemError where a given one vanishes or does not point out of the body.
    """
    if foundation.normal is None:
        return quadrature.normals
    name = f"foundation {foundation.boundary!r}: normal"
    given = VectorsAt(foundation.normal, quadrature.points, name, region)
    length = np.linalg.norm(given, axis=1)
    if np.any(length == 0):
        raise ProblemError(f"{name} vanishes at {np.sum(length == 0)} of {len(length)} points of Gamma_C; give a vector that "
                           "points from the body into the foundation, of any length but 0")
    normals = given / length[:, None]
    outward = np.einsum("ni,ni->n", normals, quadrature.normals)
    if np.any(outward <= TANGENTIAL):
        raise ProblemError(f"{name} does not point out of the body at {np.sum(outward <= TANGENTIAL)} of {len(length)} points "
                           f"of Gamma_C, where N.n is {outward.min():.3g}; N points from the body into the foundation: take "
                           "its negative, or a boundary that faces the foundation")
    return normals


def Unit(vectors: Array) -> Array:
    """Vectors (n, d) over their lengths."""
    return vectors / np.linalg.norm(vectors, axis=1)[:, None]
