"""Data as users give them: on the fine mesh only, in any unit, with forms of their own; and problems without a solution."""

import numpy as np
import pytest
from checks import Residual
from mistakes.data import TwoMaterials
from netgen.geom2d import SplineGeometry
from ngsolve import CF, H1, L2, BilinearForm, GridFunction, IfPos, LinearForm, Mesh, dx, sqrt, x

from ngdgc import (LDG, AnisotropicMaterial, Conforming, ContactProblem, CoulombFriction, Discretization, Foundation,
                   HookeMaterial, InteriorPenalty, NestedNewtonSolver, NormalCompliance, NotConvergedError, ProblemError, Solve,
                   TrescaFriction)
from ngdgc.meshes import RectangleMesh

PRESSED = {"dirichlet": {"top": CF((1e-3, -0.05))}}
LOADED = {"traction": {"top": CF((1, -10))}}


def Law(**changes):
    return Foundation("bottom", **{"compliance": NormalCompliance(1e6), "friction": CoulombFriction(0.4), **changes})


def Disc(foundation=None, *, mesh=None, method=None, material=None, **data):
    problem = ContactProblem(material or HookeMaterial(E=2000, nu=0.3), foundation or Law(), **(data or PRESSED))
    return Discretization(problem, method or InteriorPenalty(), mesh or RectangleMesh(16), order=1)


def test_data_on_the_fine_mesh_predict_or_are_left_out():
    """GridFunctions as gap and modulus: the same solution as formulas, another one with another gap."""
    mesh = RectangleMesh(16)
    gap, modulus = GridFunction(H1(mesh, order=1)), GridFunction(L2(mesh, order=0))
    gap.Set(0.01 * x)
    modulus.Set(1000)
    solution = Solve(Disc(Law(gap=gap), mesh=mesh, material=HookeMaterial(mu=modulus, lam=1500)))
    formulas = Disc(Law(gap=0.01 * x), mesh=mesh, material=HookeMaterial(mu=1000, lam=1500))
    expected = NestedNewtonSolver(coarser=()).Solve(formulas)
    assert solution.displacement == pytest.approx(expected.displacement, abs=1e-8 * np.abs(expected.displacement).max())
    assert np.abs(solution.displacement - Solve(Disc(mesh=mesh)).displacement).max() > 1e-3


def test_a_spline_geometry_that_is_gone_is_not_used():
    """Netgen's mesh does not keep it; what was there may be anything."""
    def Made():
        geometry = SplineGeometry()
        geometry.AddRectangle((0, 0), (1, 1), bcs=["bottom", "right", "top", "left"])
        return Mesh(geometry.GenerateMesh(maxh=0.06))

    mesh = Made()
    others = [Made() for _ in range(5)]     # uses the memory again
    solution = Solve(Disc(mesh=mesh))
    assert len(solution.levels) > 1 and solution.converged and len(others) == 5
    assert solution.levels[0].elements < mesh.ne / 2


@pytest.mark.slow
@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e12])
@pytest.mark.parametrize("length", [1e-6, 1e6])
def test_units_of_stress_and_length(unit, length):
    """The same numbers in other units, held by its foundation alone or not: displacements scale, step counts stay."""
    counts, results = [], []
    for scale, size in ((1.0, 1.0), (unit, length)):
        law = Law(compliance=NormalCompliance(1e6 * scale / size))
        material = HookeMaterial(E=2000 * scale, nu=0.3)
        mesh = RectangleMesh(8, upper=(size, size))
        pressed = Solve(Disc(law, mesh=mesh, material=material, dirichlet={"top": size * PRESSED["dirichlet"]["top"]}))
        loaded = Solve(Disc(law, mesh=mesh, material=material, traction={"top": scale * LOADED["traction"]["top"]}))
        counts.append((len(pressed.history), len(loaded.history)))
        results.append(np.concatenate([pressed.displacement, loaded.displacement]) / size)
    assert results[1] == pytest.approx(results[0], abs=1e-7 * np.abs(results[0]).max())
    assert np.abs(np.subtract(*counts)).max() <= 1


@pytest.mark.slow
@pytest.mark.parametrize("penalty, data", [(12, LOADED | {"roller": {"left": 0}}), (14, LOADED | {"roller": {"left": 0}}),
                                           (12, LOADED), (12, PRESSED)])
