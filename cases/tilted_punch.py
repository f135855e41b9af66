"""A flat rigid punch that is pressed beside its middle: it tilts, and if the force is too far out one edge lifts off.

Question: How much does a rigid stamp tilt under a force that misses its middle, and when does its far edge come off?
Domain: half a disc of radius 20 [mm], a part of the half-plane y < 0; the punch covers |x| < 1 of its flat side, above.
Problem: plane strain, E = 1000, nu = 0.3 [N/mm^2]; the punch is pressed by F = 20 N/mm through x = e = 0.3 mm and may turn, and
    sink, but not slide; p_n = 1e6 r, nearly rigid, no friction; the body is held far away.
What to look at: the pressure F (1 + 2 e x/a^2)/(pi sqrt(a^2 - x^2)) has no bound at both edges, and at the far one the smaller
    part.  `punches` has the motion that was found, which no displacement was given for.  `History` moves the force outwards
    (`--history`): up to e = a/2 the tilt is a straight line, from there on the far edge is free.
Source: K. L. Johnson, Contact Mechanics, section 2.8: a moment M tilts a punch of half width a by 4 M/(pi a^2 E*).
Ask: Where does the punch turn about?  What does a coefficient of friction of 0.3 change?  Two forces F/2 at -e and e: is that
    the same as one in the middle?
"""

from math import pi

import numpy as np
from netgen.occ import WorkPlane
from ngsolve import Parameter

from ngdgc import (ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NestedNewtonSolver,
                   NormalCompliance, RigidPunch, SolveHistory)
from ngdgc.meshes import ShapeMesh

PUNCH, SIZE, FORCE, BESIDE = 1.0, 20.0, 20.0, 0.3
SOLID = HookeMaterial(E=1000, nu=0.3)
TILT = 4 * FORCE * (1 - SOLID.nu ** 2) / (pi * PUNCH ** 2 * SOLID.E)    # for a force 1 mm beside the middle


def Problem(beside=BESIDE, stiffness=1e6):
    punch = RigidPunch(force=(None, -FORCE), moment=-FORCE * beside)
    return ContactProblem(SOLID, Foundation("punch", NormalCompliance(stiffness), punch=punch), dirichlet={"far": (0, 0)},
                          units=("mm", "N/mm^2"))


def Mesh(n=16, order=2):
    """About n elements under the punch, sixteen times smaller ones at its edges."""
    body = WorkPlane().MoveTo(-SIZE, 0).Rotate(-90).Arc(SIZE, 180)
    body = body.LineTo(PUNCH, 0).LineTo(-PUNCH, 0).Close().Face()
    for edge, name in zip(body.edges, ("far", "free", "punch", "free"), strict=True):
        edge.name = name
    body.edges["punch"].maxh = 2 * PUNCH / n
    for vertex in body.vertices:
        if abs(abs(vertex.p[0]) - PUNCH) < 1e-9:
            vertex.maxh = 2 * PUNCH / n / 16
    return ShapeMesh(body, SIZE / 4, order=order)


def Main(*, method=InteriorPenalty(), order=2, n=16, beside=BESIDE, solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(beside), method, Mesh(n, order), order=order)
    return solver.Solve(disc, callback=callback)


def History(*, count=8, largest=0.8, method=InteriorPenalty(), order=2, n=16, callback=None):
    """The LoadHistory of a force that moves from the middle to `largest` [mm] beside it."""
    t = Parameter(0)
    disc = Discretization(Problem(largest * t), method, Mesh(n, order), order=order)
    return SolveHistory(disc, parameter=t, times=np.linspace(0, 1, count + 1), callback=callback)


def Compare(solution):
    """Tilt, and int p x^2, which is F a^2/2 wherever the force acts."""
    x, pressure = solution.points[:, 0], solution.pressure
    beside = (solution.weights @ (pressure * x)) / solution.normalforce
    return [("tilt", -float(solution.punches["punch"][2]), TILT * float(beside)),
            ("int p x^2 [N mm]", float(solution.weights @ (pressure * x ** 2)), FORCE * PUNCH ** 2 / 2)]
