"""Bodies of revolution: exact where strain is constant, forms that agree where they must, coercive at the axis, orders."""

import numpy as np
import pytest
from bodies import Mixed
from netgen.geom2d import SplineGeometry
from netgen.occ import Glue, MoveTo
from ngsolve import BND, CF, Integrate, Mesh, Norm, Parameter, x, y
from ngsolve.meshes import MakeStructured2DMesh
from rings import STIFFNESS, Smooth

from ngdgc import (LDG, BassiEtAl, BrezziEtAl, Conforming, ContactProblem, Discretization, Foundation, HookeMaterial,
                   IncompleteInteriorPenalty, InteriorPenalty, Joint, NonsymmetricInteriorPenalty, NormalCompliance,
                   PenaltyFreeLDG, ProblemError, SemismoothNewtonSolver, Solve, SolveHistory)
from ngdgc.errors import EnergyError, L2Error, Rates
from ngdgc.export import Scene
from ngdgc.mesh.facets import Csr
from ngdgc.meshes import RectangleMesh, ShapeMesh
from ngdgc.methods.coercivity import CheckCoercivity, SmallestEigenvalue
from ngdgc.methods.variants import Variants
from ngdgc.problem.frames import Cylindrical
from ngdgc.solution.fields import SpatialStress
from ngdgc.solution.turned import Turned

STEEL = HookeMaterial(E=100, nu=0.3)
A, B, C = 0.01, -0.05, -0.02        # u_r = A r, u_z = B z + C
HOOP, AXIAL = (STEEL.lam * (2 * A + B) + 2 * STEEL.mu * slope for slope in (A, B))    # sigma_rr = sigma_theta, sigma_zz
EXACT = CF((A * x, B * y + C))
SHARP = SemismoothNewtonSolver(tol=1e-13)      # that pressures have the digits of the linear equations


def Pressed(sides="dirichlet", **changes):
    """A cylinder 0 < r < 1 on the foundation z = 0, whose law has the pressure -AXIAL at the penetration -C - gap."""
    held = {"dirichlet": {"dirichlet": {"top|right": EXACT}}, "roller": {"dirichlet": {"top": EXACT}, "roller": {"right": A}},
            "traction": {"dirichlet": {"top": EXACT}, "traction": {"right": (HOOP, 0)}}}[sides]
    foundation = Foundation("bottom", NormalCompliance(STIFFNESS), gap=-C + AXIAL / STIFFNESS)
    return ContactProblem(STEEL, foundation, axisymmetric=True, **held | changes)


def Check(solution, exact, pressure):
    """The exact field and pressure to 1e-10, and balance; returns the largest of what must vanish."""
    off = [L2Error(solution, exact) / A, EnergyError(solution, exact), np.abs(solution.pressure / pressure - 1).max(),
           solution.GlobalImbalance()]
    if solution.disc.method.conservative:
        off.append(np.abs(solution.ElementImbalance()).max())
    return max(off)


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("name", Variants())
def test_constant_strain_is_returned(name, order):
    """Triangles and quadrilaterals at the axis, loads of every kind; forces and energy are those of the whole body."""
    for sides in ("dirichlet", "roller", "traction") if name in ("LDG edge", "H1") else ("traction",):
        solution = SHARP.Solve(Discretization(Pressed(sides), Variants()[name], Mixed(), order=order))
        assert Check(solution, EXACT, -AXIAL) < 1e-10
    np.testing.assert_allclose([solution.Force("bottom")[1], solution.Force("top")[1], solution.normalforce],
                               [-np.pi * AXIAL, np.pi * AXIAL, -np.pi * AXIAL], rtol=1e-11)
    np.testing.assert_allclose(solution.Force("right")[0], 2 * np.pi * HOOP, rtol=1e-11)
    assert abs(solution.Force("top")[0]) < 1e-10 and not any(np.any(part.moment) for part in solution.Resultants())
    np.testing.assert_allclose(L2Error(solution, EXACT + CF((1, 0))), np.sqrt(np.pi), rtol=1e-10)
    np.testing.assert_allclose(solution.energy, np.pi / 2 * (2 * A * HOOP + B * AXIAL), rtol=1e-11)


@pytest.mark.parametrize("method", [NonsymmetricInteriorPenalty(), IncompleteInteriorPenalty(), PenaltyFreeLDG(),
                                    LDG(form="lifting", penalty=0.01)], ids=lambda method: method.name)
def test_other_methods_return_constant_strain(method):
    solution = SHARP.Solve(Discretization(Pressed(), method, Mixed(), order=2))
    assert Check(solution, EXACT, -AXIAL) < 1e-10


