"""Meshes that say something twice or wrongly, as generators and hands write them."""

import pytest
from netgen.meshing import Element1D, Element2D, Element3D, MeshPoint, Pnt
from netgen.meshing import Mesh as NetgenMesh
from netgen.occ import Box, Circle, IdentificationType, OCCGeometry, Rectangle, X, Y, Z
from ngsolve import Mesh

from ngdgc import (LDG, BassiEtAl, Conforming, ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, ProblemError)
from ngdgc.meshes import UnitMesh


def Edited(cells, edit, n=2):
    """A unit mesh after edit(netgen mesh, boundary elements of "bottom")."""
    mesh = UnitMesh(n, cells)
    bottom = mesh.GetBoundaries().index("bottom") + 1
    elements = mesh.ngmesh.Elements1D() if mesh.dim == 2 else mesh.ngmesh.Elements2D()
    edit(mesh.ngmesh, [element for element in elements if element.index == bottom])
    return Mesh(mesh.ngmesh)


def Side(mesh, vertices, region):
    """Add a boundary element with these vertices to a region, by its name or number."""
    number = mesh.AddRegion(region, dim=mesh.dim - 1) if isinstance(region, str) else region
    mesh.Add(Element1D(vertices, index=number) if mesh.dim == 2 else Element2D(number, vertices))


def Doubled(cells, region=None, back=False):
    """The boundary elements of "bottom" again in a region, by default in "bottom"; backwards if asked."""
    def Edit(mesh, bottom):
        number = mesh.AddRegion(region, dim=mesh.dim - 1) if region else bottom[0].index
        for element in bottom:
            Side(mesh, element.vertices[::-1] if back else element.vertices, number)
    return Edited(cells, Edit)


def Lost(cells, region=None, hanging=False, far=1):
    """Elements more in a region, by default in "bottom", that bound no element: apart, or hanging on vertices of the body."""
    def Edit(mesh, bottom):
        corners = [mesh.Add(MeshPoint(Pnt(far * s, far * t, 0))) for s, t in ((1.5, 0), (2, 0), (2, 1), (1.5, 1))]
        held = bottom[-1].vertices[:1 if mesh.dim == 2 else 2] if hanging else []
        for count in (2,) if mesh.dim == 2 else (3, 4):
            Side(mesh, held + corners[:count - len(held)], region or bottom[0].index)
    return Edited(cells, Edit)


def Diagonal(cells, region=None):
    """A boundary element more across the corners of the first element, no side of it; by default in "bottom"."""
    def Edit(mesh, bottom):
        corners = next(iter(mesh.Elements2D() if mesh.dim == 2 else mesh.Elements3D())).vertices
        across = {"quad": [0, 2], "hex": [0, 1, 2], "prism": [0, 1, 5]}[cells]
        Side(mesh, [corners[one] for one in across], region or bottom[0].index)
    return Edited(cells, Edit)


def Body(dim, corners, *elements):
    """Elements by the numbers of their corners, and a boundary "skin" on the first vertices of the first one."""
    mesh = NetgenMesh(dim=dim)
    points = [mesh.Add(MeshPoint(Pnt(*corner, *(0,) * (3 - dim)))) for corner in corners]
    body = mesh.AddRegion("body", dim=dim)
    for element in elements:
        vertices = [points[number] for number in element]
        mesh.Add(Element2D(body, vertices) if dim == 2 else Element3D(body, vertices))
    Side(mesh, [points[number] for number in elements[0][:dim]], "skin")
    return Mesh(mesh)


def Turned(cells, number):
    """A unit mesh of simplices of which every one whose number is divisible has two vertices exchanged."""
    given = UnitMesh(2, cells)
    mesh = NetgenMesh(dim=given.dim)
    points = [mesh.Add(MeshPoint(Pnt(*point[:given.dim], *(0,) * (3 - given.dim)))) for point in given.ngmesh.Coordinates()]
    mesh.AddRegion("body", dim=given.dim)
    for row, element in enumerate(given.Elements()):
        first, second, *rest = (points[vertex.nr] for vertex in element.vertices)
        vertices = [first, second, *rest] if row % number else [second, first, *rest]
        mesh.Add(Element2D(1, vertices) if given.dim == 2 else Element3D(1, vertices))
    for name in given.GetBoundaries():
        region = mesh.AddRegion(name, dim=given.dim - 1)
        for element in given.Boundaries(name).Elements():
            Side(mesh, [points[vertex.nr] for vertex in element.vertices], region)
    return Mesh(mesh)


def Periodic(dim, kind=IdentificationType.PERIODIC):
    """A square or cube with the sides "left" and "right" identified, on "bottom" and below "top"."""
    shape = Rectangle(1, 1).Face() if dim == 2 else Box((0, 0, 0), (1, 1, 1))
    sides = shape.edges if dim == 2 else shape.faces
    sides.Min(Y if dim == 2 else Z).name, sides.Max(Y if dim == 2 else Z).name = "bottom", "top"
    sides.Min(X).name, sides.Max(X).name = "left", "right"
    sides.Max(X).Identify(sides.Min(X), "period", kind)
    return Mesh(OCCGeometry(shape, dim=dim).GenerateMesh(maxh=0.5))


def Straightened():
    """A disc of second order whose boundary edges have lost the points in their middle."""
    mesh = OCCGeometry(Circle((0, 0), 1).Face(), dim=2).GenerateMesh(maxh=0.7)
    mesh.SecondOrder()
    mesh.Elements1D().NumPy()["nodes"][:, 2] = 0
    return Mesh(mesh)


def Refined():
    """A disc that was curved, then refined: Netgen forgets the curves, not the order."""
    mesh = Mesh(OCCGeometry(Circle((0, 0), 1).Face(), dim=2).GenerateMesh(maxh=0.7)).Curve(3)
    mesh.Refine()
    return mesh


SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
EDGE = LDG()
METHODS = EDGE, InteriorPenalty(form="lifting"), BassiEtAl(), Conforming()


def Block(mesh, method=EDGE, region="bottom", *, order=1, **supports):
    """Two springs in series: N = 0.03 / (1/200 + 1/1000) = 5 on an area of 1, as nu = 0."""
    supports = supports or {"dirichlet": {"top": (0,) * (mesh.dim - 1) + (-0.03,)}}
    problem = ContactProblem(HookeMaterial(E=1000, nu=0), Foundation(region, NormalCompliance(200)), **supports)
    return Discretization(problem, method, mesh, order=order)


def Refused(mesh, *arguments, **options):
    """The message of the ProblemError for a mesh."""
    with pytest.raises(ProblemError) as caught:
        Block(mesh, *arguments, **options).matrix   # noqa: B018
    return str(caught.value)
