"""Newton's method for a body that nothing but friction keeps from sliding: where all points slip nothing is stiff."""

import numpy as np
import pytest
from netgen.occ import Box, Pnt
from ngsolve import CF, x, y
from ngsolve.meshes import MakeStructured2DMesh

from ngdgc import (ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, NotConvergedError, SemismoothNewtonSolver)
from ngdgc.cases import two_materials
from ngdgc.contact.graph import STICK
from ngdgc.meshes import ShapeMesh
from ngdgc.solvers.nested import Coarser, Transfer
from ngdgc.solvers.newton import setting, step
from ngdgc.solvers.newton.pointwise import PointwiseEquation
from ngdgc.solvers.newton.run import NewtonRun
from ngdgc.solvers.newton.stiffened import StiffenedBody


def Block():
    """Eight contact points under a block that spreads under its load: nearly all of them slip, to both sides."""
    return Discretization(two_materials.Problem(), InteriorPenalty(), two_materials.Mesh(4), order=1)


def Plain(body, F):
    """|F|^2, the merit of bodies that are held."""
    return float(np.sum(body.setting.contact.weights[:, None] * F ** 2))


def Strip():
    """A strip under a tilted load that pulls it with 0.995 of what friction can hold: hardly a point sticks."""
    load = {"top": CF((0.4975, -1 - 0.6 * (x - 0.5)))}
    mesh = MakeStructured2DMesh(quads=False, nx=12, ny=1, mapping=lambda s, t: (6 * s - 2.5, 0.5 * t))
    foundation = Foundation("bottom", NormalCompliance(1), friction=CoulombFriction(0.5))
    return Discretization(ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, traction=load), InteriorPenalty(), mesh)


@pytest.mark.slow
def test_it_takes_few_steps_and_fails_without_what_holds_it(monkeypatch):
    for disc, steps, solves in ((Block(), 5, 30), (Strip(), 15, 150)):
        assert len(SemismoothNewtonSolver().Solve(disc).history) <= steps and disc.solves <= solves
    monkeypatch.setattr(step, "HOLD", 0)
    monkeypatch.setattr(StiffenedBody, "Merit", Plain)
    with pytest.raises(NotConvergedError, match="translation along x"):
        SemismoothNewtonSolver().Solve(Strip())


@pytest.mark.parametrize("sticking", [setting.STICKING, 100])
def test_merit_sees_that_a_body_in_flight_is_out_of_balance(sticking, monkeypatch):
    """All points slip the same way by 1, for a displacement of 0.3, or sink too little and too much by a thousandth of that.

    F itself sees it as long as little holds the body in the matrix.
    """
    monkeypatch.setattr(setting, "STICKING", sticking)
    run = NewtonRun(Block(), None, 1e-10)
    state, scale = step.NewtonStep(run.body.Evaluate(run.start), run.record, run.tol), run.setting.scale[:, None]
    place = run.setting.contact.coordinates[:, :1] / two_materials.LENGTH - 0.5
    tilted = state.At(state.point.q + 1e-3 * scale * place * [0, 1])
    flying = state.At(state.point.q + scale * [1, 0])
    assert np.all(flying.point.zones == 2)
    assert flying.merit > 100 * tilted.merit
    assert (Plain(run.body, flying.F) < Plain(run.body, tilted.F)) == (sticking == 100)


def test_slopes_are_raised_for_such_a_body_alone_and_fade():
    run = NewtonRun(Block(), None, 1e-10)
    state, merits, body = run.body.Evaluate(run.start), [], run.body
    for _ in range(3):
        merits.append(state.merit)
        state = step.NewtonStep(state, run.record, run.tol)
    least = [taken.least for taken in run.record.taken]
    assert least == pytest.approx(step.HOLD * np.sqrt(np.array(merits) / merits[0])) and least[-1] < 0.5 * least[0]
    sliding = run.setting.graph.At(state.point.q + run.setting.scale[:, None] * [1, 0])
    assert np.linalg.eigvalsh(sliding.derivative + np.swapaxes(sliding.derivative, 1, 2)).min() < 1e-12
    raised, plain = body.Equation(sliding, 0.01), PointwiseEquation(sliding, run.setting.scale, body.stiffness, body.blocks)
    assert np.abs(raised.P - plain.P).max() > 1e-3
    held = NewtonRun(Discretization(Held(), InteriorPenalty(), two_materials.Mesh(4), order=1), None, 1e-10)
    step.NewtonStep(held.body.Evaluate(held.start), held.record, held.tol)
    assert [taken.least for taken in held.record.taken] == [None]


def Held():
    """The block with its sides clamped."""
    problem = two_materials.Problem()
    return type(problem)(problem.material, problem.foundation, dirichlet={"side": (0, 0)}, traction=problem.traction)


def Pulled():
    """A plate of steel on a gasket, pulled with 0.97 of what friction can hold: on order 1 all of its points slip."""
    plate = Box(Pnt(0, 0, 0), Pnt(8, 5, 1))
    for face, name in zip(plate.faces, Sides(plate)):
        face.name = name
    load = {"top": CF((0.29, 0, -1 - 0.2 * (x - 4) - 0.03 * (y - 2.5)))}
    foundation = Foundation("bottom", NormalCompliance(20), friction=CoulombFriction(0.3))
    return Discretization(ContactProblem(HookeMaterial(E=210000, nu=0.3), foundation, traction=load), InteriorPenalty(),
                          ShapeMesh(plate, 2.0), order=2)


def Sides(plate):
    return ["bottom" if face.center.z < 0.1 else "top" if face.center.z > 0.9 else "side" for face in plate.faces]


def test_a_prediction_in_which_no_point_sticks_leaves_enough_stiffness(monkeypatch):
    """With no more stiffness than beside points that stick, what order 1 predicts leads nowhere."""
    disc = Pulled()
    coarse = SemismoothNewtonSolver().Solve(Coarser(disc, disc.mesh, 1))
    assert np.sum(coarse.zones == STICK) == 0
    start = Transfer(coarse, disc.contact)
    rest, found = SemismoothNewtonSolver().Solve(Pulled()), SemismoothNewtonSolver().Solve(disc, start=start)
    assert np.abs(found.displacement - rest.displacement).max() < 1e-8 * np.abs(rest.displacement).max()
    assert len(found.history) <= 6
    monkeypatch.setattr(setting, "LOOSE", setting.FLOOR)
    with pytest.raises(NotConvergedError, match="stagnates"):
        SemismoothNewtonSolver().Solve(disc, start=start)
