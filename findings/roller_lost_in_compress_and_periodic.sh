#!/usr/bin/env bash
# NGSolve 6.2.2608: a roller (dirichletx=...) is gone after Compress() or Periodic().
#
# One would guess: Compress(V) and Periodic(V) renumber the unknowns of V and keep its conditions.  They do for
# VectorH1(dirichlet="bottom"): the same unknowns are fixed before and after.
#
# What happens: the conditions on single components, dirichletx="left" and dirichlety, dirichletz, are not handed on.  They hold in V
# and in a product V * W; in Compress(V) and Periodic(V) the component is free, and nothing is printed or raised.
#
# Why it matters: a roller is how half a body is cut off at its plane of symmetry, and Periodic is how one wave of a rough surface
# stands for all of them.  As long as something else holds the body the matrix stays regular and the solution looks fine.  Below, a
# square that is clamped at the bottom, on a roller at the left and pulled at the right moves by 0.738 instead of 0.274 at the right,
# and leaves its plane of symmetry by 0.578.
#
# Source of the guess: the documentation of VectorH1 (help(VectorH1) lists dirichletx beside dirichlet) and of Compress, which speaks of
# unknowns that are unused or not active.
#
# A way round: fix the component afterwards, with FreeDofs() of V, renumbered, or by a penalty on the side.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet 'ngsolve==6.2.2608' 'numpy==2.2.6'
cd "$folder"
cat > find.py <<'PYTHON'
import ngsolve
from netgen.occ import OCCGeometry, Rectangle, X, Y
from ngsolve import (BilinearForm, Compress, Grad, GridFunction, InnerProduct, Integrate, LinearForm, NumberSpace, Periodic, Sym, Trace,
                     VectorH1, ds, dx)

face = Rectangle(1, 1).Face()
for edge, name in ((face.edges.Min(X), "left"), (face.edges.Max(X), "right"), (face.edges.Min(Y), "bottom"), (face.edges.Max(Y), "top")):
    edge.name = name
mesh = ngsolve.Mesh(OCCGeometry(face, dim=2).GenerateMesh(maxh=0.2))


def fixed(fes):
    return fes.ndof - fes.FreeDofs().NumSet()


def displacements(fes):
    u, v = fes.TnT()
    strain, virtual = Sym(Grad(u)), Sym(Grad(v))
    a = BilinearForm(2 * InnerProduct(strain, virtual) * dx + Trace(strain) * Trace(virtual) * dx).Assemble()
    f = LinearForm(v[0] * ds("right")).Assemble()
    gfu = GridFunction(fes)
    gfu.vec.data = a.mat.Inverse(fes.FreeDofs(), "sparsecholesky") * f.vec
    return Integrate(gfu[0] * ds("left"), mesh), Integrate(gfu[0] * ds("right"), mesh)


def space(**roller):
    return VectorH1(mesh, order=2, dirichlet="bottom", **roller)


print("NGSolve", ngsolve.__version__)
plain = space(dirichletx="left")
cases = {"VectorH1 with roller": plain, "Compress of it": Compress(plain), "Periodic of it": Periodic(plain),
         "VectorH1 without roller": space()}
results = {}
for name, fes in cases.items():
    results[name] = (fixed(fes), *displacements(fes))
    print(f"{name:25s} fixed {results[name][0]:3d}   u_x at left {results[name][1]:.4f}, at right {results[name][2]:.4f}")

without = results["VectorH1 without roller"]
assert ngsolve.__version__.startswith("6.2.2608")
assert results["VectorH1 with roller"][0] > without[0] and abs(results["VectorH1 with roller"][1]) < 1e-12
assert fixed(plain * NumberSpace(mesh)) == fixed(plain)                   # a product keeps it
assert fixed(Compress(space())) == fixed(space()) > 0                     # so does Compress keep dirichlet=
for name in ("Compress of it", "Periodic of it"):
    assert results[name][0] == without[0]                                 # ... but not dirichletx=
    assert all(abs(a - b) < 1e-9 for a, b in zip(results[name][1:], without[1:]))
assert without[1] > 0.5 and without[2] > 2.5 * results["VectorH1 with roller"][2]
print("as described: the roller is lost")
PYTHON
"$folder/venv/bin/python" find.py
