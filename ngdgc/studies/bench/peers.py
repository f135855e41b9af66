"""Other codes on the same problems, as far as they are installed; run by the interpreter that has them.

This file needs nothing of ngdgc: `python peers.py getfem 32` prints a line of JSON.  The problem is the block of the atlas,
`atlas.Point(problem="block")`: the unit square, E = 1000, nu = 0.3, plane strain, pressed by 0.02 and sheared by 0.002 onto a
foundation with p_n = 100 r and Coulomb friction 0.3 behind the gap (x - 1/2)^2/10.
"""

from __future__ import annotations

import json
import sys
import time
from typing import Any

E, NU, STIFFNESS, COEFFICIENT = 1000.0, 0.3, 100.0, 0.3
LAM, MU = E * NU / (1 + NU) / (1 - 2 * NU), E / 2 / (1 + NU)
TOL, LIMIT = 1e-8, 100


def GetFEM(n: int) -> dict[str, float]:
    """Displacements of order 2, conforming, on n x n x 2 triangles, with multipliers of order 1 for friction.

    Normal compliance and the projection of the multiplier onto the friction bound in GetFEM's assembly language, its own
    Newton method and linear solver.
    """
    import getfem as gf
    import numpy as np

    gf.util_warning_level(0)
    grid = np.linspace(0, 1, n + 1)
    mesh = gf.Mesh("regular_simplices", grid, grid)
    start = time.perf_counter()
    displacements, multipliers = gf.MeshFem(mesh, 2), gf.MeshFem(mesh, 1)
    displacements.set_classical_fem(2)
    multipliers.set_classical_fem(1)
    rule = gf.MeshIm(mesh, gf.Integ("IM_TRIANGLE(4)"))
    sides = mesh.outer_faces()
    vertical = mesh.normal_of_faces(sides)[1]
    bottom, top = 1, 2
    mesh.set_region(bottom, sides[:, vertical < -0.5])
    mesh.set_region(top, sides[:, vertical > 0.5])
    model = gf.Model("real")
    model.add_fem_variable("u", displacements)
    model.add_filtered_fem_variable("t", multipliers, bottom)
    for name, value in {"lam": LAM, "mu": MU, "k": STIFFNESS, "f": COEFFICIENT, "r": E}.items():
        model.add_initialized_data(name, [value])
    model.add_isotropic_linearized_elasticity_brick(rule, "u", "lam", "mu")
    model.add_initialized_data("shift", [0.002, -0.02])
    model.add_Dirichlet_condition_with_simplification("u", top, "shift")
    pressure = "k*pos_part(-u(2)-sqr(X(1)-0.5)/10)"
    model.add_nonlinear_term(rule, f"t*Test_u(1)-{pressure}*Test_u(2)", bottom)
    model.add_nonlinear_term(rule, f"(t-Ball_projection(t+r*u(1),f*{pressure}))*Test_t/r", bottom)
    iterations = model.solve("max_res", TOL, "max_iter", LIMIT)[0]
    seconds = time.perf_counter() - start
    return {"dofs": displacements.nbdof(), "iterations": int(iterations), "seconds": seconds,
            "normalforce": float(gf.asm_generic(rule, 0, pressure, bottom, model))}


def DOLFINx(n: int) -> dict[str, float]:
    """The assembly of interior penalty of order 1 on n x n x 2 triangles, once compiled, and once more."""
    import ufl
    from dolfinx import fem, mesh
    from mpi4py import MPI

    square = mesh.create_unit_square(MPI.COMM_WORLD, n, n)
    space = fem.VectorFunctionSpace(square, ("DG", 1))
    u, v, normal = ufl.TrialFunction(space), ufl.TestFunction(space), ufl.FacetNormal(square)
    size = ufl.CellDiameter(square)

    def Stress(w: Any) -> Any:
        strain = ufl.sym(ufl.grad(w))
        return 2 * MU * strain + LAM * ufl.tr(strain) * ufl.Identity(2)

    def Jump(w: Any) -> Any:
        return ufl.outer(w("+"), normal("+")) + ufl.outer(w("-"), normal("-"))

    form = (ufl.inner(Stress(u), ufl.sym(ufl.grad(v))) * ufl.dx
            - ufl.inner(ufl.avg(Stress(u)), Jump(v)) * ufl.dS - ufl.inner(Jump(u), ufl.avg(Stress(v))) * ufl.dS
            + 10 * (LAM + 2 * MU) / ufl.avg(size) * ufl.inner(Jump(u), Jump(v)) * ufl.dS)
    compiled = fem.form(form)
    seconds = []
    for _ in range(2):
        start = time.perf_counter()
        matrix = fem.petsc.assemble_matrix(compiled)
        matrix.assemble()
        seconds.append(time.perf_counter() - start)
    entries = int(matrix.getInfo()["nz_used"])
    return {"dofs": 2 * space.dofmap.index_map.size_global, "entries": entries, "seconds": min(seconds)}


PEERS = {"getfem": GetFEM, "dolfinx": DOLFINx}

if __name__ == "__main__":
    print(json.dumps(PEERS[sys.argv[1]](int(sys.argv[2]))))
