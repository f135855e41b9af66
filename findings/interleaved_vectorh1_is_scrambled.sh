#!/usr/bin/env bash
# NGSolve 6.2.2608: VectorH1(mesh, order, interleaved=True) gives wrong fields and wrong solutions, without a word.
#
# One would guess: the documented flag "interleaved" only renumbers the unknowns (x0, y0, x1, y1, ... instead of x0, x1, ..., y0, y1,
# ...), so that whatever is computed is the same field.
#
# What happens: the unknowns of the space are renumbered and, within every element, listed pair by pair, while the shape functions of
# the element remain sorted by component.  On a triangle of order 1 the list is (x0, y0, x4, y4, x11, y11) for shapes (x, x, x, y, y,
# y), so x and y change places.  The linear field (x, 2 y), which Set() should reproduce, is off by a third; the mass matrix has other
# eigenvalues; a clamped, pulled square moves 1.8 times (order 1) and 4.8 times (order 2) as far.  A value of Interpolate() at a point
# is right, for it never leaves its element: a quick look does not find it.
#
# Why it matters: pairs of unknowns per node are what algebraic multigrid (pyamg, PETSc, hypre) and block matrices want of elasticity,
# and the flag is the obvious way to get them.  The matrix is symmetric, positive definite and wrong.
#
# Source of the guess: help(VectorH1), keyword "interleaved".
#
# A way round: number i of component c becomes dim * i + c; permute matrix and vector of the ordinary space outside NGSolve.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet 'ngsolve==6.2.2608' 'numpy==2.2.6' 'scipy==1.15.3'
cd "$folder"
cat > find.py <<'PYTHON'
import ngsolve
import numpy as np
import scipy.sparse as sp
from netgen.occ import unit_square
from ngsolve import (CF, BilinearForm, ElementId, Grad, GridFunction, InnerProduct, Integrate, Interpolate, LinearForm, Norm, Sym, Trace,
                     VectorH1, VOL, ds, dx, x, y)

mesh = ngsolve.Mesh(unit_square.GenerateMesh(maxh=0.3))
field = CF((x, 2 * y))
point = mesh(0.3, 0.4)


def error(fes):
    gfu = GridFunction(fes)
    gfu.Set(field)
    return Integrate(Norm(gfu - field), mesh) / Integrate(Norm(field), mesh)


def eigenvalues(fes):
    u, v = fes.TnT()
    a = BilinearForm(InnerProduct(u, v) * dx).Assemble()
    return np.linalg.eigvalsh(sp.csr_matrix(a.mat.CSR(), shape=(fes.ndof, fes.ndof), copy=True).toarray())


def pulled(fes):
    u, v = fes.TnT()
    strain, virtual = Sym(Grad(u)), Sym(Grad(v))
    a = BilinearForm(2 * InnerProduct(strain, virtual) * dx + Trace(strain) * Trace(virtual) * dx).Assemble()
    f = LinearForm(v[0] * ds("right")).Assemble()
    gfu = GridFunction(fes)
    gfu.vec.data = a.mat.Inverse(fes.FreeDofs(), "sparsecholesky") * f.vec
    return Integrate(gfu[0] * ds("right"), mesh)


print("NGSolve", ngsolve.__version__)
assert ngsolve.__version__.startswith("6.2.2608")
for order in (1, 2):
    plain = VectorH1(mesh, order=order, dirichlet="left")
    mixed = VectorH1(mesh, order=order, dirichlet="left", interleaved=True)
    assert mixed.ndof == plain.ndof and mixed.FreeDofs().NumSet() == plain.FreeDofs().NumSet()
    print(f"order {order}: unknowns of the first element {plain.GetDofNrs(ElementId(VOL, 0))} and {mixed.GetDofNrs(ElementId(VOL, 0))}")
    errors = error(plain), error(mixed)
    other = np.abs(eigenvalues(plain) - eigenvalues(mixed)).max()
    moved = pulled(plain), pulled(mixed)
    inside = Interpolate(field, mixed)(point)
    print(f"  relative error of Set(): {errors[0]:.1e} and {errors[1]:.2f};  eigenvalues of the mass matrix differ by {other:.1e}")
    print(f"  displacement of the pulled side: {moved[0]:.4f} and {moved[1]:.4f};  Interpolate at (0.3, 0.4): {inside}")
    assert errors[0] < 1e-10 and errors[1] > 0.1
    assert other > 1e-3
    assert abs(moved[1] / moved[0] - 1) > 0.5
    assert np.allclose(inside, (0.3, 0.8))
print("as described: interleaved=True is no renumbering")
PYTHON
"$folder/venv/bin/python" find.py
