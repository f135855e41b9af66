"""A case along its load history, on the command line."""

import re
import signal

import numpy as np
import pytest
from ngsolve import Parameter

from ngdgc import LoadHistory
from ngdgc.cli import Main
from ngdgc.commands import historyrun
from ngdgc.histories import solve

CASE = '''"""A block that is pressed, and then dragged."""

import numpy as np
from ngsolve import CF, IfPos, Parameter

from ngdgc import (ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NestedNewtonSolver, NormalCompliance, SolveHistory)
from ngdgc.meshes import RectangleMesh


def Problem(t=1.0):
    foundation = Foundation("bottom", NormalCompliance(1e4), friction=CoulombFriction(0.3))
    top = CF((0.02 * IfPos(t - 1, t - 1, 0), -0.02 * IfPos(1 - t, t, 1)))
    return ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, dirichlet={"top": top})


def Main(*, method=InteriorPenalty(), n=3, solver=NestedNewtonSolver(), callback=None):
    return solver.Solve(Discretization(Problem(), method, RectangleMesh(n)), callback=callback)


def History(*, method=InteriorPenalty(), n=3, callback=None):
    t = Parameter(0)
    return SolveHistory(Discretization(Problem(t), method, RectangleMesh(n)), parameter=t, times=np.linspace(0.5, 2, 4),
                        callback=callback)
'''


@pytest.fixture
def case(tmp_path):
    (tmp_path / "case.py").write_text(CASE, encoding="utf-8")
    return tmp_path / "case.py"


@pytest.mark.slow
def test_a_case_is_led_along_its_loads(case, capsys):
    """All states are kept, in a table, an animation and a series; the last one has all that a run leaves."""
    out = case.parent / "results"
    assert Main(["run", str(case), "--history", "--n", "2", "--out", str(out)]) == 0
    text = capsys.readouterr().out
    assert len(re.findall(r"^time +[\d.]+ +\d+ applications", text, re.M)) == 4 and "SolveHistory at time 2" in text
    t = Parameter(0)
    scope = {}
    exec(CASE, scope)
    history = LoadHistory.Load(out / "history", scope["Problem"](t), parameter=t)
    rows = np.array([line.split() for line in (out / "history.txt").read_text().splitlines()[1:]], dtype=float)
    alone = np.column_stack([history.times, history.forces["bottom"], history.work, history.energy, history.dissipation])
    np.testing.assert_allclose(rows, alone, rtol=1e-5, atol=1e-9)
    assert abs(rows[-1, 1]) > 0.5 > abs(rows[1, 1])         # control: dragging, and not pressing, has a force across
    left = {path.name for path in out.iterdir()}
    assert {"forces.png", "animation.html", "series", "solution", "report.txt", "contact.png", "vonmises.png"} <= left
    assert (out / "series" / "history.pvd").read_text().count('part="0"') == 4
    assert (out / "animation.html").stat().st_size > 1e5


@pytest.mark.slow
@pytest.mark.usefixtures("quick")
def test_states_before_a_failure_are_written(case, capsys, monkeypatch):
    """A block that slides away: the states before, the message, and 1."""
    monkeypatch.setattr(solve, "HALVINGS", 1)       # to fail sooner
    case.write_text(CASE.replace('dirichlet={"top": top}', 'traction={"top": CF((4 * IfPos(t - 1, t - 1, 0), -10))}'),
                    encoding="utf-8")
    out = case.parent / "results"
    code = Main(["run", str(case), "--history", "--n", "2", "--out", str(out)])
    captured = capsys.readouterr()
    assert code == 1 and captured.err.startswith("ngdgc: ") and captured.err.count("\n") == 1
    times = [float(line.split()[0]) for line in (out / "history.txt").read_text().splitlines()[1:]]
    assert times == [0.5, 1.0, 1.5] and (out / "series" / "history.pvd").is_file()


@pytest.mark.slow
@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize("number, words", [(signal.SIGINT, "interrupted"), (signal.SIGTERM, "stopped by SIGTERM")])
def test_a_history_that_is_stopped_leaves_its_states_and_the_code_of_the_signal(number, words, case, capsys, monkeypatch):
    monkeypatch.setattr(historyrun, "_Tell", lambda increment: increment.time < 1.5 or signal.raise_signal(number))
    out = case.parent / "results"
    assert Main(["run", str(case), "--history", "--n", "2", "--out", str(out)]) == 128 + number
    assert words in capsys.readouterr().err
    times = [float(line.split()[0]) for line in (out / "history.txt").read_text().splitlines()[1:]]
    assert times == [0.5, 1.0, 1.5] and (out / "history").exists()


@pytest.mark.parametrize("arguments, words", [
    (["--error", "0.1"], "--error does not apply to a history"), (["--order", "2"], "whose History has no such keyword")])
def test_what_a_history_does_not_take(case, arguments, words, capsys):
    assert Main(["run", str(case), "--history", "--out", str(case.parent / "results"), *arguments]) == 2
    assert words in capsys.readouterr().err
