"""Properties that are computed when they are first asked for, and belong to what was frozen before."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


class Frozen:
    """A property of a DiscreteProblem that follows from what it is now: computed once, with Parameters as they were read.

    All of them are kept in its dictionary `derived`, which is never changed but only begun anew: so none depends on which other
    one was asked for before.
    """

    def __init__(self, compute: Callable[[Any], Any]) -> None:
        self.compute, self.__doc__ = compute, compute.__doc__

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, disc: Any, owner: type | None = None) -> Any:
        if disc is None:
            return self
        kept = self.Kept(disc)
        if self.name not in kept:
            with disc.state.Restored():
                kept[self.name] = self.compute(disc)
        return kept[self.name]

    def Kept(self, disc: Any) -> dict[str, Any]:
        return disc.derived


class OfMatrix(Frozen):
    """One that follows from the material, the method and added forms alone: problems with the same ones share `elastic`."""

    def Kept(self, disc: Any) -> dict[str, Any]:
        return disc.elastic


def Twin(disc: Any) -> Any:
    """The same DiscreteProblem once more, whose attributes can be set anew; what is frozen is shared."""
    twin = object.__new__(type(disc))
    twin.__dict__.update(disc.__dict__)
    return twin
