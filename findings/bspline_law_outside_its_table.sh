#!/usr/bin/env bash
# NGSolve 6.2.2608: a BSpline is 0 before its first knot and goes on as a polynomial after its last one.
#
# One would guess: the same on both sides, either 0 (what the basis functions are outside their knots) or the last value (what the
# documentation promises of VoxelCoefficient, the other table of NGSolve).
#
# What happens: with order 2 (piecewise linear), knots 0, 0, 1, 2, 2 and values 3, 1, 4, the spline interpolates 3, 1, 4 at 0, 1, 2.
# Just before 0 it jumps from 3 to 0 and has derivative 0; after 2 it continues with the last slope, 7 at 3, without a bound.  Order 3
# continues as a parabola.  So do Integrate(), Differentiate() and the linearisation of forms.  Nothing is raised or printed, and values
# in excess of the knots are dropped.
#
# Why it matters: BSpline is the tool for measured laws: pressure against penetration, friction against slip, hardening.  A law with
# adhesion begins at a negative penetration with a pressure that is not 0: one step further out the surfaces are free, and Newton's
# method sees the jump with a zero tangent.  A law whose last measured piece is steep or falling (slip weakening) is extrapolated to
# whatever it leads to: below, friction 0.4 that weakens to 0.1 at slip 2 becomes negative, that is, drives the body.
#
# Source of the guess: help(BSpline), which does not mention the ends, and help(VoxelCoefficient).
#
# A way round: clamp the argument, IfPos(s - s1, s1, s), or add knots far outside with the value of the end.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet 'ngsolve==6.2.2608' 'numpy==2.2.6'
cd "$folder"
cat > find.py <<'PYTHON'
import ngsolve
import numpy as np
from netgen.occ import unit_square
from ngsolve import H1, BilinearForm, BSpline, GridFunction, VoxelCoefficient, dx

print("NGSolve", ngsolve.__version__)
assert ngsolve.__version__.startswith("6.2.2608")

linear = BSpline(2, [0, 0, 1, 2, 2], [3, 1, 4])
at = (-1, -1e-9, 0, 1, 2, 3, 5)
print("linear    ", {t: linear(t) for t in at})
assert np.allclose([linear(t) for t in at], (0, 0, 3, 1, 4, 7, 13))
slope, integral = linear.Differentiate(), linear.Integrate()
assert slope(-1) == 0 and abs(slope(3) - 3) < 1e-12
assert integral(-1) == 0 and abs(integral(3) - (2 + 2.5 + 5.5)) < 1e-12
assert [BSpline(2, [0, 0, 1, 2, 2], [3, 1, 4, 9, 9, 9])(t) for t in at] == [linear(t) for t in at]

parabola = BSpline(3, [0, 0, 0, 1, 2, 2, 2], [0, 1, 2, 4])
print("quadratic ", {t: parabola(t) for t in at})
assert np.allclose([parabola(t) for t in (-1, 2, 2.5, 3)], (0, 4, 6.375, 9.5))

weakening = BSpline(2, [0, 0, 1, 2, 2], [0.4, 0.3, 0.1])                  # coefficient of friction against slip
print("friction  ", {t: round(weakening(t), 12) for t in (0, 1, 2, 3)})
assert abs(weakening(2) - 0.1) < 1e-12 and abs(weakening(3) + 0.1) < 1e-12

mesh = ngsolve.Mesh(unit_square.GenerateMesh(maxh=0.5))                   # the same in forms: residual and tangent
fes = H1(mesh, order=1)
u, v = fes.TnT()
gfu = GridFunction(fes)
for value, expected in ((-1, (0, 0)), (1.5, (2.5, 3)), (3, (7, 3))):
    gfu.vec[:] = value
    a = BilinearForm(fes)
    a += linear(u) * v * dx
    residual = gfu.vec.CreateVector()
    a.Apply(gfu.vec, residual)
    a.AssembleLinearization(gfu.vec)
    found = residual.FV().NumPy().sum(), np.asarray(a.mat.CSR()[0]).sum()
    print(f"form at u = {value}: law {found[0]:.3f}, tangent {found[1]:.3f}")
    assert np.allclose(found, expected)

voxels = VoxelCoefficient((0.2, 0.2), (0.8, 0.8), np.array([[3.0, 4.0], [3.0, 4.0]]))
assert np.allclose((voxels(mesh(0.01, 0.5)), voxels(mesh(0.99, 0.5))), (3, 4))        # constant on both sides
print("as described: 0 on the left, continued on the right")
PYTHON
"$folder/venv/bin/python" find.py
