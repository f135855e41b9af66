"""Exercises of notebook 6, semismooth Newton and the zones."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..contact.graph import SEPARATION, SLIP, STICK
from ..contracts import Array
from .checker import Choice, Function


def Tractions(rng: np.random.Generator) -> tuple[Any, ...]:
    """Pressures, friction of both signs and bounds with every zone among them; also contact with the bound 0."""
    pressure = np.where(rng.uniform(size=40) < 0.3, 0.0, rng.uniform(1, 9, 40))
    bound = 0.5 * pressure
    return pressure, bound * rng.choice([-1.0, -0.6, 0.0, 0.4, 1.0], 40), bound


def Zone(pressure: Array, friction: Array, bound: Array) -> Array:
    return np.where(pressure <= 0, SEPARATION, np.where(np.abs(friction) < bound, STICK, SLIP))


def Penetrations(rng: np.random.Generator) -> tuple[Any, ...]:
    """Open and closed points, each also with m = 1, the law of most examples, where numpy takes 0**0 for 1."""
    return rng.uniform(-1, 2, 30), rng.uniform(1, 50, 30), np.where(np.arange(30) % 3 == 0, 1.0, rng.uniform(1, 3, 30))


def Depth(r: Array) -> Array:
    """(r)_+."""
    return np.maximum(r, 0)


def Derivative(r: Array, k: Array, m: Array) -> Array:
    return np.where(r > 0, k * m * Depth(r) ** (m - 1), 0)


def Unmasked(r: Array, k: Array, m: Array) -> Array:
    """k m (r)_+^(m-1) without a case for r <= 0, where it is k for m = 1."""
    return k * m * Depth(r) ** (m - 1)


def Columns(rng: np.random.Generator) -> tuple[Any, ...]:
    r, k, m = Penetrations(rng)
    return r, rng.uniform(0.1, 0.5, 30), rng.uniform(1, 2, 30), rng.uniform(0.01, 0.1, 30), k, m


def NewtonStep(r: Array, g: float | Array, d: Array, c: Array, k: Array, m: Array, *,
               slope: Callable[..., float | Array] = Derivative) -> Array:
    return r - (r + g + c * k * Depth(r) ** m - d) / (1 + c * slope(r, k, m))


EXERCISES = {
    "06.1": Function(
        Right=Zone, Data=Tractions, hint="First ask for the pressure, then compare the size of the friction with its bound.",
        insight="The order of the questions matters: where there is no pressure the bound is zero, too, and reached.",
        mistakes={
            "Stick and slip are interchanged: slip is where the bound is reached.":
                lambda p, t, b: np.where(p <= 0, SEPARATION, np.where(np.abs(t) < b, SLIP, STICK)),
            "Friction has a sign: compare its absolute value with the bound.":
                lambda p, t, b: np.where(p <= 0, SEPARATION, np.where(t < b, STICK, SLIP)),
            "You forgot separation: without pressure there is no contact.":
                lambda p, t, b: np.where(np.abs(t) < b, STICK, SLIP),
            "Without friction a point can stick: what counts is the bound.":
                lambda p, t, b: np.where(p <= 0, SEPARATION, np.where(t == 0, SLIP, np.where(np.abs(t) < b, STICK, SLIP)))}),
    "06.2": Function(
        Right=Derivative, Data=Penetrations, hint="Differentiate the power on each side of zero.",
        insight="Zero on one side, k m r^(m-1) on the other; at the kink of m = 1 any slope between will do.",
        mistakes={
            "The exponent comes down as a factor.": lambda r, k, m: np.where(r > 0, k * Depth(r) ** (m - 1), 0),
            "That is the derivative for m = 1.": lambda r, k, m: np.where(r > 0, k, 0),
            "That is the law itself.": lambda r, k, m: k * Depth(r) ** m,
            "Out of contact the pressure is constant: its derivative is zero.":
                lambda r, k, m: k * m * np.abs(r) ** (m - 1),
            "Try m = 1 at an open point: numpy takes 0**0 for 1.  A case for r <= 0 makes the derivative zero there.": Unmasked,
            "Only the factor m, not the power, was lowered.": lambda r, k, m: k * m * Depth(r) ** m}),
    "06.3": Function(
        Right=NewtonStep, Data=Columns, hint="r - F(r)/F'(r), with the positive part in both.",
        insight="On the right side of the kink and for m = 1 this step lands on the solution.",
        mistakes={
            "You divide by 1, the slope of the body: the stiffness of the foundation belongs to F', too.":
                lambda *data: NewtonStep(*data, slope=lambda r, k, m: 0),
            "F' has the stiffness at open points, too: the indicator r > 0 is missing.":
                lambda *data: NewtonStep(*data, slope=lambda r, k, m: k * m * np.abs(r) ** (m - 1)),
            "Try m = 1 at an open point: in F' numpy takes 0**0 for 1.": lambda *data: NewtonStep(*data, slope=Unmasked),
            "F' is that for m = 1.": lambda *data: NewtonStep(*data, slope=lambda r, k, m: np.where(r > 0, k, 0)),
            "Wrong sign: Newton subtracts F/F'.": lambda r, *data: 2 * r - NewtonStep(r, *data),
            "You forgot the gap in F.": lambda r, g, *data: NewtonStep(r, 0, *data),
            "That is the correction alone; add it to r.": lambda r, *data: NewtonStep(r, *data) - r}),
    "06.4": Choice(
        right=("c", 2), choices={"a": "Look at the last entries of the history.",
                                 "b": "That is so for smooth laws.  What is the second derivative of a straight line?"},
        reasons={1: "So are functions for which Newton's method needs many steps; think of the pieces.",
                 3: "Nothing guarantees that; look at the residuals while zones are being found."},
        insight="An active set is guessed, and when the guess is right one linear solve is the exact answer.")}
