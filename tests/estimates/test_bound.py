"""The symmetric equilibrated stress, and the bound of the error that follows from it."""

from functools import cache

import numpy as np
import pytest
from ngsolve import CF, Grad, GridFunction, cos, x, y
from problems import ORTHOTROPIC, Loaded, Solved
from scipy.linalg import eigh

from ngdgc import (LDG, BassiEtAl, ContactProblem, CoulombFriction, Discretization, EstimateError, Foundation, HookeMaterial,
                   InteriorPenalty, NormalCompliance, PowerFriction, SlipWeakeningFriction, Solve, TrescaFriction)
from ngdgc.errors import EnergyError
from ngdgc.estimates import bound
from ngdgc.estimates.equilibrated import EquilibratedStress
from ngdgc.estimates.hypercircle import Hypercircle
from ngdgc.estimates.lawpart import LawPart
from ngdgc.estimates.potential import Potential
from ngdgc.estimates.residual import ResidualEstimate
from ngdgc.estimates.symmetric import Split, Symmetrised
from ngdgc.meshes import BoxMesh, RectangleMesh, UnitMesh
from ngdgc.studies.effectivity import Difference
from ngdgc.studies.samples import BodyMesh


@pytest.mark.parametrize("cells, order", [("triangle", 1), ("triangle", 2), ("triangle", 3), ("quad", 1), ("quad", 3),
                                          ("tet", 1), pytest.param("tet", 2, marks=pytest.mark.slow)])
@pytest.mark.parametrize("form", ["edge", "lifting"])
def test_symmetrised_stress_is_symmetric_and_tests_as_before(cells, order, form):
    """tau = 0 against all gradients of V_h(K), which is div tau = 0 and tau n = 0 seen by V_h."""
    mesh = UnitMesh(1 if cells == "tet" else 2, cells)
    solution = Solved(Loaded(mesh), LDG(form=form), mesh, order)
    v = GridFunction(solution.disc.space)
    v.vec.FV().NumPy()[:] = np.random.default_rng(5).standard_normal(v.space.ndof)
    for batch in EquilibratedStress(solution).Batches(lambda group: group.With(lambda shape: Split(group.et, order, shape))):
        found = Symmetrised(batch, order)
        skew, size = np.abs(found - np.swapaxes(found, 2, 3)).max(), np.abs(found).max()
        assert skew < 1e-12 * size
        assert np.abs(batch.equilibrated - np.swapaxes(batch.equilibrated, 2, 3)).max() > 1e-3 * size       # control
        gradient = np.asarray(Grad(v)(batch.points.ravel())).reshape(found.shape)
        tested = batch.Integral(np.einsum("nqij,nqij->nq", found - batch.equilibrated, gradient))
        scale = batch.Integral(np.sqrt(np.square(found).sum(axis=(2, 3)) * np.square(gradient).sum(axis=(2, 3))))
        assert np.abs(tested).max() < 1e-12 * scale.max()


def Wavy(stiffness, friction, gap=0.0):
    foundation = Foundation("bottom", NormalCompliance(stiffness), friction=friction, gap=gap + 0.01 * (1 - 4 * x * (1 - x)))
    return ContactProblem(HookeMaterial(E=1, nu=0.2), foundation, dirichlet={"top": CF((0.003, -0.008))})


@cache
def Fine(stiffness, friction, gap=0.0):
    return Solve(Discretization(Wavy(stiffness, friction, gap), LDG(), RectangleMesh(15), order=2))


@pytest.mark.slow
@pytest.mark.parametrize("friction, stiffness, method, order", [
    (None, 1e-2, LDG(), 1), (None, 1e6, BassiEtAl(form="lifting"), 2), (TrescaFriction(1e-5), 1, InteriorPenalty(), 2),
    (TrescaFriction(1e-3), 1e6, LDG(), 1), (CoulombFriction(0.2), 1e-2, InteriorPenalty(), 1),
    (CoulombFriction(0.2), 1e6, LDG(), 2)], ids=repr)
def test_bound_is_one_and_near_the_error(friction, stiffness, method, order):
    solution = Solve(Discretization(Wavy(stiffness, friction), method, RectangleMesh(5), order=order))
    estimate, true = EstimateError(solution), EnergyError(Fine(stiffness, friction), solution.gfu)
    # On a soft foundation the law's gap is that of its energy, of which the body has little.
    assert 1 <= estimate.bound / true < 10 and estimate.value < estimate.bound
    assert ("strict" in estimate.reason) == (not isinstance(friction, CoulombFriction))
    # Control: it bounds no error against another problem.
    assert EnergyError(Fine(stiffness, friction, -0.05), solution.gfu) > estimate.bound


