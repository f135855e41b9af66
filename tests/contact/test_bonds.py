"""Bonded joints: they pull up to a tension, open at it, and have the cohesion that friction makes of it."""

import numpy as np
import pytest
from bodies import Layers, Stacked
from ngsolve import IfPos, Parameter, x

from ngdgc import (LDG, BassiEtAl, Conforming, ContactProblem, CoulombFriction, Discretization, HookeMaterial, Joint,
                   NormalCompliance, SemismoothNewtonSolver, Solve, SolveHistory)
from ngdgc.contact.graph import ContactGraph

K, T, MU = 5000.0, 20.0, 0.5
BODIES = {2: Layers(2), 3: Stacked()}
METHODS = pytest.mark.parametrize("method", [LDG(), BassiEtAl(form="lifting"), Conforming()], ids=repr)


def Column(dim, method, *, exponent=1, order=2, tension=T, **load):
    walls = "left|right" if dim == 2 else "left|right|front|back"
    joint = Joint("mid", NormalCompliance(K, exponent), friction=CoulombFriction(MU), tension=tension)
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), joint, roller={walls: 0},
                             **({"dirichlet": {"bottom": (0,) * dim}} | load))
    return SemismoothNewtonSolver(tol=1e-13).Solve(Discretization(problem, method, BODIES[dim], order=order))


@METHODS
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("exponent", [1, 1.5])
def test_bond_pulls_as_it_presses_and_opens_at_its_tension(method, dim, exponent):
    """p = k (r + r_0)^m - T with k r_0^m = T: the jump of a column pulled and pressed; beyond T it follows at T."""
    up = (0,) * (dim - 1)
    rest = (T / K) ** (1 / exponent)
    for pressure in (-0.95 * T, -5, 30):
        solution = Column(dim, method, exponent=exponent, traction={"top": (*up, -pressure)})
        assert solution.pressure == pytest.approx(pressure, rel=1e-10)
        assert solution.penetration == pytest.approx(((pressure + T) / K) ** (1 / exponent) - rest, rel=1e-9)
        assert not np.any(solution.zones == 0) and solution.GlobalImbalance() < 1e-11
        assert solution.Force("mid", material="soft")[-1] == pytest.approx(-pressure, rel=1e-10)
    opened = Column(dim, method, exponent=exponent, dirichlet={"bottom": (0,) * dim, "top": (*up, 0.1)})
    assert opened.pressure == pytest.approx(-T, rel=1e-12) and np.all(opened.zones == 0)
    # What is left of .1 when both layers are stretched by T.
    stretch = T / (1000 * 0.7 / (1.3 * 0.4))
    assert opened.penetration == pytest.approx(stretch - 0.1, rel=1e-10)
    assert np.all(opened.friction == 0)


@METHODS
def test_friction_makes_cohesion_of_tension(method):
    """Sheared without pressure a bond sticks up to mu T, under tension up to mu (T + p): Mohr and Coulomb's cone."""
    joint = Joint("mid", NormalCompliance(K), friction=CoulombFriction(MU), tension=T)

    def Sheared(slide, pressure):
        # Both parts keep their shape: prescribed on all sides but the joint's two.
        problem = ContactProblem(HookeMaterial(E=1e6, nu=0.0), joint,
                                 dirichlet={"bottom": (0, 0), "top": (slide, -pressure / K - pressure / 1e6)})
        return Solve(Discretization(problem, method, BODIES[2], order=1), tol=1e-12)

    for pressure in (0.0, -12.0, 8.0):
        stick, slip = Sheared(1e-6, pressure), Sheared(1e-2, pressure)
        middle = np.abs(slip.points[:, 0] - 0.5) < 0.2
        assert np.all(stick.zones == 1) and np.all(slip.zones == 2)
        assert np.linalg.norm(slip.friction, axis=1) == pytest.approx(MU * (T + slip.pressure), rel=1e-9)
        assert slip.pressure[middle] == pytest.approx(pressure, abs=2.0)


def test_bond_is_elastic_in_a_history():
    """Opened and closed again without friction the work is back; within the bond the trapezoidal rule is exact."""
    t = Parameter(0)
    joint = Joint("mid", NormalCompliance(K), tension=T * (1 + 0 * x))
    up = IfPos(t - 1, 2 - t, t)
    def History(largest, count):
        problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), joint, roller={"left|right": 0},
                                 dirichlet={"bottom": (0, 0), "top": (0, largest * up)})
        disc = Discretization(problem, LDG(), BODIES[2])
        return SolveHistory(disc, parameter=t, times=np.linspace(0, 2, 2 * count + 1))

    within, beyond = History(0.01, 4), History(0.06, 16)
    assert within.forces["mid"][4, 1] > 5 and within.work == pytest.approx(within.energy, abs=1e-12)
    assert beyond.forces["mid"][16, 1] == pytest.approx(T, rel=1e-9)
    assert beyond.energy[16] == pytest.approx(beyond.work[16], rel=2e-3)      # the kink lies within an increment
    assert beyond.work[-1] == pytest.approx(0, abs=1e-10) and beyond.energy[-1] == pytest.approx(0, abs=1e-10)


def test_without_tension_nothing_changes():
    plain, none = (Column(2, LDG(), traction={"top": (0, -30)}, tension=tension) for tension in (0.0, 0 * x))
    assert plain.vector.tolist() == none.vector.tolist() and plain.disc.contact.parts[0].bond is None
    weaker = Column(2, LDG(), traction={"top": (0, 10)}, tension=T * (1 + x))
    assert weaker.pressure == pytest.approx(-10) and np.ptp(weaker.disc.contact.tension) > 10


@pytest.mark.parametrize("exponent", [1, 1.5])
def test_graph_of_a_bond_is_parametrised_and_differentiated(exponent):
    """t + gamma u = q, the law between them, and dt/dq and p_n' against central differences, away from kinks."""
    joint = Joint("mid", NormalCompliance(K, exponent), friction=CoulombFriction(MU), tension=T)
    disc = Discretization(ContactProblem(HookeMaterial(E=1000, nu=0.3), joint, dirichlet={"bottom": (0, 0), "top": (0, 0)}),
                          LDG(), BODIES[2], order=3)
    contact, gamma, step = disc.contact, 800.0, 1e-4
    q = np.random.default_rng(1).uniform(-3 * T, 3 * T, contact.normals.shape)
    graph = ContactGraph(contact, gamma)
    point = graph.At(q)
    assert point.traction + gamma * point.displacement == pytest.approx(q, abs=1e-11 * T)
    r, p = contact.Penetration(point.displacement), contact.Normal(point.traction)
    assert contact.Pressure(r) == pytest.approx(p, abs=1e-9 * T)
    assert p.min() == pytest.approx(-T) and p.max() > 0 and set(point.zones) == {0, 1, 2}
    sliding = point.zones == 2
    assert np.linalg.norm(contact.Tangential(point.traction), axis=1)[sliding] == pytest.approx(MU * (p + T)[sliding])
    for axis in range(2):
        ahead, behind = (graph.At(q + sign * step * np.eye(2)[axis]) for sign in (1, -1))
        same = (ahead.zones == point.zones) & (behind.zones == point.zones)
        slope = (ahead.traction - behind.traction)[same] / (2 * step)
        assert same.sum() > 5 and slope == pytest.approx(point.derivative[same][:, :, axis], abs=1e-5)
    pressed = r + contact.depth > 1e-4
    slope = (contact.Pressure(r + 1e-7) - contact.Pressure(r - 1e-7)) / 2e-7
    assert contact.PressureDerivative(r)[pressed] == pytest.approx(slope[pressed], rel=1e-4)
