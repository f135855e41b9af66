"""A command that signals or errors of other software end leaves what was computed."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from commandline import COMMAND, PRECIOUS, RUN, Left, Loaded

from ngdgc import export
from ngdgc.commands import studies
from ngdgc.solution import storage
from ngdgc.studies import accuracy, convergence, locking
from ngdgc.cases import example_4_1
from ngdgc.cli import Main
from ngdgc.commands.console import Console
from ngdgc.commands.signals import SIGNALS


def Kill(number=signal.SIGTERM):
    """A signal to this process, which it has when this returns."""
    os.kill(os.getpid(), number)


@pytest.mark.slow
def test_a_signal_during_the_iteration_leaves_the_last_iterate(tmp_path):
    """While an iteration with a tiny rho crawls; for Ctrl-C the same is tested among the commands."""
    arguments = [*RUN, str(tmp_path), *"--solver uzawa --rho 1e-7 --maxiter 100000000".split()]
    process = subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               preexec_fn=lambda: signal.signal(signal.SIGTERM, signal.SIG_DFL))
    while "iteration    20" not in process.stdout.readline():
        assert process.poll() is None
    process.send_signal(signal.SIGTERM)
    output, errors = process.communicate(timeout=60)
    assert process.returncode == 143 and "stopped by SIGTERM after" in errors and errors.count("\n") == 1
    solution = Loaded(tmp_path)
    assert len(solution.history) >= 20 and not solution.converged
    # What the line names is there, and nothing else.
    named = set(output.split("written to ")[1].split(": ")[1].strip().split(", "))
    assert PRECIOUS < named and named == {path.name + "/" * path.is_dir() for path in tmp_path.iterdir()}


@pytest.mark.slow
def test_signals_that_are_ignored_stay_ignored(tmp_path):
    """As `nohup` wants it: a signal before the first line, and the run ends as if there had been none."""
    command = [COMMAND, *"locking --method h1 --order 1 --n 2 --lam 1 10 --out".split(), tmp_path]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True,
                               preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    assert process.stderr.readline().startswith("H1")
    process.send_signal(signal.SIGHUP)
    process.communicate(timeout=60)
    assert process.returncode == 0 and Left(tmp_path) == {"locking.txt", "locking.png"}


def test_a_signal_before_the_first_iterate_leaves_nothing(tmp_path, capsys, monkeypatch):
    """In the middle of meshing; neither the folder nor the one above it stay."""
    case = Path(example_4_1.__file__).read_text().replace("def Mesh(n=16", "import os, signal\n\n\ndef Mesh(n=16").replace(
        "    return RectangleMesh(", "    os.kill(os.getpid(), signal.SIGTERM)\n    return RectangleMesh(")
    (tmp_path / "case.py").write_text(case)
    assert Main(["run", str(tmp_path / "case.py"), "--out", str(tmp_path / "deep" / "results")]) == 143
    output = capsys.readouterr()
    assert output.err == "ngdgc: stopped by SIGTERM before the first iterate; there is nothing to write\n"
    assert "written" not in output.out and Left(tmp_path) == {"case.py"} and not (tmp_path / "deep").exists()


@pytest.mark.slow
def test_a_signal_on_a_mesh_that_predicts_leaves_nothing_that_looks_like_a_solution(tmp_path, capsys, monkeypatch):
    """Two meshes: in the first Newton step on the coarse one, and on the fine one, which is the control."""
    for fine, files in ((False, set()), (True, {"solution/solution.json"})):
        def Residual(contact, iterate, fine=fine):
            if (len(contact.weights) == 64) == fine:
                Kill()
            return 1.0

        monkeypatch.setattr("ngdgc.solvers.driver.LawResidual", Residual)
        assert Main(["run", "example_4_1", "--n", "32", "--out", str(tmp_path / str(fine))]) == 143
        assert files <= Left(tmp_path / str(fine)) and (tmp_path / str(fine)).exists() == fine
        assert ("there is nothing to write" in capsys.readouterr().err) != fine


@pytest.mark.parametrize("calls", [1, 2], ids=["once", "twice"])
def test_a_signal_while_the_solution_is_saved_waits(calls, quick, tmp_path, capsys, monkeypatch):
    write = storage.Write

    def Interrupted(*arguments):
        for _ in range(calls):
            Kill()
        write(*arguments)
        Kill()

    monkeypatch.setattr(storage, "Write", Interrupted)
    assert Main([*RUN[1:], str(tmp_path)]) == 143
    output = capsys.readouterr()
    assert Loaded(tmp_path).converged and "int p_n" in output.out       # the report is printed
    assert f"written to {tmp_path}/: solution/, report.json, report.txt\n" in output.out and "stopped by SIGTERM" in output.err
    assert "solution.html" not in Left(tmp_path)


def test_a_signal_while_pictures_are_drawn_leaves_no_half_of_one(quick, tmp_path, capsys, monkeypatch):
    def Half(solution, path, *, scale):
        path.write_text("<html>")
        Kill(signal.SIGINT)
        path.write_text("<html></html>")

    monkeypatch.setattr(export, "WriteHTML", Half)
    (tmp_path / "solution.html").write_text("of an earlier run")
    assert Main([*RUN[1:], str(tmp_path)]) == 130
    assert (tmp_path / "solution.html").read_text() == "of an earlier run" and Loaded(tmp_path).converged
    assert not [name for name in Left(tmp_path) if name.startswith(".")]
    assert "/: solution/, report.json, report.txt\n" in capsys.readouterr().out


def test_held_signals_take_effect_at_the_end():
    # Whoever runs the tests may ignore it, as nohup does.
    before, reached = signal.signal(signal.SIGHUP, signal.SIG_DFL), []
    with SIGNALS:
        with pytest.raises(KeyboardInterrupt), SIGNALS.Held():
            Kill()
            with SIGNALS.Held():
                Kill(signal.SIGINT)
            reached.append("end")
        assert SIGNALS.code == 130
        with pytest.raises(KeyboardInterrupt):       # control: nothing is held any more
            Kill()
            reached.append("too far")
        assert SIGNALS.code == 143
        with pytest.raises(KeyboardInterrupt):
            Kill(signal.SIGHUP)
        assert SIGNALS.words == "stopped by SIGHUP"
    signal.signal(signal.SIGHUP, before)
    assert reached == ["end"] and signal.getsignal(signal.SIGTERM) == signal.SIG_DFL


def test_an_error_of_other_software_on_a_signal_is_no_traceback(tmp_path, capsys, monkeypatch):
    """What a signal raises in a callback of C++ may come out as something else; without a signal it is an error as ever."""
    def Broken(*_, number=None):
        try:
            Kill() if number is None else None
        except KeyboardInterrupt:
            pass
        raise SystemError("returned a result with an exception set")

    monkeypatch.setattr(studies, "Show", Broken)
    arguments = ["locking", "--method", "h1", "--out", str(tmp_path / "new")]
    assert Main(arguments) == 143 and capsys.readouterr().err == (
        "ngdgc: stopped by SIGTERM (SystemError: returned a result with an exception set)\n")
    assert not (tmp_path / "new").exists()
    monkeypatch.setattr(studies, "Show", lambda line: Broken(number=1))
    with pytest.raises(SystemError):
        Main(arguments)


STUDIES = [(convergence, "convergence --method ip --n 2 4 --order 1"),
           (locking, "locking --method ip --n 2 --lam 1 10 --order 1"),
           (accuracy, "accuracy --method ip --order 1 2 --cells quad --budget 1e-9")]


@pytest.mark.slow
@pytest.mark.parametrize("study, words", STUDIES, ids=["convergence", "locking", "accuracy"])
def test_a_study_that_is_stopped_keeps_what_was_computed(study, words, tmp_path, capsys, monkeypatch):
    """At its second part."""
    original, calls, name = study.Study, [], f"{words.split()[0]}.txt"

    def Second(*arguments, **options):
        calls.append(arguments)
        if len(calls) == 2:
            Kill()
        return original(*arguments, **options)

    monkeypatch.setattr(study, "Study", Second)
    assert Main([*words.split(), "--out", str(tmp_path)]) == 143
    output = capsys.readouterr()
    assert "IP edge" in (tmp_path / name).read_text() and f"written to {tmp_path}/: {name}" in output.out
    assert output.err.endswith("ngdgc: stopped by SIGTERM\n") and len(calls) == 2


def test_a_comparison_that_is_stopped_keeps_its_last_iterate(tmp_path, capsys, monkeypatch):
    """In the second method, after two steps of the iteration."""
    case = tmp_path / "case.py"
    case.write_text(Path(example_4_1.__file__).read_text() + "\n\nfrom ngdgc import *\nimport os, signal\n\n\n"
                    "def Main(*, method, solver=None):\n    def Stop(step):\n"
                    "        if method.name == 'H1' and step.number == 2:\n            os.kill(os.getpid(), signal.SIGTERM)\n"
                    "    return UzawaSolver().Solve(Discretization(Problem(), method, Mesh(2), order=1), callback=Stop)\n")
    assert Main(["compare", str(case), "--method", "ip", "h1", "ldg", "--out", str(tmp_path / "out")]) == 143
    rows = (tmp_path / "out" / "comparison.txt").read_text().splitlines()
    assert [row.split()[0] for row in rows] == ["method", "ip", "h1"] and "h1 (not converged)" in rows[2]
    assert "comparison.png" in Left(tmp_path / "out")


def test_what_only_prints_prints_what_it_has(capsys, monkeypatch):
    """The lemmas of a case and Table 3, stopped in the second method."""
    from ngdgc.studies import stability as stabilitystudy, table3

    monkeypatch.setattr(stabilitystudy, "Coercivity", lambda disc: Kill() if disc.method.name == "Bassi" else 0.123)
    assert Main("stability example_4_1 --n 2".split()) == 143
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == ["method", "IP"]

    def Read(example, name, method, plane, cells, n):
        Kill() if example == "4.2" else None
        return [table3.Reading(example, name, plane, cells, table3.PROTOCOLS[0], np.array(table3.PUBLISHED[example]))]

    monkeypatch.setattr(table3, "_Read", Read)
    assert Main("table3 --method h1".split()) == 143
    output = capsys.readouterr().out
    assert "Example 4.1" in output and "Example 4.2, all" not in output


def test_silence_does_not_last(capsys):
    """A line on the stream that spoke last, as long as nobody else speaks; none where nothing has begun."""
    with Console(every=0.2):
        time.sleep(0.5)
        assert capsys.readouterr() == ("", "")
        print("begun", file=sys.stderr)
        time.sleep(0.7)
    output = capsys.readouterr()
    assert output.out == "" and output.err.startswith("begun\n... still at work, 0 s\n") and output.err.count("still") >= 2
    with Console(every=0.2):
        for _ in range(7):
            print("progress")
            time.sleep(0.1)
    assert "still" not in capsys.readouterr().out
