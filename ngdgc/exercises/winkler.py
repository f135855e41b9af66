"""Exercises of notebook 1, the Winkler column."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..problem.materials import HookeMaterial
from .checker import Choice, Function, Value

E, NU, HEIGHT, GAP, STIFFNESS, PRESSURE = 5, 0.45, 40, 0.5, 0.2, 0.3     # of the rubber pad [N, mm]
PAD = HookeMaterial(E=E, nu=NU)
MODULUS = PAD.lam + 2 * PAD.mu


def Settlement(gap: float = GAP, depth: float = PRESSURE / STIFFNESS, modulus: float = MODULUS) -> float:
    return gap + depth + PRESSURE * HEIGHT / modulus


def Loads(rng: np.random.Generator) -> tuple[Any, ...]:
    """Also no load, for which the column just touches, and m = 1."""
    return (np.append(0, rng.uniform(1, 5, 19)), rng.uniform(10, 90, 20), np.append(rng.uniform(0.5, 3, 19), 1),
            rng.uniform(0.1, 1, 20))


EXERCISES = {
    "01.1": Value(
        Right=Settlement, tol=2e-3,
        hint="The top moves by three things: the gap, the penetration and the compression of the pad.",
        insight="Gap, penetration and compression add up; the modulus is that of a column that cannot bulge.",
        mistakes={
            "You forgot the gap: the pad has to cross it before anything resists.": lambda: Settlement(gap=0),
            "You forgot that the pad itself is compressed.": lambda: Settlement() - PRESSURE * HEIGHT / MODULUS,
            "That is the compression of the pad alone; the soil yields too.": lambda: PRESSURE * HEIGHT / MODULUS,
            "Between walls the pad cannot bulge: Young's modulus is not its stiffness.": lambda: Settlement(modulus=E),
            "The modulus between walls is not lam + mu.": lambda: Settlement(modulus=PAD.lam + PAD.mu),
            "The gap separates pad and soil, it is not part of the penetration to subtract.": lambda: Settlement(gap=-GAP)}),
    "01.2": Function(
        Right=lambda P, k, m, g: g + (P / k) ** (1 / m), Data=Loads, hint="Solve p_n(u_n - g) = P for u_n.",
        insight="The law turned around.  Without a load it gives the gap: the column just touches.",
        mistakes={
            "You forgot the gap: that is the penetration.": lambda P, k, m, g: (P / k) ** (1 / m),
            "The exponent of the law is to be inverted, too.": lambda P, k, m, g: g + (P / k) ** m,
            "That is the formula for m = 1 only.": lambda P, k, m, g: g + P / k,
            "The gap is subtracted from u_n, so it is added when you solve for u_n.": lambda P, k, m, g: (P / k) ** (1 / m) - g,
            "The stiffness divides before the root is taken.": lambda P, k, m, g: g + P ** (1 / m) / k}),
    "01.3": Value(
        Right=lambda: MODULUS / HEIGHT, tol=2e-3, hint="Set penetration and compression equal; the load drops out.",
        insight="(lam + 2 mu)/H is the stiffness of the pad as a spring.  Contact is hard or soft compared with that.",
        mistakes={
            "Between walls the pad cannot bulge: Young's modulus is not its stiffness.": lambda: E / HEIGHT,
            "Turn it around: that is a length per stress.": lambda: HEIGHT / MODULUS,
            "A longer pad is softer: divide by the height.": lambda: MODULUS * HEIGHT,
            "That is a modulus [N/mm2]; a stiffness of soil is [N/mm3].": lambda: MODULUS,
            "The gap costs displacement but no force; it is no part of either share.":
                lambda: PRESSURE / (GAP + PRESSURE * HEIGHT / MODULUS)}),
    "01.4": Choice(
        right=("b", 2), choices={"a": "Cut the column free just above the soil: which force must the soil balance?",
                                 "c": "The load is given here, not the displacement of the top.  What balances the load?"},
        reasons={1: "There is only one path for the load: through the pad into the soil.",
                 3: "The displacement of the top is not given; it adjusts."},
        insight="Statics decides the pressure, the law of the soil the penetration; the pad only settles less above it.")}
