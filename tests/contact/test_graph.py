"""The graph of the contact law: pairs on it, its derivative, zones, Lipschitz constants, and the distance to it.

Whether a pair obeys the law is decided here from (2.7)-(2.9) alone, with formulas of the laws typed again.
"""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from ngdgc import (LDG, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, NormalCompliance,
                   PowerFriction, ProblemError, SlipWeakeningFriction, TrescaFriction)
from ngdgc.contact.graph import SEPARATION, SLIP, STICK, ContactGraph, Distance
from ngdgc.meshes import BoxMesh, RectangleMesh

STIFF = 1e12
COMPLIANCES = [(50.0, 0.5), (50.0, 1), (50.0, 1.5), (50.0, 3), (STIFF, 1), (STIFF, 1.5), (0.0, 1)]
# A law and its formula p_t(r, p, s).
FRICTIONS = {"none": (None, lambda r, p, s: 0 * r), "coulomb": (CoulombFriction(0.4), lambda r, p, s: 0.4 * p),
             "power": (PowerFriction(30.0, 2), lambda r, p, s: 30 * np.maximum(r, 0) ** 2),
             "tresca": (TrescaFriction(3.0), lambda r, p, s: 3 + 0 * r),
             "weakening": (SlipWeakeningFriction(0.6, 0.3, 2.0), lambda r, p, s: (0.3 + 0.3 * np.exp(-s / 2)) * p),
             "hardening": (SlipWeakeningFriction(0.3, 0.6, 0.1), lambda r, p, s: (0.6 - 0.3 * np.exp(-s / 0.1)) * p)}
PLACES = "weights", "normals", "gap", "Normal", "dim", "origin"     # what the graph asks a ContactBoundary for
GAMMAS = [0.5, 20.0, 1e3]


@cache     # no test changes a mesh
def Mesh(dim):
    return RectangleMesh(100) if dim == 2 else BoxMesh(7, cells="hex")


def Contact(dim, compliance, friction, gap=0.02):
    """200 points with random normals: a ContactBoundary whose foundation is round."""
    foundation = Foundation("bottom", NormalCompliance(*compliance), friction=FRICTIONS[friction][0], gap=gap)
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), foundation, dirichlet={"top": (0,) * dim})
    contact = Discretization(problem, LDG(), Mesh(dim), order=1).contact
    contact.flexibility = 0.0       # the scale of displacements is the largest of them, whatever a body would do
    normals = np.random.default_rng(5).standard_normal(contact.normals.shape)
    contact.normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    return contact


CACHE = {}


def Setting(dim, compliance, friction):
    """(contact, random q of all sizes): tractions from 1e-3 to 1e2, a third of them pulling, some without a tangential part."""
    key = dim, compliance, friction
    if key not in CACHE:
        CACHE[key] = Contact(dim, compliance, friction)
    contact, random = CACHE[key], np.random.default_rng(7)
    n = len(contact.weights)
    q = random.standard_normal((n, dim)) * 10 ** random.uniform(-3, 2, n)[:, None]
    q[::3] += 2 * np.abs(q[::3]).max(axis=1)[:, None] * contact.normals[::3]
    q[::17] = contact.Normal(q)[::17, None] * contact.normals[::17]
    return contact, q


def Violation(contact, compliance, friction, u, t, uscale, tscale):
    """By how much pairs (u, t) violate (2.7)-(2.9), (n,), relative to the scales; 0 on the graph."""
    k, m = compliance
    un, p = np.sum(u * contact.normals, axis=1), np.sum(t * contact.normals, axis=1)
    ut, tt = u - un[:, None] * contact.normals, t - p[:, None] * contact.normals
    r, s = un - contact.gap, np.linalg.norm(ut, axis=1)
    # p = p_n(r), seen from whichever side is not steep.
    steep = k * m * np.maximum(r, 1e-300) ** (m - 1) > tscale / uscale
    inverse = (np.maximum(p, 0) / k) ** (1 / m) if k else 0 * p
    normal = np.where(steep & (r > 0), np.abs(r - inverse) / uscale, np.abs(p - k * np.maximum(r, 0) ** m) / tscale)
    bound = FRICTIONS[friction][1](inverse if k else r, np.maximum(p, 0), s)
    excess = np.maximum(np.linalg.norm(tt, axis=1) - bound, 0) / tscale
    opposed = np.linalg.norm(tt - bound[:, None] * ut / np.where(s > 0, s, 1)[:, None], axis=1) / tscale
    # u_t = 0 comes out of a difference of two equal vectors.
    return np.max([normal, excess, np.where(s > 1e-13 * uscale, opposed, 0)], axis=0)


