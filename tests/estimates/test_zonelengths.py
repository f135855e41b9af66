"""Lengths of zones with their estimated errors: the truth is where they say, and a wrong traction is seen."""

import numpy as np
import pytest
from ngsolve.meshes import MakeStructured2DMesh

from ngdgc import LDG, Conforming, Discretization, EstimateZones, InteriorPenalty, NestedNewtonSolver, ProblemError
from ngdgc.cases import example_4_2, hertz_sphere
from ngdgc.contact.boundary import ContactBoundary
from ngdgc.meshes import UnitMesh
from ngdgc.studies.samples import Draw
from ngdgc.traces import ThreeZones

ENDS = 0.27, 0.71       # no vertex of a uniform mesh
TRUE = {"separation": 1 - ENDS[1], "stick": ENDS[0], "slip": ENDS[1] - ENDS[0]}


@pytest.mark.parametrize("method", [InteriorPenalty(), LDG(form="lifting"), Conforming()])
def test_ends_inside_of_facets_are_where_the_errors_allow(method):
    """The worst of three meshes is off by at least a third of what is estimated, and by five times that at most.

    Pressure begins like the third power of the distance, and the friction in reserve like the second, so that a small error of
    the traction moves both ends far: the worst that is known.
    """
    exact, worst = ThreeZones(ends=ENDS, reserve=8.0), 0.0
    for n in (8, 16, 32):
        mesh = MakeStructured2DMesh(quads=False, nx=n, ny=n // 2)
        solution = NestedNewtonSolver().Solve(Discretization(exact.problem, method, mesh, order=2))
        lengths, errors = solution.ZoneLengths(), EstimateZones(solution)
        ratios = [abs(lengths[name] - TRUE[name]) / errors[name] for name in TRUE]
        assert max(ratios) < 5
        worst = max(worst, *ratios)
    assert worst > 1 / 3


@pytest.mark.parametrize("method", [InteriorPenalty(), LDG(form="lifting")])
def test_zones_of_an_exact_solution_are_sure(method):
    """Order 4 holds the three zones, which end at vertices: both tractions are the true one.  Order 2 does not hold them."""
    solutions = [NestedNewtonSolver().Solve(Discretization(ThreeZones().problem, method, UnitMesh(4, "triangle"), order=order))
                 for order in (4, 2)]
    sure, unsure = map(EstimateZones, solutions)
    assert set(sure.values()) == {0.0} and max(unsure.values()) > 0


def test_errors_fall_with_the_mesh_and_belong_to_zones_that_end():
    found = [EstimateZones(example_4_2.Main(n=n, order=2)) for n in (8, 32)]
    assert found[1]["slip"] < 0.5 * found[0]["slip"]
    for errors in found:
        # Whatever leaves one zone comes into another.
        assert max(errors.values()) <= sum(errors.values()) - max(errors.values()) + 1e-12


def test_another_traction_is_seen():
    """A pressure that is not the body's, everywhere: the two tractions tell different zones apart."""
    solution = example_4_2.Main(n=8, order=2)
    before = EstimateZones(solution)
    solution.traction += 1000 * solution.pressure.max() * solution.normals
    assert EstimateZones(solution)["separation"] > 5 * before["separation"]


def test_tractions_are_continued_exactly_between_contact_points():
    """In 2D the k + 1 contact points of a facet fix a polynomial of degree k; one of degree k + 1 is not met."""
    disc = Discretization(example_4_2.Problem(), LDG(), UnitMesh(4, "triangle"), order=2)
    fine = ContactBoundary(disc.problem, disc.facets, disc.space, disc.method.ScalarSpace(disc.mesh, 2), 12)
    for degree, exact in ((2, True), (3, False)):
        here, there = (np.column_stack([c.coordinates[:, 0] ** degree, 1 - c.coordinates[:, 0]]) for c in (disc.contact, fine))
        assert (np.abs(disc.contact.TraceProjection(here, there=fine) - there).max() < 1e-10) == exact


def test_in_space_the_radius_of_a_contact_is_known_to_a_part_of_an_element():
    solution = hertz_sphere.Main(n=4, order=1)
    errors = EstimateZones(solution)
    lengths, total = solution.ZoneLengths(), solution.weights.sum()
    assert 0 < errors["separation"] < 0.5 * total and errors["separation"] < lengths["separation"]


def test_a_random_problem_with_all_three_zones():
    """Seed 1, problem 0: 26 x 26 squares; the truth is on a mesh four times as fine, order 3."""
    sample = Draw(1, 0)
    fine = NestedNewtonSolver().Solve(Discretization(sample.problem, Conforming(), UnitMesh(52, "triangle"), order=3))
    solution = NestedNewtonSolver().Solve(sample.Disc())
    errors, truth = EstimateZones(solution), fine.ZoneLengths()
    assert all(0 < abs(length - truth[name]) < errors[name] for name, length in solution.ZoneLengths().items())


def test_what_is_no_solution():
    with pytest.raises(ProblemError, match="solution is 3"):
        EstimateZones(3)
