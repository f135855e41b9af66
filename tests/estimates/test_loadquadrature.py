"""What the quadrature of loads that jump inside of elements does to a solution is part of its error."""

import numpy as np
import pytest
from ngsolve import CF, GridFunction, IfPos, cos, dx, x, y

from ngdgc import (LDG, BassiEtAl, ContactProblem, Discretization, EstimateError, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, Solve)
from ngdgc.errors import EnergyError
from ngdgc.estimates import error
from ngdgc.estimates.loadquadrature import LoadQuadrature
from ngdgc.meshes import UnitMesh
from ngdgc.methods.symbolform import Coefficients
from ngdgc.traces import ThreeZones


def Loaded(order=2, cells="quad", **loads):
    """A square that touches nothing, clamped on its left side."""
    problem = ContactProblem(HookeMaterial(E=10, nu=0.3), Foundation("bottom", NormalCompliance(1), gap=9),
                             dirichlet={"left": (0, 0)}, **loads)
    return Solve(Discretization(problem, InteriorPenalty(), UnitMesh(4, cells), order=order))


@pytest.mark.parametrize("method", [InteriorPenalty(), LDG(), BassiEtAl(form="lifting")], ids=repr)
def test_a_force_that_jumps_in_a_column_of_elements_is_not_missed(method, monkeypatch):
    """Nearly all of the error is that of the load there; without this part the estimate is a third of it."""
    exact = ThreeZones()
    solution = Solve(Discretization(exact.problem, method, UnitMesh(7, "quad"), order=3))
    true = EnergyError(solution, exact.displacement)
    assert 0.9 < EstimateError(solution).value / true < 1.3
    monkeypatch.setattr(error, "LoadQuadrature", lambda solution, value: np.zeros(solution.disc.mesh.ne))
    assert EstimateError(solution).value / true < 0.4


@pytest.mark.parametrize("cells", ["triangle", "quad"])
def test_it_is_the_energy_of_what_an_exact_load_changes(cells):
    """The load of a function of V_h is exact: here of the projection of the force by a rule that cuts elements at the jump."""
    force = CF((IfPos(x - 0.4, 3, 1), y))
    solution = Loaded(cells=cells, bodyforce=force)
    space = solution.disc.space
    exact = GridFunction(space)
    exact.vec.FV().NumPy()[:] = Coefficients(force * space.TestFunction() * dx(bonus_intorder=42))
    space.SolveM(exact.vec)
    d = solution.vector - Loaded(cells=cells, bodyforce=exact).vector
    shares = LoadQuadrature(solution, 0.0)
    assert shares.sum() == pytest.approx(d @ solution.disc.Multiply(d), rel=1e-6) and shares.min() >= 0
    assert shares.sum() > 1e-5 * 2 * solution.energy      # control: it is no round-off


def test_no_share_is_negative_where_the_load_errs_against_the_motion():
    """Of two jumps the smaller one is integrated with the other sign: their sum is kept."""
    solution = Loaded(bodyforce=CF((IfPos(x - 0.4, 3, 1) - IfPos(x - 0.9, 2, 0), y)))
    shares, both = LoadQuadrature(solution, 0.0), CF((IfPos(x - 0.9, -2, 0), 0))
    alone = LoadQuadrature(Loaded(bodyforce=both), 0.0)
    assert shares.min() >= 0 and np.all(shares[alone > 0.01 * alone.max()] > 0)


def test_smooth_loads_ask_for_nothing():
    solution = Loaded(order=1, bodyforce=(cos(x + 2 * y), 0), traction={"top": (0, cos(3 * x))})
    applied = solution.disc.solves
    assert np.all(LoadQuadrature(solution, EstimateError(solution).value) == 0) and solution.disc.solves == applied


def test_tractions_that_jump_inside_of_sides():
    inside, between = (LoadQuadrature(Loaded(traction={"top": (0, IfPos(x - place, 1, 0))}), 0.0).sum() for place in (0.4, 0.5))
    assert inside > 1e-6 and between < 1e-12 * inside
