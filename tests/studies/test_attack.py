"""Public names under attack: one clear error or a right answer, and whatever else comes is found."""

import io
import json
import os
import re
import time
from pathlib import Path

import numpy as np
import pytest
from checks import ExitCode

from ngdgc import ContactSolution, ProblemError, SlipWeakeningFriction
from ngdgc.theory import lemmas
from ngdgc.tools import calls
from ngdgc.studies.attack.calls import ENDS, Attack, Attempt, Call, Record, Tally
from ngdgc.linear.equations import LinearEquations
from ngdgc.tools.kinds import KINDS, Mistaken
from ngdgc.studies.attack.targets import VALID, Parameters, Public, Setting

COUNT = 100     # about ten seconds; the command makes 2000


@pytest.mark.slow
def test_no_exception_but_ours():
    """And at least 30 % of the calls end with a solution: an attack that only knocks at the door proves little."""
    records = [Attempt(3, number) for number in range(COUNT)]
    assert [record for record in records if record.fault] == []
    assert sum(record.outcome == "solution" for record in records) >= 0.3 * COUNT
    assert sum(record.outcome == "problem" for record in records) >= 0.15 * COUNT


@pytest.mark.slow
def test_what_should_not_come_is_found(monkeypatch):
    """Control: a check that is taken away shows within one turn, with the place and the number that makes it again."""
    monkeypatch.setattr(calls, "_Cause", lambda *_: None)
    records = [Attempt(3, number) for number in range(40)]
    faults = [record for record in records if record.fault]
    assert faults and all(".py:" in record.detail for record in faults)
    again = Attempt(3, faults[0].number)
    same, other = (re.sub("0x[0-9a-f]+", "", record.words) for record in (again, faults[0]))    # addresses are never the same
    assert (again.name, same, again.outcome) == (faults[0].name, other, faults[0].outcome)
    assert f"FAULT {faults[0].number}: " in Tally(records)


@pytest.mark.slow
def test_every_turn_calls_every_public_name():
    names = Public()
    assert len(names) > 200 and {"Discretization", "ContactSolution.Force", "RectangleMesh", "L2Error"} <= set(names)
    for seed in (1, 2):
        assert {Call(seed, number, Path(".")).name for number in range(len(names))} == set(names)
    records = [Record(0, "Discretization", "", "value")]
    assert "ContactSolution.Force" in Tally(records) and "names not called: none" in Tally(
        [Record(0, name, "", "value") for name in names])


def test_every_parameter_has_a_valid_value(tmp_path):
    """A new parameter must be thought of."""
    setting = Setting(np.random.default_rng(1), tmp_path)
    for name, (thing, member) in Public().items():
        function = getattr(thing, member) if member else thing
        if callable(function):
            for one in Parameters(name, function):
                assert one.name == "self" or {one.name, f"{member or name}.{one.name}"} & set(VALID), (name, one.name)
    with pytest.raises(LookupError, match="no valid value of colour of Scene"):
        setting.Of("colour", "Scene")


def Made(seed, number):
    """A call that ends its process, one that hangs, and two that do neither."""
    if number == 1:
        os._exit(7)
    if number == 2:
        time.sleep(60)
    return Record(number, "name", "words", "value")


@pytest.mark.slow
def test_a_process_that_ends_or_hangs_is_noticed():
    file = io.StringIO()
    records = Attack(1, range(4), file, limit=8, Make=Made)
    assert [record.outcome for record in records] == ["value", "ended", "hung", "value"]
    assert records[1].detail == "exit code 7" and [record.fault for record in records] == [False, True, True, False]
    assert [json.loads(line)["number"] for line in file.getvalue().splitlines()] == [0, 1, 2, 3]
    assert not set(("ended", "hung")) & set(ENDS)


@pytest.mark.slow
def test_the_command_leaves_records_and_a_tally(tmp_path, capsys):
    assert ExitCode(f"attack --count 4 --seed 3 --first 10 --out {tmp_path}") in (0, 1)     # of four few may be solved
    lines = (tmp_path / "attack.jsonl").read_text().splitlines()
    assert [json.loads(line)["number"] for line in lines] == [10, 11, 12, 13]
    assert "attack, seed 3, calls 10 to 13" in capsys.readouterr().out
    assert "faults: 0" in (tmp_path / "attack.txt").read_text()


@pytest.mark.parametrize("solutions, faults, code", [(3, 0, 0), (2, 0, 1), (3, 1, 1), (9, 1, 1)])
def test_the_exit_code_counts_faults_and_solutions(solutions, faults, code, tmp_path, monkeypatch, capsys):
    """Of ten calls three must be solved, and none may be a fault."""
    outcomes = ["solution"] * solutions + ["TypeError"] * faults + ["problem"] * (10 - solutions - faults)
    records = [Record(number, "name", "words", outcome) for number, outcome in enumerate(outcomes)]
    monkeypatch.setattr("ngdgc.studies.attack.calls.Attack", lambda *_, **__: records)
    assert ExitCode(f"attack --count 10 --out {tmp_path}") == code
    assert f"faults: {faults}" in capsys.readouterr().out


def test_numbers_of_calls_begin_at_0(capsys):
    assert ExitCode("attack --count 1 --first -1") == 2
    assert "'-1' is not a nonnegative integer" in capsys.readouterr().err


def test_lists_are_no_arrays_of_points():
    """-[0.1] is nothing and 2 * [0.1] another list: a law says so, and takes arrays and numbers."""
    law = SlipWeakeningFriction(0.5, 0.3, 0.01)
    for slip in ((), [0.1]):
        with pytest.raises(ProblemError, match="slip is .*; give real numbers, an array"):
            law.Coefficient(slip)
    assert law.Coefficient(np.zeros(1))[0] == law.Coefficient(0)[0] == 0.5


def test_a_history_is_a_list_and_an_inverse_no_solver():
    """What came of a call is solved only if it is a solver; a right history is taken."""
    solution = Setting(np.random.default_rng(1), Path()).solution
    with pytest.raises(ProblemError, match="history is 3; give a list"):
        ContactSolution(solution.disc, solution.vector, solution.traction, history=3)
    assert ContactSolution(solution.disc, solution.vector, solution.traction, history=solution.history).history
    # Calls that made an inverse, and were solved with a Discretization as its load.
    assert [Attempt(1, number).fault for number in (758, 808)] == [False, False]


def test_kinds_are_looked_at_only_after_a_failure():
    """What a parameter takes is known by its name; a right argument is never blamed for what happens inside."""
    assert Mistaken("disc", 3).startswith("disc is 3; give Discretization(")
    assert Mistaken("r", np.ones(3)) is None and Mistaken("r", "soft") and Mistaken("colour", 3) is None
    assert all(Mistaken(name, object()) for name in KINDS if name != "self")
    with pytest.raises(ProblemError, match="disc is 3; give Discretization"):
        lemmas.Coercivity(3)

    class Failing(LinearEquations):
        def MakeInverse(self, matrix):
            return 1 / 0

    with pytest.raises(AttributeError, match="matrix"):     # no argument is wrong: the error stays what it is
        Failing().Multiply(np.ones(3))
