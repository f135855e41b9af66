#!/usr/bin/env bash
# NGSolve 6.2.2608: CoefficientFunction.Eig() returns sorted eigenvalues nearly always, and unsorted ones where shear is zero.
#
# One would guess: ascending order, as LAPACK and numpy.linalg.eigh have it.  Three hundred random symmetric matrices (2 x 2 and 3 x 3)
# confirm the guess: every one comes out ascending and right to 1e-14.
#
# What happens: a component that is not coupled to another one stays in its place.  diag(3, 1) has the eigenvalues (3, 1), diag(1, 3)
# has (1, 3), and in 3D (3, 1, 2) remains (3, 1, 2).  With a shear of 0.1 between the first two they become (0.995, 3.005, 2): in plane
# strain, sigma_zz is always last, and the last value is no longer the largest.  For a matrix that is not symmetric nothing is raised,
# and the two numbers are the eigenvalues neither of the matrix nor of its symmetric part or one of its triangles.
#
# Why it matters: the largest principal stress (crack, Rankine), Tresca's difference of the largest and the least one, and the principal
# stretches of a deformation gradient are read off the end of this vector.  Tests with general stresses pass; uniaxial tension, symmetry
# planes, frictionless contact sides and plane strain give another component.  Below, Tresca's stress in plane strain is too small by a
# factor of 4.3.
#
# Source of the guess: help(CoefficientFunction.Eig) says "Returns eigenvectors and eigenvalues of matrix-valued CF" and names no order.
#
# A way round: compare all values (IfPos(a - b, a, b)); use Sym(F.trans * F) instead of F.

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
from ngsolve import CF, Integrate

mesh = ngsolve.Mesh(unit_square.GenerateMesh(maxh=0.5))
point = mesh(0.3, 0.4)


def values(matrix):
    matrix = np.asarray(matrix, float)
    n = len(matrix)
    coefficient = CF(tuple(matrix.ravel()), dims=(n, n)).Eig()
    at_point = np.array(coefficient(point))[n * n:]
    mean = np.array(Integrate(coefficient, mesh))[n * n:]
    assert np.allclose(at_point, mean)                                    # both ways of evaluation agree
    return at_point


print("NGSolve", ngsolve.__version__)
assert ngsolve.__version__.startswith("6.2.2608")

random = np.random.default_rng(1)
for n in (2, 3):
    for _ in range(150):
        matrix = random.normal(size=(n, n))
        matrix += matrix.T
        assert np.allclose(values(matrix), np.linalg.eigvalsh(matrix))    # ascending
print("300 random symmetric matrices: ascending")

for matrix, result in (([[3, 0], [0, 1]], (3, 1)), ([[1, 0], [0, 3]], (1, 3)), (np.diag((3, 1, 2)), (3, 1, 2))):
    print("diagonal", np.diag(matrix), "->", values(matrix))
    assert np.allclose(values(matrix), result)

stress = np.array([[3, 0.1, 0], [0.1, 1, 0], [0, 0, 2]])                  # plane strain: sigma_zz is not coupled
found, right = values(stress), np.linalg.eigvalsh(stress)
print("plane strain ->", found, "instead of", right)
assert np.allclose(np.sort(found), right) and not (np.diff(found) >= 0).all()

stress = np.array([[3, 0.1, 0], [0.1, 1, 0], [0, 0, 1.4625]])
found, right = values(stress), np.linalg.eigvalsh(stress)
print(f"Tresca's stress: {found[-1] - found[0]:.4f} instead of {right[-1] - right[0]:.4f}")
assert (right[-1] - right[0]) / (found[-1] - found[0]) > 4

gradient = np.array([[2, 5], [1, 3]])
found = values(gradient)
candidates = {"the matrix": np.linalg.eigvals(gradient), "its lower triangle": np.linalg.eigvalsh(gradient, "L"),
              "its upper triangle": np.linalg.eigvalsh(gradient, "U"),
              "its symmetric part": np.linalg.eigvalsh((gradient + gradient.T) / 2)}
print("not symmetric ->", found, "; eigenvalues of", {name: v.round(3).tolist() for name, v in candidates.items()})
assert all(np.abs(np.sort(found) - np.sort(v)).max() > 0.05 for v in candidates.values())
print("as described: not sorted, and no error for matrices that are not symmetric")
PYTHON
"$folder/venv/bin/python" find.py
