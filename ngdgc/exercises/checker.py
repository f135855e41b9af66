"""How an answer is graded: kinds of answers, what they are compared with, and the hint that fits the mistake.

A kind of answer has `Hint(answer)`, None if the answer is right, else a sentence that helps without the answer in it.  Right
values are computed when they are asked for; so are typical wrong ones, each with its own hint.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from html import escape
from numbers import Number
from typing import Any, ClassVar

import numpy as np

from ..contracts import Array
from ..tools import sparse as sp

SEED = 6                            # of the data on which functions are tried
CLOSE = 0.1                         # relative error from which on an answer is no longer a nearly right one
FACTORS = (2, 3, 4, 8, np.pi)       # and their inverses: what numbers that are right otherwise are often wrong by
TEN = 10.0 ** np.array([-9, -6, -4, -3, -2, -1, 1, 2, 3, 4, 6, 9])


@dataclass(frozen=True)
class Verdict:
    """What became of an answer: `state` "correct", "not yet", "not answered yet" or "noted", and a hint or an insight.

    >>> bool(Verdict("01.1", "not yet", "Mind the sign."))
    False
    """

    exercise: str
    state: str
    words: str

    COLOURS: ClassVar[dict[str, str]] = {"correct": "#009E73", "not yet": "#D55E00", "not answered yet": "#777777",
                                         "noted": "#0072B2"}

    def __bool__(self) -> bool:
        return self.state == "correct"

    def __str__(self) -> str:
        return f"{self.exercise}: {self.state}. {self.words}"

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return (f'<div style="border-left:6px solid {self.COLOURS[self.state]}; padding:4px 12px"><b>{self.exercise}: '
                f'{self.state}.</b> {escape(self.words)}</div>')


def Grade(name: str, exercise: Any, answer: Any) -> Verdict:
    """The Verdict on an answer to an exercise, an object with `Hint(answer)` and `insight`; `...` is no answer yet.

    Of an exercise None nobody here knows the answer: it is noted, for a teacher to grade.
    """
    if answer is ...:
        return Verdict(name, "not answered yet", "Put your answer in place of the three dots and run the cell again.")
    if exercise is None:
        return Verdict(name, "noted", "It is graded when you hand in the notebook.")
    hint = exercise.Hint(answer)
    return Verdict(name, "correct", exercise.insight) if hint is None else Verdict(name, "not yet", hint)


@dataclass(frozen=True, kw_only=True)
class Value:
    """A number, an array or a matrix, sparse ones too.

    Right : function that returns the value;  tol : allowed error relative to its largest entry
    mistakes : {hint: function that returns the value of this mistake};  hint : for all other mistakes
    insight : said of a correct answer
    """

    Right: Callable[..., Any]
    hint: str
    insight: str
    tol: float = 0.01
    mistakes: Mapping[str, Callable[..., Any]] = field(default_factory=dict)

    def Hint(self, answer: Any) -> str | None:
        wrong = [(hint, Mistake()) for hint, Mistake in self.mistakes.items()]
        return Compare(answer, self.Right(), wrong, self.hint, self.tol)


@dataclass(frozen=True, kw_only=True)
class Function:
    """A function, tried on data that the student does not see.

    Right : the function;  Data : numpy random generator -> tuple of its arguments;  words : what to call it
    mistakes : {hint: wrong function};  hint, insight, tol : as for `Value`
    """

    Right: Callable[..., Any]
    Data: Callable[[np.random.Generator], tuple[Any, ...]]
    hint: str
    insight: str
    tol: float = 1e-8
    mistakes: Mapping[str, Callable[..., Any]] = field(default_factory=dict)
    words: str = "your function"

    def Hint(self, answer: Any) -> str | None:
        found, trouble = Called(answer, self.Arguments(), self.words)
        if trouble:
            return trouble
        wrong = [(hint, Mistake(*self.Arguments())) for hint, Mistake in self.mistakes.items()]
        return Compare(found, self.Right(*self.Arguments()), wrong, self.hint, self.tol)

    def Arguments(self) -> tuple[Any, ...]:
        """The same data every time, new arrays: a function may write into its arguments."""
        return self.Data(np.random.default_rng(SEED))


@dataclass(frozen=True, kw_only=True)
class Law:
    """An object with methods, each graded as a `Function`: {name: Function}, in this order."""

    methods: Mapping[str, Function]
    insight: str

    def Hint(self, answer: Any) -> str | None:
        if isinstance(answer, type):
            return f"Wrong type: the answer is the class {answer.__name__}; make an object of it, with its data in parentheses."
        for name, method in self.methods.items():
            if not callable(getattr(answer, name, None)):
                return f"Wrong type: {_Kind(answer)} has no method {name}; the law needs {', '.join(self.methods)}."
            hint = method.Hint(getattr(answer, name))
            if hint is not None:
                return f"{name}: {hint}"
        return None


@dataclass(frozen=True, kw_only=True)
class Choice:
    """One of several statements and the reason for it, a pair such as ("b", 2).

    right : the pair;  choices : {wrong letter: hint};  reasons : {wrong number: hint}, for the right letter
    """

    right: tuple[str, int]
    choices: Mapping[str, str]
    reasons: Mapping[int, str]
    insight: str

    def Hint(self, answer: Any) -> str | None:
        letters, numbers = sorted([self.right[0], *self.choices]), sorted([self.right[1], *self.reasons])
        if not isinstance(answer, (tuple, list)) or len(answer) != 2:
            return f"Wrong type: give a statement and its reason as a pair, a letter and a number such as ({letters[0]!r}, 1)."
        letter, number = answer
        if letter not in letters or number not in numbers:
            return f"Statements are {', '.join(letters)} and reasons {', '.join(map(str, numbers))}; give one of each."
        if letter != self.right[0]:
            return self.choices[letter]
        return None if number == self.right[1] else f"The statement is right, the reason is not. {self.reasons[number]}"


def Called(answer: Any, arguments: tuple[Any, ...], words: str) -> tuple[Any, str | None]:
    """(what a student's function returns, None), or (None, what is wrong with it); words : what to call it."""
    if not callable(answer):
        return None, f"Wrong type: the answer is {_Kind(answer)}; give the function itself, without calling it."
    try:
        found = answer(*arguments)
    except Exception as error:      # whatever a student's function does is to be graded
        return None, f"When it is called, {words} raises {type(error).__name__}: {error}{_Vectorised(error)}"
    return found, f"Nothing comes out of {words}; is there a return?" if found is None or found is ... else None


def Compare(answer: Any, right: Any, wrong: Iterable[tuple[str, Any]], hint: str, tol: float) -> str | None:
    """None if an answer equals the right value, else the hint that fits; `wrong` is a list of (hint, value)."""
    right = AsNumbers(right)
    try:
        found = AsNumbers(answer)
    except (TypeError, ValueError):
        return f"Wrong type: {_Kind(answer)} is no {'number' if right.ndim == 0 else 'array of numbers'}."
    if found.shape != right.shape:
        for words, value in wrong:
            if np.array_equal(found, AsNumbers(value)):
                return words
        if found.ndim == 2 and found.T.shape == right.shape:
            return "Wrong shape: rows and columns are interchanged."
        return f"Wrong shape: the answer has shape {found.shape}, expected is {right.shape}."
    if not np.all(np.isfinite(found)):
        return "Not finite: look for a division by zero, or a root or power of a negative number."
    scale = np.abs(right).max(initial=0) or 1.0

    def Same(value: Any) -> bool:
        value = AsNumbers(value)
        return value.shape in ((), found.shape) and np.abs(found - value).max(initial=0) <= tol * scale

    if Same(right):
        return None
    for words, value in wrong:
        if Same(value):
            return words
    return _General(found, right, Same, scale) or hint


def _General(found: Array, right: Array, Same: Callable[[Any], bool], scale: float) -> str | None:
    """The hint for a mistake that shows whatever the exercise is, or None."""
    if Same(-right):
        return "Wrong sign: the size is right.  In which direction is this quantity counted as positive?"
    if right.ndim == 2 and right.shape[0] == right.shape[1] and Same(right.T):
        return "The matrix is transposed: NGSolve's rows belong to the test functions v, its columns to u."
    if not np.any(found):
        return "Zero everywhere: is the term assembled, on facets that exist?"
    if any(Same(factor * right) for factor in TEN):
        return "Wrong unit: the digits are right, the power of ten is not."
    ratio = float(np.vdot(found, right) / scale / (np.vdot(right, right) / scale))
    common = any(np.isclose(abs(ratio), value, rtol=1e-3) for factor in FACTORS for value in (factor, 1 / factor))
    if Same(ratio * right) and (right.size > 1 or common):
        return "Wrong factor: everything is right up to a constant."
    if right.size > 1 and Same(right + np.mean(found - right)):
        return "Wrong by a constant that was added or forgotten, such as the gap."
    if np.abs(found - right).max() <= CLOSE * scale:
        return "Close, but not close enough: look for rounded data, or for a small term that is missing."
    return None


def AsNumbers(value: Any) -> Array:
    """Numbers as a float array, masks of True and False as 1 and 0; TypeError for anything else."""
    value = value.toarray() if sp.issparse(value) else value
    if isinstance(value, (str, bytes, bool)) or callable(value):
        raise TypeError
    if not isinstance(value, (Number, np.ndarray, list, tuple, np.generic)):
        raise TypeError
    array = np.asarray(value)
    if array.dtype.kind not in "iuf" and not (array.dtype.kind == "b" and array.ndim):
        raise TypeError
    return array.astype(float)


def _Vectorised(error: Exception) -> str:
    """What to do about an error that comes from taking an array for a number, or nothing."""
    if "truth value" in str(error):
        return "  The data are arrays, and `if`, `and`, `max` are for one number: use np.where, &, np.maximum."
    if re.search("only .*arrays can be converted|only 0-dimensional arrays", str(error)):
        return "  The data are arrays, and functions of math are for one number: use those of numpy."
    return ""


def _Kind(answer: Any) -> str:
    return f"an object of type {type(answer).__name__}"
