"""The checker: right answers pass, and wrong ones meet the hint for their mistake; no hint gives an answer away."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from answers import WRONG, Rest, Solution
from ngsolve import x

from ngdgc import ProblemError
from ngdgc.exercises import EXERCISES, Check
from ngdgc.exercises.checker import Choice, Function, Law, Value
from ngdgc.exercises.effectivity import Trend

LAZY = tuple(name for name, exercise in EXERCISES.items() if isinstance(exercise, Value))


def Answers(name):
    """The wrong answers; values that are expensive to make are made here."""
    for answer, words in WRONG[name]:
        yield (answer() if name in LAZY and callable(answer) else answer), words


@pytest.mark.slow
@pytest.mark.parametrize("name", EXERCISES)
def test_model_solutions_are_right(name):
    verdict = Check(name, Solution(name))
    assert verdict and verdict.state == "correct", verdict
    assert len(verdict.words) > 20


@pytest.mark.slow
@pytest.mark.parametrize("name", EXERCISES)
def test_wrong_answers_meet_the_hint_for_their_mistake(name):
    assert len(WRONG[name]) >= 2
    for answer, words in Answers(name):
        verdict = Check(name, answer)
        assert not verdict and verdict.state == "not yet"
        assert words in verdict.words, f"{words!r} was expected: {verdict}"


def Kinds(exercise):
    return exercise.methods.values() if isinstance(exercise, Law) else [exercise]


@pytest.mark.slow
@pytest.mark.parametrize("name", EXERCISES)
def test_every_mistake_that_is_known_is_told_from_the_others(name):
    for kind in Kinds(EXERCISES[name]):
        if isinstance(kind, Choice):
            continue
        assert len(kind.mistakes) >= 2
        for hint, Mistake in kind.mistakes.items():
            assert kind.Hint(Mistake() if isinstance(kind, Value) else Mistake) == hint


@pytest.mark.parametrize("name", LAZY)
def test_hints_do_not_give_numbers_away(name):
    hints = " ".join([EXERCISES[name].hint, *EXERCISES[name].mistakes])
    right = EXERCISES[name].Right()
    values = np.unique(right.data if sp.issparse(right) else np.ravel(right))
    # Small integers are in every sentence on degrees and components.
    assert not any(f"{value:.{digits}g}" in hints for value in values if value != int(value) for digits in (2, 3, 4))


def test_no_answer_is_no_mistake():
    verdict = Check("01.1", ...)
    assert not verdict and verdict.state == "not answered yet"
    assert Check("01.1", None).state == "not yet"


def test_unknown_exercises_are_refused_with_the_list():
    with pytest.raises(ProblemError, match=r"no exercise '13.1'; there are 01.1, 01.2.*12.4"):
        Check("13.1", 3)


def test_names_are_understood_with_and_without_the_zero():
    for name in ("1.4", "01.4", " 01.4 ", "1.4 "):
        assert Check(name, ("b", 2)) and Check(name, ("b", 2)).exercise == "01.4"
    assert Check("10.4", ("b", 1)).exercise == "10.4"
    for name in (1.4, 10.4, None, ["01.4"], "1", "01.40", "0.1.4"):
        with pytest.raises(ProblemError, match="no exercise .*01.1, 01.2") as error:
            Check(name, ("b", 2))
        assert ("in quotes" in str(error.value)) != isinstance(name, str)


def test_what_is_right_only_beside_the_limit_is_not_accepted():
    """The data have m = 1 at open and closed points; without them, which is the control, 0**0 would not be noticed."""
    exercise = EXERCISES["06.2"]
    r, k, m = exercise.Data(np.random.default_rng(6))
    assert np.any((m == 1) & (r < 0)) and np.any((m == 1) & (r > 0))
    without = replace(exercise, Data=lambda rng: (r, k, np.maximum(m, 1.5)))
    assert without.Hint(lambda r, k, m: k * m * np.maximum(r, 0) ** (m - 1)) is None


def test_verdicts_show_themselves():
    verdict = Check("05.3", lambda m: 1 / 0)
    assert "ZeroDivisionError" in str(verdict) and str(verdict) == repr(verdict)
    assert "<b>05.3: not yet.</b>" in verdict._repr_html_()
    script = Check("05.3", lambda m: open("<script>"))._repr_html_()
    assert "<script>" not in script and "&lt;script&gt;" in script


def test_answers_are_not_changed_by_grading_and_data_are_fresh():
    seen = []

    def Greedy(m):
        seen.append(m.copy())
        m[:] = 0
        return Solution("05.3")(seen[-1])

    assert Check("05.3", Greedy)
    assert Check("05.3", Greedy)
    assert np.array_equal(*seen) and np.abs(seen[0]).max() > 1


def test_general_hints_come_in_order():
    """For an exercise without known mistakes the kind of the error alone decides."""
    table = np.arange(1.0, 7).reshape(2, 3)
    exercise = Value(Right=lambda: table, hint="own hint", insight="", tol=1e-6)
    for answer, words in ((table, None), (-table, "Wrong sign"), (table.T, "Wrong shape: rows"), (table[0], "Wrong shape"),
                          (1000 * table, "Wrong unit"), (0.7 * table, "Wrong factor"), (table + 0.3, "such as the gap"),
                          (table * [[1, 1, 1.01]], "Close"), (0 * table, "Zero"), (np.inf * table, "Not finite"),
                          ("table", "Wrong type"), (x, "Wrong type"), ([[1, "a", 2]] * 2, "Wrong type"), (True, "Wrong type"),
                          (1j * table, "Wrong type"), (table ** 2, "own hint")):
        hint = exercise.Hint(answer)
        assert hint is None if words is None else words in hint, (answer, hint)
    loose = replace(exercise, tol=0.05)
    assert loose.Hint(1.01 * table) is None and exercise.Hint(1.01 * table) is not None
    square = replace(exercise, Right=lambda: table[:, :2])
    assert "transposed" in square.Hint(table[:, :2].T)


@pytest.mark.slow
def test_effectivities_are_followed_along_all_series():
    """A right estimator is near 1 on all of them, also those on which wrong ones are to fall."""
    for name in ("11.2", "11.3"):
        exercise = EXERCISES[name]
        steady = replace(exercise, series=[replace(series, wanted="steady") for series in exercise.series])
        assert steady.Hint(Rest) is None
        assert "goes to 0.  It should stay near 1" in steady.Hint(Solution(name))
    assert [Trend(np.array(ratios)) for ratios in ((1, 1.5, 2), (1, 0.5, 0.1), (1, 3, 9), (0, 0, 0))] == [
        "steady", "falls", "grows", "falls"]


@pytest.mark.slow
def test_estimators_get_their_data_anew():
    def Greedy(parts):
        total = Rest(parts, "law", "feasibility")
        parts.clear()
        return total

    assert Check("11.2", Greedy) and Check("11.2", Greedy)


def test_masks_are_arrays_of_truth_values_or_of_ones():
    mask = np.array([True, False, True])
    exercise = Value(Right=lambda: mask, hint="own hint", insight="", mistakes={"indices": lambda: np.array([0, 2])})
    for answer in (mask, mask.tolist(), mask.astype(int), mask.astype(float)):
        assert exercise.Hint(answer) is None
    assert exercise.Hint(np.flatnonzero(mask)) == "indices" and "Wrong shape" in exercise.Hint(mask[:2])
    assert exercise.Hint([False, False, True]) == "own hint"
    for scalar in (True, np.True_):
        assert "Wrong type" in replace(exercise, Right=lambda: 1.0, mistakes={}).Hint(scalar)


def test_single_numbers_are_wrong_by_a_factor_only_if_it_is_a_usual_one():
    exercise = Value(Right=lambda: 7.0, hint="own hint", insight="")
    assert "factor" in exercise.Hint(14.0) and "factor" in exercise.Hint(7 * np.pi)
    assert exercise.Hint(7 * 1.37) == "own hint"


def test_functions_are_tried_on_data():
    exercise = Function(Right=lambda r: r**2, Data=lambda rng: (rng.uniform(1, 2, 5),), hint="own hint", insight="")
    assert exercise.Hint(lambda r: r * r) is None
    assert exercise.Hint(lambda r: r**2.2) is not None
