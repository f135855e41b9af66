"""A foundation with a normal of its own: gap, pressure and slip are along and across N, whichever way the body's side looks."""

import numpy as np
import pytest
from checks import Interpolate
from netgen.occ import Circle, MoveTo, OCCGeometry
from ngsolve import CF, Mesh, Parameter, specialcf, x, y, z
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh
from problems import TEN, Solved

from ngdgc import (LDG, Conforming, ContactProblem, ContactSolution, CoulombFriction, Discretization, EstimateError,
                   EstimateForce, EstimateZones, Foundation, HookeMaterial, InteriorPenalty, NormalCompliance, ProblemError,
                   Solve, TrescaFriction, UzawaSolver)
from ngdgc.contact.boundary import ContactBoundary
from ngdgc.contact.graph import Distance
from ngdgc.estimates.nitsche import LinearisedContact, TractionMatrix
from ngdgc.estimates.residual import ResidualEstimate
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.plots import DeformedFigure, SettingFigure

MATERIAL = HookeMaterial(E=1000, nu=0.3)
STIFFNESS = 500.0
METHOD, SOFT = LDG(), NormalCompliance(1000)


def Plane(slope, constant, dim):
    """constant + slope.x, a CoefficientFunction."""
    return sum((float(s) * c for s, c in zip(slope, (x, y, z)[:dim])), CF(float(constant)))


def Inclined(dim):
    """The unit square or cube with a plane bottom of height 0.4 x (+ 0.25 y); and its outward normal."""
    n = np.array([0.4, -1] if dim == 2 else [0.4, 0.25, -1])
    if dim == 2:
        mesh = MakeStructured2DMesh(quads=False, nx=3, ny=3, mapping=lambda s, t: (s, t + 0.4 * s * (1 - t)))
    else:
        mesh = MakeStructured3DMesh(hexes=False, nx=2, ny=2, nz=2,
                                    mapping=lambda s, r, t: (s, r, t + (0.4 * s + 0.25 * r) * (1 - t)))
    return mesh, n / np.linalg.norm(n)


def Patch(dim, zone, n):
    """(problem, u): u = tau e + nu N affine, N = -e_height, e across it; in stick tau = 0 on the bottom.

    Stress is constant; the gap is what p_n(nu - g) = p wants.  In 3D nu has a slope that leaves no traction along N x e.
    """
    N, e = -np.eye(dim)[-1], np.array([0.6, 0.8, 0.0] if dim == 3 else [1.0, 0.0])
    f = np.cross(N, e) if dim == 3 else np.zeros(2)
    shear = 0.01 * n if zone == "stick" else 0.004 * N + 0.003 * f
    squeeze = -0.02 * N
    if zone == "slip":
        squeeze = squeeze + (0.02 * MATERIAL.lam * (f @ n) - MATERIAL.mu * (f @ shear) * (e @ n)) / (MATERIAL.mu * (N @ n)) * f
    gradient = np.outer(e, shear) + np.outer(N, squeeze)
    strain = (gradient + gradient.T) / 2
    t = -(MATERIAL.lam * np.trace(strain) * np.eye(dim) + 2 * MATERIAL.mu * strain) @ n
    pressure, friction = t @ N, np.linalg.norm(t - (t @ N) * N)
    start = 0 if zone == "stick" else 0.05 * np.sign(t @ e)     # friction t_t is along u_t
    tau, nu = Plane(shear, start, dim), Plane(squeeze, 0.1, dim)
    u = CF(tuple(tau * float(a) + nu * float(b) for a, b in zip(e, N)))
    foundation = Foundation("bottom", NormalCompliance(STIFFNESS), gap=nu - pressure / STIFFNESS, normal=3 * N,
                            friction=CoulombFriction(friction / pressure * (2 if zone == "stick" else 1)))
    sides = "left|right|top" + "|front|back" * (dim - 2)
    return ContactProblem(MATERIAL, foundation, dirichlet={sides: u}), u


CASES = [*((2, method) for method in (*TEN, Conforming())), *((3, method) for method in (*TEN[1:7:3], TEN[6], Conforming()))]


@pytest.mark.parametrize("zone", ["slip", "stick"])
@pytest.mark.parametrize("dim, method", CASES, ids=lambda value: str(value))
def test_affine_patch_on_an_inclined_side(dim, method, zone):
    # Round-off only: stresses are constant.  Along the body's own normal another pressure and friction follow (control).
    mesh, n = Inclined(dim)
    problem, u = Patch(dim, zone, n)
    solution = Solved(problem, method, mesh, order=1)
    exact = Interpolate(solution.disc, u)
    assert np.abs(solution.vector - exact).max() < 1e-11
    assert set(solution.zones) == {2 if zone == "slip" else 1}
    assert solution.GlobalImbalance() < 1e-11
    assert np.abs(solution.normals - -np.eye(dim)[-1]).max() == 0 and np.abs(solution.disc.contact.outward - n).max() < 1e-14
    tangential = np.abs(np.sum(solution.friction * solution.normals, axis=1)).max()
    assert tangential < 1e-12 * np.abs(solution.traction).max()


