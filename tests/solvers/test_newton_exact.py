"""Newton's method returns known solutions: patches, columns, three zones, the cubic one, and a published benchmark."""

from dataclasses import replace

import numpy as np
import pytest
from checks import SameZones
from ngsolve.meshes import MakeStructured2DMesh
from problems import TEN

from ngdgc import (LDG, Conforming, CoulombFriction, Discretization, InteriorPenalty, NestedNewtonSolver, NormalCompliance,
                   SemismoothNewtonSolver)
from ngdgc.cases import greco_plate
from ngdgc.errors import L2Error
from ngdgc.exact import AffinePatch, CubicCompliance, WinklerColumn
from ngdgc.contact.graph import SEPARATION, SLIP, STICK
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.traces import ThreeZones

ELEVEN = [*TEN, Conforming()]
NAMES = [method.name + getattr(method, "form", "") for method in ELEVEN]
THREE = [LDG(), InteriorPenalty(), Conforming()]
SOLVERS = [SemismoothNewtonSolver(), NestedNewtonSolver()]
ENDS = 0.27, 0.71       # of the zones of B3: no vertex of a uniform mesh


@pytest.fixture(params=ELEVEN, ids=NAMES)
def every(request):
    return request.param


@pytest.fixture(params=THREE, ids=lambda method: method.name)
def some(request):
    return request.param


def Solve(problem, method, mesh, order=1, solver=SOLVERS[0]):
    return solver.Solve(Discretization(problem, method, mesh, order=order))


def RelativeError(solution, displacement):
    return L2Error(solution, displacement) / np.abs(solution.vector).max()


def Halved(problem):
    """The same with half the friction: bound or coefficient."""
    friction = problem.foundation[0].friction
    half = replace(friction, **{name: value / 2 for name, value in vars(friction).items()})
    return replace(problem, foundation=replace(problem.foundation[0], friction=half))


@pytest.mark.slow
@pytest.mark.parametrize("stiffness, coulomb", [(100.0, None), (1e8, 0.2)])
@pytest.mark.parametrize("zone", ["slip", "stick", "open"])
def test_affine_patches(zone, stiffness, coulomb, every):
    """B0 to round-off, on a soft and on a nearly rigid foundation; halving the friction, or the gap, is another solution."""
    exact = AffinePatch(zone, stiffness=stiffness, coulomb=coulomb)
    solution = Solve(exact.problem, every, RectangleMesh(3))
    assert RelativeError(solution, exact.displacement) < 1e-10 and SameZones(solution.zones, solution.points, exact)
    closed = replace(exact.problem, foundation=replace(exact.problem.foundation[0], gap=0.01))
    wrong = closed if zone == "open" else Halved(Halved(exact.problem))
    assert RelativeError(Solve(wrong, every, RectangleMesh(3)), exact.displacement) > 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("cells", ["tet", "hex", "prism"])
@pytest.mark.parametrize("zone", ["slip", "stick", "open"])
def test_affine_patches_in_space(zone, cells, some):
    exact = AffinePatch(zone, dim=3)
    solution = Solve(exact.problem, some, BoxMesh(2, cells=cells))
    assert RelativeError(solution, exact.displacement) < 1e-10 and SameZones(solution.zones, solution.points, exact)
    if zone != "open":
        half = Solve(Halved(Halved(exact.problem)), some, BoxMesh(2, cells=cells))
        assert RelativeError(half, exact.displacement) > 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("exponent", [1, 1.5])
@pytest.mark.parametrize("stiffness", [1.0, 1e3, 1e12])
def test_column_under_pressure(stiffness, exponent, some):
    """B1: the foundation alone holds the column; a gap deeper by 0.01 is noticed."""
    exact = WinklerColumn(stiffness=stiffness, exponent=exponent, load="pressure")
    for solver in SOLVERS:
        solution = Solve(exact.problem, some, RectangleMesh(4), solver=solver)
        # Round-off of A, 1e-16 times a penalty of 1e5, against the stiffness that holds the column.
        assert RelativeError(solution, exact.displacement) < 1e-10 * max(1, 1e3 / stiffness)
        assert solution.normalforce == pytest.approx(20, rel=1e-8)
    deeper = WinklerColumn(stiffness=stiffness, exponent=exponent, load="pressure", gap=0.11)
    assert L2Error(solution, deeper.displacement) == pytest.approx(0.01, rel=1e-3)


@pytest.mark.slow
def test_three_zones_on_an_aligned_mesh(every):
    """B3 at order 4: round-off, and the zone of every point; with half the friction nothing sticks."""
    exact = ThreeZones()
    solution = Solve(exact.problem, every, RectangleMesh(4), order=4)
    assert RelativeError(solution, exact.displacement) < 1e-9 and SameZones(solution.zones, solution.points, exact)
    half = Solve(Halved(exact.problem), every, RectangleMesh(4), order=4)
    # 1/4 but for one point at the end of the zone, where both pieces of the law meet; its weight is at most 1/64.
    assert half.ZoneLengths()["stick"] < 0.13 < 0.23 < solution.ZoneLengths()["stick"]


