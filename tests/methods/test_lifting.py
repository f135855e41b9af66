"""The liftings, and the four methods in their two forms and routes of assembly: identities to round-off."""

from functools import cache, lru_cache

import numpy as np
import pytest
from bodies import AddSides, Cube, Distorted, Ring
from checks import Interpolate, Random, Spectrum
from netgen.geom2d import SplineGeometry
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import (CF, L2, VOL, BilinearForm, ElementId, GridFunction, InnerProduct, LinearForm, MatrixValued, Mesh, VectorL2,
                     ds, dx, specialcf, x, y)
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh
from problems import GRADED, ROWS, Example

from ngdgc import (LDG, BassiEtAl, BrezziEtAl, ContactProblem, Discretization, Foundation, HookeMaterial,
                   IncompleteInteriorPenalty, InteriorPenalty, Lifting, NonsymmetricInteriorPenalty, NormalCompliance,
                   ProblemError, UzawaSolver)
from ngdgc.mesh.facets import Csr
from ngdgc.meshes import RectangleMesh


@pytest.mark.parametrize("order, liftorder", [(1, 0), (1, 1), (2, 1), (2, 3)])
def test_global_lifting_against_its_definition_solved_densely(order, liftorder):
    """(3.2) on eight triangles: M_Q r_0 = - int_E0 [u]:{q}, the right-hand side from NGSolve's own skeleton integrals."""
    disc = Discretization(Example(), InteriorPenalty(), RectangleMesh(2), order=order)
    lifting = Lifting(disc, order=liftorder)
    u, n = Random(disc.space), specialcf.normal(2)
    space = MatrixValued(L2(disc.mesh, order=liftorder, dgjumps=True), symmetric=True)
    p, q = space.TnT()
    mass = BilinearForm(InnerProduct(p, q) * dx).Assemble()
    right = LinearForm(space)
    right += -0.5 * ((q + q.Other()) * n) * (u - u.Other()) * dx(skeleton=True)
    right += -(q * n) * u * ds(skeleton=True, definedon=disc.mesh.Boundaries("right"))
    expected = np.linalg.solve(Csr(mass.mat).toarray(), right.Assemble().vec.FV().NumPy())
    lifted = lifting.Global(u).vec.FV().NumPy()
    assert lifted == pytest.approx(expected, abs=1e-11 * np.abs(expected).max())
    assert np.abs(lifted + expected).max() > np.abs(expected).max()     # the sign matters


@pytest.mark.parametrize("mesh", [RectangleMesh(2), RectangleMesh(2, cells="quad"), Distorted("triangle")],
                         ids=["triangles", "quads", "unstructured"])
def test_local_liftings_live_at_their_facet_and_add_up(mesh):
    disc = Discretization(Example(), InteriorPenalty(), mesh, order=2)
    lifting, u = Lifting(disc), Random(disc.space)
    total = np.zeros(lifting.space.ndof)
    incidence = disc.facets.incidence
    for facet in range(incidence.shape[0]):
        local = lifting.Local(u, facet).vec.FV().NumPy()
        total += local
        near = set(incidence.indices[incidence.indptr[facet]:incidence.indptr[facet + 1]].tolist())
        touched = {element for element in range(mesh.ne)
                   if np.any(np.abs(local[list(lifting.space.GetDofNrs(ElementId(VOL, element)))]) > 1e-12)}
        assert touched <= near
        assert bool(touched) == bool(lifting.operators.share[facet])
    assert total == pytest.approx(lifting.Global(u).vec.FV().NumPy(), abs=1e-11)


def test_lifting_of_a_continuous_function_vanishes():
    disc = Discretization(Example(), InteriorPenalty(), RectangleMesh(3), order=2)
    function = GridFunction(disc.space)
    function.vec.FV().NumPy()[:] = Interpolate(disc, CF((1 - x, x * y - y)))        # zero on Gamma_D, x = 1
    assert np.abs(Lifting(disc).Global(function).vec.FV().NumPy()).max() < 1e-12
    function.vec.FV().NumPy()[:] = Interpolate(disc, CF((x, y)))
    assert np.abs(Lifting(disc).Global(function).vec.FV().NumPy()).max() > 0.1


@lru_cache(2)   # one is compared with several, and the form assembles anew whenever it is asked
def FormMatrix(disc):
    return Csr(disc.form.Matrix())


def Relative(a, b):
    return abs(FormMatrix(a) - FormMatrix(b)).max() / abs(FormMatrix(a)).max()


@cache     # no test changes a mesh
def Meshes():
    return {"triangle": Distorted("triangle"), "mixed": Distorted("mixed"),
            "quad": RectangleMesh(2, cells="quad", upper=(1, 0.4)), "tet": Cube("tet"), "hex": Cube("hex"),
            "prism": Cube("prism")}