@pytest.mark.slow
@pytest.mark.parametrize("gamma", GAMMAS)
@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize("compliance", COMPLIANCES, ids=lambda law: f"{law[0]:g}^{law[1]}")
@pytest.mark.parametrize("dim", [2, 3])
def test_every_q_has_its_pair_on_the_graph(dim, compliance, friction, gamma):
    if friction == "weakening" and gamma < 10:
        gamma = 1e3         # p <= 300 weakens by at most 0.15 p, more than a small gamma: then q has several pairs
    contact, q = Setting(dim, compliance, friction)
    at = ContactGraph(contact, gamma).At(q)
    size = np.linalg.norm(q, axis=1)
    tscale = np.maximum(size, gamma * contact.gap)
    # 1e-13 and not 1e-15: r = u_n - g cancels where r is small, which the stiffness of the law amplifies.
    assert np.abs(at.traction + gamma * at.displacement - q).max(axis=1) == pytest.approx(0 * size, abs=1e-13 * tscale.max())
    violation = Violation(contact, compliance, friction, at.displacement, at.traction, tscale / gamma, tscale)
    assert violation.max() < 1e-11
    slid = np.linalg.norm(at.displacement - contact.Normal(at.displacement)[:, None] * contact.normals, axis=1)
    # Friction, which Tresca's law has without contact, leaves round-off in the normal component.
    touching = contact.Normal(at.traction) > 1e-13 * size
    assert np.all((at.zones == SEPARATION) == ~touching)
    assert np.all(slid[at.zones == STICK] < 1e-14 * tscale.max() / gamma)
    if friction in ("coulomb", "power"):
        assert {SEPARATION, SLIP} <= set(at.zones.tolist()) or compliance[0] == 0
    # Control: pairs moved off the graph are seen.
    moved = at.displacement + 0.3 * (tscale / gamma)[:, None] * contact.normals
    seen = Violation(contact, compliance, friction, moved, at.traction, tscale / gamma, tscale) > 1e-3
    assert np.any(seen) or compliance[0] == 0


@pytest.mark.slow
@pytest.mark.parametrize("gamma", [20.0, 1e3])
@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize("compliance", COMPLIANCES, ids=lambda law: f"{law[0]:g}^{law[1]}")
@pytest.mark.parametrize("dim", [2, 3])
def test_derivative_against_central_differences(dim, compliance, friction, gamma):
    if friction == "weakening":
        gamma = 1e3
    contact, q = Setting(dim, compliance, friction)
    graph = ContactGraph(contact, gamma)
    at, step = graph.At(q), 1e-5 * np.linalg.norm(q, axis=1)
    smooth = np.ones(len(q), dtype=bool)
    columns = []
    for unit in np.eye(dim):
        forward, backward = graph.At(q + step[:, None] * unit), graph.At(q - step[:, None] * unit)
        # Kinks are where a zone changes and where q_n passes gamma g.
        smooth &= (forward.zones == at.zones) & (backward.zones == at.zones)
        ahead, behind = (forward.traction - at.traction) / step[:, None], (at.traction - backward.traction) / step[:, None]
        smooth &= np.abs(ahead - behind).max(axis=1) < 1e-3
        columns.append((ahead + behind) / 2)
    difference = np.moveaxis(columns, 0, 2)
    assert smooth.mean() > 0.8
    error = np.abs(difference - at.derivative).max(axis=(1, 2))[smooth]
    assert error.max() < 1e-5
    wrong = np.abs(difference - np.swapaxes(at.derivative, 1, 2)).max(axis=(1, 2))[smooth]
    # Control: friction that depends on the pressure makes the derivative unsymmetric; a stiff foundation has no penetration.
    symmetric = friction in ("none", "tresca") or compliance[0] == 0 or friction == "power" and compliance[0] == STIFF
    assert wrong.max() > 1e-3 or symmetric


@pytest.mark.slow
@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize("compliance", COMPLIANCES, ids=lambda law: f"{law[0]:g}^{law[1]}")
def test_traction_is_a_lipschitz_function_of_q_however_stiff_the_law(compliance, friction):
    """The normal part with the constant 1, friction with 1 + L, L that of the bound by p and, through 1/gamma, by r."""
    contact, q = Setting(3, compliance, friction)
    gamma, random = 1e3, np.random.default_rng(1)
    graph = ContactGraph(contact, gamma)
    constant = {"none": 0, "coulomb": 0.4, "tresca": 0, "weakening": 0.6, "hardening": 0.6,
                "power": 60 * np.linalg.norm(q, axis=1).max() * 2 / gamma ** 2}[friction]
    for size in (1e-8, 1e-3, 1.0):
        other = q + size * random.standard_normal(q.shape) * np.linalg.norm(q, axis=1)[:, None]
        change = np.linalg.norm(graph.At(other).traction - graph.At(q).traction, axis=1)
        # Weakening by at most 0.15 p <= 60 against gamma = 1000.
        assert np.all(change <= (1 + constant) * 1.1 * np.linalg.norm(other - q, axis=1) + 1e-12)
    assert change.max() > 1e-2 or friction != "tresca" and compliance[0] == 0


