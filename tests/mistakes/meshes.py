"""Mistakes in meshes, as in `mistakes`."""

import numpy as np
from badmeshes import Body, Doubled, Lost, Periodic, Refined, Straightened
from mistakes import Disc

from ngdgc import Solve
from ngdgc.mesh.facets import Facets
from ngdgc.mesh.checks import CheckElements, CheckSkeleton
from ngdgc.mesh.quadrature import BoundaryQuadrature
from ngdgc.meshes import ReadMesh, RectangleMesh

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
# One triangle of area 1, its lower side "foot".
INP = """*NODE
1, 0, 0
2, 2, 0
3, 0, 1
*ELEMENT, TYPE=CPE3, ELSET=steel
1, 1, 2, 3
*NSET, NSET=foot
1, 2
"""
GMSH = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 1 "steel"
1 2 "foot"
$EndPhysicalNames
$Nodes
3
1 0 0 0
2 2 0 0
3 0 1 0
$EndNodes
$Elements
2
1 1 2 2 1 1 2
2 2 2 1 1 1 2 3
$EndElements
"""


def File(folder, name, text):
    """A file with this text."""
    (folder / name).write_text(text)
    return folder / name


def Gmsh(old="", new="", text=GMSH):
    """Reads the triangle of Gmsh with another line."""
    assert old in text
    return lambda folder: ReadMesh(File(folder, "part.msh", text.replace(old, new)))


def Inp(old="", new=""):
    assert old in INP
    return lambda folder: ReadMesh(File(folder, "part.inp", INP.replace(old, new)))


def Second(folder):
    mesh = RectangleMesh(1)
    mesh.ngmesh.SecondOrder()
    mesh.ngmesh.Save(str(folder / "part.vol"))
    return ReadMesh(folder / "part.vol")


QUAD = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
9
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
5 .5 0 0
6 1 .5 0
7 .5 1 0
8 0 .5 0
9 .6 .5 0
$EndNodes
$Elements
1
1 10 2 0 1 1 2 3 4 5 6 7 8 9
$EndElements
"""

HEX = (0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)


