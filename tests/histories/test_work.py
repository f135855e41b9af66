"""Work and energies of histories, and parts of increments, against what is known exactly."""

import numpy as np
import pytest
from ngsolve import CF, Parameter, x, y

from ngdgc import (Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NonsymmetricInteriorPenalty, NormalCompliance, NotConvergedError, SolveHistory)
from ngdgc.histories.energies import FoundationEnergy
from ngdgc.histories.solve import _Run
from ngdgc.meshes import RectangleMesh

TIMES = [1, 2, 3.5, 4]


def Moved(t, *, friction=None, **changes):
    """A block pressed for good, all of whose data move, each in its own way."""
    gap = changes.pop("gap", 0.004 * t * t * x - 0.01 * t)
    data = {"dirichlet": {"top": CF((0.01 * t * (4 - t), -0.08 - 0.002 * t * t * x))},
            "traction": {"right": CF((5 * t * y, -3 * t * t))}, "bodyforce": CF((4 - t * t, 7 * t))} | changes
    return ContactProblem(HookeMaterial(E=1000, nu=0.3),
                          Foundation("bottom", NormalCompliance(1e4), friction=friction, gap=gap), **data)


def Followed(method, times=TIMES, **changes):
    t = Parameter(0)
    return SolveHistory(Discretization(Moved(t, **changes), method, RectangleMesh(3)), parameter=t, times=times)


@pytest.mark.parametrize("method", [InteriorPenalty(), InteriorPenalty(form="lifting"), Conforming()], ids=str)
def test_without_friction_and_with_a_linear_foundation_work_is_energy(method):
    """All is linear, the trapezoidal rule exact, with loads, supports and a foundation that move: 1e-8 the tolerance."""
    history = Followed(method)
    assert history.traction[..., 1].max() < 0
    assert np.abs(history.work - history.energy).max() < 1e-8 * history.energy.max()
    assert np.all(history.dissipation == 0)
    # Control: each datum does a work of its own.
    for name in ("traction", "bodyforce", "gap"):
        less = Followed(method, **{name: {} if name == "traction" else CF((0, 0)) if name == "bodyforce" else 0.0})
        assert abs(less.work[-1] - history.work[-1]) > 1e-3 * history.work[-1]


def test_work_of_a_method_that_is_not_symmetric_is_not_known():
    history = Followed(NonsymmetricInteriorPenalty())
    assert np.all(np.isnan(history.work)) and np.all(np.isfinite(history.traction))


@pytest.mark.parametrize("exponent", [1, 1.5, 2])
def test_energy_of_a_foundation_is_the_integral_of_its_law(exponent):
    """k r^(m+1)/(m+1) where the body is in it, to round-off for these m."""
    foundation = Foundation("bottom", NormalCompliance(100, exponent=exponent), gap=0.01)
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, dirichlet={"top": CF((0, 0))})
    contact = Discretization(problem, InteriorPenalty(), RectangleMesh(3)).contact
    depth = 0.05 * contact.coordinates[:, 0] - 0.02
    energy = FoundationEnergy(contact, (depth + 0.01)[:, None] * contact.normals)
    expected = contact.weights @ (100 * np.maximum(depth, 0) ** (exponent + 1) / (exponent + 1))
    assert abs(energy - expected) < 1e-13 * expected


def test_an_increment_that_fails_is_halved_into_increments(monkeypatch):
    """States, work and dissipation are those of a history through the halves; slip counts from the last of them."""
    def Rubbed(times):
        t = Parameter(0)
        problem = Moved(t, friction=CoulombFriction(0.3), dirichlet={"top": CF((0.01 * t * (4 - t), -0.1))})
        return SolveHistory(Discretization(problem, InteriorPenalty(), RectangleMesh(3)), parameter=t, times=times)

    whole, fine = Rubbed(TIMES), Rubbed([1, 1.5, 2, 2.375, 2.75, 3.125, 3.5, 4])
    begun, failed, At = [], [], _Run._At

    def Short(run, time, old):
        if begun and time - begun[-1] > 0.5:
            failed.append(time)
            raise NotConvergedError("too far", whole[0])
        found = At(run, time, old)
        begun.append(time)
        return found

    monkeypatch.setattr(_Run, "_At", Short)
    halved = Rubbed(TIMES)
    assert [increment.parts for increment in halved.increments] == [1, 2, 4, 1] and failed == [2, 3.5, 2.75]
    same = [list(fine.times).index(time) for time in TIMES]
    for name in ("traction", "work", "energy", "dissipation"):
        expected, other = getattr(fine, name)[same], getattr(whole, name)
        assert np.abs(getattr(halved, name) - expected).max() < 1e-9 * np.abs(expected).max()
        assert np.abs(other - expected).max() > 1e-7 * np.abs(expected).max()
    assert np.abs(halved[2].disc.origin - fine.displacement[-3]).max() < 1e-9 * np.abs(fine.displacement).max()
