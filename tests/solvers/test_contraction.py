"""Predicted contraction of Uzawa's iterations: the norm of S, the rate of the theory and of the run, and how it is reported."""

import numpy as np
import pytest
import scipy.linalg
from ngsolve import CF
from problems import Example
from stiff import FAST, IMPLICIT, Stiff

from ngdgc import (Conforming, ContactProblem, ContactSolution, CoulombFriction, Discretization, EstimateContraction,
                   Foundation, HookeMaterial, InteriorPenalty, NormalCompliance, NotConvergedError, TrescaFriction, UzawaSolver)
from ngdgc.exact import AffinePatch
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.solvers.uzawa.contraction import ComplianceNorm


@pytest.mark.parametrize("acceleration", [None, "anderson"])
def test_too_large_step_is_named_with_a_remedy_that_works(acceleration):
    disc = Discretization(AffinePatch("stick").problem, InteriorPenalty(), RectangleMesh(4), order=1)
    limit = 2 / ComplianceNorm(disc)
    assert UzawaSolver(normal="implicit", rho=0.95 * limit, acceleration=acceleration).Solve(disc).converged
    if acceleration is None:
        with pytest.raises(NotConvergedError, match=r"rho=.* is too large: rho \|S\| is 2.4.*Remedy: 0.75 of it"):
            UzawaSolver(normal="implicit", rho=1.2 * limit).Solve(disc)
    with pytest.raises(NotConvergedError, match="too slowly.*Remedy: take rho='auto'"):
        UzawaSolver(normal="implicit", rho=1e-4 * limit, maxiter=20).Solve(disc)


def test_compliance_norm_against_the_dense_operator():
    """Two orders, and a mesh whose symmetries hide the largest eigenvalue from a smooth start."""
    for disc in (Discretization(Example(), InteriorPenalty(), RectangleMesh(3), order=2),
                 Discretization(AffinePatch("stick", dim=3).problem, InteriorPenalty(), BoxMesh(2, cells="prism"), order=1)):
        assert ComplianceNorm(disc) == pytest.approx(np.linalg.eigvalsh(DenseCompliance(disc))[-1], rel=0.01)
        assert ComplianceNorm(disc, maxiter=1) < 0.9 * ComplianceNorm(disc)


def DenseCompliance(disc):
    """S as a symmetric matrix (n d, n d), orthonormal in L2(Gamma_C)."""
    contact = disc.contact
    size, root = contact.normals.size, np.repeat(np.sqrt(contact.weights), contact.dim)
    columns = [contact.Displacement(disc.Response(unit.reshape(-1, contact.dim))).ravel() for unit in np.eye(size)]
    dense = root[:, None] * np.array(columns).T / root
    return (dense + dense.T) / 2


