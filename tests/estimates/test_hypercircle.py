"""Bounds where the stress cannot be made symmetric, by Korn's constants."""

from functools import cache

import numpy as np
import pytest
from ngsolve import CF, x, y
from problems import GRADED, Solved

from ngdgc import (LDG, BassiEtAl, ContactProblem, Discretization, EstimateError, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, Solve, TrescaFriction)
from ngdgc.errors import EnergyError
from ngdgc.estimates.equilibrated import EquilibratedStress, Stress
from ngdgc.estimates.hypercircle import ElementConstants, Hypercircle
from ngdgc.estimates.lawpart import LawPart
from ngdgc.estimates.potential import Potential
from ngdgc.meshes import BoxMesh, RectangleMesh, UnitMesh
from ngdgc.studies.samples import BodyMesh


def Bent(mesh, material=None, gap=0.0):
    solid = (0.01,) * (mesh.dim - 2)
    gap = gap + 0.01 * (1 - 4 * x * (1 - x))
    foundation = Foundation("bottom", NormalCompliance(10), friction=TrescaFriction(0.01), gap=gap)
    return ContactProblem(material or HookeMaterial(E=1, nu=0.3), foundation, dirichlet={"top": CF((0.03, *solid, -0.05))})


CASES = {"hex": (lambda: BoxMesh(1, cells="hex"), lambda: BoxMesh(3, cells="hex"), None),
         "prism": (lambda: UnitMesh(1, "prism"), lambda: UnitMesh(3, "prism"), None),
         "curved": (lambda: BodyMesh(3, "cad", 2), lambda: BodyMesh(9, "cad", 3), None),
         "graded": (lambda: RectangleMesh(4), lambda: RectangleMesh(12), GRADED)}


@cache
def Fine(name, gap=0.0):
    """The solution on a fine mesh, with which those of both methods are compared."""
    _, Make, material = CASES[name]
    mesh = Make()
    return Solve(Discretization(Bent(mesh, material, gap), LDG(), mesh, order=2))


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("method", [InteriorPenalty(), BassiEtAl(form="lifting")], ids=lambda method: method.name)
def test_bound_is_one_and_near_the_error(name, method):
    Coarse, _, material = CASES[name]
    order = 1 if name != "curved" else 2
    solution = Solve(Discretization(Bent(Coarse(), material), method, Coarse(), order=order))
    estimate = EstimateError(solution)
    true = EnergyError(Fine(name), solution.gfu)
    assert estimate.value < estimate.bound and 1 <= estimate.bound / true < 5 and "Korn" in estimate.reason
    # Control: it bounds no error against another problem.
    assert EnergyError(Fine(name, 0.05), solution.gfu) > estimate.bound


def test_bound_is_the_root_of_its_equation_with_korns_constants():
    """x^2 = (|a + b| + I + S) x + Phi + (I + S) |b| - (a, b), |.| of C^-1 by Hooke's law, S by 2 mu."""
    mu, lam, mesh = 0.4, 0.2, BoxMesh(1, cells="hex")
    solution = Solved(Bent(mesh, HookeMaterial(mu=mu, lam=lam)), LDG(), mesh, 1)
    stress, v, products, skewness = EquilibratedStress(solution), Potential(solution), np.zeros(3), 0.0
    korn = np.full(mesh.ne, 2.5)
    for batch in stress.Batches():
        symmetric = (batch.equilibrated + np.swapaxes(batch.equilibrated, 2, 3)) / 2
        skewness += batch.Integral(np.square(batch.equilibrated - symmetric).sum(axis=(2, 3))).sum() * 2.5 ** 2 / (2 * mu)
        a, b = symmetric - batch.computed, Stress(batch.group.Stiffness(), v.Gradient(batch.group)) - batch.computed
        for number, (s, t) in enumerate(((a + b, a + b), (b, b), (a, b))):
            traces = np.einsum("nqii,nqjj->nq", s, t)
            density = np.einsum("nqij,nqij->nq", s, t) - lam / (2 * mu + 3 * lam) * traces
            products[number] += batch.Integral(density).sum() / (2 * mu)
    law = LawPart(solution, v, stress)
    gap, cut = (sum(part.weights @ getattr(part, name) for part in law) for name in ("gap", "cut"))
    sum_, jumps, mixed = products
    off = np.sqrt(cut) + np.sqrt(skewness)
    found, _ = Hypercircle(solution, stress, v, korn)
    assert found ** 2 == pytest.approx((np.sqrt(sum_) + off) * found + gap + off * np.sqrt(jumps) - mixed, rel=1e-9)
    assert np.sqrt(skewness) > 0.05 * found and Hypercircle(solution, stress, v, 0 * korn)[0] < 0.99 * found       # control


def test_korns_constants_are_those_of_elements_without_a_symmetric_stress():
    """Of parallelograms none is needed."""
    mesh = RectangleMesh(2, cells="quad")
    assert not ElementConstants(Discretization(Bent(mesh), LDG(), mesh)).any()
    bent = BodyMesh(2, "cad", 2)
    assert ElementConstants(Discretization(Bent(bent, HookeMaterial(E=1 + y, nu=0.2)), LDG(), bent)).min() > 2
