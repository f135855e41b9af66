"""Gamma_C in parts, one for each foundation: which contact points are its, and its laws there."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..contracts import Array, Compliance, Friction, Wear
from ..data.coefficients import CheckRange, ValuesAt
from ..exceptions import ProblemError
from ..problem.foundation import Foundation
from ..problem.hypotheses import BoundDerivatives, CheckCompliance, CheckFriction, CheckWear, SlipFactor
from ..problem.laws import LawAt
from ..problem.userlaws import LawName
from .bonds import Bond
from .resolvent import Resolvent


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactPart:
    """A foundation, the slice of its contact points, and its laws with their data there; friction or wear None: there is none.

    bond : of a joint with a tension, else None
    path : of the slip before the one that counts now (m,) [length]

    All methods map arrays over these points, (m,), to such arrays: r penetration, p pressure, slip |u_t|.
    """

    foundation: Foundation
    points: slice
    compliance: Compliance
    friction: Friction | None
    bond: Bond | None = None
    wear: Wear | None = None
    path: Array | float = 0.0

    @classmethod
    def On(cls, foundation: Foundation, points: slice, meshpoints: Any, region: Any) -> ContactPart:
        """The part of a foundation on a boundary region, with laws evaluated at mesh points, and checked."""
        name, count = f"{foundation.kind} {foundation.boundary!r}", points.stop - points.start
        compliance: Any = LawAt(foundation.compliance, meshpoints, f"{name}: ", region)
        CheckCompliance(compliance, count, name)
        friction: Any = None
        if foundation.friction is not None:
            friction = LawAt(foundation.friction, meshpoints, f"{name}: ", region)
            r = np.ones(count)
            CheckFriction(friction, r, compliance.Pressure(r), name)
        wear: Any = LawAt(foundation.wear, meshpoints, f"{name}: ", region)
        if wear is not None:
            CheckWear(wear, compliance.Pressure(np.ones(count)), name)
        part = cls(foundation=foundation, points=points, compliance=compliance, friction=friction, wear=wear)
        tension = ValuesAt(foundation.tension, meshpoints, f"{name}: tension", region)
        CheckRange(tension, f"{name}: tension", least=0)
        return replace(part, bond=Bond.Of(part, tension, name)) if np.any(tension) else part

    def After(self, path: Array) -> ContactPart:
        """The same with a path of the slip so far, (m,) [length]."""
        bond = self.bond and replace(self.bond, part=replace(self.bond.part, path=path))
        return replace(self, path=path, bond=bond)

    def Depth(self, p: Array, slip: Array) -> Array:
        """What a slip wears off at the pressure p [length]."""
        return np.zeros_like(p) if self.wear is None else self.wear.Depth(p, slip)

    def Pressure(self, r: Array) -> Array:
        """p_n(r) [stress]."""
        if self.bond:
            return self.bond.part.Pressure(r + self.bond.depth) - self.bond.tension
        return self.compliance.Pressure(r)

    def Least(self, p: Array) -> Array:
        """The pressure in separation, as large an array as p: 0, or of a bond minus its tension [stress]."""
        return 0 - self.bond.tension if self.bond else np.zeros_like(p)

    def PressureDerivative(self, r: Array) -> Array:
        """p_n'(r) [stress/length]."""
        return self.compliance.PressureDerivative(r + self.bond.depth if self.bond else r)

    def Bound(self, r: Array, p: Array) -> Array:
        """p_t(r, p, 0), the friction bound without slip [stress], zero without friction."""
        if self.bond:
            return self.bond.part.Bound(r + self.bond.depth, p + self.bond.tension)
        return np.zeros_like(r) if self.friction is None else self.friction.Bound(r, p)

    def BoundDerivatives(self, r: Array, p: Array) -> tuple[Array, Array]:
        """(d p_t/dr, d p_t/dp) of the bound without slip."""
        if self.bond:
            return self.bond.part.BoundDerivatives(r + self.bond.depth, p + self.bond.tension)
        return (np.zeros_like(r), np.zeros_like(r)) if self.friction is None else BoundDerivatives(self.friction, r, p)

    def SlipFactor(self, slip: Array) -> tuple[Array, Array]:
        """(Coefficient(path + s), its derivative by s), [1] and [1/length]."""
        if self.friction is None:
            return np.ones_like(slip), np.zeros_like(slip)
        return SlipFactor(self.friction, self.path + slip)

    def NormalPoint(self, gamma: Array, q: Array) -> tuple[Array, Array, Array]:
        """(r, p, p_n'(r)) with p = p_n(r) and p + gamma r = q; where the law has ended, a rigid wall."""
        if self.bond:
            r, p, slope = self.bond.part.NormalPoint(gamma, q + self.bond.tension + gamma * self.bond.depth)
            return r - self.bond.depth, p - self.bond.tension, slope
        r, ended = self._Depth(gamma, q)
        with np.errstate(all="ignore"):
            slope = np.where(r > 0, self.PressureDerivative(np.where(r > 0, r, 0)), 0)
            slope = np.where(ended, np.inf, slope)
            # Where the law is stiff p_n(r) would multiply the round-off of r by p_n'.
            p = np.where(r > 0, np.where(slope < gamma, self.Pressure(r), q - gamma * r), 0)
            return r, p, slope

    def SlipPoint(self, gamma: Array, bound: Array, length: Array) -> tuple[Array, Array, Array]:
        """(s, factor, d p_t/ds), p_t = bound factor(s), with p_t + gamma s = length where length > bound factor(0), else s = 0.

        bound : that without slip.  Without friction gamma s = length
        """
        if self.friction is None:
            return length / gamma, *self.SlipFactor(length)
        slip, ended = self._Slip(gamma, bound, length)
        factor, slope = self.SlipFactor(slip)
        if np.any(ended):
            return slip, np.where(ended, (length - gamma * slip) / bound, factor), np.where(ended, np.inf, bound * slope)
        return slip, factor, bound * slope

    def CheckEnds(self, gamma: Array, q: Array, length: Array) -> None:
        """Raise ProblemError if `NormalPoint` or `SlipPoint` of q and length is where a law has ended."""
        if self.bond:
            return self.bond.part.CheckEnds(gamma, q + self.bond.tension + gamma * self.bond.depth, length)
        _RaiseWhere(f"{LawName(self.compliance)}.Pressure", "penetration", *self._Depth(gamma, q))
        if self.friction is not None:
            bound = self.Bound(*self.NormalPoint(gamma, q)[:2])
            _RaiseWhere(f"{LawName(self.friction)}.Coefficient", "slip", *self._Slip(gamma, bound, length))

    def _Depth(self, gamma: Array, q: Array) -> tuple[Array, np.ndarray]:
        return Resolvent(self.Pressure, self.PressureDerivative, gamma, q)

    def _Slip(self, gamma: Array, bound: Array, length: Array) -> tuple[Array, np.ndarray]:
        return Resolvent(lambda s: bound * self.SlipFactor(s)[0], lambda s: bound * self.SlipFactor(s)[1], gamma, length)


