"""The package of students: sealed exercises grade as those that they were made of, and hold no formula."""

import inspect
import json
import zlib
from functools import cache

import numpy as np
import pytest
from answers import SOLUTIONS, WRONG, Solution

from ngdgc.exercises import EXERCISES
from ngdgc.exercises.checker import Choice, Function, Grade, Law, Value
from ngdgc.exercises.sealed import Seal, Unseal


@cache
def File():
    return Seal(EXERCISES)


@cache
def Sealed():
    return Unseal(File())


def Answers(name):
    """The right answer and the wrong ones; values that are expensive to make are made here."""
    yield Solution(name)
    for answer, _ in WRONG[name]:
        yield answer() if isinstance(EXERCISES[name], Value) and callable(answer) else answer
    yield from (..., None, "text")


@pytest.mark.slow
@pytest.mark.parametrize("name", EXERCISES)
def test_sealed_exercises_say_the_same_of_every_answer(name):
    verdicts = [Grade(name, Sealed()[name], answer) for answer in Answers(name)]
    assert verdicts == [Grade(name, EXERCISES[name], answer) for answer in Answers(name)]
    assert verdicts[0] and not any(verdicts[1:])


@pytest.mark.slow
def test_sealing_again_changes_nothing():
    assert list(Sealed()) == list(EXERCISES) and Seal(Sealed()) == File()


@pytest.mark.slow
def test_the_file_holds_no_formula_and_cannot_be_read_by_a_look():
    """Nothing of the solutions of the notebooks, nor of the functions of the exercises, stands in what it holds."""
    text = zlib.decompress(File()).decode()
    lines = {line.strip() for path in SOLUTIONS.values() for line in path.read_text(encoding="utf-8").splitlines()}
    formulas = {line for line in lines if ("=" in line or "return" in line) and len(line) > 20}
    assert len(formulas) > 60 and not [line for line in formulas if line in text]
    functions = [method for one in EXERCISES.values() for method in (one.methods.values() if isinstance(one, Law) else [one])
                 if isinstance(method, Function)]
    assert not any(inspect.getsource(function.Right).strip()[:40] in text for function in functions)
    # A control: hints are words, and do stand there, but not for the eye.
    assert "You forgot the gap" in text and b"gap" not in File() and b"right" not in File()


def test_a_number_that_is_changed_changes_the_verdict():
    exercise = Function(Right=lambda r: r ** 2, Data=lambda rng: (rng.uniform(1, 2, 5),), hint="own hint", insight="yes",
                        mistakes={"the cube": lambda r: r ** 3})
    packed = json.loads(zlib.decompress(Seal({"a": exercise})))
    packed["a"]["right"][3] += 1e-6
    sealed, spoilt = (Unseal(zlib.compress(json.dumps(one).encode()))["a"]
                      for one in (json.loads(zlib.decompress(Seal({"a": exercise}))), packed))
    assert sealed.Hint(lambda r: r * r) is None and sealed.Hint(lambda r: r * r * r) == "the cube"
    assert spoilt.Hint(lambda r: r * r) is not None


def test_data_are_fresh_and_keep_their_types():
    given = (np.arange(3), np.linspace(0, 1, 4), 0.1, np.array([True, False]))
    seen = []

    def Greedy(*arguments):
        seen.append([argument.copy() if isinstance(argument, np.ndarray) else argument for argument in arguments])
        arguments[0][:] = 9
        return 1.0

    sealed = Unseal(Seal({"a": Function(Right=lambda *data: 1.0, Data=lambda rng: tuple(
        one.copy() if isinstance(one, np.ndarray) else one for one in given), hint="", insight="")}))["a"]
    assert sealed.Hint(Greedy) is None and sealed.Hint(Greedy) is None
    for arguments in seen:
        assert all(np.array_equal(one, other) for one, other in zip(arguments, given))
        assert [getattr(one, "dtype", float) for one in arguments] == [getattr(one, "dtype", float) for one in given]


def test_without_answers_the_checker_takes_note():
    exercise = Choice(right=("a", 1), choices={"b": "no"}, reasons={2: "no"}, insight="yes")
    file = Seal({"01.4": exercise}, answers=False)
    for answer in (("a", 1), ("b", 1)):
        verdict = Grade("01.4", Unseal(file)["01.4"], answer)
        assert verdict.state == "noted" and not verdict and "hand in" in verdict.words and "#" in verdict._repr_html_()
    assert Grade("01.4", None, ...).state == "not answered yet"
    assert "yes" not in zlib.decompress(file).decode() and "yes" in zlib.decompress(Seal({"01.4": exercise})).decode()


def test_what_cannot_be_sealed_is_said():
    class Riddle(Choice):
        pass

    assert Unseal(Seal({"a": Riddle(right=("a", 1), choices={}, reasons={}, insight="")}, answers=False)) == {"a": None}
    with pytest.raises(TypeError, match="seal a object"):
        Seal({"a": object()})
