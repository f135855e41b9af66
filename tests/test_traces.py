"""Exact solutions with zones: B3 and those made from traces, also for laws of a user; a changed datum must be noticed."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from checks import Interpolate, Residual, SameZones
from ngsolve import CF, exp, sin, x
from ngsolve.meshes import MakeStructured3DMesh

from ngdgc import (LDG, AnisotropicMaterial, BassiEtAl, BrezziEtAl, ComplianceLaw, Conforming, CoulombFriction, Discretization,
                   Foundation, HookeMaterial, InteriorPenalty, NormalCompliance, PowerFriction, ProblemError,
                   SemismoothNewtonSolver, SlipWeakeningFriction, TrescaFriction)
from ngdgc.errors import L2Error
from ngdgc.exact import AffinePatch, CubicCompliance, ExactStrain, SmoothSlip, WinklerColumn
from ngdgc.contact.graph import SEPARATION, SLIP, STICK, Distance
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.traces import FromTraces, Positive, ThreeZones

# Residuals are relative to loads of size E eta |u|/h; round-off of the matrix at order 4 is a few thousand times 1e-16 of that.
ROUNDOFF = 1e-11


def Columns(cells, n=4):
    """n columns along x: aligned with x = 1/4 and 3/4 for n = 4."""
    if cells in ("hex", "tet"):
        return MakeStructured3DMesh(hexes=cells == "hex", nx=n, ny=1, nz=1)
    return RectangleMesh(n, cells=cells)


def Held(exact, disc):
    """(Coefficients of u, t = -sigma(u) n at the contact points): what the exact solution is on the mesh."""
    contact, dim = disc.contact, disc.mesh.dim
    stress = disc.problem.material.Stress(ExactStrain(exact.displacement))(contact.inside)
    traction = -np.einsum("pij,pj->pi", np.asarray(stress).reshape(-1, dim, dim), contact.normals)
    return Interpolate(disc, exact.displacement), traction


def Violations(exact, problem, method, mesh, order):
    """(residual of equilibrium, largest distance to the law, do the zones agree) of the exact solution in `problem`."""
    disc = Discretization(problem, method, mesh, order=order)
    vector, traction = Held(exact, disc)
    graph = Distance(disc.contact, disc.contact.Displacement(vector), traction)
    zones = SameZones(graph.zones, disc.contact.coordinates, exact)
    return Residual(disc, vector, traction), graph.distance.max(), zones


# The conforming rule on triangles of Gamma_C has degree 6 at order 4, one too few for p_n v_n; that of degree 7 would have 16
# points for 8 traces.
@pytest.mark.slow
@pytest.mark.parametrize("method, cells", [
    (method, cells) for method in (InteriorPenalty(), BassiEtAl(), BrezziEtAl(form="lifting"), LDG(), Conforming())
    for cells in ("triangle", "quad", "hex", "tet") if method.discontinuous or cells != "tet"])
def test_three_zones_are_a_discrete_solution_on_aligned_meshes_at_order_four(method, cells):
    exact = ThreeZones(dim=3 if cells in ("hex", "tet") else 2)
    residual, distance, zones = Violations(exact, exact.problem, method, Columns(cells), 4)
    assert residual < ROUNDOFF and distance < ROUNDOFF and zones
    if cells in ("triangle", "quad"):
        # On simplices order 3 is too small; a mesh that cuts the zone ends integrates a jump of f.
        assert cells == "quad" or Violations(exact, exact.problem, method, Columns(cells), 3)[0] > 1e-8
        assert Violations(exact, exact.problem, method, Columns(cells, 5), 4)[0] > 1e-8


def Changed(problem, **changes):
    return replace(problem, foundation=replace(problem.foundation[0], **changes))


@pytest.mark.parametrize("changes", [{"friction": CoulombFriction(0.2)}, {"gap": 1e-3}, {"compliance": NormalCompliance(251)}])
def test_three_zones_control_another_law_is_violated(changes):
    exact = ThreeZones()
    assert Violations(exact, Changed(exact.problem, **changes), Conforming(), Columns("quad"), 4)[1] > 1e-3


@pytest.mark.slow
def test_three_zones_are_found_by_a_solver():
    """From zero, to the tolerance; without half the friction nothing sticks; on other meshes the ends are met to a cell."""
    exact = ThreeZones()

    def Solve(problem, mesh, order=4, tol=1e-11):
        return SemismoothNewtonSolver(tol=tol).Solve(Discretization(problem, LDG(), mesh, order=order))

    solution = Solve(exact.problem, RectangleMesh(4))
    assert L2Error(solution, exact.displacement) < 1e-12        # of 5e-3
    assert np.array_equal(solution.zones, exact.zones(solution.points))
    halved = Solve(Changed(exact.problem, friction=CoulombFriction(0.2)), RectangleMesh(4))
    assert halved.ZoneLengths()["stick"] < 0.15
    other = Solve(exact.problem, RectangleMesh(10), order=3, tol=1e-8)
    assert other.ZoneLengths() == pytest.approx({"stick": 0.25, "slip": 0.5, "separation": 0.25}, abs=0.05)


@dataclass(frozen=True)
class Exponential(ComplianceLaw):
    """A user's law whose stiffness varies in space."""

    scale: object

    def Pressure(self, r):
        return self.scale * np.expm1(np.maximum(r, 0))

    def PressureDerivative(self, r):
        return self.scale * np.where(r > 0, np.exp(np.maximum(r, 0)), 0)


