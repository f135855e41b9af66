"""The Uzawa iteration: it is the paper's, its limit is predicted, its failures are recognised and explained."""

from dataclasses import replace

import numpy as np
import pytest
from ngsolve import CF, H1, SEGM, GridFunction, IfPos, IntegrationRule, LinearForm, ds, specialcf, x
from problems import CASES, METHODS, Example

from ngdgc import (Conforming, ContactProblem, CoulombFriction, Discretization, EstimateContraction, Foundation, HookeMaterial,
                   InteriorPenalty, NormalCompliance, NotConvergedError, ProblemError, SolveInterrupted, UzawaSolver)
from ngdgc.cases import example_4_1, example_4_2
from ngdgc.exact import AffinePatch
from ngdgc.meshes import RectangleMesh
from ngdgc.contact.equilibrium import Equilibrium
from ngdgc.solvers.driver import LawResidual


def Softened(case, stiffness, plane="strain"):
    """An example with another stiffness of its foundation."""
    problem = case.Problem(plane)
    return replace(problem, foundation=replace(problem.foundation[0], compliance=NormalCompliance(stiffness)))


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS, ids=["ip-auto", "ip-30", "h1"])
@pytest.mark.parametrize("name", CASES)
def test_converges_below_its_limit_and_fails_recognised_above(name, method):
    """0.9, 1.2 and 10 times the stiffness at which the contraction number, measured at the solution, becomes 1."""
    case, stiffness = CASES[name], {"4.1": 450, "4.2": 250}[name]
    mesh = case.Mesh(16)
    solution = UzawaSolver().Solve(Discretization(case.Problem("strain"), method, mesh, order=1))
    limit = stiffness / EstimateContraction(solution.disc, solution.penetration).normal
    near = UzawaSolver().Solve(Discretization(Softened(case, 0.9 * limit), method, mesh, order=1))
    assert near.converged and near.history[-1].change <= 1e-8 and near.history[-1].residual <= 1e-8
    for factor in (1.2, 10):
        with pytest.raises(NotConvergedError, match="cannot converge for any rho.*cycle.*Remedy") as failure:
            UzawaSolver().Solve(Discretization(Softened(case, factor * limit), method, mesh, order=1))
        error = failure.value
        assert len(error.history) <= 50
        assert error.contraction.normal == pytest.approx(factor, rel=0.3) and error.contraction.normal > 1
        if factor == 1.2:       # bounded, so growth would never have been seen
            assert np.abs(error.solution.displacement).max() < 5


@pytest.mark.parametrize("method", METHODS[::2], ids=["ip", "h1"])
def test_iterates_are_those_of_the_paper(method):
    """(4.3)-(4.8) written again in NGSolve symbolics, multiplier at the points by hand, for five steps."""
    rho, kn, kt, gap = 0.02, 450.0, 40.0, 0.05      # lambda stays inside the ball for some steps
    disc = Discretization(Example(kn, friction=kt), method, RectangleMesh(4, lower=(0, 0.05), upper=(1, 1.05)), order=1)
    iterates = []
    with pytest.raises(NotConvergedError):
        UzawaSolver(rho=rho, tol=1e-14, maxiter=5).Solve(disc, callback=iterates.append)
    gfu, v, n = GridFunction(disc.space), disc.space.TestFunction(), specialcf.normal(2)
    rule = IntegrationRule(SEGM, 2) if method.discontinuous else IntegrationRule([(0,), (1,)], [0.5, 0.5])
    bottom = ds(skeleton=True, definedon=disc.mesh.Boundaries("bottom"), intrules={SEGM: rule})
    Interpolate = _FacetwiseLinear if method.discontinuous else _Nodal
    gfu.vec.FV().NumPy()[:] = free = disc.FreeSolution()
    multiplier = np.zeros(len(disc.contact.weights))
    # The multiplier as a function that has its values at the points.
    for _ in range(5):
        multiplier = np.clip(multiplier + rho * kt * np.asarray(gfu[0](disc.contact.inside)).ravel(), -1, 1)
        interpolated = Interpolate(disc, multiplier)
        normal = LinearForm(kn * IfPos(gfu * n - gap, gfu * n - gap, 0) * (v * n) * bottom).Assemble()
        tangential = LinearForm(kt * interpolated * v[0] * bottom).Assemble()
        gfu.vec.FV().NumPy()[:] = free - disc.SolveLinear(normal.vec.FV().NumPy() + tangential.vec.FV().NumPy())
    ours = disc.contact.Displacement(_Last(disc, rho))
    assert ours == pytest.approx(np.asarray(gfu(disc.contact.inside)), abs=1e-12)
    assert ours != pytest.approx(np.asarray(disc.contact.Displacement(_Last(disc, 0.9 * rho))), abs=1e-6)


