#!/usr/bin/env bash
# Netgen 6.2.2608: a side of second order is straight for integrals over the boundary unless its edge descriptor has a number.
#
# One would guess: a plane mesh whose sides have a node in the middle is curved, for the triangles inside and for the boundary alike: both
# have the same nodes.
#
# What happens: of a mesh that is built by hand (AddRegion, Element1D, SecondOrder) the triangle beside a bent side is curved, and the side
# itself is not.  With the middle of the bottom of the unit square moved down by 0.1 the area is 1 + 2/3 0.1, as it should be, but the
# length of the bottom is 1 in place of 1.0261, and the integral of (0, y).n over the boundary is 1, not the area.  With
# mesh.EdgeDescriptor(side).edgenr set to any number of its own, which nothing else asks for, both are right.
#
# Why it matters: readers of mesh files build meshes like this.  The volume is right, pictures too, and so nobody looks; but a traction on
# such a side has a wrong total, a force through it is wrong, and contact happens on the chord.  First order meshes show nothing.
#
# Source of the guess: Element1D of a mesh that comes from a geometry, where the number is set.
#
# A way round: set edgenr of every region of sides right after AddRegion.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet 'ngsolve==6.2.2608' 'numpy==2.2.6'
cd "$folder"
cat > find.py <<'PYTHON'
import numpy as np
import ngsolve
from netgen.meshing import Element1D, Element2D, Mesh, MeshPoint, Pnt
from ngsolve import BND, CF, InnerProduct, Integrate, specialcf, y

DEPTH = 0.1
# Of the parabola y = -4 DEPTH x (1 - x), whose slope is at most 4 DEPTH.
SLOPE = 4 * DEPTH
LENGTH = (np.sqrt(1 + SLOPE ** 2) + np.arcsinh(SLOPE) / SLOPE) / 2


def bent(numbered):
    """The unit square in two triangles of second order, the node in the middle of its bottom moved down."""
    mesh = Mesh(dim=2)
    corners = [mesh.Add(MeshPoint(Pnt(*place, 0))) for place in ((0, 0), (1, 0), (1, 1), (0, 1))]
    inside = mesh.AddRegion("inside", dim=2)
    for triangle in ((0, 1, 2), (0, 2, 3)):
        mesh.Add(Element2D(inside, [corners[number] for number in triangle]))
    for number, name in enumerate(("bottom", "right", "top", "left")):
        side = mesh.AddRegion(name, dim=1)
        if numbered:
            mesh.EdgeDescriptor(side).edgenr = side
        mesh.Add(Element1D([corners[number], corners[(number + 1) % 4]], index=side))
    mesh.SecondOrder()
    places = mesh.Coordinates()
    middle, = np.flatnonzero(np.all(np.isclose(places[:, :2], (0.5, 0)), axis=1))
    places[middle, 1] = -DEPTH
    return ngsolve.Mesh(mesh)


print("NGSolve", ngsolve.__version__)
assert ngsolve.__version__.startswith("6.2.2608")
for numbered in (False, True):
    mesh = bent(numbered)
    area = Integrate(CF(1), mesh, order=10)
    length = Integrate(CF(1), mesh, BND, definedon=mesh.Boundaries("bottom"), order=10)
    flux = Integrate(InnerProduct(CF((0, y)), specialcf.normal(2)), mesh, BND, order=10)
    print(f"edgenr {'set' if numbered else 'left alone'}: area {area:.6f}, length of the bottom {length:.6f}, flux of (0, y) {flux:.6f}")
    assert abs(area - 1 - 2 / 3 * DEPTH) < 1e-12
    assert abs(length - (LENGTH if numbered else 1)) < 1e-6
    assert abs(flux - (area if numbered else 1)) < 1e-12
print("as described: the side is straight until it has a number")
PYTHON
"$folder/venv/bin/python" find.py