def test_zones_of_pairs_that_are_known():
    """q = t + gamma u of pairs written down; n = (0, -1), p = 50 r, gap 0.02, Coulomb's coefficient 0.4."""
    contact = Contact(2, (50.0, 1), "coulomb")
    contact.normals = np.tile([0.0, -1.0], (len(contact.weights), 1))
    pairs = [((0.3, 0.1), (0, 0), SEPARATION), ((0, -0.12), (1.9, -5), STICK), ((0, -0.12), (-1.9, -5), STICK),
             ((0.1, -0.12), (2, -5), SLIP), ((-0.1, -0.12), (-2, -5), SLIP)]
    u, t = (np.zeros(contact.normals.shape) for _ in range(2))
    for row, (displacement, traction, _) in enumerate(pairs):
        u[row], t[row] = displacement, traction
    for gamma in (*GAMMAS, np.geomspace(0.1, 10, len(u))):
        graph = ContactGraph(contact, gamma)
        at = graph.At(graph.Coordinates(u, t))
        assert at.displacement == pytest.approx(u, abs=1e-14) and at.traction == pytest.approx(t, abs=1e-13)
        assert at.zones[:len(pairs)].tolist() == [zone for _, _, zone in pairs]
    # Control: a traction above the bound is no pair, so another one is found.
    t[1] = 2.1, -5
    graph = ContactGraph(contact, 20.0)
    assert np.abs(graph.At(graph.Coordinates(u, t)).traction[1] - t[1]).max() > 0.01


@pytest.mark.slow
@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize("compliance", COMPLIANCES, ids=lambda law: f"{law[0]:g}^{law[1]}")
@pytest.mark.parametrize("dim", [2, 3])
def test_distance_vanishes_on_the_graph_and_grows_off_it(dim, compliance, friction):
    contact, q = Setting(dim, compliance, friction)
    at = ContactGraph(contact, 1e3).At(q)
    found = Distance(contact, at.displacement, at.traction)
    # 1e-11 where friction is so small that it is measured by a part of the traction.
    assert found.distance.max() < (1e-10 if friction == "power" else 1e-12)
    clear = np.abs(np.linalg.norm(contact.Tangential(at.traction), axis=1)
                   - FRICTIONS[friction][1](contact.Penetration(at.displacement), contact.Normal(at.traction),
                                            contact.Slip(at.displacement))) > 1e-9
    sure = clear | (at.zones != STICK)
    assert np.mean(found.zones[sure] == at.zones[sure]) == 1
    pushed = at.traction + 0.1 * (np.linalg.norm(at.traction, axis=1).max() or 1) * contact.normals
    off = Distance(contact, at.displacement - 0.1 * np.abs(at.displacement).max() * contact.normals, pushed).distance
    assert off.min() > 1e-3


def Minimum(compliance, r, p, uscale, tscale):
    """min(|p - p_n(r)|/t_s, |r - p_n^-1(p)|/u_s) of design and paper, with p_n^-1(0) all of r <= 0."""
    k, m = compliance
    inverse = np.where(p > 0, (np.maximum(p, 0) / k) ** (1 / m), np.minimum(r, 0))
    # A negative p is off the graph by |p|, whatever r.
    sideways = np.where(p < 0, np.inf, np.abs(r - inverse) / uscale)
    return np.minimum(np.abs(p - k * np.maximum(r, 0) ** m) / tscale, sideways)


def Ratios(compliance, friction, size):
    """Distance over minimum for random pairs `size` away from a graph, relative to each r and p, and to the largest; p > 0."""
    contact, q = Setting(2, compliance, friction)
    at, random = ContactGraph(contact, 1e3).At(q), np.random.default_rng(2)
    r, p = contact.Penetration(at.displacement), contact.Normal(at.traction)
    for local in (True, False):
        rsize, psize = (np.abs(values) if local else np.abs(values).max() for values in (r, p))
        shifted = r + size * rsize * random.standard_normal(len(q))
        pressed = p + size * psize * random.standard_normal(len(q))
        u, t = (contact.gap + shifted)[:, None] * contact.normals, pressed[:, None] * contact.normals
        us, ts = (np.linalg.norm(values, axis=1).max() for values in (u, t))
        yield Distance(contact, u, t).distance / np.maximum(Minimum(compliance, shifted, pressed, us, ts), 1e-14), p > 0


