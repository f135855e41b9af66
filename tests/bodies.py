"""Meshes of the tests: bodies whose sides have names."""

import numpy as np
from netgen.geom2d import SplineGeometry
from netgen.meshing import Element1D, Element2D, Element3D, FaceDescriptor, MeshPoint, Pnt
from netgen.meshing import Mesh as NetgenMesh
from netgen.occ import Box, Circle, Glue, MoveTo, OCCGeometry, WorkPlane
from ngsolve import Mesh
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh

from ngdgc.meshes import RectangleMesh


def AddSides(mesh, sides):
    """Named sides of a plane mesh of Netgen, {name: [(vertex, vertex), ...]}, counted from 0."""
    for name, edges in sides.items():
        region = mesh.AddRegion(name, dim=1)
        for first, second in edges:     # not all at once: in NGSolve 6.2.2604 they would have no region
            mesh.Add(Element1D(index=region, vertices=[first + 1, second + 1]))


def Mixed():
    """The unit square from two rectangles on the left and two triangles on the right."""
    mesh = NetgenMesh()
    mesh.dim = 2
    mesh.AddPoints(np.array([[0, 0, 0], [0.6, 0, 0], [1, 0, 0], [0, 0.5, 0], [0.6, 0.5, 0], [0, 1, 0], [0.6, 1, 0], [1, 1, 0]],
                            dtype=float))
    domain = mesh.AddRegion("domain", dim=2)
    mesh.AddElements(dim=2, index=domain, data=np.array([[0, 1, 4, 3], [3, 4, 6, 5]], dtype=np.int32), base=0)
    mesh.AddElements(dim=2, index=domain, data=np.array([[1, 2, 4], [4, 2, 7], [4, 7, 6]], dtype=np.int32), base=0)
    AddSides(mesh, {"bottom": [[0, 1], [1, 2]], "right": [[2, 7]], "top": [[7, 6], [6, 5]], "left": [[5, 3], [3, 0]]})
    return Mesh(mesh)


def Distorted(cells):
    """Unstructured triangles, or quadrilaterals that are no parallelograms, or a mixed mesh."""
    if cells == "mixed":
        return Mixed()
    if cells == "quad":
        return MakeStructured2DMesh(quads=True, nx=3, ny=3, mapping=lambda s, t: (s + 0.1 * t * (1 - t), t * (1 - 0.2 * s)))
    geometry = SplineGeometry()
    geometry.AddRectangle((0, 0), (1, 1), bcs=["bottom", "right", "top", "left"])
    return Mesh(geometry.GenerateMesh(maxh=0.4))


def Tilted(angle):
    """A unit square rotated by an angle; sides bottom, right, top, left."""
    c, s = np.cos(angle), np.sin(angle)
    return MakeStructured2DMesh(quads=False, nx=3, ny=3, mapping=lambda a, b: (c * a - s * b, s * a + c * b))


def Ring(order, maxh):
    """Quarter ring 1 < r < 2, its arcs "inner" and "outer", its straight sides "horizontal" and "vertical"."""
    geometry = SplineGeometry()
    p = [geometry.AppendPoint(*q) for q in [(1, 0), (2, 0), (2, 2), (0, 2), (0, 1), (1, 1)]]
    geometry.Append(["line", p[0], p[1]], bc="horizontal")
    geometry.Append(["spline3", p[1], p[2], p[3]], bc="outer")
    geometry.Append(["line", p[3], p[4]], bc="vertical")
    geometry.Append(["spline3", p[4], p[5], p[0]], bc="inner", leftdomain=1, rightdomain=0)
    return Mesh(geometry.GenerateMesh(maxh=maxh)).Curve(order)


def Cube(cells, n=1):
    return MakeStructured3DMesh(hexes=cells == "hex", prism=cells == "prism", nx=n, ny=n, nz=n)


def Pyramids():
    """The unit cube of six pyramids."""
    net = NetgenMesh(dim=3)
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1), (0.5, 0.5, 0.5)]
    points, region = [net.Add(MeshPoint(Pnt(*corner))) for corner in corners], net.AddRegion("solid", dim=3)
    for face in [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]:
        base = [points[corner] for corner in face]
        net.Add(Element3D(region, base + [points[8]]))
        net.Add(Element2D(net.Add(FaceDescriptor(surfnr=1, domin=1, bc=1)), base[::-1]))
    return Mesh(net)


def Layers(dim):
    """A body of two materials with the interface "mid"; the sides are those of the unit square or cube."""
    if dim == 2:
        parts = [MoveTo(0, 0).Rectangle(1, 0.4).Face(), MoveTo(0, 0.4).Rectangle(1, 0.6).Face()]
        sides = [list(part.edges) for part in parts]
    else:
        parts = [Box((0, 0, 0), (1, 1, 0.4)), Box((0, 0, 0.4), (1, 1, 1))]
        sides = [list(part.faces) for part in parts]
    for part, own, name in zip(parts, sides, ("soft", "hard")):
        part.name = name
        for side in own:
            at = [side.center.x, side.center.y, side.center.z][:dim]
            names = {(-1, 0): "bottom", (-1, 1): "top", (-1, 0.4): "mid", (0, 0): "left", (0, 1): "right", (1, 0): "front",
                     (1, 1): "back"}
            side.name = next(name for (axis, value), name in names.items() if abs(at[axis] - value) < 1e-9)
    return Mesh(OCCGeometry(Glue(parts), dim=dim).GenerateMesh(maxh=0.3 if dim == 2 else 0.5))


