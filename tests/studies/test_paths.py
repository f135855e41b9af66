"""Random load histories, and the command that counts their failures."""

import io
import json

import numpy as np
import pytest
from ngsolve import Parameter

from ngdgc import ProblemError, SolveHistory
from ngdgc.cli import Main
from ngdgc.studies import paths
from ngdgc.studies.paths import Led, Paths, PathTally, RunPath, Through
from ngdgc.studies.samples import Draw
from ngdgc.studies.sweep import Violation


def test_a_path_goes_through_its_values_linearly():
    t, values = Parameter(0), [2.0, -1.0, 4.0]
    path = Through(t, values)
    mesh = Draw(1, 2, dofs=2000).mesh()
    for time, expected in ((1, 2), (1.5, 0.5), (2, -1), (2.25, 0.25), (3, 4), (7, 4)):
        t.Set(time)
        assert path(mesh(0.5, 0.5)) == pytest.approx(expected)


def test_loads_of_a_history_change_and_keep_their_kind():
    sample = Draw(1, 3, dofs=2000)
    led, t = Led(sample, steps=4, seed=5)
    mesh = sample.mesh()
    before, after = (dict(problem.traction)["top"] for problem in (sample.problem, led.problem))
    rng = np.random.default_rng([5, 4])
    along, press = rng.uniform(-1, 1, 4), rng.uniform(0.2, 1.2, 4)
    for time in (1, 3):
        t.Set(time)
        point = mesh(0.3, 0.9)
        assert after(point) == pytest.approx(np.array(before(point)) * (along[time - 1], press[time - 1]))


@pytest.mark.slow
def test_random_histories_obey_the_law_of_increments_at_every_point():
    """To 1e-8, of which the tolerance of the increments is 1e-10; the static law is not obeyed, by far."""
    file = io.StringIO()
    records = Paths(3, 6, file, dofs=3000, steps=5)
    assert not any(record.failed for record in records) and [len(record.violation) for record in records] == [5] * 6
    assert [json.loads(line)["number"] for line in file.getvalue().splitlines()] == list(range(6))
    assert PathTally(records).startswith("6 histories, 0 failed\nlaw violation: at most ")


def test_control_violation_of_an_increment_counts_slip_from_the_last_state():
    led, t = Led(Draw(1, 0, dofs=3000), steps=10, seed=1)
    history = SolveHistory(led.Disc(), parameter=t, times=range(1, 6))
    still = [type(state)(state.disc.After(None), state.vector, state.traction) for state in history]
    assert max(Violation(state).max() for state in history) < 1e-8
    assert max(Violation(state).max() for state in still) > 1e-4


def test_command_tells_which_histories_failed(tmp_path, capsys, monkeypatch):
    seen = []

    def SecondFails(disc, **options):
        seen.append(disc)
        if len(seen) == 2:
            raise ProblemError("lost")
        return SolveHistory(disc, **options)

    monkeypatch.setattr(paths, "SolveHistory", SecondFails)
    assert Main([*"sweep --histories --count 2 --seed 3 --dofs 2000 --out".split(), str(tmp_path)]) == 1
    text = (tmp_path / "histories.txt").read_text()
    assert text.startswith("histories, seed 3, 2 problems\n2 histories, 1 failed\n") and "FAILED ProblemError: lost" in text
    assert len((tmp_path / "histories.jsonl").read_text().splitlines()) == 2
    assert "applications" in capsys.readouterr().out


def test_an_interrupted_sweep_of_histories_keeps_what_is_there(tmp_path, monkeypatch):
    def Stopped(number, sample, **options):
        if number == 1:
            raise KeyboardInterrupt
        return RunPath(number, sample, **options)

    monkeypatch.setattr(paths, "RunPath", Stopped)
    assert Main([*"sweep --histories --count 3 --seed 3 --dofs 2000 --out".split(), str(tmp_path)]) == 130
    assert len((tmp_path / "histories.jsonl").read_text().splitlines()) == 1
