"""Exercises of notebook 2, H1 against DG."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..contracts import Array
from .checker import Choice, Function


def Sizes(rng: np.random.Generator) -> tuple[Any, ...]:
    return rng.integers(2, 9, 12), rng.integers(1, 6, 12)


def Errors(rng: np.random.Generator) -> tuple[Any, ...]:
    sizes = np.cumprod(rng.uniform(0.3, 0.7, 5))
    return 3 * sizes ** rng.uniform(1, 3), sizes


def Orders(errors: Array, sizes: Array) -> Array:
    return np.log(errors[:-1] / errors[1:]) / np.log(sizes[:-1] / sizes[1:])


EXERCISES = {
    "02.1": Function(
        Right=lambda n, k: 2 * n * n * (k + 1) * (k + 2), Data=Sizes,
        hint="Count: triangles, times polynomials of degree k in two variables, times components of a displacement.",
        insight="Every triangle has (k+1)(k+2)/2 polynomials for each component, and shares none of them.",
        mistakes={
            "A displacement has two components.": lambda n, k: n * n * (k + 1) * (k + 2),
            "Every square holds two triangles, and a displacement has two components.":
                lambda n, k: n * n * (k + 1) * (k + 2) // 2,
            "(k+1)^2 counts the polynomials of a square; on a triangle the total degree is k.":
                lambda n, k: 4 * n * n * (k + 1) ** 2,
            "That is the count of continuous elements: here nothing is shared.": lambda n, k: 2 * (n * k + 1) ** 2}),
    "02.2": Function(
        Right=lambda n, k: 2 * (n * k + 1) ** 2, Data=Sizes,
        hint="Values at a lattice determine a continuous piecewise polynomial; how many points has it along one side?",
        insight="A lattice of nk + 1 points in each direction; for large n DG has (k+1)(k+2)/k^2 times as many.",
        mistakes={
            "A displacement has two components.": lambda n, k: (n * k + 1) ** 2,
            "n intervals have n + 1 ends.": lambda n, k: 2 * (n * k) ** 2,
            "That is right for k = 1: edges and triangles carry unknowns, too.": lambda n, k: 2 * (n + 1) ** 2,
            "That is the count of discontinuous elements: here neighbours share.":
                lambda n, k: 2 * n * n * (k + 1) * (k + 2)}),
    "02.3": Function(
        Right=Orders, Data=Errors, hint="Put e = c h^p on two meshes and eliminate c.",
        insight="The logarithm of a ratio by the logarithm of a ratio; c and the base of the logarithm drop out.",
        mistakes={
            "You took the meshes for halved; the sizes are given.": lambda e, h: np.log2(e[:-1] / e[1:]),
            "Divide by the logarithm of the ratio of the sizes.": lambda e, h: np.log(e[:-1] / e[1:]),
            "Ratios of errors are no orders yet: e = c h^p has p in the exponent.": lambda e, h: e[:-1] / e[1:],
            "That is 1/p: error over size, not size over error.": lambda e, h: 1 / Orders(e, h)}),
    "02.4": Choice(
        right=("b", 1), choices={"a": "What did GlobalImbalance say about H1?",
                                 "c": "What did the averages of H1 do on a single element?"},
        reasons={2: "The order says how fast an error shrinks; a balance is exact, up to round-off, or it is not.",
                 3: "Quadrature can be made as exact as one likes; the imbalance on elements stays."},
        insight="A balance is a test function: what the space contains is balanced, whatever the error.")}
