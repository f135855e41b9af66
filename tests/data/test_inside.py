"""Data on boundaries: what the element inside sees, whatever kind of function they are given as."""

import numpy as np
import pytest
from matplotlib.quiver import Quiver
from netgen.occ import Circle, OCCGeometry, Rectangle
from ngsolve import (CF, H1, L2, BoundaryFromVolumeCF, CacheCF, FacetFESpace, Grad, GridFunction, HDiv, IfPos,
                     LinearForm, Mesh, Parameter, SurfaceL2, VectorL2, ds, specialcf, sqrt, x, y, z)
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh

from ngdgc import (LDG, BassiEtAl, Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial,
                   InteriorPenalty, NormalCompliance, Solve)
from ngdgc.mesh.facets import Facets
from ngdgc.data.inside import FromInside, OnBoundary
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.plots import SettingFigure
from ngdgc.mesh.quadrature import BoundaryQuadrature

ROUNDOFF = 1e-12        # of values and normals of size 1
STEEL = HookeMaterial(E=2000, nu=0.3)


def Holed(order=1):
    """A square of side 2 with a round hole in its middle, of straight edges if order = 1."""
    plate = Rectangle(2, 2).Face().Move((-1, -1, 0)) - Circle((0, 0), 0.4).Face()
    for edge in plate.edges:
        edge.name = "hole" if abs(edge.center.x) + abs(edge.center.y) < 1e-6 else "bottom" if edge.center.y < -0.99 else "side"
    return Mesh(OCCGeometry(plate, dim=2).GenerateMesh(maxh=0.5)).Curve(order)


def Mirrored2D(quads):
    return MakeStructured2DMesh(quads=quads, nx=3, ny=3, mapping=lambda x, y: (-x, y))


def Mirrored3D(**cells):
    return MakeStructured3DMesh(nx=2, ny=2, nz=2, mapping=lambda x, y, z: (-x, y, z), **{"hexes": False, **cells})


MESHES = {"hole": Holed, "curved": lambda: Holed(2), "triangles": lambda: Mirrored2D(False), "quads": lambda: Mirrored2D(True),
          "tetrahedra": Mirrored3D, "hexahedra": lambda: Mirrored3D(hexes=True), "prisms": lambda: Mirrored3D(prism=True)}


def Field(space, value):
    (function := GridFunction(space)).Set(value)
    return function


def Skin(space, value):
    (function := GridFunction(space)).Set(value, definedon=space.mesh.Boundaries(".*"))
    return function


def Named(mesh, value, other):
    """A BoundaryCF with one value on the first boundary and another one elsewhere."""
    first = mesh.GetBoundaries()[0]
    return mesh.BoundaryCF({name: value if name == first else other for name in set(mesh.GetBoundaries())})


# The linear function f in many guises; of the wrong ones NGSolve's values at boundary points are others, or none.
KINDS = {"L2": lambda mesh, f, n: Field(L2(mesh, order=1), f), "VectorL2": lambda mesh, f, n:
         Field(VectorL2(mesh, order=1), CF((f,) * mesh.dim))[1], "H1": lambda mesh, f, n: Field(H1(mesh, order=1), f),
         "gradient": lambda mesh, f, n: CF((f, Grad(Field(H1(mesh, order=1), y))[1] * f))[1],
         "normal derivative": lambda mesh, f, n: (Grad(Field(H1(mesh, order=1), f)) * n) - Slope(mesh) * n + f,
         "stress": lambda mesh, f, n: Grad(Field(VectorL2(mesh, order=2), CF((x,) * mesh.dim)))[1, 0] * f,
         "material": lambda mesh, f, n: mesh.MaterialCF({".*": f}), "domains": lambda mesh, f, n: CF([f]),
         "boundary": lambda mesh, f, n: Named(mesh, f, Field(L2(mesh, order=1), f)),
         "surface": lambda mesh, f, n: Skin(SurfaceL2(mesh, order=1), f),
         "skin": lambda mesh, f, n: Skin(H1(mesh, order=1, definedon=mesh.Boundaries(".*")), f),
         "facets": lambda mesh, f, n: Skin(FacetFESpace(mesh, order=1), f),
         "H(div)": lambda mesh, f, n: Field(HDiv(mesh, order=1), CF((f,) * mesh.dim))[0],
         "other mesh": lambda mesh, f, n: Field(L2(mesh.__class__(mesh.ngmesh.Copy()), order=1), f),
         "all": lambda mesh, f, n: IfPos(x, Named(mesh, 2 * f, f) / Named(mesh, 2, 1), Field(L2(mesh, order=1), f)),
         "compiled": lambda mesh, f, n: (Field(L2(mesh, order=1), f) * (n * n)).Compile(),
         "compiled boundary": lambda mesh, f, n: (Named(mesh, f, 1.0 * f) * (n * n)).Compile(),
         "cache": lambda mesh, f, n: CacheCF(1.0 * Field(L2(mesh, order=1), f)),
         "parameter": lambda mesh, f, n: Parameter(2) * f / 2}
