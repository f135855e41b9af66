"""A stiffness of Gamma_C in the matrix changes no solution: any D >= 0 gives the same linear problem."""

from dataclasses import replace

import numpy as np
import pytest
from checks import Residual
from ngsolve import CF, BilinearForm, dx, x
from problems import Example

from ngdgc import (LDG, AnisotropicMaterial, Conforming, ContactProblem, Discretization, Foundation,
                   HookeMaterial, InteriorPenalty, NonsymmetricInteriorPenalty, NormalCompliance, ProblemError)
from ngdgc.discrete.response import Apply, ContactResponse
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
    """Symmetric D >= 0 at the points, of the size of the body's stiffness; a displacement and a traction there."""
    random = np.random.default_rng(seed)
    n, dim = disc.contact.normals.shape
    factors = random.standard_normal((n, dim, rank or dim))
    return 1e3 * factors @ np.swapaxes(factors, 1, 2), 0.1 * random.standard_normal((n, dim)), random.standard_normal((n, dim))


def Start(disc, stiffness, displacement, traction, load=1.0):
    return ContactResponse(disc, stiffness).Meet(displacement, traction, load=load)[0]


@pytest.mark.parametrize("rank", [None, 1])
def test_an_equilibrium_solves_the_elastic_problem_and_meets_the_line_asked_for(disc, rank):
    """A u = f - T' W t and t = t_0 + D (u - u_0) to round-off; u is that of disc.inverse for the same t."""
    stiffness, displacement, traction = Random(disc, rank=rank)
    found = Start(disc, stiffness, displacement, traction)
    assert Residual(disc, found.vector, found.traction) < ROUNDOFF
    assert disc.contact.Displacement(found.vector) == pytest.approx(found.displacement, abs=ROUNDOFF)
    again = disc.FreeSolution() - disc.Response(found.traction)
    assert found.vector == pytest.approx(again, abs=1e-8 * np.abs(again).max())       # condition number of A times 1e-16
    line = traction + Apply(stiffness, found.displacement - displacement)
    assert found.traction == pytest.approx(line, abs=1e-12 * np.abs(line).max())
    assert Residual(disc, found.vector, traction) > 1e-3
    moved = Start(disc, stiffness, displacement + 0.01, traction)
    assert np.abs(moved.traction - found.traction).max() > 1e-3 * np.abs(found.traction).max()


def test_the_next_equilibrium_comes_from_the_difference(disc):
    """The same as from nothing; s and S_D s are a pair of the operator; the load that it was found for matters."""
    stiffness, displacement, traction = Random(disc)
    response = ContactResponse(disc, stiffness)
    near, *nothing = response.Meet(displacement, traction)
    goal = (0.3 * displacement, traction + 1)
    found, s, product = response.Meet(*goal, near=near)
    fresh = Start(disc, stiffness, *goal)
    assert nothing == [None, None] and product == pytest.approx(response.Product(s), abs=1e-12)
    assert found.vector == pytest.approx(fresh.vector, abs=1e-9 * np.abs(fresh.vector).max())
    assert found.traction == pytest.approx(fresh.traction, abs=1e-9 * np.abs(fresh.traction).max())
    half, s, _ = response.Meet(*goal, load=0.5, near=near)
    assert s is None and half.load == 0.5 and np.abs(half.vector - found.vector).max() > 1e-6 * np.abs(found.vector).max()


def test_no_stiffness_is_the_inverse_of_the_discretization(disc):
    stiffness, displacement, traction = Random(disc)
    found = Start(disc, None, displacement, traction)
    expected = disc.FreeSolution() - disc.Response(traction)
    assert found.vector == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
    assert np.array_equal(found.traction, traction)
    zero = Start(disc, 0 * stiffness, displacement, traction)
    assert zero.vector == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
    stiff, soft = (ContactResponse(disc, D).Product(traction) for D in (stiffness, None))
    assert np.abs(stiff).max() < 0.9 * np.abs(soft).max()


