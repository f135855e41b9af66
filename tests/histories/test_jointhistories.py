"""Histories on joints: a patch that sticks, slips, turns back and slips again; energy; and the loop of two rollers."""

from math import sqrt

import numpy as np
import pytest
from bodies import Halves, Stacked
from ngsolve import CF, IfPos, Parameter, specialcf

from ngdgc import (LDG, Conforming, ContactProblem, CoulombFriction, Discretization, HookeMaterial, InteriorPenalty, Joint,
                   LoadHistory, NormalCompliance, SemismoothNewtonSolver, SolveHistory)
from ngdgc.cases import two_rollers

K, P, E, NU = 5000.0, 40.0, 1000.0, 0.3
G, CONFINED = E / (2 * (1 + NU)), E * (1 - NU) / ((1 + NU) * (1 - 2 * NU))
TIMES = np.linspace(0, 6, 13)
# Sheared until it slips, slid by .01, taken back through the stick, slid back beyond where it began, and once more.
SHEARS, SLIPS = [0, 12, 12, -12, -12, 12, 12], [0, 0, 0.01, 0.01, -0.02, -0.02, 0.01]
BODIES = {2: Halves(), 3: Stacked()}


def Through(t, values):
    """The polygon with these values at 0, 1, 2, ..., a CoefficientFunction of a Parameter."""
    steps = [IfPos(t - k - 1, 1, IfPos(t - k, t - k, 0)) * (b - a) for k, (a, b) in enumerate(zip(values, values[1:]))]
    return sum(steps, CF(values[0]))


def Sheared(dim, t, method, order=1):
    """The body of one modulus under pressure P, sheared by tau(t), with the slip of its upper part."""
    tau, slip, side = Through(t, SHEARS), Through(t, SLIPS), -P * NU / (1 - NU)
    stress = np.diag([side] * (dim - 1) + [-P]).astype(object)
    stress[0, -1] = stress[-1, 0] = tau
    top = (tau / G + slip, *(0,) * (dim - 2), -P / CONFINED - P / K)
    walls = "left|right" if dim == 2 else "left|right|front|back"
    joint = Joint("mid", NormalCompliance(K), friction=CoulombFriction(0.3))
    problem = ContactProblem(HookeMaterial(E=E, nu=NU), joint, dirichlet={"bottom": (0,) * dim, "top": top},
                             traction={walls: CF(tuple(stress.ravel()), dims=(dim, dim)) * specialcf.normal(dim)})
    return Discretization(problem, method, BODIES[dim], order=order)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("method", [LDG(), InteriorPenalty(form="lifting"), Conforming()], ids=repr)
def test_patch_through_stick_slip_and_back(method, dim):
    """At every time friction and slip are those of the polygon, which a law without memory has only until the first turn."""
    t = Parameter(0)
    solver = SemismoothNewtonSolver(tol=1e-13)
    history = SolveHistory(Sheared(dim, t, method), parameter=t, times=TIMES, solver=solver)
    for time, state in zip(TIMES, history):
        tau, slip = (np.interp(time, range(7), values) for values in (SHEARS, SLIPS))
        assert np.abs(state.friction - [tau, *(0,) * (dim - 1)]).max() < 1e-10 * P
        assert np.abs(state.displacement[:, 0] + slip).max() < 1e-10
        assert state.pressure == pytest.approx(P, rel=1e-10)
    assert history.forces["mid"][:, 0] == pytest.approx(np.interp(TIMES, range(7), SHEARS), abs=1e-10 * P)
    assert history.forces["mid"][:, -1] == pytest.approx(-P, rel=1e-10)
    # .01 + .03 + .03 were slid against .3 P; the work that is left is elastic, for the traction was exact in between.
    assert history.dissipation[-1] == pytest.approx(12 * 0.07, rel=1e-10)
    loops = history.work - history.energy - history.dissipation
    assert loops - loops[0] == pytest.approx(0, abs=1e-10)


def test_history_with_a_joint_is_saved_and_goes_on(tmp_path):
    t = Parameter(0)
    disc = Sheared(2, t, LDG())
    whole = SolveHistory(disc, parameter=t, times=TIMES)
    SolveHistory(disc, parameter=t, times=TIMES[:6]).Save(tmp_path / "half")
    half = LoadHistory.Load(tmp_path / "half", disc.problem, parameter=t)
    rest = SolveHistory(Sheared(2, t, LDG()), parameter=t, times=TIMES[5:], start=half)
    assert rest.forces["mid"][-1] == pytest.approx(whole.forces["mid"][-1], abs=1e-7)


@pytest.mark.slow
def test_loop_of_two_rollers():
    """Mindlin and Deresiewicz: the area within 2 %, the stick within an element; two equal bodies are not coupled.

    What yields besides: the joint, 1/220 of the bodies, and their size, 25 half widths.
    """
    count, n = 4, 24
    history = two_rollers.History(count=count, n=n)
    force, shear = -history.forces["joint"][-1, 1], abs(history.forces["joint"][-1, 0])
    area = history.dissipation[-1] - history.dissipation[2 * count]
    assert area == pytest.approx(two_rollers.LoopArea(force, shear), rel=0.02)
    assert abs(area / two_rollers.LoopArea(force, 1.05 * shear) - 1) > 0.05         # it is no wide tolerance
    half, _ = two_rollers.Hertz(force)
    element = 2 * two_rollers.CONTACT / n
    for number in (2, 4, 6):       # the turns, at the largest pull
        stick = history[number * count].ZoneLengths()["stick"] / 2
        assert stick == pytest.approx(half * sqrt(1 - shear / (two_rollers.COEFFICIENT * force)), abs=element)
    pressure = history.forces["joint"][count:, 1]
    assert np.ptp(pressure) < 1e-3 * force       # friction does not change it
