#!/usr/bin/env bash
# Netgen and NGSolve 6.2.2608: bodies that were glued come apart in a STEP file, while all names survive; BREP does the opposite.
#
# One would guess: Glue([steel, rubber]) has one face between the two bodies, and WriteStep() followed by OCCGeometry("part.step")
# brings back what was written.
#
# What happens: the two solids come back with their names, and the names of their faces, but the face between them has become two.  The
# mesh has two nodes in every point of the interface, NGSolve sees two bodies that touch without knowing of each other, and nothing is
# raised or printed.  WriteBrep() keeps the bodies together and loses every name.  In memory both are right.
#
# Why it matters: STEP is the format in which parts are handed on, and names are what conditions hang on, so that the file looks
# complete. In a computation with dx(skeleton=True) the interior facets of the interface are missing, and with continuous elements the
# second body hangs on nothing: below, the jump between steel and rubber that a DG form integrates has the area 0 instead of 1.  With
# springs or a contact law on the second body the matrix is even regular, and the stresses are wrong.
#
# Source of the guess: the help of WriteStep ("Export shape in STEP - format") and the names that come back.
#
# A way round: Glue(OCCGeometry("part.step").shape.solids), which keeps the names.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet 'ngsolve==6.2.2608' 'numpy==2.2.6'
cd "$folder"
cat > find.py <<'PYTHON'
import ngsolve
import numpy as np
from netgen.occ import Box, Glue, OCCGeometry, X
from ngsolve import L2, BilinearForm, GridFunction, InnerProduct, dx

print("NGSolve", ngsolve.__version__)
assert ngsolve.__version__.startswith("6.2.2608")

steel, rubber = Box((0, 0, 0), (1, 1, 1)), Box((1, 0, 0), (2, 1, 1))
steel.mat("steel")
rubber.mat("rubber")
steel.faces.Min(X).name, rubber.faces.Max(X).name = "clamped", "pulled"
part = Glue([steel, rubber])
part.WriteStep("part.step")
part.WriteBrep("part.brep")


def look(shape):
    mesh = ngsolve.Mesh(OCCGeometry(shape).GenerateMesh(maxh=0.5))
    points = [tuple(np.round(v.point, 9)) for v in mesh.vertices if abs(v.point[0] - 1) < 1e-9]
    fes = L2(mesh, order=0, dgjumps=True)
    u, v = fes.TnT()
    a = BilinearForm((u - u.Other()) * (v - v.Other()) * dx(skeleton=True)).Assemble()
    left = GridFunction(fes)
    left.vec.FV().NumPy()[:] = [np.mean([mesh[v].point[0] for v in el.vertices]) < 1 for el in mesh.Elements(ngsolve.VOL)]
    image = left.vec.CreateVector()
    image.data = a.mat * left.vec
    names = sorted(set(mesh.GetMaterials()) | set(mesh.GetBoundaries()))
    return len(points), len(set(points)), InnerProduct(left.vec, image), names


cases = {"in memory": part, "STEP": OCCGeometry("part.step").shape, "BREP": OCCGeometry("part.brep").shape}
cases["STEP, glued again"] = Glue(cases["STEP"].solids)
results = {}
for name, shape in cases.items():
    results[name] = nodes, places, area, names = look(shape)
    print(f"{name:18s} {nodes:3d} nodes in {places} points of the interface, area of the jump {area:.3f}, names {names}")

all_names = ["clamped", "default", "pulled", "rubber", "steel"]
for name, shared, kept in (("in memory", True, True), ("STEP", False, True), ("BREP", True, False), ("STEP, glued again", True, True)):
    nodes, places, area, names = results[name]
    assert nodes == (places if shared else 2 * places)
    assert abs(area - (1 if shared else 0)) < 1e-12
    assert names == (all_names if kept else ["default"])
print("as described: STEP keeps the names and separates the bodies, BREP the other way round")
PYTHON
"$folder/venv/bin/python" find.py
