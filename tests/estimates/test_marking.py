"""What an adaptive run decides from mesh to mesh: which elements, and how accurately the law is solved."""

from types import SimpleNamespace

import numpy as np
import pytest
from bodies import Mixed
from netgen.geom2d import SplineGeometry
from ngsolve import CF, Integrate, Mesh

from ngdgc import LDG, Discretization, EstimateError, InteriorPenalty, SemismoothNewtonSolver, SolveAdaptive
from ngdgc.cases import example_4_2
from ngdgc.discrete.response import ContactResponse
from ngdgc.estimates import adaptive, measures
from ngdgc.estimates.marking import Marked
from ngdgc.estimates.refine import Refined
from ngdgc.meshes import BoxMesh
from ngdgc.solvers.newton import paused
from ngdgc.studies import savings


@pytest.mark.parametrize("excess, count", [(1.0, 61), (0.35, 61), (0.2, 41), (0.05, 21), (0.0, 21)])
def test_twice_the_excess_is_marked_between_a_fifth_and_three_fifths(excess, count):
    """Of a hundred and a bit equal elements, whose share no whole number of them meets."""
    assert Marked(np.ones(101), excess).sum() == count


def test_accuracy_of_the_law_follows_the_expected_error():
    """A hundredth of it, or of tol, 1e-4 at most; the first time half is expected."""
    run = adaptive._Run(tol=1e-3, law=1e-10, Measure=None, most=1, callback=None, words="")
    def Tolerance(*errors):
        return run._LawTolerance([SimpleNamespace(error=error) for error in errors])
    assert Tolerance(0.5) == 1e-4                       # not 2.5e-3
    assert Tolerance(0.01) == pytest.approx(5e-5)
    assert Tolerance(0.02, 0.01) == pytest.approx(5e-5) and Tolerance(0.0125, 0.01) == pytest.approx(8e-5)
    assert Tolerance(0.004, 0.0026) == pytest.approx(1.69e-5) and Tolerance(0.004, 0.001) == pytest.approx(1e-5)


def test_only_the_last_mesh_is_solved_to_the_end(monkeypatch):
    tols = []

    class Told(SemismoothNewtonSolver):
        def __init__(self, *, tol):
            tols.append(tol)
            super().__init__(tol=tol)
    monkeypatch.setattr(adaptive, "SemismoothNewtonSolver", Told)
    solution = SolveAdaptive(example_4_2.Problem(), InteriorPenalty(), example_4_2.Mesh(4), order=2, tol=0.05)
    assert len(tols) == len(solution.levels) > 2 and min(tols[:-1]) >= 1e-2 * 0.05 * 0.2 and tols[-1] == 1e-10
    assert solution.history[-1].residual <= 1e-10


def test_what_a_run_keeps_and_what_it_hands_on(monkeypatch):
    """The choices of the user on every mesh, no matrix or factors of the meshes before; powers of the error where it counts."""
    marked, sums = [], []
    monkeypatch.setattr(adaptive, "Marked", lambda indicators, excess: marked.append(excess) or Marked(indicators, excess))
    monkeypatch.setattr(adaptive, "_CheckProgress", lambda values, disc: sums.append(values))
    disc = Discretization(example_4_2.Problem(), LDG(), example_4_2.Mesh(4), order=2, assembly="skeleton", inverse="umfpack")
    solution = adaptive.Adapt(disc, tol=0.1, goal="energy", most=10 ** 5, callback=None)
    assert (solution.disc.assembly, solution.disc.wanted, solution.disc.order) == ("skeleton", "umfpack", 2)
    assert solution.earlier and not any({"matrix", "inverse"} & one.disc.elastic.keys() for one in solution.earlier)
    assert {"matrix"} <= solution.disc.elastic.keys()   # control
    errors = [level.error for level in solution.levels[:-1]]
    assert marked == pytest.approx([1 - (0.1 / error) ** 2 for error in errors])
    assert sums[-1] == pytest.approx([one.estimate.value for one in solution.earlier])


