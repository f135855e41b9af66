#!/usr/bin/env bash
# Netgen 6.2.2608: a boundary layer that is added outside leaves the name of the side below the layer; the new surface has another name.
#
# One would guess: after BoundaryLayerParameters(boundary="contact", thickness=[0.1], new_material="coating", outside=True) the side
# "contact" is the surface of the coated body, as it is for outside=False.
#
# What happens: with outside=False the layer is cut out of the body; "contact" remains at z = 1, the surface, and the new interface at z
# = 0.9 is called "mapped_contact".  With outside=True it is the other way round: "contact" is the interface at z = 1 between body and
# coating, and the surface at z = 1.1 is "mapped_contact".  Both have the same area, so that a look at areas does not tell. Nothing is
# printed or raised, and a load or a contact law on "contact" is accepted.
#
# Why it matters: coatings and pads are what contact problems put on a surface.  A pressure on "contact" then acts between body and
# coating, and the coating rides on the body without a load.  Below, the surface of a body with a soft coating yields by 1.0 under a
# pressure of 1 on "contact", the compression of the body alone, instead of 2.0.
#
# Source of the guess: help(BoundaryLayerParameters) says of "outside" that the layer is added on the outside, and nothing about names.
#
# A way round: look at the position of the sides, Integrate(z, mesh, BND, definedon=mesh.Boundaries(name)), or rename them in the mesh.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet 'ngsolve==6.2.2608' 'numpy==2.2.6'
cd "$folder"
cat > find.py <<'PYTHON'
import ngsolve
from netgen.meshing import BoundaryLayerParameters
from netgen.occ import Box, OCCGeometry, Z
from ngsolve import BND, BilinearForm, Grad, GridFunction, InnerProduct, Integrate, LinearForm, Sym, VectorH1, ds, dx, z

print("NGSolve", ngsolve.__version__)
assert ngsolve.__version__.startswith("6.2.2608")


def coated(outside):
    body = Box((0, 0, 0), (1, 1, 1))
    body.mat("body")
    body.faces.name = "sides"
    body.faces.Min(Z).name, body.faces.Max(Z).name = "clamped", "contact"
    layer = BoundaryLayerParameters(boundary="contact", thickness=[0.1], new_material="coating", outside=outside)
    return ngsolve.Mesh(OCCGeometry(body).GenerateMesh(maxh=0.5, boundary_layers=[layer]))


def side(mesh, name):
    area = Integrate(1, mesh, BND, definedon=mesh.Boundaries(name))
    return area, Integrate(z, mesh, BND, definedon=mesh.Boundaries(name)) / area


def compression(mesh, name):
    """Mean displacement of the uppermost side under a pressure of 1 on the side of that name: body E = 1, coating E = 0.1, nu = 0."""
    fes = VectorH1(mesh, order=2, dirichlet="clamped")
    u, v = fes.TnT()
    modulus = mesh.MaterialCF({"body": 1.0, "coating": 0.1})
    a = BilinearForm(modulus * InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx).Assemble()
    f = LinearForm(-v[2] * ds(name)).Assemble()
    gfu = GridFunction(fes)
    gfu.vec.data = a.mat.Inverse(fes.FreeDofs(), "sparsecholesky") * f.vec
    upper = max(("contact", "mapped_contact"), key=lambda n: side(mesh, n)[1])
    return -Integrate(gfu[2] * ds(upper), mesh)


expected = {False: (1.0, 0.9), True: (1.0, 1.1)}
for outside, (contact, mapped) in expected.items():
    mesh = coated(outside)
    found = {name: side(mesh, name) for name in ("contact", "mapped_contact")}
    print(f"outside={outside}:", {name: f"area {area:.3f} at z = {height:.3f}" for name, (area, height) in found.items()},
          {name: round(compression(mesh, name), 3) for name in found})
    assert all(abs(area - 1) < 1e-10 for area, _ in found.values())
    assert abs(found["contact"][1] - contact) < 1e-10 and abs(found["mapped_contact"][1] - mapped) < 1e-10
    if outside:
        assert abs(compression(mesh, "contact") - 1) < 1e-6 and abs(compression(mesh, "mapped_contact") - 2) < 1e-6
print("as described: with outside=True the name stays on the interface")
PYTHON
"$folder/venv/bin/python" find.py
