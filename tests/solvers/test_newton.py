"""Newton's method on the graph of the law: its derivative, its counts, exact solutions, agreement, failures that are named."""

from dataclasses import replace

import numpy as np
import pytest
from dense import DenseNewton
from ngsolve import CF, x
from problems import METHODS, Example

from ngdgc import (BassiEtAl, Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial,
                   NestedNewtonSolver, NormalCompliance, NotConvergedError, PowerFriction, ProblemError,
                   SemismoothNewtonSolver, SlipWeakeningFriction, SolveInterrupted, TrescaFriction, UzawaSolver)
from ngdgc.cases import example_4_1, example_4_2
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.solvers.newton.record import Record
from ngdgc.solvers.newton.run import NewtonRun

EXAMPLES = {"4.1": (example_4_1, 2000), "4.2": (example_4_2, 2500)}
NEWTON = SemismoothNewtonSolver()


def Stiff(name, ratio, friction, n=8, method=METHODS[0], order=1):
    """An example with k_n = ratio E and another friction law."""
    case, modulus = EXAMPLES[name]
    problem = case.Problem("strain")
    foundation = replace(problem.foundation[0], compliance=NormalCompliance(ratio * modulus), friction=friction)
    return Discretization(replace(problem, foundation=foundation), method, case.Mesh(n), order=order)


def Pressed(foundation, *, push=0.02, mesh=None, method=METHODS[0], order=1):
    """A block whose top is pressed down by a twentieth of its height and moved sideways."""
    mesh = mesh or RectangleMesh(8)
    down = (push, -0.05) if mesh.dim == 2 else (push, 0.5 * push, -0.05)
    problem = ContactProblem(HookeMaterial(E=2000, nu=0.3), foundation, dirichlet={"top": CF(down)})
    return Discretization(problem, method, mesh, order=order)


def Difference(one, other):
    """Largest differences of displacement and of the traction that the body feels, relative."""
    contact = one.disc.contact
    loads = [contact.TraceProjection(solution.traction) for solution in (one, other)]
    return max(np.abs(one.displacement - other.displacement).max() / np.abs(one.displacement).max(),
               np.abs(loads[0] - loads[1]).max() / np.abs(loads[0]).max())


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [1e-2, 1e2, 1e9])
@pytest.mark.parametrize("disc", [lambda k: Stiff("4.1", k, CoulombFriction(0.3), order=2),
                                  lambda k: Stiff("4.2", k, TrescaFriction(5), method=Conforming()),
                                  lambda k: Stiff("4.2", k, SlipWeakeningFriction(0.5, 0.2, 0.01), method=BassiEtAl())])
def test_step_is_that_of_the_derivative(disc, ratio):
    """On a linear piece one full step with exact linear equations ends: from near a solution the merit falls to round-off.

    F is quadratic in the slip of a weakening law, so the step is small enough for its second order.  With a derivative that is
    wrong by a per cent a per cent of F would be left, 1e-4 of the merit.
    """
    disc = disc(ratio)
    solution = NEWTON.Solve(disc)
    random = np.random.default_rng(0)
    for start in (None, (solution.displacement, solution.traction)):
        run = NewtonRun(disc, start, NEWTON.tol)        # with and without stiffness in the matrix
        q = run.setting.graph.Coordinates(solution.displacement, solution.traction)
        point = run.setting.graph.At(q)
        q = q + 1e-6 * np.abs(q).max() * random.uniform(-1, 1, q.shape)
        state = run.body.Evaluate(run.setting.graph.At(q))
        kept = np.array_equal(state.point.zones, point.zones)
        step = run.body.Direction(state, 1e-13)
        left = state.At(q + step).merit / state.merit
        wrong = state.At(q + 1.01 * step).merit / state.merit
        # 1e-5 ^ 2: round-off of u 1e-11 of its size, and second order, against F of 1e-6 of it.
        assert kept and left < 1e-8 and 5e-5 < wrong