@pytest.mark.parametrize("method", [InteriorPenalty(), BrezziEtAl(form="lifting"), Conforming()], ids=["IP", "Brezzi", "H1"])
def test_constant_strain_is_returned_on_curved_elements(method):
    geometry = SplineGeometry()
    p = [geometry.AppendPoint(*q) for q in [(0, 0), (1, 0), (1.2, 0.5), (1, 1), (0.5, 1.2), (0, 1)]]
    geometry.Append(["line", p[0], p[1]], bc="bottom")
    geometry.Append(["spline3", p[1], p[2], p[3]], bc="right")
    geometry.Append(["spline3", p[3], p[4], p[5]], bc="top")
    geometry.Append(["line", p[5], p[0]], bc="axis")
    mesh = Mesh(geometry.GenerateMesh(maxh=0.7)).Curve(2)
    solution = SHARP.Solve(Discretization(Pressed(), method, mesh, order=2))
    assert Check(solution, EXACT, -AXIAL) < 1e-10


@pytest.mark.parametrize("method", [LDG(), Conforming()], ids=["LDG", "H1"])
def test_press_fit_of_a_ring(method):
    """u_r = A r in a ring pressed into a bore: contact along a cylinder, whose area is 2 pi 2."""
    mesh = MakeStructured2DMesh(quads=True, nx=1, ny=2, mapping=lambda s, t: (1 + s, t))
    k, gap = 200.0, 2 * A + HOOP / 200
    problem = ContactProblem(STEEL, Foundation("right", NormalCompliance(k), gap=gap), dirichlet={"left": EXACT},
                             roller={"bottom": -C, "top": B + C}, axisymmetric=True)
    assert HOOP < 0
    solution = SHARP.Solve(Discretization(problem, method, mesh, order=2))
    assert Check(solution, EXACT, -HOOP) < 1e-10
    np.testing.assert_allclose(solution.ZoneLengths()["slip"], 4 * np.pi, rtol=1e-12)
    np.testing.assert_allclose(solution.Force("right")[0], 4 * np.pi * HOOP, rtol=1e-10)


def test_springs_count_around_the_axis():
    """Constant strain with springs above, whose pull the traction there makes up for."""
    stiffness = 30.0
    problem = ContactProblem(STEEL, Pressed().foundation, spring={"top": (0, stiffness)}, axisymmetric=True,
                             traction={"top": (0, AXIAL + stiffness * (B + C)), "right": (HOOP, 0)})
    solution = SHARP.Solve(Discretization(problem, LDG(), Mixed(), order=2))
    assert Check(solution, EXACT, -AXIAL) < 1e-10


@pytest.mark.parametrize("member, forgotten", [("Integral", lambda self, integrand, symbol: integrand * symbol),
                                               ("Weights", lambda self, weights, *_: weights)])
def test_forgotten_weights_are_seen(monkeypatch, member, forgotten):
    """The control of the patch tests: 2 pi r left out of integrals in symbols, or of the contact points."""
    monkeypatch.setattr(Cylindrical, member, forgotten)
    for method in (LDG(), Conforming()):
        solution = SHARP.Solve(Discretization(Pressed("traction"), method, Mixed(), order=2))
        assert Check(solution, EXACT, -AXIAL) > 1e-3


def Difference(first, second):
    first, second = Csr(first), Csr(second)
    return abs(first - second).max() / abs(second).max()


@pytest.mark.parametrize("name", ["IP edge", "Bassi lifting", "Brezzi edge", "LDG lifting"])
def test_blocks_and_symbols_have_one_matrix(name):
    """With the same rule for u_r v_r/r, which no rule integrates exactly."""
    facet, skeleton = (Discretization(Pressed("roller"), Variants()[name], Mixed(), order=2, assembly=assembly)
                       for assembly in ("facet", "skeleton"))
    assert Difference(facet.matrix, skeleton.matrix) < 1e-13
    np.testing.assert_allclose(facet.load, skeleton.load, atol=1e-13 * abs(facet.load).max() + 1e-15)


@pytest.mark.parametrize("method", [InteriorPenalty, BassiEtAl, BrezziEtAl, LDG])
def test_edge_form_is_lifting_form_without_lateral_strain(method):
    """C eps(V_h) lies in Q_h for nu = 0 alone: else lam u_r/r is in all its diagonal, and no polynomial."""
    def Off(nu):
        problem = ContactProblem(HookeMaterial(E=100, nu=nu), Pressed().foundation, dirichlet={"top|right": EXACT},
                                 axisymmetric=True)
        mesh = MakeStructured2DMesh(quads=False, nx=2, ny=1)
        return Difference(*(Discretization(problem, method(penalty=30, form=form), mesh, order=2).form.Matrix()
                            for form in ("edge", "lifting")))

    assert Off(0) < 1e-14
    assert 1e-5 < Off(0.3) < 1e-2


