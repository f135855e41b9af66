"""Gamma_C: the trace matrix, loads, zones, several foundations, and data that vary in space."""

from functools import cache
from math import factorial

import numpy as np
import pytest
from bodies import Plate, Ring
from netgen.csg import CSGeometry, Pnt, Sphere
from netgen.occ import Compound, OCCGeometry, WorkPlane, Y
from ngsolve import QUAD, SEGM, TRIG, VOL, CF, ElementId, GridFunction, Integrate, LinearForm, Mesh, ds, exp, sin, x, y
from ngsolve.meshes import MakeStructured3DMesh
from problems import METHODS, Example

from ngdgc import (Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, TrescaFriction, UzawaSolver)
from ngdgc.discrete import divided
from ngdgc.contact.graph import SEPARATION, SLIP, STICK, Distance
from ngdgc.mesh.facets import Coordinates, Facets
from ngdgc.mesh.quadrature import BoundaryQuadrature, NodalRules
from ngdgc.meshes import RectangleMesh, UnitMesh


def Ball():
    geometry = CSGeometry()
    geometry.Add(Sphere(Pnt(0, 0, 0), 1).bc("rim"))
    return Mesh(geometry.GenerateMesh(maxh=0.8)).Curve(3)


@cache     # no test changes a mesh
def Meshes():
    prisms = MakeStructured3DMesh(hexes=False, prism=True, nx=2, ny=2, nz=2)
    tets, hexes = (MakeStructured3DMesh(hexes=kind, nx=2, ny=2, nz=2) for kind in (False, True))
    return {"quad": (RectangleMesh(3, cells="quad"), "bottom"), "ring": (Ring(3, 0.5), "inner|outer"), "tet": (tets, "bottom"),
            "hex": (hexes, "top"), "prism": (prisms, "bottom|left"), "ball": (Ball(), "rim"), "hole": (Plate(), "hole")}


@pytest.mark.parametrize("name", Meshes())
def test_boundary_points_are_the_same_seen_from_inside(name):
    """Also on curved facets and mixed ones; the weights add up to the measure, the normals point outward."""
    mesh, region = Meshes()[name]
    quadrature = BoundaryQuadrature.On(Facets(mesh), region, 5)
    inside = np.asarray(Coordinates(mesh.dim)(quadrature.inside))
    assert inside == pytest.approx(quadrature.coordinates, abs=1e-12)
    assert quadrature.weights.sum() == pytest.approx(Integrate(CF(1), mesh.Boundaries(region), order=5))
    centroids = np.array([np.mean([mesh[vertex].point for vertex in mesh[ElementId(VOL, int(number))].vertices], axis=0)
                          for number in quadrature.elements])
    assert np.all(np.einsum("nd,nd->n", quadrature.coordinates - centroids, quadrature.normals) > 0)


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 3])
@pytest.mark.parametrize("name", ["quad", "ring", "hole", "tet", "hex", "prism"])
def test_trace_matrix_is_evaluation_and_its_transpose_is_the_load(name, order, method):
    mesh, region = Meshes()[name]
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation(region, NormalCompliance(1), friction=TrescaFriction(1)))
    disc = Discretization(problem, method, mesh, order=order)
    contact = disc.contact
    function = GridFunction(disc.space)
    function.vec.FV().NumPy()[:] = np.random.default_rng(0).standard_normal(disc.space.ndof)
    values = contact.Displacement(function.vec.FV().NumPy())
    assert values == pytest.approx(np.asarray(function(contact.inside)), abs=1e-11)
    # Of degrees that the rule integrates: 2 k with discontinuous elements, 2 k - 2, but at least 1, with conforming ones.
    traction = CF((1 + x, y - x, x - y)[:mesh.dim]) if method.discontinuous or order > 1 else CF((1, 2, 3)[:mesh.dim])
    v = disc.space.TestFunction()
    form = LinearForm(traction * v * ds(skeleton=True, definedon=mesh.Boundaries(region), bonus_intorder=1)).Assemble()
    if name not in ("ring", "hole"):    # on curves NGSolve chooses another rule, and neither is exact
        load = contact.Load(np.asarray(traction(contact.inside)))
        assert load == pytest.approx(form.vec.FV().NumPy(), abs=1e-12)
        assert np.abs(load - 1.01 * form.vec.FV().NumPy()).max() > 1e-4


