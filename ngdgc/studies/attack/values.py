"""Values that nobody should give, but somebody does: of wrong types, extreme sizes, shapes and contents."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
from ngsolve import CF, GridFunction, H1, IfPos, L2, Mesh, Parameter, VectorH1, sin, specialcf, sqrt, x, y

from ...contracts import Array
from ...problem.laws import ComplianceLaw, FrictionLaw

NUMBERS = (0, -1, 1, 2, 3, 0.5, -0.5, 1.5, -0.0, 1e-300, 1e300, -1e300, 1e-12, 1e12, 10 ** 30, 2 ** 63, 10 ** 400, float("nan"),
           float("inf"), -float("inf"), True, False, 1j, Fraction(1, 3), Fraction(-7, 2), Decimal("0.3"), Decimal("NaN"))
ARRAYS = (np.float32(0.3), np.float64(2), np.int8(2), np.int64(-3), np.bool_(True), np.complex128(1j), np.array(0.3),
          np.array([1.0, 2.0]), np.array([1, 2, 3]), np.ones((2, 3)), np.ones(0), np.array([np.nan, 1]), np.array(["a", "b"]),
          np.array([None, 1], dtype=object), np.array([1 + 1j, 0]))
WORDS = ("", "a", "auto", "adaptive", "top", "bottom", "left|right", ".*", "nowhere", "(", "(?i)top", "\\", "a\0b", "ä€",
         b"top", "stress", "edge", "lifting", "None", "1", "x" * 1000)
THINGS: tuple[Any, ...] = (
    None, ..., NotImplemented, [], (), {}, set(), frozenset([1]), range(3), slice(0, 1), [None], (1, 2), [0.0, -0.1], (1, 2, 3),
    (0, 0, 0, 0), ((1, 2), (3, 4)), [[1, 2], [3]], {"top": 1}, {"top": (0, 0)}, {"nowhere": (0, 0)}, {1: 2}, {None: None}, int,
    len, print, object, ValueError, ValueError("no"))


class OddLaw(ComplianceLaw):
    """p_n = 300 r_+, but for one thing."""

    def __init__(self, kind: str) -> None:
        self.kind = kind

    def Pressure(self, r: Array) -> Any:
        return Odd(self.kind, 300 * np.maximum(r, 0), r)

    def PressureDerivative(self, r: Array) -> Any:
        return 300.0 * (r > 0)


class OddFriction(FrictionLaw):
    """p_t = 0.3 p_n, but for one thing."""

    def __init__(self, kind: str) -> None:
        self.kind = kind

    def Bound(self, r: Array, p: Array) -> Any:
        return Odd(self.kind, 0.3 * p, r)


def Odd(kind: str, values: Array, r: Array) -> Any:
    """What the method of such a law returns; of the kind "raising" nothing, and KeyError."""
    if kind == "in place":
        r[:] = np.nan
    return {"complex": values * (1 + 1j), "nan": np.where(r > 1e-3, np.nan, values), "list": list(values), "none": None,
            "infinite": np.where(r > 0.5, np.inf, values), "negative": -values, "flat": values[:, None],
            "text": values.astype(str), "number": values.max(initial=0), "in place": values}[kind]


ODD = ("raising", "complex", "nan", "list", "none", "infinite", "negative", "flat", "text", "number", "in place")


def Functions(mesh: Mesh) -> tuple[Any, ...]:
    """CoefficientFunctions of all kinds."""
    gfu, inside = GridFunction(H1(mesh, order=1)), GridFunction(L2(mesh, order=0))
    return (x, CF(0), CF(1), CF((1, 2)), CF((1, 2, 3)), CF(1j), CF((1j, 0)), CF(((1, 2), (3, 4))), 1 / (x - x), sqrt(-1 - x),
            1e300 * x, IfPos(x - 0.5, 1, -1), Parameter(1), Parameter(-1) * y, specialcf.normal(mesh.dim), specialcf.mesh_size,
            sin(100 * x), gfu, inside, mesh.BoundaryCF({"top": 1}) + x, mesh.BoundaryCF({"top": 1}, default=0),
            gfu.space.TrialFunction(), GridFunction(VectorH1(mesh, order=1)))


def Hostile(rng: np.random.Generator, mesh: Mesh) -> Any:
    """A value that is drawn from all of them."""
    pools = NUMBERS, ARRAYS, WORDS, THINGS, Functions(mesh), [OddLaw(kind) for kind in ODD], [OddFriction(kind) for kind in ODD]
    pool = pools[rng.choice(len(pools), p=(0.3, 0.15, 0.15, 0.15, 0.15, 0.05, 0.05))]
    return pool[rng.integers(len(pool))]


def Spoiled(value: Any, rng: np.random.Generator, mesh: Mesh) -> Any:
    """A value with something hostile in its place, or inside of it."""
    if isinstance(value, dict) and value and rng.random() < 0.7:
        key = list(value)[rng.integers(len(value))]
        if rng.random() < 0.7:
            return {**value, key: Spoiled(value[key], rng, mesh)}
        try:
            return {Hostile(rng, mesh): value[key]}
        except TypeError:       # no key of a dictionary
            return {**value, "nowhere": value[key]}
    if isinstance(value, (tuple, list)) and value and rng.random() < 0.7:
        number = rng.integers(len(value))
        return type(value)(Spoiled(one, rng, mesh) if number == other else one for other, one in enumerate(value))
    return Hostile(rng, mesh)