def test_stiff_laws_need_a_lowered_displacement(monkeypatch):
    solution = Solve(Discretization(Wavy(1e8, None), LDG(), RectangleMesh(5), order=2))
    estimate = EstimateError(solution)
    assert estimate.bound < 4 * estimate.value
    monkeypatch.setattr(bound, "Pushed", lambda solution, potential, stress: None)
    assert EstimateError(solution).bound > 10 * estimate.value      # control


@pytest.mark.slow
@pytest.mark.parametrize("nu", [0.3, 0.499])
def test_bound_of_solids_and_of_nearly_incompressible_ones(nu):
    foundation = Foundation("bottom", NormalCompliance(1))
    problem = ContactProblem(HookeMaterial(E=1, nu=nu), foundation, dirichlet={"top": CF((0.02, 0, -0.05))})
    solution, fine = (Solve(Discretization(problem, InteriorPenalty(), BoxMesh(n), order=n)) for n in (1, 2))
    assert 1 < EstimateError(solution).bound / EnergyError(fine, solution.gfu) < 10


@pytest.mark.parametrize("stiffness", [10, 0.01])
def test_bound_is_the_root_of_its_equation(stiffness):
    """x^2 = (|a + b| + I) x + Phi + I |b| - (a, b), with Hooke's C^-1 s:t = (s:t - lam/(2 mu + d lam) tr s tr t)/(2 mu)."""
    mu, lam = 0.4, 0.2
    foundation = Foundation("bottom", NormalCompliance(stiffness), friction=TrescaFriction(0.002), gap=0.02 * (x - 0.4))
    problem = ContactProblem(HookeMaterial(mu=mu, lam=lam), foundation, dirichlet={"top": CF((0.01, -0.005))})
    solution = Solve(Discretization(problem, LDG(), RectangleMesh(4), order=1))
    stress, v, products = EquilibratedStress(solution), Potential(solution), np.zeros(3)
    for batch in stress.Batches(lambda group: group.With(lambda shape: Split(group.et, 1, shape))):
        gradient = v.Gradient(batch.group)
        strain = (gradient + np.swapaxes(gradient, 2, 3)) / 2
        a = Symmetrised(batch, 1) - batch.computed
        b = 2 * mu * strain + lam * np.einsum("nqii->nq", strain)[..., None, None] * np.eye(2) - batch.computed
        for number, (s, t) in enumerate(((a + b, a + b), (b, b), (a, b))):
            traces = np.einsum("nqii,nqjj->nq", s, t)
            density = np.einsum("nqij,nqij->nq", s, t) - lam / (2 * mu + 2 * lam) * traces
            products[number] += batch.Integral(density).sum() / (2 * mu)
    law = LawPart(solution, v, stress)
    sum_, jumps, mixed = products
    names = ("gap", "cut"), ("softgap", "softcut")
    for found, both in zip(Hypercircle(solution, stress, v, np.zeros(solution.disc.mesh.ne)), names):
        gap, cut = (sum(part.weights @ getattr(part, name) for part in law) for name in both)
        rest = gap + np.sqrt(cut * jumps) - mixed
        assert found ** 2 == pytest.approx((np.sqrt(sum_) + np.sqrt(cut)) * found + rest, rel=1e-9)
        # Every summand is large enough to be missed.
        if stiffness == 10 and both[0] == "gap":
            assert min(gap, np.sqrt(cut * jumps), abs(mixed), np.sqrt(cut) * found) > 1e-4 * found ** 2
        if stiffness < 10 and both[0] == "softgap":
            assert np.sqrt(cut) * found > 1e-4 * found ** 2 and cut > 1.01 * sum(part.weights @ part.cut for part in law)


def test_soft_foundation_does_not_make_the_bound_large():
    """Its gap (t - k r)^2/2k of what t lacks between the contact points is 15 times the error; moved to the law it is small."""
    def Found(stiffness, n=6, order=2):
        foundation = Foundation("bottom", NormalCompliance(stiffness), gap=0.005 * (1 + cos(3 * np.pi * x)))
        problem = ContactProblem(HookeMaterial(E=1, nu=0.3), foundation, dirichlet={"top": CF((0, -0.006))})
        return Solve(Discretization(problem, LDG(), RectangleMesh(n), order=order))

    solution, fine = Found(0.002), Found(0.002, n=15, order=3)
    true, estimate = Difference(fine, solution), EstimateError(solution)
    assert 1 < estimate.bound / true < 3 and estimate.reason.startswith("not strict: ")
    v, stress = Potential(solution), EquilibratedStress(solution)
    strict, soft = Hypercircle(solution, stress, v, np.zeros(solution.disc.mesh.ne))
    assert soft < 3 * true and strict > 10 * true
    assert EstimateError(Found(0.1)).reason.startswith("strict")


