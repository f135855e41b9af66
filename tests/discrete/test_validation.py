"""Every mistake in a problem is an error that names culprit and remedy, before anything is solved."""

import numpy as np
import pytest
from bodies import Tilted
from netgen.csg import unit_cube
from netgen.geom2d import SplineGeometry
from ngsolve import CF, BilinearForm, Grad, IfPos, InnerProduct, Mesh, Sym, dx, specialcf, sqrt, x, y
from problems import Example

from ngdgc import (AnisotropicMaterial, Conforming, ContactProblem, ContactSolution, CoulombFriction, Discretization,
                   Foundation, HookeMaterial, InteriorPenalty, NormalCompliance, ProblemError, SemismoothNewtonSolver, Solve,
                   TrescaFriction, UzawaSolver)
from ngdgc.meshes import RectangleMesh

NAN = sqrt(-1 - x)
SOFT = NormalCompliance(450)


def test_the_example_itself_is_accepted(method):
    disc = Discretization(Example(), method, RectangleMesh(2), order=1)
    assert disc.unresisted is None and UzawaSolver().Solve(disc).converged


@pytest.mark.slow
@pytest.mark.parametrize("changes, culprit", [
    ({"dirichlet": {"rihgt": CF((0, 0))}}, "dirichlet region 'rihgt' matches no boundary.*bottom, left, right, top"),
    ({"traction": {"east": CF((0, 0))}}, "traction region 'east'"), ({"roller": {"north": 0}}, "roller region 'north'"),
    ({"foundation": Foundation("floor", SOFT)}, "foundation region 'floor' matches no boundary.*Gamma_C would be empty"),
    ({"foundation": Foundation("", SOFT)}, "Gamma_C would be empty"),
    ({"foundation": Foundation("bottom|right", SOFT)}, "'right' is claimed twice, by dirichlet 'right' and by foundation"),
    ({"traction": {"left|bottom": CF((0, 0))}}, "'bottom' is claimed twice"),
    ({"dirichlet": {"right": CF((0, 0)), "ri.*": CF((0, 0))}}, "'right' is claimed twice"),
    ({"foundation": [Foundation("bottom", SOFT), Foundation("bot.*", SOFT)]}, "'bottom' is claimed twice"),
    ({"foundation": [Foundation("bottom", SOFT)] * 2}, "'bottom' is claimed twice"),
    ({"material": HookeMaterial(E=1, nu=0.7 + 0 * x, plane="stress")}, "0.5 - nu is -0.2"),
    ({"material": HookeMaterial(E=1000 + sqrt(y - 0.02), nu=0.3)}, "not finite"),
    ({"roller": {"top": 0}, "traction": {"top": CF((1, 1))}}, r"traction\['top'\] has a normal component on a roller"),
    ({"traction": {"left": CF((NAN, 0))}}, r"traction\['left'\] is not finite"),
    ({"dirichlet": {"right": CF((0, NAN))}}, r"dirichlet\['right'\] is not finite"),
    ({"roller": {"top": NAN}}, r"roller\['top'\] is not finite"), ({"bodyforce": CF((NAN, 0))}, "bodyforce is not finite"),
    ({"material": HookeMaterial(E=NAN, nu=0.3)}, "mu is not finite"),
    ({"material": HookeMaterial(mu=IfPos(x - 0.5, 1, -1), lam=1)}, "mu is -1"),
    ({"material": HookeMaterial(mu=1, lam=-2 + 0 * x)}, r"2\*lam \+ 2\*mu is -2"),
    ({"material": AnisotropicMaterial([[1, 0, 0], [0, x - 0.5, 0], [0, 0, 1]])}, "not positive definite"),
    ({"foundation": Foundation("bottom", NormalCompliance(x - 0.5))}, "foundation 'bottom': stiffness is"),
    ({"foundation": Foundation("bottom", SOFT, gap=NAN)}, "foundation 'bottom': gap is not finite"),
    ({"foundation": Foundation("bottom", SOFT, friction=TrescaFriction(x - 2))}, "foundation 'bottom': bound is"),
    ({"dirichlet": None}, "foundation alone"), ({"dirichlet": None, "roller": {"right": 0}}, "foundation alone")])
def test_bad_data_on_a_mesh(changes, culprit, method):
    with pytest.raises(ProblemError, match=culprit):
        UzawaSolver().Solve(Discretization(Example(**changes), method, RectangleMesh(2), order=1))