@pytest.mark.slow
@pytest.mark.parametrize("name", EXAMPLES)
def test_steps_from_rest_do_not_grow_with_stiffness_friction_or_mesh(name):
    """k_n/E from 1 to 1e9, friction 0.05 to 0.5, three meshes: at most 15 steps; half the coefficient is another solution."""
    for n in (8, 16, 32):
        counts = {}
        for friction in (0.05, 0.5) if n > 8 else (0.05, 0.2, 0.5):
            for ratio in (1.0, 1e3, 1e9) if n < 32 else (1.0, 1e9):
                solution = NEWTON.Solve(Stiff(name, ratio, CoulombFriction(friction), n))
                counts[friction, ratio] = len(solution.history)
                assert solution.history[-1].residual <= 1e-10
        assert max(counts.values()) <= 15, counts
        if n == 8:
            half = NEWTON.Solve(Stiff(name, 1e9, CoulombFriction(0.25)))
            assert Difference(solution, half) > 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("name", EXAMPLES)
def test_nested_iteration_leaves_little_to_the_finest_mesh(name):
    """At most 7 steps and 60 applications there for every stiffness; from rest it takes more work."""
    works = []
    for ratio in (1.0, 1e3, 1e9):
        disc = Stiff(name, ratio, CoulombFriction(0.3), 32)
        solution = NestedNewtonSolver().Solve(disc)
        last = solution.levels[-1]
        assert len(solution.levels) == 3 and last.points == 64 and last.iterations <= 7 and last.solves <= 60
        works.append(last.solves)
        alone = NEWTON.Solve(Stiff(name, ratio, CoulombFriction(0.3), 32))
        assert Difference(solution, alone) < 1e-7
        assert ratio == 1 or alone.disc.solves > 1.5 * last.solves
    assert works[2] <= works[1] + 10


FRICTIONS = [TrescaFriction(20), CoulombFriction(0.3), PowerFriction(400, 1), SlipWeakeningFriction(0.4, 0.3, 0.05), None]


@pytest.mark.slow
@pytest.mark.parametrize("friction", FRICTIONS, ids=lambda law: type(law).__name__)
def test_all_solvers_find_one_solution(friction, method):
    """Soft enough for the explicit iteration; 1e-7 in displacement and projected traction; another stiffness is seen."""
    disc = Stiff("4.2", 0.1, friction, method=method)
    explicit = UzawaSolver().Solve(disc)
    others = [UzawaSolver(normal="implicit", acceleration="anderson"), UzawaSolver(normal="implicit"), NEWTON,
              NestedNewtonSolver(coarser=[example_4_2.Mesh(4)])]
    for solver in others:
        assert Difference(explicit, solver.Solve(disc)) < 1e-7
    assert Difference(explicit, DenseNewton(disc, scale=2500.0)) < 1e-7
    assert Difference(explicit, NEWTON.Solve(Stiff("4.2", 0.101, friction, method=method))) > 1e-4


@pytest.mark.slow
def test_implicit_solvers_agree_on_stiff_foundations(method):
    disc = Stiff("4.1", 1e6, CoulombFriction(0.3), method=method, order=2)
    reference = NEWTON.Solve(disc)
    for solution in (DenseNewton(disc, scale=2000.0), NestedNewtonSolver().Solve(disc),
                     UzawaSolver(normal="implicit", acceleration="anderson").Solve(disc)):
        assert Difference(reference, solution) < 1e-7
    assert Difference(reference, NEWTON.Solve(Stiff("4.1", 1e6, CoulombFriction(0.29), method=method, order=2))) > 1e-4


@pytest.mark.slow
def test_several_foundations_with_data_that_vary_in_space():
    """Three sides with laws of their own; the same solution as with dense matrices, and each law matters."""
    def Laws(stiff=1e6, bound=3.0):
        return [Foundation("bottom", NormalCompliance(1e4 * (1 + x)), friction=CoulombFriction(0.5 * x), gap=0.01 * x),
                Foundation("left", NormalCompliance(stiff, 2), friction=TrescaFriction(bound), gap=1e-3),
                Foundation("right", NormalCompliance(1e3, 0.5), gap=1e-3)]

    solution = NEWTON.Solve(Pressed(Laws()))
    assert Difference(solution, DenseNewton(Pressed(Laws()), scale=2e3)) < 1e-7
    assert Difference(solution, NestedNewtonSolver().Solve(Pressed(Laws()))) < 1e-7
    for other in (Laws(stiff=1e5), Laws(bound=1.5)):
        assert Difference(solution, NEWTON.Solve(Pressed(other))) > 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("cells, order", [("tet", 1), ("prism", 1), ("hex", 2)])