def _RaiseWhere(method: str, word: str, values: Array, ended: np.ndarray) -> None:
    if np.any(ended):
        raise ProblemError(f"{method} is not finite beyond {word} {values[ended].min():.6g}, and more would be needed: the law "
                           f"ends there; give it values for larger {word}s, or make the loads smaller")


def OverParts(parts: Sequence[ContactPart], Values: Callable[..., Any], *arrays: Array) -> Array:
    """Values of a part and arrays (m,) at its points, of all parts together: (n,), or (k, n) of a method that gives k arrays.

    Values : such as `ContactPart.Pressure`;  arrays : (n,)
    """
    return np.concatenate([np.asarray(Values(part, *(array[part.points] for array in arrays)), dtype=float) for part in parts],
                          axis=-1)


def CheckFinite(parts: Sequence[ContactPart], method: str, values: Array, at: Array, word: str = "penetration") -> None:
    """Raise ProblemError that names the law and where it is unless its values (n,) at arguments (n,) are finite.

    method : of a law, one of `userlaws.VALUES` or `PAIRS`;  word : for its argument
    """
    wrong = np.flatnonzero(~np.isfinite(values))
    if not len(wrong):
        return
    part = next(part for part in parts if part.points.start <= wrong[0] < part.points.stop)
    law = part.compliance if method in ("Pressure", "PressureDerivative") else part.friction
    raise ProblemError(f"{LawName(law)}.{method} is {values[wrong[0]]:g} at {word} {at[wrong[0]]:.6g}, not finite, where the "
                       "iteration needs it; look at its exponent and its data for the penetrations that occur")
