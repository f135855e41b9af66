"""Adaptive runs: what they reach and with how much less, on which meshes, and how they end otherwise."""

import numpy as np
import pytest
from bodies import Mixed, Perforated
from ngsolve import CF, VOL, ElementId, Integrate, Mesh, ds, x

from ngdgc import (LDG, Conforming, ContactProblem, CoulombFriction, Discretization, EstimateError, EstimateForce, Foundation,
                   HookeMaterial, InteriorPenalty, NormalCompliance, NotConvergedError, ProblemError, SemismoothNewtonSolver,
                   Solve, SolveAdaptive, SolveInterrupted)
from ngdgc.cases import example_4_2
from ngdgc.discrete.state import MeshState
from ngdgc.errors import EnergyError
from ngdgc.estimates import adaptive
from ngdgc.estimates.marking import Fewest
from ngdgc.estimates.refine import Refined
from ngdgc.exact import AffinePatch, SmoothSlip
from ngdgc.meshes import BoxMesh, RectangleMesh

SQUARE = example_4_2.Problem()
BLOCK = ContactProblem(HookeMaterial(E=2000, nu=0.3), dirichlet={"top": CF((0.004, -0.006))}, foundation=Foundation(
    "bottom", NormalCompliance(50000), friction=CoulombFriction(0.4), gap=0.004 * (x - 0.6) ** 2))


class Watch:
    """A callback that counts the steps, and calls functions with every Step and every Level."""

    def __init__(self, Do=lambda level: None, Step=lambda step: None):
        self.steps, self.Do, self.Step = 0, Do, Step

    def __call__(self, step):
        self.steps += 1
        self.Step(step)

    def Reached(self, level):
        self.Do(level)


def Order(unknowns, errors):
    """p of errors that fall as unknowns^(-p/2), over the last four meshes."""
    return -2 * np.polyfit(np.log(unknowns[-4:]), np.log(errors[-4:]), 1)[0]


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2, 3])
def test_corner_singularities_do_not_spoil_the_order(order):
    """Clamped and loaded sides meet at right angles: uniform meshes have the order of the singularity, below 0.9 for any k.

    Adaptive ones that of the polynomials, k, but for the tenth that four meshes say too little.
    """
    tol = {1: 0.06, 2: 0.006, 3: 0.002}[order]
    levels = SolveAdaptive(SQUARE, InteriorPenalty(), example_4_2.Mesh(4), order=order, tol=tol).levels
    assert Order([level.dofs for level in levels], [level.error for level in levels]) > 0.9 * order
    uniform = [EstimateError(Solve(Discretization(SQUARE, InteriorPenalty(), example_4_2.Mesh(n), order=order)))
               for n in (2, 4, 8, 16)]
    rate = Order([4.0 ** n for n in range(4)], [estimate.relative for estimate in uniform])
    assert rate < 0.9 and rate < 0.85 * order
    # As accurate as the finest uniform one, of 512 elements, with few of its unknowns.
    reached = next(level.elements for level in levels if level.error <= uniform[-1].relative)
    assert reached < {1: 400, 2: 150, 3: 100}[order]


def test_what_comes_back_is_the_solution_on_the_last_mesh():
    """To the full tolerance, with its estimate; the meshes on the way are solved to what they carry, and the user's stays."""
    mesh = RectangleMesh(4, upper=(2, 1))
    before, watch = MeshState(mesh), Watch()
    solution = SolveAdaptive(BLOCK, LDG(), mesh, order=2, tol=0.03, callback=watch)
    assert before.Changed(mesh) is None and solution.earlier[0].disc.mesh is mesh
    assert solution.estimate.relative == EstimateError(solution).relative == solution.levels[-1].error <= 0.03
    assert solution.converged and solution.history[-1].residual <= 1e-10
    # As often as it was solved on the last mesh, loosely and then to the end, its steps are counted through.
    assert [step.number for step in solution.history] == [*range(1, solution.levels[-1].iterations + 1)]
    again = SemismoothNewtonSolver().Solve(Discretization(BLOCK, LDG(), solution.disc.mesh, order=2))
    size = np.abs(again.vector).max()
    # Equations of condition 1e6 and a law residual of 1e-10.
    assert np.abs(solution.vector - again.vector).max() < 1e-8 * size
    assert [one.disc.space.ndof for one in [*solution.earlier, solution]] == [level.dofs for level in solution.levels]
    assert all(level.error > 0.03 for level in solution.levels[:-1])
    residuals = [one.history[-1].residual for one in solution.earlier[1:]]
    assert max(residuals) < 1e-4 and max(residuals) > 1e-10
    # Those are solutions on their own, which have their matrices computed anew.
    assert solution.earlier[1].EquilibriumResidual() < 1e-8
    assert watch.steps == sum(level.iterations for level in solution.levels)