@pytest.mark.slow
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("friction, bound", [
    (SlipWeakeningFriction(static=0.6, dynamic=0.3, distance=0.1), lambda p, s: (0.3 + 0.3 * exp(-s / 0.1)) * p),
    (PowerFriction(stiffness=5, exponent=2), lambda p, s: 5 * (0.1 + 0.05 * sin(3 * x)) ** 2), (None, lambda p, s: 0.0)])
def test_a_users_law_with_its_traces_is_a_discrete_solution_in_the_limit(friction, bound, dim):
    """Interpolation error only: it falls with the order like one of an analytic function; another gap is noticed."""
    gap, penetration, slip = 0.01 * x, 0.1 + 0.05 * sin(3 * x), 0.2 + 0.1 * x ** 2
    pressure = 40 * (1 + x) * (exp(penetration) - 1)
    foundation = Foundation("bottom", Exponential(40 * (1 + x)), friction=friction, gap=gap)
    exact = FromTraces(foundation, un=gap + penetration, ut=slip, pressure=pressure, shear=bound(pressure, slip),
                       material=HookeMaterial(mu=100, lam=150), dim=dim)
    mesh = Columns("hex" if dim == 3 else "quad", 2)
    low, high = (Violations(exact, exact.problem, Conforming(), mesh, order) for order in (2, 4))
    assert high[0] < 0.05 * low[0] and high[1] < 1e-4 and high[2]
    assert Violations(exact, Changed(exact.problem, gap=0.02 * x), Conforming(), mesh, 4)[1] > 1e-2


def test_a_stick_zone_is_refused_to_slip_and_the_other_way_round():
    law = Foundation("bottom", NormalCompliance(100), friction=CoulombFriction(0.5))
    sticking = FromTraces(law, un=0.1, pressure=10, shear=-2 * x)
    assert np.all(sticking.zones(np.array([[0.1, 0.0], [0.9, 0.0]])) == STICK)
    open_ = FromTraces(law, un=-0.1 * (1 + x), ut=x, pressure=0)
    assert np.all(open_.zones(np.array([[0.1, 0.0]])) == SEPARATION)
    for traces, culprit in (({"un": 0.1, "pressure": 11}, "pressure is 11 and"),
                            ({"un": 0.1, "pressure": 10, "shear": 4 + 2 * x}, r"at x = 0.5005: the shear is 5.001, more than"),
                            ({"un": 0.1, "pressure": 10, "ut": 0.1, "shear": 4}, "ut is 0.1, not 0"),
                            ({"un": 0.1, "pressure": 10, "ut": -0.1, "shear": 5}, "ut is -0.1, not 0"),
                            ({"un": -0.1, "pressure": 0, "shear": 1}, "the shear is 1, more than the friction bound 0")):
        with pytest.raises(ProblemError, match=culprit):
            FromTraces(law, **traces)