def Kappa(disc, slope):
    """By the least energy of a normal traction x and any tangential one: max S_tt x.x/(that + x.x/p_n'), along each tangent."""
    contact, patch = disc.contact, bound._Patches(disc.contact.coordinates)
    m, found = patch.max() + 1, []
    axes = [contact.normals, *(np.broadcast_to(row, contact.normals.shape) for row in np.eye(contact.dim)[:-1])]
    tractions = np.array([axis * (patch == number)[:, None] for axis in axes for number in range(m)])
    moved = np.array([contact.Displacement(disc.SolveLinear(contact.Load(traction))) for traction in tractions])
    S = np.einsum("n,and,bnd->ab", contact.weights, tractions, moved)
    soft = np.diag(np.bincount(patch, contact.weights)) / slope
    for t in range(m, len(S), m):
        both = np.r_[0:m, t:t + m]
        least = np.linalg.inv(np.linalg.inv(S[np.ix_(both, both)])[:m, :m])
        found.append(np.sqrt(eigh(S[t:t + m, t:t + m], (least + least.T) / 2 + soft, eigvals_only=True).max()))
    return found


def test_patches_are_as_many_with_as_many_points():
    """12 slices of a line; of a face 4 along its longer side, each of 3."""
    places = np.random.default_rng(2).permutation(96) / 96
    counts = np.bincount(bound._Patches(np.stack([places, 0 * places], axis=1)))
    assert counts.tolist() == 12 * [8]
    grid = np.stack([axis.ravel() for axis in np.meshgrid(2 * np.arange(8), np.arange(9), [0.0])], axis=1)
    patch = bound._Patches(grid)
    assert np.bincount(patch).tolist() == 12 * [6]
    assert all(np.ptp(grid[patch == number], axis=0).tolist() == [2, 2, 0] for number in range(12))


@pytest.mark.parametrize("dim", [2, 3])
def test_kappa_is_the_largest_work_of_a_pressure_by_its_energy(dim):
    mesh = RectangleMesh(4) if dim == 2 else BoxMesh(1, upper=(1, 3, 1))
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("bottom", NormalCompliance(100)),
                             dirichlet={"left": CF((0,) * dim)})
    disc = Discretization(problem, LDG(), mesh, order=2)
    wanted = Kappa(disc, 100.0)
    assert bound._Kappa(disc, np.full(len(disc.contact.weights), 100.0)) == pytest.approx(max(wanted), rel=1e-6)


def test_feedback_of_friction_that_follows_the_penetration():
    """On a linear law p_t = c r is Coulomb's with mu = c/k: the same q, by which the bound grows as 1/(1 - q)."""
    pairs = []
    for friction in (PowerFriction(stiffness=0.2, exponent=1), CoulombFriction(0.2)):
        solution = Solve(Discretization(Wavy(1, friction), LDG(), RectangleMesh(4)))
        pairs.append((bound._Feedback(solution)[0], EstimateError(solution).bound))
    assert pairs[0] == pytest.approx(pairs[1], rel=1e-6)
    q, found = pairs[1]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bound, "_Feedback", lambda solution: (0.0, ""))
        assert EstimateError(solution).bound == pytest.approx((1 - q) * found, rel=1e-12) and q > 0.05


def test_factor_of_the_feedback_grows_to_none():
    """q = mu kappa is linear in mu; a soft foundation answers less."""
    words = [EstimateError(Solve(Discretization(Wavy(stiffness, CoulombFriction(mu)), LDG(), RectangleMesh(4)))).reason
             for stiffness, mu in ((1, 0.1), (1, 0.2), (0.01, 0.2), (1, 0.45))]
    q = [float(one.split("q = ")[1].split(",")[0]) for one in words]
    assert q[1] == pytest.approx(2 * q[0], abs=0.03) and q[2] < 0.3 * q[1] and 0.5 < q[3] < 0.9 and "too much" in words[3]


@pytest.mark.slow
def test_rollers_of_one_name_on_several_faces_keep_their_normals():
    foundation = Foundation("bottom", NormalCompliance(1))
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), foundation, roller={"front|right": 0.01},
                             traction={"top": CF((0.02, 0, -0.1))})
    solution = Solve(Discretization(problem, LDG(), BoxMesh(2), order=1))
    assert EstimateError(solution).bound < 10 * EstimateError(solution).value


