"""Forces and moments: every element for DG, the whole body for H1; a flux without its penalty must fail."""

import os
import subprocess
import sys

import numpy as np
import pytest
from bodies import Distorted, Ring, Tilted
from ngsolve import CF, GridFunction, VectorH1, VectorL2, exp, sin, x, y
from problems import METHODS, ORTHOTROPIC, Example

from ngdgc import (Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, SemismoothNewtonSolver, TrescaFriction)
from ngdgc.exact import AffinePatch
from ngdgc.mesh.facets import Projected
from ngdgc.meshes import RectangleMesh
from ngdgc.solution.resultants import RigidBasis
from ngdgc.methods.symbolform import Clamped, Interior

DG = METHODS[:2]
FORCED = {"bodyforce": CF((10 * sin(3 * y), -20 * exp(x))), "dirichlet": {"right": CF((0.01 * y, 0.02 * x * y))},
          "roller": {"top": -0.01 * x}}


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("cells", ["triangle", "quad"])
@pytest.mark.parametrize("method", DG, ids=["auto", "30"])
def test_every_element_balances_force_and_moment(method, cells, order):
    disc = Discretization(Example(**FORCED), method, Distorted(cells), order=order)
    solution = SemismoothNewtonSolver().Solve(disc)
    assert np.abs(solution.ElementImbalance()).max() < 1e-10
    assert solution.GlobalImbalance() < 1e-10


@pytest.mark.parametrize("part", [Interior, Clamped])
@pytest.mark.parametrize("method", DG, ids=["auto", "30"])
def test_a_flux_without_its_penalty_does_not_balance(method, part, monkeypatch):
    disc = Discretization(Example(**FORCED), method, Distorted("triangle"), order=1, assembly="skeleton")
    solution = SemismoothNewtonSolver().Solve(disc)
    assert np.abs(solution.ElementImbalance()).max() < 1e-10
    del solution.testedfluxes
    monkeypatch.setattr(part, "Flux", part.Mean)
    assert np.abs(solution.ElementImbalance()).max() > 1e-3


@pytest.mark.parametrize("material", [HookeMaterial(E=900 * (1 + x), nu=0.3), ORTHOTROPIC], ids=["graded", "anisotropic"])
def test_balance_with_other_materials(material, method):
    problem = Example(20.0, material=material, **FORCED)
    solution = SemismoothNewtonSolver().Solve(Discretization(problem, method, RectangleMesh(4), order=2))
    assert solution.GlobalImbalance() < 1e-10


@pytest.mark.parametrize("order", [1, 3])
def test_conforming_reactions_balance_globally(order):
    disc = Discretization(Example(**FORCED), Conforming(), Distorted("triangle"), order=order)
    solution = SemismoothNewtonSolver().Solve(disc)
    assert solution.GlobalImbalance() < 1e-10
    support = next(resultant for resultant in solution.Resultants() if resultant.region == "right")
    force, moment = support.integrated
    # Integrated sigma n sees the singular corners: the same size, but it does not balance.
    size = np.linalg.norm(support.force)
    assert np.linalg.norm(force - support.force) < 0.5 * size and np.abs(moment - support.moment) < 0.5 * size
    total = sum(resultant.force for resultant in solution.Resultants())
    assert np.linalg.norm(total + force - support.force) > 1e-3 * size


def test_every_resultant_has_its_own_kind(method):
    """A roller with a tangential traction is both."""
    problem = Example(roller={"top": 0}, traction={"left": CF((5, 0)), "top": CF((3, 0))})
    solution = SemismoothNewtonSolver().Solve(Discretization(problem, method, RectangleMesh(3), order=1))
    kinds = sorted((resultant.kind, resultant.region) for resultant in solution.Resultants())
    assert kinds == [("dirichlet", "right"), ("foundation", "bottom"), ("roller", "top"), ("traction", "left"),
                     ("traction", "top")]
    assert next(r for r in solution.Resultants() if (r.kind, r.region) == ("traction", "top")).force == pytest.approx([3, 0])
    assert solution.GlobalImbalance() < 1e-10


def test_a_body_without_forces_balances(method):
    """All forces are round-off: nothing is out of balance."""
    exact = AffinePatch("open")
    solution = SemismoothNewtonSolver().Solve(Discretization(exact.problem, method, RectangleMesh(3), order=2))
    assert solution.GlobalImbalance() < 1e-10
    if method.discontinuous:
        assert np.abs(solution.ElementImbalance()).max() < 1e-10


