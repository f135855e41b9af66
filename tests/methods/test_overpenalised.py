"""The weakly over-penalised method: first order without consistency, balance, and why each of its penalties is there."""

import numpy as np
import pytest
from bodies import Cube, Distorted
from checks import Random
from ngsolve import CF, TET, TRIG, VOL, InnerProduct, IntegrationRule, Integrate, x, y, z
from problems import Example, Held

from ngdgc import (ContactProblem, ContactSolution, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, SemismoothNewtonSolver, TrescaFriction, WeaklyOverPenalised)
from ngdgc.errors import EnergyError, L2Error, Rates
from ngdgc.exact import SmoothSlip
from ngdgc.mesh.facets import Csr
from ngdgc.meshes import RectangleMesh
from ngdgc.methods.overpenalised import OverPenalty
from ngdgc.problem.materials import Strain
from ngdgc.theory.consistency import ConsistencyResidual

EXACT = SmoothSlip()


def Errors(method, *sizes, cells="triangle"):
    """Energy and L2 errors on meshes 1/n."""
    solutions = [SemismoothNewtonSolver().Solve(Discretization(EXACT.problem, method, RectangleMesh(n, cells=cells)))
                 for n in sizes]
    return [EnergyError(one, EXACT.displacement) for one in solutions], [L2Error(one, EXACT.displacement) for one in solutions]


@pytest.mark.slow
@pytest.mark.parametrize("cells", ["triangle", "quad"])
def test_converges_at_the_orders_of_the_space(cells):
    energy, l2 = Errors(WeaklyOverPenalised(), 8, 16, cells=cells)
    assert Rates(energy)[0] == pytest.approx(1, abs=0.15) and Rates(l2)[0] == pytest.approx(2, abs=0.15)
    # No worse than the consistent method by more than a fourth.
    assert energy[-1] < 1.25 * Errors(InteriorPenalty(), 16, cells=cells)[0][0]


@pytest.mark.slow
def test_control_the_usual_penalty_alone_does_not_converge(monkeypatch):
    """Without the excess on the means the missing terms stay an error of order 1/2 in |[u]|: the L2 error hardly falls."""
    full = Errors(WeaklyOverPenalised(), 8, 16)[1]
    monkeypatch.setattr(OverPenalty, "FacetMatrix", lambda rule, patch: rule._plain.FacetMatrix(patch))
    plain = Errors(WeaklyOverPenalised(), 8, 16)[1]
    assert Rates(plain)[0] < 0.5 and plain[-1] > 20 * full[-1]


def test_it_is_not_consistent_and_interior_penalty_is():
    """sup <v+ - v-, sigma n>/|||v||| does not vanish: it is the stronger norm of the method in which it is of order h."""
    own, other = (ConsistencyResidual(Discretization(EXACT.problem, method, RectangleMesh(8)), EXACT.displacement)
                  for method in (WeaklyOverPenalised(), InteriorPenalty()))
    assert own > 0.1 and other < 1e-8


def Square(jump, n, point):
    """[u]:[u] at a point, from the coefficients of the affine u+ - u-."""
    w = np.concatenate([[1], point]) @ jump
    return (w @ w + (w @ n) ** 2) / 2


