"""Laws of users: their methods get arrays of their own, and what they return is looked at before it is used."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from ..contracts import Array
from ..exceptions import ProblemError

VALUES = ("Pressure", "PressureDerivative", "Bound", "Depth")    # methods that return an array
ROUNDOFF = 1e-9     # relative, between numpy's ways through short and long arrays
PAIRS = ("BoundDerivatives", "Coefficient")             # methods that return two of them


class UserLaw:
    """A law whose methods are called with copies, and return float arrays (npoints,) of their own; else ProblemError.

    All else is the law's own.  Values may be infinite or no number: a law may end at some penetration that never occurs.
    """

    def __init__(self, law: Any) -> None:
        self.law = law

    def __getattr__(self, name: str) -> Any:
        law = object.__getattribute__(self, "law")      # which a copy that is being made has not yet
        value = getattr(law, name)
        return partial(_Call, law, name, value) if name in VALUES + PAIRS else value


def Watched(law: Any) -> Any:
    """A `UserLaw` of the law, unless it is one of the package's own classes or None."""
    return law if law is None or isinstance(law, UserLaw) or type(law).__module__ == f"{__package__}.laws" else UserLaw(law)


def LawName(law: Any) -> str:
    return type(law.law if isinstance(law, UserLaw) else law).__name__


def CheckPointwise(law: Any, method: str, *arguments: Any) -> None:
    """Raise ProblemError unless a `UserLaw` gives at every point what it gives for that point alone, whenever it is asked."""
    if not isinstance(law, UserLaw):
        return
    Value = getattr(law, method)
    with np.errstate(all="ignore"):
        together = np.atleast_2d(Value(*arguments))
        alone = np.hstack([np.atleast_2d(Value(*point)) for point in np.stack(arguments, axis=1)[..., None]])
    if not np.allclose(together, alone, rtol=ROUNDOFF, atol=0, equal_nan=True):
        raise ProblemError(f"{LawName(law)}.{method} gives another value at a point alone than among others, or when it is "
                           "asked again; a law is a function of its arguments at the point: use numpy's functions of "
                           "each entry, and keep no state")


def _Call(law: Any, name: str, method: Any, *arguments: Any) -> Any:
    words, shape = f"{type(law).__name__}.{name}", np.broadcast_shapes(*map(np.shape, arguments))
    try:
        # Its own arrays: a law may work in place on what it is given.
        result = method(*(np.array(argument, dtype=float) for argument in arguments))
    except ProblemError:
        raise
    except Exception as error:
        raise ProblemError(f"{words} raises {type(error).__name__} ({error}); it is called with arrays (npoints,) and must "
                           "return values there; mend the law") from error
    if name in VALUES:
        return _Values(result, shape, words)
    if not isinstance(result, (tuple, list)) or len(result) != 2:
        what = "its derivatives by r and by p" if name == "BoundDerivatives" else "the factor and its derivative"
        raise ProblemError(f"{words} returns {_Kind(result)}; give the pair of {what}, one value per point each")
    return tuple(_Values(part, shape, words) for part in result)


def _Values(result: Any, shape: tuple[int, ...], words: str) -> Array:
    """What a method has returned as a float array, (npoints,); a number counts everywhere."""
    values = np.asarray(result)
    if values.dtype.kind == "c":
        raise ProblemError(f"{words} returns complex values; give real ones, an array (npoints,)")
    if not isinstance(result, np.ndarray) and values.shape or values.dtype.kind not in "fiub":
        raise ProblemError(f"{words} returns {_Kind(result)}; give an array (npoints,) of numbers, numpy's functions make it")
    if values.dtype in (np.float16, np.float32) and "Derivative" not in words:
        raise ProblemError(f"{words} returns {values.dtype}, whose digits are too few for an iteration; give float64, numpy's "
                           "own floats")
    if values.shape not in ((), shape):
        raise ProblemError(f"{words} returns shape {values.shape} for arguments of shape {shape}; give one value per point, an "
                           "array (npoints,)")
    return np.array(Each(values, shape), dtype=float)


def Each(values: Any, shape: tuple[int, ...]) -> Array:
    """What a law returns at points, or once for all, as one value at each, (npoints,)."""
    # NumPy takes longer than most laws to see that there is nothing to do.
    return values if np.shape(values) == shape else np.broadcast_to(values, shape)


def _Kind(result: Any) -> str:
    if isinstance(result, np.ndarray):
        return f"an array of shape {result.shape} and type {result.dtype}"
    return f"a {type(result).__name__}"
