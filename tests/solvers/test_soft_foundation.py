"""A body that only its foundation holds costs the same on any foundation, however soft against the body."""

import numpy as np
import pytest
from ngsolve import CF, IfPos, VectorH1, VectorL2, x
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh

from ngdgc import (LDG, BassiEtAl, Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial,
                   InteriorPenalty, NormalCompliance, NotConvergedError, SemismoothNewtonSolver, Solve)
from ngdgc.mesh.facets import Free, Projected, RigidMotions
from ngdgc.meshes import UnitMesh
from ngdgc.linear.motions import ProjectedMotions
from ngdgc.solvers.newton import setting
from ngdgc.solvers.newton.holding import Holding
from ngdgc.solvers.newton.stiffened import StiffenedBody

PRESSED = {"roller": {"left": 0}, "traction": {"top": (0, -1)}}
BENT = {"roller": {"left": 0}, "traction": {"right": (0, -1)}}
LIFTED = {"friction": CoulombFriction(0.3), "traction": {"top": CF((0, IfPos(x - 200, -1, 0)))}}


def Steel(k, method=None, *, friction=None, n=15, quads=True, **loads):
    """A steel plate 300 x 20 [N, mm] on a foundation of stiffness k, which sinks freely."""
    foundation = Foundation("bottom", NormalCompliance(k), friction=friction)
    problem = ContactProblem(HookeMaterial(E=2.1e5, nu=0.3), foundation, **loads)
    mesh = MakeStructured2DMesh(quads=quads, nx=n, ny=2, mapping=lambda s, t: (300 * s, 20 * t))
    return Discretization(problem, method or InteriorPenalty(), mesh, order=2)


def Cost(solution):
    return sum(level.solves for level in solution.levels)


@pytest.mark.slow
@pytest.mark.parametrize("method", [InteriorPenalty(), BassiEtAl(), LDG(form="lifting"), Conforming()])
def test_pressed_plate_sinks_evenly(method):
    """The stress is -1 along y: the pressure is 1 everywhere, whatever k is."""
    costs = []
    for k in (5, 0.05):
        solution = Solve(Steel(k, method, **PRESSED))
        costs.append(Cost(solution))
        assert np.abs(solution.pressure - 1).max() < 1e-6 and solution.normalforce == pytest.approx(300, rel=1e-7)
    assert costs[1] <= 3 * costs[0]


@pytest.mark.slow
@pytest.mark.parametrize(("loads", "force"), [(BENT, 20), (LIFTED, 100)])
def test_beam_and_lifting_footing_cost_the_same(loads, force):
    costs = []
    for k in (500, 5, 0.05, 5e-4):
        solution = Solve(Steel(k, **loads))
        costs.append(Cost(solution))
        assert solution.normalforce == pytest.approx(force, rel=1e-7)
        assert loads is BENT or np.any(solution.zones == 0)
    assert max(costs[1:]) <= 3 * min(costs)


def Steps(k):
    return len(SemismoothNewtonSolver().Solve(Steel(k, **LIFTED)).history)


@pytest.mark.slow
def test_slip_counts_on_any_foundation(monkeypatch):
    """The footing sinks by up to 1e8 of what it slips, and 22 points lift off: 3 to 5 steps of Newton's method, always."""
    assert max(Steps(k) for k in (50, 0.5, 5e-3, 5e-4, 5e-5, 5e-6)) <= 6
    # Measured by displacements alone, slip is nothing until the body has come to rest, and then every step is too long,
    # unless the matrix holds it where all points slip.
    monkeypatch.setattr(setting, "LOOSE", setting.FLOOR)
    monkeypatch.setattr(StiffenedBody, "Merit", lambda self, F: float(np.sum(self.setting.contact.weights[:, None] * F ** 2)))
    with pytest.raises((AssertionError, NotConvergedError)):
        assert max(Steps(k) for k in (5e-4, 5e-5)) <= 12


def Slab(k, inverse="auto"):
    """A plate 300 x 300 x 20 on a foundation with friction, loaded on one half, so that part of it lifts off."""
    foundation = Foundation("bottom", NormalCompliance(k), friction=CoulombFriction(0.3))
    problem = ContactProblem(HookeMaterial(E=2.1e5, nu=0.3), foundation, traction={"top": CF((0, 0, IfPos(x - 150, -1, 0)))})
    mesh = MakeStructured3DMesh(nx=4, ny=4, nz=1, mapping=lambda s, t, u: (300 * s, 300 * t, 20 * u))
    return Discretization(problem, InteriorPenalty(), mesh, order=1, inverse=inverse)