def test_indicators_sum_up_to_a_power_of_the_error():
    solution = example_4_2.Main(method=LDG(), order=2, n=4)
    energy, force = measures.Energy(solution), measures.Quantity("force", solution)
    assert energy.power == 2 and np.sqrt(energy.indicators.sum()) == pytest.approx(EstimateError(solution).value)
    assert force.power == 1 and force.error <= force.indicators.sum() < 10 * force.error


def test_tetrahedra_are_bisected_once():
    """And with the neighbours not many more; until all edges are halved the mesh would be three times as large."""
    mesh = BoxMesh(2)
    marked = np.zeros(mesh.ne, dtype=bool)
    marked[[0, 5]] = True
    assert mesh.ne + 2 <= Refined(mesh, marked).ne < 1.5 * mesh.ne


def test_a_mesh_outlives_its_geometry():
    """Netgen asks a SplineGeometry for new points, which nothing but the name is left of; straight elements need none."""
    def Lonely():
        geometry = SplineGeometry()
        geometry.AddRectangle((0, 0), (1, 1), bcs=["bottom", "right", "top", "left"])
        return Mesh(geometry.GenerateMesh(maxh=0.5))

    for mesh in (Lonely(), Mixed()):
        fine = Refined(mesh, np.ones(mesh.ne, dtype=bool))
        assert fine.ne > 2 * mesh.ne and Integrate(CF(1), fine) == pytest.approx(Integrate(CF(1), mesh), rel=1e-12)


def test_the_last_mesh_goes_on_where_it_has_stopped(monkeypatch):
    """Where the inverse is an iteration: with its matrix, from its residual, and no digit of balance before that is needed."""
    def Found():
        made.clear()
        most.clear()
        disc = Discretization(savings.Box(), InteriorPenalty(), BoxMesh(2), order=1, inverse="iterative")
        return adaptive.Adapt(disc, tol=0.28, goal="energy", most=10 ** 4, callback=None)

    def Spied(self, *arguments, **goal):
        most.append(goal.get("most"))
        return Approach(self, *arguments, **goal)

    made, most, Factorise, Approach = [], [], ContactResponse._Factorise, ContactResponse.Approach
    monkeypatch.setattr(ContactResponse, "Approach", Spied)
    monkeypatch.setattr(ContactResponse, "_Factorise", lambda self: made.append(self.disc.matrix.height) or Factorise(self))
    solution = Found()
    last = solution.levels[-1]
    assert made.count(last.dofs) == 1 and solution.history[-1].residual <= 1e-10 and solution.EquilibriumResidual() < 1e-8
    residuals = np.array([step.residual for step in solution.history])
    stopped = np.flatnonzero(residuals <= 1e-4)[0]
    assert 0 < stopped < len(residuals) - 1 and residuals[stopped + 1:].max() < 1e-4
    # Balance is asked for when the law holds: once a mesh, a thousandth of what the law is solved to, and at the very end.
    asked = [goal for goal in most if goal is not None]
    assert len(asked) == len(solution.levels) + 1 and asked[-1] == 1e-10 and min(asked[1:-1]) >= 1e-8
    loose = [one.EquilibriumResidual() for one in solution.earlier[1:]]
    assert loose and 1e-10 < max(loose) < 1e-6
    monkeypatch.setattr(paused, "CARRIED", 0.0)     # controls: conjugate gradients to the end, and runs that begin again
    monkeypatch.setattr(paused.PausedNewton, "GoOn", lambda self, solver, found, callback: solver.Solve(
        found.disc, start=(found.displacement, found.traction), callback=callback))
    again = Found()
    cycles = [sum(level.cycles for level in one.levels) for one in (again, solution)]
    assert made.count(last.dofs) == 2 and cycles[0] > 1.2 * cycles[1]
    assert np.abs(again.vector - solution.vector).max() < 1e-7 * np.abs(again.vector).max()
