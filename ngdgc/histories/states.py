"""What is kept of every state of a history, and what it has cost."""

from __future__ import annotations

from dataclasses import dataclass

from ..contact.memory import Memory
from ..contracts import Array
from ..tools.calls import ByKeyword


@ByKeyword
@dataclass(frozen=True)
class Increment:
    """What one increment took.

    time : at its end;  parts : into which it was divided;  solves : applications of A^-1
    residual : how far displacement and traction are from law and equilibrium, no unit;  seconds : of this increment

    >>> Increment(time=1.0, parts=1, solves=4, residual=1e-12, seconds=0.1).solves
    4
    """

    time: float
    parts: int
    solves: int
    residual: float
    seconds: float


@dataclass(frozen=True, kw_only=True, eq=False)
class LoadState:
    """What a history keeps of a state: arrays over the n contact points, and numbers.

    displacement, traction : u, t (n, d);  before, after : `Memory` with which its last part began, and that it leaves
    work, dissipation, abrasion : cumulated;  energy : of body and foundations, all [stress length^d]
    vector : coefficients of u (ndof,), or None where they are computed when they are asked for
    punches : displacement and rotation of rigid punches (punches, modes) [length], [1], or None where there are none
    """

    time: float
    displacement: Array
    traction: Array
    before: Memory
    after: Memory
    work: float
    energy: float
    dissipation: float
    abrasion: float
    increment: Increment
    vector: Array | None = None
    punches: Array | None = None
