"""Forces that are given as totals, and springs that hold a body: exact solutions, totals and balance to round-off."""

import pickle

import numpy as np
import pytest
from bodies import Perforated
from ngsolve import CF, Parameter, x, y
from problems import TEN, Solved

from ngdgc import (LDG, Conforming, ContactProblem, ContactSolution, Discretization, EstimateError, EstimateForce, Foundation,
                   HookeMaterial, InteriorPenalty, NonsymmetricInteriorPenalty, NormalCompliance, ProblemError, Solve)
from ngdgc.estimates.residual import ResidualEstimate
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.plots import SettingFigure
from ngdgc.theory.consistency import ConsistencyResidual

MATERIAL = HookeMaterial(mu=1000, lam=1500)     # lam + 2 mu = 3500
WALLS = {2: "left|right", 3: "left|right|front|back"}


def Column(dim, *, force=-40.0, spring=500.0, k=300.0, gap=0.01):
    """(problem, p, u): a column of base 2 between rollers, a force and springs on its top, the foundation at its bottom.

    p = P + k_s u_top on every height, P = 20 the load over the area 2, u = -(g + p/k) - p h/(lam + 2 mu).
    """
    load = {"top": (0,) * (dim - 1) + (force,)}
    problem = ContactProblem(MATERIAL, Foundation("bottom", NormalCompliance(k), gap=gap), roller={WALLS[dim]: 0}, force=load,
                             spring={"top": (0,) * (dim - 1) + (spring,)})
    p = (-force / 2 - spring * gap) / (1 + spring / k + spring / 3500)
    return problem, p, -(gap + p / k)


def Block(dim):
    return RectangleMesh(2, upper=(2, 1)) if dim == 2 else BoxMesh(2, upper=(2, 1, 1))


@pytest.mark.parametrize("assembly", ["facet", "skeleton"])
@pytest.mark.parametrize("dim, method", [*((2, method) for method in (*TEN, Conforming(), NonsymmetricInteriorPenalty())),
                                         (3, TEN[0]), (3, TEN[6]), (3, Conforming())], ids=str)
def test_column_on_springs(dim, method, assembly):
    problem, p, bottom = Column(dim)
    solution = Solved(problem, method, Block(dim), order=1, assembly=assembly)
    assert np.abs(solution.pressure - p).max() < 1e-11 * p
    if dim == 2:
        assert np.abs(np.array(solution.gfu(solution.disc.contact.inside)) - [0, bottom]).max() < 1e-12
    assert solution.At(*(0.7,) * (dim - 1), 1.0)[-1] == pytest.approx(bottom - p / 3500, rel=1e-11)
    assert solution.GlobalImbalance() < 1e-11
    if method.conservative:
        assert np.abs(solution.ElementImbalance()).max() < 1e-11
    spring = next(part for part in solution.Resultants() if part.kind == "spring")
    assert spring.region == "top" and spring.force[-1] == pytest.approx(-500 * (bottom - p / 3500) * 2, rel=1e-11)
    if method.conservative or not method.discontinuous:
        # Through the top go the load and the springs.
        assert np.abs(solution.Force("top") - np.eye(dim)[-1] * (-40 + spring.force[-1])).max() < 1e-10


def test_springs_alone_hold_a_body():
    # A body that nothing but springs and the foundation holds; with springs along one axis it floats (control).
    mesh, held = RectangleMesh(3), {"left": 50.0}

    def Found(spring):
        foundation = Foundation("bottom", NormalCompliance(1000), gap=0.5)
        problem = ContactProblem(MATERIAL, foundation, bodyforce=(3, 0), spring=spring)
        return Solved(problem, LDG(), mesh, order=1)

    solution = Found(held)
    assert solution.disc.loose and not solution.disc.unresisted
    assert np.abs(solution.Mean("left") - [3 / 50, 0]).max() < 1e-2 and np.all(solution.pressure == 0)
    force = next(part.force for part in solution.Resultants() if part.kind == "spring")
    assert np.abs(force - [-3, 0]).max() < 1e-11
    assert abs(solution.Mean("left")[0] - 3 / 50) < 1e-12       # the mean of k u over the side is the load
    assert np.abs(Found({"left": (50, 50)}).vector - solution.vector).max() == 0
    with pytest.raises(ProblemError, match="nor a spring"):
        Found({"left": (0, 0)})


@pytest.mark.parametrize("method", [LDG(), InteriorPenalty(form="lifting"), Conforming()], ids=str)
def test_springs_that_vary_and_depend_on_a_parameter(method):
    scale, mesh = Parameter(1), RectangleMesh(3)
    springs = {"left": scale * (100 + 300 * y), "right": CF((50 * (1 + y), 0))}
    problem = ContactProblem(MATERIAL, Foundation("bottom", NormalCompliance(400)), dirichlet={"top": (0.01, -0.05)},
                             spring=springs, traction={"right": (0, 5)})
    disc = Discretization(problem, method, mesh, order=2)
    one = Solve(disc)
    scale.Set(2)
    two = Solve(disc)
    scale.Set(1)
    assert np.array_equal(Solve(disc).vector, one.vector)
    assert np.abs(two.vector - one.vector).max() > 1e-4         # the new stiffness counts, in the matrix too
    for solution in (one, two):
        assert solution.GlobalImbalance() < 1e-11
        shares = {part.region: part.force for part in solution.Resultants() if part.kind == "spring"}
        assert shares["right"][1] == 0 and abs(shares["right"][0]) > 0.1
        assert np.abs(solution.Force("left") - shares["left"]).max() < 1e-10
        assert np.abs(solution.Force("right") - shares["right"] - [0, 5]).max() < 1e-10