def Between(swapped):
    """A body between two foundations, a stiff one with friction and a softer one that it is drawn along."""
    foundations = (Foundation("bottom", NormalCompliance(1e5), friction=TrescaFriction(1e-3), gap=0.01 * (1 - 1.5 * x)),
                   Foundation("top", NormalCompliance(1e6), gap=0.005 - 0.02 * x))
    problem = ContactProblem(HookeMaterial(E=1, nu=0.2), foundations[::-1] if swapped else foundations,
                             dirichlet={"left": CF((0.01, -0.005))})
    return Solve(Discretization(problem, LDG(), RectangleMesh(4), order=2))


def test_foundations_count_whatever_their_order(monkeypatch):
    """Parts, indicators and bound: the same numbers up to the tolerance of the law; each of them presses."""
    estimates = [EstimateError(Between(swapped)) for swapped in (False, True)]
    one, other = estimates
    assert one.bound == pytest.approx(other.bound, rel=1e-6)
    np.testing.assert_allclose(one.indicators, other.indicators, rtol=1e-6, atol=1e-8 * one.indicators.max())
    monkeypatch.setattr(bound, "Pushed", lambda solution, potential, stress: None)
    assert EstimateError(Between(False)).bound > 1.5 * one.bound       # control: the body is lowered at both or at one of them


def test_a_body_is_lowered_along_its_rollers():
    """The vertex where a roller meets a stiff foundation is as free to leave it as the others."""
    foundation = Foundation("bottom", NormalCompliance(1e8), gap=0.02 * cos(3 * x))        # deepest at the roller
    problem = ContactProblem(HookeMaterial(E=1, nu=0.2), foundation, roller={"right": 0}, dirichlet={"top": CF((0, -0.02))})
    solution = Solve(Discretization(problem, LDG(), BodyMesh(4, "unstructured"), order=1))
    estimate = EstimateError(solution)
    assert estimate.bound < 5 * estimate.value


def test_bound_of_a_body_that_only_its_foundation_holds(monkeypatch):
    """What is added to A is taken away again: of a body that is held, nearly the kappa without it."""
    disc = Solve(Discretization(Wavy(10, CoulombFriction(0.2)), LDG(), RectangleMesh(4))).disc
    slope = np.full(len(disc.contact.weights), 10.0)
    plain = bound._Kappa(disc, slope)
    monkeypatch.setattr(type(disc), "unresisted", property(lambda self: "translation along y"))
    # The tangential compliance stays the stiffer one, which says less of the work and is right, too.
    assert 0.9 * plain < bound._Kappa(disc, slope) < plain
    Respond, added = bound._Response(disc, 10.0)
    monkeypatch.setattr(bound, "_Response", lambda disc, slope: (Respond, 0.0))
    assert bound._Kappa(disc, slope) > 1.02 * plain     # control: left there
    foundation = Foundation("bottom", NormalCompliance(10), friction=CoulombFriction(0.2))
    monkeypatch.undo()
    free = ContactProblem(HookeMaterial(E=1, nu=0.2), foundation, roller={"right": 0}, traction={"top": CF((0, -0.1))})
    assert 0 < bound._Feedback(Solve(Discretization(free, LDG(), RectangleMesh(4))))[0] < 0.5


@pytest.mark.parametrize("changes, words", [
    ({"friction": SlipWeakeningFriction(0.3, 0.1, 1e-3)}, "weakens"),
    ({"bodyforce": CF((0, 0.1 * x ** 4))}, "body force is no polynomial"),
    ({"traction": {"left": CF((0.1 * y ** 4, 0))}}, "traction is no polynomial"),
    ({"roller": {"left": 0.01 * y ** 4}}, "displacement is no polynomial"),
    ({"top": CF((0.02, -0.05 * x ** 4))}, "displacement is no polynomial")])
def test_no_bound_has_its_reason(changes, words):
    mesh = RectangleMesh(3)
    foundation = Foundation("bottom", NormalCompliance(1), friction=changes.pop("friction", None))
    top = changes.pop("top", CF((0.02, -0.05)))
    problem = ContactProblem(HookeMaterial(E=1, nu=0.2), foundation, dirichlet={"top": top}, **changes)
    estimate = EstimateError(Solve(Discretization(problem, InteriorPenalty(), mesh, order=1)))
    assert estimate.bound is None and words in estimate.reason


def test_anisotropic_bodies_have_a_bound():
    foundation = Foundation("bottom", NormalCompliance(100))
    problem = ContactProblem(ORTHOTROPIC, foundation, dirichlet={"top": CF((0.02, -0.05))})
    solution, fine = (Solve(Discretization(problem, LDG(), RectangleMesh(n), order=order)) for n, order in ((3, 1), (12, 2)))
    assert 1 < EstimateError(solution).bound / EnergyError(fine, solution.gfu) < 5
    assert ResidualEstimate(solution).bound is None and "shape" in ResidualEstimate(solution).reason
