"""Few files run in this process, all on the processors; slow tests that are not marked are named."""

import ast
from pathlib import Path
from types import SimpleNamespace

import pytest
import running

pytest_plugins = ["pytester"]
ROOT = Path(__file__).parents[1]
HOOKS = "from running import pytest_runtest_logstart, pytest_runtest_makereport, pytest_terminal_summary\n"
HOOKS += "from running import pytest_xdist_auto_num_workers\n"
SAMPLE = """
import subprocess, sys, time
import pytest

WORK = "end = time.process_time() + {}\\nwhile time.process_time() < end:\\n    pass"

@pytest.mark.parametrize("n", range(3))
def test_cases(n):
    exec(WORK.format(0.2))

def test_child():
    subprocess.run([sys.executable, "-c", "import time\\n" + WORK.format(0.5)])

@pytest.mark.slow
def test_marked():
    exec(WORK.format(0.5))

def test_sleep():
    time.sleep(0.5)
"""


@pytest.fixture
def folder(pytester, monkeypatch):
    """Tests that tell the process in which they run, more than a few files of them."""
    monkeypatch.delenv("PYTEST_XDIST_WORKER", raising=False)        # of this process
    pytester.makeconftest(HOOKS)
    pytester.makeini("[pytest]\naddopts = -n auto --maxprocesses 2 --dist loadfile\nmarkers =\n    slow: long\n")
    pytester.makepyfile(**{f"test_{number}": "import os\ndef test_one():\n    assert 'PYTEST_XDIST_WORKER' not in os.environ\n"
                           for number in range(running.FEW + 1)})
    return pytester


@pytest.mark.parametrize("words", [["test_1.py"], ["test_1.py::test_one", "test_2.py"], ["-k", "one"]],
                         ids=["file", "test", "name"])
def test_few_files_start_no_process(folder, words):
    done = folder.runpytest_inprocess(*words)
    assert done.ret == 0 and "worker" not in done.stdout.str()


def test_control_all_files_run_in_processes_of_their_own(folder, monkeypatch):
    monkeypatch.setattr(running, "Processors", lambda: 1)
    done = folder.runpytest_inprocess()
    done.assert_outcomes(failed=running.FEW + 1)
    assert "1 worker" in done.stdout.str()


def test_slow_tests_without_a_mark_are_named(pytester, monkeypatch):
    """Of CPU time, in all cases and in processes of their own; a test that sleeps, or that is marked, is not named."""
    pytester.makeconftest(HOOKS)
    monkeypatch.setattr(running, "SLOW", 0.4)
    pytester.makepyfile(SAMPLE)
    lines = pytester.runpytest_inprocess("-n", "0", "-W", "ignore").stdout.lines
    named = [line.split("::")[1] for line in lines if "s test_slow" in line]
    assert sorted(named) == ["test_cases", "test_child"]


def test_the_limit_is_that_of_the_description():
    reports = [SimpleNamespace(nodeid=f"test_a[{case}]", seconds=0.4, keywords={}) for case in range(3)]
    assert running.Unmarked(reports, 1) == {"test_a": pytest.approx(1.2)} and running.Unmarked(reports[:2], 1) == {}
    assert "more than a second" in (ROOT / ".pytest.ini").read_text() and running.SLOW == 1


def Borrowed(source):
    """Test modules that a test module imports from."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom | ast.Import):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else [alias.name for alias in node.names]
            yield from (name for name in names if name.startswith("test_") or name == "conftest")


def test_no_test_needs_the_file_of_another():
    """What several use stands in modules of its own, so that each file runs alone and none can be found in two folders."""
    paths = [path for path in (ROOT / "tests").rglob("*.py")]
    assert [path.name for path in paths if list(Borrowed(path.read_text()))] == [] and len(paths) > 80
    names = [path.name for path in paths if path.name.startswith("test_")]
    assert len(names) == len(set(names))
    assert list(Borrowed("import test_a\nfrom conftest import A\nfrom problems import B")) == ["test_a", "conftest"]