@pytest.mark.slow
def test_each_mesh_starts_from_the_one_before():
    """Two Newton steps and ten applications a mesh at most, on average; from rest it takes twice as many."""
    solution = SolveAdaptive(BLOCK, InteriorPenalty(), RectangleMesh(4, upper=(2, 1)), order=2, tol=0.02)
    later = solution.levels[1:]
    applications = sum(level.solves for level in later)
    assert sum(level.iterations for level in later) <= 2 * len(later) and applications <= 10 * len(later)
    rest = 0
    for one in [*solution.earlier[1:], solution]:
        disc = Discretization(BLOCK, InteriorPenalty(), one.disc.mesh, order=2)
        SemismoothNewtonSolver(tol=max(one.history[-1].residual, 1e-10)).Solve(disc)
        rest += disc.solves
    assert rest > 2 * applications


def test_the_methods_without_equilibrated_stress_take_the_residual():
    solution = SolveAdaptive(SQUARE, Conforming(), example_4_2.Mesh(4), order=2, tol=0.1)
    assert solution.estimate.relative <= 0.1 and solution.estimate.parts.keys() >= {"equilibrium", "tractions"}


@pytest.mark.slow
def test_a_force_is_made_accurate_by_its_own_mesh():
    """To 1e-4 with 1500 unknowns; it is held against one that is corrected by its estimate, ten times more accurate.

    An energy error of ten percent, which takes as many, leaves a larger one, and so does a uniform mesh.
    """
    mesh, method, goal = example_4_2.Mesh(4), InteriorPenalty(), "force"
    fine = SolveAdaptive(SQUARE, method, mesh, order=3, tol=1e-5, goal=goal).estimate.corrected["bottom"][1]
    solution = SolveAdaptive(SQUARE, method, mesh, order=2, tol=1e-4, goal=goal)
    assert solution.levels[-1].dofs < 1500 and solution.estimate.relative <= 1e-4
    assert abs(solution.estimate.value["bottom"][1] / fine - 1) < 2e-4
    uniform = Solve(Discretization(SQUARE, method, example_4_2.Mesh(8), order=2))
    assert uniform.disc.space.ndof > 1500 and abs(uniform.normalforce / fine - 1) > 4e-4


@pytest.mark.slow
@pytest.mark.parametrize("goal", [("pressure", "bottom"), ("displacement", (0.0, 0.0))])
def test_other_goals(goal):
    """Each is estimated on the last mesh as the run says."""
    solution = SolveAdaptive(SQUARE, InteriorPenalty(), example_4_2.Mesh(4), order=2, tol=3e-3, goal=goal)
    assert solution.levels[-1].error == EstimateForce(solution, goal).relative <= 3e-3
    name = f"{goal[0]} {goal[1]}"
    assert list(solution.ToJSON()["estimated_quantities"]) == [name] and f"Estimated error of the {name}: " in solution.Report()
    with pytest.raises(ProblemError, match="choose 'energy'"):
        SolveAdaptive(SQUARE, InteriorPenalty(), example_4_2.Mesh(4), tol=0.1, goal=("energy", "bottom"))


@pytest.mark.slow
def test_in_space():
    exact = SmoothSlip(dim=3)
    solution = SolveAdaptive(exact.problem, InteriorPenalty(), BoxMesh(1), order=2, tol=0.1)
    assert len(solution.levels) > 1
    assert EnergyError(solution, exact.displacement) <= solution.estimate.value


def test_marks_are_the_fewest_that_bear_their_share():
    indicators = np.array([3.0, 0, 1, 5, 1])
    assert Fewest(indicators, 0.5).tolist() == [False, False, False, True, False]
    assert Fewest(indicators, 0.51).tolist() == [True, False, False, True, False]
    assert Fewest(indicators, 1.0)[indicators > 0].all()


BODIES = {"triangles": lambda: RectangleMesh(3), "quadrilaterals": lambda: RectangleMesh(3, cells="quad"), "mixed": Mixed,
          "curved": Perforated, "tetrahedra": lambda: BoxMesh(1)}


