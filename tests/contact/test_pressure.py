"""Pressure and friction are values of the law: exactly 0 where it has none, never negative, else the traction."""

import numpy as np
import pytest
from netgen.occ import Circle, MoveTo
from ngsolve import IfPos, specialcf, x, y
from problems import Pressed

from ngdgc import (LDG, Conforming, ContactProblem, ContactSolution, CoulombFriction, Discretization, Foundation, HookeMaterial,
                   InteriorPenalty, NormalCompliance, NotConvergedError, SemismoothNewtonSolver, Solve, TrescaFriction,
                   UzawaSolver)
from ngdgc.contact.graph import SEPARATION
from ngdgc.meshes import BoxMesh, RectangleMesh, ShapeMesh
from ngdgc.plots import ComparisonFigure


def Parts(solution):
    """(p_n, sigma_t) as they are in the traction."""
    contact = solution.disc.contact
    return contact.Normal(solution.traction), -contact.Tangential(solution.traction)


def CheckPressure(solution):
    """It is 0 exactly in separation, positive elsewhere, and the normal part of the traction where that is."""
    apart, normal = solution.zones == SEPARATION, Parts(solution)[0]
    assert 0 < apart.sum() < len(apart)
    assert np.array_equal(solution.pressure > 0, ~apart) and np.all(solution.pressure[apart] == 0)
    pressed = ~apart & (normal > 0)
    assert np.array_equal(solution.pressure[pressed], normal[pressed])
    assert solution.normalforce == solution.weights @ solution.pressure
    return normal[apart]


@pytest.mark.parametrize("method", [InteriorPenalty(), LDG(), Conforming()], ids=lambda method: method.name)
def test_a_roller_of_rubber_touches_where_its_pressure_is(method):
    shape = (Circle((0, 0), 35).Face() - Circle((0, 0), 17.5).Face()) * MoveTo(-35, -35).Rectangle(70, 35).Face()
    for edge in shape.edges:
        edge.name = "cut" if abs(edge.center.y) < 1e-6 else "hub" if np.hypot(edge.center.x, edge.center.y) < 25 else "out"
    n = specialcf.normal(2)
    problem = ContactProblem(HookeMaterial(E=0.275, nu=0.4995), dirichlet={"hub": (0, -1)}, foundation=Foundation(
        "out", NormalCompliance(5), gap=(y + 35) / IfPos(-n[1] - 0.2, -n[1], 0.2)))
    solution = Solve(Discretization(problem, method, ShapeMesh(shape, 6, order=2), order=2))
    CheckPressure(solution)
    # With round-off in the traction, in positive values too, no zone could be read from it.
    noise = 1e-14 * np.random.default_rng(1).standard_normal(solution.traction.shape)
    noisy = ContactSolution(solution.disc, solution.vector, solution.traction + noise * np.abs(solution.traction).max())
    assert np.any(CheckPressure(noisy) > 0)
    assert np.all(solution.friction == 0)
    # The traction is what equilibrium was solved with.
    disc = solution.disc
    pull = disc.contact.Load(solution.traction)
    residual = (disc.Multiply(solution.vector) - disc.load + pull)[np.array(disc.space.FreeDofs(), dtype=bool)]
    assert np.abs(residual).max() < 1e-8 * np.abs(pull).max()


@pytest.mark.slow
@pytest.mark.parametrize("friction", [None, CoulombFriction(0.3), TrescaFriction(0.2)], ids=["none", "coulomb", "tresca"])
@pytest.mark.parametrize("mesh, u", [(RectangleMesh(8), (0.03, -0.02)), (BoxMesh(3), (0.03, 0.01, -0.02))], ids=["2D", "3D"])
def test_friction_is_kept_where_the_law_has_it(mesh, u, friction):
    foundation = Foundation("bottom", NormalCompliance(1e5), friction=friction, gap=0.02 * (2 * x - 0.6))
    solution = Pressed(foundation, mesh, u)
    CheckPressure(solution)
    apart, given = solution.zones == SEPARATION, Parts(solution)[1]
    if isinstance(friction, TrescaFriction):        # the bound acts in separation too, and the body would not balance without
        assert np.array_equal(solution.friction, given)
        assert np.linalg.norm(solution.friction[apart], axis=1).max() > 0.19
    else:
        assert np.all(solution.friction[apart] == 0)
        assert np.array_equal(solution.friction[~apart], given[~apart] if friction else 0 * given[~apart])
    assert solution.GlobalImbalance() < 1e-10


@pytest.mark.parametrize("solver", [SemismoothNewtonSolver(maxiter=1), UzawaSolver(maxiter=2), UzawaSolver(maxiter=5)],
                         ids=["newton-1", "uzawa-2", "uzawa-5"])
def test_iterates_on_their_way_have_no_negative_pressure(solver):
    stiff = 200 if isinstance(solver, UzawaSolver) else 1e4
    foundation = Foundation("bottom", NormalCompliance(stiff), friction=CoulombFriction(0.5), gap=0.02 * (2 * x - 0.6))
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, dirichlet={"top": (0.03, -0.02)})
    with pytest.raises(NotConvergedError) as found:
        solver.Solve(Discretization(problem, InteriorPenalty(), RectangleMesh(8)))
    CheckPressure(found.value.solution)


@pytest.mark.parametrize("friction", [None, TrescaFriction(1)], ids=["none", "tresca"])
def test_a_comparison_draws_no_friction_where_there_is_none(friction):
    """Without friction the curve is 0 whatever round-off is in the traction; round-off alone gets wide axes, more its own."""
    solution = Pressed(Foundation("bottom", NormalCompliance(1e3), friction=friction), RectangleMesh(4))
    # As a frictionless one has it on an inclined boundary.
    traction = solution.traction * [0, 1] + [1e-15, 0]
    rough = ContactSolution(solution.disc, solution.vector * 0, traction)
    axes = ComparisonFigure({"a": rough, "b": rough}).axes[1]
    assert np.all(Parts(rough)[1][:, 0] != 0) and np.abs(axes.get_ylim()).max() > 0.01
    assert all(np.all(line.get_ydata() == 0) for line in axes.lines[:2]) == (friction is None)
    shown = ContactSolution(solution.disc, solution.vector * 0, traction + [1e-3, 0])
    assert friction is None or np.abs(ComparisonFigure({"a": shown}).axes[1].get_ylim()).max() < 0.01
