"""A flat punch on a half-space: infinite pressure at the edge, and a force that is known.

Question: Which force presses a flat-ended rod into a solid by a tenth of its radius, and where is the pressure least?
Domain: a quarter of a disc of radius 10 [mm], half of the section of a half-ball of the half-space; the punch covers r < 1 of
    its flat side, which is below.
Problem: E = 1000, nu = 0.3 [N/mm^2]; the punch stands 0.1 mm deep in the solid, p_n = 1e7 r, nearly rigid, no friction; far
    away the displacement is that of Boussinesq's point force, of the force that is expected.
What to look at: the pressure F/(2 pi a sqrt(a^2 - r^2)) is half of its mean in the middle and has no bound at the edge, where
    the mesh is fine.
Source: J. Boussinesq 1885; K. L. Johnson, Contact Mechanics, sections 3.2 and 3.8: F = 2 a E* d.
Ask: Which part of the error is that of the stiffness of the foundation?  Which part is that of the far field, if it is held
    (0 in place of Boussinesq's displacement)?  What does friction do to the edge?
"""

from math import pi

import numpy as np
from netgen.occ import WorkPlane
from ngsolve import CF, sqrt, x, y

from ngdgc import (ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NestedNewtonSolver,
                   NormalCompliance)
from ngdgc.meshes import ShapeMesh

PUNCH, SIZE, DEPTH = 1.0, 10.0, 0.1
SOLID = HookeMaterial(E=1000, nu=0.3)
FORCE = 2 * PUNCH * SOLID.E / (1 - SOLID.nu ** 2) * DEPTH


def PointForce(force=FORCE):
    """Boussinesq's displacement of the half-space y > 0, which a force along the axis presses inwards at the origin."""
    distance = sqrt(x ** 2 + y ** 2)
    scale = force / (4 * pi * SOLID.mu)
    return CF((scale * (x * y / distance ** 3 - (1 - 2 * SOLID.nu) * x / (distance * (distance + y))),
               scale * (y ** 2 / distance ** 3 + 2 * (1 - SOLID.nu) / distance)))


def Problem(stiffness=1e7):
    foundation = Foundation("punch", NormalCompliance(stiffness), gap=-DEPTH)
    return ContactProblem(SOLID, foundation, dirichlet={"far": PointForce()}, axisymmetric=True, units=("mm", "N/mm^2"))


def Mesh(n=16, order=2):
    """About n elements under the punch, eight times smaller ones at its edge."""
    body = WorkPlane().LineTo(PUNCH, 0).LineTo(SIZE, 0).Rotate(90).Arc(SIZE, 90).Close().Face()
    for edge, name in zip(body.edges, ("punch", "free", "far", "axis"), strict=True):
        edge.name = name
    body.edges["punch"].maxh = PUNCH / n
    for vertex in body.vertices:
        if abs(vertex.p[0] - PUNCH) < 1e-9:
            vertex.maxh = PUNCH / n / 64
    return ShapeMesh(body, SIZE / 4, order=order)


def Main(*, method=InteriorPenalty(), order=2, n=16, solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(), method, Mesh(n, order), order=order)
    return solver.Solve(disc, callback=callback)


def Compare(solution):
    """The least pressure is a mean over r < a/4, where it is 1 + r^2/(2 a^2) of that on the axis."""
    r = solution.points[:, 0]
    middle = r < PUNCH / 4
    least = solution.weights[middle] @ solution.pressure[middle] / solution.weights[middle].sum()
    share = 2 * (1 - np.sqrt(1 - r[middle].max() ** 2)) / r[middle].max() ** 2
    return [("force [N]", solution.normalforce, FORCE),
            ("pressure in the middle [N/mm^2]", float(least), FORCE / (2 * pi * PUNCH ** 2) * float(share))]
