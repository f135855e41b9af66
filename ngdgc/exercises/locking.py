"""Exercises of notebook 9, locking."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from ..contracts import Array, Method
from ..methods.conforming import Conforming
from ..studies import locking
from .checker import Choice, Function, Value


def Materials(rng: np.random.Generator) -> tuple[Any, ...]:
    """Also without lateral contraction."""
    return rng.uniform(1, 3000, 20), np.append(0, rng.uniform(0.05, 0.499, 19))


def Lam(E: Array, nu: Array) -> Array:
    return E * nu / ((1 + nu) * (1 - 2 * nu))


@cache
def Growth(method: Method, *, order: int = 2, n: int = 4, last: float = 1e4) -> float:
    return locking.Study(method, order=order, n=n, lam=(1, last)).factor


def Counts() -> Array:
    """Leading terms of 2 (k n + 1)^2 and 2 n^2 (k + 1)(k + 2) over 2 n^2 times dim P_(k-1)."""
    return np.array([2 * 1 ** 2 / (2 * 1), 2 * 2 * 3 / (2 * 1), 2 * 2 ** 2 / (2 * 3)])


EXERCISES = {
    "09.1": Function(
        Right=Lam, Data=Materials, hint="lam = 2 mu nu/(1 - 2 nu) with mu = E/(2 (1 + nu)).",
        insight="The factor 1 - 2 nu in the denominator is the incompressible limit.",
        mistakes={
            "mu = E/(2 (1 + nu)): the factor 1 + nu is missing.": lambda E, nu: E * nu / (1 - 2 * nu),
            "That is plane stress, which does not become incompressible.": lambda E, nu: E * nu / (1 - nu ** 2),
            "That is mu.": lambda E, nu: E / (2 * (1 + nu)),
            "That is the bulk modulus lam + 2 mu/3.": lambda E, nu: E / (3 * (1 - 2 * nu))}),
    "09.2": Value(
        Right=Counts, tol=0.01, hint="Unknowns grow like a multiple of n^2, and so do conditions; divide the factors.",
        insight="Between 1 and 2 is where one begins to worry; but a count is a heuristic, not a theorem.",
        mistakes={
            "A displacement has two components.": lambda: Counts() / 2,
            "There are two triangles in every square.": lambda: 2 * Counts(),
            "For k = 2 the divergence has three coefficients on every triangle.": lambda: Counts() * [1, 1, 3],
            "Turn it around: unknowns by conditions.": lambda: 1 / Counts()}),
    "09.3": Value(
        Right=lambda: Growth(Conforming()), tol=0.02, hint="locking.Study(Conforming(), order=2, n=4, lam=(1, 1e4)).factor",
        insight="An error that grows although the solution stays smooth: that is how locking is defined.",
        mistakes={
            "Hardly any growth: are method and degree those that were asked for?": lambda: Growth(Conforming(), order=1),
            "That is the mesh with n = 8.": lambda: Growth(Conforming(), n=8),
            "That is for lam up to 1e6.": lambda: Growth(Conforming(), last=1e6),
            "Last by first, not first by last.": lambda: 1 / Growth(Conforming())}),
    "09.4": Choice(
        right=("b", 2), choices={"a": "The locked pad of this notebook balances and converges as well.",
                                 "c": "Not with every element: look at the table of forces."},
        reasons={1: "A locked solution is the exact solution of a discrete problem, and balanced.",
                 3: "Then DG would lock, too."},
        insight="Ask another discretisation: another degree, another method.  That is why ngdgc has several.")}
