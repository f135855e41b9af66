#!/usr/bin/env bash
# NGSolve 6.2.2608: with ContactBoundary a body that overhangs the other one is in contact with what is not there.
#
# One would guess: a point of the first boundary that has nothing of the second opposite to it takes no part.
#
# What happens: every point is paired with the nearest point of the other boundary, which beyond the end of that is the end itself, and
# the gap along the normal is the same there as beside it.  How far that goes is decided by maxdist alone: for a gap g the contact is
# longer by sqrt(maxdist^2 - g^2).  Below, half of a side has a support, and all of it is pressed.
#
# Why it matters: maxdist is chosen generously, so that bodies that approach each other are found.  A block on a shorter support, or one
# that slides over an edge, then has too much support, without any sign of it.
#
# Source of the guess: help(ContactBoundary.Update) calls maxdist the distance up to which the gap function is accurate, 0 for two mesh
# sizes; nothing says that what lies beside the other boundary counts as what lies opposite.
#
# A way round: keep maxdist little more than the gap, or let only the part of the boundary that is opposite be the first region.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet 'ngsolve==6.2.2608' 'numpy==2.2.6'
cd "$folder"
cat > find.py <<'PYTHON'
from math import sqrt

import ngsolve
from netgen.occ import Compound, MoveTo, OCCGeometry, Y
from ngsolve import CF, BilinearForm, ContactBoundary, GridFunction, InnerProduct, Variation, VectorH1, dx, x, y

GAP = 0.1


def length(overhang, maxdist):
    """int (gap/GAP)^2 over the side of a square that is GAP above another one, moved aside: the length that is paired."""
    upper, lower = (MoveTo(*place).Rectangle(1, 1).Face() for place in ((0, 0), (overhang, -1 - GAP)))
    upper.edges.Min(Y).name, lower.edges.Max(Y).name = "contact", "support"
    mesh = ngsolve.Mesh(OCCGeometry(Compound([upper, lower]), dim=2).GenerateMesh(maxh=0.1))
    fes = VectorH1(mesh, order=1)
    u, gfu = fes.TrialFunction(), GridFunction(fes)
    boundary = ContactBoundary(mesh.Boundaries("contact"), mesh.Boundaries("support"))
    between = CF((x, y)) + u - CF((x, y)).Other() - u.Other()
    gap = between * boundary.normal
    boundary.AddEnergy((gap / GAP) ** 2)
    form = BilinearForm(fes)
    form += Variation(1e-20 * InnerProduct(u, u) * dx)
    boundary.Update(gfu, form, intorder=10, maxdist=maxdist)
    return form.Energy(gfu.vec)


print("NGSolve", ngsolve.__version__)
assert ngsolve.__version__.startswith("6.2.2608")
assert abs(length(0, 1) - 1) < 1e-9                 # one above the other: all of it
for maxdist in (0.105, 0.2, 0.3, 1):
    found, expected = length(0.5, maxdist), min(1, 0.5 + sqrt(maxdist ** 2 - GAP ** 2))
    print(f"support under half of the side, maxdist {maxdist}: {found:.3f} of it is in contact (by the formula {expected:.3f})")
    assert abs(found - expected) < 0.02
assert length(0.5, 1) > 0.999
print("as described: the contact goes on beyond the end of the support")
PYTHON
"$folder/venv/bin/python" find.py
