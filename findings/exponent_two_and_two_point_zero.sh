#!/usr/bin/env bash
# NGSolve 6.2.2608: u**2 and u**2.0 are not the same; with a real exponent, negative bases are NaN in integrals and right at points.
#
# One would guess: u**2.0, or u**m with m = Parameter(2), is u**2, as it is for floats and numpy arrays.
#
# What happens: an int stands for a power, a float, a CF or a Parameter, wherever several points are computed at a
# time, evidently for exp(m log u).
#  * The integral of gfu**2.0 is NaN where gfu < 0, and so are the values at an array of points, while the value at a single mesh point,
#    (gfu**2.0)(mesh(x, y)), is right: the look that is meant to find the NaN does not see it.
#  * At u = 0 the value is right (0), and the linearised matrix is NaN: Apply() looks healthy, AssembleLinearization() is not.
#  * IfPos(u, u**m, 0) is right everywhere.  IfPos(-u, 0, u**m), the same law to the reader, has a NaN matrix at u = 0, since zero is
#    not positive and goes to the power.
#
# Why it matters: u_+^m is the law of normal compliance, and m is the parameter that one varies.  Every computation begins at u = 0, and
# almost every point of a contact boundary has u < 0 (a gap) sooner or later.  Newton's method then meets NaN in the first step, with a
# residual that is fine.
#
# Source of the guess: Python, where 2 == 2.0, and NGSolve's own value at points.
#
# A way round: an int where it is one; else IfPos(u, u**m, 0), with the power in the branch that is taken for u > 0.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet 'ngsolve==6.2.2608' 'numpy==2.2.6'
cd "$folder"
cat > find.py <<'PYTHON'
import math

import ngsolve
import numpy as np
from netgen.occ import unit_square
from ngsolve import CF, H1, BilinearForm, GridFunction, IfPos, Integrate, Parameter, dx, x

mesh = ngsolve.Mesh(unit_square.GenerateMesh(maxh=0.3))
fes = H1(mesh, order=1)
u, v = fes.TnT()
gfu = GridFunction(fes)
point = mesh(0.3, 0.4)


def residual_and_matrix(law):
    a = BilinearForm(fes)
    a += law * v * dx
    residual = gfu.vec.CreateVector()
    a.Apply(gfu.vec, residual)
    a.AssembleLinearization(gfu.vec)
    return float(np.sum(residual.FV().NumPy())), float(np.sum(np.asarray(a.mat.CSR()[0])))


print("NGSolve", ngsolve.__version__)
assert ngsolve.__version__.startswith("6.2.2608")

gfu.Set(x - 2)                                                            # negative everywhere
exponents = {"2": 2, "2.0": 2.0, "CF(2)": CF(2), "Parameter(2)": Parameter(2)}
for name, m in exponents.items():
    at_point, integral = (gfu**m)(point), Integrate(gfu**m, mesh)
    print(f"gfu = x - 2:  gfu**{name:12s} at a point {at_point:.4f}   integral {integral:.4f}")
    assert abs(at_point - 1.7**2) < 1e-12
    array = (gfu**m)(mesh(np.array([0.3, 0.5]), np.array([0.4, 0.5])))
    assert np.isnan(array).all() if name != "2" else np.allclose(array.ravel(), (1.7**2, 1.5**2))
    assert math.isnan(integral) if name != "2" else abs(integral - 7 / 3) < 1e-12

gfu.vec[:] = 0
laws = {"u**2": (u**2, False), "u**2.0": (u**2.0, True), "IfPos(u, u**2.0, 0)": (IfPos(u, u**2.0, 0), False),
        "IfPos(-u, 0, u**2.0)": (IfPos(-u, 0, u**2.0), True), "IfPos(-u, 0, u**2)": (IfPos(-u, 0, u**2), False)}
for name, (law, broken) in laws.items():
    residual, matrix = residual_and_matrix(law)
    print(f"gfu = 0:      {name:21s} residual {residual:.1f}   matrix {matrix}")
    assert residual == 0 and math.isnan(matrix) == broken
print("as described: real exponents are NaN where integers are not")
PYTHON
"$folder/venv/bin/python" find.py
