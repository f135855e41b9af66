"""Coarser meshes of the same body: same measures, names and order; None where there is no way to make one."""

import numpy as np
import pytest
from netgen.csg import CSGeometry, OrthoBrick, Pnt
from netgen.geom2d import SplineGeometry, unit_square
from netgen.meshing import Element1D, Element2D, FaceDescriptor, MeshPoint
from netgen.meshing import Mesh as NetgenMesh
from netgen.meshing import Pnt as MeshPnt
from netgen.occ import Box, Glue, MoveTo, OCCGeometry, X, Y, Z
from netgen.occ import Pnt as OccPnt
from ngsolve import BND, CF, Integrate, Mesh, ds, dx, x, y, z

from ngdgc.mesh.coarsening import CoarserMesh, MeshSize, Outline
from ngdgc.meshes import BoxMesh, RectangleMesh


def Measures(mesh):
    """{name: measure} of materials and boundaries, regions of one name together; and centroids, which tell mirror images."""
    found = {}
    for number, name in enumerate(mesh.GetMaterials()):
        found["volume", number, name] = Integrate(CF(1) * dx(definedon=mesh.Materials(f"^{name}$")), mesh)
    for number, name in enumerate(mesh.GetBoundaries()):
        mask = mesh.Boundaries(".*")
        mask.Mask().Clear()
        mask.Mask().Set(number)
        found["boundary", number, name] = Integrate(CF(1) * ds(definedon=mask), mesh)
        found["centre", number, name] = Integrate((2 * x + 3 * y + 4 * z) * ds(definedon=mask), mesh)
    return found


def SameBody(coarse, mesh, rel=1e-12):
    """Names in the same order, measures to round-off, fewer elements, larger facets."""
    fine, other = Measures(mesh), Measures(coarse)
    assert list(fine) == list(other)
    size = max(abs(value) for value in fine.values())
    assert [other[key] for key in fine] == pytest.approx(list(fine.values()), rel=rel, abs=rel * size)
    assert coarse.ne <= 0.6 * mesh.ne and MeshSize(coarse) > 1.2 * MeshSize(mesh)


def ByHand(points, cells, edges, names, material="body"):
    """A mesh without geometry: points (n, 2), cells of 3 or 4 vertices, edges (a, b, number of the name from 1)."""
    mesh = NetgenMesh(dim=2)
    numbers = [mesh.Add(MeshPoint(MeshPnt(*point, 0))) for point in points]
    mesh.Add(FaceDescriptor(surfnr=1, domin=1, bc=1))
    mesh.SetMaterial(1, material)
    for cell in cells:
        mesh.Add(Element2D(1, [numbers[i] for i in cell]))
    for a, b, number in edges:
        mesh.Add(Element1D([numbers[a], numbers[b]], index=number))
    for number, name in enumerate(names):
        mesh.SetBCName(number, name)
    return Mesh(mesh)


def Cells(n, inside, Name, names, Map=lambda x, y: (x, y)):
    """Triangles of the cells (i, j) of an n x n grid with inside(i, j); Name(middle) of a boundary edge."""
    index, points, cells, count = {}, [], [], {}

    def Point(i, j):
        if (i, j) not in index:
            index[i, j] = len(points)
            points.append(Map(i / n, j / n))
        return index[i, j]

    for i in range(n):
        for j in range(n):
            if inside(i, j):
                a, b, c, d = Point(i, j), Point(i + 1, j), Point(i + 1, j + 1), Point(i, j + 1)
                cells += [(a, b, c), (a, c, d)]
                for edge in ((a, b), (b, c), (c, d), (d, a)):
                    count.setdefault(frozenset(edge), []).append(edge)
    single = [edges[0] for edges in count.values() if len(edges) == 1]
    edges = [(a, b, names.index(Name(*np.mean([points[a], points[b]], axis=0))) + 1) for a, b in single]
    return ByHand(points, cells, edges, names)


