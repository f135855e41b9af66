"""Things every test file uses."""

import os

# Processes side by side must not start threads of their own: theirs wait for each other busily.  Libraries read this once.
os.environ.update(NGS_NUM_THREADS="1", OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", MKL_NUM_THREADS="1")

import pytest
from ngsolve import x
from problems import METHODS, TEN, Pressed
from running import (pytest_collection_finish, pytest_collection_modifyitems, pytest_configure,  # noqa: F401  hooks
                     pytest_runtest_logstart, pytest_runtest_makereport, pytest_terminal_summary, pytest_xdist_auto_num_workers)

from ngdgc import LDG, CoulombFriction, Foundation, NormalCompliance, TrescaFriction, export
from ngdgc.cases import example_4_2
from ngdgc.commands import output
from ngdgc.meshes import BoxMesh, RectangleMesh


@pytest.fixture(params=TEN, ids=[f"{method.name}-{method.form}" for method in TEN])
def ten(request):
    """The four methods of the paper and LDG without a penalty, in two forms each."""
    return request.param


@pytest.fixture(params=METHODS, ids=["ip-auto", "ip-30", "h1"])
def method(request):
    return request.param


@pytest.fixture
def quick(monkeypatch):
    """One picture in place of all that a command draws."""
    monkeypatch.setattr(output, "DrawResults", lambda solution, files, scale: files.Write(
        "solution.html", lambda path: export.WriteHTML(solution, path, scale=scale)))


@pytest.fixture(scope="session")
def lifting():
    """Example 4.2: half of the bottom presses and slips."""
    return example_4_2.Main(n=8)


@pytest.fixture(scope="session")
def varying():
    """Two foundations, one with a stiffness that varies; separation, stick and slip."""
    return Pressed((Foundation("bottom", NormalCompliance(2000 * (1 + x)), friction=CoulombFriction(0.3)),
                    Foundation("right", NormalCompliance(300, exponent=0.5), gap=0.01, friction=TrescaFriction(2))),
                   RectangleMesh(6), order=2)


@pytest.fixture(scope="session")
def solid():
    """A block in space that leaves its foundation, sticks and slips."""
    return Pressed(Foundation("bottom", NormalCompliance(100), friction=CoulombFriction(0.4), gap=0.1 * x),
                   BoxMesh(2, cells="hex"), (0.05, 0.02, -0.04), method=LDG())