@pytest.mark.parametrize("changes, culprit", [
    ({"dirichlet": {"right": 0}}, r"dirichlet\['right'\] is 0; give a"), ({"dirichlet": {"right": CF(0)}}, "1 component"),
    ({"dirichlet": "right"}, "dirichlet is 'right'; give a dictionary"), ({"roller": {"top": CF((0, 0))}}, "2 components"),
    ({"traction": {"left": CF((0, 0, 0))}}, "different dimensions"), ({"bodyforce": 3}, "bodyforce is 3"),
    ({"foundation": None}, "at least one"), ({"foundation": "bottom"}, "give a Foundation"),
    ({"material": 2000}, "material is 2000"), ({"foundation": 5}, "foundation is 5"),
    ({"dirichlet": {1: CF((0, 0))}}, "dirichlet region is 1"), ({"traction": {"[": CF((0, 0))}}, "traction region is '\\['"),
    ({"traction": {"left": CF((1j, 0))}}, "complex"),
    ({"dirichlet": {"right": (0, float("nan"))}}, r"dirichlet\['right'\] is nan")])
def test_bad_data_without_a_mesh(changes, culprit):
    with pytest.raises(ProblemError, match=culprit):
        Example(**changes)


@pytest.mark.parametrize("order", [0, -1, 1.5, "two", True])
def test_bad_order(order, method):
    with pytest.raises(ProblemError, match="order is"):
        Discretization(Example(), method, RectangleMesh(2), order=order)


@pytest.mark.parametrize("rho", [0, -1.0, float("nan"), float("inf"), "best"])
def test_bad_rho(rho):
    with pytest.raises(ProblemError, match="rho is"):
        UzawaSolver(rho=rho)


@pytest.mark.parametrize("arguments", [{"tol": 0}, {"tol": -1}, {"tol": 2}, {"maxiter": 0}, {"maxiter": 1.5}])
def test_bad_solver_arguments(arguments):
    with pytest.raises(ProblemError, match=f"{next(iter(arguments))} is"):
        UzawaSolver(**arguments)


@pytest.mark.parametrize("penalty", [0, -3, float("nan"), "large", None])
def test_bad_penalty(penalty):
    with pytest.raises(ProblemError, match="penalty is"):
        InteriorPenalty(penalty=penalty)


@pytest.mark.slow
def test_mesh_of_the_wrong_dimension(method):
    cube = Mesh(unit_cube.GenerateMesh(maxh=1))
    with pytest.raises(ProblemError, match="mesh has dimension 3, the data of the problem have 2"):
        Discretization(Example(), method, cube, order=1)
    scalar = ContactProblem(HookeMaterial(E=1, nu=0.3, plane="stress"), Foundation("bottom", SOFT), roller={"top": 0})
    with pytest.raises(ProblemError, match="plane='stress' on a mesh of dimension 3"):
        Discretization(scalar, method, cube, order=1)


def test_interface_inside_the_body_is_no_boundary(method):
    geometry = SplineGeometry()
    geometry.AddRectangle((0, 0), (1, 1), bcs=["bottom", "right", "top", "left"], leftdomain=1)
    geometry.AddRectangle((0.3, 0.3), (0.7, 0.7), bc="interface", leftdomain=2, rightdomain=1)
    with pytest.raises(ProblemError, match="'interface' contains facets inside the body"):
        problem = Example(foundation=Foundation("interface", SOFT))
        Discretization(problem, method, Mesh(geometry.GenerateMesh(maxh=0.4)), order=1)


def test_floating_body_names_the_motion(method):
    """A frictionless foundation below resists neither a horizontal translation nor, on the disc, a rotation."""
    problem = Example(dirichlet=None, traction=None, foundation=Foundation("bottom", SOFT))
    with pytest.raises(ProblemError, match="body floats: nothing resists translation along x"):
        Discretization(problem, method, RectangleMesh(2), order=1).matrix   # noqa: B018
    geometry = SplineGeometry()
    geometry.AddCircle((2, 3), 1, bc="rim")
    mesh = Mesh(geometry.GenerateMesh(maxh=0.5)).Curve(6)     # a circle up to round-off squared
    disc = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("rim", SOFT))
    with pytest.raises(ProblemError, match=r"rotation about \(2, 3\)"):
        Solve(Discretization(disc, method, mesh, order=2))


