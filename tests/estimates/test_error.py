"""The estimate of the energy error, against exact solutions and fine ones."""

from dataclasses import replace

import numpy as np
import pytest
from ngsolve import CF, InnerProduct, Integrate, Parameter, sin, x, y
from problems import TEN, Example, Loaded, Solved

from ngdgc import (LDG, BassiEtAl, ContactProblem, CoulombFriction, Discretization, EstimateError, Foundation, HookeMaterial,
                   InteriorPenalty, NonsymmetricInteriorPenalty, NormalCompliance, ProblemError, Solve, SolveHistory)
from ngdgc.errors import EnergyError
from ngdgc.estimates import error, estimate, lawpart, potential
from ngdgc.estimates.residual import ResidualEstimate
from ngdgc.exact import AffinePatch, SmoothSlip
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.traces import ThreeZones


def Effectivity(exact, method, mesh, order):
    solution = Solve(Discretization(exact.problem, method, mesh, order=order))
    return EstimateError(solution).value / EnergyError(solution, exact.displacement)


def UnitMesh(cells, n):
    return (RectangleMesh if cells in ("triangle", "quad") else BoxMesh)(n, cells=cells)


@pytest.mark.parametrize("zone", ["slip", "stick", "open"])
@pytest.mark.parametrize("cells", ["triangle", "quad", *(pytest.param(cells, marks=pytest.mark.slow)
                                                         for cells in ("tet", "hex", "prism"))])
def test_exact_solution_has_no_error(cells, zone):
    exact = AffinePatch(zone, dim=2 if cells in ("triangle", "quad") else 3, sides="roller")
    solution = Solved(exact.problem, LDG(), UnitMesh(cells, 2), 1)
    found = EstimateError(solution)
    # The iteration stops at a law residual of 1e-11, of which the law's part is a root.
    assert found.value < 1e-6 and found.indicators.sum() == pytest.approx(found.value ** 2)
    wrong = replace(exact.problem, bodyforce=(0,) * (solution.disc.mesh.dim - 1) + (-1,))
    assert EstimateError(Solved(wrong, LDG(), UnitMesh(cells, 2), 1)).value > 1e-3      # control: with a load it has one


@pytest.mark.parametrize("order", [1, 2, pytest.param(3, marks=pytest.mark.slow)])
@pytest.mark.parametrize("cells", ["triangle", "quad"])
@pytest.mark.parametrize("method", [*TEN, NonsymmetricInteriorPenalty()], ids=repr)
def test_value_is_near_the_error_for_every_method(method, cells, order):
    # For linear problems and symmetric stresses value is a bound; elements far from the limit and skew parts take some of that.
    assert 1 < Effectivity(SmoothSlip(), method, UnitMesh(cells, 4), order) < 2.4


@pytest.mark.slow
@pytest.mark.parametrize("cells, order, most", [("tet", 1, 2.3), ("tet", 2, 2.3), ("hex", 1, 2.3), ("hex", 2, 2.5),
                                                 ("prism", 2, 2.5)])
def test_value_is_near_the_error_in_three_dimensions(cells, order, most):
    assert 0.9 < Effectivity(SmoothSlip(dim=3), LDG(), UnitMesh(cells, 3), order) < most


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [2.5, 2.5e3, 2.5e6, 2.5e9])
def test_value_does_not_depend_on_the_stiffness(stiffness):
    exact = SmoothSlip(stiffness=stiffness)
    assert 1 < Effectivity(exact, InteriorPenalty(), RectangleMesh(6), 2) < 1.6


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("nu", [0.45, 0.499, 0.4999])
def test_value_does_not_lose_touch_with_nearly_incompressible_bodies(nu, order, monkeypatch):
    exact = SmoothSlip(mu=2, lam=4 * nu / (1 - 2 * nu))
    solution = Solve(Discretization(exact.problem, InteriorPenalty(), RectangleMesh(6), order=order))
    true = EnergyError(solution, exact.displacement)
    assert 1 < EstimateError(solution).value / true < 1.5
    if nu > 0.49:
        monkeypatch.setattr(error, "Relaxed", lambda stress, sweeps: stress)
        monkeypatch.setattr(potential, "Sweeps", lambda material, mesh: 0)
        assert EstimateError(solution).value > 4 * true        # control: the average alone


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("method", [LDG(), BassiEtAl(form="lifting")], ids=repr)
def test_value_where_zones_meet_within_facets(method, order):
    assert 1 < Effectivity(ThreeZones(), method, RectangleMesh(7), order) < 2.4


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [1e-3, 1e-1, 10, 1e6])
def test_value_on_a_wavy_foundation_against_a_fine_mesh(stiffness):
    """The edge of contact lies within facets; on soft foundations their energy is much more than that of the body."""
    foundation = Foundation("bottom", NormalCompliance(stiffness), friction=CoulombFriction(0.3),
                            gap=0.01 * (1 - 4 * x * (1 - x)))
    problem = ContactProblem(HookeMaterial(E=1, nu=0.2), foundation, dirichlet={"top": CF((0.003, -0.008))})
    solution = Solve(Discretization(problem, LDG(), RectangleMesh(5), order=2))
    fine = Solve(Discretization(problem, LDG(), RectangleMesh(10), order=3))
    true = EnergyError(fine, solution.gfu)
    assert 0.9 < EstimateError(solution).value / true < 3
    if stiffness in (1e-3, 1e6):
        # Control: without envelopes, and with that traction alone, the law's part is far too large.
        raw = lawpart.LawPart(solution, potential.Potential(solution), error.EquilibratedStress(solution))
        assert np.sqrt(sum(2 * gaps.weights @ gaps.gap for gaps in raw)) > 3 * true