def _Nodal(disc, values):
    function = GridFunction(H1(disc.mesh, order=1))
    number = {tuple(place): i for i, place in enumerate(disc.contact.coordinates)}
    for vertex in disc.mesh.vertices:
        if vertex.point in number:
            function.vec[vertex.nr] = values[number[vertex.point]]
    return function


def _FacetwiseLinear(disc, values):
    """Linear between the two Gauss points of each facet."""
    order = np.argsort(disc.contact.coordinates[:, 0])
    s, values = disc.contact.coordinates[order, 0], values[order]
    pieces = 0
    for cell in range(4):
        (a, b), (va, vb) = s[2 * cell:2 * cell + 2], values[2 * cell:2 * cell + 2]
        inside = IfPos(x - cell / 4, 1, 0) * IfPos((cell + 1) / 4 - x, 1, 0)
        pieces += inside * (va + (vb - va) * (x - a) / (b - a))
    return pieces


def _Last(disc, rho):
    with pytest.raises(NotConvergedError) as failure:
        UzawaSolver(rho=rho, tol=1e-14, maxiter=5).Solve(disc)
    return failure.value.solution.vector


def test_automatic_rho_equals_no_slower_than_the_paper_could_choose():
    """Example 4.1: about 80 iterations with rho = 1 and 34 with rho = 300."""
    disc = Discretization(example_4_1.Problem("strain"), METHODS[1], example_4_1.Mesh(16), order=2)
    counts = {rho: len(UzawaSolver(rho=rho, tol=1e-9).Solve(disc).history) for rho in (1.0, 300.0, "auto")}
    assert counts["auto"] <= min(counts.values()) + 2 and counts[1.0] > 2 * counts["auto"]


@pytest.mark.parametrize("zone", ["slip", "stick"])
def test_automatic_rho_does_not_depend_on_the_units(zone):
    """The same patch with all stresses in another unit takes the same number of iterations."""
    counts = []
    for unit in (1.0, 1e6):
        exact = AffinePatch(zone, material=HookeMaterial(mu=1000 * unit, lam=1500 * unit), stiffness=100 * unit, bound=3 * unit)
        solution = UzawaSolver().Solve(Discretization(exact.problem, InteriorPenalty(), RectangleMesh(2), order=1))
        counts.append(len(solution.history))
    assert abs(counts[0] - counts[1]) <= 1


def test_too_large_rho_is_named_with_a_remedy_that_works():
    # Stick everywhere, so that the multiplier is inside the ball and the step matters.
    problem = AffinePatch("stick").problem
    disc = Discretization(problem, InteriorPenalty(), RectangleMesh(2), order=1)
    unit = EstimateContraction(disc, np.ones(len(disc.contact.weights)), step=9.0)     # p_t^2, rho = 1
    limit = (1 - unit.normal) / unit.friction
    with pytest.raises(NotConvergedError, match="rho=.* is too large.*Remedy") as failure:
        UzawaSolver(rho=2 * limit).Solve(disc)
    assert len(failure.value.history) <= 50 and failure.value.contraction.friction > 1
    assert UzawaSolver(rho=0.8 * limit).Solve(disc).converged