@pytest.mark.parametrize("nu", [0.3, 0.4999])
def test_coercive_at_the_axis(nu):
    """The element bound keeps B_h >= (1 - 1/sqrt 2) of the norm; a small penalty loses it."""
    problem = ContactProblem(HookeMaterial(E=1, nu=nu), Pressed().foundation, dirichlet={"right": (0, 0)}, axisymmetric=True)
    for order in (1, 3):
        disc = Discretization(problem, InteriorPenalty(), RectangleMesh(2), order=order)
        assert disc.form.guarantee.holds
        smallest = SmallestEigenvalue(disc.matrix, disc.form.Norm(), disc.space.FreeDofs())
        assert smallest > 1 - np.sqrt(1 / 2)
        weak = Discretization(problem, InteriorPenalty(penalty=0.5, weighting="C"), RectangleMesh(2), order=order)
        with pytest.raises(ProblemError, match="loses coercivity"):
            CheckCoercivity(weak.form, weak.form.Matrix(), weak.space.FreeDofs())


@pytest.mark.parametrize("method, order", [(InteriorPenalty(), 1), (InteriorPenalty(), 2), (BassiEtAl(form="lifting"), 2),
                                           (Conforming(), 2)], ids=["IP 1", "IP 2", "Bassi 2", "H1 2"])
def test_orders_on_a_field_that_reaches_the_axis(method, order):
    """k in the energy norm and k + 1 in L2, within 0.1."""
    problem, u = Smooth()
    solutions = [Solve(Discretization(problem, method, RectangleMesh(n), order=order)) for n in (6, 12)]
    assert abs(Rates([EnergyError(solution, u) for solution in solutions])[0] - order) < 0.1
    assert abs(Rates([L2Error(solution, u) for solution in solutions])[0] - order - 1) < 0.1
    assert EnergyError(solutions[-1], u) < {1: 1.2e-2, 2: 2e-4}[order]
    # On the axis u_r/r is d_r u_r.
    hoop = solutions[-1].strain(solutions[-1].disc.mesh(0, 0.37))[8]
    assert hoop == pytest.approx(0.1 * (1 + 0.37 ** 2 / 2), rel=5e-2 / order ** 4)
    # u_r vanishes there by nature: nothing imposes it.
    assert abs(solutions[-1].gfu[0](solutions[-1].disc.mesh(0, 0.37))) < {1: 2e-4, 2: 1e-5}[order]


def test_only_the_translation_along_the_axis_is_rigid():
    """A ring that nothing holds but a bore is free along the axis, and only there."""
    ring = MakeStructured2DMesh(quads=True, nx=2, ny=2, mapping=lambda s, t: (1 + s, t))
    loose = ContactProblem(STEEL, Foundation("right", NormalCompliance(10)), traction={"left": (1, 0)}, axisymmetric=True)
    with pytest.raises(ProblemError, match="translation along the axis"):
        Solve(Discretization(loose, LDG(), ring))
    standing = ContactProblem(STEEL, Foundation("bottom", NormalCompliance(10)), traction={"left": (1, 0), "top": (0, -1)},
                              axisymmetric=True)
    solution = Solve(Discretization(standing, LDG(), ring))
    np.testing.assert_allclose(solution.Force("bottom"), [0, 3 * np.pi], atol=1e-12)
    assert solution.GlobalImbalance() < 1e-12


def test_report_table_and_hoop_stress():
    solution = Solve(Discretization(Pressed("traction"), Conforming(), Mixed(), order=2))
    assert solution.Table().dtype.names[1:3] == ("r", "z") and "friction_r" in solution.Table().dtype.names
    report = solution.Report()
    assert "F_r" in report and "moment" not in report and "area 3.142" in report
    assert solution.ToJSON()["axisymmetric"] is True
    stress = np.array(SpatialStress(solution)(solution.disc.mesh(0.4, 0.5))).reshape(3, 3)
    np.testing.assert_allclose(stress, np.diag([HOOP, AXIAL, HOOP]), atol=1e-12)
    largest, _ = solution.Largest("stt")        # also at corners on the axis, where u_r/r is its limit
    np.testing.assert_allclose(largest, HOOP, rtol=1e-10)


