"""Problems with exact solutions: B0, B1, B2 and B5, each with a datum changed so that the check must fail."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from checks import Interpolate, Residual
from ngsolve import CF
from problems import METHODS

from ngdgc import (LDG, BassiEtAl, BrezziEtAl, Conforming, Discretization, EstimateContraction, InteriorPenalty,
                   ProblemError, SemismoothNewtonSolver, TrescaFriction)
from ngdgc.errors import EnergyError, L2Error, Rates, StrainError
from ngdgc.exact import AffinePatch, CubicCompliance, ExactStrain, SmoothSlip, WinklerColumn
from ngdgc.contact.graph import SLIP
from ngdgc.meshes import BoxMesh, RectangleMesh, UnitMesh

Patch = cache(AffinePatch)
ZONE = {"slip": "slip", "stick": "stick", "open": "separation"}
# The patch lies in every space, so what is left is round-off and the iteration's tolerance, both far below 1e-10.
ROUNDOFF = 1e-10
SOLVER = SemismoothNewtonSolver(tol=1e-11)


def Solve(problem, method, mesh, order):
    return SOLVER.Solve(Discretization(problem, method, mesh, order=order))


@pytest.mark.slow
@pytest.mark.parametrize("cells", ["triangle", "quad"])
@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("sides", ["dirichlet", "roller"])
@pytest.mark.parametrize("zone", ["slip", "stick", "open"])
def test_affine_patch_is_returned_to_roundoff(zone, sides, order, cells, method):
    exact = Patch(zone, sides=sides)
    solution = Solve(exact.problem, method, RectangleMesh(2, cells=cells), order)
    assert L2Error(solution, exact.displacement) < ROUNDOFF
    assert EnergyError(solution, exact.displacement) < 1e3 * ROUNDOFF     # sqrt of moduli near 1e3, and a derivative
    assert solution.ZoneLengths()[ZONE[zone]] == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("zone", ["slip", "stick", "open"])
def test_affine_patch_with_tractions_and_a_quadratic_law(zone, method):
    exact = Patch(zone, exponent=2, stiffness=400, sides="traction" if zone != "stick" else "dirichlet")
    solution = Solve(exact.problem, method, RectangleMesh(2), 1)
    assert L2Error(solution, exact.displacement) < ROUNDOFF


@pytest.mark.parametrize("zone", ["slip", "stick"])
def test_affine_patch_with_coulomb_friction(zone, method):
    exact = Patch(zone, coulomb=0.3)
    assert L2Error(Solve(exact.problem, method, RectangleMesh(2), 1), exact.displacement) < ROUNDOFF


def Changed(problem, **changes):
    return replace(problem, foundation=replace(problem.foundation[0], **changes))


def test_patch_control_halved_friction_bound_is_noticed(method):
    exact = Patch("slip")
    halved = Changed(exact.problem, friction=TrescaFriction(1.5))
    assert L2Error(Solve(halved, method, RectangleMesh(2), 1), exact.displacement) > 1e-5


def test_patch_control_bound_below_the_stick_traction_makes_it_slip(method):
    exact = Patch("stick")
    solution = Solve(Changed(exact.problem, friction=TrescaFriction(1.0)), method, RectangleMesh(2), 1)
    free = np.abs(solution.points[:, 0] - 0.5) < 0.499      # points of H1 at the sides are held there
    assert np.all(solution.zones[free] == SLIP) and np.any(free)
    assert L2Error(solution, exact.displacement) > 1e-5


def test_patch_control_gap_moved_until_it_touches(method):
    exact = Patch("open")
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


@pytest.mark.slow
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


@pytest.mark.slow
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


@pytest.mark.slow
@pytest.mark.parametrize("zone, sides, cells", [
    *(("slip", sides, cells) for sides in ("dirichlet", "roller", "traction") for cells in ("tet", "hex", "prism")),
    *(("open", "roller", cells) for cells in ("tet", "hex", "prism")),
    *(("stick", sides, cells) for sides in ("dirichlet", "roller") for cells in ("tet", "hex", "prism"))])
def test_patch_in_three_dimensions(zone, sides, cells, method):
    """The same code with d = 3: an oblique direction in the plane z = 0."""
    exact = Patch(zone, sides=sides, coulomb=0.15 if zone == "open" else None, dim=3)
    solution = Solve(exact.problem, method, BoxMesh(2, cells=cells), 1)
    assert L2Error(solution, exact.displacement) < ROUNDOFF
    assert EnergyError(solution, exact.displacement) < 1e3 * ROUNDOFF
    assert solution.ZoneLengths()[ZONE[zone]] == pytest.approx(1, abs=1e-12)
    assert solution.GlobalImbalance() < ROUNDOFF
    if method.discontinuous:
        assert np.abs(solution.ElementImbalance()).max() < ROUNDOFF
    # A bound below the traction makes it slip, or slip with less; the open body notices when its gap closes.
    other = Changed(exact.problem, gap=0.0) if zone == "open" else Changed(exact.problem, friction=TrescaFriction(0.5))
    assert L2Error(Solve(other, method, BoxMesh(2, cells=cells), 1), exact.displacement) > 1e-5


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("lam", [1.0, 1e4])
def test_smooth_slip_fulfils_equilibrium_and_the_law(lam, dim):
    """At random points: -div sigma = f_1 by central differences; on Gamma_C sigma_n = -p_n, sigma_t = -p_t u_t/|u_t|."""
    exact = SmoothSlip(lam=lam, stiffness=3.0, exponent=1.5, dim=dim)
    problem, u = exact.problem, exact.displacement
    foundation, mesh = problem.foundation[0], UnitMesh(1, "quad" if dim == 2 else "hex")
    stress = problem.material.Stress(ExactStrain(u))
    places, step = np.random.default_rng(1).uniform(0.1, 0.9, (20, dim)), 1e-4

    def At(function, where):
        return np.array([function(mesh(*place)) for place in where])

    shifts = step * np.eye(dim)
    divergence = sum((At(stress, places + shift) - At(stress, places - shift)).reshape(-1, dim, dim)[:, :, j] / (2 * step)
                     for j, shift in enumerate(shifts))
    scale = np.abs(At(stress, places)).max()
    # Truncation step^2, and round-off of terms of size lam that cancel in sigma.
    assert np.abs(divergence + At(problem.bodyforce, places)).max() < 1e-6 * scale + 1e-11 * lam

    places[:, -1] = 0
    normal = -np.eye(dim)[-1]
    traction = At(stress, places).reshape(-1, dim, dim) @ normal
    sigman, un = traction @ normal, At(u, places) @ normal
    sigmat, ut = traction - np.outer(sigman, normal), At(u, places) - np.outer(un, normal)
    pressure = foundation.compliance.Pressure(un - foundation.gap)
    bound = At(foundation.friction.coefficient, places) * pressure
    direction = ut / np.linalg.norm(ut, axis=1)[:, None]
    assert pressure.min() > 0 and np.abs(sigman + pressure).max() < 1e-14 * lam
    assert np.abs(sigmat + bound[:, None] * direction).max() < 1e-14 * lam
    assert np.abs(sigmat - bound[:, None] * direction).max() > 0.1      # friction the other way
    if dim == 3:
        assert np.all(np.abs(ut[:, :2]).min(axis=0) > 0.01)             # both components slip


# Meshes 1/2 and 1/4; order 2 with the two methods that are solved fastest, `ngdgc convergence --cells tet` does the others.
@pytest.mark.slow
@pytest.mark.parametrize("method, cells, order", [
    *((method, cells, 1) for method in (InteriorPenalty(), LDG(), Conforming()) for cells in ("tet", "hex", "prism")),
    (BassiEtAl(form="lifting"), "tet", 1), (BassiEtAl(form="lifting"), "tet", 2), (Conforming(), "tet", 2),
    (BrezziEtAl(form="lifting"), "prism", 1)])
def test_smooth_slip_converges_at_full_rates_in_three_dimensions(method, cells, order):
    exact, energy, l2 = SmoothSlip(dim=3), [], []
    for n in (2, 4):
        solution = Solve(exact.problem, method, BoxMesh(n, cells=cells), order)
        energy.append(EnergyError(solution, exact.displacement))
        l2.append(L2Error(solution, exact.displacement))
    assert Rates(energy)[0] == pytest.approx(order, abs=0.15)
    assert Rates(l2)[0] == pytest.approx(order + 1, abs=0.15)


@pytest.mark.slow
def test_smooth_slip_control_friction_in_the_wrong_direction_stops_converging():
    """The oblique direction matters: the tangential displacement of another one does not solve the problem."""
    exact = SmoothSlip(dim=3)
    turned = CF((exact.displacement[1], exact.displacement[0], exact.displacement[2]))
    wrong = replace(exact.problem, dirichlet={region: turned for region in exact.problem.dirichlet})
    errors = [L2Error(Solve(wrong, InteriorPenalty(), BoxMesh(n), 1), exact.displacement) for n in (2, 4)]
    assert abs(Rates(errors)[0]) < 0.1


@pytest.mark.parametrize("arguments, culprit", [({"dim": 4}, "dim is 4"), ({"mu": 1.0}, "mu is 1 and lam is 1"),
                                                ({"lam": 0.0}, "mu is 2 and lam is 0")])
def test_bad_arguments_of_the_smooth_solution(arguments, culprit):
    with pytest.raises(ProblemError, match=culprit):
        SmoothSlip(**arguments)


def test_bad_arguments_of_the_patch_and_the_box():
    for call, culprit in ((lambda: AffinePatch("slip", dim=1), "dim is 1"), (lambda: BoxMesh(0), "n is 0"),
                          (lambda: BoxMesh(2, cells="quad"), "cells is 'quad'"),
                          (lambda: UnitMesh(2, "cube"), "cells is 'cube'")):
        with pytest.raises(ProblemError, match=culprit):
            call()


def test_relative_strain_error_of_a_known_pair():
    """u_h = u up to round-off; against 2 u it is |eps(u)|/|eps(2 u)|."""
    exact = Patch("slip")
    solution = Solve(exact.problem, Conforming(), RectangleMesh(2), 1)
    assert StrainError(solution, exact.displacement) < ROUNDOFF
    assert StrainError(solution, 2 * exact.displacement) == pytest.approx(0.5, rel=1e-9)
