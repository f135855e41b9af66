"""Thresholds and maxima that a looser one would pass for: where an iteration stops, what is symmetric, a corner, a diameter."""

import numpy as np
import pytest
from ngsolve import HEX, QUAD, TET, TRIG, BilinearForm, GridFunction, L2, IntegrationRule, dx, x
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh
from problems import Example

from ngdgc import (Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, SemismoothNewtonSolver, Solve, TrescaFriction, UzawaSolver)
from ngdgc.mesh.facets import Facets
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.contact.equilibrium import Equilibrium
from ngdgc.solvers.driver import Drive, LawResidual


def Disc(friction=TrescaFriction(1), n=4):      # noqa: B008
    return Discretization(Example(foundation=Foundation("bottom", NormalCompliance(300), friction=friction)), InteriorPenalty(),
                          RectangleMesh(n), order=1)


@pytest.mark.parametrize("solver", [UzawaSolver(tol=1e-7), UzawaSolver(tol=1e-7, normal="implicit"),
                                    UzawaSolver(tol=1e-7, normal="implicit", acceleration="anderson"),
                                    UzawaSolver(tol=1e-7, normal="implicit", rho="adaptive")],
                         ids=["explicit", "implicit", "anderson", "adaptive"])
def test_an_iteration_stops_at_its_tolerance_and_not_before(solver):
    """At the last step change and residual are at most tol, at the one before they were not: with 10 tol it would be sooner."""
    history = solver.Solve(Disc()).history
    sizes = [max(step.change, step.residual) for step in history]
    assert sizes[-1] <= solver.tol < min(sizes[:-1])
    # Control: the iteration is slow enough that 10 tol would be met by an earlier step.
    assert min(sizes[:-1]) < 10 * solver.tol


@pytest.mark.parametrize("window", [None, 10], ids=["newton", "fixed-point"])
def test_the_driver_stops_at_the_first_iterate_that_is_good_enough(window):
    """Iterates that come half as near each time to a known solution, as no Newton step would."""
    disc, tol = Disc(CoulombFriction(0.3)), 1e-6
    exact = SemismoothNewtonSolver(tol=1e-13).Solve(disc)
    rest = SemismoothNewtonSolver(tol=1e-13).Solve(Disc(CoulombFriction(0.29)))

    def Iterates():
        for part in 0.5 ** np.arange(60):
            vector, traction = (goal + part * (start - goal) for goal, start in ((exact.vector, rest.vector),
                                                                                (exact.traction, rest.traction)))
            yield Equilibrium(vector=vector, displacement=disc.contact.Displacement(vector), traction=traction)

    residuals = [LawResidual(disc.contact, iterate) for iterate in Iterates()]
    assert np.all(np.diff(residuals[:25]) < 0) and residuals[0] > 100 * tol
    history = Drive(SemismoothNewtonSolver(tol=tol), disc, Iterates(), None, None, window=window).history
    assert history[-1].residual <= tol < history[-2].residual or window and history[-1].change <= tol < history[-2].change
    if window is None:
        assert history[-1].number == next(number for number, one in enumerate(residuals) if one <= tol)


@pytest.mark.slow
@pytest.mark.parametrize("size, symmetric", [(0, True), (1e-10, False), (1e-6, False), (1e-3, False), (1e-2, False)])
def test_a_form_is_symmetric_to_round_off_or_not_at_all(size, symmetric):
    """A convection of this size beside a spring; of a matrix taken for symmetric only one half would be read."""
    def Made(convection):
        disc = Disc()
        u, v = disc.space.TnT()
        return disc.Add(BilinearForm((100 * u * v + 100 * convection * u[0] * v[1]) * dx))

    disc = Made(size)
    assert disc.symmetric == symmetric and Made(0).symmetric
    solution, half = Solve(disc), Solve(Made(0))
    product = disc.Multiply(solution.vector) + disc.contact.Load(solution.traction) - disc.load
    assert np.abs(product).max() < 1e-9 * np.abs(disc.load).max()
    if size >= 1e-6:        # control: without the form these are other equations
        other = disc.Multiply(half.vector) + disc.contact.Load(half.traction) - disc.load
        assert np.abs(other).max() > 1e-9 * np.abs(disc.load).max()


