#!/usr/bin/env bash
# Netgen 6.2.2608: Export(file, "Abaqus Format") writes the boundary as structural elements, all sides of a structured mesh in one set.
#
# One would guess: the boundary arrives as node or surface sets under its names, with which Abaqus or CalculiX can fix and load the
# body.
#
# What happens:
#  * A square of MakeStructured2DMesh, or one built by hand with AddRegion, has one set for its boundary.  It has the name of the first
#    side ("bottom") and holds all segments of all sides; "right", "top" and "left" do not occur in the file, though NGSolve knows them.
#    Meshes of a geometry (occ) have a set for each side.
#  * The segments are trusses, T2D2, and the triangles are CPS3: plane stress, whatever was meant.  In 3D the triangles of the boundary
#    are CPS3 beside the C3D4 of the body (CPS6 beside C3D10), plane stress elements that are not even in a plane z = 0.
#  * No *NSET and no *SURFACE is written.
#
# Why it matters: for the solver the sides are part of the structure.  A section that is given to everything makes trusses and plates of
# them; a support on the nodes of "bottom" fixes the whole circumference, and a contact surface made of that set is the boundary of the
# whole body.  Node numbers and coordinates are fine, so that pictures of the mesh are.
#
# Source of the guess: the sets of meshes that come from a geometry, and mesh.GetBoundaries(), which is the same for both.
#
# A way round: write the sets from NGSolve, [v.nr + 1 for v in el.vertices] of mesh.Elements(BND), and drop the elements on the
# boundary.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet 'ngsolve==6.2.2608' 'numpy==2.2.6'
cd "$folder"
cat > find.py <<'PYTHON'
from pathlib import Path

import ngsolve
from netgen.occ import unit_cube, unit_square
from ngsolve import BND
from ngsolve.meshes import MakeStructured2DMesh


def sets(netgen_mesh, file):
    netgen_mesh.Export(file, "Abaqus Format")
    found, current = {}, None
    text = Path(file).read_text()
    for line in text.splitlines():
        if line.startswith("*"):
            fields = dict(part.strip().split("=") for part in line.split(",")[1:] if "=" in part)
            current = (fields["type"], fields["ELSET"]) if line.upper().startswith("*ELEMENT") else None
        elif current and line.strip():
            found[current] = found.get(current, 0) + 1
    keywords = {line.split(",")[0].upper() for line in text.splitlines() if line.startswith("*")}
    return found, keywords


print("NGSolve", ngsolve.__version__)
assert ngsolve.__version__.startswith("6.2.2608")

for text, mesh in (("occ", ngsolve.Mesh(unit_square.GenerateMesh(maxh=0.5))), ("structured", MakeStructured2DMesh(False, 2, 2))):
    found, keywords = sets(mesh.ngmesh, "square.inp")
    print(f"2D, {text}: boundaries {mesh.GetBoundaries()}, file {found}")
    assert mesh.GetBoundaries() == ("bottom", "right", "top", "left")
    trusses = {name: number for (kind, name), number in found.items() if kind == "T2D2"}
    expected = {name: 2 for name in mesh.GetBoundaries()} if text == "occ" else {"bottom": 8}
    assert trusses == expected and sum(trusses.values()) == sum(1 for _ in mesh.Elements(BND))
    assert {kind for kind, _ in found} == {"T2D2", "CPS3"}
    assert not keywords & {"*NSET", "*SURFACE"}

cube = unit_cube.GenerateMesh(maxh=1)
for order, (side, volume) in ((1, ("CPS3", "C3D4")), (2, ("CPS6", "C3D10"))):
    if order == 2:
        cube.SecondOrder()
    found, keywords = sets(cube, "cube.inp")
    print(f"3D, order {order}: file {found}")
    assert {name for kind, name in found if kind == side} == {"back", "bottom", "front", "left", "right", "top"}
    assert {kind for kind, _ in found} == {side, volume}
    assert not keywords & {"*NSET", "*SURFACE"}
print("as described: sides are trusses in one set, faces are plane stress elements")
PYTHON
"$folder/venv/bin/python" find.py
