"""Forces, mean displacements and tractions on boundaries and interfaces, for every method."""

import numpy as np
import pytest
from bodies import Layers, Perforated
from checks import Body
from netgen.occ import Circle, MoveTo
from ngsolve import (CF, BilinearForm, BoundaryFromVolumeCF, Discontinuous, Grad, InnerProduct, Integrate, Sym, ds, exp,
                     specialcf, x, y)
from problems import TEN, Loaded, Solved

from ngdgc import (LDG, Conforming, ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NonsymmetricInteriorPenalty, NormalCompliance, SemismoothNewtonSolver, Solve)
from ngdgc.solution.conformingtractions import _Elastic
from ngdgc.exact import AffinePatch, ExactStrain
from ngdgc.meshes import BoxMesh, RectangleMesh, ShapeMesh
from ngdgc.mesh.quadrature import BoundaryQuadrature, ContactRules
from ngdgc.methods.symbolform import Coefficients

SEVERAL = [InteriorPenalty(), LDG(form="lifting"), Conforming()]
NAMES = dict(ids=lambda method: method.name)


@pytest.mark.slow
@pytest.mark.parametrize("assembly", ["facet", "skeleton"])
@pytest.mark.parametrize("method", [*TEN, NonsymmetricInteriorPenalty(), Conforming()], ids=lambda method: repr(method))
def test_forces_are_those_of_the_balance(method, assembly):
    """Region by region as `Resultants`, with contact as `weights` and `traction` have it; the plain integral is not."""
    mesh = RectangleMesh(4)
    solution = Solved(Loaded(mesh, roller={}, traction={"right": CF((3 * y, exp(x * y)))}), method, mesh, assembly=assembly)
    size = np.abs(solution.Force("top")).max()
    for resultant in solution.Resultants():
        if resultant.region:
            assert solution.Force(resultant.region) == pytest.approx(resultant.force, abs=1e-10 * size)
    assert solution.Force("bottom") == pytest.approx(-solution.weights @ solution.traction, abs=1e-12 * size)
    assert solution.Force(".*") == pytest.approx(-Body(solution), abs=1e-9 * size)
    assert solution.Force("top|left") == pytest.approx(solution.Force("top") + solution.Force("left"), abs=1e-12 * size)
    stress = np.array(Integrate(solution.stress * specialcf.normal(2), mesh, definedon=mesh.Boundaries("top")))
    assert not np.abs(stress - solution.Force("top")).max() < 1e-2 * size


@pytest.mark.slow
@pytest.mark.parametrize("method", SEVERAL, **NAMES)
@pytest.mark.parametrize("mesh", [Layers(2), Perforated(), BoxMesh(1), BoxMesh(2, cells="hex"), BoxMesh(1, cells="prism"),
                                  RectangleMesh(3, cells="quad")], ids=["layers", "hole", "tet", "hex", "prism", "quad"])
def test_tractions_integrate_to_the_forces(mesh, method):
    solution = Solved(Loaded(mesh), method, mesh)
    size = np.abs(solution.Force("top")).max()
    for region in sorted(set(mesh.GetBoundaries())):
        integral = np.array(Integrate(solution.Traction(region), mesh, definedon=mesh.Boundaries(region)))
        assert integral == pytest.approx(solution.Force(region), abs=1e-10 * size)
    outer = "|".join(sorted(set(mesh.GetBoundaries()) - {"mid"}))
    assert solution.Force(outer) == pytest.approx(-Body(solution), abs=1e-9 * size)
    for free in {"hole", "front", "back"} & set(mesh.GetBoundaries()):
        assert np.all(solution.Force(free) == 0)


@pytest.mark.parametrize("method", SEVERAL, **NAMES)
@pytest.mark.parametrize("dim", [2, 3])
def test_tractions_of_an_affine_solution_are_exact(method, dim):
    """On all sides, though their normals jump at the corners, where conforming functions test both of them."""
    exact = AffinePatch("slip", dim=dim)
    solution = Solved(exact.problem, method, RectangleMesh(3) if dim == 2 else BoxMesh(1))
    mesh, n = solution.disc.mesh, specialcf.normal(dim)
    stress = exact.problem.material.Stress(ExactStrain(exact.displacement))
    for region in set(mesh.GetBoundaries()):
        there = {"mesh": mesh, "definedon": mesh.Boundaries(region)}
        right = np.array(Integrate(stress * n, **there))
        size = np.abs(solution.Force("top")).max()
        assert solution.Force(region) == pytest.approx(right, abs=1e-8 * size)
        error = solution.Traction(region) - stress * n
        assert Integrate(error * error, **there) < (1e-8 * size) ** 2


