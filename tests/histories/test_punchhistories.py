"""Histories of rigid punches that forces press, or that are moved: exact where they can be, and as good as one by one."""

import re

import numpy as np
import pytest
from ngsolve import CF, IfPos, Parameter, x
from problems import Along

from ngdgc import (LDG, ArchardWear, Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial,
                   LoadHistory, NormalCompliance, RigidPunch, SolveHistory)
from ngdgc.commands.historyrun import Table
from ngdgc.histories.increments import Increments
from ngdgc.meshes import BoxMesh, RectangleMesh

MATERIAL = HookeMaterial(E=1000, nu=0.3)
METHOD, RUBBING = LDG(), CoulombFriction(0.4)
TIMES = np.linspace(0, 3, 13)
PUSH, PULL = [0, 5, 5, 5], [0, 0, 1.2, -1.2]


def Problem(t, punch, *, gap=0.0, wear=None, dim=2, friction=RUBBING):
    foundation = Foundation("top", NormalCompliance(2e4), friction=friction, gap=gap, punch=punch, wear=wear)
    return ContactProblem(MATERIAL, foundation, dirichlet={"bottom": (0,) * dim})


def Rubbed(punch, *, method=METHOD, times=TIMES, mesh=None, start=None, **data):
    """The history of a block under a punch, which is a function of the time."""
    t = Parameter(0)
    mesh = mesh or RectangleMesh(4)
    disc = Discretization(Problem(t, punch(t), dim=mesh.dim, **data), method, mesh, order=1)
    return SolveHistory(disc, parameter=t, times=times, start=start)


def Forced(t):
    """Pressed until 1, pulled until 2, pulled back until 3; free to turn."""
    return RigidPunch(force=(Along(t, PULL), -Along(t, PUSH)), moment=0, about=(0.4, 1))


ROUND = 0.01 * (x - 0.5) ** 2


@pytest.fixture(scope="module")
def forced():
    return Rubbed(Forced, gap=ROUND)


def test_forces_are_what_is_prescribed_and_cost_nothing_after_the_first_states(forced):
    wanted = np.column_stack([np.interp(TIMES, range(4), path) for path in (PULL, np.negative(PUSH))])
    assert np.abs(forced.forces["top"] - wanted).max() < 1e-11
    assert np.abs(np.diff(forced.punches["top"], axis=0)).max(axis=0).min() > 1e-5
    assert sum(increment.solves for increment in forced.increments[3:]) <= 10
    header, *rows = Table(forced).splitlines()
    assert "top moved x  top moved y  top turned  work" in re.sub(" {2,}", "  ", header)
    assert [float(entry) for entry in rows[7].split()[3:6]] == pytest.approx(forced.punches["top"][7], rel=1e-5)
    assert {0, 1, 2} >= set(np.concatenate([solution.zones for solution in forced])) >= {1, 2}


def test_the_motions_that_were_found_lead_to_these_forces(forced):
    """Prescribed, piecewise linear through the states, as many increments: tolerances of 1e-10 of two histories."""
    def Moved(t):
        a, b, w = (sum((float(after - before) * IfPos(t - begin, IfPos(t - end, 1, (t - begin) / (end - begin)), 0)
                        for begin, end, before, after in zip(TIMES[:-1], TIMES[1:], path[:-1], path[1:])), CF(float(path[0])))
                   for path in forced.punches["top"].T)
        return RigidPunch(displacement=(a, b), rotation=w, about=(0.4, 1))

    moved = Rubbed(Moved, gap=ROUND)
    assert np.abs(moved.traction - forced.traction).max() < 1e-7 * np.abs(forced.traction).max()
    assert np.abs(moved.forces["top"] - forced.forces["top"]).max() < 1e-8
    # The work of the forces is that of the motions.
    assert moved.work == pytest.approx(forced.work, rel=1e-8)


@pytest.mark.parametrize("method", [LDG(), Conforming()], ids=str)
def test_increments_are_those_of_the_full_method(monkeypatch, method):
    """Each one alone, by Newton's method from the state before: the law residual is 1e-10 in both."""
    times = TIMES[4::2]
    found = Rubbed(Forced, gap=ROUND, method=method, times=times)
    monkeypatch.setattr(Increments, "Next", lambda *_: None)
    alone = Rubbed(Forced, gap=ROUND, method=method, times=times)
    for name in ("displacement", "traction"):
        one, other = getattr(found, name), getattr(alone, name)
        assert np.abs(one - other).max() < 1e-8 * np.abs(one).max()
    assert np.abs(found.punches["top"] - alone.punches["top"]).max() < 1e-10
    assert np.abs(found[2].vector - alone[2].vector).max() < 1e-10
    assert found.work == pytest.approx(alone.work, rel=1e-8)
    assert found.dissipation == pytest.approx(alone.dissipation, abs=1e-10)


def test_work_is_energy_and_dissipation(forced):
    """Up to the increments: halved, they leave half.  A flat punch pressed without friction is linear, and all exact."""
    fine = Rubbed(Forced, gap=ROUND, times=np.linspace(0, 3, 25))
    defects = [abs(history.work - history.energy - history.dissipation)[-1] for history in (forced, fine)]
    assert 1.4 < defects[0] / defects[1] < 2.8 and defects[1] < 0.01 * fine.work[-1]
    linear = Rubbed(lambda t: RigidPunch(force=(None, -5 * t), moment=t, about=(0.5, 1)), times=[0.5, 1],
                    friction=None)
    assert np.abs(linear.work - linear.energy - linear.dissipation).max() < 1e-12


def test_goes_on_from_a_folder(forced, tmp_path):
    """Half of the history, saved and loaded, leads to the other half."""
    t = Parameter(0)
    forced[:7].Save(tmp_path)
    half = LoadHistory.Load(tmp_path, Problem(t, Forced(t), gap=ROUND), parameter=t)
    assert half.punches["top"].tolist() == forced.punches["top"][:7].tolist()
    assert np.abs(half[3].vector - forced[3].vector).max() < 1e-12
    on = SolveHistory(half.disc, parameter=t, times=TIMES[7:], start=half)
    assert np.abs(on.traction - forced.traction[7:]).max() < 1e-8 * np.abs(forced.traction).max()
    assert np.abs(on.punches["top"] - forced.punches["top"][7:]).max() < 1e-10
    assert on.work == pytest.approx(forced.work[7:], rel=1e-8)


def test_a_punch_in_space_that_wears():
    """Pressed by F, dragged by s: Archard's volume C F s but for what sticks at first; the punch sinks as the body wears."""
    C, force, way = 1e-5, 5.0, 0.5
    mesh = BoxMesh(1)
    history = Rubbed(lambda t: RigidPunch(force=(None, None, -force), displacement=(way * t, None, None)), mesh=mesh,
                     wear=ArchardWear(C), times=[0, 0.5, 1])
    volume = float(history.worn[-1] @ history[-1].weights)
    assert abs(volume / (C * force * way) - 1) < 0.02
    sunk = history.punches["top"][1, 2] - history.punches["top"][2, 2]
    assert sunk == pytest.approx(C * force * way / 2, rel=1e-3)
    assert np.abs(history.forces["top"][:, 2] + force).max() < 1e-9
    # Slip is that on the punch: the body hardly moves.
    assert history.path[-1].mean() == pytest.approx(way, rel=0.02) and np.abs(history.displacement).max() < 0.05 * way
