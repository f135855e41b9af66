"""Problems with exact solutions: B0, B1, B2 and B5, each with a datum changed so that the check must fail."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import METHODS, Interpolate, Residual
from ngsolve import CF, InnerProduct, Integrate, z
from ngsolve.meshes import MakeStructured3DMesh

from ngdgc import (ContactProblem, Discretization, EstimateContraction, Foundation, HookeMaterial, NormalCompliance,
                   TrescaFriction, UzawaSolver)
from ngdgc.errors import EnergyError, L2Error, Rates
from ngdgc.exact import AffinePatch, CubicCompliance, SmoothSlip, WinklerColumn
from ngdgc.meshes import RectangleMesh

ZONE = {"slip": "slip", "stick": "stick", "open": "separation"}
# The patch lies in every space, so what is left is round-off and the iteration's tolerance, both far below 1e-10.
ROUNDOFF = 1e-10
SOLVER = UzawaSolver(tol=1e-11)


def Solve(problem, method, mesh, order):
    return SOLVER.Solve(Discretization(problem, method, mesh, order=order))


@pytest.mark.parametrize("cells", ["triangle", "quad"])
@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("sides", ["dirichlet", "roller"])
@pytest.mark.parametrize("zone", ["slip", "stick", "open"])
def test_affine_patch_is_returned_to_roundoff(zone, sides, order, cells, method):
    exact = AffinePatch(zone, sides=sides)
    solution = Solve(exact.problem, method, RectangleMesh(2, cells=cells), order)
    assert L2Error(solution, exact.displacement) < ROUNDOFF
    assert EnergyError(solution, exact.displacement) < 1e3 * ROUNDOFF     # sqrt of moduli near 1e3, and a derivative
    assert solution.ZoneLengths()[ZONE[zone]] == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("zone", ["slip", "stick", "open"])
def test_affine_patch_with_tractions_and_a_quadratic_law(zone, method):
    exact = AffinePatch(zone, exponent=2, stiffness=400, sides="traction" if zone != "stick" else "dirichlet")
    solution = Solve(exact.problem, method, RectangleMesh(2), 1)
    assert L2Error(solution, exact.displacement) < ROUNDOFF


@pytest.mark.parametrize("zone", ["slip", "stick"])
def test_affine_patch_with_coulomb_friction(zone, method):
    exact = AffinePatch(zone, coulomb=0.3)
    assert L2Error(Solve(exact.problem, method, RectangleMesh(2), 1), exact.displacement) < ROUNDOFF


def Changed(problem, **changes):
    return replace(problem, foundation=replace(problem.foundation[0], **changes))


def test_patch_control_halved_friction_bound_is_noticed(method):
    exact = AffinePatch("slip")
    halved = Changed(exact.problem, friction=TrescaFriction(1.5))
    assert L2Error(Solve(halved, method, RectangleMesh(2), 1), exact.displacement) > 1e-5


def test_patch_control_bound_below_the_stick_traction_makes_it_slip(method):
    exact = AffinePatch("stick")
    solution = Solve(Changed(exact.problem, friction=TrescaFriction(1.0)), method, RectangleMesh(2), 1)
    assert solution.ZoneLengths()["slip"] == pytest.approx(1, abs=1e-12)
    assert L2Error(solution, exact.displacement) > 1e-5


def test_patch_control_gap_moved_until_it_touches(method):
    exact = AffinePatch("open")
    solution = Solve(Changed(exact.problem, gap=0.0), method, RectangleMesh(2), 1)
    assert solution.ZoneLengths()["separation"] == 0
    assert L2Error(solution, exact.displacement) > 1e-4


@pytest.mark.parametrize("exponent", [1, 1.5, 2])
def test_winkler_column(exponent, method):
    exact = WinklerColumn(exponent=exponent)
    solution = Solve(exact.problem, method, RectangleMesh(3, cells="quad"), 1)
    assert L2Error(solution, exact.displacement) < ROUNDOFF
    assert solution.pressure == pytest.approx(20, rel=1e-9)
    if exponent == 1:   # k H/(lam + 2 mu), the uniform mode being an eigenvector
        number = EstimateContraction(solution.disc, solution.penetration).normal
        assert number == pytest.approx(100 / 3500, rel=1e-6)
    deeper = WinklerColumn(exponent=exponent, gap=0.11)
    assert L2Error(solution, deeper.displacement) > 1e-3


@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("method", METHODS[::2], ids=["ip", "h1"])
def test_smooth_slip_converges_at_full_rates(method, order):
    exact, energy, l2 = SmoothSlip(), [], []
    for n in (4, 8):
        solution = Solve(exact.problem, method, RectangleMesh(n), order)
        energy.append(EnergyError(solution, exact.displacement))
        l2.append(L2Error(solution, exact.displacement))
    assert Rates(energy)[0] == pytest.approx(order, abs=0.15)
    assert Rates(l2)[0] == pytest.approx(order + 1, abs=0.15)
    # Best approximation of a solution of size 1 with all derivatives of size 1: h^k/(k+1)! and a stability constant.
    assert energy[-1] < 2 * 0.125 ** order
    assert solution.ZoneLengths()["slip"] == pytest.approx(1)


@pytest.mark.parametrize("method", METHODS[::2], ids=["ip", "h1"])
def test_smooth_slip_control_wrong_coefficient_stops_converging(method):
    exact = SmoothSlip()
    wrong = replace(exact.problem, foundation=replace(exact.problem.foundation[0], friction=TrescaFriction(0)))
    errors = [L2Error(Solve(wrong, method, RectangleMesh(n), 3), exact.displacement) for n in (4, 8)]
    assert abs(Rates(errors)[0]) < 0.1


@pytest.mark.parametrize("friction", [None, TrescaFriction(7.0)])
@pytest.mark.parametrize("cells", ["triangle", "quad"])
def test_cubic_solution_has_no_residual_at_order_three(cells, friction, method):
    exact = CubicCompliance(friction=friction)

    def ExactResidual(problem, order):
        disc = Discretization(problem, method, RectangleMesh(3, upper=(2, 1), cells=cells), order=order)
        vector = Interpolate(disc, exact.displacement)
        contact = disc.contact
        pressure = contact.Pressure(contact.Penetration(contact.Displacement(vector)))
        return Residual(disc, vector, pressure[:, None] * contact.normals)

    assert ExactResidual(exact.problem, 3) < ROUNDOFF
    toosmall = 2 if cells == "triangle" else 1                             # the cubic lies in Q_2
    assert ExactResidual(exact.problem, toosmall) > 1e-5
    assert ExactResidual(Changed(exact.problem, gap=0.01), 3) > 1e-5       # the gap is not zero


def test_patch_in_three_dimensions(method):
    """The same code with d = 3: slip in an oblique direction of the plane z = 0, tetrahedra and hexahedra."""
    mu, lam, k, w, gap, bound = 1000.0, 1500.0, 100.0, 0.3, 0.1, 3.0
    e, s = k * (w - gap) / (lam + 2 * mu), bound / mu
    u = CF((0.6 * (0.1 + s * z), 0.8 * (0.1 + s * z), -w - e * z))
    foundation = Foundation("bottom", NormalCompliance(k), friction=TrescaFriction(bound), gap=gap)
    problem = ContactProblem(HookeMaterial(mu=mu, lam=lam), foundation, dirichlet={"left|right|front|back|top": u})
    for hexes in (False, True):
        mesh = MakeStructured3DMesh(hexes=hexes, nx=2, ny=2, nz=2)
        solution = Solve(problem, method, mesh, 1)
        difference = solution.gfu - u
        assert np.sqrt(Integrate(InnerProduct(difference, difference), mesh)) < ROUNDOFF
        assert solution.ZoneLengths()["slip"] == pytest.approx(1)
        assert solution.GlobalImbalance() < ROUNDOFF
        if method.discontinuous:
            assert np.abs(solution.ElementImbalance()).max() < ROUNDOFF
        halved = replace(problem, foundation=replace(foundation, friction=TrescaFriction(bound / 2)))
        assert np.abs(Solve(halved, method, mesh, 1).displacement - solution.displacement).max() > 1e-5
