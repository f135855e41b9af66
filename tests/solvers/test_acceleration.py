"""The implicit normal step, its adaptive step and Anderson's acceleration: limits, equivalence, counts, ends."""

from dataclasses import replace

import numpy as np
import pytest
from ngsolve import CF
from problems import Example
from stiff import EXAMPLES, FAST, IMPLICIT, Stiff

from ngdgc import (Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, NotConvergedError, ProblemError, SemismoothNewtonSolver, TrescaFriction, UzawaSolver)
from ngdgc.exact import AffinePatch
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.studies.samples import Draw as Sample
from ngdgc.solution.history import Step
from ngdgc.solvers import driver
from ngdgc.solvers.uzawa import solver as uzawa
from ngdgc.solvers.driver import _Verdict
from ngdgc.solvers.uzawa.steps import Anderson


def Difference(one, other):
    """Largest differences of displacement and of the load that the tractions are to the body, relative."""
    contact = one.disc.contact
    loads = [contact.Load(solution.traction) for solution in (one, other)]
    return (np.abs(one.displacement - other.displacement).max() / np.abs(one.displacement).max(),
            np.abs(loads[0] - loads[1]).max() / np.abs(loads[0]).max())


@pytest.mark.slow
@pytest.mark.parametrize("friction", [TrescaFriction(1), TrescaFriction(50), CoulombFriction(0.3)],
                         ids=["bound-1", "bound-50", "coulomb"])
@pytest.mark.parametrize("name", EXAMPLES)
def test_implicit_and_explicit_solve_the_same_problem(name, friction, method):
    """At a tenth of the modulus both converge; a friction bound halved is another problem."""
    explicit = UzawaSolver().Solve(Stiff(name, 0.1, friction, method=method))
    for solver in IMPLICIT.values():
        solution = solver.Solve(Stiff(name, 0.1, friction, method=method))
        assert max(Difference(explicit, solution)) < 1e-7
    half = replace(friction, **{key: value / 2 for key, value in vars(friction).items()})
    assert max(Difference(explicit, solver.Solve(Stiff(name, 0.1, half, method=method)))) > 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [1e2, 1e6])
@pytest.mark.parametrize("friction", [TrescaFriction(1), CoulombFriction(0.3)], ids=["bound", "coulomb"])
@pytest.mark.parametrize("name", EXAMPLES)
def test_implicit_converges_far_beyond_the_explicit_limit(name, friction, ratio):
    """k_n of 100 and 1e6 moduli: all implicit variants find one solution, the explicit iteration none."""
    plain = replace(IMPLICIT["plain"], tol=1e-8).Solve(Stiff(name, ratio, friction, n=4))
    penetration = plain.penetration.max() / np.abs(plain.displacement).max()
    assert plain.normalforce > 1 and penetration < 5 / ratio
    for solver in FAST:
        solution = solver.Solve(Stiff(name, ratio, friction, n=4))
        # The plain iteration stops 1e-8 per step from a limit that it approaches by a hundredth per step.
        assert max(Difference(solution, plain)) < 5e-6
        assert len(plain.history) > 5 * len(solution.history)
    assert len(solution.history) <= 50
    with pytest.raises(NotConvergedError, match="cannot converge for any rho.*SemismoothNewtonSolver"):
        UzawaSolver().Solve(Stiff(name, ratio, friction, n=4))


def test_counts_of_anderson_do_not_grow_with_the_stiffness():
    """From k_n = 100 E to 1e6 E nothing happens any more; from n = 8 to 16 less than twice the steps, plain more."""
    counts = {(n, ratio): len(IMPLICIT["anderson"].Solve(Stiff("4.1", ratio, TrescaFriction(1), n=n)).history)
              for n in (8, 16) for ratio in (1e2, 1e4, 1e6)}
    assert counts[8, 1e6] <= counts[8, 1e4] + 2 and counts[16, 1e6] <= 2 * counts[8, 1e6] <= 80


@pytest.mark.parametrize("stiffness", [100.0, 1e7])
@pytest.mark.parametrize("exponent", [1, 3])
def test_slip_patch_is_exact_for_stiff_and_nonlinear_foundations(stiffness, exponent):
    exact = AffinePatch("slip", stiffness=stiffness, exponent=exponent, coulomb=0.2)
    for solver in FAST:
        # The tolerance is relative to what the tractions do to the body: they move its top by up to 570.
        solution = replace(solver, tol=1e-12).Solve(Discretization(exact.problem, InteriorPenalty(), RectangleMesh(3), order=1))
        expected = np.array([exact.displacement(solution.disc.mesh(*point)) for point in solution.points])
        assert solution.displacement == pytest.approx(expected, abs=1e-9)
        assert solution.ZoneLengths()["slip"] == pytest.approx(1)