@pytest.mark.slow
@pytest.mark.parametrize("method", SEVERAL, **NAMES)
@pytest.mark.parametrize("mesh", [RectangleMesh(8), Perforated(), BoxMesh(1)], ids=["plane", "hole", "solid"])
def test_traction_of_the_foundation_has_the_values_of_the_law(mesh, method):
    """-t at the contact points: of DG in the plane and of nodal rules, where points and facet functions are as many."""
    solution = Solved(Loaded(mesh), method, mesh, order=1)
    disc = solution.disc
    quadrature = BoundaryQuadrature.On(disc.facets, "bottom", ContactRules(method, mesh.dim, 1))
    there = np.asarray(solution.Traction("bottom")(quadrature.points))
    right = -solution.traction[disc.contact.members]
    assert np.abs(there - right).max() < 1e-10 * np.abs(right).max() or (mesh.dim == 3 and method.discontinuous)
    assert quadrature.weights @ there == pytest.approx(quadrature.weights @ right, abs=1e-10 * np.abs(right).max())


@pytest.mark.slow
@pytest.mark.parametrize("method", SEVERAL, **NAMES)
@pytest.mark.parametrize("mesh", [RectangleMesh(4), Perforated(), BoxMesh(1)], ids=["plane", "hole", "solid"])
def test_mean_displacement(mesh, method):
    """Of Gamma_C as the contact points have it, elsewhere as the trace; the plain integral of DG is garbage."""
    solution = Solved(Loaded(mesh), method, mesh)
    weights = solution.weights
    size = np.abs(solution.Mean("top")).max()
    # The rule at the contact points of conforming triangles is exact for the degree of u alone.
    assert solution.Mean("bottom") == pytest.approx(weights @ solution.displacement / weights.sum(), abs=1e-9 * size)
    for region in set(mesh.GetBoundaries()):
        there = {"mesh": mesh, "definedon": mesh.Boundaries(region)}
        length = Integrate(CF(1), **there)
        assert solution.Mean(region) == pytest.approx(np.array(Integrate(BoundaryFromVolumeCF(solution.gfu), **there)) / length,
                                                      abs=1e-6 * size)
        plain = np.array(Integrate(solution.gfu, **there)) / length
        assert (np.abs(plain - solution.Mean(region)).max() < 1e-6 * size) != method.discontinuous


def test_added_springs_are_not_the_boundary():
    """Forces of added forms are listed in the balance; on a side that they alone hold, `Force` has nothing."""
    mesh = RectangleMesh(4)
    for method in SEVERAL:
        disc = Discretization(Loaded(mesh, dirichlet={"top": (0.02, -0.1)}), method, mesh, order=2)
        u, v = disc.space.TnT()
        springs = BilinearForm(disc.space)
        springs += 500 * u * v * ds(skeleton=True, definedon="left")
        solution = SemismoothNewtonSolver(tol=1e-11).Solve(disc.Add(springs))
        added = next(resultant.force for resultant in solution.Resultants() if resultant.kind == "added")
        assert np.all(solution.Force("left") == 0) and np.abs(added).max() > 0.1
        assert solution.Force(".*") + added == pytest.approx(-Body(solution), abs=1e-9 * np.abs(added).max())


@pytest.mark.parametrize("order", [2, 3])
def test_reactions_balance_on_curved_bodies(order):
    """What the equations of the conforming method leave over is computed by their own quadrature; another leaves more."""
    shape = (Circle((0, 0), 2).Face() - Circle((0, 0), 1).Face()) * MoveTo(-2, -2).Rectangle(4, 2).Face()
    for edge in shape.edges:
        away = np.hypot(edge.center.x, edge.center.y)
        edge.name = "cut" if abs(edge.center.y) < 1e-6 else "hub" if away < 1.5 else "out"
    problem = ContactProblem(HookeMaterial(E=1, nu=0.4995), Foundation("out", NormalCompliance(20), gap=y + 2),
                             dirichlet={"hub": (0, -0.05)})
    solution = Solve(Discretization(problem, Conforming(), ShapeMesh(shape, 0.4, order=2), order=order))
    # Round-off of a nearly incompressible material.
    assert solution.GlobalImbalance() < 1e-9
    assert solution.Force("hub") == pytest.approx(-solution.Force("out"), abs=1e-9 * solution.normalforce)
    space, disc = Discontinuous(solution.disc.space), solution.disc
    linear = Coefficients(InnerProduct(solution.stress, Sym(Grad(space.TestFunction()))) * disc.form.volume)
    assert np.abs(linear - _Elastic(solution, space)).max() > 1e-6 * solution.normalforce


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("method", SEVERAL, **NAMES)
def test_the_displacement_at_a_point(dim, method):
    """Of an affine solution, with coordinates that all differ: in another order, or without the last, it is another one."""
    exact, point = AffinePatch("slip", dim=dim), (0.2, 0.7, 0.45)[:dim]
    mesh = RectangleMesh(2) if dim == 2 else BoxMesh(1)
    solution = Solve(Discretization(exact.problem, method, mesh, order=1))
    # A relative error of 1e-8 is what the solver's stopping rule leaves.
    expected = np.array(exact.displacement(mesh(*point)))
    assert solution.At(*point) == pytest.approx(expected, abs=1e-8)
    assert solution.At(*map(np.float32, point)) == pytest.approx(expected, abs=1e-6)
    for wrong in (point[::-1], (*point[:-1], 0)):
        assert np.abs(solution.At(*wrong) - expected).max() > 1e-4
