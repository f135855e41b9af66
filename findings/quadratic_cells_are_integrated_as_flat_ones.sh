#!/usr/bin/env bash
# VTK 9.7.2 and pyvista 0.49.1: sizes and integrals of cells of second order are those of flat pieces between their nodes.
#
# One would guess: a field on quadratic (or Lagrange) cells is integrated as the quadratic function that it is, since the cells carry
# their shape functions; for that one writes such cells.
#
# What happens: integrate_data (vtkIntegrateAttributes) and compute_cell_sizes cut the cells at their nodes into linear triangles or
# tetrahedra.  A side that is bent to a quarter of an arc lacks area, and x^2 on a straight triangle of six nodes, where its values
# determine it, comes out 25 % too large, on a tetrahedron of ten nodes 41 %.  Linear fields on straight cells are right.  Nothing is
# printed.
#
# Why it matters: forces and volumes that are integrated from a file of second order in ParaView or pyvista are of first order, and
# differ from the solver's by more than its own error; the reader looks for the fault in the solver.
#
# Source of the guess: the documentation of vtkQuadraticTriangle and vtkLagrangeTriangle, which interpolate with shape functions (so do
# probes: the value at a point inside is that of the parabola).
#
# A way round: write what is to be integrated as means of cells, or refine, or integrate in the solver.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet 'pyvista==0.49.1' 'vtk==9.7.2' 'numpy==2.2.6'
cd "$folder"
cat > find.py <<'PYTHON'
from itertools import combinations

import numpy as np
import pyvista as pv
import vtk

TRIANGLE = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
TET = [*TRIANGLE, (0, 0, 1)]


def cell(corners, kind, bent=0.0):
    """One cell with the nodes of its edges; the hypotenuse of a triangle bent outwards."""
    corners = np.array(corners, dtype=float)
    pairs = [(0, 1), (1, 2), (0, 2)] + [(i, 3) for i in range(3)] * (len(corners) == 4)
    assert set(pairs) == set(combinations(range(len(corners)), 2))
    points = np.vstack([corners, [(corners[i] + corners[j]) / 2 for i, j in pairs]])
    points[len(corners) + 1, :2] += bent
    grid = pv.UnstructuredGrid(np.r_[len(points), np.arange(len(points))], [kind], points)
    for power in (1, 2):
        grid.point_data[f"x^{power}"] = points[:, 0] ** power
    return grid


def integrals(grid):
    found = grid.integrate_data()
    return [float(found.point_data[name][0]) for name in ("x^1", "x^2")]


print("VTK", vtk.vtkVersion.GetVTKVersion(), "pyvista", pv.__version__)
assert (vtk.vtkVersion.GetVTKVersion(), pv.__version__) == ("9.7.2", "0.49.1")
kinds = pv.CellType
for name, corners, pair, exact in (("triangle", TRIANGLE, (kinds.QUADRATIC_TRIANGLE, kinds.LAGRANGE_TRIANGLE), (1 / 6, 1 / 12)),
                                   ("tetrahedron", TET, (kinds.QUADRATIC_TETRA, kinds.LAGRANGE_TETRAHEDRON), (1 / 24, 1 / 60))):
    for kind in pair:
        found = integrals(cell(corners, kind))
        print(f"straight {name}, {kind.name}: int x {found[0]:.5f} ({exact[0]:.5f}), int x^2 {found[1]:.5f} ({exact[1]:.5f})")
        assert abs(found[0] - exact[0]) < 1e-12
        assert found[1] / exact[1] > 1.2
# The value at a point is that of the parabola, not of the pieces.
inside = pv.PolyData([(0.25, 0.25, 0.0)]).sample(cell(TRIANGLE, kinds.QUADRATIC_TRIANGLE))
assert abs(inside.point_data["x^2"][0] - 0.0625) < 1e-12
bent = 0.2
area = float(cell(TRIANGLE, kinds.QUADRATIC_TRIANGLE, bent).compute_cell_sizes().cell_data["Area"][0])
# A parabola of height bent sqrt(2) over a chord of sqrt(2), two thirds of their product; of the pieces half.
print(f"bent triangle: area {area:.5f}, exact {0.5 + 2 * bent * 2 / 3:.5f}, of flat pieces {0.5 + bent:.5f}")
assert abs(area - (0.5 + bent)) < 1e-9
print("as described: integrals are those of flat pieces")
PYTHON
"$folder/venv/bin/python" find.py
