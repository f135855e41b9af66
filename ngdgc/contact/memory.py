"""What contact points remember when an increment ends: from where slip counts next, its path so far, and what is worn off."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..contracts import Array
from .boundary import ContactBoundary
from .graph import SEPARATION, SLIP, GraphDistance
from .parts import ContactPart, OverParts


class Memory(NamedTuple):
    """The arguments of `ContactBoundary.After`.

    displacement : u at the points, relative to rigid punches (n, d)
    path : sum of |change of u_t| over the increments that ended in slip (n,) [length]
    worn : depth worn off (n,) [length]
    """

    displacement: Array | None = None
    path: Array | None = None
    worn: Array | None = None

    @classmethod
    def Of(cls, contact: ContactBoundary, displacement: Array, law: GraphDistance) -> Memory:
        """What u (n, d) and the law there leave at the end of an increment that began with what `contact` remembers."""
        rubbed = (law.zones == SLIP) | (law.zones == SEPARATION) & np.any(law.friction != 0, axis=1)
        slip = np.where(rubbed, contact.Slip(displacement), 0)
        depth = OverParts(contact.parts, ContactPart.Depth, law.pressure, slip)
        return cls(displacement - contact.moved, contact.path + slip, contact.worn + depth)
