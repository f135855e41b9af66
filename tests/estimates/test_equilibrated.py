"""The equilibrated stress: in balance with the loads to round-off, continuous, the traction of the foundation on Gamma_C."""

import numpy as np
import pytest
from bodies import RING, Crossed, Cube, Distorted, Ring
from ngsolve import CF, VOL, GridFunction, Integrate, x
from problems import GRADED, ORTHOTROPIC, TEN, Loaded, Solved

from ngdgc import (LDG, BrezziEtAl, ContactProblem, CoulombFriction, Foundation, HookeMaterial, IncompleteInteriorPenalty,
                   InteriorPenalty, NonsymmetricInteriorPenalty, NormalCompliance, WeaklyOverPenalised)
from ngdgc.estimates.equilibrated import EquilibratedStress
from ngdgc.mesh.quadrature import BoundaryQuadrature
from ngdgc.meshes import RectangleMesh

MESHES = {"triangle": lambda: RectangleMesh(2), "quad": lambda: Distorted("quad"), "mixed": lambda: Distorted("mixed"),
          "tet": lambda: Cube("tet"), "hex": lambda: Cube("hex"), "prism": lambda: Cube("prism")}
METHODS = [*TEN, NonsymmetricInteriorPenalty(), IncompleteInteriorPenalty(), WeaklyOverPenalised()]
KINDS = LDG(), LDG(form="lifting"), BrezziEtAl(form="lifting"), NonsymmetricInteriorPenalty()


def Imbalance(solution, theta=None):
    """Largest |int_K (div s + f_1).v| for random v in V_h(K), relative to that of f_1."""
    stress, disc = EquilibratedStress(solution), solution.disc
    if theta is not None:
        stress._theta = theta
    v = GridFunction(disc.space)
    v.vec.FV().NumPy()[:] = np.random.default_rng(3).standard_normal(disc.space.ndof)
    loads = np.array(Integrate(CF(disc.problem.bodyforce) * v, disc.mesh, VOL, order=2 * disc.order + 4, element_wise=True))
    found = np.full(disc.mesh.ne, np.nan)
    for batch in stress.Batches():
        values = np.asarray(v(batch.points.ravel())).reshape(batch.divergence.shape)
        found[batch.group.elements] = batch.Integral((batch.divergence * values).sum(axis=2))
    return np.abs(found + loads).max() / np.abs(loads).max()


def Combinations():
    """All methods on all cells at order 1, in the plane at order 2; of higher orders one of each kind of form."""
    for cells in MESHES:
        plane = cells in ("triangle", "quad")
        for order, methods in ((1, METHODS), (2, METHODS[:-1] if plane else KINDS), (3, KINDS if plane else ())):
            for method in methods:
                yield pytest.param(method, cells, order, marks=[] if plane and order == 1 else pytest.mark.slow)


@pytest.mark.parametrize("method, cells, order", list(Combinations()))
def test_divergence_is_the_load(method, cells, order):
    mesh = MESHES[cells]()
    solution = Solved(Loaded(mesh), method, mesh, order)
    # Round-off of penalties against loads.
    assert Imbalance(solution) < 1e-9
    if EquilibratedStress(solution)._theta:
        assert Imbalance(solution, theta=0) > 1e-4      # control: without the jumps it is not


def test_divergence_is_the_load_at_high_orders():
    """Functions that were not orthonormal would be nearly dependent, and leave 5e-4."""
    mesh = RectangleMesh(1)
    assert Imbalance(Solved(Loaded(mesh), LDG(), mesh, 8)) < 1e-8


@pytest.mark.parametrize("form", ["edge", "lifting"])
@pytest.mark.parametrize("material", [GRADED, ORTHOTROPIC], ids=["graded", "orthotropic"])
def test_divergence_is_the_load_in_any_material(material, form):
    mesh = Distorted("mixed")
    # C eps(V_h) is not in Q_h: here the forms have different jumps.
    problem = ContactProblem(material, Foundation("bottom", NormalCompliance(100), friction=CoulombFriction(0.3)),
                             dirichlet={"top": (0.05, -0.1)}, roller={"right": -0.01}, bodyforce=(1, -5))
    assert Imbalance(Solved(problem, LDG(form=form), mesh)) < 1e-9


@pytest.mark.parametrize("form", ["edge", "lifting"])
def test_divergence_is_the_load_on_curved_elements(form):
    problem = ContactProblem(ORTHOTROPIC, Foundation("inner", NormalCompliance(50)), dirichlet={"outer": CF((-0.1 * x, 0))},
                             roller={"vertical": 0}, bodyforce=(1, -2))
    assert Imbalance(Solved(problem, BrezziEtAl(form=form), Ring(3, 0.7))) < 1e-9


def test_divergence_is_the_load_on_both_sides_of_a_named_interface():
    mesh = Crossed({"ring": [RING]})
    problem = ContactProblem(HookeMaterial(E=200, nu=0.3), Foundation("bottom", NormalCompliance(100)),
                             dirichlet={"top": (0.01, -0.1)}, bodyforce=(1, -5))
    solution = Solved(problem, LDG(), mesh, order=1)
    # Its normal is that of one side, which not always has the smaller number.
    assert np.any(solution.disc.facets.interfaces.sign < 0)
    assert Imbalance(solution) < 1e-9


@pytest.mark.parametrize("body", ["flat", "curved"])
def test_traction_on_the_foundation_balances_that_of_the_law(body):
    mesh, region = (RectangleMesh(3), "bottom") if body == "flat" else (Ring(2, 0.7), "inner")
    problem = ContactProblem(HookeMaterial(E=100, nu=0.3), Foundation(region, NormalCompliance(20), gap=-0.1 + 0.02 * x * x),
                             dirichlet={"top" if body == "flat" else "outer": (0, 0)})
    solution = Solved(problem, InteriorPenalty(), mesh)
    quadrature = BoundaryQuadrature.On(solution.disc.facets, region, 9)
    force = quadrature.weights @ EquilibratedStress(solution).Traction(quadrature)
    largest = np.abs(solution.weights @ np.abs(solution.traction)).max()
    assert np.abs(force + solution.weights @ solution.traction).max() < 1e-10 * largest
    stress = np.asarray(solution.stress(quadrature.inside)).reshape(-1, mesh.dim, mesh.dim)
    plain = quadrature.weights @ np.einsum("mij,mj->mi", stress, quadrature.normals)
    assert np.abs(plain - force).max() > 1e-5 * largest     # control: C eps(u_h) n is not in balance
