"""A quadrature that is divided where contact ends: the law is integrated exactly, and forces lose an error of their own."""

import numpy as np
import pytest
from bodies import Layers
from jointed import MID
from mistakes.saved import Edited
from ngsolve import CF, SEGM, TRIG, IfPos, IntegrationRule, y

from ngdgc import (LDG, ContactProblem, ContactSolution, CoulombFriction, Discretization, EstimateError, EstimateForce,
                   Foundation, HookeMaterial, InteriorPenalty, Joint, NormalCompliance, ProblemError, Solve, SolveDivided,
                   TrescaFriction)
from ngdgc.cases import example_4_2
from ngdgc.contact.graph import ContactGraph
from ngdgc.estimates.zoneends import PARTS, Openings
from ngdgc.mesh.pieces import Area, Cut, Interval, PiecesArray, PiecesOf, Quarters, Triangles
from ngdgc.mesh.quadrature import BoundaryQuadrature
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.plots import ContactFigure, DeformedFigure
from ngdgc.solution.pointcells import ContactCells

FORCE = 25.14297        # of Example 4.2, on fine meshes
FINE = {2: [Interval(n / 256, (n + 1) / 256) for n in range(256)], 3: Quarters(3, 5)}


def Lifted(dim, exponent=1):
    """A body that is pressed down and pulled up at one side, so that contact ends somewhere."""
    friction = CoulombFriction(0.3) if dim == 2 else TrescaFriction(2)
    foundation = Foundation("bottom", NormalCompliance(500 * 10 ** (exponent - 1), exponent), friction=friction)
    pull = {"left": (0, 20)} if dim == 2 else {"left": (0, 0, 30), "front": (0, 0, 20)}
    return ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, dirichlet={"top": (0.01, *(0,) * (dim - 2), -0.02)},
                          traction=pull)


@pytest.fixture(scope="module", params=[(2, 1, 1), (2, 2, 1), (2, 2, 2), (3, 1, 1)], ids=str)
def pair(request):
    """(solution, divided) in d dimensions, of order k, with p_n = c r^m."""
    dim, order, exponent = request.param
    mesh = RectangleMesh(5) if dim == 2 else BoxMesh(2)
    solution = Solve(Discretization(Lifted(dim, exponent), LDG() if order == 1 else InteriorPenalty(), mesh, order=order))
    return solution, SolveDivided(solution)


def Missed(solution):
    """|int_GammaC p_n(u_h) - normalforce|, the integral by a quadrature of many parts, relative."""
    disc = solution.disc
    numbers = {int(number): FINE[disc.mesh.dim] for number in disc.contact.boundaryelements}
    at = BoundaryQuadrature.On(disc.facets, "bottom", 2 * disc.order, pieces=numbers)
    r = np.einsum("ni,ni->n", np.asarray(solution.gfu(at.inside)).reshape(at.normals.shape), at.normals)
    return abs(at.weights @ disc.problem.foundation[0].compliance.Pressure(r) / solution.normalforce - 1)


def test_pressure_of_the_law_is_integrated_exactly_where_contact_ends_in_no_part(pair):
    """u_h is a polynomial: on parts where all of it is in contact, so is p_n(u_h), of a degree that the rule is made for."""
    solution, divided = pair
    plane = solution.disc.mesh.dim == 2
    # The end is missed by a part of the facet, the integral by its square; curved lines, which parts have not, by more.
    assert Missed(solution) > 3e-5 and Missed(divided) < (Missed(solution) / 100 if plane else Missed(solution) / 5)
    if plane:       # the ends of a solution that is nearly the same are found better among more points
        assert Missed(SolveDivided(divided)) < max(Missed(divided) / 10, 3e-6)


def test_divided_solutions_are_solutions(pair):
    solution, divided = pair
    assert divided.converged and divided.GlobalImbalance() < 1e-11 and divided.ElementImbalance().max() < 1e-10
    assert divided.disc.matrix is solution.disc.matrix and len(divided.weights) > len(solution.weights)
    np.testing.assert_allclose(divided.weights.sum(), solution.weights.sum(), rtol=1e-13)
    # Within every part all points are in contact, or none is.
    parts = {number: len(found) for number, found in divided.disc.pieces.items()}
    assert divided.levels[:-1] == solution.levels and divided.levels[-1].points == len(divided.weights)
    assert divided.disc.solves == divided.levels[-1].solves <= 10       # its own, not those before
    if divided.disc.mesh.dim == 2:
        for number, count in parts.items():
            zones = np.split(divided.zones[divided.disc.contact.boundaryelements == number] > 0, count)
            assert all(np.ptp(part.astype(int)) == 0 for part in zones) and len({bool(part[0]) for part in zones}) == 2
    energies = EstimateError(solution).value, EstimateError(divided).value
    assert abs(energies[1] / energies[0] - 1) < 0.01       # the mesh carries no more


