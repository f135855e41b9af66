"""The compliance operator known on remembered vectors and guessed elsewhere, and what it saves."""

import numpy as np
import pytest
from dense import DIM, Compliance, Dense, N

from ngdgc import Discretization, InteriorPenalty
from ngdgc.studies.atlas.solvers import Point
from ngdgc.meshes import RectangleMesh
from ngdgc.solvers.newton import step
from ngdgc.solvers.newton.run import NewtonRun
from ngdgc.solvers.newton.recycling import Recycled
from ngdgc.solvers.newton.reduced import ReducedResponse
from ngdgc.traces import ThreeZones

BLOCKS = np.broadcast_to(0.1 * np.eye(DIM), (N, DIM, DIM))


def Remembering(count, stiffness=0.0):
    """(weights, S_D, Recycled that knows `count` random products with it)."""
    random = np.random.default_rng(3)
    weights = random.uniform(0.1, 1, N)
    matrix = Compliance()
    dense = Dense(np.linalg.inv(np.linalg.inv(matrix) + stiffness * np.eye(N * DIM)))
    dense.stiffness = np.full(N * DIM, stiffness)
    recycled = Recycled(dense, weights)
    for s in random.standard_normal((count, N, DIM)):
        recycled.Remember(s, dense.Product(s))
    return weights, dense.matrix, recycled


@pytest.mark.parametrize("stiffness", [0.0, 5.0])
@pytest.mark.parametrize("count", [0, 1, 7])
def test_it_is_exact_on_the_span_and_the_blocks_on_its_complement(count, stiffness):
    weights, S, recycled = Remembering(count, stiffness)
    reduced = ReducedResponse(recycled, BLOCKS)
    for s, image in zip(*recycled.Pairs()) if count else ():
        assert image.ravel() == pytest.approx(S @ s.ravel(), abs=1e-12)
        assert reduced.Product(s) == pytest.approx(image, abs=1e-11)
    known = np.array([s.ravel() for s in recycled.Pairs()[0]]).reshape(count, N * DIM) if count else np.empty((0, N * DIM))
    other = np.random.default_rng(4).standard_normal(N * DIM)
    measure = np.repeat(weights, DIM)
    other -= known.T @ np.linalg.lstsq(known * measure @ known.T, known @ (measure * other), rcond=None)[0] if count else 0
    image = reduced.Product(other.reshape(N, DIM)).ravel()
    assert image == pytest.approx(0.1 * other, abs=1e-11)
    assert np.abs(image - S @ other).max() > 1e-2          # it does not know S there


def test_its_equations_are_solved_exactly():
    weights, S, recycled = Remembering(N * DIM)
    random = np.random.default_rng(5)
    P, b = random.standard_normal((N, DIM, DIM)), random.standard_normal((N, DIM))
    rest = ReducedResponse(recycled, BLOCKS).Solve(P, b)
    s = b - np.einsum("nij,nj->ni", P, rest)
    assert rest.ravel() == pytest.approx((S - 0.1 * np.eye(N * DIM)) @ s.ravel(), abs=1e-9 * np.abs(s).max())
    few = ReducedResponse(Remembering(3)[2], BLOCKS).Solve(P, b)
    assert np.abs(few - rest).max() > 1e-2 * np.abs(rest).max()


@pytest.mark.parametrize("everything", [True, False])
def test_the_contact_problem_is_solved_at_once_where_all_products_are_known(everything):
    disc = Discretization(ThreeZones().problem, InteriorPenalty(), RectangleMesh(4), order=2)
    run = NewtonRun(disc, None, 1e-10)
    state = run.body.Evaluate(run.start)
    for unit in np.eye(run.start.q.size)[::1 if everything else 5]:
        unit = unit.reshape(run.start.q.shape)
        run.body.recycled.Remember(unit, run.body.response.Product(unit))
    reduced = ReducedResponse(run.body.recycled, run.body.blocks)
    q = reduced.Minimise(run.setting.graph, run.body.Equation, run.body.Merit, state, state.point.q)
    merit = state.At(q).merit / state.merit
    assert merit < 1e-12 if everything else merit > 1e-4


@pytest.mark.slow
def test_a_box_takes_few_steps_and_few_applications(monkeypatch):
    """The bounds promised for three dimensions; Newton's steps alone take more of both."""
    def Finest(stiffness):
        point = Point(problem="box", stiffness=stiffness, n=6)
        disc = Discretization(point.contactproblem, InteriorPenalty(), point.Mesh(), order=1)
        level = disc.Solve().levels[-1]
        return level.iterations, level.solves

    counts = np.array([Finest(stiffness) for stiffness in (1, 1e3)])
    assert np.all(counts <= (5, 60))
    monkeypatch.setattr(step, "Corrected", lambda state, q, least, tol: state.At(q))
    assert np.all(np.array(Finest(1e3)) > counts[1] + (1, 10))