def test_matrix_is_restored_to_the_last_bit(disc, monkeypatch):
    """Also if the factorisation fails; a sum that is subtracted again would leave round-off."""
    values = disc.matrix.AsVector().FV().NumPy()
    before = values.copy()
    stiffness, *_ = Random(disc)
    ContactResponse(disc, stiffness)
    assert np.array_equal(values, before)
    seen = []

    def Fails(matrix):
        seen.append(np.abs(matrix.AsVector().FV().NumPy() - before).max())
        raise MemoryError

    monkeypatch.setattr(disc, "Factorise", Fails)
    with pytest.raises(MemoryError):
        ContactResponse(disc, stiffness)
    assert np.array_equal(values, before) and seen[0] > 1
    changed = values + 1e3 / 3
    assert not np.array_equal(changed - 1e3 / 3, before)


def test_stiffness_couples_dofs_that_the_matrix_does_not():
    """With an added form the pattern of the sum can lack entries of T' W D T; then a new matrix is made."""
    problem = Example(material=AnisotropicMaterial([[3e3, 0, 0], [0, 2e3, 0], [0, 0, 1e3]]))
    disc = Discretization(problem, InteriorPenalty(), RectangleMesh(3), order=1)
    u, v = disc.space.TnT()
    disc.Add(BilinearForm(5 * u * v * dx))
    found = Start(disc, *Random(disc))
    assert Residual(disc, found.vector, found.traction) < ROUNDOFF


@pytest.mark.slow
@pytest.mark.parametrize("load", [0.0, 0.3, 1.0, -2.0])
def test_loads_and_prescribed_values_are_scaled_together(disc, load):
    """Meet(load=) is the problem with all data multiplied; D and the line to be met are not."""
    problem = disc.problem
    scaled = replace(problem, dirichlet={region: load * value for region, value in problem.dirichlet.items()},
                     traction={region: load * value for region, value in problem.traction.items()},
                     bodyforce=problem.bodyforce and load * problem.bodyforce)
    other = Discretization(scaled, disc.method, disc.mesh, order=disc.order)
    found, expected, full = Start(disc, *Random(disc), load), Start(other, *Random(disc)), Start(disc, *Random(disc))
    size = np.abs(full.vector).max()
    assert found.displacement == pytest.approx(expected.displacement, abs=1e-9 * size)
    assert found.vector == pytest.approx(expected.vector, abs=1e-8 * size)
    assert load == 1 or np.abs(full.displacement - found.displacement).max() > 1e-6 * size


@pytest.mark.parametrize("method", [InteriorPenalty(), LDG(), Conforming()], ids=lambda method: method.name)
def test_stiffness_holds_a_body_that_only_its_foundation_holds(method):
    """The Winkler column, p = k r in the matrix: its solution in one application; A alone has no inverse."""
    exact = WinklerColumn(load="pressure")
    disc = Discretization(exact.problem, method, RectangleMesh(3), order=1)
    n = disc.contact.normals
    stiffness = 100.0 * n[:, :, None] * n[:, None, :]
    gap = disc.contact.gap[:, None] * n
    found = Start(disc, stiffness, gap, np.zeros_like(n))
    assert disc.contact.Normal(found.traction) == pytest.approx(20, rel=1e-9)
    assert Residual(disc, found.vector, found.traction) < ROUNDOFF
    assert disc.contact.Normal(found.displacement) == pytest.approx(0.1 + 20 / 100, rel=1e-9)
    deeper = Start(disc, stiffness / 2, gap, np.zeros_like(n))
    assert disc.contact.Normal(deeper.displacement) == pytest.approx(0.1 + 20 / 50, rel=1e-9)
    with pytest.raises(ProblemError, match="held by its foundation alone"):
        ContactResponse(disc)


def test_a_response_that_is_not_finite_is_an_error():
    """A free dof without any stiffness, a load against a material that is nearly nothing, is named before nan spreads."""
    problem = ContactProblem(HookeMaterial(E=1e-300, nu=0.3), Foundation("bottom", NormalCompliance(1)),
                             dirichlet={"top": CF((0, 0))}, bodyforce=CF((0, -1e100)))
    disc = Discretization(problem, Conforming(), RectangleMesh(2), order=1)
    with pytest.raises(ProblemError, match="not finite.*extreme size"):
        Start(disc, None, disc.contact.normals, disc.contact.normals)
