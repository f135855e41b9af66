#!/usr/bin/env bash
# Netgen and NGSolve 6.2.2608: where two fused bodies have sides in one plane, one name is left for both, or covers what had none.
#
# One would guess: a + b joins two bodies and keeps the names of what is left of their faces, as a - b and Glue([a, b]) do.
#
# What happens: faces (in the plane: edges) that lie in one surface become a single one.  With two names one of them stays, that of the
# first operand; the other is in no list of boundaries any more.  With one name it goes to the whole: a foundation of area 1 has area 2.
# Nothing is printed or raised.  Names of materials are lost altogether.
#
# Why it matters: two pads, or a pad and its free surroundings, are drawn as two bodies that are fused.  A load or a foundation on the
# name then acts on twice the surface.
#
# Source of the guess: names survive cuts, fillets, chamfers, moves and Glue, and the manual of the OCC interface names faces before it
# joins bodies.
#
# A way round: Glue keeps both names, and the interface between the bodies; or name the faces of the sum, and look at the areas,
# Integrate(1, mesh.Boundaries(name)).

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet 'ngsolve==6.2.2608' 'numpy==2.2.6'
cd "$folder"
cat > find.py <<'PYTHON'
import ngsolve
from netgen.occ import Box, Glue, OCCGeometry, WorkPlane, Y, Z
from ngsolve import Integrate


def cubes(first, second):
    """Two cubes side by side, with names of their bottoms."""
    bodies = [Box((i, 0, 0), (i + 1, 1, 1)) for i in range(2)]
    for body, name in zip(bodies, (first, second)):
        body.mat(f"of {name}")
        if name:
            body.faces.Min(Z).name = name
    return bodies


def squares(first, second):
    faces = [WorkPlane().MoveTo(i, 0).Rectangle(1, 1).Face() for i in range(2)]
    for face, name in zip(faces, (first, second)):
        if name:
            face.edges.Min(Y).name = name
    return faces


def sizes(shape, dim):
    mesh = ngsolve.Mesh(OCCGeometry(shape, dim=dim).GenerateMesh(maxh=0.5))
    found = {name: round(Integrate(1, mesh.Boundaries(name)), 6) for name in set(mesh.GetBoundaries()) - {"default"}}
    return dict(sorted(found.items())), mesh.GetMaterials()


print("NGSolve", ngsolve.__version__)
assert ngsolve.__version__.startswith("6.2.2608")
for dim, make in ((3, cubes), (2, squares)):
    for names in (("pad", "foot"), ("pad", None), (None, "foot")):
        a, b = make(*names)
        glued, fused, turned = sizes(Glue([a, b]), dim), sizes(a + b, dim), sizes(b + a, dim)
        print(f"{dim}D {names!s:16s} glued {glued[0]!s:28s} a + b {fused[0]!s:14s} b + a {turned[0]}")
        assert glued[0] == {name: 1 for name in sorted(filter(None, names))}
        first = names[0] or names[1]
        assert fused[0] == {first: 2}
        assert turned[0] == {names[1] or names[0]: 2}
    if dim == 3:
        assert set(glued[1]) == {"of None", "of foot"} and set(fused[1]) == {"default"}
        cut = Box((0, 0, 0), (1, 1, 1))
        cut.faces.Min(Z).name = "pad"
        assert sizes(cut - Box((0.5, 0, 0), (1, 1, 0.5)), 3)[0] == {"pad": 0.5}     # a cut keeps it
print("as described: one name is left, for both sides")
PYTHON
"$folder/venv/bin/python" find.py