def test_coercivity_of_a_body_that_only_its_foundation_holds(penalty, data):
    """A and its norm are singular: rigid motions are no reason to refuse a penalty, and none to let a small one pass."""
    disc = Disc(method=InteriorPenalty(penalty=penalty), mesh=RectangleMesh(8), **data)
    assert Solve(disc).converged
    with pytest.raises(ProblemError, match="penalty=10 loses coercivity.*eigenvalue -0.0[0-9]+ of"):
        Solve(Disc(method=InteriorPenalty(penalty=10), mesh=RectangleMesh(8), **data))


@pytest.mark.parametrize("method", [InteriorPenalty(), LDG(form="lifting")], ids=["ip", "ldg"])
def test_added_forms_may_hold_the_body(method):
    """Springs in the volume, and a load; springs that push are refused."""
    def Sprung(stiffness):
        disc = Disc(method=method, mesh=RectangleMesh(8), **LOADED)
        u, v = disc.space.TnT()
        return disc.Add(BilinearForm(stiffness * u * v * dx)).Add(LinearForm(CF((3, 0)) * v * dx))

    disc = Sprung(500)
    solution = Solve(disc)
    assert Residual(disc, solution.vector, solution.traction) < 1e-9
    with pytest.raises(ProblemError, match="forms that were added"):
        Solve(Sprung(-500))


@pytest.mark.parametrize("foundation, data, culprit", [
    (Law(gap=sqrt(x - 0.5)), PRESSED, "gap is not finite"),
    (Law(compliance=NormalCompliance(sqrt(x - 0.5))), PRESSED, "stiffness"),
    (Law(), {"dirichlet": {"top": CF((sqrt(x - 0.5), 0))}}, "dirichlet.'top'. is not finite"),
    (Law(), LOADED | {"bodyforce": CF((0, 1 / (x - x)))}, "bodyforce is not finite")])
def test_values_that_are_not_finite_are_named(foundation, data, culprit):
    with pytest.raises(ProblemError, match=culprit):
        Solve(Disc(foundation, mesh=RectangleMesh(4), **data))


@pytest.mark.parametrize("Material", [lambda E: HookeMaterial(E=E, nu=0.3), lambda E: HookeMaterial(mu=E, lam=1000),
                                      lambda E: AnisotropicMaterial([[3 * E, 0, 0], [0, 3 * E, 0], [0, 0, E]])])
@pytest.mark.parametrize("Within", [lambda E: 1 + E, lambda E: (x + E).Compile(), lambda E: IfPos(E, E, 3),
                                    lambda E: CF((E, x))[0] + 2], ids=["sum", "compiled", "chosen", "component"])
def test_a_material_that_is_missing_within_an_expression(Within, Material):
    """Its values are in range, and nobody meant them; with a default it is accepted."""
    mesh = TwoMaterials(Material=lambda _: HookeMaterial(E=2000, nu=0.3)).mesh
    whole, part = mesh.MaterialCF({"steel": 2000.0}, default=7), mesh.MaterialCF({"steel": 2000.0})
    assert Disc(mesh=mesh, material=Material(Within(whole))).mesh is mesh
    with pytest.raises(ProblemError, match=r"(E|mu|voigt) has no value on material 'rubber'; give one, or a default"):
        Disc(mesh=mesh, material=Material(Within(part)))


@pytest.mark.parametrize("coefficient", [1.0, 5.0])
@pytest.mark.parametrize("method", [InteriorPenalty(), Conforming()], ids=["ip", "h1"])
def test_very_strong_friction(coefficient, method):
    solution = Solve(Disc(Law(friction=CoulombFriction(coefficient)), method=method))
    assert solution.ZoneLengths()["stick"] > 0.9 and np.abs(solution.slip).max() < 1e-2


def test_very_different_foundations_at_once():
    laws = [Law(compliance=NormalCompliance(1e-3)), Foundation("left", NormalCompliance(1e12, 2), gap=1e-4,
                                                              friction=TrescaFriction(3)),
            Foundation("right", NormalCompliance(1e3, 0.5), gap=1e-5)]
    disc = Disc(laws)
    solution = Solve(disc)
    assert solution.history[-1].residual <= 1e-10
    assert np.all(solution.pressure[solution.points[:, 1] == 0] < 1e-4) and solution.pressure.max() > 1


@pytest.mark.slow
@pytest.mark.parametrize("force", [CF((0, 10)), CF((5, -10))], ids=["lifted", "dragged"])
def test_a_body_that_nothing_keeps_is_an_error(force):
    """It leaves its foundation, or friction cannot hold it: no solution is made up."""
    disc = Disc(Law(compliance=NormalCompliance(1e4)), mesh=RectangleMesh(4), traction={"top": force})
    with pytest.raises(NotConvergedError) as failure:
        Solve(disc)
    assert not failure.value.solution.converged and disc.solves < 20000
