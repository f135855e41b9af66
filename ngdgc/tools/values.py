"""Numbers as arguments: Python's, fractions, decimals and numpy's are all the same; one conversion, one check."""

from __future__ import annotations

from collections.abc import Iterable
from decimal import Decimal
from numbers import Integral, Real
from typing import Any

import numpy as np

from ..contracts import Array
from .failures import ProblemError


HIGHEST = {2: 8, 3: 6}      # order of displacements and liftings up to which the tests go, by dimension


def IsNumber(value: Any) -> bool:
    """True for real numbers, arrays of one number without a dimension included, and False for truth values."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    return isinstance(value, (Real, Decimal)) and not isinstance(value, bool)


def Number(value: Any) -> float:
    """A number as a float, of Python's integers as it is; nan for one that no float holds."""
    try:
        number = float(value)
    except (OverflowError, ValueError):
        return np.nan
    return value if type(value) is int else number


def PositiveNumber(value: Any, name: str, remedy: str, *, below: float = np.inf, least: float | None = None) -> float:
    """The number, 0 < value < `below`, or least <= value; else ProblemError, which ends with the remedy."""
    number = Number(value) if IsNumber(value) else np.nan
    if not ((0 < number) if least is None else (least <= number)) or not number < below:
        raise ProblemError(f"{name} is {value!r}; {remedy}")
    return number


def Finite(value: Any, name: str, remedy: str = "give a finite number") -> float:
    """The number as a float; else ProblemError, which ends with the remedy."""
    number = Number(value) if IsNumber(value) else np.nan
    if not -np.inf < number < np.inf:
        raise ProblemError(f"{name} is {value!r}; {remedy}")
    return float(number)


def Among(value: Any, choices: Iterable[Any]) -> bool:
    """Is a value one of the choices, words, integers or None?  Arrays, which compare with each of them, are not."""
    return (value is None or isinstance(value, (str, Integral))) and value in choices


def Integer(value: Any, name: str, remedy: str, *, least: int = 1, most: int | None = None) -> int:
    """The integer, least <= value <= most, as Python's; else ProblemError, which ends with the remedy."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if isinstance(value, bool) or not isinstance(value, Integral) or int(value) < least or (
            most is not None and int(value) > most):
        raise ProblemError(f"{name} is {value!r}; {remedy}")
    return int(value)


def Order(value: Any, dim: int) -> int:
    """The order of a method on a mesh of this dimension; else ProblemError."""
    most = HIGHEST[dim]
    return Integer(value, "order", "it must be an integer of at least 1, piecewise constants carry no strain, and in "
                                   f"{dim}D at most {most}, up to which methods are tested", most=most)


def Vectors(value: Any, shape: tuple[int, ...], name: str, remedy: str) -> Array:
    """Real finite numbers as an array of this shape; else ProblemError, which ends with the remedy."""
    array = Reals(value, shape)
    if array is None:
        raise ProblemError(f"{name} is {value!r}; {remedy}")
    return array


def Reals(value: Any, shape: tuple[int, ...]) -> Array | None:
    """Real finite numbers as an array of this shape, or None for what is not."""
    try:
        # Entries of tuples are looked at one by one: among numbers numpy makes numbers of truth values.
        array = np.asarray(value, dtype=object if isinstance(value, (tuple, list)) else None)
    except ValueError:      # rows of different lengths
        return None
    if array.dtype.kind == "O":     # fractions, decimals, or no numbers
        array = np.reshape([Number(entry) if IsNumber(entry) else np.nan for entry in array.ravel()], array.shape)
    if array.dtype.kind not in "fiu" or array.shape != shape or not np.all(np.isfinite(array)):
        return None
    return np.array(array, dtype=float)
