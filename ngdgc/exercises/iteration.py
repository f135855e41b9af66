"""Exercises of notebook 5, Uzawa's iteration."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..contracts import Array
from .checker import Choice, Function


def Columns(rng: np.random.Generator) -> tuple[Any, ...]:
    return (rng.uniform(0, 9, 20), rng.uniform(0.1, 0.5, 20), rng.uniform(0, 0.2, 20), rng.uniform(10, 90, 20),
            rng.uniform(0.01, 0.05, 20))


def Factors(rng: np.random.Generator) -> tuple[Any, ...]:
    """Also a tolerance that is reached exactly, after 3 and after 2 steps."""
    return np.append(rng.uniform(0.05, 0.99, 18), (0.5, 0.25)), np.append(10 ** -rng.uniform(2, 12, 18), (0.125, 0.0625))


def Step(p: Array, d: Array, g: float | Array, k: float | Array, c: float | Array) -> Array:
    return k * np.maximum(d - c * p - g, 0)


def Steps(q: Array, tol: Array) -> Array:
    return np.log(tol) / np.log(q)


def Multipliers(rng: np.random.Generator) -> tuple[Any, ...]:
    return (rng.uniform(-2, 2, (30, 2)) * np.arange(30)[:, None] / 15,)


def Project(multiplier: Array) -> Array:
    return multiplier / np.maximum(np.linalg.norm(multiplier, axis=1), 1)[:, None]


EXERCISES = {
    "05.1": Function(
        Right=Step, Data=Columns, hint="The end of the column moves by d - c p; what does the law answer to that?",
        insight="The slope of this step is -k c where there is contact and 0 where there is none.",
        mistakes={
            "A foundation does not pull: where is the positive part?": lambda p, d, g, k, c: k * (d - c * p - g),
            "You forgot the gap.": lambda p, d, g, k, c: Step(p, d, 0, k, c),
            "Pressure shortens the column: mind the sign of c p.": lambda p, d, g, k, c: Step(-p, d, g, k, c),
            "The gap has the wrong sign: r = u_n - g.": lambda p, d, g, k, c: Step(p, d, -g, k, c),
            "The law gives a stress: penetration times stiffness.": lambda p, d, g, k, c: Step(p, d, g, 1, c),
            "That ignores that the column yields under the last pressure.": lambda p, d, g, k, c: Step(p, d, g, k, 0)}),
    "05.2": Function(
        Right=lambda q, tol: np.ceil(Steps(q, tol)), Data=Factors, hint="Solve q^i <= tol for i.",
        insight="The cost is that of 1/log(1/q), about 1/(1 - q): halving the distance of q from 1 doubles the steps.",
        mistakes={
            "A step is done or not: round, and in the direction that reaches the tolerance.": Steps,
            "Rounded in the wrong direction: the tolerance is just missed.": lambda q, tol: np.floor(Steps(q, tol)),
            "The tolerance may be reached exactly: then there is nothing to round up.":
                lambda q, tol: np.floor(Steps(q, tol)) + 1,
            "Rounding to the nearest number misses the tolerance half of the time.": lambda q, tol: np.round(Steps(q, tol)),
            "Wrong sign: both logarithms are negative.": lambda q, tol: np.ceil(-Steps(q, tol)),
            "Divide the logarithms the other way round.": lambda q, tol: np.ceil(1 / Steps(q, tol))}),
    "05.3": Function(
        Right=Project, Data=Multipliers, hint="Vectors inside the ball stay; others are shortened to length 1.",
        insight="In 2D friction has one component and this is clipping; in 3D it turns with the direction of the slip.",
        mistakes={
            "You clip components: that is a square, not a ball.": lambda m: np.clip(m, -1, 1),
            "Vectors inside the ball must stay as they are; you made all of them unit vectors.":
                lambda m: m / np.maximum(np.linalg.norm(m, axis=1), 1e-300)[:, None],
            "Nothing was projected.": lambda m: m,
            "Vectors outside the ball are to be shortened, not dropped.":
                lambda m: np.where(np.linalg.norm(m, axis=1)[:, None] > 1, 0, m)}),
    "05.4": Choice(
        right=("c", 2), choices={"a": "Look at the largest displacement of the runs that failed.",
                                 "b": "Look at the changes of the runs that failed: do they go to zero?"},
        reasons={1: "The matrix of this iteration does not contain the stiffness of the foundation.",
                 3: "P bounds friction; without friction the column cycles just the same."},
        insight="Watch for stagnation: an iteration that is bounded is not an iteration that converges.")}