@pytest.mark.slow
@pytest.mark.parametrize("mu, stiffness, push, method, order, n", [
    (0.3, 1000, 1e-3, Conforming(), 1, 8), (0.3, 500, 0, Conforming(), 1, 8), (0.1, 500, 0, Conforming(), 2, 4),
    (0.1, 1000, 0, Conforming(), 2, 4), (0.3, 1000, 1e-3, InteriorPenalty(), 1, 8)])
def test_a_convergent_iteration_is_not_taken_for_a_cycle(mu, stiffness, push, method, order, n):
    """Coulomb friction with points that turn from stick to slip on the way, which lifts the change for some steps."""
    foundation = Foundation("bottom", NormalCompliance(stiffness), friction=CoulombFriction(mu), gap=1e-3)
    problem = ContactProblem(HookeMaterial(E=2000, nu=0.3), foundation, dirichlet={"top": CF((push, -3e-3))})
    disc = Discretization(problem, method, RectangleMesh(n), order=order)
    solution = UzawaSolver(tol=1e-8).Solve(disc)
    assert solution.converged and EstimateContraction(disc, solution.penetration).normal < 1


def test_a_plateau_before_the_end_is_not_taken_for_a_cycle():
    """Example 4.1 with rho = 1: the multiplier reaches its bound late."""
    assert len(example_4_1.Main(n=16, solver=UzawaSolver(rho=1.0, tol=1e-11)).history) > 40


def test_a_body_moved_by_its_foundation_alone_is_no_blow_up():
    """It starts inside the foundation, and its loads are round-off: the displacement grows from 1e-19 to 1e-3."""
    foundation = Foundation("bottom", NormalCompliance(300), gap=-0.05)
    problem = Example(foundation=foundation, traction={"left": CF((1e-16, 0))})
    solution = UzawaSolver().Solve(Discretization(problem, Conforming(), RectangleMesh(4), order=1))
    assert solution.converged and np.abs(solution.displacement).max() > 1e-3


def test_stiffness_far_beyond_the_limit_is_recognised_before_anything_overflows():
    for exponent in (1, 3):
        foundation = Foundation("bottom", NormalCompliance(1e12, exponent))
        problem = replace(example_4_2.Problem(), foundation=foundation)
        with pytest.raises(NotConvergedError, match="cannot converge for any rho") as failure:
            UzawaSolver().Solve(Discretization(problem, Conforming(), example_4_2.Mesh(8), order=1))
        assert np.all(np.isfinite(failure.value.solution.vector)) and len(failure.value.history) <= 50


def test_only_a_discretisation_can_be_solved():
    with pytest.raises(ProblemError, match="give Discretization"):
        UzawaSolver().Solve(Example())


def test_automatic_rho_leaves_room_for_the_normal_part():
    """k_n near its limit and a sticking zone: the rule converges, the step that |S_tt| alone allows does not."""
    bound = 1000.0
    disc = Discretization(Example(750.0, friction=bound), Conforming(), RectangleMesh(4), order=1)
    solution = UzawaSolver(tol=1e-8).Solve(disc)
    assert solution.ZoneLengths()["stick"] > 0.5
    unit = EstimateContraction(disc, solution.penetration, step=1.0)
    assert 0.7 < unit.normal < 1
    with pytest.raises(NotConvergedError, match="too large"):
        UzawaSolver(tol=1e-8, rho=0.9 / unit.friction / bound ** 2).Solve(disc)


@pytest.mark.slow
def test_small_rho_does_not_stop_early():
    """u hardly moves while lambda crawls: the law residual keeps the iteration going until it is true."""
    exact = AffinePatch("slip", bound=1.0)
    disc = Discretization(exact.problem, InteriorPenalty(), RectangleMesh(2), order=1)
    slow = UzawaSolver(tol=1e-4, rho=0.01).Solve(disc)
    assert slow.history[20].change < 1e-4 < slow.history[20].residual       # by its change alone it would have stopped
    assert np.linalg.norm(slow.friction, axis=1) == pytest.approx(1.0, rel=1e-3)


