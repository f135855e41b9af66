"""What facets tell of the whole body, of which a mesh may be a part."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..contracts import Array


class OfBody:
    """A mesh that is all of the body; `incidence` is sparse (facets, elements)."""

    incidence: Any

    @property
    def interior(self) -> np.ndarray:
        """True for the facets inside the body, over facets."""
        return np.diff(self.incidence.indptr) > 1

    def Largest(self, values: Array) -> float:
        """The largest of values (n,) on elements or facets, or 0."""
        return float(np.max(values, initial=0))