def test_three_dimensions(cells, order):
    law = Foundation("bottom", NormalCompliance(1e6), friction=CoulombFriction(0.3))
    discs = [Pressed(law, mesh=BoxMesh(2, cells=cells), order=order, method=method) for method in (METHODS[0], Conforming())]
    for disc in discs:
        solution = NEWTON.Solve(disc)
        assert Difference(solution, DenseNewton(disc, scale=2e3)) < 1e-7
        assert (not disc.method.discontinuous or np.ptp(solution.zones) > 0) and len(solution.history) <= 15
    half = replace(law, friction=CoulombFriction(0.15))
    other = NEWTON.Solve(Pressed(half, mesh=BoxMesh(2, cells=cells), order=order, method=METHODS[2]))
    assert Difference(solution, other) > 1e-3


@pytest.mark.slow
def test_a_body_that_only_friction_holds_slides_when_it_must():
    """Below the limit of friction there is an equilibrium, beyond it none: an error in bounded time, not a solution."""
    def Dragged(force):
        law = Foundation("bottom", NormalCompliance(1e4), friction=CoulombFriction(0.3))
        problem = ContactProblem(HookeMaterial(E=2000, nu=0.3), law, traction={"top": CF((force, -10))})
        return Discretization(problem, METHODS[0], RectangleMesh(4), order=1)

    solution = NEWTON.Solve(Dragged(2.9))
    assert solution.friction[:, 0] @ solution.weights == pytest.approx(-2.9, rel=1e-8)
    assert np.all(solution.zones[solution.points[:, 0] < 0.1] != 1)
    disc = Dragged(3.1)
    with pytest.raises(NotConvergedError, match="raising the load.*The foundation alone resists.*no equilibrium"):
        NEWTON.Solve(disc)
    assert disc.solves < 20000


def test_an_excursion_leaves_no_trace():
    """Where the iteration has been astray, digits are lost; they are those of that place and not of the next one."""
    disc = Stiff("4.2", 1e3, CoulombFriction(0.3))
    solution = NEWTON.Solve(disc)
    run = NewtonRun(disc, (solution.displacement, solution.traction), NEWTON.tol)
    point, first = run.start, run.body.Evaluate(run.setting.graph.At(0.5 * run.start.q))
    before = first.To(point).F
    astray = first.At(1e12 * point.q)
    lost = np.abs(astray.equilibrium.displacement).max() * np.finfo(float).eps
    again = astray.To(point).F
    assert np.abs(again - before).max() < 1e-12 * np.abs(point.displacement).max() < 1e-6 * lost


def test_tolerance_below_roundoff_is_named():
    with pytest.raises(NotConvergedError, match="tol=1e-17 is below what round-off allows"):
        SemismoothNewtonSolver(tol=1e-17).Solve(Stiff("4.1", 1e3, CoulombFriction(0.3), order=3))


def test_limit_of_steps_is_named_and_the_last_iterate_kept():
    with pytest.raises(NotConvergedError, match="limit of steps.*raise maxiter.*after 2 iterations") as failure:
        SemismoothNewtonSolver(maxiter=2).Solve(Stiff("4.1", 1e3, CoulombFriction(0.3)))
    error = failure.value
    assert [step.number for step in error.history] == [1, 2] and not error.solution.converged
    assert np.abs(error.solution.vector).max() > 0 and "NOT CONVERGED" in error.solution.Report()


