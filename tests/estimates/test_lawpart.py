"""The law's part of an estimate at displacements and tractions of one's own, against minima that are searched."""

from types import SimpleNamespace

import numpy as np
import pytest
from ngsolve import CF

from ngdgc import (LDG, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, NormalCompliance,
                   SlipWeakeningFriction)
from ngdgc.estimates.lawpart import FoundationPoints
from ngdgc.meshes import RectangleMesh

MU, SIDES = 3.0, 4


def Points(compliance, friction, penetration, slip, *, order=1):
    """A quadrature of the bottom, whose normal is -e_y and whose tangent is e_x, with a displacement that is constant."""
    foundation = Foundation("bottom", compliance, friction=friction)
    problem = ContactProblem(HookeMaterial(mu=MU, lam=1), foundation, dirichlet={"top": CF((0, 0))})
    disc = Discretization(problem, LDG(), RectangleMesh(SIDES), order=order)
    return FoundationPoints(disc, foundation, SimpleNamespace(gfu=CF((slip, -penetration))))


def Pulled(p, pull):
    """In the place of an EquilibratedStress, one of the pressure p and the traction pull along e_x on the body's foundation."""
    return SimpleNamespace(Traction=lambda quadrature: np.stack([np.full(len(p), -pull), p], axis=1))


def Slipping(slips):
    return np.full(4 * SIDES, slips)


def Least(Energy, gamma, value):
    """min_w Energy(w) + gamma/2 (value - w)^2, (n,), on a grid that is fine around 0 and the value."""
    span = 4 * np.linspace(-1, 1, 8001) ** 3
    w = np.concatenate([span * (abs(value) + 1e-2), value + span])
    return (Energy(w[:, None]) + gamma / 2 * (value - w[:, None]) ** 2).min(axis=0)


CASES = {"stiff": (1e4, None, 0.02, 0.0, 10.0, 0.0), "soft": (0.05, None, 0.2, 0.0, 0.3, 0.0),
         "open": (100, None, -0.01, 0.0, 1.0, 0.0), "tension": (100, None, 0.01, 0.0, -0.5, 0.0),
         "stick": (100, 0.4, 0.05, 0.001, 5.0, 1.0), "backwards": (100, 0.4, 0.05, -0.3, 5.0, 1.0),
         "beyond": (100, 0.4, 0.05, 0.3, 5.0, 4.0), "less": (100, 0.4, 0.05, 0.3, 5.0, 1.0)}


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("slips", [False, True])
@pytest.mark.parametrize("name", CASES)
def test_gaps_of_a_linear_law_are_what_they_are_called(name, slips, order):
    """Linear law, Coulomb's bound: Fenchel and Young's gaps, their envelopes, and the cheaper one of two tractions."""
    k, mu, r, s, mean, f = CASES[name]
    at = Points(NormalCompliance(k), mu and CoulombFriction(mu), r, s, order=order)
    places, gamma, price = at.quadrature.coordinates[:, 0], order ** 2 * 2 * MU * SIDES, 1 / (SIDES * 2 * MU)
    facet, p = np.floor(places * SIDES).astype(int), mean * (1 + 0.2 * np.sin(9 * places))
    gaps = at.Gaps(Pulled(p, f), Slipping(slips))
    kept = np.maximum(p, 0)
    bound = (mu or 0) * kept
    given, missed = (np.abs(f) + 0 * p, bound - abs(f)) if slips else (bound, 0 * p)
    held = np.clip(f, -given, given)

    def Normal(w):
        return k / 2 * np.maximum(w, 0) ** 2 + kept ** 2 / (2 * k) - kept * w

    def Rubbed(w):
        return given * np.abs(w) - held * w

    np.testing.assert_allclose(gaps.gap, Normal(r) + Rubbed(s), rtol=1e-8, atol=1e-12)
    cut = price * ((p - kept) ** 2 + (f - held) ** 2 + missed ** 2)
    np.testing.assert_allclose(gaps.cut, cut, rtol=1e-10, atol=1e-12)
    envelope = Least(Normal, gamma, r) + Least(Rubbed, gamma, s)
    # Or the point of the graph on the line t + gamma v, which costs what differs, with a mean more.
    deep = np.where(kept + gamma * r > 0, (kept + gamma * r) / (k + gamma), (kept + gamma * r) / gamma)
    q = np.clip(f, -bound, bound) + gamma * s
    rubbed = np.clip(q, -bound, bound)
    other = gamma / 2 * (r - deep) ** 2 + (q - rubbed - gamma * s) ** 2 / (2 * gamma)
    cost = 0
    for replaced in (p - k * np.maximum(deep, 0), f - rubbed):
        middle = (np.bincount(facet, gaps.weights * replaced) * SIDES)[facet]
        # The extent of Gamma_C is that of its points, which is some percent less than 1.
        cost = cost + price * ((replaced - middle) ** 2 + (1 + np.log2(SIDES)) * middle ** 2)
    totals = [np.bincount(facet, gaps.weights * both) for both in (2 * envelope + cut, 2 * other + cost)]
    better = (totals[1] < totals[0])[facet]
    np.testing.assert_allclose(gaps.envelope, np.where(better, other, envelope), rtol=1e-4, atol=1e-7)
    np.testing.assert_allclose(gaps.infeasible, np.where(better, cost, cut), rtol=1e-2, atol=1e-10)
    # The same choice by gaps instead of envelopes, for the bound.
    there = k * np.maximum(deep, 0)
    left = k / 2 * np.maximum(r, 0) ** 2 + there ** 2 / (2 * k) - there * r + bound * np.abs(s) - rubbed * s
    totals = [np.bincount(facet, gaps.weights * both) for both in (2 * gaps.gap + cut, 2 * left + cost)]
    softer = (totals[1] < totals[0])[facet]
    np.testing.assert_allclose(gaps.softgap, np.where(softer, left, gaps.gap), rtol=1e-8, atol=1e-12)
    np.testing.assert_allclose(gaps.softcut, np.where(softer, cost, cut), rtol=1e-2, atol=1e-10)