def test_held_by_the_foundation_alone_is_legitimate_but_not_for_uzawa(method):
    problem = Example(dirichlet=None, roller={"left|right": 0}, traction=None, bodyforce=(0, -1))
    disc = Discretization(problem, method, RectangleMesh(2), order=1)
    assert disc.unresisted == "translation along y"
    with pytest.raises(ProblemError, match=r"only contact resists translation along y.*Solve\(disc\)"):
        UzawaSolver().Solve(disc)
    held = Discretization(Example(dirichlet={"right": CF((0, 0))}), method, RectangleMesh(2), order=1)
    assert held.unresisted is None


@pytest.mark.parametrize("compliance, friction, motion", [
    (NormalCompliance(0), None, "translation along x"), (NormalCompliance(0), CoulombFriction(0.3), "translation along x"),
    (NormalCompliance(0), TrescaFriction(1), "translation along y"), (NormalCompliance(CF(0)), TrescaFriction(1), "along y"),
    (NormalCompliance(1), CoulombFriction(0), "translation along x"), (NormalCompliance(IfPos(x - 0.6, 1, 0)), None, "along x"),
    (NormalCompliance(1), TrescaFriction(1), None), (NormalCompliance(IfPos(x - 0.6, 1, 0)), CoulombFriction(0.3), None)])
def test_a_foundation_without_stiffness_or_friction_resists_nothing(compliance, friction, motion, method):
    problem = Example(dirichlet=None, traction=None, foundation=Foundation("bottom", compliance, friction=friction))
    if motion is None:
        assert "translation along y" in Discretization(problem, method, RectangleMesh(4), order=1).unresisted
        return
    with pytest.raises(ProblemError, match=f"body floats: nothing resists.*{motion}"):
        Solve(Discretization(problem, method, RectangleMesh(4), order=1))


def test_springs_hold_a_body_that_nothing_else_holds(method):
    """Uzawa solves it, and agrees with Newton; springs along y leave a translation along x to the foundation."""
    def Held(springs):
        problem = Example(50.0, dirichlet=None, traction=None, bodyforce=(0, -1))
        disc = Discretization(problem, method, RectangleMesh(4), order=1)
        u, v = disc.space.TnT()
        return disc.Add(BilinearForm(springs(u, v) * dx))

    disc = Held(lambda u, v: 40 * u * v)
    assert disc.unresisted is None and disc.loose is not None
    solution = UzawaSolver().Solve(disc)
    assert solution.normalforce > 0 or solution.penetration.max() < 0
    assert SemismoothNewtonSolver().Solve(disc).displacement == pytest.approx(solution.displacement, abs=1e-8)
    with pytest.raises(ProblemError, match="only contact resists translation along x"):
        UzawaSolver().Solve(Held(lambda u, v: 40 * u[1] * v[1]))


def test_forms_that_no_rigid_motion_feels_hold_nothing(method):
    """Round-off of strains, and of a form that is skew, is no stiffness; control: the smallest one that is holds."""
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), Foundation("bottom", NormalCompliance(10)),
                             traction={"right": (5, 0)}, bodyforce=(0, -1))

    def Added(integrand):
        disc = Discretization(problem, method, RectangleMesh(2, upper=(2, 1)))
        return disc.Add(BilinearForm(integrand(*disc.space.TnT()) * dx))
    for integrand in (lambda u, v: 500 * InnerProduct(Sym(Grad(u)), Sym(Grad(v))), lambda u, v: u[0] * v[1] - u[1] * v[0]):
        assert "translation along x" in Added(integrand).unresisted
        with pytest.raises(ProblemError, match="the body floats: nothing resists translation along x"):
            Solve(Added(integrand))
    held = Added(lambda u, v: 500 * InnerProduct(Sym(Grad(u)), Sym(Grad(v))) + 1e-3 * u[0] * v[0])
    assert "translation along x" not in held.unresisted and held.matrix.height == held.space.ndof


def test_springs_hold_one_part_of_the_mesh():
    """Two separate squares: the springs of one do not hold the other."""
    geometry = SplineGeometry()
    geometry.AddRectangle((0, 0), (1, 1), bcs=["bottom", "right", "top", "left"], leftdomain=1)
    geometry.AddRectangle((3, 0), (4, 1), bcs=["bottom", "other", "other", "other"], leftdomain=2)
    geometry.SetMaterial(1, "left")
    problem = Example(dirichlet=None, traction=None, foundation=Foundation("bottom", SOFT, friction=TrescaFriction(1)))
    for region, left in ((".*", None), ("left", "part 2")):
        disc = Discretization(problem, Conforming(), Mesh(geometry.GenerateMesh(maxh=0.5)), order=1)
        u, v = disc.space.TnT()
        disc.Add(BilinearForm(u * v * dx(definedon=disc.mesh.Materials(region))))
        assert disc.unresisted is None if left is None else left in disc.unresisted


