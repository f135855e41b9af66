#!/usr/bin/env bash
# pyamg 5.4.1: max_coarse counts blocks, not unknowns, so that with rigid motions the coarsest grid has up to six times as many.
#
# One would guess: smoothed_aggregation_solver(A, B=motions, max_coarse=300) coarsens until at most 300 unknowns are left for the dense
# pseudo-inverse, the default coarse solver.
#
# What happens: the number of rows is divided by the block size of the level before it is compared with max_coarse.  The block size of
# coarse levels is the number of candidates in B, 3 rigid motions in the plane and 6 in space.  So 432 unknowns are left on a plane body,
# and more than a thousand on a body in space, where the singular value decomposition behind the pseudo-inverse takes their cube.  For a
# scalar equation the limit holds.  Nothing is printed.
#
# Why it matters: elasticity is what B is for.  On a preconditioner for 350 000 unknowns this last grid took more time to set up than all
# others together, and saved two steps of thirty.
#
# Source of the guess: the docstring, "Maximum number of variables permitted on the coarse grid".
#
# A way round: give max_coarse as the wanted number of unknowns over the number of columns of B.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet 'pyamg==5.4.1' 'scipy==1.16.3' 'numpy==2.2.6'
cd "$folder"
cat > find.py <<'PYTHON'
import numpy as np
import pyamg
import scipy.sparse as sp
from pyamg.gallery import linear_elasticity, poisson

LIMIT = 300
print("pyamg", pyamg.__version__)
assert pyamg.__version__ == "5.4.1"


def coarsest(matrix, candidates, limit=LIMIT):
    solver = pyamg.smoothed_aggregation_solver(matrix, B=candidates, max_coarse=limit)
    return [level.A.shape[0] for level in solver.levels]


def space(n):
    """A vector-valued Laplacian on n^3 points with the rigid motions of their lattice."""
    matrix = sp.kron(poisson((n, n, n)), sp.identity(3)).tobsr((3, 3))
    x = np.stack(np.meshgrid(*3 * [np.arange(n) / n], indexing="ij"), axis=-1).reshape(-1, 3)
    motions = np.zeros((len(x), 3, 6))
    motions[:, range(3), range(3)] = 1
    for column, (i, j) in enumerate([(0, 1), (1, 2), (2, 0)]):
        motions[:, i, 3 + column], motions[:, j, 3 + column] = -x[:, j], x[:, i]
    return matrix, motions.reshape(-1, 6)


scalar = coarsest(poisson((100, 100), format="csr"), None)
plane = coarsest(*linear_elasticity((100, 100)))
solid = coarsest(*space(12))
for name, levels in {"scalar": scalar, "plane elasticity": plane, "three components, six motions": solid}.items():
    print(f"{name}: unknowns of the levels {levels}, max_coarse={LIMIT}")
assert scalar[-1] <= LIMIT
assert LIMIT < plane[-1] <= 3 * LIMIT
assert 3 * LIMIT < solid[-1] <= 6 * LIMIT
matrix, motions = space(12)
divided = coarsest(matrix, motions, LIMIT // 6)
print(f"the same with max_coarse={LIMIT // 6}: {divided}")
assert divided[-1] <= LIMIT
print("as described: the limit is one of blocks")
PYTHON
"$folder/venv/bin/python" find.py