@pytest.mark.parametrize("n", [8, 16])
def test_force_of_a_soft_foundation_loses_most_of_its_error(n):
    solution = example_4_2.Main(order=2, n=n)
    divided = SolveDivided(solution)
    before, after = (one.normalforce - FORCE for one in (solution, divided))
    assert abs(after) < abs(before) / 5 and -2e-3 < after < -1e-3      # before: 1.6e-2, -1.2e-2, as the end lies
    # What is corrected has this error no more, and is the same.
    first, second = (EstimateForce(one) for one in (solution, divided))
    assert abs(first.corrected["bottom"][1] - second.corrected["bottom"][1]) < 1e-5
    assert abs(second.error["bottom"][1]) < abs(first.error["bottom"][1]) / 5


def Parts(et, above, along=0.0, bound=0.0):
    """Parts of a segment or triangle for levels that are functions of the place."""
    places = np.array(IntegrationRule(et, 4).points)[:, :1 if et == SEGM else 2]
    levels = [np.array([one(*place) if callable(one) else one for place in places]) for one in (above, along, bound)]
    return PARTS[et](places, *levels)


@pytest.mark.parametrize("end", [0.02, 0.3, 0.98])
def test_ends_of_zones_are_where_linear_levels_are_zero(end):
    """Also beyond the outermost points of the quadrature, which are 0.11 from the ends of the segment."""
    for level in (lambda s: s - end, lambda s: end - s):        # contact on either side
        first, second = Parts(SEGM, level, bound=0.3)
        np.testing.assert_allclose([first.origin[0], first.matrix[0, 0], second.origin[0]], [0, end, end], atol=1e-14)
    for along in (lambda s: s, lambda s: -s):       # slip forwards or backwards beyond the end of stick
        first, second = Parts(SEGM, 1.0, along=along, bound=end)
        assert second.origin[0] == pytest.approx(end, abs=1e-14)
    both = Parts(SEGM, 1.0, along=lambda s: s - 0.5, bound=0.2)
    np.testing.assert_allclose([part.origin[0] for part in both], [0, 0.3, 0.7], atol=1e-14)
    # One zone, also where friction is without bound and its direction turns, is not divided.
    assert all(len(Parts(SEGM, 1.0, along=along)) == 1 for along in (0.0, lambda s: s - end))
    assert len(Parts(SEGM, lambda s: s + 1e-3)) == 1


def test_triangles_are_cut_between_zones():
    def Sides(parts, level):
        """Values of a level at the corners of parts."""
        corners = np.array([(0, 0), (1, 0), (0, 1)])
        return [[level(*(part.origin + part.matrix @ corner)) for corner in corners] for part in parts]

    def Above(s, t):
        return s + 0.5 * t - 0.4

    def Beyond(s, t):
        return s + 0.1 - (0.2 + 0.9 * t)

    opened = Parts(TRIG, Above, along=1.0, bound=0.5)
    assert len(opened) == 3 and all(min(values) > -1e-12 or max(values) < 1e-12 for values in Sides(opened, Above))
    sticking = Parts(TRIG, 1.0, along=lambda s, t: s + 0.1, bound=lambda s, t: 0.2 + 0.9 * t)
    assert len(sticking) > 1 and all(min(values) > -1e-12 or max(values) < 1e-12 for values in Sides(sticking, Beyond))
    assert len(Parts(TRIG, 1.0, along=1.0, bound=0.5)) == 1 and len(Parts(TRIG, -1.0)) == 1


def test_a_bond_ends_where_its_tension_is_reached():
    """The zero level is that below which the law pulls with its tension: q_n = -T - gamma (depth - g)."""
    joint = Joint("mid", NormalCompliance(500), tension=2.0, gap=0.001)
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), joint, dirichlet={"bottom": (0, 0), "top": (0, 0.01)})
    contact = Discretization(problem, LDG(), Layers(2)).contact
    graph = ContactGraph(contact, 700.0)
    opening = -2.0 - 700 * (2.0 / 500 - 0.001)
    for moved, zone in ((1e-6, 1), (-1e-6, 0)):
        q = (opening + moved) * contact.normals
        above = Openings(graph, q)[0]
        assert np.all(np.sign(above) == np.sign(moved)) and np.allclose(above, moved, rtol=1e-6)
        assert np.all((graph.At(q).zones > 0) == zone)


