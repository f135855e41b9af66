"""A discrete problem after the states before it, and with its rigid punches where a solution has moved them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..contact.boundary import ContactBoundary
from ..contact.memory import Memory
from ..contracts import Array
from .frozen import Twin

if TYPE_CHECKING:
    from typing import Self


class Placed:
    """What changes the contact points alone; all else is shared.

    memory : `Memory` of the states before;  origin : displacement of the contact points from which slip counts (n, d), or None
    motion : (m,) of rigid punches as a solution has found it, in units of `contact.punches`, or None
    """

    contact: ContactBoundary
    memory = Memory()
    motion: Array | None = None

    def After(self, origin: Array | None, slid: Array | None = None, worn: Array | None = None) -> Self:
        """The same problem after a state with this `Memory`: displacement of the contact points (n, d), path and worn (n,)."""
        other: Self = Twin(self)
        other.memory = Memory(origin, slid, worn)
        other.contact, other.motion = self.contact.After(*other.memory), None
        return other

    def Moved(self, motion: Array | None) -> Self:
        """The same problem with its rigid punches moved by `motion` (m,), as they are in a solution; None: not yet."""
        if motion is self.motion:
            return self
        other: Self = Twin(self)
        other.contact, other.motion = self.contact.Moved(motion), motion
        return other

    @property
    def punches(self) -> Array | None:
        """Displacement and rotation of rigid punches, (punches, modes) [length], [1], or None where there are none."""
        return None if self.contact.punches is None else self.contact.punches.Whole(self.motion)

    @property
    def origin(self) -> Array | None:
        return self.memory.displacement