def Halves(inner):
    """A cylinder or a ring of two halves, "lower" and "upper", with the joint z = 1/2 between them."""
    body = Glue([MoveTo(inner, low).Rectangle(1, 0.5).Face() for low in (0, 0.5)])
    for face in body.faces:
        face.name = "lower" if face.center[1] < 0.5 else "upper"
    for edge in body.edges:
        r, z, _ = edge.center
        edge.name = ("joint" if abs(z - 0.5) < 1e-9 else "bottom" if z < 1e-9 else "top" if z > 1 - 1e-9
                     else "right" if r > inner + 1 - 1e-9 else "inner")
    return ShapeMesh(body, 0.6)


@pytest.mark.parametrize("inner", [0, 1])
@pytest.mark.parametrize("method", [LDG(), BassiEtAl(form="lifting"), Conforming()], ids=["LDG", "Bassi", "H1"])
def test_jump_across_a_joint(method, inner):
    """u_z jumps by P/k; the point of the joint on the axis, where no area is, has no part in it, also with doubled nodes."""
    lower, upper = CF((A * x, B * y)), CF((A * x, B * y + AXIAL / 80))
    loads = {"right": (HOOP, 0)} | ({"inner": (-HOOP, 0)} if inner else {})
    problem = ContactProblem(STEEL, Joint("joint", NormalCompliance(80)), dirichlet={"bottom": lower, "top": upper},
                             traction=loads, axisymmetric=True)
    solution = SHARP.Solve(Discretization(problem, method, Halves(inner), order=2))
    mesh = solution.disc.mesh
    assert Integrate(Norm(solution.gfu - mesh.MaterialCF({"lower": lower, "upper": upper})), mesh) < 1e-12
    np.testing.assert_allclose(solution.pressure, -AXIAL, rtol=1e-10)
    area = np.pi * (2 * inner + 1)
    for material, sign in (("lower", 1), ("upper", -1)):
        assert solution.Force("joint", material=material)[1] == pytest.approx(sign * AXIAL * area, rel=1e-11)


@pytest.mark.parametrize("method", [LDG(), Conforming()], ids=["LDG", "H1"])
def test_work_is_energy_along_a_history(method):
    """Without friction the trapezoids of the work are exact, and proportional loads end in the state of Solve."""
    t = Parameter(0)
    problem = ContactProblem(STEEL, Foundation("bottom", NormalCompliance(200)), dirichlet={"top": (0, -0.02 * t)},
                             traction={"right": (-0.5 * t, 0)}, axisymmetric=True)
    disc = Discretization(problem, method, Mixed(), order=2)
    history = SolveHistory(disc, parameter=t, times=[0.5, 1])
    np.testing.assert_allclose(history.work, history.energy, rtol=1e-12)
    np.testing.assert_allclose(history.forces["bottom"][-1], history[-1].Force("bottom"), atol=1e-12)
    t.Set(1)
    spring = history[-1].weights @ history[-1].pressure ** 2 / 400
    # The energy of the form has the jumps, too, and another quadrature for u_r^2/r.
    np.testing.assert_allclose(history[-1].energy + spring, history.energy[-1], rtol=1e-3)
    np.testing.assert_allclose(Solve(disc).vector, history[-1].vector, atol=1e-11)


def test_turned_body_has_the_surface_of_three_quarters():
    """Of a cylinder and of a ring: both cuts and what is around; its values are those of the section, also deformed."""
    for inner in (0, 1):
        mesh = MakeStructured2DMesh(quads=bool(inner), nx=2, ny=2, mapping=lambda s, t, inner=inner: (inner + s, t))
        foundation = Foundation("bottom", NormalCompliance(10))
        problem = ContactProblem(STEEL, foundation, traction={"top": (0, -1)}, axisymmetric=True)
        solution = Solve(Discretization(problem, LDG(), mesh, order=2))
        body, value, displacement = Turned(solution, x * y)
        # A cylinder of 36 facets in three quarters.
        polygon = 36 * 2 * np.sin(0.75 * np.pi / 36)
        around = polygon * ((inner + 1) + inner + np.cos(0.75 * np.pi / 36) * ((inner + 1) ** 2 - inner ** 2))
        assert Integrate(CF(1), body, BND) == pytest.approx(2 + around, rel=1e-12)
        assert value.vec.FV().NumPy().max() == pytest.approx(inner + 1)
        lowest = displacement.vec.FV().NumPy().reshape(3, -1)[2].min()
        assert lowest == pytest.approx(solution.gfu[1](solution.disc.mesh(inner + 0.5, 1 - 1e-9)), rel=0.02)
    assert len(Scene(solution).Page()) < len(Scene(solution, turned=True).Page())
