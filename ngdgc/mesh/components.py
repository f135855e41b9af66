"""Connected parts of a mesh, and of any graph."""

from __future__ import annotations

from typing import Any

import numpy as np


def Components(facets: Any) -> np.ndarray:
    """Number of the connected part of the mesh of `facets.Facets`, over elements, in the order of their first elements."""
    inside = facets.incidence.indptr[:-1][(facets.neighbours > 1) & ~facets.cut]
    first, second = (facets.incidence.indices[inside + side] for side in (0, 1))
    return Connected(facets.mesh.ne, first, second)


def Connected(count: int, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Number of the connected part of each node of a graph, (count,), by the first node of each, from the ends of its edges."""
    # Every node points to one of its part with a smaller number, or is the smallest; scipy.sparse.csgraph takes longer to
    # import than this takes.
    smallest = np.arange(count)
    while np.any(apart := smallest[first] != smallest[second]):
        first, second = first[apart], second[apart]
        ends = smallest[first], smallest[second]
        np.minimum.at(smallest, np.maximum(*ends), np.minimum(*ends))
        while np.any((further := smallest[smallest]) != smallest):
            smallest = further
    return np.unique(smallest, return_inverse=True)[1]