def test_normal_and_tangential_parts_are_orthogonal_and_complete():
    disc = Discretization(Example(), InteriorPenalty(), RectangleMesh(2), order=2)
    contact, u = disc.contact, np.random.default_rng(1).standard_normal((len(disc.contact.weights), 2))
    normal, tangential = contact.Normal(u), contact.Tangential(u)
    assert normal[:, None] * contact.normals + tangential == pytest.approx(u)
    assert np.einsum("nd,nd->n", tangential, contact.normals) == pytest.approx(0, abs=1e-15)


def test_zones_follow_their_definition():
    disc = Discretization(Example(friction=2.0), InteriorPenalty(), RectangleMesh(1), order=2)
    contact = disc.contact      # three points, n = (0, -1)
    u = np.array([[0.1, 0.04], [1e-9, -0.2], [0.1, -0.2]])
    # The slipping point misses its bound by the tolerance of an iteration, the sticking one creeps by it.
    traction = np.array([[0.5, 0], [0.5, -3], [2.0 * (1 - 1e-7), -3]])
    assert Distance(contact, u, traction).zones.tolist() == [SEPARATION, STICK, SLIP]


def test_several_foundations_with_data_that_vary(method):
    """Two soft foundations under one body; each law is evaluated with its own data at its own points."""
    left = Foundation("bottom", NormalCompliance(40 * (1 + x), 1.5), friction=CoulombFriction(0.1 + 0.2 * x), gap=0.01 * exp(x))
    right = Foundation("right", NormalCompliance(300), friction=TrescaFriction(1 + y), gap=0.02 * sin(y))
    problem = Example(foundation=[left, right], dirichlet={"top": CF((0, 0))}, traction={"left": CF((80, -90))})
    solution = UzawaSolver(tol=1e-10).Solve(Discretization(problem, method, RectangleMesh(4), order=2))
    contact = solution.disc.contact
    s, t = contact.coordinates.T
    bottom, side = (part.points for part in contact.parts)
    r = solution.penetration
    assert r[bottom] == pytest.approx(-solution.displacement[bottom, 1] - 0.01 * np.exp(s[bottom]), abs=1e-12)
    assert r[side] == pytest.approx(solution.displacement[side, 0] - 0.02 * np.sin(t[side]), abs=1e-12)
    expected = 40 * (1 + s[bottom]) * np.maximum(r[bottom], 0) ** 1.5
    assert solution.pressure[bottom] == pytest.approx(expected, abs=1e-6)
    assert solution.pressure[side] == pytest.approx(300 * np.maximum(r[side], 0), abs=1e-6)
    assert solution.pressure[side].max() > 1 and np.abs(solution.pressure[bottom]).max() > 0.1
    assert solution.bound[bottom] == pytest.approx((0.1 + 0.2 * s[bottom]) * expected, abs=1e-6)
    assert solution.bound[side] == pytest.approx(1 + t[side])
    assert np.linalg.norm(solution.friction, axis=1) == pytest.approx(np.minimum(np.linalg.norm(
        solution.friction, axis=1), solution.bound), abs=1e-7)
    assert {resultant.region for resultant in solution.Resultants()} == {"top", "left", "bottom", "right"}
    assert solution.GlobalImbalance() < 1e-10


def test_friction_opposes_the_slip():
    solution = UzawaSolver().Solve(Discretization(Example(friction=50.0), InteriorPenalty(), RectangleMesh(8), order=1))
    slipping = solution.zones == SLIP
    work = np.einsum("nd,nd->n", solution.friction, solution.slip)[slipping]
    size = (np.linalg.norm(solution.friction, axis=1) * np.linalg.norm(solution.slip, axis=1))[slipping]
    assert np.any(slipping) and work == pytest.approx(-size, rel=1e-6)


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_nodal_rules_have_the_degree_they_say(order):
    """On edges and squares 2 k - 1, on triangles 1 and then 2 k - 2, with positive weights; one degree more is not exact."""
    rules = NodalRules(order)

    def Error(et, a, b):
        exact = factorial(a) * factorial(b) / factorial(a + b + 2) if et == TRIG else 1 / ((a + 1) * (b + 1))
        return abs(sum(w * p[0] ** a * p[1] ** b for p, w in zip(rules[et].points, rules[et].weights)) - exact)

    for et in (SEGM, QUAD):
        assert max(Error(et, a, b if et == QUAD else 0) for a in range(2 * order) for b in range(2 * order)) < 1e-15
        assert Error(et, 2 * order, 0) > 1e-6
    degree = max(1, 2 * order - 2)
    assert max(Error(TRIG, a, degree - a) for a in range(degree + 1)) < 1e-15 < 1e-6 < Error(TRIG, degree + 1, 0)
    assert min(min(rule.weights) for rule in rules.values()) > 0


