"""Benchmarks B1, B5, B6, B8 and B11, solved by `dense.DenseNewton`; each with a datum changed so that the check must fail."""

from dataclasses import replace

import numpy as np
import pytest
from checks import SameZones
from dense import DenseNewton

from ngdgc import LDG, Conforming, CoulombFriction, Discretization, InteriorPenalty, UzawaSolver
from ngdgc.cases import breaking_beam, greco_plate, rigid_limit
from ngdgc.errors import EnergyError, L2Error, Rates
from ngdgc.exact import CubicCompliance, WinklerColumn
from ngdgc.contact.graph import Distance
from ngdgc.meshes import RectangleMesh
from ngdgc.traces import RigidLimit, ThreeZones

THREE = [LDG(), InteriorPenalty(), Conforming()]


@pytest.fixture(params=THREE, ids=lambda method: method.name)
def some(request):
    return request.param


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [0.1, 100.0, 1e6, 1e12])
@pytest.mark.parametrize("exponent", [1, 1.5, 2])
def test_column_under_pressure(stiffness, exponent, some):
    """Soft and rigid foundations that alone hold the column; deeper by 0.01 if the gap is."""
    exact = WinklerColumn(stiffness=stiffness, exponent=exponent, load="pressure")
    solution = DenseNewton(Discretization(exact.problem, some, RectangleMesh(3), order=1), scale=100.0)
    size = 1 + (20 / stiffness) ** (1 / exponent)
    # Round-off of A, 1e-16 times a penalty of 1e5, against the stiffness that holds the column.
    assert L2Error(solution, exact.displacement) < 1e-10 * size * max(1, 1e3 / stiffness)
    # The same round-off, of the displacement against the pressure of 20.
    assert solution.pressure == pytest.approx(20, rel=1e-9 * max(1, size / 20))
    deeper = WinklerColumn(stiffness=stiffness, exponent=exponent, load="pressure", gap=0.11)
    assert L2Error(solution, deeper.displacement) == pytest.approx(0.01, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [None, CoulombFriction(0.4)])
def test_cubic_solution_is_found_at_order_three(friction, some):
    exact = CubicCompliance(friction=friction)
    solution, low = (DenseNewton(Discretization(exact.problem, some, RectangleMesh(3, upper=(2, 1)), order=order), scale=1e4)
                     for order in (3, 2))
    assert L2Error(solution, exact.displacement) < 1e-11        # of 0.1
    pressed = solution.points[:, 0] > 0         # p_n(x = 0) = 0
    assert SameZones(solution.zones[pressed], solution.points[pressed], exact)
    assert L2Error(low, exact.displacement) > 1e-5


@pytest.mark.slow
def test_three_zones_are_found(some):
    exact = ThreeZones()
    solution = DenseNewton(Discretization(exact.problem, some, RectangleMesh(4), order=4), scale=1e3)
    assert L2Error(solution, exact.displacement) < 1e-13        # of 5e-3
    assert SameZones(solution.zones, solution.points, exact)


@pytest.mark.slow
def test_plate_of_the_greco_group(some):
    """u_x at five points: 3 per cent around the published values, and a conforming penalty solution to its digits."""
    penalty = np.array([2.860, 2.722, 2.286, 1.980, 1.541]) * 1e-5

    def Slips(**data):
        disc = Discretization(greco_plate.Problem(**data), some, greco_plate.Mesh(16), order=2)
        solution = DenseNewton(disc, scale=1.3e11 / greco_plate.SIDE)
        return solution, np.array([solution.At(x, 0)[0] for x in greco_plate.REFERENCE])

    solution, slips = Slips()
    assert slips == pytest.approx(list(greco_plate.REFERENCE.values()), rel=0.03)
    assert slips == pytest.approx(penalty, rel=2e-3)
    assert solution.normalforce == pytest.approx(5e7 * greco_plate.SIDE, rel=1e-6)
    assert set(solution.zones.tolist()) == {0, 1, 2}
    assert np.all(Slips(stiffness=1e14)[1] < 0.99 * slips)          # a plane that is not rigid
    assert np.all(Slips(coefficient=0.5)[1] > 1.1 * slips)          # half the friction


@pytest.mark.slow
def test_beam_on_a_foundation_that_breaks(some):
    """Two solutions of one problem: unbroken, with the values of the peer where there is no friction, and broken."""
    def Unbroken(friction):
        mesh = breaking_beam.Mesh(8)
        disc = Discretization(breaking_beam.Problem(np.inf, friction), some, mesh, order=2)
        solution = DenseNewton(disc, scale=20.0)
        law = Discretization(breaking_beam.Problem(0.1, friction), some, mesh, order=2).contact
        return solution, Distance(law, solution.displacement, solution.traction).distance.max()

    frictionless, distance = Unbroken(0.0)
    assert distance < 1e-10 and frictionless.penetration.max() == pytest.approx(0.0447, rel=0.01)
    for x, peer in breaking_beam.PEER.items():
        assert -frictionless.At(x, 0) == pytest.approx(peer, abs=2e-3)
    rubbing, distance = Unbroken(8.0)
    assert distance < 1e-10
    assert np.all(rubbing.At(2, 0)[0] > 0.7 * frictionless.At(2, 0)[0])      # displacements are negative: held back
    broken = breaking_beam.Main(method=some, order=2, n=8)
    assert broken.converged and broken.penetration.max() > 1 and broken.ZoneLengths()["separation"] > 1.5


@pytest.mark.slow
def test_rate_towards_the_rigid_foundation(some):
    stiffnesses = 10.0 ** np.arange(6, 13)

    class Solver:
        def Solve(self, disc, callback):
            return DenseNewton(disc, scale=2500.0)

    errors, rates = rigid_limit.Study(stiffnesses, method=some, solver=Solver())
    assert rates == pytest.approx(1, abs=0.05) and rates[-1] == pytest.approx(1, abs=1e-3)
    assert errors[-1] < 1e-8
    # Control: towards the limit of a problem with another friction coefficient nothing converges.
    problem = RigidLimit(stiffness=1e9).problem
    other = RigidLimit(stiffness=1e9, coefficient=0.5)
    wrong = [EnergyError(DenseNewton(Discretization(replace(problem, foundation=replace(problem.foundation[0], compliance=law)),
                                                    some, RectangleMesh(4), order=4), scale=2500.0), other.displacement)
             for law in (RigidLimit(stiffness=k).problem.foundation[0].compliance for k in (1e8, 1e9))]
    assert abs(Rates(wrong, ratio=10)[0]) < 0.01


@pytest.mark.slow
def test_study_of_the_rigid_foundation_takes_a_solver():
    """The explicit iteration does soft ones: the error falls, not yet like 1/k."""
    errors, rates = rigid_limit.Study([250, 1000], method=Conforming(), solver=UzawaSolver(tol=1e-8))
    assert errors[1] < errors[0] and 0 < rates[0] < 0.5
