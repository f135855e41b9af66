"""Contact in a subspace and equilibrium in the whole space: how much the subspace knows, and what the corrections take."""

import numpy as np
import pytest
from scipy.linalg import eigh

from ngdgc import (LDG, ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NormalCompliance,
                   NotConvergedError, SemismoothNewtonSolver)
from ngdgc.contact.stiffness import BodyStiffness
from ngdgc.discrete.response import ContactResponse
from ngdgc.mesh.facets import Csr
from ngdgc.meshes import BoxMesh
from ngdgc.solvers.newton import subspace
from ngdgc.solvers.newton import correction
from ngdgc.solvers.newton.subspace import Basis, Subspace
from ngdgc.studies.atlas.solvers import Point
from ngdgc.studies.samples import Draw


def Box(n=4, *, method=None, order=1, stiffness=1.0, inverse="iterative", coefficient=0.3):
    point = Point(problem="box", n=n, stiffness=stiffness, coefficient=coefficient)
    return Discretization(point.contactproblem, method or InteriorPenalty(), point.Mesh(), order=order, inverse=inverse)


def Operator(disc, stiffness):
    """S_D in L2(Gamma_C), a dense symmetric matrix."""
    response, (n, dim) = ContactResponse(disc, stiffness), disc.contact.normals.shape
    root = np.repeat(np.sqrt(disc.contact.weights), dim)
    columns = [response.Product((unit / root).reshape(n, dim)).ravel() * root for unit in np.eye(n * dim)]
    return (np.array(columns) + np.array(columns).T) / 2


@pytest.mark.slow
@pytest.mark.parametrize(("method", "order", "n", "stiff", "bound"), [
    (InteriorPenalty(), 1, 4, False, 1.2), (InteriorPenalty(), 1, 4, True, 1.06), (LDG(), 1, 4, False, 1.2),
    (InteriorPenalty(), 2, 3, True, 1.1)])
def test_compliance_of_the_subspace_is_that_of_the_whole_nearly(method, order, n, stiff, bound):
    """S_X <= S <= bound S_X for D = 0 or gamma: the documented bounds."""
    disc = Box(n, method=method, order=order, inverse="sparsecholesky")
    stiffness = BodyStiffness(disc)[:, None, None] * np.eye(3) if stiff else None
    ratios = eigh(Operator(disc, stiffness), Operator(Subspace(disc), stiffness), eigvals_only=True)
    assert 1 - 1e-6 < ratios.min() and 1 + 1e-3 < ratios.max() < bound


def test_without_the_elements_that_touch_with_a_vertex_it_is_not(monkeypatch):
    """Negative control: elements with a facet on Gamma_C alone."""
    disc = Box(inverse="sparsecholesky")
    whole = Operator(disc, None)
    monkeypatch.setattr(subspace, "Near", lambda disc: disc.facets.Touching(disc.facets.On("bottom")))
    assert eigh(whole, Operator(Subspace(disc), None), eigvals_only=True).max() > 3


@pytest.mark.parametrize("order", [1, 2])
def test_subspace_has_all_functions_near_the_foundation_then_the_continuous_linear_ones_then_some_of_them(order):
    disc = Box(4 - order, order=order)
    P = Basis(disc).prolongation.toarray()
    assert np.linalg.eigvalsh(P.T @ P).min() > 1e-3 and P.shape[1] < P.shape[0] / 1.5

    def Missed(function):
        function = np.asarray(function, dtype=float)
        return np.linalg.norm(P @ np.linalg.solve(P.T @ P, P.T @ function) - function) / np.linalg.norm(function)

    contact, random = disc.contact, np.random.default_rng(0)
    assert Missed(contact.Load(random.standard_normal(contact.normals.shape)) != 0) < 1e-12     # one function per element
    continuous = subspace.PartlyContinuous(disc.facets, order)
    points = np.array(disc.mesh.ngmesh.Coordinates())[continuous.vertex]
    near = points[:, 2] < 2.5 / (4 - order)
    values = random.standard_normal(points.shape)
    embedding = continuous.Embedding()[:, :points.size]
    assert Missed(embedding @ (values * near[:, None]).ravel()) < 1e-12
    assert Missed(embedding @ (points @ random.standard_normal((3, 3)) + 1).ravel()) < 1e-12
    assert 1e-2 < Missed(random.standard_normal(disc.space.ndof))
    if order == 1:
        assert 1e-2 < Missed(embedding @ values.ravel())