@pytest.mark.parametrize("name", BODIES)
def test_refined_meshes_are_those_of_the_same_body(name):
    """Names, measures to round-off, every side with one or two neighbours, curves, which NGSolve's own refinement loses."""
    mesh = BODIES[name]()
    marked = np.zeros(mesh.ne, dtype=bool)
    marked[[0, 2]] = True
    fine = Refined(mesh, marked)
    assert mesh.ne + 2 <= fine.ne < 8 * mesh.ne
    assert fine.GetBoundaries() == mesh.GetBoundaries() and fine.GetMaterials() == mesh.GetMaterials()
    assert fine.GetCurveOrder() == mesh.GetCurveOrder()
    areas = [{region: Integrate(CF(1) * ds(definedon=one.Boundaries(f"^{region}$")), one) for region in one.GetBoundaries()}
             for one in (mesh, fine)]
    # The hole is a circle in neither, but nearer to one in the finer.
    assert areas[1] == pytest.approx(areas[0], rel=1e-6 if name == "curved" else 1e-12)
    disc = Discretization(AffinePatch("slip", dim=mesh.dim).problem if name != "curved" else SQUARE, InteriorPenalty(), fine)
    assert set(disc.facets.neighbours) == {1, 2}
    sizes = np.array(Integrate(CF(1), mesh, element_wise=True))[marked]
    assert np.array(Integrate(CF(1), fine, element_wise=True)).min() < 0.6 * sizes.min()
    lost = Mesh(mesh.ngmesh.Copy())
    lost.Refine()
    assert (abs(Integrate(1, lost) - Integrate(1, mesh)) > 1e-4) == (name == "curved")


def test_locally_refined_meshes_have_coarser_ones():
    """Nested iteration on a mesh from an adaptive run: coarse meshes predict, and it converges to the same solution."""
    solution = SolveAdaptive(BLOCK, InteriorPenalty(), RectangleMesh(8, upper=(2, 1)), order=2, tol=0.04)
    nested = Solve(Discretization(BLOCK, InteriorPenalty(), solution.disc.mesh, order=2))
    assert len(nested.levels) > 1 and nested.levels[0].points < nested.levels[-1].points
    assert np.abs(nested.vector - solution.vector).max() < 1e-8 * np.abs(nested.vector).max()


def test_too_few_unknowns_and_roundoff_keep_the_last_mesh():
    with pytest.raises(NotConvergedError, match="more than most=500; give") as stop:
        SolveAdaptive(SQUARE, InteriorPenalty(), example_4_2.Mesh(4), tol=0.01, most=500)
    kept = stop.value.solution
    assert 192 < kept.disc.space.ndof <= 500 and kept.estimate.relative > 0.01 and kept.EquilibriumResidual() < 1e-8
    with pytest.raises(NotConvergedError, match="round-off") as stop:
        SolveAdaptive(AffinePatch("slip").problem, InteriorPenalty(), RectangleMesh(1), tol=1e-15)
    assert len(stop.value.solution.levels) == adaptive.WINDOW + 1


def test_an_interrupted_run_keeps_its_last_mesh():
    """In the middle of the second mesh the first, after it the second."""
    def Stop(level):
        if level.dofs > 192:
            raise KeyboardInterrupt

    watch = Watch(Stop)
    with pytest.raises(SolveInterrupted) as stop:
        SolveAdaptive(SQUARE, InteriorPenalty(), example_4_2.Mesh(4), tol=0.01, callback=watch)
    after = stop.value.solution
    assert len(after.levels) == 2 and after.converged and after.estimate.relative == after.levels[-1].error

    def Middle(step):
        if middle.steps == watch.steps:
            raise KeyboardInterrupt

    middle = Watch(Step=Middle)
    with pytest.raises(SolveInterrupted) as stop:
        SolveAdaptive(SQUARE, InteriorPenalty(), example_4_2.Mesh(4), tol=0.01, callback=middle)
    assert stop.value.solution.disc.space.ndof == 192 and stop.value.solution.converged


def test_elements_keep_their_shape_however_often_they_are_bisected():
    """Of triangles with right angles all are such; of ten refinements at a corner every mesh."""
    mesh = RectangleMesh(2)
    for _ in range(10):
        marked = np.zeros(mesh.ne, dtype=bool)
        marked[[element.nr for element in mesh.Elements(VOL) if any(max(mesh[v].point) == 0 for v in element.vertices)]] = True
        mesh = Refined(mesh, marked)
    corners = np.array([[mesh[v].point for v in mesh[ElementId(VOL, n)].vertices] for n in range(mesh.ne)])
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    areas = np.array(Integrate(CF(1), mesh, element_wise=True))
    assert areas.min() < 1e-6 * areas.max() and (areas / sides.max(axis=1) ** 2).min() == pytest.approx(0.25, rel=1e-9)
