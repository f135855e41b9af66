"""A ring pressed into a bore: Lame's stresses, and the force that pushes it out.

Question: How hard does a bush sit in its bore, and what force pushes it out?
Domain: a ring of bronze, 20 mm < r < 30 mm and 0 < z < 40 mm, half of its section; the bore is around it.
Problem: E = 110000, nu = 0.34 [N/mm^2]; the ring is 0.05 mm larger than the bore, which gives way by p_n = 2e4 r (steel is
    stiffer than that); the ring stands on a roller, its other end is free.
What to look at: u_r = A r + B/r and u_z = C z, so that the radial stress goes from 0 inside to the pressure outside, and the
    hoop stress is the largest at the inner side.  Each ring of the mesh is alike: nothing depends on z.
Source: G. Lame 1852; S. Timoshenko, Strength of Materials, part II.  `Exact` solves the two conditions for A and B.
Ask: At which interference does the bronze yield, at 140 N/mm^2?  What does a friction with the coefficient 0.15 change in the
    fit, and which force pushes the ring out then?  How much softer is the fit in a bore of steel, k_n = E/((1 + nu) r)?
"""

from math import pi

import numpy as np
from ngsolve import CF, x, y
from ngsolve.meshes import MakeStructured2DMesh

from ngdgc import (ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NestedNewtonSolver,
                   NormalCompliance)

INNER, OUTER, LENGTH = 20.0, 30.0, 40.0
INTERFERENCE, STIFFNESS = 0.05, 2e4
BRONZE = HookeMaterial(E=110000, nu=0.34)


def Exact():
    """(displacement, pressure [N/mm^2], hoop stress at the inner side [N/mm^2]).

    sigma_r = 2 (lam + mu) A + lam C - 2 mu B/r^2 vanishes inside, sigma_z = 2 lam A + (lam + 2 mu) C everywhere, and outside
    -sigma_r = k (A r + B/r + interference).
    """
    lam, mu = BRONZE.lam, BRONZE.mu
    equations = [[2 * (lam + mu), -2 * mu / INNER ** 2, lam], [2 * lam, 0, lam + 2 * mu],
                 [2 * (lam + mu) + STIFFNESS * OUTER, -2 * mu / OUTER ** 2 + STIFFNESS / OUTER, lam]]
    A, B, C = np.linalg.solve(equations, [0, 0, -STIFFNESS * INTERFERENCE])
    pressure = STIFFNESS * (A * OUTER + B / OUTER + INTERFERENCE)
    hoop = 2 * (lam + mu) * A + lam * C + 2 * mu * B / INNER ** 2
    return CF((A * x + B / x, C * y)), float(pressure), float(hoop)


def Problem(friction=None):
    foundation = Foundation("outer", NormalCompliance(STIFFNESS), friction=friction, gap=-INTERFERENCE)
    return ContactProblem(BRONZE, foundation, roller={"bottom": 0}, axisymmetric=True, units=("mm", "N/mm^2"))


def Mesh(n=6):
    """n elements through the wall, twice as many along it."""
    mesh = MakeStructured2DMesh(quads=True, nx=n, ny=2 * n,
                                mapping=lambda s, t: (INNER + s * (OUTER - INNER), t * LENGTH))
    for name, new in (("left", "inner"), ("right", "outer")):
        mesh.ngmesh.SetBCName(mesh.GetBoundaries().index(name), new)
    return mesh


def Main(*, method=InteriorPenalty(), order=2, n=6, solver=NestedNewtonSolver(), callback=None):
    return solver.Solve(Discretization(Problem(), method, Mesh(n), order=order), callback=callback)


def Compare(solution):
    _, pressure, hoop = Exact()
    inner = solution.disc.mesh(INNER + 1e-9, LENGTH / 2)
    return [("force on the bore [N]", solution.normalforce, 2 * pi * OUTER * LENGTH * pressure),
            ("largest pressure [N/mm^2]", float(solution.pressure.max()), pressure),
            ("hoop stress inside [N/mm^2]", float(solution.stress(inner)[8]), hoop)]
