"""What the theory asks of contact laws, (2.13) of Xiao, Wang, Han 2018, and what a law's own derivatives must be.

A law is any object with the methods of `laws.ComplianceLaw` or `laws.FrictionLaw`; nothing else is used here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..contracts import Array, Compliance, Friction, Wear
from ..data.coefficients import Pointwise
from ..exceptions import ProblemError
from ..tools.calls import ByKeyword
from ..tools.values import Integer, PositiveNumber
from .userlaws import CheckPointwise, Each, Watched

SCALES = np.logspace(-6, 0, 25)     # of penetration, pressure and slip at which derivatives are compared
MIXED = SCALES[::4]     # of these a law is asked at once and one by one
STEP = 1e-5         # of differences, relative: their error is 1e-10 of the third derivative and 1e-11 of round-off
TOLERANCE = 1e-3    # of derivatives, relative to the slope
GRID = np.concatenate([[0.0], np.logspace(-4, -2, 20, endpoint=False), np.linspace(0.01, 1, 200)])     # of a range
PARTS, LEVELS = 8, 7    # an interval is cut into parts again and again where it is steepest
GROWTH = 1.5        # of the slope over the last three levels that a bounded one does not show; (r)_+^0.93 does
FLAT = 1e-6         # slopes, relative to largest value over range, that may be round-off of the finest differences
Function = Callable[[Array], Array]


def BoundDerivatives(law: Friction, r: Array, p: Array) -> tuple[Array, Array]:
    """(d Bound/dr, d Bound/dp) of a friction law at points, two arrays (npoints,)."""
    if hasattr(law, "BoundDerivatives"):
        byr, byp = law.BoundDerivatives(r, p)
        return Each(byr, np.shape(r)), Each(byp, np.shape(r))
    bound, derivatives = law.Bound(r, p), []
    for values, shifted in ((r, lambda h: law.Bound(r + h, p)), (p, lambda h: law.Bound(r, p + h))):
        h = 1e-7 * np.maximum(np.abs(values), 1e-8 * (np.abs(values).max(initial=0) or 1))
        derivatives.append((shifted(h) - bound) / h)
    return derivatives[0], derivatives[1]


def SlipFactor(law: Friction, slip: Array) -> tuple[Array, Array]:
    """(Coefficient, its derivative) of a friction law at slips s >= 0, two arrays (npoints,)."""
    if not hasattr(law, "Coefficient"):
        return np.ones_like(slip), np.zeros_like(slip)
    factor, derivative = law.Coefficient(slip)
    return Each(factor, np.shape(slip)), Each(derivative, np.shape(slip))


def CheckCompliance(law: Compliance, npoints: int, name: str) -> None:
    """Check (2.13) and the derivative of a law at `npoints` points, for penetrations from 1e-6 to 1."""
    for r in (-1.0, 0.0):
        p = law.Pressure(np.full(npoints, r))
        if np.any(p != 0):
            raise ProblemError(f"{name}: the pressure is not zero at penetration {r:g}, but {p[p != 0][0]:g}; it must be 0 for "
                               "r <= 0 (2.13)")
    for r in SCALES:
        at = np.full(npoints, r)
        with np.errstate(all="ignore"):
            p = law.Pressure(at)
        if np.any(p < 0):
            raise ProblemError(f"{name}: the pressure at penetration {r:g} is negative; it must be >= 0 (2.13)")
        if _Differs(law.Pressure, law.PressureDerivative, at):
            raise ProblemError(f"{name}: PressureDerivative differs from the finite difference of Pressure at "
                               f"penetration {r:g}; mend the one that is wrong")
    if npoints == 1:
        for method in ("Pressure", "PressureDerivative"):
            CheckPointwise(law, method, MIXED)


def CheckFriction(law: Friction, r: Array, p: Array, name: str) -> None:
    """Check the signs of a friction law and its derivatives at fractions of penetrations r and pressures p (npoints,) > 0."""
    # The pressure of a law that is not defined at these penetrations says nothing about friction.
    p = np.where(np.isfinite(p) & (p > 0), p, 1)
    for fraction in SCALES:
        at, pressed = fraction * r, fraction * p
        with np.errstate(all="ignore"):
            bound = law.Bound(at, pressed)
        # The unit of length is unknown: a law may overflow at the largest values, which may never occur.
        if np.any(bound < 0) or fraction == SCALES[0] and not np.all(np.isfinite(bound)):
            raise ProblemError(f"{name}: the friction bound is negative or not finite at penetration {at[0]:g}; it must be "
                               "p_t >= 0")
        if not hasattr(law, "BoundDerivatives"):
            continue
        for number, (word, Value, start) in enumerate((("penetration", lambda values, p=pressed: law.Bound(values, p), at),
                                                       ("pressure", lambda values, r=at: law.Bound(r, values), pressed))):
            if _Differs(Value, _DerivativeAt(law, at, pressed, number), start):
                raise ProblemError(f"{name}: BoundDerivatives differs from the finite difference of Bound by the {word}, at "
                                   f"penetration {at[0]:g} and pressure {pressed[0]:g}; mend one of them, or leave "
                                   "BoundDerivatives out")
    if len(r) == 1:
        CheckPointwise(law, "Bound", MIXED, p * MIXED)
    if hasattr(law, "Coefficient"):
        _CheckCoefficient(law, np.ones_like(r), name)


def CheckWear(law: Wear, p: Array, name: str) -> None:
    """Check the depths of a wear law at fractions of pressures p (npoints,) and at slips from 1e-6 to 1."""
    p = np.where(np.isfinite(p) & (p > 0), p, 1)
    for fraction in SCALES:
        for slip in (0.0, fraction):
            depth = law.Depth(fraction * p, np.full_like(p, slip))
            if not np.all(np.isfinite(depth)) or np.any(depth < 0 if slip else depth != 0):
                raise ProblemError(f"{name}: the depth that wears off at pressure {fraction * p[0]:g} and slip {slip:g} is "
                                   f"{depth[0]:g}; it must be finite, >= 0, and 0 without slip")
    if len(p) == 1:
        CheckPointwise(law, "Depth", MIXED, MIXED)


def _DerivativeAt(law: Any, r: Array, p: Array, number: int) -> Function:
    return lambda values: law.BoundDerivatives(r, p)[number]


def _CheckCoefficient(law: Any, ones: Array, name: str) -> None:
    for slip in (0.0, *SCALES):
        factor, _ = law.Coefficient(slip * ones)
        if np.any(factor < 0) or not np.all(np.isfinite(factor)):
            raise ProblemError(f"{name}: the friction Coefficient is negative or not finite at slip {slip:g}; it must be >= 0")
        if slip and _Differs(lambda s: law.Coefficient(s)[0], lambda s: law.Coefficient(s)[1], slip * ones):
            raise ProblemError(f"{name}: the derivative that Coefficient returns differs from its finite difference at slip "
                               f"{slip:g}; mend the one that is wrong")
    if len(ones) == 1:
        CheckPointwise(law, "Coefficient", MIXED)


def _Differs(Value: Function, Derivative: Function, at: Array) -> bool:
    """True if somewhere the derivative is not that of Value at points (npoints,), as far as differences can tell."""
    h = STEP * at
    # A law may overflow, or not be defined, at arguments that never occur.
    with np.errstate(all="ignore"):
        value, forward, backward = (Each(Value(shifted), at.shape) for shifted in (at, at + h, at - h))
        derivative = Each(Derivative(at), at.shape)
        slope = (forward - backward) / (2 * h)
        scale = np.abs(value) / at + np.abs(slope)
        # Where the one-sided differences disagree the law has a kink or a jump, and any value will do.
        smooth = np.abs(forward - 2 * value + backward) / h <= TOLERANCE * scale
        return bool(np.any(smooth & (np.abs(derivative - slope) > TOLERANCE * scale)))


@ByKeyword
@dataclass(frozen=True, eq=False)
class LawReport:
    """The constants of laws for penetrations up to `depth` and slips up to `slip` [length], arrays (npoints,) [stress/length].

    normal : L_n, Lipschitz constant of p_n(r);  decrease : the largest N with p_n' >= -N, 0 for a monotone law
    friction : L_t, Lipschitz constant of p_t by the penetration, the pressure p_n(r) included
    weakening : the largest M with dp_t/ds >= -M, s the slip
    problems : what contradicts (2.13), words;  remarks : what does not, but is worth knowing

    inf stands for a function that is not Lipschitz.  Constants are slopes between samples, refined where they are steepest:
    lower bounds, exact for functions without features finer than a hundredth of the range.
    """

    depth: float
    slip: float
    normal: np.ndarray
    decrease: np.ndarray
    friction: np.ndarray
    weakening: np.ndarray
    problems: tuple[str, ...]
    remarks: tuple[str, ...]

    @property
    def monotone(self) -> bool:
        """True if p_n does not decrease."""
        return not np.any(self.decrease > 0)

    @property
    def valid(self) -> bool:
        """True if (2.13) holds over the range."""
        return not self.problems

    def __str__(self) -> str:
        lines = [f"laws for penetrations up to {self.depth:g} and slips up to {self.slip:g}:",
                 f"  p_n        {_Lipschitz('L_n', self.normal)}, " + ("monotone" if self.monotone else
                                                                       f"not monotone: p_n' >= -{self.decrease.max():.4g}"),
                 f"  p_t        {_Lipschitz('L_t', self.friction)}"]
        if np.any(self.weakening > 0):
            lines.append(f"  slip       weakens friction: dp_t/ds >= -{self.weakening.max():.4g}")
        lines.append("  (2.13)     " + ("holds" if self.valid else "violated: " + "; ".join(self.problems)))
        return "\n".join(lines + [f"  remark     {remark}" for remark in self.remarks])


def _Lipschitz(symbol: str, constants: Array) -> str:
    return f"Lipschitz, {symbol} = {constants.max():.4g}" if np.all(np.isfinite(constants)) else "not Lipschitz"


@ByKeyword
def CheckLaws(compliance: Compliance, friction: Friction | None = None, *, depth: float = 1.0, slip: float = 1.0,
              npoints: int = 1) -> LawReport:
    """The `LawReport` of a compliance law and a friction law or None, any objects with their methods.

    The laws are looked at for penetrations in [-depth, depth] and slips in [0, slip] [length]; hypotheses (2.13) are
    p_n, p_t >= 0, Lipschitz in the penetration, 0 without.  Laws with data at `npoints` points have constants there.

    Raises ProblemError for a range that is not positive, and for laws whose data are CoefficientFunctions: their values at
    points of Gamma_C are in the laws of `Discretization(...).contact.parts`.

    >>> from ngdgc import NormalCompliance, CoulombFriction
    >>> report = CheckLaws(NormalCompliance(stiffness=100), CoulombFriction(0.3))
    >>> [round(float(constant), 3) for constant in (report.normal[0], report.friction[0])], report.monotone
    ([100.0, 30.0], True)
    """
    depth, slip = (PositiveNumber(value, name, "give a positive length") for name, value in (("depth", depth), ("slip", slip)))
    npoints = Integer(npoints, "npoints", "give the number of points, a positive integer")
    if Pointwise(compliance) or Pointwise(friction):
        raise ProblemError("the laws have data that are CoefficientFunctions, which have values only at points of a mesh; take "
                           "the laws in Discretization(...).contact.parts, or CheckUniqueness(disc)")
    compliance, friction = Watched(compliance), Watched(friction)
    zeros = np.zeros(npoints)
    factor, weakening = np.ones(npoints), zeros

    def Bound(r: Array) -> Array:
        return zeros if friction is None else factor * friction.Bound(r, compliance.Pressure(r))

    if friction is not None:
        loss = _Steepest(lambda s: SlipFactor(friction, s)[0], slip, npoints, _Decrease)
        largest = np.max([Bound(r + zeros) for r in depth * GRID], axis=0)
        weakening = np.where(loss > 0, loss, 0) * np.where(loss > 0, largest, 0)
        factor = np.max([SlipFactor(friction, s + zeros)[0] for s in slip * GRID], axis=0)
    constants = [_Steepest(compliance.Pressure, depth, npoints, np.abs),
                 _Steepest(compliance.Pressure, depth, npoints, _Decrease), _Steepest(Bound, depth, npoints, np.abs)]
    problems, remarks = _Violations(compliance.Pressure, Bound, depth, zeros)
    problems += [f"{name} is not Lipschitz" for name, constant in (("p_n", constants[0]), ("p_t", constants[2]))
                 if not np.all(np.isfinite(constant))]
    return LawReport(depth, slip, constants[0], constants[1], constants[2], weakening, tuple(problems), tuple(remarks))


def _Violations(Pressure: Function, Bound: Function, depth: float, zeros: Array) -> tuple[list[str], list[str]]:
    """(problems, remarks): where p_n and p_t are negative, not finite, or not zero without penetration."""
    problems, remarks = [], []
    for name, Value in (("p_n", Pressure), ("p_t", Bound)):
        with np.errstate(all="ignore"):
            inside = np.array([Value(r + zeros) for r in depth * GRID])
            outside = np.array([Value(-r + zeros) for r in depth * GRID])
        if not np.all(np.isfinite(inside)):
            problems.append(f"{name} is not finite at penetration {depth * GRID[~np.isfinite(inside).all(axis=1)][0]:.4g}")
        if np.any(inside < 0):
            problems.append(f"{name} is negative at penetration {depth * GRID[(inside < 0).any(axis=1)][0]:.4g}")
        if np.any(outside != 0):
            # With the bound constant on all of Gamma_C this is the reduced law, which has a theory of its own.
            if name == "p_t" and np.all(inside == outside[0]) and np.all(outside == outside[0]):
                remarks.append("p_t is not zero without penetration, as in the reduced law (4.2)")
            else:
                problems.append(f"{name} is not zero without penetration")
    return problems, remarks


def _Decrease(slopes: Array) -> Array:
    return np.maximum(-slopes, 0)


def _Steepest(Value: Function, length: float, npoints: int, Measure: Function) -> Array:
    """Largest Measure of slopes of Value over [0, length] at each point, (npoints,), inf where they grow without bound."""
    with np.errstate(all="ignore"):
        nodes = np.broadcast_to(length * GRID[:, None], (len(GRID), npoints))
        flat = FLAT / length * np.nanmax(np.abs([Value(at) for at in nodes]), axis=0)
        levels = []
        for _ in range(LEVELS):
            slopes = Measure(np.diff([Value(at) for at in nodes], axis=0) / np.diff(nodes, axis=0))
            # Where a value is not finite there is no slope.
            slopes = np.where(np.isfinite(slopes) & (slopes > flat), slopes, 0)
            steepest = slopes.argmax(axis=0)
            low, high = (nodes[steepest + end, np.arange(npoints)] for end in (0, 1))
            levels.append(slopes.max(axis=0))
            nodes = low + (high - low) * np.linspace(0, 1, PARTS + 1)[:, None]
    found = np.array(levels)
    return np.where(found[-1] > GROWTH * found[LEVELS // 2], np.inf, found.max(axis=0))