@pytest.mark.parametrize("traces, culprit", [
    ({"un": 0.1 + 0.1 * Positive(x - 0.3, 1), "pressure": 10 + 10 * Positive(x - 0.3, 1)},
     "derivative of un jumps near x = 0.3"),
    ({"un": 0.1 + Positive(x - 0.3, 2), "pressure": 10 + 100 * Positive(x - 0.3, 2)},
     "second derivative of un jumps near x = 0.3"),
    ({"un": 0.1, "pressure": 10, "shear": Positive(x - 0.6, 1)}, "first derivative of shear jumps near x = 0.6"),
    ({"un": 0.1, "pressure": 10, "ut": Positive(x - 0.6, 2), "shear": 5}, "second derivative of ut jumps near x = 0.6")])
def test_traces_whose_stress_would_jump_are_refused(traces, culprit):
    law = Foundation("bottom", NormalCompliance(100), friction=CoulombFriction(0.5))
    with pytest.raises(ProblemError, match=culprit):
        FromTraces(law, **traces)


@pytest.mark.parametrize("call, culprit", [
    (lambda: ThreeZones(ends=(0.5, 0.5)), "ends is"), (lambda: ThreeZones(reserve=40), "more than the friction bound"),
    (lambda: ThreeZones(dim=1), "dim is 1"), (lambda: WinklerColumn(load="weight"), "load is 'weight'"),
    (lambda: FromTraces(Foundation("top", NormalCompliance(1)), un=0, pressure=0), "region 'bottom'"),
    (lambda: FromTraces(Foundation("bottom", NormalCompliance(1)), un=CF((0, 1)), pressure=0), "un has 2 components"),
    (lambda: FromTraces(Foundation("bottom", NormalCompliance(1)), un=0, pressure=0,
                        material=AnisotropicMaterial([[3, 1, 0], [1, 3, 0], [0, 0, 1]])), "HookeMaterial")])
def test_bad_arguments_are_refused_by_name(call, culprit):
    with pytest.raises(ProblemError, match=culprit):
        call()


@pytest.mark.parametrize("exponent", [1, 1.5])
def test_winkler_column_under_pressure_is_a_discrete_solution(exponent, method):
    """The same displacement as under a prescribed one, held by the foundation alone; any other gap violates the law."""
    exact = WinklerColumn(exponent=exponent, load="pressure")
    residual, distance, zones = Violations(exact, exact.problem, method, RectangleMesh(3), 1)
    assert residual < ROUNDOFF and distance < ROUNDOFF and zones
    assert Discretization(exact.problem, method, RectangleMesh(3)).unresisted == "translation along y"
    assert Violations(exact, Changed(exact.problem, gap=0.11), method, RectangleMesh(3), 1)[1] > 1e-2


@pytest.mark.parametrize("exact, order, upper, found", [
    *((AffinePatch(zone), 1, (1, 1), kind) for zone, kind in (("slip", SLIP), ("stick", STICK), ("open", SEPARATION))),
    (CubicCompliance(), 3, (2, 1), SLIP), (CubicCompliance(friction=TrescaFriction(1)), 3, (2, 1), STICK)],
    ids=["slip", "stick", "open", "cubic", "cubic-stick"])
def test_exact_solutions_know_their_zones(exact, order, upper, found):
    mesh = RectangleMesh(3, upper=upper)
    residual, distance, zones = Violations(exact, exact.problem, InteriorPenalty(), mesh, order)
    assert residual < ROUNDOFF and distance < ROUNDOFF and zones
    assert np.all(exact.zones(np.zeros((2, 2))) == found)


@pytest.mark.slow
@pytest.mark.parametrize("dim", [2, 3])
def test_smooth_slip_knows_its_zone(dim):
    exact = SmoothSlip(dim=dim)
    # On hexahedra the interpolation of this order needs more memory than NGSolve gives to one thread.
    assert Violations(exact, exact.problem, Conforming(), RectangleMesh(2) if dim == 2 else BoxMesh(2, cells="prism"), 5)[2]
