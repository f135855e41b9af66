"""Threads are taken where processors are free: what other processes keep busy is measured."""

import os
import subprocess
import sys
import time
from contextlib import nullcontext

import pytest
from ngsolve import TaskManager

from ngdgc.mesh import facets
from ngdgc.meshes import RectangleMesh
from ngdgc.tools import parallel
from ngdgc.tools.parallel import Others, Processors


def Fake(monkeypatch, *times):
    """Others whose measurements are (clock, busy, own)."""
    times = iter(times)
    monkeypatch.setattr(Others, "_Times", staticmethod(lambda: next(times)))
    others = Others()
    monkeypatch.setattr(parallel, "_Others", lambda: others)
    return others


def test_others_are_what_is_busy_without_this_process(monkeypatch):
    others = Fake(monkeypatch, (0, 100, 5), (1, 101.5, 6), (1.1, 101.6, 6), (2, 102, 7), (3, 105, 8))
    assert others.busy == 0 and others.Measure() == pytest.approx(0.5)
    assert others.Measure() == pytest.approx(0.5)       # 0.1 s later: too early to tell
    assert others.Measure() == 0                        # own time is counted finer than the system's
    assert others.Measure() == pytest.approx(2)


def test_threads_on_large_meshes_and_free_processors_only(monkeypatch):
    small, large = RectangleMesh(2), RectangleMesh(40)
    assert small.ne < facets.THREADED < large.ne
    for busy, kind in ((0.4, TaskManager), (0.6, nullcontext)):
        Fake(monkeypatch, (0, 0, 0), (1, busy, 0), (2, 2 * busy, 0))
        assert type(facets.Threads(large)) is kind
        assert type(facets.Threads(small)) is nullcontext


def test_a_busy_process_is_seen():
    """Whatever else runs, nothing is less busy for it; half of what the other one would take if it were alone."""
    spin = "import time; end = time.time() + 5\nwhile time.time() < end: pass"
    with subprocess.Popen([sys.executable, "-c", spin]) as other:
        try:
            time.sleep(0.2)
            others = Others()
            time.sleep(2 * Others.LATELY)
            assert 0.5 < others.Measure() <= len(Processors()) + 0.2
        finally:
            other.kill()


def test_batches_take_one_thread_of_every_library():
    """Also of scipy's, which is loaded after the first batch."""
    script = ("import numpy as np\nfrom threadpoolctl import threadpool_info\nfrom ngdgc.tools.parallel import Batched\n"
              "def Threads(): return sorted(part['num_threads'] for part in threadpool_info() if part['user_api'] == 'blas')\n"
              "Batched(np.linalg.inv)(np.eye(2))\nbefore = len(Threads())\nimport scipy.linalg\n"
              "print(before, *Batched(Threads)(), *Threads())")
    environment = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    words = subprocess.run([sys.executable, "-c", script], env=environment | {"OPENBLAS_NUM_THREADS": "2"}, capture_output=True,
                           text=True, check=True).stdout.split()
    before, inside = int(words[0]), words[1:(len(words) + 1) // 2]
    assert len(inside) > before and set(inside) == {"1"}
    assert "2" in words[(len(words) + 1) // 2:] or len(Processors()) == 1       # control: outside of batches
