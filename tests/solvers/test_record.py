"""What a run records, and what the parts of a run leave untouched."""

from types import SimpleNamespace

import numpy as np
import pytest
from ngsolve import CF

from ngdgc import ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty, NormalCompliance
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.solvers.newton.continuation import RaiseLoad
from ngdgc.solvers.newton.record import PATIENCE, Record, Taken
from ngdgc.solvers.newton.run import NewtonRun
from ngdgc.solvers.newton.step import NewtonStep
from ngdgc.solvers.newton.subspace import Subspace


def Filled(ratios, zones=(), merits=()):
    record = Record()
    for number, ratio in enumerate(ratios):
        record.Add(None, Taken(length=1.0, merit=merits[number] if merits else 1.0, ratio=ratio, least=None,
                               zones=np.array(zones[number] if zones else [number])))
    return record


def Disc():
    """A block on a foundation with friction, pulled along it."""
    law = Foundation("bottom", NormalCompliance(1e4), friction=CoulombFriction(0.3))
    problem = ContactProblem(HookeMaterial(E=2000, nu=0.3), law, dirichlet={"left": CF((0, 0))},
                             traction={"top": CF((3.1, -10))})
    return Discretization(problem, InteriorPenalty(), RectangleMesh(4), order=1)


def test_a_run_stalls_when_so_many_steps_have_not_halved_the_merit():
    assert Filled([0.95] * PATIENCE).Stalled(PATIENCE) and not Filled([0.95] * (PATIENCE - 1)).Stalled(PATIENCE)
    assert not Filled([0.9] * PATIENCE).Stalled(PATIENCE)       # 0.9^8 < 1/2
    again = Filled([0.95] * PATIENCE)
    again.Begin(SimpleNamespace())
    assert not again.Stalled(PATIENCE) and again.steps == [] and len(again.taken) == PATIENCE


@pytest.mark.parametrize("period", [2, 3, 5])
def test_the_period_is_that_of_the_zones(period):
    zones = [[number % period, 1] for number in range(2 * period + 1)]
    assert Filled([0.9] * len(zones), zones).Period() == period
    assert Filled([0.9] * (len(zones) - 1), zones[1:]).Period() == 0        # too few to tell
    assert Filled([0.9] * len(zones), [[0, 1]] * len(zones)).Period() == 0


def test_the_largest_merit_is_that_of_all_steps():
    record = Filled([0.5, 0.5, 0.5], merits=[2.0, 7.0, 1.0])
    record.Begin(SimpleNamespace())
    assert record.largest == 7 and Record().largest == 0


def test_a_step_returns_another_state_and_leaves_its_own():
    """Evaluated again it is the same to round-off: nothing of the step is kept in the body but products."""
    run = NewtonRun(Disc(), None, 1e-10)
    state = run.body.Evaluate(run.start)
    before = state.F.copy()
    found = NewtonStep(state, run.record, run.tol)
    assert found.merit < 0.5 * state.merit and run.record.state is found and len(run.record.taken) == 1
    assert np.array_equal(state.F, before)
    assert state.To(state.point).F == pytest.approx(before, abs=1e-10 * np.abs(before).max())
    assert found.base is state.base and found.body is state.body


def test_a_renewed_matrix_knows_the_same_body():
    """Another D, the same state to the round-off of the equations, and products that serve on; their number is one's own."""
    run = NewtonRun(Disc(), None, 1e-10)
    state = NewtonStep(run.body.Evaluate(run.start), run.record, run.tol)
    count = len(run.body.recycled.images)
    renewed = state.Renewed()
    assert renewed.body.predicted and not run.body.predicted and np.abs(renewed.body.stiffness).max() > 0
    assert not np.any(run.body.stiffness)
    # The point of the graph is the same; u is that of t + D (u - U), nearer to it.
    assert renewed.point is state.point and renewed.merit <= state.merit
    assert len(run.body.recycled.images) == count <= len(renewed.body.recycled.images)


def test_the_load_is_raised_to_a_state_under_all_of_it():
    run = NewtonRun(Disc(), None, 1e-10)
    raised = RaiseLoad(run.body, run.record, run.tol)
    assert raised.state.equilibrium.load == 1 and raised.load < 1
    state = raised.state
    for _ in range(3):
        state = NewtonStep(state, run.record, run.tol)
    assert run.record.residual < 1e-10
    # Control: at rest the load is not there.
    assert run.body.Evaluate(run.start, load=0.0).merit < 1e-20 < run.body.Evaluate(run.start).merit


def test_a_subspace_that_moves_is_another_one():
    disc = Box()
    small = Subspace(disc)
    load, shift = small.load.copy(), small.shift.copy()
    moved = small.Moved(np.random.default_rng(0).standard_normal(disc.space.ndof))
    assert np.array_equal(small.load, load) and np.array_equal(small.shift, shift) and moved.matrix is small.matrix
    assert np.abs(moved.load - load).max() > 0.1 and np.abs(moved.shift).max() > 0.1
    assert disc.contact.trace.shape[1] == disc.space.ndof > small.contact.trace.shape[1]


def Box():
    problem = ContactProblem(HookeMaterial(E=2000, nu=0.3), Foundation("bottom", NormalCompliance(1e3)),
                             dirichlet={"top": CF((0, 0, -0.1))})
    return Discretization(problem, InteriorPenalty(), BoxMesh(2), inverse="iterative")