@pytest.mark.parametrize("stiffness, divided", [(500, True), (1e6, False)])
def test_foundations_that_are_stiffer_than_the_body_stay_whole(stiffness, divided):
    """p_n' = 1e6 against 2 mu k/h = 7 700: there the traction has a root where contact ends."""
    foundation = Foundation("bottom", NormalCompliance(stiffness))
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, dirichlet={"top": (0.01, -0.02)},
                             traction={"left": (0, 100)})
    solution = Solve(Discretization(problem, LDG(), RectangleMesh(5), order=2))
    assert set(solution.zones) == {0, 2} and (SolveDivided(solution) is not solution) == divided


def test_where_contact_ends_in_no_facet_nothing_is_divided():
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), Foundation("bottom", NormalCompliance(500)),
                             dirichlet={"top": (0, -0.02)})
    solution = Solve(Discretization(problem, LDG(), RectangleMesh(2)))
    assert SolveDivided(solution) is solution


def test_joint_that_opens_in_part_is_divided_on_both_sides():
    joint = Joint("mid", NormalCompliance(500), friction=CoulombFriction(0.3))
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), joint, dirichlet={"bottom": (0, 0), "top": (0.01, -0.01)},
                             traction={"left": CF((0, IfPos(y - MID, 20, 0)))})
    solution = Solve(Discretization(problem, LDG(), Layers(2), order=2))
    divided = SolveDivided(solution)
    assert len(divided.disc.pieces) == 1 and np.any(divided.zones == 0)
    assert divided.GlobalImbalance() < 1e-11 and divided.ElementImbalance().max() < 1e-10
    assert abs(divided.normalforce / solution.normalforce - 1) > 1e-4     # one facet of four: it matters
    # The law is integrated exactly, as more points there do not change it.
    again = SolveDivided(divided)
    assert abs(again.normalforce - divided.normalforce) < abs(divided.normalforce - solution.normalforce) / 50


def test_divided_solutions_are_kept_and_drawn(pair, tmp_path):
    solution, divided = pair
    divided.Save(tmp_path / "kept")
    again = ContactSolution.Load(tmp_path / "kept", divided.disc.problem)
    np.testing.assert_array_equal(again.traction, divided.traction)
    np.testing.assert_array_equal(again.points, divided.points)
    again.case = "block"
    assert SolveDivided(again).case == "block"
    assert again.normalforce == divided.normalforce
    # A folder without pieces, as version 0.2 wrote it, holds other points.
    with pytest.raises(ProblemError, match="its points differ"):
        ContactSolution.Load(Edited(tmp_path / "kept", without=["pieces", "path", "worn"]), divided.disc.problem)
    solution.Save(tmp_path / "whole")
    assert ContactSolution.Load(Edited(tmp_path / "whole", without=["pieces", "path", "worn"]), divided.disc.problem).converged
    cells = ContactCells(divided.disc)
    np.testing.assert_allclose(cells.weights @ divided.pressure, divided.normalforce, rtol=1e-13)
    ContactFigure(divided), DeformedFigure(divided)


def test_cells_around_points_of_parts_are_as_large_as_their_weights(pair):
    _, divided = pair
    cells, dim = ContactCells(divided.disc), divided.disc.mesh.dim
    for corners, weight in zip(cells.corners, cells.weights):
        at = cells.coordinates[corners][:, :dim - 1]
        assert abs((np.ptp(at) if dim == 2 else Area(at)) - weight) < 1e-9


def test_a_line_cuts_a_triangle_into_parts_that_cover_it():
    triangle = np.array([(1.0, 0.0), (0.0, 1.0), (0.0, 0.0)])
    for slope in np.random.default_rng(1).normal(size=(20, 2)):
        level = triangle @ slope - 0.3 * slope.sum()
        parts = Cut(triangle, level)
        pieces = Triangles(parts)
        assert len(pieces) == (3 if len(parts) == 2 else 1)
        assert abs(sum(abs(np.linalg.det(piece.matrix)) for piece in pieces) - 1) < 1e-14
        for part in parts:      # on one side each
            values = part @ slope - 0.3 * slope.sum()
            assert values.min() > -1e-14 or values.max() < 1e-14
    np.testing.assert_array_equal(PiecesArray(PiecesOf(PiecesArray({3: pieces}, 3), 3), 3), PiecesArray({3: pieces}, 3))
