"""How large the facets are on which a quadrature has its points."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..contracts import Array
from ..mesh.quadrature import BoundaryQuadrature


def FacetSizes(disc: Any, quadrature: BoundaryQuadrature) -> Array:
    """h = |e|^(1/(d-1)) at the points, (m,) [length], |e| in the plane of the mesh also for a body of revolution."""
    if disc.problem.axisymmetric:
        return np.asarray(disc.facets.measure[disc.facets.boundary[0][quadrature.boundaryelements]])
    _, facet = np.unique(quadrature.boundaryelements, return_inverse=True)
    return np.asarray(np.bincount(facet, quadrature.weights)[facet] ** (1 / (disc.mesh.dim - 1)))
