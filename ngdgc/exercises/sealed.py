"""Exercises without their formulas, for the package of students: what right and wrong answers return on the checker's data.

A sealed exercise says of every answer what the exercise says that it was made of.  Of functions the file holds nothing but
numbers; of values and choices it holds the answer, compressed: that keeps it from eyes, not from a student who programs.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from ..contracts import Array
from .checker import AsNumbers, Choice, Function, Law, Value
from .effectivity import Estimator, Series


@dataclass(frozen=True)
class Returns:
    """A function that is known by what it returned: {its arguments as text: numbers}."""

    values: Mapping[str, Any]

    def __call__(self, *arguments: Any) -> Array:
        return np.array(self.values[_Text(arguments)], dtype=float)


def Seal(exercises: Mapping[str, Any], *, answers: bool = True) -> bytes:
    """The file of exercises {name: exercise}; without answers it has their names alone, and the checker takes note.

    >>> choice = Choice(right=("a", 1), choices={"b": "no"}, reasons={2: "no"}, insight="yes")
    >>> Unseal(Seal({"01.1": choice}))["01.1"] == choice, Unseal(Seal({"01.1": choice}, answers=False))
    (True, {'01.1': None})
    """
    return zlib.compress(json.dumps({name: _Packed(one) if answers else None for name, one in exercises.items()}).encode(), 9)


def Unseal(file: bytes) -> dict[str, Any]:
    """{name: exercise, or None} of a file of `Seal`."""
    return {name: packed and _Unpacked(packed) for name, packed in json.loads(zlib.decompress(file)).items()}


def _Packed(exercise: Any) -> dict[str, Any]:
    """Kind, words and numbers of an exercise, as JSON takes them; TypeError for a kind that is not known here."""
    words = {key: value for key, value in getattr(exercise, "__dict__", {}).items() if isinstance(value, (str, float))}
    mistakes = getattr(exercise, "mistakes", {}).items()
    inside: dict[str, Any]
    match exercise:
        case Choice():
            inside = {"right": exercise.right, "choices": dict(exercise.choices), "reasons": list(exercise.reasons.items())}
        case Law():
            inside = {"methods": {name: _Packed(method) for name, method in exercise.methods.items()}}
        case Value():
            inside = {"right": _Numbers(exercise.Right()), "mistakes": [(hint, _Numbers(Wrong())) for hint, Wrong in mistakes]}
        case Function():
            inside = {"arguments": _Written(exercise.Arguments()), "right": _Numbers(exercise.Right(*exercise.Arguments())),
                      "mistakes": [(hint, _Numbers(Wrong(*exercise.Arguments()))) for hint, Wrong in mistakes]}
        case Estimator():
            samples = [(series, list(series.Samples())) for series in exercise.series]
            given = [estimate for _, some in samples for estimate, _ in some]
            inside = {"series": [(series.words, series.wanted, [(_Written([exercise.Given(one)]), true) for one, true in some])
                                 for series, some in samples],
                      "mistakes": [(hint, [_Numbers(Wrong(exercise.Given(one))) for one in given]) for hint, Wrong in mistakes]}
        case _:
            raise TypeError(f"there is no way to seal a {type(exercise).__name__}")
    return {"kind": type(exercise).__name__, "words": words, **inside}


def _Unpacked(packed: Mapping[str, Any]) -> Any:
    words = packed["words"]
    match packed["kind"]:
        case "Choice":
            return Choice(right=tuple(packed["right"]), choices=packed["choices"], reasons=dict(packed["reasons"]), **words)
        case "Law":
            return Law(methods={name: _Unpacked(method) for name, method in packed["methods"].items()}, **words)
        case "Value":
            return Value(Right=_Known([[]], [packed["right"]]), **words,
                         mistakes={hint: _Known([[]], [value]) for hint, value in packed["mistakes"]})
        case "Function":
            given = packed["arguments"]
            return Function(Right=_Known([given], [packed["right"]]), Data=lambda rng: _Read(given), **words,
                            mistakes={hint: _Known([given], [value]) for hint, value in packed["mistakes"]})
        case _:
            samples = [argument for _, _, some in packed["series"] for argument, _ in some]
            return Estimator(series=[Series(words=said, wanted=wanted, Samples=partial(list, some))
                                     for said, wanted, some in packed["series"]],
                             Given=_First, **words,
                             mistakes={hint: _Known(samples, values) for hint, values in packed["mistakes"]})


def _Known(arguments: Iterable[Any], values: Iterable[Any]) -> Returns:
    """What returns these values for these arguments, both as they are packed."""
    return Returns({_Text(_Read(one)): value for one, value in zip(arguments, values)})


def _Numbers(value: Any) -> Any:
    return AsNumbers(value).tolist()


def _Written(arguments: Iterable[Any]) -> list[Any]:
    """Arguments as JSON takes them: arrays with their types, numbers, and dictionaries of numbers."""
    return [{"array": one.tolist(), "type": one.dtype.str} if isinstance(one, np.ndarray) else
            {"parts": {key: float(part) for key, part in one.items()}} if isinstance(one, dict) else float(one)
            for one in arguments]


def _Read(written: Iterable[Any]) -> tuple[Any, ...]:
    """New arguments, as a function may write into them."""
    return tuple(one if isinstance(one, float) else dict(one["parts"]) if "parts" in one else
                 np.array(one["array"], one["type"]) for one in written)


def _First(written: Any) -> Any:
    return _Read(written)[0]


def _Text(arguments: Iterable[Any]) -> str:
    return json.dumps(_Written(arguments))
