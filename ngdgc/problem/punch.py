"""A foundation that moves as a rigid body: where it goes, and what presses it where that is not known."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..contracts import Datum
from ..data.coefficients import Scalar
from ..exceptions import ProblemError
from ..tools.calls import ByKeyword
from ..tools.formula import Described
from ..tools.values import IsNumber

PAIRS = ("force", "displacement"), ("moment", "rotation")


@ByKeyword
@dataclass(frozen=True)
class RigidPunch:
    """How a `Foundation(..., punch=)` moves: as a rigid body, by a small displacement a and a rotation w about x_0,

        M(x) = a + w x (x - x_0),        r = (u - M).N - g,        slip (u - M)_t,

    so that a displacement into the body presses it.  For every component of a and of w there is one of these:

    force, moment : what presses the punch along this axis, or turns it about x_0 [stress length^(d-1)], [stress length^d]; the
        component of the motion is found with the solution (`ContactSolution.punches`).  It is the force, or moment, of the
        foundation on the body, as `Resultants` has it
    displacement, rotation : where the punch is moved to [length], [1]
    neither : the punch is held

    Forces and displacements are sequences of d entries, with None where there is none; moment and rotation are one number in
    2D, about the axis out of the plane, and sequences of 3 in 3D.  Entries are numbers or CoefficientFunctions of Parameters.
    about : x_0 (d,), numbers; None: the origin

    Of a body of revolution the punch moves along the axis alone, force=(None, F), F that of the whole ring.

    Raises ProblemError for anything else, and for a component of which both are given.

    >>> RigidPunch(force=(None, -50), moment=0, about=(0.2, 1))         # an eccentric load on a punch that may tilt
    RigidPunch(force=(None, -50.0), moment=(0.0,), about=(0.2, 1.0))
    >>> RigidPunch(force=(None, -50), displacement=(0.1, None)).dim     # pressed and dragged
    2
    """

    force: Any = None
    moment: Any = None
    displacement: Any = None
    rotation: Any = None
    about: Any = None
    __repr__ = Described

    if TYPE_CHECKING:
        def __init__(self, force: Sequence[Datum | None] | None = None, moment: Datum | Sequence[Datum | None] | None = None,
                     displacement: Sequence[Datum | None] | None = None,
                     rotation: Datum | Sequence[Datum | None] | None = None,
                     about: Sequence[float] | None = None) -> None: ...

    def __post_init__(self) -> None:
        for name, sizes, remedy in (
                ("force", (2, 3), "2 or 3 entries, with None where there is none, such as (None, -50)"),
                ("displacement", (2, 3), "2 or 3 entries, with None where there is none, such as (0.1, None)"),
                ("moment", (1, 3), "a number in 2D and 3 entries in 3D, with None where there is none, (None, None, 5)"),
                ("rotation", (1, 3), "a number in 2D and 3 entries in 3D, with None where there is none"),
                ("about", (2, 3), "2 or 3 numbers, such as (0, 1)")):
            object.__setattr__(self, name, _Entries(getattr(self, name), f"{name} of a punch", sizes, remedy))
        if self.about is not None and not all(IsNumber(entry) for entry in self.about):
            raise ProblemError(f"about of a punch is {self.about}; give 2 or 3 numbers, such as (0, 1)")
        if all(getattr(self, name) is None for pair in PAIRS for name in pair):
            raise ProblemError("a punch has no force, moment, displacement or rotation; give one, or leave punch= out")
        dims = {name: {2: 2, 1: 2, 3: 3}[len(entries)] for name in ("force", "moment", "displacement", "rotation", "about")
                if (entries := getattr(self, name)) is not None}
        if len(set(dims.values())) > 1:
            listing = ", ".join(f"{name}: {dim}" for name, dim in dims.items())
            raise ProblemError(f"the data of a punch have different dimensions ({listing}); give all of them that of the mesh")
        for load, motion in PAIRS:
            pairs = zip(getattr(self, load) or (), getattr(self, motion) or ())
            if both := [number for number, pair in enumerate(pairs, start=1) if None not in pair]:
                raise ProblemError(f"component {both[0]} of a punch has a {load} and a {motion}; give one of them, and None in "
                                   "the place of the other")

    @property
    def dim(self) -> int:
        """Space dimension d of the data."""
        given = next(len(entries) for pair in PAIRS for name in pair if (entries := getattr(self, name)) is not None)
        return 3 if given == 3 else 2

    def Loads(self) -> tuple[Any, ...]:
        """Forces and moments of all rigid motions, a number or CoefficientFunction each, or None where the motion is known."""
        return self._Both("force", "moment")

    def Motions(self) -> tuple[Any, ...]:
        """Prescribed displacements and rotations, a number or CoefficientFunction each, or None."""
        return self._Both("displacement", "rotation")

    def _Both(self, first: str, second: str) -> tuple[Any, ...]:
        sizes = {first: self.dim, second: 1 if self.dim == 2 else 3}
        return tuple(entry for name, size in sizes.items() for entry in (getattr(self, name) or (None,) * size))

    def Data(self) -> Iterator[tuple[str, Any]]:
        """(name, value) of everything that is given."""
        for pair in PAIRS:
            for name in pair:
                yield from ((f"{name} of punch, component {number}", entry)
                            for number, entry in enumerate(getattr(self, name) or (), start=1) if entry is not None)


def _Entries(value: Any, name: str, sizes: tuple[int, int], remedy: str) -> tuple[Any, ...] | None:
    """A tuple of numbers, CoefficientFunctions and None, as many as a dimension asks for, of a scalar one; None for None."""
    if value is None:
        return None
    entries = list(value) if isinstance(value, (tuple, list, np.ndarray)) and np.ndim(value) == 1 else [value]
    if len(entries) not in sizes or len(entries) == 1 and entries[0] is None:
        raise ProblemError(f"{name} is {value!r}; give {remedy}")
    return tuple(None if entry is None else Scalar(entry, f"component {number} of {name}")
                 for number, entry in enumerate(entries, start=1))