def Brick(middle):
    """A cube of 20 nodes as Abaqus has it, the one between the first two corners at another place."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
    points = [*corners.tolist(), *(corners[list(edge)].mean(axis=0).tolist() for edge in HEX)]
    rows = [", ".join(map(str, point)) for point in points]
    rows[8] = middle
    nodes = "".join(f"{number}, {row}\n" for number, row in enumerate(rows, 1))
    return f"*NODE\n{nodes}*ELEMENT, TYPE=C3D20\n1, {', '.join(map(str, range(1, 21)))}\n"


READ = [
    (lambda _: ReadMesh("part.stl"), "file is 'part.stl' | give the name of a mesh | .msh of Gmsh"),
    (lambda folder: ReadMesh(folder / "part.msh"), "part.msh cannot be read | No such file | give a file that is there"),
    (lambda folder: ReadMesh(File(folder, "part.vol", "solid")),
     "part.vol is no mesh of Netgen | or is cut off | write it anew"),
    (Second, "part.vol has no elements of a body, or elements of second order | not in files of Netgen | Curve(2)"),
    (Gmsh("2.2 0 8", "2.2 1 8"),
     "part.msh is no mesh of Gmsh in ASCII | with nodes and elements | write it anew, with Mesh.MshFileVersion"),
    (Gmsh("2 2 2 1 1 1 2 3", "2 36 2 1 1 1 2 3"),
     "elements of Gmsh's type 36 | first and second order are read | set Mesh.ElementOrder"),
    (Gmsh("3 0 1 0\n", ""),
     "part.msh is cut off or has wrong numbers | 3 | write it anew"),
    (Gmsh("2 2 2 1 1 1 2 3\n", ""), "part.msh has no elements of a body | mesh a surface in the plane or a volume | write its"),
    (Gmsh("4 0 1 0", "4 0 1 1", QUAD), "part.msh has a surface in space | no body | mesh the volume"),
    (Gmsh("1 1 2 2 1 1 2\n", "1 1 2 2 1 1 2\n1 1 2 3 1 1 2\n"),
     "part.msh has sides that are in 'foot' and in 'group3' | give each one region | another name"),
    (Gmsh("3 0 1 0\n", "3 0 1 0\n4 5 5 0\n", GMSH.replace("2 2 1 1 2", "2 2 1 1 4")),
     "part.msh has sides in 'foot' | that bound no element | remove them"),
    (Gmsh('1 2 "foot"\n', '1 2 "foot"\n1 3 "hole"\n'), "part.msh has a group 'hole' | without sides | fill or remove it"),
    (Gmsh(text=QUAD),
     "part.msh has quad elements with nodes off their places | without these nodes | Mesh.SecondOrderIncomplete = 1"),
    (Gmsh("5 .5 0 0\n", "5 .5 -.2 0\n", QUAD.replace("9 .6 .5", "9 .5 .4").replace("8 9\n$End", "8 9\n2 2 2 0 1 1 2 3\n$End")),
     "part.msh has curved elements of second order | and of first order (triangle) | mesh it with one order"),
    (lambda folder: ReadMesh(File(folder, "part.inp", Brick(".5, -.1, 0"))),
     "part.inp has curved hex elements | up to 0.1 off the middles | write them with order 1, or mesh with tetrahedra"),
    (Inp("*NSET", "*INCLUDE, INPUT=other.inp\n*NSET"), "part.inp has *INCLUDE | elsewhere | give one file"),
    (Inp("CPE3", "CAX3"), "part.inp has elements of type 'CAX3' | C3D4 | are read"),
    (Inp("3, 0, 1\n", "3, zero, 1\n"), "part.inp is no mesh of Abaqus or CalculiX | 'zero' | write *NODE, *ELEMENT and sets"),
]
MESHES = [
    (lambda _: Disc(mesh=Doubled("triangle")),
     "between (0, 0) and (0.5, 0) is twice in the mesh, in boundary 'bottom' | would count twice in 'bottom' | keep it once"),
    (lambda _: Disc(mesh=Lost("quad")),
     "boundary 'bottom' has an element between (1.5, 0) and (2, 0) | which is no side of an element of the body | remove it"),
    (lambda _: BoundaryQuadrature.On(Facets(Straightened()), "default", 2),
     "boundary elements of region 'default' lie up to 0.0194 off | the same points in the middle | make the mesh again"),
    (lambda _: CheckElements(Refined()),
     "the mesh has order 3 but straight elements at a curved boundary | refined after it was curved | call mesh.Curve(3)"),
    (lambda _: CheckSkeleton(Facets(Lost("triangle", "axis"))),
     "boundary 'axis' has an element between (1.5, 0) and (2, 0) | need a mesh without it | or take assembly='facet'"),
    (lambda _: Solve(Disc(mesh=Lost("triangle", "axis"))).Mean("axis"),
     "boundary 'axis' | contains no side of an element | give one that is part"),
    (lambda _: Disc(mesh=Body(2, SQUARE, (0, 1, 3, 2))),
     "element 0 of the mesh, with corners (0, 0), (1, 0), (0, 1), (1, 1), has a map that folds, with a determinant from -1 to 1"
     " | must be images of the reference element | put its corners in order"),
    (lambda _: Disc(mesh=Body(2, [(0, 0), (1, 1), (2, 2)], (0, 1, 2))),
     "element 0 of the mesh, with corners (0, 0), (1, 1), (2, 2), has area zero | images of the reference element | move them"),
    (lambda _: Disc(mesh=Body(2, [*SQUARE, (0.7, 0.2)], (0, 1, 2), (0, 2, 4))),
     "elements 0 and 1 of the mesh lie on the same side of what they have in common, between (1, 1) and (0, 0) | "
     "must not overlap | remove one of them"),
    (lambda _: Disc(mesh=Body(2, SQUARE, (0, 1, 2), (0, 2, 3), (0, 2, 3))),
     "elements 0, 1, 2 of the mesh have a side in common | common to two elements at most | remove elements that occur twice"),
    (lambda _: Disc(mesh=Periodic(2)),
     "sides of the mesh are identified with each other, boundary left, right | no periodic sides | mesh without Identify"),
]
MESHES += READ