def test_part_of_the_mesh_that_floats(method):
    """Two separate squares, only one of them held."""
    geometry = SplineGeometry()
    geometry.AddRectangle((0, 0), (1, 1), bcs=["bottom", "right", "top", "left"])
    geometry.AddRectangle((3, 0), (4, 1), bc="other")
    mesh = Mesh(geometry.GenerateMesh(maxh=0.5))
    with pytest.raises(ProblemError, match="the body floats.*part 2 of the mesh"):
        UzawaSolver().Solve(Discretization(Example(), method, mesh, order=1))
    both = Example(dirichlet={"right|other": CF((0, 0))})
    assert Discretization(both, method, mesh, order=1).unresisted is None


@pytest.mark.parametrize("problem, method, mesh, culprit", [
    ("problem", Conforming(), RectangleMesh(1), "problem is 'problem'"), (Example(), "ip", RectangleMesh(1), "method is 'ip'"),
    (Example(), InteriorPenalty, RectangleMesh(1), "method is <class"), (Example(), Conforming(), None, "mesh is None"),
    (Example(), Conforming(), RectangleMesh(1).ngmesh, "mesh is <netgen")])
def test_arguments_of_the_wrong_kind(problem, method, mesh, culprit):
    with pytest.raises(ProblemError, match=culprit):
        Discretization(problem, method, mesh, order=1)


def test_values_that_only_the_assembly_sees_are_named(method):
    """The rule of order 5 comes closer to the boundary than the points at which data are looked at."""
    problem = Example(bodyforce=CF((sqrt(y - 0.03), 0)))
    disc = Discretization(problem, method, RectangleMesh(2), order=5)
    with pytest.raises(ProblemError, match="bodyforce is not finite at some quadrature point"):
        UzawaSolver().Solve(disc)


def test_numpy_numbers_are_numbers(method, tmp_path):
    problem = Example(np.float32(450), material=HookeMaterial(E=np.float64(2000), nu=np.float64(0.25)))
    disc = Discretization(problem, method, RectangleMesh(np.int64(2)), order=np.int64(1))
    solution = UzawaSolver(maxiter=np.int64(500)).Solve(disc)
    solution.Save(tmp_path)
    numbered = Discretization(Example(), InteriorPenalty(penalty=np.int64(30)), RectangleMesh(2), order=1)
    UzawaSolver().Solve(numbered).Save(tmp_path / "numbered")
    assert ContactSolution.Load(tmp_path, problem).energy == pytest.approx(solution.energy)


def test_round_off_of_a_traction_on_a_roller_is_no_normal_part(method):
    """The tangential part of a stress without any, on an inclined side, is 1e-16 in every direction."""
    normal = specialcf.normal(2)
    stress = (HookeMaterial(E=2000, nu=0.3).Stress(CF((1e-3, 0, 0, 1e-3), dims=(2, 2)))) * normal
    problem = Example(roller={"left": 0.001}, traction={"left": stress - (stress * normal) * normal},
                      dirichlet={"top": CF((0, 0))})
    assert Discretization(problem, method, Tilted(0.7), order=1).unresisted is None


def test_penalty_that_loses_coercivity_is_detected_not_assumed():
    """P1 with lam/mu = 4: the threshold lies near 21.5; nearly incompressible, the paper's 30 is lost."""
    mesh = RectangleMesh(4)
    for penalty, nu, safe in ((30, 0.4, True), (18, 0.4, False), (5, 0.4, False), (30, 0.495, False), (1500, 0.495, True)):
        problem = Example(material=HookeMaterial(E=2000, nu=nu))
        disc = Discretization(problem, InteriorPenalty(penalty=penalty), mesh, order=1)
        if safe:
            assert UzawaSolver().Solve(disc).converged
        else:
            with pytest.raises(ProblemError, match=f"penalty={penalty} loses coercivity.*penalty='auto'"):
                UzawaSolver().Solve(disc)


def test_mesh_helper_refuses_nonsense():
    for arguments in ({"n": 0}, {"n": 2.5}, {"n": 2, "cells": "hexagon"}):
        with pytest.raises(ProblemError, match=f"{list(arguments)[-1]} is"):
            RectangleMesh(**arguments)
