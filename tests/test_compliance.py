"""A stiffness of Gamma_C in the matrix changes no solution: any D >= 0 and any reference give the same linear problem."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import Example, Residual
from ngsolve import CF, BilinearForm, dx, x

from ngdgc import (LDG, AnisotropicMaterial, Conforming, ContactProblem, Discretization, Foundation,
                   HookeMaterial, InteriorPenalty, NonsymmetricInteriorPenalty, NormalCompliance, ProblemError)
from ngdgc.compliance import Apply, Compliance
from ngdgc.exact import WinklerColumn
from ngdgc.meshes import BoxMesh, RectangleMesh

# Round-off of a matrix with penalties of 1e5 moduli against loads; a wrong sign or factor is off by 1e-2 and more.
ROUNDOFF = 1e-10
PULLED = {"right": CF((0.01, 0.02 * x))}        # prescribed values that are not zero
DISCRETIZATIONS = {
    "ip": lambda: Discretization(Example(), InteriorPenalty(), RectangleMesh(4), order=2),
    "ldg-lifting": lambda: Discretization(Example(dirichlet=PULLED), LDG(form="lifting"), RectangleMesh(3, cells="quad")),
    "h1-prescribed": lambda: Discretization(Example(dirichlet=PULLED), Conforming(), RectangleMesh(4), order=3),
    "nipg": lambda: Discretization(Example(dirichlet=PULLED), NonsymmetricInteriorPenalty(), RectangleMesh(3), order=1),
    "3d": lambda: Discretization(Box(), InteriorPenalty(), BoxMesh(2), order=1)}


def Box():
    return ContactProblem(HookeMaterial(E=100, nu=0.3), Foundation("bottom", NormalCompliance(1)),
                          dirichlet={"top": CF((0, 0.1, 0))}, bodyforce=CF((1, 0, x)))


@pytest.fixture(params=DISCRETIZATIONS)
def disc(request):
    return DISCRETIZATIONS[request.param]()


def Random(disc, *, rank=None, seed=0):
    """Symmetric D >= 0 at the points, of the size of the body's stiffness; and a reference."""
    random = np.random.default_rng(seed)
    n, dim = disc.contact.normals.shape
    factors = random.standard_normal((n, dim, rank or dim))
    return 1e3 * factors @ np.swapaxes(factors, 1, 2), 0.1 * random.standard_normal((n, dim))


def Solved(compliance, s, load=1.0):
    """(u, t) at the contact points, with the coefficients of u, for a shifted traction."""
    u = compliance.Free(load) - compliance.Response(s)
    return u, compliance.Traction(u, s), compliance.vector


@pytest.mark.parametrize("rank", [None, 1])
def test_the_pair_solves_the_elastic_problem_for_every_stiffness_and_reference(disc, rank):
    """A u = f - T' W t to round-off, u is that of disc.inverse for the same t; forgetting the shift is noticed."""
    stiffness, reference = Random(disc, rank=rank)
    s = np.random.default_rng(1).standard_normal(reference.shape)
    compliance = Compliance(disc, stiffness, reference)
    u, t, vector = Solved(compliance, s)
    assert Residual(disc, vector, t) < ROUNDOFF
    assert disc.contact.Displacement(vector) == pytest.approx(u, abs=ROUNDOFF * np.abs(u).max())
    again = disc.FreeSolution() - disc.Response(t)
    assert vector == pytest.approx(again, abs=1e-8 * np.abs(again).max())       # condition number of A times 1e-16
    assert compliance.Shifted(u, t) == pytest.approx(s, abs=1e-12 * np.abs(t).max())
    assert Residual(disc, vector, s) > 1e-3
    other = Compliance(disc, stiffness, reference + 0.01)
    assert np.abs(Solved(other, s)[1] - t).max() > 1e-3 * np.abs(t).max()
    shifted = other.Shifted(u, t)               # but the same t from the s that belongs to it
    assert Solved(other, shifted)[0] == pytest.approx(u, abs=1e-9 * np.abs(u).max())


def test_no_stiffness_is_the_inverse_of_the_discretization(disc):
    traction = np.random.default_rng(2).standard_normal(disc.contact.normals.shape)
    compliance = Compliance(disc)
    u, t, vector = Solved(compliance, traction)
    assert np.array_equal(vector, disc.FreeSolution() - disc.Response(traction)) and t is traction
    assert compliance.Shifted(u, traction) is traction
    stiffness, _ = Random(disc)
    zero = Compliance(disc, 0 * stiffness)
    assert Solved(zero, traction)[2] == pytest.approx(vector, abs=1e-9 * np.abs(vector).max())
    assert np.abs(Compliance(disc, stiffness).Response(traction)).max() < 0.9 * np.abs(compliance.Response(traction)).max()


