"""Exercises of notebook 8, from normal compliance to Signorini."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..contracts import Array
from .checker import Choice, Function


def States(rng: np.random.Generator) -> tuple[Any, ...]:
    """Also without pressure, open and closed."""
    return rng.uniform(-1, 1, 30), np.where(np.arange(30) % 3 == 0, 0.0, rng.uniform(0, 5, 30)), 3.7


def Residual(r: Array, p: Array, gamma: float) -> Array:
    return p - np.maximum(p + gamma * r, 0)


def Errors(rng: np.random.Generator) -> tuple[Any, ...]:
    stiffnesses = np.cumprod(rng.uniform(2, 9, 6))
    return 4 / stiffnesses ** rng.uniform(0.5, 1.5), stiffnesses


def Powers(errors: Array, stiffnesses: Array) -> Array:
    return -np.diff(np.log(errors)) / np.diff(np.log(stiffnesses))


def Graph(rng: np.random.Generator) -> tuple[Any, ...]:
    return rng.uniform(-4, 9, 30), rng.uniform(1, 20, 30), 3.7


def Pressure(q: Array, k: Array, gamma: float) -> Array:
    return k / (k + gamma) * np.maximum(q, 0)


def Rings(rng: np.random.Generator) -> tuple[Any, ...]:
    return rng.uniform(0, 5, 12), np.cumsum(rng.uniform(0.1, 0.6, 12)), rng.uniform(0.1, 0.4, 12)


def RingForce(p: Array, r: Array, weights: Array) -> float:
    return float(2 * np.pi * weights @ (r * p))


EXERCISES = {
    "08.1": Function(
        Right=Residual, Data=States, hint="One positive part, of the sum.",
        insight="Three conditions in one equation without inequalities: the starting point of semismooth Newton methods.",
        mistakes={
            "The positive part is missing: without it p drops out.": lambda r, p, gamma: -gamma * r,
            "That is the residual of normal compliance with the stiffness gamma.":
                lambda r, p, gamma: p - gamma * np.maximum(r, 0),
            "gamma multiplies r: stresses are added to stresses.": lambda r, p, gamma: p - np.maximum(p + r, 0),
            "Without pressure the point may be in the foundation all the same: that is no solution either.":
                lambda r, p, gamma: np.where(p > 0, Residual(r, p, gamma), 0),
            "r counts into the foundation: mind its sign.": lambda r, p, gamma: Residual(-r, p, gamma),
            "That is the product p r: it forgets the two inequalities.": lambda r, p, gamma: p * r}),
    "08.2": Function(
        Right=Powers, Data=Errors, hint="Take logarithms of e = c k^-alpha on two neighbours and eliminate c.",
        insight="As for orders in h, with 1/k in the place of h.",
        mistakes={
            "Divide by the logarithm of the ratio of the stiffnesses.": lambda e, k: -np.diff(np.log(e)),
            "The stiffnesses are given, they do not grow tenfold.": lambda e, k: -np.diff(np.log10(e)),
            "Divide the logarithms the other way round.": lambda e, k: 1 / Powers(e, k),
            "Ratios are no powers yet.": lambda e, k: e[:-1] / e[1:]}),
    "08.3": Function(
        Right=Pressure, Data=Graph, hint="Put r = p/k, where there is contact, into q = p + gamma r and solve for p.",
        insight="Its slope is at most 1 for every stiffness, and (q)_+ for k = infinity: nothing blows up.",
        mistakes={
            "A foundation does not pull: the positive part is missing.": lambda q, k, gamma: k / (k + gamma) * q,
            "That is the limit of infinite stiffness.": lambda q, k, gamma: np.maximum(q, 0),
            "That is the part gamma r of q; the rest is p.": lambda q, k, gamma: np.maximum(q, 0) - Pressure(q, k, gamma),
            "That is the penetration; multiply by the stiffness.": lambda q, k, gamma: np.maximum(q, 0) / (k + gamma),
            "q is no penetration: it contains p itself.": lambda q, k, gamma: k * np.maximum(q, 0)}),
    "08.4": Choice(
        right=("a", 1), choices={"b": "Look at the second line of the last picture: which power of h has its stiffness?",
                                 "c": "Look at the first line of the last picture on the finest meshes."},
        reasons={2: "The question is about the energy error, of order 1.",
                 3: "True, and just why a fixed stiffness would stop the convergence; but how large is that error?"},
        insight="Model error and discretisation error should be balanced: 1/k of the size of h."),
    "08.5": Function(
        Right=RingForce, Data=Rings, hint="Over which area is the pressure of a point of the section spread, all around?",
        insight="`solution.weights` of a body of revolution have 2 pi r in them, so that weights @ pressure is the force.",
        mistakes={
            "That is the force per length of a roller; here each point stands for a ring.":
                lambda p, r, weights: float(weights @ p),
            "That is the force of a wedge of one radian; all around there are 2 pi.":
                lambda p, r, weights: float(weights @ (r * p)),
            "A ring has the circumference 2 pi r.": lambda p, r, weights: RingForce(p, r, weights) / 2,
            "Each point has a radius of its own, by which its pressure counts.":
                lambda p, r, weights: float(2 * np.pi * r.mean() * (weights @ p))})}