@pytest.mark.slow
@pytest.mark.parametrize("solver", [NEWTON, NestedNewtonSolver()])
def test_interrupt_keeps_the_last_iterate_and_callback_sees_every_step(solver):
    """On the last mesh."""
    disc, steps = Stiff("4.1", 1e3, CoulombFriction(0.3), 32), []
    solution = solver.Solve(disc, callback=steps.append)
    assert steps == solution.history and [step.number for step in steps] == list(range(1, len(steps) + 1))

    def Interrupt(step):
        if step.number == len(steps):
            raise KeyboardInterrupt

    with pytest.raises(SolveInterrupted) as stop:
        solver.Solve(disc, callback=Interrupt)
    assert len(stop.value.solution.history) == len(steps)
    assert not stop.value.solution.converged and stop.value.solution.energy > 0


def test_a_start_near_the_solution_saves_steps_and_a_bad_one_does_no_harm():
    disc = Stiff("4.2", 1e3, CoulombFriction(0.3), 16)
    solution = NEWTON.Solve(disc)
    again = NEWTON.Solve(disc, start=(solution.displacement, solution.traction))
    assert len(again.history) <= 2 < len(solution.history)
    far = NEWTON.Solve(disc, start=(-solution.displacement, 3 * solution.traction))
    assert Difference(solution, far) < 1e-7 and len(far.history) > 2


def test_a_coarse_mesh_that_fails_is_listed(monkeypatch):
    """The next one starts from rest, and the report says so."""
    disc, solve, starts = Stiff("4.2", 1.0, CoulombFriction(0.3), 32), SemismoothNewtonSolver.Solve, []

    def Solve(solver, coarse, *, start=None, callback=None):
        solution = solve(solver, coarse, start=start, callback=callback)
        starts.append(start)
        if len(starts) == 2:
            raise NotConvergedError("as if", solution)
        return solution

    assert [level.converged for level in NestedNewtonSolver().Solve(disc).levels] == [True] * 3
    monkeypatch.setattr(SemismoothNewtonSolver, "Solve", Solve)
    solution = NestedNewtonSolver().Solve(disc)
    assert [level.converged for level in solution.levels] == [True, False, True] and solution.converged
    assert solution.levels[1].iterations > 0 and starts[1] is not None and starts[2] is None
    assert solution.Report().count("not converged") == 1


@pytest.mark.parametrize("call, culprit", [
    (lambda disc: NEWTON.Solve(disc.problem), "give Discretization"),
    (lambda disc: NestedNewtonSolver().Solve(disc.problem), "give Discretization"),
    (lambda disc: NEWTON.Solve(disc, start=(disc.contact.normals, disc.contact.weights)), "start has shapes"),
    (lambda disc: NEWTON.Solve(disc, start=(disc.contact.normals[1:], disc.contact.normals[1:])), "start has shapes"),
    (lambda disc: SemismoothNewtonSolver(tol=0), "tol is 0"), (lambda disc: SemismoothNewtonSolver(maxiter=1.5), "maxiter is"),
    (lambda disc: SemismoothNewtonSolver(maxiter=True), "maxiter is True"),
    (lambda disc: NestedNewtonSolver(tol=2), "tol is 2"),
    (lambda disc: NestedNewtonSolver(coarser=disc.mesh), "coarser is.*sequence of ngsolve.Mesh"),
    (lambda disc: NestedNewtonSolver(coarser=[BoxMesh(1)]).Solve(disc), "coarser: the mesh has dimension 3"),
    (lambda disc: NestedNewtonSolver(coarser=[4, 8]), "coarser is.*sequence of ngsolve.Mesh")])
def test_bad_arguments_are_refused_by_name(call, culprit):
    with pytest.raises(ProblemError, match=culprit):
        call(Discretization(Example(), METHODS[0], RectangleMesh(2), order=1))


def test_a_run_that_gives_up_before_its_first_step_is_no_index_error(monkeypatch):
    monkeypatch.setattr(Record, "Stalled", lambda record, patience: True)
    monkeypatch.setattr(NewtonRun, "AlongPath", lambda run, state, tol: None)
    monkeypatch.setattr(NewtonRun, "UnderLoad", lambda run, state, tol: None)
    with pytest.raises(NotConvergedError, match=r"Newton.*before its first iteration") as failure:
        SemismoothNewtonSolver().Solve(Stiff("4.1", 1e3, CoulombFriction(0.3)))
    assert failure.value.history == [] and not failure.value.solution.converged