def LShape(n=8, Map=lambda x, y: (x, y)):
    def Name(x, y):
        return "foot" if y == 0 else "wall" if x == 0 else "rest"

    return Cells(n, lambda i, j: i < n // 2 or j < n // 2, Name, ["rest", "foot", "wall"], Map)


def WithHole(n=12):
    """A hole that touches no vertex of the outside; the names of the outside by sides."""
    def Name(x, y):
        return {0: "left", 1: "right"}.get(x) or {0: "bottom", 1: "top"}.get(y) or "hole"

    return Cells(n, lambda i, j: not (n // 3 <= i < 2 * n // 3 and n // 3 <= j < 2 * n // 3), Name,
                 ["bottom", "hole", "top", "left", "right"])


def Disc():
    """A disc without geometry: the outline has as many corners as edges."""
    n = 40
    angles = 2 * np.pi * np.arange(n) / n
    points = [(0, 0), *((np.cos(a), np.sin(a)) for a in angles)]
    ring = [(i + 1, (i + 1) % n + 1) for i in range(n)]
    return ByHand(points, [(0, a, b) for a, b in ring], [(a, b, 1) for a, b in ring], ["rim"])


def Glued():
    lower = MoveTo(0, 0).Rectangle(1, 1).Face()
    upper = MoveTo(0, 1).Rectangle(1, 0.5).Face()
    lower.faces.name, upper.faces.name = "rubber", "steel"
    lower.edges.Min(Y).name, upper.edges.Max(Y).name = "bottom", "top"
    return OCCGeometry(Glue([lower, upper]), dim=2)


def Holed():
    plate = MoveTo(0, 0).Rectangle(2, 1).Face()
    plate.edges.name = "side"
    plate.edges.Min(Y).name = "bottom"
    hole = MoveTo(1, 0.5).Circle(0.25).Face()
    hole.edges.name = "hole"
    return OCCGeometry(plate - hole, dim=2)


def Brick():
    box = Box(OccPnt(0, 0, 0), OccPnt(1, 2, 1))
    box.faces.name = "side"
    box.faces.Min(Z).name, box.faces.Max(X).name = "bottom", "front"
    return OCCGeometry(box)


def Ordered():
    geometry = SplineGeometry()
    geometry.AddRectangle((0, 0), (2, 1), bcs=["bottom", "right", "top", "left"])
    return geometry


MESHES = {
    "rectangle": lambda: RectangleMesh(8, lower=(-1, 2), upper=(3, 3)),
    "quads": lambda: RectangleMesh(8, cells="quad"),
    "box": lambda: BoxMesh(4, lower=(1, 2, 3), upper=(2, 4, 6)),
    "hexes": lambda: BoxMesh(4, cells="hex"),
    "prisms": lambda: BoxMesh(4, cells="prism"),
    "unit-square": lambda: Mesh(unit_square.GenerateMesh(maxh=0.1)),
    "spline": lambda: Mesh(Ordered().GenerateMesh(maxh=0.1)),
    "glued": lambda: Mesh(Glued().GenerateMesh(maxh=0.1)),
    "brick": lambda: Mesh(Brick().GenerateMesh(maxh=0.5)),
    "l-shape": LShape,
    "inclined": lambda: LShape(Map=lambda x, y: (0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y)),
    "hole": WithHole}


@pytest.mark.slow
@pytest.mark.parametrize("name", MESHES)
def test_coarser_mesh_is_one_of_the_same_body(name):
    mesh = MESHES[name]()
    coarse = CoarserMesh(mesh)
    SameBody(coarse, mesh)
    assert coarse.ne < 2 * CoarserMesh(mesh, factor=1.5).ne or mesh.ne < 100
    squashed = MESHES[name]()
    squashed.ngmesh.Scale(1.01)
    with pytest.raises(AssertionError):
        SameBody(coarse, squashed)


@pytest.mark.slow
def test_coarser_meshes_end():
    """Again and again, each of the same body, until None: no endless loop, and a few levels."""
    for make in MESHES.values():
        mesh, count = make(), 0
        while (coarse := CoarserMesh(mesh)) is not None:
            assert coarse.ne < mesh.ne
            mesh, count = coarse, count + 1
        assert 1 <= count <= 8


@pytest.mark.parametrize("order", [1, 3])
def test_curved_boundaries_stay_curved(order):
    """A plate with a hole from CAD: the area is met like on the fine mesh, by straight edges it is not."""
    mesh = Mesh(Holed().GenerateMesh(maxh=0.1)).Curve(order)
    coarse = CoarserMesh(mesh)
    assert coarse.GetCurveOrder() == mesh.GetCurveOrder()
    assert coarse.GetBoundaries() == mesh.GetBoundaries() and "hole" in coarse.GetBoundaries()
    error = abs(Integrate(1, coarse, order=8) - (2 - np.pi / 16))
    assert error < 5e-5 if order == 3 else error > 5e-3


def test_refined_meshes_are_still_the_same_body():
    for make in (LShape, MESHES["rectangle"], MESHES["spline"]):
        mesh = make()
        mesh.Refine()
        SameBody(CoarserMesh(mesh), mesh)


@pytest.mark.parametrize("mesh", [Disc, lambda: RectangleMesh(1), lambda: BoxMesh(1),
                                  lambda: Mesh(unit_square.GenerateMesh(maxh=2))],
                         ids=["disc", "coarsest", "coarsest-box", "coarsest-netgen"])
def test_none_where_there_is_no_way(mesh):
    assert CoarserMesh(mesh()) is None


def test_none_for_curved_interfaces_and_two_materials_without_geometry():
    """What an outline cannot tell is refused, not lost."""
    one = RectangleMesh(8)
    assert Outline(one) is not None
    two = RectangleMesh(8)
    two.ngmesh.Add(FaceDescriptor(surfnr=2, domin=2, bc=1))
    two.ngmesh.SetMaterial(2, "other")
    for number, element in enumerate(two.ngmesh.Elements2D()):
        element.index = 1 + number % 2
    assert CoarserMesh(Mesh(two.ngmesh)) is None
    curved = RectangleMesh(8)
    curved.Curve(2)
    assert Outline(curved) is None and CoarserMesh(curved) is None


def test_names_in_another_order_are_no_structured_box():
    """Data by region number would change sides; the outline of a polygon keeps them."""
    mesh = RectangleMesh(8)
    for number, name in enumerate(["top", "left", "bottom", "right"]):
        mesh.ngmesh.SetBCName(number, name)
    SameBody(CoarserMesh(mesh), mesh)
    parts = Cells(8, lambda i, j: True, lambda x, y: "half" if y == 0 and x < 0.5 else "rest", ["rest", "half"])
    coarse = CoarserMesh(parts)
    SameBody(coarse, parts)
    ends = [coarse[vertex].point[0] for element in coarse.Elements(BND) if element.mat == "half" for vertex in element.vertices]
    assert max(ends) == pytest.approx(0.5) and min(ends) == 0


@pytest.mark.slow
def test_solid_geometry_keeps_its_surfaces():
    """Constructive solid geometry, where surface numbers, not names alone, carry data."""
    geometry = CSGeometry()
    geometry.Add(OrthoBrick(Pnt(0, 0, 0), Pnt(1, 1, 1)).bc("side").mat("block"))
    mesh = Mesh(geometry.GenerateMesh(maxh=0.3))
    SameBody(CoarserMesh(mesh), mesh)
