"""The lining of a pressure tunnel in its rock: a curved body with a curved foundation.

Question: What does it cost to draw a circle with straight edges, and what does mesh.Curve(order) change?
Domain: the ring 2 < r < 2.5 [m], a quarter of it between two planes of symmetry; a gap of 0.1 mm all around.
Problem: concrete in plane strain, E = 30000, nu = 0.2 [MN/m^2]; water pressure 1 inside; p_n = 2000 r [MN/m^3] outside.
What to look at: with `curve` = `order` the pressure on the rock has as many digits as the method can give; with `curve` = 1 the
    error is that of the polygon, whatever the order.  A `curve` above the order is no gain: then rotations are no functions of
    the space any more, and moments no longer balance to round-off.
Source: G. Lame's thick ring, u_r = A r + B/r, with -sigma_r = k (u_r - g) outside: two linear equations for A and B.
Ask: At which order does the polygon with n = 16 spoil the pressure: `--n 16` with order 1, 2, 3 and `curve=1` in a script?
    What share of the water's pressure would reach the rock without the gap?  Why do moments not balance for `curve` above
    the order?
"""

import numpy as np
from netgen.occ import WorkPlane
from ngsolve import specialcf

from ngdgc import (ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NestedNewtonSolver,
                   NormalCompliance)
from ngdgc.meshes import ShapeMesh

INNER, OUTER, PRESSURE, STIFFNESS, GAP = 2.0, 2.5, 1.0, 2000.0, 1e-4
CONCRETE = HookeMaterial(E=30000, nu=0.2)


def Lame(gap=GAP):
    """(radial displacement inside [m], pressure on the rock [MN/m^2])"""
    mu, bulk = CONCRETE.mu, CONCRETE.lam + CONCRETE.mu
    # sigma_r = 2 bulk A - 2 mu B/r^2
    matrix = [[2 * bulk, -2 * mu / INNER ** 2],
              [2 * bulk + STIFFNESS * OUTER, -2 * mu / OUTER ** 2 + STIFFNESS / OUTER]]
    A, B = np.linalg.solve(matrix, [-PRESSURE, STIFFNESS * gap])
    return float(A * INNER + B / INNER), float(STIFFNESS * (A * OUTER + B / OUTER - gap))


def Problem(gap=GAP):
    foundation = Foundation("rock", NormalCompliance(STIFFNESS), gap=gap)
    return ContactProblem(CONCRETE, foundation, roller={"symmetry": 0},
                          traction={"water": -PRESSURE * specialcf.normal(2)}, units=("m", "MN/m^2"))


def Mesh(n=16, curve=2):
    """About n elements along the outer arc, as polynomials of degree `curve`."""
    path = WorkPlane().MoveTo(INNER, 0).LineTo(OUTER, 0).Rotate(90).Arc(OUTER, 90).LineTo(0, INNER).Rotate(180)
    ring = path.Arc(INNER, -90).Face()
    for edge, name in zip(ring.edges, ("symmetry", "rock", "symmetry", "water"), strict=True):
        edge.name = name
    return ShapeMesh(ring, np.pi / 2 * OUTER / n, order=curve)


def Main(*, method=InteriorPenalty(), order=2, n=16, curve=None, solver=NestedNewtonSolver(), callback=None):
    """curve : degree of the boundary; None: the order of the displacement"""
    disc = Discretization(Problem(), method, Mesh(n, curve or order), order=order)
    return solver.Solve(disc, callback=callback)


def Compare(solution):
    inside, pressure = Lame()
    length = np.pi / 2 * OUTER
    return [("mean pressure on the rock [MN/m^2]", solution.normalforce / length, pressure),
            ("smallest pressure on the rock [MN/m^2]", float(solution.pressure.min()), pressure),
            ("displacement inside [mm]", 1e3 * float(solution.At(INNER, 0)[0]), 1e3 * inside)]