def Supported(mesh, material=None, **regions):
    """A body with Gamma_D, a roller and a foundation, where the mesh has the sides of a box."""
    regions = regions or {"dirichlet": {"right": CF((0.3, -0.1, 0.2)[:mesh.dim])}, "roller": {"left": y + 1}}
    bottom = "bottom" if "bottom" in mesh.GetBoundaries() else "outer"
    return ContactProblem(material or HookeMaterial(E=2000, nu=0.4), Foundation(bottom, NormalCompliance(1)), **regions)


@pytest.mark.slow
@pytest.mark.parametrize("name, order", [*((name, order) for name in ("triangle", "mixed", "quad") for order in range(1, 7)),
                                         *((name, order) for name in ("tet", "hex", "prism") for order in range(1, 4)),
                                         ("tet", 5), ("hex", 4), ("prism", 4)])
def test_edge_form_is_lifting_form_is_skeleton_form(name, order):
    """On simplices and parallelograms, constant C, to 1e-12; the symbols of NGSolve as well, where they take seconds."""
    mesh = Meshes()[name]
    problem = Supported(mesh)
    for row in ROWS if order < 4 or mesh.dim == 2 else (LDG,):
        edge, lifting = (Discretization(problem, row(form=form), mesh, order=order) for form in ("edge", "lifting"))
        assert Relative(edge, lifting) < 1e-12
        if order < 5 and (mesh.dim == 2 or order < 3):
            assert Relative(edge, Discretization(problem, row(), mesh, order=order, assembly="skeleton")) < 1e-12
    assert Relative(Discretization(problem, InteriorPenalty(), mesh, order=order),
                    Discretization(problem, BassiEtAl(), mesh, order=order)) > 1e-3


@cache     # no test changes a mesh
def Hard():
    """Meshes and materials on which C eps(V_h) does not lie in Q_h: {name: (mesh, material, supports)}."""
    skewed = MakeStructured3DMesh(hexes=True, nx=2, ny=1, nz=1, mapping=lambda s, t, r: (s + 0.2 * r, t * (1 + s / 3), r))
    straight = {"dirichlet": {"horizontal": CF((0.3, 0.2))}, "roller": {"vertical": 1}}
    return {"bilinear": (Distorted("quad"), None, {}), "graded": (Distorted("mixed"), GRADED, {}),
            "curved": (Ring(2, 0.5), None, straight), "curved and graded": (Ring(2, 0.5), VARYING, straight),
            "trilinear": (skewed, None, {"dirichlet": {"right": CF((0.3, -0.1, 0.2))}}),
            "by element": (Distorted("triangle"), "by element", {}), "second order": (SecondOrder(), None, {})}


VARYING = HookeMaterial(mu=50 * (3 + x), lam=40 * (2 - y))


def SecondOrder():
    """A square with a round hole, whose curved edges are Netgen's own second-order elements."""
    geometry = SplineGeometry()
    geometry.AddRectangle((0, 0), (1, 1), bcs=["bottom", "right", "top", "left"])
    geometry.AddCircle((0.5, 0.5), 0.2, leftdomain=0, rightdomain=1, bc="hole")
    mesh = Mesh(geometry.GenerateMesh(maxh=0.4))
    mesh.ngmesh.SecondOrder()
    return Mesh(mesh.ngmesh)


@pytest.mark.slow
@pytest.mark.parametrize("row", [*ROWS, NonsymmetricInteriorPenalty, IncompleteInteriorPenalty])
@pytest.mark.parametrize("form", ["edge", "lifting"])
@pytest.mark.parametrize("name", Hard())
def test_both_routes_agree_where_the_two_forms_differ(name, form, row):
    """Matrix, norm, prescribed loads and fluxes, from blocks and from NGSolve's symbols: two independent assemblies.

    The prescribed values lie in F_h: others are projected on it by the block route alone.
    """
    mesh, material, supports = Hard()[name]
    if material == "by element":
        modulus = GridFunction(L2(mesh, order=0, dgjumps=True))
        modulus.vec.FV().NumPy()[:] = np.random.default_rng(0).uniform(1, 2, mesh.ne)
        material = HookeMaterial(mu=100 * modulus, lam=150)
    problem = Supported(mesh, material, **supports)
    one, two = (Discretization(problem, row(form=form), mesh, order=1, assembly=route) for route in ("facet", "skeleton"))
    u, tol = Random(one.space), 1e-12
    assert Relative(one, two) < tol
    assert abs(Csr(one.form.Norm()) - Csr(two.form.Norm())).max() < tol * abs(Csr(one.form.Norm())).max()
    for mine, other in ((one.form.Fluxes(u), two.form.Fluxes(u)), (one.form.Prescribed(), two.form.Prescribed())):
        assert set(mine) == set(other)
        size = max(np.abs(values).max() for values in other.values())
        assert all(np.abs(mine[region] - other[region]).max() < tol * size for region in mine)
    other = Discretization(problem, InteriorPenalty(form=form) if row is LDG else LDG(form=form), mesh, order=1)
    assert Relative(one, other) > 1e-3


