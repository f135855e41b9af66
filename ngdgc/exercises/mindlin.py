"""Exercises of notebook 12, Mindlin's loop."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..contracts import Array
from .checker import Choice, Function


def Shears(rng: np.random.Generator) -> tuple[Any, ...]:
    return rng.uniform(0, 6, 20), 20.0, 0.4


def Places(rng: np.random.Generator) -> tuple[Any, ...]:
    return rng.uniform(-0.3, 0.6, 20), 0.6, 8.0, 0.9


def States(rng: np.random.Generator) -> tuple[Any, ...]:
    places = np.cumsum(rng.uniform(-1, 1, (6, 9)), axis=0)
    return rng.uniform(-3, 3, (6, 9)), places, rng.uniform(0.1, 0.5, 9)


def First(s: Array, limit: float, slide: float) -> Array:
    return limit * (1 - (1 - s / slide) ** 1.5)


def Back(s: Array, largest: float, limit: float, slide: float, *, twice: float = 2.0, half: float = 2.0) -> Array:
    return First(np.asarray(largest), limit, slide) - twice * First((largest - s) / half, limit, slide)


EXERCISES = {
    "12.1": Function(
        Right=lambda Q, P, mu: np.sqrt(1 - Q / (mu * P)), Data=Shears,
        hint="Everything sticks for Q = 0, and nothing for Q = mu P.",
        insight="A small shear makes the edges slip at once, where the pressure that presses them is small.", mistakes={
            "That is the part of the pressure that is left over; its root is missing.": lambda Q, P, mu: 1 - Q / (mu * P),
            "That is the formula for balls, with a third root.": lambda Q, P, mu: np.cbrt(1 - Q / (mu * P)),
            "The shear is held against the normal force without the coefficient of friction.":
                lambda Q, P, mu: np.sqrt(1 - Q / P),
            "That is the part of the contact that slips.": lambda Q, P, mu: 1 - np.sqrt(1 - Q / (mu * P))}),
    "12.2": Function(
        Right=Back, Data=Places, hint="Slip back changes the friction of a point from + to -, by twice the bound.",
        insight="Masing's rule: a way back is the first way, twice as large; it holds as long as the pressure stays the same.",
        mistakes={
            "That goes back along the first way, as if friction did not remember.": lambda s, largest, limit, slide: First(
                np.maximum(s, 0), limit, slide),
            "The way since the turn must be halved as the force is doubled.": lambda s, largest, limit, slide: Back(
                s, largest, limit, slide, half=1.0),
            "The way back is twice as large as the first one: a factor is missing before it.":
                lambda s, largest, limit, slide: Back(s, largest, limit, slide, twice=1.0)}),
    "12.3": Function(
        Right=lambda sigma, u, weights: float(-np.sum(weights * sigma[1:] * np.diff(u, axis=0))), Data=States,
        hint="Changes of u_t from one state to the next, with the friction at the end of each.",
        insight="Backward Euler: so friction never gives energy back, and the balance closes as the increments are halved.",
        mistakes={
            "That takes the friction at the beginning of each increment; backward Euler takes that at its end.":
                lambda sigma, u, weights: float(-np.sum(weights * sigma[:-1] * np.diff(u, axis=0))),
            "Points stand for different lengths: the weights are missing.":
                lambda sigma, u, weights: float(-np.sum(sigma[1:] * np.diff(u, axis=0))),
            "Slip counts from the state before, not from the undeformed body.":
                lambda sigma, u, weights: float(-np.sum(weights * sigma * u))}),
    "12.4": Choice(
        right=("b", 2), choices={"a": "Look at the loop where it crosses the abscissa 0.",
                                 "c": "Is that force a push along the pull, or against it?  Look at the sign."},
        reasons={1: "Without friction nothing would be left, however elastic the bodies are.",
                 3: "The middle never slips, in none of the states."},
        insight="What is locked in is paid for by the next pull: the loop is what memory looks like.")}