def test_parts_find_what_causes_them():
    """A load that the mesh does not resolve is in "data", the corner singularity in "stress" where it is."""
    mesh = RectangleMesh(6)
    solution = Solved(Example(), InteriorPenalty(), mesh, 2)
    assert EstimateError(solution).parts["data"] < 1e-9 * np.sqrt(solution.energy)
    for rough in (Example(bodyforce=CF((0, 1000 * x ** 9))), Example(traction={"left": CF((200 * sin(20 * y), 0))})):
        solution = Solved(rough, InteriorPenalty(), mesh, 2)
        assert EstimateError(solution).parts["data"] > 1e-5 * np.sqrt(solution.energy)


@pytest.mark.parametrize("cells", ["triangle", "quad"])
def test_parts_are_their_integrals(cells):
    """Hooke: C^-1 s:s = s:s/(2 mu) - lam/(2 mu + d lam) tr(s)^2/(2 mu); of shears on quadrilaterals the larger counts twice."""
    mesh, mu, lam = RectangleMesh(3, cells=cells), 200 / 2.6, 60 / 0.52       # of E = 200, nu = 0.3
    solution = Solved(Loaded(mesh), LDG(), mesh, 2)
    found, stress, normal, shears = EstimateError(solution), error.EquilibratedStress(solution), 0.0, np.zeros(2)
    for batch in stress.Batches():
        s = batch.equilibrated - batch.computed
        trace = np.einsum("nqii->nq", s)
        normal += batch.Integral(s[..., 0, 0] ** 2 + s[..., 1, 1] ** 2 - lam / (2 * mu + 2 * lam) * trace ** 2).sum()
        one, other = batch.Integral(s[..., 0, 1] ** 2), batch.Integral(s[..., 1, 0] ** 2)
        shears += (one + other).sum(), 2 * np.maximum(one, other).sum()
    assert shears[1] > 1.01 * shears[0]         # else the choice would make no difference
    parts = {name: part ** 2 for name, part in found.parts.items()}
    wanted = normal + shears[int(cells == "quad")]
    assert parts["stress"] + parts["skew"] == pytest.approx(wanted / (2 * mu), rel=1e-10) and parts["skew"] > 0
    law = lawpart.LawPart(solution, potential.Potential(solution), stress)
    assert parts["law"] == pytest.approx(2 * sum(gaps.weights @ gaps.envelope for gaps in law), rel=1e-12)
    assert parts["feasibility"] == pytest.approx(sum(gaps.weights @ gaps.infeasible for gaps in law), rel=1e-12)
    energy = Integrate(InnerProduct(solution.stress, solution.strain), mesh, order=4)
    assert found.relative == pytest.approx(found.value / np.sqrt(energy), rel=1e-10)


def test_text_says_value_and_parts_and_asks_for_no_bound(monkeypatch):
    found = EstimateError(Solved(Example(), InteriorPenalty(), RectangleMesh(2), 1))
    monkeypatch.setattr(type(found), "bound", property(lambda self: pytest.fail("a bound may take as long as the solution")))
    assert all(word in str(found) for word in ("energy error", "of the solution", "stress", "law"))


@pytest.mark.parametrize("unit", [1, 1e9])
@pytest.mark.parametrize("Estimate", [EstimateError, ResidualEstimate])
def test_a_rigid_motion_has_no_error(Estimate, unit, monkeypatch):
    """Nothing is touched: strain and estimate are round-off, some 1e-14 of |u|/h, and their quotient says nothing."""
    foundation = Foundation("bottom", NormalCompliance(unit), gap=1)
    problem = ContactProblem(HookeMaterial(E=unit, nu=0.3), foundation, dirichlet={"top": CF((0.1, 0.1))})
    solution = Solved(problem, LDG(), RectangleMesh(4), 2)
    assert Estimate(solution).relative < 1e-3
    monkeypatch.setattr(estimate, "ROUNDOFF", 0)
    assert Estimate(solution).relative > 0.01       # control


def test_the_first_state_of_a_history_has_an_estimate():
    """Its slip counts from rest; that of later ones does not, and they have none."""
    t = Parameter(0)
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), Foundation("bottom", NormalCompliance(1e4)),
                             dirichlet={"top": CF((0.01 * t, -0.02))})
    states = SolveHistory(Discretization(problem, LDG(), RectangleMesh(3)), parameter=t, times=(1, 2))
    t.Set(1)
    alone = Solve(Discretization(problem, LDG(), RectangleMesh(3)))
    assert EstimateError(states[0]).value == pytest.approx(EstimateError(alone).value, rel=1e-8)
    with pytest.raises(ProblemError, match="state of a history"):
        EstimateError(states[1])