def test_corner_shared_by_two_supports_is_counted_once():
    problem = Example(dirichlet={"right": CF((0, 0)), "top": CF((0, -0.01))})
    solution = SemismoothNewtonSolver().Solve(Discretization(problem, Conforming(), RectangleMesh(4), order=2))
    assert {resultant.region for resultant in solution.Resultants()} == {"right", "top", "left", "bottom"}
    assert solution.GlobalImbalance() < 1e-10


def test_resultants_of_known_loads(method):
    """Traction (200 (5 - y), -190) on x = 0, 0 < y < 1: force (900, -190); moment about the origin -int y t_x."""
    solution = SemismoothNewtonSolver().Solve(Discretization(Example(), method, RectangleMesh(4), order=2))
    load, foundation = (next(r for r in solution.Resultants() if r.region == region) for region in ("left", "bottom"))
    assert load.force == pytest.approx([900, -190], rel=1e-10)
    assert load.moment == pytest.approx([-200 * (5 / 2 - 1 / 3)], rel=1e-10)
    assert foundation.force[1] == pytest.approx(solution.normalforce, rel=1e-10)
    lever = solution.weights @ (solution.pressure * solution.points[:, 0])
    assert foundation.moment[0] == pytest.approx(lever, rel=1e-8)


def test_inclined_and_curved_boundaries_balance(method):
    inclined = ContactProblem(HookeMaterial(E=2000, nu=0.3), Foundation("bottom", NormalCompliance(200), gap=0.01,
                                                                        friction=CoulombFriction(0.2)),
                              roller={"left": 0.0}, dirichlet={"top": CF((0.01, -0.05))}, traction={"right": CF((5, 3))})
    solution = SemismoothNewtonSolver().Solve(Discretization(inclined, method, Tilted(0.7), order=2))
    assert solution.normalforce > 0.1 and solution.GlobalImbalance() < 1e-10
    around = Foundation("outer", NormalCompliance(50), friction=TrescaFriction(0.5))
    ring = ContactProblem(HookeMaterial(E=2000, nu=0.3), around, roller={"horizontal|vertical": 0},
                          traction={"inner": CF((x * 30, y * 40))})
    # Curve(order): the rigid rotation lies in the curved space, so moments balance too.
    solution = SemismoothNewtonSolver().Solve(Discretization(ring, method, Ring(3, 0.5), order=3))
    assert solution.normalforce > 1 and solution.GlobalImbalance() < 1e-10
    if method.discontinuous:
        assert np.abs(solution.ElementImbalance()).max() < 1e-10


def test_fluxes_are_single_valued_up_to_sign():
    """What one element receives through an interior facet, the other one gives: the interior part alone sums to zero."""
    disc = Discretization(Example(), InteriorPenalty(), RectangleMesh(3), order=1)
    solution = SemismoothNewtonSolver().Solve(disc)
    flux = disc.form.Fluxes(solution.gfu)[None]
    assert np.abs(RigidBasis(disc.space) @ flux).max() < 1e-9 and np.abs(flux).max() > 1


LARGE = """
from ngsolve import CF, GridFunction
from ngdgc import Conforming, ContactProblem, Discretization, Foundation, HookeMaterial, NormalCompliance, Solve
from ngdgc.meshes import BoxMesh

problem = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("bottom", NormalCompliance(1)), bodyforce=(0, 0, -1),
                         dirichlet={"top": CF((0, 0, 0))})
solution = Solve(Discretization(problem, Conforming(), BoxMesh(1, cells="hex"), order=6))
print(solution.GlobalImbalance())
try:
    GridFunction(solution.disc.space).Set(CF((1, 0, 0)))
except Exception as error:
    print(error)
"""


@pytest.mark.slow
def test_large_elements_balance(tmp_path):
    """Hexahedra of order 6 with one thread of NGSolve, whose own projection into the space overflows its heap."""
    done = subprocess.run([sys.executable, "-P", "-c", LARGE], cwd=tmp_path, env=os.environ | {"NGS_NUM_THREADS": "1"},
                          capture_output=True, text=True)
    imbalance, _, control = done.stdout.partition("\n")
    assert float(imbalance) < 1e-10, done.stderr
    assert "Local Heap overflow" in control


def test_projection_by_components_is_the_one_of_all():
    """Curved elements, and a function that is in no space; one component alone is another function."""
    function = CF((exp(x) * y, sin(3 * y)))
    for space in (VectorH1(Ring(3, 0.4), order=3), VectorL2(Ring(3, 0.4), order=2, dgjumps=True)):
        expected = GridFunction(space)
        expected.Set(function)
        found = Projected(space, function)
        assert np.abs(found - expected.vec.FV().NumPy()).max() < 1e-12
        assert np.abs(found - Projected(space, CF((exp(x) * y, 0)))).max() > 0.1