def test_springs_are_consistent():
    # The exact column satisfies the discrete equations; with a stiffness that is 1 % off it does not (control).
    _, p, bottom = Column(2)
    down = bottom - p / 3500 * y

    def Residual(spring):
        problem = ContactProblem(MATERIAL, Foundation("bottom", NormalCompliance(300), gap=0.01), dirichlet={"top": (0, down)},
                                 roller={"left": 0}, traction={"right": CF((-1500 * p / 3500, 700 * down))},
                                 spring={"right": (0, spring)})
        return ConsistencyResidual(Discretization(problem, LDG(), Block(2)), CF((0, down)))

    assert Residual(700) < 1e-9
    assert Residual(707) > 1e-4


@pytest.mark.parametrize("inverse", ["iterative", "umfpack"])
def test_inverses(inverse):
    problem, p, _ = Column(2)
    solution = Solve(Discretization(problem, InteriorPenalty(), Block(2), inverse=inverse))
    assert np.abs(solution.pressure - p).max() < 1e-7 * p


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("method", [LDG(), TEN[5], Conforming()], ids=str)
def test_the_total_is_kept_on_a_curved_hole(method, order):
    # Over the area of the mesh: the polygon of a circle has less than the circle, and traction times area loses the difference.
    total, mesh = np.array([30.0, -200.0]), Perforated()
    problem = ContactProblem(HookeMaterial(E=1e4, nu=0.3), Foundation("bottom", NormalCompliance(1000)), roller={"left": 0},
                             force={"hole": total})
    disc = Discretization(problem, method, mesh, order=order)
    solution = Solve(disc)
    resultant = next(part for part in solution.Resultants() if part.kind == "force")
    assert np.abs(resultant.force - total).max() < 1e-12 * 200
    assert np.abs(disc.resultant - total).max() < 1e-12 * 200
    foundation = next(part for part in solution.Resultants() if part.kind == "foundation")
    # Rotations are no functions of order 1 on curved elements, forces balance on all.
    assert foundation.force[1] == pytest.approx(200, rel=1e-10)


def test_a_force_is_read_when_solve_begins():
    load = Parameter(0)
    problem = ContactProblem(MATERIAL, Foundation("bottom", NormalCompliance(300)), roller={"left": 0},
                             force={"top": CF((0, -load))})
    disc = Discretization(problem, LDG(), RectangleMesh(2))
    load.Set(7)
    assert Solve(disc).Force("bottom")[1] == pytest.approx(7, rel=1e-11)
    load.Set(9)
    assert Solve(disc).Force("bottom")[1] == pytest.approx(9, rel=1e-11)


def test_estimates():
    # Of a force nothing is left to estimate on the exact column; springs belong to another norm, forces are estimated.
    problem, *_ = Column(2)
    plain = ContactProblem(MATERIAL, problem.foundation, roller=dict(problem.roller), force=dict(problem.force))
    assert EstimateError(Solved(plain, LDG(), Block(2))).relative < 1e-6
    assert ResidualEstimate(Solved(plain, Conforming(), Block(2))).relative < 1e-6
    solution = Solved(problem, LDG(), Block(2))
    for Estimate in (EstimateError, ResidualEstimate):
        with pytest.raises(ProblemError, match="springs"):
            Estimate(solution)
    estimate = EstimateForce(solution)
    assert np.abs(estimate.error["bottom"]).max() < 1e-9 * np.abs(estimate.value["bottom"]).max()


def test_estimate_of_the_force_with_springs():
    # The signed error against a solution of order 5; without the springs in the fine problem it would be off by far.
    foundation = Foundation("bottom", NormalCompliance(3000), gap=0.01 * (x - 0.3) ** 2)
    problem = ContactProblem(MATERIAL, foundation, dirichlet={"top": (0.02, -0.05)}, spring={"left|right": 2000.0})
    coarse, fine = (Solved(problem, InteriorPenalty(), RectangleMesh(n), order=order) for n, order in ((3, 1), (6, 4)))
    estimate, error = EstimateForce(coarse), fine.Force("bottom") - coarse.Force("bottom")
    assert np.all(np.abs(estimate.error["bottom"] - error) < 0.3 * np.abs(error))


def test_they_are_pickled_stored_reported_and_drawn(tmp_path):
    problem, *_ = Column(2)
    again = pickle.loads(pickle.dumps(Column(2, force=-7)[0]))
    assert dict(again.spring).keys() == {"top"} and again.force["top"].dim == 2
    solution = Solved(problem, LDG(), Block(2), order=1)
    solution.Save(tmp_path / "column")
    assert np.array_equal(ContactSolution.Load(tmp_path / "column", problem).vector, solution.vector)
    for other in (Column(2, spring=501.0)[0], Column(2, force=-41.0)[0]):
        with pytest.raises(ProblemError, match="another problem"):
            ContactSolution.Load(tmp_path / "column", other)
    assert "force top" in solution.Report() and "spring top" in solution.Report()
    assert solution.ToJSON()["spring"] == {"top": "(0, 500)"}
    foundation = Foundation("bottom", NormalCompliance(300))
    held = ContactProblem(MATERIAL, foundation, force={"top": (0, -40)}, spring={"left": 10})
    figure = SettingFigure(Discretization(held, LDG(), Block(2)))
    words = " ".join(text.get_text() for text in figure.axes[0].texts)
    assert "F = (0, -40)" in words and "springs" in words and "k = 10" in words
    assert any(part.get_gid() == "springs" for part in figure.axes[0].collections)
    assert SettingFigure(Discretization(Column(3)[0], LDG(), Block(3)))
