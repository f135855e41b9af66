"""Derivatives of functions that are made of GridFunctions, and errors against other solutions."""

import numpy as np
import pytest
from ngsolve import (CF, H1, BoundaryFromVolumeCF, BSpline, CacheCF, GridFunction, IfPos, InnerProduct, Integrate, Norm,
                     NumberSpace, Parameter, VectorH1, VectorL2, VoxelCoefficient, exp, x, y, z)
from problems import Example

from ngdgc import (LDG, Conforming, ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, ProblemError, Solve)
from ngdgc.data.derivatives import Derivative
from ngdgc.errors import EnergyError, L2Error, StrainError
from ngdgc.exact import BodyForce
from ngdgc.meshes import BoxMesh, RectangleMesh

STEP = 1e-5


def Interpolant(space, value):
    function = GridFunction(space)
    function.Set(value)
    return function


@pytest.mark.parametrize("dim", [2, 3])
def test_derivatives_follow_gridfunctions(dim):
    """Against difference quotients within an element; NGSolve's Diff alone takes GridFunctions for constants."""
    mesh, at = (RectangleMesh(2), (0.3, 0.1)) if dim == 2 else (BoxMesh(1), (0.35, 0.25, 0.2))
    s = Interpolant(H1(mesh, order=2), x * x + y)
    broken = Interpolant(VectorL2(mesh, order=2), CF((x * y, y * y, x * z)[:dim]))
    pair = GridFunction(NumberSpace(mesh) * VectorH1(mesh, order=2))
    pair.components[1].Set(CF((x * y, x + y, x)[:dim]))
    (material,), vector = set(mesh.GetMaterials()), pair.components[1]
    functions = [broken, 2 * broken + s * CF((x, y, z)[:dim]), CF(tuple(s * exp(s) for _ in range(dim))),
                 vector - Norm(vector) * broken, IfPos(s - 5, vector, x * vector), mesh.MaterialCF({material: broken}),
                 broken.components[0] * broken, s, broken[0] * y]
    for function in functions:
        for axis in range(dim):
            ahead, behind = (np.array(function(mesh(*(np.array(at) + sign * STEP * np.eye(dim)[axis])))) for sign in (1, -1))
            quotient = (ahead - behind) / (2 * STEP)
            # Differences of numbers near 1 over 2e-5 are good to 1e-11.
            assert np.array(Derivative(function, axis)(mesh(*at))) == pytest.approx(quotient, abs=1e-9)
            plain = np.array(function.Diff((x, y, z)[axis])(mesh(*at)))
            assert axis == 2 or np.abs(plain - quotient).max() > 1e-4


VOXELS = VoxelCoefficient((0, 0), (1, 1), np.array([[0.0, 1], [0, 1]]))     # x


@pytest.mark.parametrize("function", [VOXELS, y * VOXELS, CF(x).real], ids=["voxels", "product", "real"])
def test_what_would_count_as_constant_is_refused(function):
    """NGSolve's Diff gives 0 where the function grows with x."""
    mesh = RectangleMesh(2)
    assert function(mesh(0.7, 0.5)) > function(mesh(0.2, 0.5)) and function.Diff(x)(mesh(0.3, 0.5)) == 0
    with pytest.raises(ProblemError, match="the function has no symbolic derivative"):
        Derivative(function, 0)


def test_a_gridfunction_out_of_sight_is_not_taken_for_constant():
    mesh = RectangleMesh(2)
    for Hidden in (CacheCF, BoundaryFromVolumeCF):
        with pytest.raises(ProblemError, match="no symbolic derivative"):
            Derivative(Hidden(Interpolant(H1(mesh, order=1), x)), 0)
    for function in (Parameter(2) * x, BSpline(2, [0, 0, 1, 1], [0, 2])(x), mesh.MaterialCF({".*": 2 * x}), CF(2) * x + CF(0),
                     (2 * x).Compile(), Norm(CF((2 * x, 0)))):
        assert Derivative(function, 0)(mesh(0.3, 0.6)) == pytest.approx(2, rel=1e-12)    # control: what is known


def Pressed(method, mesh, order):
    up = (0.05, -0.1) if mesh.dim == 2 else (0.05, 0, -0.1)
    foundation = Foundation("bottom", NormalCompliance(300), gap=0.02)
    problem = ContactProblem(HookeMaterial(E=2000, nu=0.3), foundation, dirichlet={"top": up})
    return Solve(Discretization(problem, method, mesh, order=order))


@pytest.mark.parametrize("method", [InteriorPenalty(), Conforming()], ids=lambda method: method.name)
@pytest.mark.parametrize("mesh", [RectangleMesh(4), BoxMesh(1)], ids=["2D", "3D"])
def test_errors_against_other_solutions(mesh, method):
    """To itself 0, to another order the energy norm of the difference of the strains."""
    one, two = Pressed(method, mesh, 1), Pressed(LDG(), mesh, 2)
    size, d = EnergyError(one, CF((0,) * mesh.dim)), one.strain - two.strain
    difference = np.sqrt(Integrate(InnerProduct(one.disc.problem.material.Stress(d), d), mesh, order=8))
    # The square root of the round-off of a square.
    assert EnergyError(one, one.gfu) < 1e-7 * size and StrainError(one, one.gfu) < 1e-7
    assert EnergyError(one, two.gfu) == pytest.approx(difference, rel=1e-9) and difference < 0.5 * size
    assert EnergyError(one, 2 * one.gfu - one.gfu + CF((1,) * mesh.dim)) < 1e-7 * size
    assert EnergyError(one, 2 * one.gfu) == pytest.approx(size, rel=1e-9)
    assert L2Error(one, one.gfu) == 0


def test_error_against_a_solution_on_a_coarser_mesh():
    """Nested meshes: the coarse function is a polynomial on every fine element."""
    coarse, fine = Pressed(LDG(), RectangleMesh(2), 2), Pressed(LDG(), RectangleMesh(4), 2)
    there = GridFunction(fine.disc.space)
    # NGSolve's default rule has points on the edges, where the coarse function is two-valued.
    there.Set(coarse.gfu, bonus_intorder=1)
    same = EnergyError(fine, there)
    assert EnergyError(fine, coarse.gfu) == pytest.approx(same, rel=1e-9) and same > 1e-3 * EnergyError(fine, CF((0, 0)))


def test_body_force_of_a_varying_material():
    """-div(mu grad) with mu a GridFunction: its slope counts."""
    mesh = RectangleMesh(2)
    mu = Interpolant(H1(mesh, order=1), 1 + x)
    u, at = CF((x * y, x * x)), mesh(0.3, 0.6)
    force = BodyForce(HookeMaterial(mu=mu, lam=1), u)(at)
    assert force == pytest.approx(BodyForce(HookeMaterial(mu=1 + x, lam=1), u)(at), abs=1e-12)
    assert np.abs(np.array(force) - BodyForce(HookeMaterial(mu=1.3, lam=1), u)(at)).max() > 0.5


def test_example_is_not_its_own_error():
    """An exact displacement without GridFunctions is differentiated as before."""
    solution = Solve(Discretization(Example(), LDG(), RectangleMesh(2), order=1))
    u = CF((x * y, 0))
    by_hand = solution.strain - CF((y, x / 2, x / 2, 0), dims=(2, 2))
    square = Integrate(InnerProduct(solution.disc.problem.material.Stress(by_hand), by_hand), solution.disc.mesh, order=8)
    assert EnergyError(solution, u) == pytest.approx(np.sqrt(square), rel=1e-12)
