"""Mistakes in meshes, as in `mistakes`."""

from badmeshes import Body, Doubled, Lost, Periodic, Refined, Straightened
from mistakes import Disc

from ngdgc import Solve
from ngdgc.mesh.facets import Facets
from ngdgc.mesh.checks import CheckElements, CheckSkeleton
from ngdgc.mesh.quadrature import BoundaryQuadrature

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
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