def test_control_of_the_patch():
    mesh, n = Inclined(2)
    problem, u = Patch(2, "slip", n)
    (own,) = problem.foundation
    along = Foundation(own.boundary, own.compliance, friction=own.friction, gap=own.gap)
    solution = Solved(ContactProblem(MATERIAL, along, dirichlet=dict(problem.dirichlet)), LDG(), mesh, order=1)
    assert np.abs(solution.vector - Interpolate(solution.disc, u)).max() > 1e-4


@pytest.mark.parametrize("Estimate, method", [(EstimateError, LDG()), (ResidualEstimate, Conforming())],
                         ids=["equilibrated", "residual"])
def test_estimates_know_the_normal(Estimate, method):
    # Of an affine patch nothing is left to estimate; with tractions along n the law's part would be of the size of the energy.
    mesh, n = Inclined(2)
    solution = Solved(Patch(2, "slip", n)[0], method, mesh, order=2)
    assert Estimate(solution).relative < 1e-6     # the root of round-off


def test_estimate_of_the_force_knows_the_normal():
    mesh, n = Inclined(2)
    estimate = EstimateForce(Solved(Patch(2, "slip", n)[0], LDG(), mesh, order=1))
    assert np.abs(estimate.error["bottom"]).max() < 1e-9 * np.abs(estimate.value["bottom"]).max()


def Rounded(maxh=0.3):
    """A block whose underside "rim" is an arc of radius 3, at most 19 degrees steep; its lowest point is the origin."""
    face = Circle((0, 3), 3).Face() * MoveTo(-1, -1).Rectangle(2, 2.5).Face()
    for edge in face.edges:
        x, y = edge.center.x, edge.center.y
        edge.name = "top" if y > 1.4 else "left" if x < -0.9 else "right" if x > 0.9 else "rim"
    return Mesh(OCCGeometry(face, dim=2).GenerateMesh(maxh=maxh)).Curve(2)


def OnFlat(mesh, method=METHOD, friction=None, *, normal=(0, -1), solver=None, law=SOFT):
    """The rounded block pressed onto the flat foundation y = 0 and pushed aside."""
    foundation = Foundation("rim", law, friction=friction, gap=y, normal=normal)
    problem = ContactProblem(HookeMaterial(E=2000, nu=0.3), foundation, dirichlet={"top": CF((0.02, -0.1))})
    disc = Discretization(problem, method, mesh, order=2)
    return (solver or Solve)(disc)


@pytest.mark.parametrize("method", [LDG(), InteriorPenalty(form="lifting"), Conforming()], ids=str)
def test_a_flat_foundation_pushes_upwards_only(method):
    mesh = Rounded()
    force = OnFlat(mesh, method).Force("rim")
    assert force[1] > 10 and abs(force[0]) < 1e-12 * force[1]
    sideways = OnFlat(mesh, method, normal=None).Force("rim")
    assert abs(sideways[0]) > 1e-3 * sideways[1]            # control: along n the sides of the arc push


@pytest.mark.parametrize("law", [NormalCompliance(1000), NormalCompliance(1e9), NormalCompliance(3000, 2)], ids=str)
def test_solvers_agree(law):
    mesh = Rounded()
    newton = OnFlat(mesh, friction=CoulombFriction(0.3), law=law)
    uzawa = OnFlat(mesh, friction=CoulombFriction(0.3), law=law,
                   solver=UzawaSolver(normal="implicit", acceleration="anderson", tol=1e-9, maxiter=500).Solve)
    assert np.abs(newton.traction - uzawa.traction).max() < 1e-6 * np.abs(newton.traction).max()
    law = Distance(newton.disc.contact, newton.displacement, newton.traction)
    assert law.distance.max() < 1e-9
    assert newton.GlobalImbalance() < 1e-10


@pytest.mark.parametrize("mesh, given", [
    (RectangleMesh(4), (0, -1)), (RectangleMesh(4), CF((0, -2))), (BoxMesh(2), (0, 0, -1)), (Rounded(), specialcf.normal(2))],
    ids=["square", "longer", "cube", "curved"])
