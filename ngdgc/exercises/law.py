"""Exercises of notebook 10, laws of one's own."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..contracts import Array
from .checker import Choice, Function, Law

SOFT, HARD, THICKNESS = 20.0, 500.0, 0.1            # of the foam [stress/length], [length]
COEFFICIENT, STRENGTH = 0.4, 5.0                    # of the friction


def Penetrations(rng: np.random.Generator) -> tuple[Any, ...]:
    return (rng.uniform(-0.1, 0.3, 40),)


def Foam(r: Array, *, base: float = SOFT * THICKNESS, hard: float = HARD) -> Array:
    depth = np.maximum(r, 0)
    return np.where(depth < THICKNESS, SOFT * depth, base + hard * (depth - THICKNESS))


def Slope(r: Array) -> Array:
    return np.where(r > 0, np.where(r < THICKNESS, SOFT, HARD), 0)


def Pressures(rng: np.random.Generator) -> tuple[Any, ...]:
    return rng.uniform(0, 0.3, 40), rng.uniform(0, 30, 40)


def Slips(rng: np.random.Generator) -> tuple[Any, ...]:
    return rng.uniform(0, 30, 40), rng.choice([-0.2, 0.1], 40), 0.4, 5.0


def Bound(p: Array, coefficient: float = COEFFICIENT, strength: float = STRENGTH) -> Array:
    return np.minimum(coefficient * p, strength)


def Derivatives(r: Array, p: Array, *, factor: float = COEFFICIENT) -> tuple[Array, Array]:
    return np.zeros_like(r), np.where(COEFFICIENT * p < STRENGTH, factor, 0.0)


EXERCISES = {
    "10.1": Law(
        methods={
            "Pressure": Function(
                Right=Foam, Data=Penetrations, words="Pressure", hint="Two straight lines that meet at r = d, zero for r <= 0.",
                insight="", mistakes={
                    "A foundation does not pull: zero for r <= 0.":
                        lambda r: np.where(r < THICKNESS, SOFT * r, SOFT * THICKNESS + HARD * (r - THICKNESS)),
                    "The pressure jumps at r = d: the part of the foam, k1 d, is missing beyond.": lambda r: Foam(r, base=0),
                    "The second line starts at r = d, not at 0.": lambda r: np.where(
                        r < THICKNESS, SOFT * np.maximum(r, 0), SOFT * THICKNESS + HARD * r),
                    "Beyond d the slope is k2 alone, the foam is used up.": lambda r: Foam(r, hard=SOFT + HARD)}),
            "PressureDerivative": Function(
                Right=Slope, Data=Penetrations, words="PressureDerivative", hint="The slopes of the two lines, and of none.",
                insight="", mistakes={
                    "Without contact the pressure is constant: zero for r <= 0.": lambda r: np.where(r < THICKNESS, SOFT, HARD),
                    "The slopes are interchanged.": lambda r: np.where(r > 0, np.where(r < THICKNESS, HARD, SOFT), 0),
                    "That is the slope of the foam, also where it is used up.": lambda r: np.where(r > 0, SOFT, 0)})},
        insight="Lipschitz and monotone: the theory covers it, and so does Newton's method, kink included."),
    "10.2": Law(
        methods={
            "Bound": Function(
                Right=lambda r, p: Bound(p), Data=Pressures, words="Bound", hint="The smaller of two numbers at every point.",
                insight="", mistakes={
                    "That is Coulomb's law; the limit is missing.": lambda r, p: COEFFICIENT * p,
                    "That is Tresca's law; small pressures have a smaller bound.": lambda r, p: np.full_like(p, STRENGTH),
                    "The larger of the two was taken.": lambda r, p: np.maximum(COEFFICIENT * p, STRENGTH),
                    "The limit holds for the bound, not for the pressure.":
                        lambda r, p: COEFFICIENT * np.minimum(p, STRENGTH)}),
            "BoundDerivatives": Function(
                Right=Derivatives, Data=Pressures, words="BoundDerivatives", insight="",
                hint="A pair: by r, which does not occur, and by p.", mistakes={
                    "At the limit the bound is constant.": lambda r, p: (np.zeros_like(r), np.full_like(p, COEFFICIENT)),
                    "The order is: by the penetration r first, then by the pressure p.": lambda r, p: Derivatives(r, p)[::-1],
                    "The derivative of coefficient times p by p is the coefficient.":
                        lambda r, p: Derivatives(r, p, factor=1.0),
                    "Constant where it should grow, and growing where it is constant.": lambda r, p: (
                        np.zeros_like(r), COEFFICIENT - Derivatives(r, p)[1])})},
        insight="Coulomb's law for small pressures, Tresca's for large ones, as metal forming uses it."),
    "10.3": Function(
        Right=lambda p, s, c, strength: Bound(p, c, strength) * np.sign(s), Data=Slips,
        hint="Where there is slip the bound is reached; which way does the body drag the foundation?",
        insight="The size from the bound, the direction from the slip: all of Coulomb's law in one line.",
        mistakes={
            "The shear has the direction of the slip: a sign is missing.": lambda p, s, c, strength: Bound(p, c, strength),
            "Wrong sign: tau is what the body exerts on the foundation, along the slip.":
                lambda p, s, c, strength: -Bound(p, c, strength) * np.sign(s),
            "The limit is missing.": lambda p, s, c, strength: c * p * np.sign(s),
            "Only the direction of the slip matters, not its size.": lambda p, s, c, strength: Bound(p, c, strength) * s}),
    "10.4": Choice(
        right=("b", 1), choices={"a": "The pressure law is at work at every point in contact, sticking or slipping.",
                                 "c": "A wrong sign would have changed the solution at every slipping point."},
        reasons={2: "They do: a wrong constant in a law makes the errors stagnate, as the negative control shows.",
                 3: "True, but the question is which branch of the solver was never run."},
        insight="Test each zone, and each change between zones; hence the solution with all three.")}