@pytest.mark.parametrize("size", [1e-5, 1e-3, 0.03])
@pytest.mark.parametrize("compliance", COMPLIANCES[:-1], ids=lambda law: f"{law[0]:g}^{law[1]}")
def test_distance_is_the_minimum_of_both_ways_up_to_a_factor_two(compliance, size):
    """Never more than the minimum; at least half where the slope of the law hardly changes between the pair and the graph."""
    (near, touching), (far, _) = Ratios(compliance, "none", size)
    assert np.all(far < 1 + 1e-6)
    if compliance[0] == STIFF:
        return      # there r is known to round-off of the gap only, and a relative shift of r means nothing
    assert np.all(near < 1 + 1e-6)
    # A pair at relative distance `size` sees slopes that differ by the factor 1 + O(size).
    assert np.all(near[touching] > 0.5 * (1 - 10 * size))
    assert np.any(near[touching] < 0.9)


def test_a_law_that_returns_nan_is_reported():
    contact, q = Setting(2, (50.0, 1), "none")
    broken = SimpleNamespace(Pressure=lambda r: r * np.nan, PressureDerivative=lambda r: r * np.nan)
    part, = contact.parts
    sick = SimpleNamespace(**{name: getattr(contact, name) for name in PLACES},
                           parts=[replace(part, compliance=broken)])
    ContactGraph(contact, 1.0).At(q)
    with pytest.raises(ProblemError, match="not finite"):
        ContactGraph(sick, 1.0).At(q)
    nan = SimpleNamespace(Bound=lambda r, p: p, Coefficient=lambda s: (s * np.nan, s * np.nan))
    sick.parts = [replace(part, friction=nan)]
    with pytest.raises(ProblemError, match="not finite"):
        ContactGraph(sick, 1.0).At(q)


def test_a_law_that_ends_at_some_penetration_has_its_pairs_below():
    """p_n = -ln(1 - 100 r), undefined from r = 0.01 on; r = (1 - exp(-p))/100 is its inverse."""
    contact, q = Setting(2, (50.0, 1), "none")
    part, = contact.parts

    def Pressure(r):
        with np.errstate(all="ignore"):
            return np.where(r > 0, -np.log(1 - 100 * np.maximum(r, 0)), 0)

    barrier = SimpleNamespace(Pressure=Pressure, PressureDerivative=lambda r: np.where(r > 0, 100 / (1 - 100 * r), 0))
    ended = SimpleNamespace(**{name: getattr(contact, name) for name in PLACES},
                            parts=[replace(part, compliance=barrier)])
    for gamma in GAMMAS:
        at = ContactGraph(ended, gamma).At(q)
        r, p = contact.Penetration(at.displacement), contact.Normal(at.traction)
        # u_n - g is what is left of a large slip.
        roundoff = 1e-15 * np.abs(at.displacement).max() + 1e-14
        assert np.any(p > 5) and np.all(r < 0.01 + roundoff)
        assert r[p > 1e-12] == pytest.approx(-np.expm1(-p[p > 1e-12]) / 100, abs=roundoff)
        assert at.traction + gamma * at.displacement == pytest.approx(q, abs=1e-12)


def test_distance_to_a_law_that_is_not_monotone_vanishes_on_its_graph():
    """p_n = 50 r up to r = 0.1 and 0 beyond: the line through a pair before the drop meets the graph beyond it, too."""
    contact, _ = Setting(2, (50.0, 1), "none")
    part, = contact.parts
    drop = SimpleNamespace(Pressure=lambda r: np.where((r > 0) & (r < 0.1), 50 * r, 0),
                           PressureDerivative=lambda r: np.where((r > 0) & (r < 0.1), 50.0, 0))
    broken = SimpleNamespace(**{name: getattr(contact, name) for name in ("weights", "normals", "gap", "Normal", "Tangential",
                                                                          "Penetration", "SinceOrigin", "dim", "flexibility")},
                             parts=[replace(part, compliance=drop)])
    r = np.linspace(-0.1, 0.3, len(contact.weights))
    u, t = (r + contact.gap)[:, None] * contact.normals, drop.Pressure(r)[:, None] * contact.normals
    found = Distance(broken, u, t)
    assert found.distance.max() < 1e-13
    assert np.array_equal(found.zones == SEPARATION, drop.Pressure(r) == 0)
    # Control: half the pressure is no pair.
    assert np.all(Distance(broken, u, t / 2).distance[drop.Pressure(r) > 1] > 1e-2)