@pytest.mark.parametrize("method", [InteriorPenalty(), Conforming()], ids=str)
def test_the_outward_normal_changes_nothing(method, mesh, given):
    boundary = "rim" if "rim" in mesh.GetBoundaries() else "bottom"

    def Found(**normal):
        foundation = Foundation(boundary, NormalCompliance(300), friction=TrescaFriction(1), gap=0.01, **normal)
        push = (0.01,) * (mesh.dim - 1) + (-0.05,)
        return Solve(Discretization(ContactProblem(MATERIAL, foundation, dirichlet={"top": push}), method, mesh))

    own, plain = Found(normal=given), Found()
    if boundary == "bottom":
        assert np.array_equal(own.vector, plain.vector) and np.array_equal(own.traction, plain.traction)
    else:       # NGSolve's normal has a round-off of its own
        assert np.abs(own.vector - plain.vector).max() < 1e-12 * np.abs(plain.vector).max()


def test_a_normal_that_varies_and_depends_on_a_parameter():
    mesh, turn = RectangleMesh(3), Parameter(0)
    foundation = Foundation("bottom", NormalCompliance(300), normal=CF((turn * x, -1)))
    disc = Discretization(ContactProblem(MATERIAL, foundation, dirichlet={"top": (0, -0.05)}), LDG(), mesh)
    straight = Solve(disc)
    turn.Set(0.5)
    turned = Solve(disc)
    assert straight.Force("bottom")[0] == pytest.approx(0, abs=1e-10) and abs(turned.Force("bottom")[0]) > 0.1
    slope = 0.5 * turned.points[:, 0]
    assert np.allclose(turned.traction[:, 0], -slope * turned.traction[:, 1], rtol=1e-12)


def test_it_is_drawn_and_stored(tmp_path):
    solution = OnFlat(Rounded(), friction=CoulombFriction(0.3))
    for figure, level in ((SettingFigure(solution.disc), 0), (DeformedFigure(solution), 0)):
        (block,) = [patch for patch in figure.axes[0].patches if patch.get_gid() == "foundation"]
        surface = block.get_xy()[:-1][:len(block.get_xy()) // 2]
        assert np.abs(surface[:, 1] - level).max() < 1e-9       # the surface of the foundation is flat, however the body is
    solution.Save(tmp_path / "solution")
    problem = solution.disc.problem
    assert np.array_equal(ContactSolution.Load(tmp_path / "solution", problem).traction, solution.traction)
    (own,) = problem.foundation
    other = Foundation("rim", own.compliance, friction=own.friction, gap=own.gap, normal=(0.001, -1))
    with pytest.raises(ProblemError, match="gaps differ"):
        ContactSolution.Load(tmp_path / "solution", ContactProblem(problem.material, other, dirichlet=dict(problem.dirichlet)))


def test_nothing_resists_a_slide_along_a_flat_foundation():
    foundation = Foundation("rim", NormalCompliance(1000), gap=y, normal=(0, -1))
    disc = Discretization(ContactProblem(MATERIAL, foundation, traction={"top": (0, -1)}), LDG(), Rounded())
    with pytest.raises(ProblemError, match="nothing resists translation along x, neither"):
        Solve(disc)
    along = Foundation("rim", NormalCompliance(1000), gap=y)
    disc = Discretization(ContactProblem(MATERIAL, along, traction={"top": (0, -1)}), LDG(), Rounded())
    with pytest.raises(ProblemError, match="nothing resists translation along x with rotation about"):
        Solve(disc)     # control: an arc rolls about its middle


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("zone", ["slip", "stick"])
def test_zones_of_an_exact_solution_are_sure(dim, zone, monkeypatch):
    """-C eps(u_h) n is the traction with n the body's own normal; with N it would slip where all of it sticks (control)."""
    mesh, n = Inclined(dim)
    solution = Solved(Patch(dim, zone, n)[0], METHOD, mesh, order=1)
    assert set(EstimateZones(solution).values()) == {0.0}
    if zone == "stick":
        monkeypatch.setattr(ContactBoundary, "outward", property(lambda contact: contact.normals, lambda contact, n: None),
                            raising=False)
        assert EstimateZones(solution)["stick"] == pytest.approx(solution.ZoneLengths()["stick"])


@pytest.mark.parametrize("dim", [2, 3])
def test_stress_vectors_of_force_estimates_are_those_of_the_body(dim):
    """The matrix that maps coefficients to -C eps(u) n gives what is computed from the function; along N it would not."""
    mesh, n = Inclined(dim)
    disc = Discretization(Patch(dim, "stick", n)[0], METHOD, mesh, order=2)
    vector = np.random.default_rng(1).uniform(-1, 1, disc.space.ndof)
    contact = LinearisedContact(disc, vector)
    found = (contact.tractions @ vector).reshape(contact.stress.shape)
    assert np.abs(found - contact.stress).max() < 1e-10 * np.abs(contact.stress).max()
    contact.contact.outward = contact.contact.normals
    wrong = (TractionMatrix(disc, contact.contact) @ vector).reshape(contact.stress.shape)
    assert np.abs(wrong - contact.stress).max() > 0.1 * np.abs(contact.stress).max()