def test_curved_rollers_differ_by_a_projection():
    """On a curved side v_n n is no function of F_h: the facet route couples its projection, which converges."""
    differences = []
    for size in (0.5, 0.25):
        problem = Supported(Ring(2, size), VARYING, roller={"inner": 1, "horizontal": 0})
        differences.append(Relative(*(Discretization(problem, InteriorPenalty(), Ring(2, size), order=1, assembly=route)
                                      for route in ("facet", "skeleton"))))
    assert 1e-4 < differences[0] < 0.05 and differences[1] < 0.5 * differences[0]


@pytest.mark.slow
@pytest.mark.parametrize("row", [BassiEtAl, BrezziEtAl])
@pytest.mark.parametrize("mesh, order", [(RectangleMesh(3), 3), (Distorted("quad"), 2)], ids=["triangles", "quads"])
def test_edge_forms_that_lift_too_little_are_refused(mesh, order, row):
    """With l < k - 1 tractions meet jumps that r_e does not see: no eta helps, and no bound may say that one does."""
    for penalty in ("auto", 1000):
        disc = Discretization(Example(), row(liftorder=1, penalty=penalty), mesh, order=order)
        assert Spectrum(disc) < 0
        with pytest.raises(ProblemError, match="loses coercivity.* take form='lifting', a larger liftorder"):
            UzawaSolver().Solve(disc)
    assert Spectrum(Discretization(Example(), row(liftorder=1, form="lifting"), mesh, order=order)) > 0


def test_two_elements_with_two_facets_in_common():
    """Their coupling comes from two facets and adds up."""
    mesh = NetgenMesh()
    mesh.dim = 2
    mesh.AddPoints(np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [1, 2, 0], [1, -2, 0]], dtype=float))
    cells = mesh.AddRegion("body", dim=2)
    mesh.AddElements(dim=2, index=cells, data=np.array([[0, 1, 2, 3], [0, 4, 2, 1]], dtype=np.int32), base=0)
    AddSides(mesh, {"right": [[2, 3], [4, 2]], "left": [[3, 0]], "bottom": [[0, 4]]})
    mesh = Mesh(mesh)
    for row in ROWS:
        facet, skeleton = (Discretization(Supported(mesh), row(), mesh, order=1, assembly=route)
                           for route in ("facet", "skeleton"))
        assert not facet.facets.distinct
        assert Relative(facet, skeleton) < 1e-12


def test_one_skewed_quadrilateral():
    """Sides of an element that no facet of E0 touches."""
    mesh = MakeStructured2DMesh(quads=True, nx=1, ny=1, mapping=lambda s, t: (s + 0.2 * s * t, t + 0.1 * s * t))
    assert Spectrum(Discretization(Example(), BassiEtAl(), mesh, order=1)) > 0.1


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("liftorder", [1, 2])
def test_lifting_terms_against_skeleton_integrals(order, liftorder):
    """LDG - IP and Brezzi - Bassi are (C r_0, r_0), built here from a mixed skeleton form and a dense mass."""
    mesh, problem = RectangleMesh(2), Example()
    V = VectorL2(mesh, order=order, dgjumps=True)
    Q = MatrixValued(L2(mesh, order=liftorder, dgjumps=True), symmetric=True)
    u, q, p, n = V.TrialFunction(), Q.TestFunction(), Q.TrialFunction(), specialcf.normal(2)
    jump = BilinearForm(trialspace=V, testspace=Q)
    jump += -0.5 * ((q + q.Other()) * n) * (u - u.Other()) * dx(skeleton=True)
    jump += -(q * n) * u * ds(skeleton=True, definedon=mesh.Boundaries("right"))
    mass, weighted = (Csr(BilinearForm(InnerProduct(stress, q) * dx).Assemble().mat).toarray()
                      for stress in (p, problem.material.Stress(p)))
    lift = np.linalg.solve(mass, Csr(jump.Assemble().mat).toarray())
    expected = lift.T @ weighted @ lift

    def Matrix(method):
        return Csr(Discretization(problem, method, mesh, order=order).form.Matrix()).toarray()

    options = {"form": "lifting", "liftorder": liftorder}
    for more, less in ((LDG, InteriorPenalty), (BrezziEtAl, BassiEtAl)):
        difference = Matrix(more(**options)) - Matrix(less(**options))
        assert np.abs(difference - expected).max() < 1e-12 * np.abs(expected).max()
