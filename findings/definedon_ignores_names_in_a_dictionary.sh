#!/usr/bin/env bash
# NGSolve 6.2.2608: definedon={VOL: "steel"} and definedon={BND: "contact"} are no restriction; the names are ignored.
#
# One would guess: a name, or a regular expression, works in the dictionary as it does without one, definedon="steel".  The exception
# for definedonbound=region even recommends the dictionary, "definedon= {VOL: mats, BND: bnds}".
#
# What happens:
#  * A string (or a list of numbers) in the dictionary restricts nothing and raises nothing, whether such a region exists or not.
#  * A Region in it works, {BND: mesh.Boundaries("contact")}; but beside {VOL: mesh.Materials(".*")} the restriction to one side is gone
#    again: all sides of the materials are added.
#
# Why it matters: a multiplier or a wear field that should live on the contact boundary lives on all of them.  Below, the mass matrix of
# such a space adds up to the whole circumference, 4, instead of the length of one side, 1: forces and areas are those of another body,
# and no matrix becomes singular for it.
#
# Source of the guess: the exception quoted above, and help(H1), "definedon: Region or regexpr".

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet 'ngsolve==6.2.2608' 'numpy==2.2.6'
cd "$folder"
cat > find.py <<'PYTHON'
import ngsolve
import numpy as np
from netgen.occ import Glue, MoveTo, OCCGeometry, Rectangle, unit_square
from ngsolve import BND, H1, VOL, BilinearForm, ds, dx

print("NGSolve", ngsolve.__version__)
assert ngsolve.__version__.startswith("6.2.2608")


def total(definedon, mesh, measure):
    fes = H1(mesh, order=1, definedon=definedon)
    u, v = fes.TnT()
    a = BilinearForm(u * v * measure, check_unused=False).Assemble()
    return float(np.asarray(a.mat.CSR()[0]).sum())


def check(text, value, expected):
    print(f"{text:72s} {value:.3f}")
    assert abs(value - expected) < 1e-10


square = ngsolve.Mesh(unit_square.GenerateMesh(maxh=0.3))                 # sides of length 1
left = square.Boundaries("left")
check('length: left, as definedon=mesh.Boundaries("left")', total(left, square, ds), 1)
check('length: left, as {BND: mesh.Boundaries("left")}', total({BND: left}, square, ds), 1)
check('length: left, as {BND: "left"}', total({BND: "left"}, square, ds), 4)
check('length: a side that is not there, as {BND: "nonsense"}', total({BND: "nonsense"}, square, ds), 4)
check('length: {VOL: mesh.Materials(".*"), BND: mesh.Boundaries("left")}', total({VOL: square.Materials(".*"), BND: left}, square, ds), 4)

steel, rubber = Rectangle(1, 1).Face(), MoveTo(0, 1).Rectangle(1, 1).Face()
steel.name, rubber.name = "steel", "rubber"
pair = ngsolve.Mesh(OCCGeometry(Glue([steel, rubber]), dim=2).GenerateMesh(maxh=0.5))
check('area: steel, as definedon="steel"', total("steel", pair, dx), 1)
check('area: steel, as {VOL: mesh.Materials("steel")}', total({VOL: pair.Materials("steel")}, pair, dx), 1)
check('area: steel, as {VOL: "steel"}', total({VOL: "steel"}, pair, dx), 2)

try:
    H1(square, definedonbound=left)
except Exception as error:
    print("the exception:", str(error).strip())
    assert "definedon= {VOL: mats, BND: bnds}" in str(error)
else:
    raise AssertionError("definedonbound takes regions now")
print("as described: names in the dictionary are ignored")
PYTHON
"$folder/venv/bin/python" find.py