INSIDE, ABOVE = ("L2", "VectorL2", "stress", "material", "domains", "compiled", "cache"), ("boundary", "surface", "skin", "all")


def Slope(mesh):
    return CF((1, 2, 3)[:mesh.dim])


def Linear(mesh):
    return 5 + sum(slope * axis for slope, axis in zip((1, 2, 3), (x, y, z)[:mesh.dim]))


def OnSkeleton(function, mesh):
    """Moments of a function on the facets of the boundary, seen by ds(skeleton=True)."""
    mu = FacetFESpace(mesh, order=1).TestFunction()
    return LinearForm(function * mu * ds(skeleton=True, definedon=mesh.Boundaries(".*"))).Assemble().vec.FV().NumPy().copy()


def AtPoints(function, points):
    """Values at points, or nan where there are none."""
    try:
        return np.asarray(function(points), dtype=float).ravel()
    except Exception:
        return np.full(len(points), np.nan)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("shape", [name for name in MESHES if name != "curved"])
def test_every_kind_of_function_has_its_values_inside(shape, kind):
    mesh = MESHES[shape]()
    f, region, points = Linear(mesh), mesh.Boundaries(".*"), BoundaryQuadrature.On(Facets(mesh), ".*", 3).points
    given, right = KINDS[kind](mesh, f, specialcf.normal(mesh.dim)), AtPoints(f, points)
    assert np.abs(AtPoints(OnBoundary(given, region, "f"), points) - right).max() < ROUNDOFF * np.abs(right).max()
    moments = OnSkeleton(f, mesh)
    assert np.abs(OnSkeleton(FromInside(given, region, "f"), mesh) - moments).max() < ROUNDOFF * np.abs(moments).max()
    # What it would be without translation: 0, or no value at all.
    if kind in INSIDE:
        assert not np.allclose(AtPoints(given, points), right, rtol=0.1)
    if kind in ABOVE:
        assert not np.allclose(AtPoints(BoundaryFromVolumeCF(given), points), right, rtol=0.1)


@pytest.mark.parametrize("shape", MESHES)
def test_normals_are_outward(shape):
    mesh = MESHES[shape]()
    quadrature, n = BoundaryQuadrature.On(Facets(mesh), ".*", 3), specialcf.normal(mesh.dim)
    turned = Named(mesh, n, 1.0 * n)
    for given in (n, turned, Field(L2(mesh, order=0), 1) * n):
        seen = np.asarray(OnBoundary(given, mesh.Boundaries(".*"), "n")(quadrature.points))
        assert np.abs(seen - quadrature.normals).max() < ROUNDOFF
        outward = FromInside(given, mesh.Boundaries(".*"), "n") * n
        assert np.allclose(OnSkeleton(outward, mesh), OnSkeleton(CF(1), mesh), rtol=0, atol=ROUNDOFF)
    # NGSolve's own normal at boundary points is the other one at holes and on mirrored meshes.
    assert np.abs(np.asarray(n(quadrature.points)) - quadrature.normals).max() > 1.9


def Forces(mesh, method, *, k=300, coefficient=0.3, gap=0.02, top=(0.05, -0.1), side=(-3, 1), roller=0.01):
    laws = Foundation("bottom", NormalCompliance(k), friction=CoulombFriction(coefficient), gap=gap)
    problem = ContactProblem(STEEL, laws, dirichlet={"top": top}, traction={"right": side}, roller={"left": roller})
    solution = Solve(Discretization(problem, method, mesh))
    assert solution.GlobalImbalance() < 1e-9
    return np.array([solution.normalforce, solution.weights @ solution.friction[:, 0], *solution.At(*[0.5] * mesh.dim)])


SOLVED = [InteriorPenalty(), LDG(form="lifting"), BassiEtAl(), Conforming()]


@pytest.mark.slow
@pytest.mark.parametrize("method", SOLVED, ids=[method.name for method in SOLVED])
def test_discontinuous_data_act_as_numbers_do(method):
    mesh = RectangleMesh(4)
    right = Forces(mesh, method)

    def Constant(value):
        return Field(L2(mesh, order=1), value)

    vectors = VectorL2(mesh, order=1)
    for given in ({"k": Constant(300)}, {"coefficient": Constant(0.3)}, {"gap": Constant(0.02)}, {"roller": Constant(0.01)},
                  {"top": Field(vectors, CF((0.05, -0.1)))}, {"side": Field(vectors, CF((-3, 1)))},
                  {"gap": mesh.MaterialCF({".*": 0.02})}, {"top": mesh.BoundaryCF({".*": CF((0.05, -0.1))})},
                  {"side": mesh.BoundaryCF({"right": CF((-3, 1))})}, {"roller": mesh.BoundaryCF({".*": 0.01})}):
        found = Forces(mesh, method, **given)
        assert np.allclose(found, right, rtol=1e-8, atol=1e-10), given     # 100 times the tolerance of the solver
    # What counted as 0 would show.
    for wrong in ({"k": 1e-9}, {"coefficient": 0}, {"gap": 0}, {"roller": 0}, {"top": (0, 0)}, {"side": (0, 0)}):
        assert not np.allclose(Forces(mesh, method, **wrong), right, rtol=1e-3)