def Halves():
    """`Layers(2)` of six triangles, of which no two facets lie alike in their elements."""
    mesh = NetgenMesh()
    mesh.dim = 2
    points = [(0, 0), (1, 0), (0, 0.4), (0.55, 0.4), (1, 0.4), (0, 1), (1, 1)]
    mesh.AddPoints(np.array([(*point, 0) for point in points], dtype=float))
    for name, elements in (("soft", [[0, 1, 3], [3, 2, 0], [4, 3, 1]]), ("hard", [[2, 3, 5], [5, 3, 6], [6, 3, 4]])):
        mesh.AddElements(dim=2, index=mesh.AddRegion(name, dim=2), data=np.array(elements, dtype=np.int32), base=0)
    AddSides(mesh, {"bottom": [[0, 1]], "right": [[1, 4], [4, 6]], "top": [[6, 5]], "left": [[5, 2], [2, 0]],
                    "mid": [[2, 3], [3, 4]]})
    return Mesh(mesh)


def Stacked(faces=lambda middle: True):
    """`Layers(3)` of twelve tetrahedra; with `faces`, of the middle of a face, which ones between the layers are "mid"."""
    old = MakeStructured3DMesh(hexes=False, nx=1, ny=1, nz=2, mapping=lambda s, t, h: (s, t, 0.8 * h + 0.4 * h * (h - 0.5)))
    mesh, points = NetgenMesh(dim=3), old.ngmesh.Coordinates()
    mesh.AddPoints(points)
    layers = [mesh.AddRegion(name, dim=3) for name in ("soft", "hard")]
    names = {name: mesh.AddRegion(name, dim=2) for name in (*old.GetBoundaries(), "mid")}
    between = set()
    for element in old.ngmesh.Elements3D():
        nodes = [vertex.nr for vertex in element.vertices]
        height = points[np.array(nodes) - 1, 2]
        mesh.Add(Element3D(layers[int(height.mean() > 0.4)], nodes))
        flat = tuple(sorted(node for node, z in zip(nodes, height) if abs(z - 0.4) < 1e-9))
        if len(flat) == 3 and faces(points[np.array(flat) - 1].mean(axis=0)):
            between.add(flat)
    for side in old.ngmesh.Elements2D():
        mesh.Add(Element2D(names[old.ngmesh.GetBCName(side.index - 1)], [vertex.nr for vertex in side.vertices]))
    for flat in sorted(between):
        mesh.Add(Element2D(names["mid"], list(flat)))
    return Mesh(mesh)


def Perforated():
    """A plate with a curved hole; on its boundary elements NGSolve's normal points into the body."""
    plate, hole = MoveTo(0, 0).Rectangle(1, 1).Face(), Circle((0.5, 0.5), 0.2).Face()
    names = {(0, 0.5): "left", (1, 0.5): "right", (0.5, 0): "bottom", (0.5, 1): "top"}
    for edge in plate.edges:
        edge.name = names[round(edge.center.x, 6), round(edge.center.y, 6)]
    hole.edges.name = "hole"
    mesh = Mesh(OCCGeometry(plate - hole, dim=2).GenerateMesh(maxh=0.3))
    mesh.Curve(2)
    return mesh


def Plate():
    """A square with a round hole, whose boundary NGSolve orients into the body."""
    face = WorkPlane().Rectangle(2, 2).Face() - WorkPlane().Circle(1, 1, 0.4).Face()
    for edge in face.edges:
        edge.name = "hole" if 0.5 < edge.center.x < 1.5 and 0.5 < edge.center.y < 1.5 else "outer"
    return Mesh(OCCGeometry(face, dim=2).GenerateMesh(maxh=0.5)).Curve(3)


RING = [(2, 2), (3, 2), (4, 2), (4, 3), (4, 4), (3, 4), (2, 4), (2, 3), (2, 2)]
LINE = [(i, 3) for i in range(7)]


def Crossed(paths, cells="triangle", turn=0):
    """The unit square of 6 by 6 cells with named paths along its grid; with turn the elements are numbered in another order."""
    mesh = RectangleMesh(6, cells=cells).ngmesh
    points = np.array([point.p[:2] for point in mesh.Points()])
    at = {tuple(np.rint(6 * point).astype(int)): number for number, point in enumerate(points)}
    if turn:
        elements = mesh.Elements2D().NumPy()["nodes"][:, :3 if cells == "triangle" else 4].astype(np.int32)
        sides = [(mesh.GetBCName(side.index - 1), [vertex.nr - 1 for vertex in side.vertices]) for side in mesh.Elements1D()]
        mesh = type(mesh)(dim=2)
        mesh.AddPoints(points)
        mesh.AddElements(dim=2, index=mesh.AddRegion("domain", dim=2), data=np.roll(elements, turn, axis=0), base=1)
        AddSides(mesh, {name: [side for own, side in sides if own == name] for name in dict(sides)})
    for name, several in paths.items():
        AddSides(mesh, {name: [(at[a], at[b]) for path in several for a, b in zip(path, path[1:])]})
    return Mesh(mesh)
