"""Gamma_C: the trace matrix, loads, zones, several foundations, and data that vary in space."""

import numpy as np
import pytest
from conftest import Example
from netgen.csg import CSGeometry, Pnt, Sphere
from netgen.occ import OCCGeometry, WorkPlane
from ngsolve import VOL, CF, ElementId, GridFunction, Integrate, LinearForm, Mesh, ds, exp, sin, x, y
from ngsolve.meshes import MakeStructured3DMesh
from test_forms import Ring

from ngdgc import (ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, TrescaFriction, UzawaSolver)
from ngdgc.graph import SEPARATION, SLIP, STICK, Distance
from ngdgc.facets import BoundaryQuadrature, Coordinates, Facets
from ngdgc.meshes import RectangleMesh


def Ball():
    geometry = CSGeometry()
    geometry.Add(Sphere(Pnt(0, 0, 0), 1).bc("rim"))
    return Mesh(geometry.GenerateMesh(maxh=0.8)).Curve(3)


def Plate():
    """A square with a round hole, whose boundary NGSolve orients into the body."""
    face = WorkPlane().Rectangle(2, 2).Face() - WorkPlane().Circle(1, 1, 0.4).Face()
    for edge in face.edges:
        edge.name = "hole" if 0.5 < edge.center.x < 1.5 and 0.5 < edge.center.y < 1.5 else "outer"
    return Mesh(OCCGeometry(face, dim=2).GenerateMesh(maxh=0.5)).Curve(3)


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
    bottom, side = contact.parts[0][1], contact.parts[1][1]
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