@pytest.mark.parametrize("normal", ["explicit", "implicit"])
def test_predicted_rate_is_the_one_of_the_theory_and_the_one_observed(normal):
    """Stick, k_n soft: 1 - s lambda_min(S_tt); implicit, dt/dq = p_n'/(p_n' + gamma) across and 1 along."""
    disc = Discretization(AffinePatch("stick").problem, InteriorPenalty(), RectangleMesh(4), order=1)
    run = UzawaSolver(normal=normal).Solve(disc)
    dense, n = DenseCompliance(disc), len(run.weights)
    stiffness, across = 100.0, np.arange(2 * n) % 2 == 1        # the bottom: components x, y
    if normal == "implicit":
        gamma = 1.8 / ComplianceNorm(disc)
        root = np.sqrt(np.where(across, stiffness / (stiffness + gamma), 1))
        theory = np.abs(np.linalg.eigvalsh(root[:, None] * (np.eye(2 * n) - gamma * dense) * root)).max()
    else:
        tangential = dense[~across][:, ~across]
        normalnorm, norm = (np.linalg.eigvalsh(dense[part][:, part])[-1] for part in (across, ~across))
        step = 1.8 * (1 - stiffness * normalnorm) / norm
        root = np.sqrt(np.where(across, stiffness, step))
        theory = np.abs(np.linalg.eigvalsh(np.diag(~across * 1.0) - root[:, None] * dense * root)).max()
        assert theory == pytest.approx(1 - step * np.linalg.eigvalsh(tangential)[0], rel=0.01)
    assert 0.8 < theory < 0.95
    for rate in (run.rates.predicted, run.rates.observed):
        assert 1 - rate == pytest.approx(1 - theory, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("solver, name, ratio, friction, lower, upper", [
    (UzawaSolver(), "4.1", 0.1, TrescaFriction(1), 0.2, 0.25), (UzawaSolver(), "4.2", 0.1, CoulombFriction(0.3), 0.1, 0.13),
    (IMPLICIT["plain"], "4.1", 10, TrescaFriction(1), 0.9, 0.95),
    (IMPLICIT["plain"], "4.1", 1e4, CoulombFriction(0.3), 0.97, 0.99),
    (IMPLICIT["plain"], "4.2", 1e2, TrescaFriction(1), 0.98, 0.992)])
def test_predicted_rates_of_the_examples(solver, name, ratio, friction, lower, upper):
    """Slow or fast, 1 - rate is predicted within 15 %."""
    rates = solver.Solve(Stiff(name, ratio, friction, n=8 if ratio < 100 else 4)).rates
    assert lower < rates.predicted < upper and lower < rates.observed < upper
    assert 1 - rates.predicted == pytest.approx(1 - rates.observed, rel=0.15)


def test_rates_are_reported_saved_and_absent_where_there_are_none(tmp_path):
    disc = Discretization(Example(), InteriorPenalty(), RectangleMesh(4), order=1)
    solution = UzawaSolver().Solve(disc)
    before = disc.solves
    assert f"contraction per iteration: predicted {solution.rates.predicted:.4g}, observed" in solution.Report()
    assert 0 < disc.solves - before <= 22           # once, not for every report
    assert solution.ToJSON()["contraction"]["observed"] == solution.rates.observed
    solution.Save(tmp_path)
    assert ContactSolution.Load(tmp_path, disc.problem).rates == solution.rates
    for solver in FAST:
        rates = solver.Solve(disc).rates
        assert rates.predicted is None and 0 < rates.observed < 1
    far = Foundation("bottom", NormalCompliance(450), gap=5.0)
    rates = UzawaSolver().Solve(Discretization(Example(foundation=far), InteriorPenalty(), RectangleMesh(2), order=1)).rates
    assert rates.observed is None
    with pytest.raises(NotConvergedError) as failure:
        UzawaSolver().Solve(Discretization(Example(2e4), InteriorPenalty(), RectangleMesh(4), order=1))
    assert failure.value.solution.rates.predicted is None


def test_contraction_number_against_the_dense_compliance_operator():
    disc = Discretization(Example(), InteriorPenalty(), RectangleMesh(3), order=2)
    contact, n = disc.contact, len(disc.contact.weights)

    def Dense(directions, scale):
        columns = [contact.Displacement(disc.Response(direction)) for direction in directions]
        matrix = np.array([[np.einsum("nd,nd,n->", row, column, contact.weights) for column in columns] for row in directions])
        mass = np.array([[np.einsum("nd,nd,n->", a, b, contact.weights) for b in directions] for a in directions])
        return scale * scipy.linalg.eigh(matrix, mass, eigvals_only=True)[-1]

    normals = [contact.normals * (np.arange(n) == i)[:, None] for i in range(n)]
    tangents = [vector[:, ::-1] * [1, -1] for vector in normals]
    estimate = EstimateContraction(disc, np.full(n, 0.1), step=7.0)
    assert estimate.normal == pytest.approx(Dense(normals, 450), rel=0.01)
    assert estimate.friction == pytest.approx(Dense(tangents, 3.5), rel=0.01)
    # The active zone: half of the points out of contact.
    half = EstimateContraction(disc, np.where(contact.coordinates[:, 0] < 0.5, 0.1, -0.1)).normal
    active = [vector for vector, point in zip(normals, contact.coordinates) if point[0] < 0.5]
    assert half == pytest.approx(Dense(active, 450), rel=0.01) and half != pytest.approx(estimate.normal, rel=0.01)


def test_local_stiffness_of_other_exponents():
    """p_n' = 2 k r: at penetration r a quadratic law contracts like a linear one of stiffness 2 k r."""
    linear = Discretization(Example(500.0), InteriorPenalty(), RectangleMesh(3), order=1)
    foundation = Foundation("bottom", NormalCompliance(500.0, 2), friction=TrescaFriction(1), gap=0.05)
    quadratic = Discretization(Example(foundation=foundation), InteriorPenalty(), RectangleMesh(3), order=1)
    r = np.full(len(linear.contact.weights), 0.25)
    assert EstimateContraction(quadratic, r).normal == pytest.approx(EstimateContraction(linear, r).normal / 2, rel=1e-6)


def test_contraction_number_of_zones_that_are_never_active_together():
    """Foundations above and below a beam: the number in the error is that of one iterate, not of the union of their zones."""
    def Beam(stiffness):
        law = NormalCompliance(stiffness)
        problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), [Foundation("bottom", law), Foundation("top", law)],
                                 dirichlet={"left": CF((0, 0))}, traction={"right": CF((0, -1))})
        return Discretization(problem, Conforming(), RectangleMesh(6, upper=(3, 1), cells="quad"), order=1)

    solution = UzawaSolver().Solve(Beam(1.0))
    limit = 1 / EstimateContraction(solution.disc, solution.penetration).normal
    with pytest.raises(NotConvergedError, match="cannot converge for any rho") as failure:
        UzawaSolver().Solve(Beam(1.3 * limit))
    assert 1 < failure.value.contraction.normal < 1.7