def Body(mesh, region="bottom", order=1, method=METHODS[2], **data):
    foundation = Foundation(region, NormalCompliance(1), friction=TrescaFriction(1))
    return Discretization(ContactProblem(HookeMaterial(E=1, nu=0.3), foundation, **data), method, mesh, order=order)


@pytest.mark.parametrize("cells, order", [("triangle", 1), ("triangle", 2), ("quad", 3), ("tet", 1), ("tet", 2), ("hex", 1),
                                          ("hex", 2), ("prism", 2)])
def test_contact_points_of_conforming_elements_are_nodes(cells, order):
    """Values at the points are independent, and every trace is determined by them but for P_2 on triangles, a value per edge.

    Points of discontinuous elements are never shared.
    """
    contact = Body(UnitMesh(3, cells), order=order).contact
    rank = np.linalg.matrix_rank(contact.trace.toarray())
    assert rank == contact.normals.size == len(np.unique(contact.coordinates.round(9), axis=0)) * contact.dim
    traces = (3 * order + 1) ** (contact.dim - 1)
    assert rank == contact.dim * (3 * 3 + 2 * 3 * 4 if (cells, order) in (("tet", 2), ("prism", 2)) else traces)
    assert contact.weights.sum() == pytest.approx(1)
    assert contact.measures == pytest.approx({"tet": 1 / 18, "prism": 1 / 18, "hex": 1 / 9}.get(cells, 1 / 3))
    other = Body(UnitMesh(3, cells), order=order, method=InteriorPenalty()).contact
    assert np.array_equal(other.members, np.arange(len(other.weights))) and len(other.boundaryelements) == len(other.weights)


def Least(disc):
    """The smallest eigenvalue of S but for nodes that are held, in L2(Gamma_C)."""
    contact = disc.contact
    root = np.repeat(np.sqrt(contact.weights), contact.dim)
    units = np.eye(contact.normals.size).reshape(-1, *contact.normals.shape)
    rows = [contact.Displacement(disc.Response(unit)).ravel() for unit in units]
    values = np.linalg.eigvalsh(np.array(rows) * root / root[:, None])
    return values[values > 1e-10 * values[-1]][0]


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2, 3])
def test_compliance_of_conforming_elements_has_no_small_eigenvalues(order, monkeypatch):
    """The smallest one falls like h, and with Gauss' k points like h^3: tractions of alternating sign load no node."""
    def Rate():
        coarse, fine = (Least(Body(RectangleMesh(n), order=order, dirichlet={"right": CF((0, 0))})) for n in (8, 16))
        return np.log2(coarse / fine)

    assert Rate() == pytest.approx(1, abs=0.05)
    monkeypatch.setattr(divided, "ContactRules", lambda method, dim, order: 2 * order - 2)
    assert Rate() == pytest.approx(3, abs=0.1)


def test_shared_points_at_corners_slits_and_ends_of_foundations():
    """A corner, the lips of a slit and another foundation each keep a point of their own; a polygon has one per vertex."""
    corner = Body(RectangleMesh(3), "bottom|left").contact
    assert len(corner.weights) == 8 and np.sum(np.all(corner.coordinates == 0, axis=1)) == 2
    assert {tuple(normal) for normal in corner.normals.round(9).tolist()} == {(0, -1), (-1, 0)}
    law = NormalCompliance(1)
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), [Foundation("bottom", law), Foundation("left", law)])
    two = Discretization(problem, Conforming(), RectangleMesh(3)).contact
    assert [part.points for part in two.parts] == [slice(0, 4), slice(4, 8)]
    halves = [WorkPlane().MoveTo(s, 0).Rectangle(1, 1).Face() for s in (0, 1)]
    for half in halves:
        half.edges.Min(Y).name = "bottom"
    slit = Body(Mesh(OCCGeometry(Compound(halves), dim=2).GenerateMesh(maxh=0.5))).contact
    assert np.sum(np.all(slit.coordinates == (1, 0), axis=1)) == 2
    ring = Body(Ring(1, 0.3), "inner").contact
    inside = ring.weights > 0.2         # all vertices of the arc but its ends
    assert len(ring.weights) == len(np.unique(ring.boundaryelements)) + 1 and np.sum(inside) == len(ring.weights) - 2
    # The mean of the normals of two chords of nearly one length is that of the circle.
    radial = ring.coordinates / np.linalg.norm(ring.coordinates, axis=1)[:, None]
    assert ring.normals[inside] == pytest.approx(-radial[inside], abs=1e-3) and np.abs(ring.normals + radial).max() > 0.1
