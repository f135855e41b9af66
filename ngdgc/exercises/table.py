"""Exercises of notebook 7, Table 3."""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import Integrate, ds

from ..cases import example_4_1
from ..contracts import Array
from ..errors import Rates
from ..problem.materials import HookeMaterial
from ..studies.table3 import PUBLISHED
from .checker import Choice, Function, Value


def Materials(rng: np.random.Generator) -> tuple[Any, ...]:
    """Also without lateral contraction."""
    return rng.uniform(10, 3000, 20), np.append(0, rng.uniform(0.05, 0.48, 19))


def Lam(E: Array, nu: Array, plane: str) -> Array:
    return np.array([HookeMaterial(E=a, nu=b, plane=plane).lam for a, b in zip(E, nu)])


def Mu(E: Array, nu: Array) -> Array:
    return E / (2 * (1 + nu))


def Halved(E: Array, nu: Array) -> Array:
    """2 lam mu/(lam + mu), a slip of the pen."""
    lam, mu = Lam(E, nu, "strain"), Mu(E, nu)
    return 2 * lam * mu / (lam + mu)


def Load(component: int) -> float:
    """Size of the force of the traction of Example 4.1 in a direction."""
    (region, traction), = example_4_1.Problem().traction.items()
    mesh = example_4_1.Mesh(4)
    return abs(Integrate(traction[component] * ds(definedon=mesh.Boundaries(region)), mesh))


EXERCISES = {
    "07.1": Function(
        Right=lambda E, nu: Lam(E, nu, "stress"), Data=Materials,
        hint="Eliminate eps_zz from sigma_zz = 0, or use lam* = 2 lam mu/(lam + 2 mu).",
        insight="E nu/(1 - nu^2).  It stays finite as nu goes to 1/2: plane stress does not lock.",
        mistakes={
            "That is lam of plane strain (and of three dimensions).": lambda E, nu: Lam(E, nu, "strain"),
            "That is mu.": Mu,
            "The denominator is lam + 2 mu.": Halved,
            "That is the whole modulus lam* + 2 mu.": lambda E, nu: E / (1 - nu ** 2)}),
    "07.2": Value(
        Right=lambda: Rates(PUBLISHED["4.2"]), hint="Logarithms of ratios of neighbours to the base 2: the meshes are halved.",
        insight="Below 1 and growing: the corners between clamped and loaded sides are singular.",
        mistakes={
            "That is the column of Example 4.1.": lambda: Rates(PUBLISHED["4.1"]),
            "Divide by log 2: the meshes are halved.": lambda: Rates(PUBLISHED["4.2"]) * np.log(2),
            "Those are the ratios of the errors; take their logarithm to the base 2.": lambda: 2 ** Rates(PUBLISHED["4.2"])}),
    "07.3": Value(
        Right=lambda: 1 / Load(0), tol=2e-3, hint="Integrate the horizontal traction over the side, for the y that are given.",
        insight="A thousandth: what a table of errors of several per cent cannot see.",
        mistakes={
            "The side goes from y = 0.05 to 1.05, not from 0 to 1.": lambda: 1 / (200 * (5 - 0.5)),
            "Turn it around: friction by load.": lambda: Load(0),
            "That is the vertical load.": lambda: 1 / Load(1),
            "The traction is a function of y: integrate it.": lambda: 1 / (200 * 5),
            "A number was asked for, not per cent.": lambda: 100 / Load(0)}),
    "07.4": Choice(
        right=("b", 1), choices={"a": "Look at the errors without friction.",
                                 "c": "Look at nearly incompressible materials: what happens to 30 mu?"},
        reasons={2: "Orders are a matter of the discretisation; a wrong law can be discretised with the right order.",
                 3: "True, and a weakness, but without friction the same reference gives the same table."},
        insight="A test shows what it is sensitive to.  Ask of every benchmark which mistake it would not notice.")}