def Roof(angle, dim):
    """Squares or cubes whose bottom has an edge in the middle, where it turns by an angle [degrees]."""
    slope = np.tan(np.radians(angle) / 2)
    if dim == 2:
        return MakeStructured2DMesh(quads=True, nx=2, ny=1, mapping=lambda s, t: (s, t + slope * abs(s - 0.5)))
    return MakeStructured3DMesh(hexes=True, nx=2, ny=1, nz=1, mapping=lambda r, s, t: (r, s, t + slope * abs(r - 0.5)))


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("angle, points", [(0, 1), (20, 1), (44, 1), (47, 2), (60, 2), (71, 2), (73, 2), (90, 2)])
def test_a_corner_is_one_from_45_degrees_on(angle, points, dim):
    """Conforming elements: at a corner the two normals are two contact points, on a smooth boundary they are one."""
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("bottom", NormalCompliance(1)),
                             dirichlet={"top": (0,) * dim})
    contact = Discretization(problem, Conforming(), Roof(angle, dim), order=1).contact
    edge = contact.coordinates[:, 0] == 0.5
    assert edge.sum() == points * (1 if dim == 2 else 2)
    turned = np.radians(angle) / 2 if points == 2 else 0
    assert np.abs(contact.normals[edge, 0]) == pytest.approx(np.sin(turned), abs=1e-12)


@pytest.mark.parametrize("cells", ["tet", "hex", "prism"])
def test_the_diameter_of_a_facet_is_that_of_its_farthest_vertices(cells):
    mesh = BoxMesh(2, upper=(1, 2, 4), cells=cells)
    points, found = np.array(mesh.ngmesh.Coordinates()), Facets(mesh).diameter
    corners = [points[[vertex.nr for vertex in facet.vertices]] for facet in mesh.facets]
    distances = [np.linalg.norm(here[:, None] - here[None], axis=2) for here in corners]
    assert found == pytest.approx([one.max() for one in distances], rel=1e-14)
    # Control: from the first vertex alone some are too small; not so in rectangles and cut cubes: see below.
    assert any(one[0].max() < 0.99 * one.max() for one in distances) == (cells == "prism")


@pytest.mark.parametrize("shear", [0.7, -0.7])
@pytest.mark.parametrize("hexes", [True, False])
def test_the_diameter_of_a_skew_facet_is_its_longest_side_or_diagonal(hexes, shear):
    """In one of two mirrored bodies it does not begin at the first vertex."""
    mesh = MakeStructured3DMesh(hexes=hexes, nx=1, ny=1, nz=1, mapping=lambda r, s, t: (r + shear * s, s - shear * t, t))
    points, found = np.array(mesh.ngmesh.Coordinates()), Facets(mesh).diameter
    corners = [points[[vertex.nr for vertex in facet.vertices]] for facet in mesh.facets]
    distances = [np.linalg.norm(here[:, None] - here[None], axis=2) for here in corners]
    assert found == pytest.approx([one.max() for one in distances], rel=1e-14)
    if shear < 0:       # control
        assert any(one[0].max() < 0.99 * one.max() for one in distances)


def Halves(cells):
    """Two squares or cubes side by side, cut into cells."""
    if cells in ("triangle", "quad"):
        return MakeStructured2DMesh(quads=cells == "quad", nx=2, ny=1)
    return MakeStructured3DMesh(hexes=cells == "hex", nx=2, ny=1, nz=1)


@pytest.mark.slow
@pytest.mark.parametrize("cells, et", [("triangle", TRIG), ("quad", QUAD), ("tet", TET), ("hex", HEX)])
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("slope", [99, -99])
def test_a_shear_modulus_that_varies_counts_with_its_largest_value(cells, et, order, slope):
    """eta_e = penalty mu k^2 with the largest mu at the quadrature points of both elements: a jump at x = 1/2 tells it.

    mu = 50.5 + slope (x - 1/2) grows as the coordinate of reference does, or the barycentric one of the vertex there.
    """
    mesh, away = Halves(cells), ("left" if cells in ("triangle", "quad") else "back")

    def Jumped(mu):
        """v B_h v of one penalty less that of half of it, for v = 1 where x > 1/2, and 0 where the body is clamped."""
        problem = ContactProblem(HookeMaterial(mu=mu, lam=0), Foundation("bottom", NormalCompliance(1)),
                                 dirichlet={away: (0,) * mesh.dim})
        values = []
        for penalty in (100, 200):
            disc = Discretization(problem, InteriorPenalty(penalty=penalty), mesh, order=order)
            gfu, right = GridFunction(disc.space), GridFunction(L2(mesh, order=0))
            right.vec.FV().NumPy()[:] = [np.mean([mesh[vertex].point[0] for vertex in element.vertices]) > 0.5
                                         for element in mesh.Elements()]
            gfu.components[0].Set(right)
            vector = gfu.vec.FV().NumPy().copy()
            values.append(vector @ disc.Multiply(vector))
        return values[1] - values[0]

    largest = max(point[0] for point in IntegrationRule(et, 2 * order).points)
    found = Jumped(50.5 + slope * (x - 0.5)) / Jumped(1)
    assert found == pytest.approx(50.5 + 99 * largest / 2, rel=1e-9)
    # Control: in the middle of the elements there are other values.
    assert found > 1.1 * (50.5 + 99 / (2 * (mesh.dim + 1) if cells in ("triangle", "tet") else 4))