@pytest.mark.parametrize("cells", ["triangle", "tet"])
def test_energy_against_jumps_at_points(cells):
    """B_h(u, u) of a random u, affine in every element: its mean on a side is its value in the middle."""
    mesh, penalty = RectangleMesh(3) if cells == "triangle" else Cube("tet", 2), 7
    disc, dim = Discretization(Held(mesh.dim), WeaklyOverPenalised(penalty=penalty), mesh), mesh.dim
    function = Random(disc.space)
    at = mesh.MapToAllElements(IntegrationRule(TRIG if dim == 2 else TET, 2), VOL)
    ones = np.ones((mesh.ne, len(at) // mesh.ne, 1))
    places = np.concatenate([ones, np.asarray(CF((x, y, z)[:dim])(at)).reshape(mesh.ne, -1, dim)], axis=2)
    affine = np.linalg.pinv(places) @ np.asarray(function(at)).reshape(mesh.ne, -1, dim)
    energy = Integrate(InnerProduct(Held(mesh.dim).material.Stress(Strain(function)), Strain(function)), mesh)
    plain, sides = 0.0, {tuple(sorted(v.nr for v in one.vertices)) for one in mesh.Boundaries("right").Elements()}
    for facet in mesh.facets:
        elements, vertices = [element.nr for element in facet.elements], [vertex.nr for vertex in facet.vertices]
        if len(elements) == 1 and tuple(sorted(vertices)) not in sides:
            continue
        corners = np.array([mesh.vertices[vertex].point for vertex in vertices])
        edges = corners[1:] - corners[0]
        n = np.array([edges[0][1], -edges[0][0]]) if dim == 2 else np.cross(*edges)
        measure, n = np.linalg.norm(n) / (dim - 1), n / np.linalg.norm(n)
        diameter = max(np.linalg.norm(one - other) for one in corners for other in corners)
        middle, jump = corners.mean(axis=0), affine[elements[0]] - (affine[elements[1]] if len(elements) > 1 else 0)
        # Of degree 2: Simpson's rule, and the middles of the edges of a triangle.
        points, weights = (((corners[0], middle, corners[1]), (1 / 6, 4 / 6, 1 / 6)) if dim == 2 else
                           ([(corners[i] + corners[i - 1]) / 2 for i in range(3)], (1 / 3,) * 3))
        whole = sum(weight * Square(jump, n, point) for point, weight in zip(points, weights))
        energy += penalty * measure / diameter * (whole + Square(jump, n, middle) / diameter ** 2)
        plain += penalty * measure / diameter * whole
    vector = function.vec.FV().NumPy()
    assert vector @ (Csr(disc.matrix) @ vector) == pytest.approx(energy, rel=1e-10)
    assert plain > 0.01 * energy        # control: both penalties count


def test_any_penalty_is_coercive_and_means_alone_are_not(monkeypatch):
    """Rotations of elements about the middles of edges: fewer conditions than motions where few edges are held."""
    mesh = RectangleMesh(4)

    def Smallest(penalty):
        disc = Discretization(Held(mesh.dim), WeaklyOverPenalised(penalty=penalty), mesh)
        values = np.linalg.eigvalsh(Csr(disc.matrix).toarray())
        return values[0] / values[-1]

    assert Smallest(1e-3) > 1e-7 and Smallest(10) > 1e-7
    full = OverPenalty.FacetMatrix
    monkeypatch.setattr(OverPenalty, "FacetMatrix", lambda rule, patch: full(rule, patch) - rule._plain.FacetMatrix(patch))
    assert abs(Smallest(10)) < 1e-14


@pytest.mark.slow
def test_condition_number_grows_like_h_to_the_minus_4():
    def Condition(method, n):
        values = np.linalg.eigvalsh(Csr(Discretization(Held(), method, RectangleMesh(n)).matrix).toarray())
        return values[-1] / values[0]

    # It tends to 16 from below, and of interior penalty to 4.
    assert Condition(WeaklyOverPenalised(), 12) > 11 * Condition(WeaklyOverPenalised(), 6)
    assert Condition(InteriorPenalty(), 12) < 5 * Condition(InteriorPenalty(), 6)


@pytest.mark.parametrize("cells", ["triangle", "mixed"])
def test_flux_balances_every_element_and_forces_are_right(cells, monkeypatch):
    """With weak supports, rollers and prescribed values; the flux is the penalty, and nine tenths of it balance nothing."""
    mesh = Distorted(cells)
    foundation = Foundation("bottom", NormalCompliance(10), friction=TrescaFriction(0.2))
    problem = ContactProblem(HookeMaterial(E=200, nu=0.3), foundation, bodyforce=(1, -2), roller={"top": -0.01},
                             dirichlet={"right": CF((0.01 * y, 0.02))}, traction={"left": CF((10, -5))})
    solution = SemismoothNewtonSolver().Solve(Discretization(problem, WeaklyOverPenalised(), mesh))
    # Round-off grows with the condition number, here 1e4.
    assert np.abs(solution.ElementImbalance()).max() < 1e-10 and solution.GlobalImbalance() < 1e-10
    forces = solution.Force("bottom") + solution.Force("right") + solution.Force("top") + solution.Force("left")
    area = 1.0
    assert forces == pytest.approx([-area, 2 * area], abs=1e-9)
    plain = OverPenalty.FacetMatrix
    del solution.testedfluxes
    monkeypatch.setattr(OverPenalty, "FacetMatrix", lambda rule, patch: 0.9 * plain(rule, patch))
    assert np.abs(solution.ElementImbalance()).max() > 1e-3


@pytest.mark.slow
def test_flux_converges_to_the_stress():
    """The force on the support, against that of order 3."""
    region = next(iter(EXACT.problem.dirichlet))

    def Force(n, method, order):
        disc = Discretization(EXACT.problem, method, RectangleMesh(n), order=order)
        return SemismoothNewtonSolver().Solve(disc).Force(region)

    exact = Force(8, InteriorPenalty(), 3)
    differences = [np.linalg.norm(Force(n, WeaklyOverPenalised(), 1) - exact) for n in (8, 16)]
    assert Rates(differences)[0] > 0.8 and differences[-1] < 0.05 * np.linalg.norm(exact)


def test_it_is_saved_and_solved_by_a_factorisation(tmp_path):
    disc = Discretization(Example(), WeaklyOverPenalised(), RectangleMesh(4))
    assert disc.symmetric and disc.inversekind == Discretization(Example(), InteriorPenalty(), RectangleMesh(4)).inversekind
    assert [repr(WeaklyOverPenalised(**given)) for given in ({}, {"penalty": 3})] == ["WeaklyOverPenalised()",
                                                                                    "WeaklyOverPenalised(penalty=3)"]
    solution = SemismoothNewtonSolver().Solve(disc)
    solution.Save(tmp_path / "saved")
    assert ContactSolution.Load(tmp_path / "saved", Example()).disc.method == disc.method
