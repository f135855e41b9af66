"""How the tests are run: on how many processes, in which order, and which of them are slow.

A test that takes more than a second of CPU time, all its cases and the fixtures that it needs together, is marked `slow`;
`pytest -m "not slow"` runs the others.  The times are added up at the end of each run, and those that should be marked are
named.
"""

import gc
import os
from collections import Counter
from importlib.util import find_spec

import pytest

SLOW = 1.0      # second
RANKS = all(find_spec(name) for name in ("petsc4py", "mpi4py"))
FEW = 4         # files that are done before processes of their own have imported what they need


def pytest_xdist_auto_num_workers(config):
    """None, in place of the processors, for few files and for tests chosen by name."""
    paths = [config.invocation_params.dir / word.split("::")[0] for word in config.args]
    files = sum(len(list(path.rglob("test_*.py"))) if path.is_dir() else 1 for path in paths)
    return 0 if config.option.keyword or files <= FEW else Processors()


def Processors():
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()


def pytest_configure():
    # Each time that there are a few more tests it would look at all of them for garbage, half of the time of a collection.
    gc.disable()


def pytest_collection_finish():
    gc.freeze()
    gc.enable()


def pytest_collection_modifyitems(items):
    """Files with slow tests first: a long one at the end would keep one process busy and the others waiting."""
    slow = {item.path for item in items if item.get_closest_marker("slow")}
    items.sort(key=lambda item: item.path not in slow)


class Clock:
    """CPU time, in seconds, of this process and of those that it has waited for."""

    def __init__(self):
        self.last = self.Now()

    @staticmethod
    def Now():
        return sum(os.times()[:4])

    def Lap(self):
        """Time since the last lap."""
        last, self.last = self.last, self.Now()
        return self.last - last


CLOCK = Clock()


def pytest_runtest_logstart():
    CLOCK.Lap()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport():
    report = yield
    report.seconds = CLOCK.Lap()
    return report


def Unmarked(reports, limit):
    """{name of a test: seconds} of those that should be marked slow, of reports on the parts of all their cases."""
    seconds, marked = Counter(), set()
    for report in reports:
        name = report.nodeid.split("[")[0]
        seconds[name] += report.seconds
        if "slow" in report.keywords:
            marked.add(name)
    return {name: total for name, total in seconds.most_common() if total > limit and name not in marked}


def pytest_terminal_summary(terminalreporter):
    reports = [report for kind in terminalreporter.stats.values() for report in kind if hasattr(report, "seconds")]
    unmarked = Unmarked(reports, SLOW)
    if unmarked:
        terminalreporter.section(f"more than {SLOW:g} s of CPU time, and not marked slow")
        for name, seconds in unmarked.items():
            terminalreporter.write_line(f"{seconds:.2f}s {name}")
    if reports:
        terminalreporter.write_line(f"CPU time of the tests: {sum(report.seconds for report in reports):.1f} s")
    paths = [terminalreporter.config.invocation_params.dir / word for word in terminalreporter.config.args]
    if not RANKS and any((path / "test_ranks.py").is_file() or (path / "distributed").is_dir() for path in paths):
        terminalreporter.write_line("tests/distributed was left out: this Python has no petsc4py and mpi4py; .ci/distributed "
                                    "installs them and runs it")