def test_matrix_is_restored_to_the_last_bit(disc, monkeypatch):
    """Also if the factorisation fails; a sum that is subtracted again would leave round-off."""
    values = disc.matrix.AsVector().FV().NumPy()
    before = values.copy()
    stiffness, reference = Random(disc)
    Compliance(disc, stiffness, reference)
    assert np.array_equal(values, before)
    seen = []

    def Fails(matrix):
        seen.append(np.abs(matrix.AsVector().FV().NumPy() - before).max())
        raise MemoryError

    monkeypatch.setattr(disc, "Factorise", Fails)
    with pytest.raises(MemoryError):
        Compliance(disc, stiffness, reference)
    assert np.array_equal(values, before) and seen[0] > 1
    changed = values + 1e3 / 3
    assert not np.array_equal(changed - 1e3 / 3, before)


def test_stiffness_couples_dofs_that_the_matrix_does_not():
    """With an added form the pattern of the sum can lack entries of T' W D T; then a new matrix is made."""
    problem = Example(material=AnisotropicMaterial([[3e3, 0, 0], [0, 2e3, 0], [0, 0, 1e3]]))
    disc = Discretization(problem, InteriorPenalty(), RectangleMesh(3), order=1)
    u, v = disc.space.TnT()
    disc.Add(BilinearForm(5 * u * v * dx))
    stiffness, reference = Random(disc)
    _, t, vector = Solved(Compliance(disc, stiffness, reference), np.ones_like(reference))
    assert Residual(disc, vector, t) < ROUNDOFF


@pytest.mark.parametrize("load", [0.0, 0.3, 1.0, -2.0])
def test_loads_and_prescribed_values_are_scaled_together(disc, load):
    """Free(load) is the problem with all data multiplied, c and D kept; it is affine in the load and repeatable."""
    stiffness, reference = Random(disc)
    compliance = Compliance(disc, stiffness, reference)
    s = np.ones_like(reference)
    problem = disc.problem
    scaled = replace(problem, dirichlet={region: load * value for region, value in problem.dirichlet.items()},
                     traction={region: load * value for region, value in problem.traction.items()},
                     bodyforce=problem.bodyforce and load * problem.bodyforce)
    other = Discretization(scaled, disc.method, disc.mesh, order=disc.order)
    expected = Solved(Compliance(other, stiffness, reference), s)
    for _ in range(2):
        u, t, vector = Solved(compliance, s, load)
        size = np.abs(compliance.Free(1.0)).max() + np.abs(reference).max()
        compliance.Free(load)
        assert u == pytest.approx(expected[0], abs=1e-9 * size) and vector == pytest.approx(expected[2], abs=1e-8 * size)
        compliance.Free(0.7)        # another one in between
    assert load == 1 or np.abs(compliance.Free(1.0) - u).max() > 1e-6 * size


@pytest.mark.parametrize("method", [InteriorPenalty(), LDG(), Conforming()], ids=lambda method: method.name)
def test_stiffness_holds_a_body_that_only_its_foundation_holds(method):
    """The Winkler column, p = k r in the matrix with c = g: its solution in one application; A alone has no inverse."""
    exact = WinklerColumn(load="pressure")
    disc = Discretization(exact.problem, method, RectangleMesh(3), order=1)
    n = disc.contact.normals
    stiffness = 100.0 * n[:, :, None] * n[:, None, :]
    gap = disc.contact.gap[:, None] * n
    u, t, vector = Solved(Compliance(disc, stiffness, gap), np.zeros_like(n))
    assert disc.contact.Normal(t) == pytest.approx(20, rel=1e-9) and Residual(disc, vector, t) < ROUNDOFF
    assert disc.contact.Normal(u) == pytest.approx(0.1 + 20 / 100, rel=1e-9)
    assert Apply(stiffness, u - gap) == pytest.approx(t, rel=1e-9, abs=1e-9)
    deeper = Solved(Compliance(disc, stiffness / 2, gap), np.zeros_like(n))[0]
    assert disc.contact.Normal(deeper) == pytest.approx(0.1 + 20 / 50, rel=1e-9)
    with pytest.raises(ProblemError, match="held by its foundation alone"):
        Compliance(disc)


def test_a_response_that_is_not_finite_is_an_error():
    """A free dof without any stiffness, a load against a material that is nearly nothing, is named before nan spreads."""
    problem = ContactProblem(HookeMaterial(E=1e-300, nu=0.3), Foundation("bottom", NormalCompliance(1)),
                             dirichlet={"top": CF((0, 0))}, bodyforce=CF((0, -1e100)))
    disc = Discretization(problem, Conforming(), RectangleMesh(2), order=1)
    with pytest.raises(ProblemError, match="not finite.*extreme size"):
        Compliance(disc)