STICK = [(2, "triangle", 8), (3, "tet", 2), (3, "hex", 2), (3, "prism", 2)]


@pytest.mark.slow
@pytest.mark.parametrize("dim, cells, n", STICK, ids=[f"{cells}-{n}" for _, cells, n in STICK])
def test_acceleration_on_the_stick_patch(dim, cells, n):
    """Every point sticks, so |S|/lambda_min decides; Anderson needs a fifth of the steps, and the patch stays exact."""
    exact, mesh = AffinePatch("stick", dim=dim), (RectangleMesh if dim == 2 else BoxMesh)(n, cells=cells)
    disc = Discretization(exact.problem, InteriorPenalty(), mesh, order=1)
    for normal in ("explicit", "implicit"):
        plain = UzawaSolver(normal=normal).Solve(disc)
        fast = UzawaSolver(normal=normal, acceleration="anderson").Solve(disc)
        assert 5 * len(fast.history) < len(plain.history)
        assert np.abs(fast.slip).max() < 1e-8 and fast.ZoneLengths()["stick"] == pytest.approx(1)
        assert max(Difference(fast, plain)) < 1e-6
    assert 2 * len(IMPLICIT["adaptive"].Solve(disc).history) < len(plain.history)
    # A bound below the traction of the patch makes it slip.
    soft = replace(exact.problem, foundation=replace(exact.problem.foundation[0], friction=TrescaFriction(1.0)))
    assert np.abs(IMPLICIT["anderson"].Solve(Discretization(soft, InteriorPenalty(), mesh, order=1)).slip).max() > 1e-5


@pytest.mark.slow
def test_acceleration_does_not_break_a_convergent_run():
    """Examples at all stiffnesses where the plain explicit iteration converges: never more steps than it takes."""
    for name in EXAMPLES:
        for friction in (TrescaFriction(1), CoulombFriction(0.3)):
            for ratio in (1e-3, 1e-2, 0.1):
                disc = Stiff(name, ratio, friction)
                for normal in ("explicit", "implicit"):
                    plain, fast = (len(UzawaSolver(normal=normal, acceleration=acceleration).Solve(disc).history)
                                   for acceleration in (None, "anderson"))
                    assert fast <= plain


def test_anderson_is_gmres_on_a_linear_map_and_forgets_when_it_fails():
    """For x -> M x + b in R^6 it ends after 7 evaluations; after a residual that grew it makes the plain step."""
    random = np.random.default_rng(3)
    matrix, b = 0.4 * random.standard_normal((6, 6)), random.standard_normal(6)
    anderson, x = Anderson(1.0), np.zeros(6)
    for _ in range(8):
        x = anderson(x, matrix @ x + b)
    assert x == pytest.approx(np.linalg.solve(np.eye(6) - matrix, b), abs=1e-9)
    assert np.abs(np.linalg.eigvals(matrix)).max() > 0.5        # plain steps would be far off
    image = x + 1.0
    assert np.array_equal(anderson(x, image), image)
    assert np.array_equal(anderson(image, image + 1.0), image + 1.0)       # until the residual is back
    x = anderson(image, image + 1e-16)
    assert not np.array_equal(anderson(x, x + 1e-16), x + 1e-16)


@pytest.mark.parametrize("normal", ["explicit", "implicit"])
def test_iterations_do_not_depend_on_the_units(normal):
    """The same patch with all stresses in another unit, accelerated: the same number of iterations."""
    counts = []
    for unit in (1.0, 1e6):
        material = HookeMaterial(mu=1000 * unit, lam=1500 * unit)
        exact = AffinePatch("stick", material=material, stiffness=100 * unit, bound=3 * unit)
        disc = Discretization(exact.problem, InteriorPenalty(), RectangleMesh(4), order=1)
        counts.append(len(UzawaSolver(normal=normal, acceleration="anderson").Solve(disc).history))
    assert abs(counts[0] - counts[1]) <= 1