def Ends(solution):
    """(a, b): where the slip and the pressure begin, from their positive parts between the outermost points of the zones.

    Zones are known at points only, so their ends jump by the distance of points.  With slip (x - a)^3 and pressure (b - x)^3
    the cube roots are linear, and the zero of the line through their values in the slip zone is the end.
    """
    at, slipping = solution.points[:, 0], (solution.points[:, 0] > 0.4) & (solution.points[:, 0] < 0.6)
    roots = np.cbrt(solution.slip[slipping, 0]), np.cbrt(solution.pressure[slipping])
    lines = [np.polyfit(at[slipping], values, 1) for values in roots]
    return [-b / a for a, b in lines]


@pytest.mark.slow
def test_ends_of_the_zones_on_other_meshes(some):
    """B3 with ends inside of facets: |a_h - a| and |b_h - b| fall with order 2 to 3.5 to a hundredth of h.

    The rate is over two refinements from n = 16: f jumps at x = a, and what the quadrature makes of it depends on where in its
    facet that is.  Elements are twice as high as wide: nothing happens inside of the body.
    Read off the zones of the points b is met to a facet and a to three, the friction in reserve being 8 (a - x)^2 only.
    """
    exact = ThreeZones(ends=ENDS, reserve=8.0)
    errors, mesh = [], {n: MakeStructured2DMesh(quads=False, nx=n, ny=n // 2) for n in (16, 32, 64)}
    for n in mesh:
        solution = Solve(exact.problem, some, mesh[n], order=2, solver=SOLVERS[1])
        errors.append(np.abs(np.subtract(Ends(solution), ENDS)))
        lengths = solution.ZoneLengths()
        assert lengths["stick"] == pytest.approx(ENDS[0], abs=3 / n)
        assert lengths["separation"] == pytest.approx(1 - ENDS[1], abs=1 / n)
    assert np.all(errors[-1] < 0.01 / n)
    rates = np.log2(errors[0] / errors[-1]) / 2
    assert np.all((2 < rates) & (rates < 3.5))
    half = Solve(Halved(exact.problem), some, mesh[32], order=2)
    assert np.abs(Ends(half)[0] - ENDS[0]) > 50 * errors[-1][0] and half.ZoneLengths()["stick"] < ENDS[0] - 3 / n


@pytest.mark.slow
@pytest.mark.parametrize("friction", [None, CoulombFriction(0.4)])
def test_cubic_solution(friction, every):
    """B5, for any friction; order 2 is too small, and a foundation softer by a per cent is another problem."""
    exact = CubicCompliance(friction=friction)
    solution = Solve(exact.problem, every, RectangleMesh(3, upper=(2, 1)), order=3)
    pressed = solution.points[:, 0] > 0         # p_n(x = 0) = 0
    assert RelativeError(solution, exact.displacement) < 1e-9
    assert SameZones(solution.zones[pressed], solution.points[pressed], exact)
    law = exact.problem.foundation[0]
    soft = replace(law, compliance=NormalCompliance(0.99 * law.compliance.stiffness))
    for problem, order in ((exact.problem, 2), (replace(exact.problem, foundation=soft), 3)):
        assert RelativeError(Solve(problem, every, RectangleMesh(3, upper=(2, 1)), order=order), exact.displacement) > 1e-6


ASTER = dict(zip(greco_plate.REFERENCE, (2.8649e-5, 2.7269e-5, 2.2924e-5, 1.9929e-5, 1.5608e-5)))


@pytest.mark.slow
def test_plate_of_the_greco_group(some):
    """B11: the five values of code_aster to 2 per cent, all zones, and the work of an easy problem; half the friction slips."""
    def Slips(coefficient, n=32):
        disc = Discretization(greco_plate.Problem(coefficient=coefficient), some, greco_plate.Mesh(n), order=2)
        solution = SOLVERS[1].Solve(disc)
        return solution, np.array([solution.At(x, 0)[0] for x in ASTER])

    solution, slips = Slips(1.0)
    assert slips == pytest.approx(list(ASTER.values()), rel=0.02)
    assert set(solution.zones) == {SEPARATION, STICK, SLIP} and solution.levels[-1].iterations <= 7
    assert solution.levels[-1].solves <= 60 and solution.normalforce == pytest.approx(5e7 * greco_plate.SIDE, rel=1e-6)
    assert np.all(Slips(0.5, n=16)[1] > 1.1 * slips)