@pytest.mark.slow
def test_discontinuous_data_in_space():
    mesh, vectors = BoxMesh(2), CF((0.02, 0, -0.1))

    def Solution(**given):
        data = {"k": 300, "gap": 0.02, "top": vectors, **given}
        foundation = Foundation("bottom", NormalCompliance(data["k"]), gap=data["gap"])
        problem = ContactProblem(STEEL, foundation, dirichlet={"top": data["top"]})
        return [Solve(Discretization(problem, method, mesh)).normalforce for method in (InteriorPenalty(), Conforming())]

    right = Solution()
    for given in ({"k": Field(L2(mesh), 300)}, {"gap": Field(L2(mesh), 0.02)}, {"top": Field(VectorL2(mesh), vectors)}):
        assert np.allclose(Solution(**given), right, rtol=1e-8)
    assert not np.allclose(Solution(gap=0), right, rtol=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("method", [InteriorPenalty(), LDG(form="lifting"), Conforming()], ids=lambda method: method.name)
def test_a_prescribed_normal_and_a_gap_with_the_normal_in_a_hole(method):
    mesh, found = Holed(2), []
    for n in (specialcf.normal(2), CF((-x, -y)) / sqrt(x * x + y * y), CF((x, y)) / sqrt(x * x + y * y)):
        swollen = ContactProblem(STEEL, Foundation("bottom", NormalCompliance(300)), dirichlet={"hole": -0.02 * n})
        pinned = ContactProblem(STEEL, Foundation("hole", NormalCompliance(3000), gap=0.005 + 0.02 * n[1]),
                                dirichlet={"bottom": CF((0, 0))})
        solution = Solve(Discretization(pinned, method, mesh, order=2))
        found.append([Solve(Discretization(swollen, method, mesh, order=2)).At(0, 0.7)[1],
                      (solution.weights * solution.pressure) @ solution.normals[:, 1]])
    # The mapped circle of order 2 is one to 1e-3.
    assert np.allclose(found[0], found[1], rtol=3e-3)
    assert not np.allclose(found[2], found[1], rtol=0.5)


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["triangles", "quads", "tetrahedra", "hexahedra", "prisms"])
def test_prescribed_normals_on_mirrored_meshes(shape):
    mesh = MESHES[shape]()
    upwards = CF((0,) * (mesh.dim - 1) + (1,))

    def Force(n, method):
        problem = ContactProblem(STEEL, Foundation("bottom", NormalCompliance(300)), dirichlet={"top": -0.1 * n})
        return Solve(Discretization(problem, method, mesh)).normalforce

    for method in (InteriorPenalty(), Conforming()):
        right = Force(upwards, method)
        assert right > 1 and np.isclose(Force(specialcf.normal(mesh.dim), method), right, rtol=1e-9)
        assert Force(-upwards, method) < 1e-9


def test_the_setting_of_an_inner_pressure_shows_it():
    mesh = Holed(2)
    problem = ContactProblem(STEEL, Foundation("bottom", NormalCompliance(300)), dirichlet={"side": CF((0, 0))},
                             traction={"hole": -50 * specialcf.normal(2)})
    disc = Discretization(problem, InteriorPenalty(), mesh, order=2)
    (quiver,) = [child for child in SettingFigure(disc).axes[0].get_children() if isinstance(child, Quiver)]
    radial = quiver.get_offsets() / np.linalg.norm(quiver.get_offsets(), axis=1)[:, None]
    arrows = np.c_[quiver.U, quiver.V]
    # They act on the body outwards from the centre, all of one length but for the polygon that interpolates them.
    assert np.allclose(np.sum(arrows * radial, axis=1), np.linalg.norm(arrows, axis=1), rtol=0.05)
    assert Solve(disc).At(0, 0.5)[1] > 0


def test_a_coordinate_stays_that_of_the_boundary():
    bottom, root = RectangleMesh(3).Boundaries("bottom"), sqrt(1 - x)
    names = [str(OnBoundary(gap, bottom, "gap")) for gap in (root, root * specialcf.normal(2)[1])]
    # Of the map of an element x = 1 + 1e-16 is known, and then the root is not a number.
    assert ["BoundaryFromVolume" in name for name in names] == [False, True]
