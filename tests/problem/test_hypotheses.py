"""What the theory asks of laws, checked: derivatives of friction laws, (2.13), Lipschitz constants, uniqueness."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from ngsolve import x
from problems import Example

from ngdgc import (CoulombFriction, Discretization, Foundation, FrictionLaw, InteriorPenalty, NonsymmetricInteriorPenalty,
                   NormalCompliance, PowerFriction, ProblemError, SlipWeakeningFriction, TrescaFriction)
from ngdgc.exact import WinklerColumn
from ngdgc.problem.hypotheses import CheckLaws
from ngdgc.meshes import RectangleMesh
from ngdgc.theory.uniqueness import CheckUniqueness


@dataclass(frozen=True)
class Friction(FrictionLaw):
    """p_t = 3 r^2 p/(1 + p) c(s), c = 1/(1 + s), each derivative times a factor that should be 1."""

    byr: float = 1.0
    byp: float = 1.0
    bys: float = 1.0
    shift: float = 0.0

    def Bound(self, r, p):
        return 3 * np.maximum(r, 0) ** 2 * p / (1 + p)

    def BoundDerivatives(self, r, p):
        return self.byr * 6 * np.maximum(r, 0) * p / (1 + p), self.byp * 3 * np.maximum(r, 0) ** 2 / (1 + p) ** 2

    def Coefficient(self, slip):
        return 1 / (1 + slip) - self.shift, -self.bys / (1 + slip) ** 2


class OneNumber(FrictionLaw):
    def Bound(self, r, p):
        return p

    def Coefficient(self, slip):
        return 0.5


@pytest.mark.parametrize("law, culprit", [
    (Friction(byr=1.1), "BoundDerivatives differs from the finite difference of Bound by the penetration"),
    (Friction(byp=0.9), "BoundDerivatives differs from the finite difference of Bound by the pressure"),
    (Friction(bys=-1.0), "the derivative that Coefficient returns differs"),
    (Friction(shift=0.6), "the friction Coefficient is negative or not finite at slip"),
    (OneNumber(), r"Coefficient returns a float; give the pair")])
def test_a_wrong_derivative_of_a_friction_law_is_refused_by_name(law, culprit):
    Foundation("bottom", NormalCompliance(1), friction=Friction())
    with pytest.raises(ProblemError, match=culprit):
        Foundation("bottom", NormalCompliance(1), friction=law)


@dataclass(frozen=True)
class Wrong(CoulombFriction):
    def BoundDerivatives(self, r, p):
        return np.zeros_like(r), 2 * self.coefficient * np.ones_like(r)


def test_a_law_with_data_that_vary_is_checked_where_they_are_known():
    problem = Example(foundation=Foundation("bottom", NormalCompliance(450), friction=Wrong(0.1 + x)))
    with pytest.raises(ProblemError, match="foundation 'bottom': BoundDerivatives differs .* by the pressure"):
        Discretization(problem, InteriorPenalty(), RectangleMesh(2))
    right = Foundation("bottom", NormalCompliance(450), friction=CoulombFriction(0.1 + x))
    Discretization(Example(foundation=right), InteriorPenalty(), RectangleMesh(2))


class Barrier:
    """No base class, not monotone beyond none, undefined from a penetration of 0.01 on."""

    def Pressure(self, r):
        return np.where(r > 0, -np.log(1 - 100 * np.maximum(r, 0)), 0)

    def PressureDerivative(self, r):
        return np.where(r > 0, 100 / (1 - 100 * np.maximum(r, 0)), 0)


def test_friction_on_a_law_that_is_undefined_at_large_penetrations():
    problem = Example(foundation=Foundation("bottom", Barrier(), friction=CoulombFriction(0.3)))
    Discretization(problem, InteriorPenalty(), RectangleMesh(2))
    report = CheckLaws(Barrier(), CoulombFriction(0.3), depth=0.005)
    # p_n' = 100/(1 - 0.5) at the end of the range.
    assert report.valid
    assert [report.normal[0], report.friction[0]] == pytest.approx([200, 60], rel=1e-3)
    assert "not finite at penetration 0.01" in CheckLaws(Barrier(), depth=0.02).problems[0]


class Hump:
    """p_n = r up to 0.1, then down to 0 at 0.3 with slope -1/2: not monotone."""

    def Pressure(self, r):
        return np.clip(np.minimum(r, 0.1 - (r - 0.1) / 2), 0, None)

    def PressureDerivative(self, r):
        return np.where((r <= 0) | (r > 0.3), 0, np.where(r < 0.1, 1.0, -0.5))


class Drop:
    """p_n = 20 r up to 0.1, nothing beyond."""

    def Pressure(self, r):
        return np.where((r > 0) & (r < 0.1), 20 * r, 0)

    def PressureDerivative(self, r):
        return np.where((r > 0) & (r < 0.1), 20.0, 0)


@pytest.mark.parametrize("law, depth, lipschitz, decrease", [
    (NormalCompliance(7), 2.0, 7, 0), (NormalCompliance(7, 2), 2.0, 28, 0), (NormalCompliance(7, 1.5), 4.0, 21, 0),
    (NormalCompliance(7, 0.5), 1.0, np.inf, 0), (NormalCompliance(1e12), 1e-9, 1e12, 0), (Hump(), 1.0, 1, 0.5),
    (Hump(), 0.09, 1, 0), (Drop(), 1.0, np.inf, np.inf), (Drop(), 0.09, 20, 0)])
def test_lipschitz_constant_and_monotonicity_of_compliance_laws(law, depth, lipschitz, decrease):
    report = CheckLaws(law, depth=depth)
    assert report.normal[0] == pytest.approx(lipschitz, rel=1e-4)
    assert report.decrease[0] == pytest.approx(decrease, rel=1e-6) and report.monotone == (decrease == 0)
    assert report.valid == np.isfinite(lipschitz)
    assert ("monotone" in str(report)) and ("not Lipschitz" in str(report)) == (lipschitz == np.inf)
    if isinstance(law, NormalCompliance):
        assert str(law.Check(depth=depth)) == str(report)


@pytest.mark.parametrize("law, lipschitz, weakening", [
    (CoulombFriction(0.3), 30, 0), (PowerFriction(5, 2), 10, 0), (TrescaFriction(4), 0, 0), (None, 0, 0),
    # p_t = 100 r (0.2 + 0.3 e^(-s/d)): slope 50 in r, and largest pressure times 0.3/d in s.
    (SlipWeakeningFriction(0.5, 0.2, 0.01), 50, 3000), (SlipWeakeningFriction(0.2, 0.5, 0.01), 50, 0)])
def test_constants_of_friction_laws(law, lipschitz, weakening):
    report = Foundation("bottom", NormalCompliance(100), friction=law).Check()
    assert report.friction[0] == pytest.approx(lipschitz, rel=1e-5)
    assert report.weakening[0] == pytest.approx(weakening, rel=1e-5)
    assert report.valid and ("weakens" in str(report)) == (weakening > 0)
    assert ("reduced law" in str(report)) == isinstance(law, TrescaFriction)


class Sticky(FrictionLaw):
    """Acts at a distance, by an amount that depends on it: no law of (2.13), nor the reduced one."""

    def Bound(self, r, p):
        return np.maximum(1 + r, 0)


def test_violations_of_the_hypotheses_are_told_and_bad_ranges_refused():
    assert Sticky().Check(NormalCompliance(1)).problems == ("p_t is not zero without penetration",)
    assert "violated: p_t is not zero" in str(Sticky().Check(NormalCompliance(1)))
    for call, culprit in ((lambda: CheckLaws(NormalCompliance(1), depth=0), "depth is 0"),
                          (lambda: CheckLaws(NormalCompliance(1), slip=-1), "slip is -1"),
                          (lambda: NormalCompliance(1 + x).Check(), "data that are CoefficientFunctions")):
        with pytest.raises(ProblemError, match=culprit):
            call()


@dataclass(frozen=True)
class Softening:
    """p_n rises to 1 at r = 1/100, then falls with the slope -N until it is 0."""

    slope: float

    def Pressure(self, r):
        return np.clip(np.minimum(100 * r, 1 - self.slope * (r - 0.01)), 0, None)

    def PressureDerivative(self, r):
        return np.where((r <= 0) | (self.Pressure(r) <= 0), 0, np.where(r < 0.01, 100, -self.slope))


@pytest.mark.parametrize("slope", [3000, 4000])
def test_softening_column_is_unique_exactly_as_long_as_the_number_is_below_one(slope, method):
    """Between rollers |S_nn| = H/(lam + 2 mu) = 1/3500.  With the top at -d the column is in balance where p(r) = 3500 (d - r):
    at one r for N < 3500, for N > 3500 at three for a suitable d."""
    column = WinklerColumn().problem
    problem = replace(column, foundation=Foundation("bottom", Softening(slope)))
    report = CheckUniqueness(Discretization(problem, method, RectangleMesh(2), order=2), depth=0.02)
    assert report.number == pytest.approx(slope / 3500, rel=1e-3)
    assert report.exists and report.unique == (slope < 3500) and ("by theory" in str(report).splitlines()[-1]) == report.unique
    r = np.linspace(0, 0.02, 200001)
    for d, roots in ((0.01 + 0.95 / 3500, 3 if slope > 3500 else 1), (0.005, 1)):
        balance = Softening(slope).Pressure(r) - 3500 * (d - r)
        assert np.sum(np.diff(np.sign(balance)) != 0) == roots


def Bounds(disc, D):
    """The largest eigenvalue of D^(1/2) S D^(1/2) by dense matrices; D (n, d, d) at the contact points."""
    contact, dim = disc.contact, disc.mesh.dim
    n = len(contact.weights)
    root, S = np.zeros((n * dim, n * dim)), np.empty((n * dim, n * dim))
    for point in range(n):
        here = slice(point * dim, (point + 1) * dim)
        values, vectors = np.linalg.eigh(D[point])
        root[here, here] = vectors @ np.diag(np.sqrt(values * contact.weights[point])) @ vectors.T
    weights = np.repeat(contact.weights, dim)
    for column, unit in enumerate(np.eye(n * dim)):
        S[:, column] = contact.Displacement(disc.Response((unit / weights).reshape(n, dim))).ravel()
    return np.linalg.eigvalsh(root @ S @ root)[-1]


def test_number_of_a_problem_with_friction_that_varies_against_dense_matrices(method):
    """L_t = 450 (0.1 + x) differs from point to point; halved friction halves the number."""
    foundation = Foundation("bottom", NormalCompliance(450), friction=CoulombFriction(0.1 + x), gap=0.05)
    disc = Discretization(Example(foundation=foundation), method, RectangleMesh(3), order=1)
    report = CheckUniqueness(disc)
    assert report.laws[0].friction == pytest.approx(450 * (0.1 + disc.contact.coordinates[:, 0]), rel=1e-5)
    expected = Bounds(disc, 0.5 * report.laws[0].friction[:, None, None] * np.eye(2))
    assert report.number == pytest.approx(expected, rel=1e-2)
    half = replace(foundation, friction=CoulombFriction(0.05 + x / 2))
    other = Discretization(Example(foundation=half), method, RectangleMesh(3), order=1)
    assert CheckUniqueness(other).number == pytest.approx(expected / 2, rel=1e-2)


def test_what_the_theory_does_not_cover():
    column = WinklerColumn(load="pressure")
    with pytest.raises(ProblemError, match="held by its foundation alone"):
        CheckUniqueness(Discretization(column.problem, InteriorPenalty(), RectangleMesh(2)), depth=1, slip=1)
    with pytest.raises(ProblemError, match="not symmetric"):
        CheckUniqueness(Discretization(Example(), NonsymmetricInteriorPenalty(), RectangleMesh(2)))
    drop = Example(foundation=Foundation("bottom", Drop()))
    report = CheckUniqueness(Discretization(drop, InteriorPenalty(), RectangleMesh(2)))
    assert not report.exists and not report.unique and "not covered, (2.13)" in str(report)
    # The paper's example: friction does not depend on the penetration, so nothing can be lost.
    assert CheckUniqueness(Discretization(Example(), InteriorPenalty(), RectangleMesh(2))).number == 0
