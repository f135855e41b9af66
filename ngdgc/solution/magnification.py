"""By how much a displacement is enlarged in pictures."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..mesh.facets import VolumePoints
from ..tools.values import Finite

SEEN = 0.02         # largest displacement, relative to the body, from which on it is seen as it is
WANTED = 0.06       # of an enlarged one, at most
FARTHEST = 0.3      # of an enlarged gap, relative to the body


def Magnification(solution: Any, scale: Any) -> float:
    """`scale` as a float, or for "auto" 1 where the displacement is seen, else 1, 2 or 5 times a power of 10.

    "auto" makes the largest |u| at most 6 % of the body, and no gap larger than 30 % of it.
    """
    if not isinstance(scale, str) or scale.lower() != "auto":
        return Finite(scale, "scale", 'give a number, 1 for the displacement as it is, or "auto"')
    disc = solution.disc
    size = np.ptp(disc.mesh.ngmesh.Coordinates(), axis=0).max()
    largest = np.linalg.norm(np.asarray(solution.gfu(VolumePoints(disc.mesh, 2 * disc.order))), axis=1).max()
    if not 0 < largest < SEEN * size:
        return 1.0
    gap = np.abs(disc.contact.gap).max(initial=0)
    wanted = min(WANTED / largest, FARTHEST / gap if gap > 0 else np.inf) * size
    decade = 10.0 ** np.floor(np.log10(wanted))
    return float(max(1, max(step * decade for step in (1, 2, 5) if step * decade <= wanted * (1 + 1e-9))))