def test_two_step_limit_raises_with_everything_in_the_error():
    disc = Discretization(Example(), InteriorPenalty(), RectangleMesh(4), order=1)
    with pytest.raises(NotConvergedError, match="too slowly.*after 2 iterations") as failure:
        UzawaSolver(maxiter=2).Solve(disc)
    error = failure.value
    assert [step.number for step in error.history] == [1, 2] and not error.solution.converged
    assert error.contraction.normal == pytest.approx(0.54, abs=0.03)
    assert "NOT CONVERGED" in error.solution.Report()


def test_tolerance_below_roundoff_is_recognised():
    disc = Discretization(Example(), InteriorPenalty(), RectangleMesh(8), order=3)
    with pytest.raises(NotConvergedError, match="below what round-off allows") as failure:
        UzawaSolver(tol=1e-17).Solve(disc)
    assert len(failure.value.history) < 200


def test_interrupt_keeps_the_last_iterate():
    disc = Discretization(Example(), InteriorPenalty(), RectangleMesh(4), order=1)

    def Interrupt(step):
        if step.number == 3:
            raise KeyboardInterrupt

    with pytest.raises(SolveInterrupted) as stop:
        UzawaSolver().Solve(disc, callback=Interrupt)
    assert len(stop.value.solution.history) == 3 and stop.value.solution.energy > 0


def test_law_residual_vanishes_on_the_graph_and_only_there():
    disc = Discretization(Example(100.0, friction=2.0), InteriorPenalty(), RectangleMesh(1), order=2)
    contact = disc.contact      # n = (0, -1), gap 0.05; points: open, stick, slip
    u = np.array([[0.0, 0.01], [0.0, -0.25], [0.3, -0.25]])
    t = np.array([[0.0, 0.0], [1.5, -20.0], [2.0, -20.0]])
    assert LawResidual(contact, Equilibrium(vector=None, displacement=u, traction=t)) < 1e-15
    for wrong in ([[0, 0], [1.5, -20], [-2, -20]], [[0, 0], [1.5, -19], [2, -20]], [[0, -1], [1.5, -20], [2, -20]]):
        assert LawResidual(contact, Equilibrium(vector=None, displacement=u, traction=np.array(wrong, float))) > 1e-3
    creeping = u + [[0, 0], [0.1, 0], [0, 0]]       # slips although friction is below its bound
    assert LawResidual(contact, Equilibrium(vector=None, displacement=creeping, traction=t)) > 0.1


def test_no_contact_needs_one_step_and_no_friction_law_is_frictionless():
    far = Foundation("bottom", NormalCompliance(450), gap=5.0)
    solution = UzawaSolver().Solve(Discretization(Example(foundation=far), InteriorPenalty(), RectangleMesh(4), order=1))
    assert len(solution.history) == 1 and not np.any(solution.traction)
    near = Foundation("bottom", NormalCompliance(450), gap=0.05)
    solution = UzawaSolver().Solve(Discretization(Example(foundation=near), InteriorPenalty(), RectangleMesh(4), order=1))
    assert not np.any(solution.friction) and solution.normalforce > 1 and solution.ZoneLengths()["stick"] == 0


def test_lagged_coulomb_bound_satisfies_the_law_at_the_end():
    foundation = Foundation("bottom", NormalCompliance(300), friction=CoulombFriction(0.4), gap=0.05)
    solution = UzawaSolver(tol=1e-10).Solve(Discretization(Example(foundation=foundation), InteriorPenalty(), RectangleMesh(8),
                                                           order=1))
    assert solution.bound == pytest.approx(0.4 * solution.pressure, abs=1e-6)
    friction = np.linalg.norm(solution.friction, axis=1)
    assert np.all(friction <= solution.bound + 1e-6)
    slip = solution.zones == 2
    assert np.any(slip) and friction[slip] == pytest.approx(solution.bound[slip], rel=1e-6)


def test_unloaded_body_stays_at_rest(method):
    problem = Example(traction={"left": CF((0, 0))})
    solution = UzawaSolver().Solve(Discretization(problem, method, RectangleMesh(3), order=1))
    assert np.abs(solution.vector).max() == 0 and solution.converged and solution.energy == 0