def test_a_correction_balances_what_the_subspace_can_test():
    """From any u_0: P' (A u + T' W t - f) = 0 for u = u_0 + P x, and u on Gamma_C is what the equilibrium says."""
    disc = Box(3, order=2)
    random, small = np.random.default_rng(1), Subspace(disc)
    start = 1e-3 * random.standard_normal(disc.space.ndof)
    small = small.Moved(start)
    n = disc.contact.normals
    stiffness = 500 * np.eye(3) * np.ones((len(n), 1, 1))
    for D in (None, stiffness):
        found, *_ = ContactResponse(small, D).Meet(0.01 * n, 3 * n)
        whole = small.Whole(found.vector)
        excess = Csr(disc.matrix) @ whole + disc.contact.Load(found.traction) - disc.load
        size = np.linalg.norm(disc.contact.Load(found.traction))
        assert np.linalg.norm(small.prolongation.T @ excess) < 1e-9 * size < 1e-3 * np.linalg.norm(excess)
        assert disc.contact.Displacement(whole) == pytest.approx(found.displacement, abs=1e-12)
        line = 3 * n + (0 if D is None else 500 * (found.displacement - 0.01 * n))
        assert found.traction == pytest.approx(line, abs=1e-9 * np.abs(line).max())


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [1.0, 1e3, 1e6])
def test_all_corrections_take_about_as_many_cycles_as_one_linear_equation(stiffness):
    disc = Box(6, stiffness=stiffness)
    level = disc.Solve(tol=1e-8).levels[-1]
    alone = Box(6)
    alone.SolveLinear(alone.load)
    assert level.iterations <= 8 and level.cycles <= 1.5 * alone.inverse.iterations
    assert level.cycles == disc.cycles > level.solves


@pytest.mark.slow
@pytest.mark.parametrize("forgotten", ["shift", "load"])
def test_corrections_of_another_state_do_not_converge(forgotten, monkeypatch):
    """Negative control, and the message: displacement or imbalance of what is to be corrected are left out."""
    def Moved(small, vector):
        other, old = moved(small, vector), Subspace(small.disc)
        setattr(other, forgotten, getattr(old, forgotten))
        return other

    moved = Subspace.Moved
    monkeypatch.setattr(correction.Subspace, "Moved", Moved)
    with pytest.raises(NotConvergedError, match="law residual of .*inverse='sparsecholesky'"):
        SemismoothNewtonSolver().Solve(Box())


def test_a_solution_is_in_balance_however_loose_its_tolerance(monkeypatch):
    """The law may be missed by the tolerance, the balance of forces may not; the last solve alone sees to that."""
    def Excess():
        disc = Box()
        solution = SemismoothNewtonSolver(tol=1e-2).Solve(disc)
        excess = disc.Multiply(solution.vector) + disc.contact.Load(solution.traction) - disc.load
        return np.linalg.norm(excess) / np.linalg.norm(disc.load)

    assert Excess() <= 2 * correction.MOST
    monkeypatch.setattr(correction, "MOST", 1.0)
    # More than the 1e-6 that count as converged.
    with pytest.raises(NotConvergedError, match="A u - f .* of its terms"):
        Excess()


def test_a_body_without_loads_rests():
    """Nothing is out of balance, exactly; the same body under its weight moves."""
    def Largest(weight):
        problem = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("bottom", NormalCompliance(1)),
                                 dirichlet={"top": (0, 0, 0)}, bodyforce=(0, 0, weight))
        return np.abs(Discretization(problem, InteriorPenalty(), BoxMesh(3), inverse="iterative").Solve().displacement).max()

    assert Largest(0) == 0 < 1e-3 < Largest(-1)


@pytest.mark.parametrize("n", [2, 3])
def test_a_foundation_alone_may_deform_a_body(n):
    """No loads, but an overlap: there is nothing else to which the balance could be relative; as from a factorisation."""
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), Foundation("top", NormalCompliance(500), gap=-0.01),
                             dirichlet={"bottom": (0, 0, 0)})
    ours, theirs = (Discretization(problem, LDG(), BoxMesh(n), inverse=inverse).Solve() for inverse in ("iterative", "auto"))
    assert theirs.disc.inversekind != "iterative"
    assert np.abs(ours.traction - theirs.traction).max() < 1e-8 * np.abs(theirs.traction).max()


def test_a_tolerance_below_round_off_is_named():
    with pytest.raises(NotConvergedError, match="tol=1e-18 is below what round-off allows"):
        SemismoothNewtonSolver(tol=1e-18).Solve(Box(3))


@pytest.mark.slow
@pytest.mark.parametrize("number", [0, 1, 2])
def test_random_problems_have_the_same_solution(number):
    """As from a factorisation; the bodies are fine enough that the subspace is a part."""
    numbers = (n for n in range(1000) if _Fits(Draw(3, n, dofs=12_000)))
    disc = Draw(3, [next(numbers) for _ in range(3)][number], dofs=12_000).Disc()
    iterated = Discretization(disc.problem, disc.method, disc.mesh, order=disc.order, inverse="iterative")
    assert Basis(iterated).prolongation.shape[1] < 0.7 * disc.space.ndof
    ours, theirs = iterated.Solve(tol=1e-9), disc.Solve(tol=1e-9)
    for name in ("displacement", "traction"):
        one, other = getattr(ours, name), getattr(theirs, name)
        assert np.abs(one - other).max() < 1e-5 * np.abs(other).max()


def _Fits(sample):
    return sample.words.startswith("3D") and sample.method.discontinuous and sample.n >= 4 and sample.order < 3
