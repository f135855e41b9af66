"""Laws on several foundations at once: each has its own points, and where there is no friction there is none."""

import numpy as np
import pytest
from ngsolve import x

from ngdgc import (ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, SlipWeakeningFriction)
from ngdgc.contact.parts import ContactPart, OverParts
from ngdgc.meshes import RectangleMesh


@pytest.fixture(scope="module")
def contact():
    foundations = [Foundation("bottom", NormalCompliance(50 * (1 + x)), friction=CoulombFriction(0.3 * x)),
                   Foundation("left", NormalCompliance(20, 2)),
                   Foundation("right", NormalCompliance(30, 0.5), friction=SlipWeakeningFriction(0.6, 0.3, 0.1))]
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), foundations, dirichlet={"top": (0, 0)})
    return Discretization(problem, InteriorPenalty(), RectangleMesh(3)).contact


def Random(contact, seed, low, high):
    return np.random.default_rng(seed).uniform(low, high, len(contact.weights))


def test_parts_are_one_after_the_other_and_all(contact):
    assert [part.foundation.boundary for part in contact.parts] == ["bottom", "left", "right"]
    numbers = np.arange(len(contact.weights))
    assert np.array_equal(OverParts(contact.parts, lambda part, values: values, numbers), numbers)
    assert [part.friction is None for part in contact.parts] == [False, True, False]


def test_each_law_is_asked_at_its_own_points(contact):
    """Against the formulas typed again, with the coordinates of all points; in another order of parts they would differ."""
    r, s, along = Random(contact, 0, -0.1, 0.2), Random(contact, 1, 0, 0.3), contact.coordinates[:, 0]
    bottom, left, right = (np.zeros(len(r), bool) for _ in range(3))
    for mine, part in zip((bottom, left, right), contact.parts):
        mine[part.points] = True
    depth = np.maximum(r, 0)
    p = np.select([bottom, left, right], [50 * (1 + along) * depth, 20 * depth ** 2, 30 * depth ** 0.5])
    friction = np.select([bottom, left, right], [0.3 * along, 0 * r, 0.3 + 0.3 * np.exp(-s / 0.1)])
    assert contact.Pressure(r) == pytest.approx(p, rel=1e-14)
    assert contact.Bound(r, s) == pytest.approx(friction * p, rel=1e-14)
    turned = OverParts(contact.parts[::-1], ContactPart.Pressure, r)
    assert np.abs(turned - p).max() > 0.1


def test_points_of_the_graph_solve_their_scalar_equations(contact):
    """p + gamma r = q and p_t + gamma s = length with the values returned; the derivatives are those of the law there.

    Both equations are solved to 4e-16 of their right-hand side.
    """
    gamma, q, length = Random(contact, 2, 1, 100), Random(contact, 3, -5, 20), Random(contact, 4, 0, 8)
    r, p, slope = OverParts(contact.parts, ContactPart.NormalPoint, gamma, q)
    assert p + gamma * r == pytest.approx(q, abs=1e-13) and np.array_equal(p > 0, q > 0)
    assert p == pytest.approx(contact.Pressure(r), rel=1e-12, abs=1e-13)
    assert slope[q > 0] == pytest.approx(contact.PressureDerivative(r)[q > 0], rel=1e-12)
    bound = OverParts(contact.parts, ContactPart.Bound, r, p)
    s, factor, _ = OverParts(contact.parts, ContactPart.SlipPoint, gamma, bound, length)
    sliding = length > contact.Bound(r, 0 * r)
    assert (bound * factor + gamma * s)[sliding] == pytest.approx(length[sliding], abs=1e-13)
    assert np.all(s[~sliding] <= 0) and 0 < sliding.sum() < len(r)
    # Control: where there is friction its law counts, elsewhere all of the length is slip.
    smooth = contact.parts[1].points
    assert s[smooth] == pytest.approx(length[smooth] / gamma[smooth], rel=1e-15) and np.all(bound[smooth] == 0)
    assert np.abs(s - length / gamma)[contact.parts[2].points].max() > 1e-3