@pytest.mark.slow
def test_forces_balance_where_the_inverse_is_an_iteration(monkeypatch):
    """To 1e-11; where motions are not known to be rigid, to the round-off of A times a displacement of 1e5 only, 3e-8."""
    for k in (0.05, 5e-6):
        assert SemismoothNewtonSolver().Solve(Slab(k, "iterative")).normalforce == pytest.approx(45000, rel=2e-10)
    monkeypatch.setattr(Discretization, "motions", ())
    with pytest.raises((AssertionError, NotConvergedError)):
        assert SemismoothNewtonSolver().Solve(Slab(5e-6, "iterative")).normalforce == pytest.approx(45000, rel=2e-9)


@pytest.mark.slow
def test_footing_in_3d_costs_the_same(monkeypatch):
    """About 50 products each; twice as many where stick is as stiff in the matrix as that of a body that is held."""
    costs = []
    for k in (5, 0.05, 5e-4):
        solution = Solve(Slab(k))
        costs.append(Cost(solution))
        assert solution.normalforce == pytest.approx(45000, rel=1e-10) and np.any(solution.zones == 0)
    assert max(costs) <= 1.5 * min(costs)
    monkeypatch.setattr(setting, "STICKING", 100)
    assert Cost(Solve(Slab(0.05))) > 1.5 * max(costs)


@pytest.mark.slow
def test_stiffness_of_the_body_would_not_hold_it(monkeypatch):
    """dt/dq of at least 1/100 of the body's own stiffness, with it in the matrix: steps of a thousandth of what is needed."""
    assert len(SemismoothNewtonSolver().Solve(Steel(5e-4, **PRESSED)).history) <= 2
    Own = Holding.__init__

    def Bodily(self, disc, scale):
        Own(self, disc, scale)
        self.slope = np.broadcast_to(np.eye(2), self.slope.shape)
    monkeypatch.setattr(Holding, "__init__", Bodily)
    with pytest.raises(NotConvergedError):
        SemismoothNewtonSolver(maxiter=30).Solve(Steel(5e-4, **PRESSED))


@pytest.mark.parametrize("method", [InteriorPenalty(), Conforming()])
def test_forces_balance_however_soft_the_foundation_is(method, monkeypatch):
    """The plate sinks by 2e7, which is the round-off of all else, and too much where motions are not known to be rigid."""
    assert Solve(Steel(5e-8, method, **PRESSED)).normalforce == pytest.approx(300, rel=1e-12)
    monkeypatch.setattr(Discretization, "motions", ())
    with pytest.raises((AssertionError, NotConvergedError)):
        assert Solve(Steel(5e-8, method, **PRESSED)).normalforce == pytest.approx(300, rel=1e-7)


def test_motions_are_those_that_nothing_resists():
    assert Steel(1, **PRESSED).motions.shape[0] == 1        # a roller leaves one translation
    free, held = Steel(1, **LIFTED), Steel(1, Conforming(), dirichlet={"left": (0, 0)})
    assert free.motions.shape[0] == 3 and held.motions.shape[0] == 0
    assert max(np.abs(free.Multiply(motion)).max() for motion in free.motions) < 1e-10


@pytest.mark.parametrize("space", [VectorL2, VectorH1])
@pytest.mark.parametrize("dim", [2, 3])
def test_motions_made_of_projections_of_1_and_x_are_those_of_the_rigid_motions(dim, space):
    mesh = UnitMesh(2, "quad" if dim == 2 else "prism")
    clamped = space(mesh, order=2, **({"dirichlet": "top"} if space is VectorH1 else {}))
    expected = np.array([Projected(clamped, motion) for motion in RigidMotions(dim)])
    # Round-off of NGSolve's mass matrices of single elements.
    assert np.abs(ProjectedMotions(clamped, np.zeros(dim)) - expected).max() < 1e-13
    # About another centre they differ by translations, and no less.
    shifted = ProjectedMotions(clamped, np.full(dim, 0.5))
    assert np.abs(shifted[dim:] - expected[dim:]).max() > 0.1
    assert np.linalg.matrix_rank(np.concatenate([shifted, expected]), tol=1e-10) == len(expected)
    assert np.array_equal(Free(clamped), list(clamped.FreeDofs())) and np.all(Free(clamped)) == (space is VectorL2)