def test_both_tractions_are_taken_somewhere():
    """A soft foundation keeps no traction off its law, a stiff one keeps one that only costs penetration."""
    taken = []
    for k, r, mean in ((0.05, 0.2, 0.3), (1e4, 0.02, 10.0)):
        at = Points(NormalCompliance(k), None, r, 0)
        taken.append(at.Gaps(Pulled(np.full(len(at.quadrature.weights), mean), 0.0), Slipping(False)).infeasible.max())
    assert taken[0] > 1e-3 and taken[1] == 0


def test_friction_that_weakens_has_the_bound_of_its_slip():
    law, slip, pressure, pull = SlipWeakeningFriction(0.5, 0.2, 0.1), 0.05, 3.0, 0.4
    at = Points(NormalCompliance(100), law, pressure / 100, slip)
    gaps = at.Gaps(Pulled(np.full(len(at.quadrature.weights), pressure), pull), Slipping(False))
    bound = law.Coefficient(slip)[0] * pressure
    np.testing.assert_allclose(gaps.gap, (bound - pull) * slip, rtol=1e-8)
    assert bound < 0.5 * pressure - 0.1     # control: that without slip is another one


class Saturating:
    """A law whose pressure stays below one."""

    def Pressure(self, r):
        return np.maximum(r, 0) / (1 + np.maximum(r, 0))

    def PressureDerivative(self, r):
        return np.where(r > 0, 1 / (1 + np.maximum(r, 0)) ** 2, 0)


def test_no_pressure_is_beyond_the_largest_of_a_law():
    """What is beyond it is cut off; the gap, with the largest pressure, is finite."""
    at = Points(Saturating(), None, 0.5, 0)
    gaps = at.Gaps(Pulled(np.full(len(at.quadrature.weights), 3.0), 0.0), Slipping(False))
    # A hundred penetrations deep the pressure is within two percent of the largest.
    np.testing.assert_allclose(gaps.cut, (3 - 1) ** 2 / (SIDES * 2 * MU), rtol=0.02)
    assert np.all(np.isfinite(gaps.gap))
    feasible = at.Gaps(Pulled(np.full(len(at.quadrature.weights), 0.9), 0.0), Slipping(False))
    assert not feasible.cut.any()           # control


@pytest.mark.parametrize("stiffness, pressure, lowered", [(1e4, 1.0, True), (1e4, 150.0, True), (1e3, 90.0, False),
                                                          (10, 0.01, False)])
def test_v_is_lowered_where_that_costs_less_than_the_gap(stiffness, pressure, lowered):
    """By the excess e of the penetration over that of the pressure, if k e^2/2 > (p + gamma e) e."""
    at, r = Points(NormalCompliance(stiffness), None, 0.1, 0), 0.1
    excess = r - pressure / stiffness
    assert (stiffness * excess / 2 > pressure + 2 * MU * SIDES * excess) == lowered
    found = at.Excess(Pulled(np.full(len(at.quadrature.weights), pressure), 0.0))
    np.testing.assert_allclose(found, excess if lowered else 0, rtol=1e-8)