def test_unloaded_body_and_no_contact():
    far = Foundation("bottom", NormalCompliance(450), gap=5.0)
    for problem in (Example(traction={"left": CF((0, 0))}), Example(foundation=far)):
        for solver in IMPLICIT.values():
            solution = solver.Solve(Discretization(problem, Conforming(), RectangleMesh(2), order=1))
            assert solution.converged and not np.any(solution.traction) and solution.Report()


def test_body_held_by_its_foundation_alone_is_refused():
    problem = ContactProblem(HookeMaterial(E=100, nu=0.3), Foundation("bottom", NormalCompliance(10)), roller={"left": 0},
                             bodyforce=CF((0, -1)))
    disc = Discretization(problem, Conforming(), RectangleMesh(2), order=1)
    for solver in IMPLICIT.values():
        with pytest.raises(ProblemError, match="held by its foundation alone"):
            solver.Solve(disc)


def Verdict(residuals, window, rest):
    """The first verdict of the driver on an iteration with these residuals that goes to and fro, with its number."""
    history, positions = [], []
    for number, residual in enumerate(residuals, 1):
        history.append(Step(number, residual, residual, number, 0.0))
        positions = positions[-window:] + [np.array([[(-1.0) ** number * residual, 1.0]])]
        reason = _Verdict(UzawaSolver(tol=1e-8), history, positions, 0.0, window, rest)
        if reason:
            return reason, number
    return None


def test_rests_of_fast_iterations_are_no_end():
    """As long as half of the way before, as adaptive steps make them; who never moves again is stopped, plain steps sooner."""
    way = np.geomspace(1e-2, 1e-4, 110)
    resting = [*way, *[1e-4] * 50, *np.geomspace(1e-4, 1e-7, 100)]
    assert Verdict(resting, uzawa.WINDOW, uzawa.REST) is None
    assert Verdict(resting, uzawa.WINDOW, 0.0)[0] == "cycle"        # control: a fixed window
    reason, number = Verdict([*way, *[1e-4] * 1000], uzawa.WINDOW, uzawa.REST)
    assert reason == "cycle" and number <= 2 * len(way) + 10
    assert Verdict([0.1] * 1000, uzawa.WINDOW, uzawa.REST) == ("cycle", 2 * uzawa.WINDOW)
    assert Verdict([0.1] * 1000, driver.WINDOW, 0.0) == ("cycle", 2 * driver.WINDOW)


@pytest.mark.slow
@pytest.mark.parametrize("options", [{"rho": "adaptive"}, {"acceleration": "anderson"}])
def test_a_slow_problem_is_solved(options):
    """Stick, slip and separation on a stiff foundation: hundreds of adaptive steps with rests, and Newton's solution."""
    disc = Sample(1, 8, dofs=3000).Disc()
    solution = UzawaSolver(normal="implicit", tol=1e-8, **options).Solve(disc)
    assert max(Difference(SemismoothNewtonSolver().Solve(disc), solution)) < 1e-4 and len(solution.history) > 100


@pytest.mark.parametrize("friction, words", [(TrescaFriction(1), "no progress with.*plain steps converge"),
                                             (CoulombFriction(0.3), "friction depends on the penetration")])
@pytest.mark.parametrize("options", [{"rho": "adaptive"}, {"acceleration": "anderson"}])
def test_cause_of_a_failure_depends_on_the_friction(options, friction, words, monkeypatch):
    """As if nothing progressed; a bound that is constant is not blamed."""
    monkeypatch.setattr(uzawa, "WINDOW", 10)
    monkeypatch.setattr(driver, "NOPROGRESS", 0.0)
    monkeypatch.setattr(driver, "_GoesSomewhere", lambda positions: False)
    with pytest.raises(NotConvergedError, match=words):
        UzawaSolver(normal="implicit", tol=1e-14, **options).Solve(Stiff("4.1", 1e4, friction))


@pytest.mark.parametrize("arguments, culprit", [
    ({"normal": "semi"}, "normal is"), ({"acceleration": "fista"}, "acceleration is"),
    ({"rho": "adaptive"}, "rho is 'adaptive'.*normal='implicit'"),
    ({"rho": "adaptive", "normal": "implicit", "acceleration": "anderson"}, "rho is 'adaptive'.*without acceleration")])
def test_bad_options(arguments, culprit):
    with pytest.raises(ProblemError, match=culprit):
        UzawaSolver(**arguments)
