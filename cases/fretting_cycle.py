"""A roller rubbed to and fro on a plane without sliding as a whole: the middle sticks, the edges slip and wear.

Question: Where does a contact wear that never slides, and what becomes of its pressure?
Domain: the lower half of a disc of radius 50 [mm]; 1.2 mm of its arc to both sides of the lowest point may touch.
Problem: plane strain, E = 3000, nu = 0.49 [N/mm^2]; the plane through the axis goes down by 0.01 mm and to and fro by `pull`
    [mm]; p_n = 1e5 r, friction coefficient 0.5, Archard's wear 0.02 [mm^2/N], that of ten thousand cycles in one.
What to look at: `History` presses, and goes forth, back and forth again in cycles (`--history`).  The loop of force over pull
    is that of Mindlin and Deresiewicz, of partial slip.  Only the edges wear; so they carry less and the middle, which sticks
    and stays as it was, carries more.
Source: R. D. Mindlin and H. Deresiewicz 1953; K. L. Johnson, Contact Mechanics, section 7.4, c/b = sqrt(1 - Q/(mu P)) after
    the first pull; J. F. Archard, J. Appl. Phys. 24 (1953).
Ask: Does the stick zone grow or shrink from cycle to cycle?  What is left of the edges after many cycles?  With `wear=0`, by
    how much does the second cycle differ from the first one?
"""

from math import sqrt

import numpy as np
from netgen.occ import WorkPlane
from ngsolve import CF, IfPos, Parameter, y

from ngdgc import (ArchardWear, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NestedNewtonSolver, NormalCompliance, SolveHistory)
from ngdgc.meshes import ShapeMesh

RADIUS, CONTACT, DOWN, PULL, COEFFICIENT, WEAR = 50.0, 1.2, 0.01, 0.007, 0.5, 0.02


def Problem(pull=PULL, down=DOWN, wear=WEAR):
    foundation = Foundation("contact", NormalCompliance(1e5), friction=CoulombFriction(COEFFICIENT), wear=ArchardWear(wear),
                            gap=y * RADIUS / (RADIUS - y))
    return ContactProblem(HookeMaterial(E=3000, nu=0.49), foundation, dirichlet={"top": CF((pull, -down))},
                          units=("mm", "N/mm^2"))


def Mesh(n=32, order=2):
    """About n elements along the part that may touch, its boundary of degree `order`."""
    angle = np.degrees(CONTACT / RADIUS)
    path = WorkPlane().MoveTo(-RADIUS, RADIUS).Rotate(-90).Arc(RADIUS, 90 - angle).Arc(RADIUS, 2 * angle)
    body = path.Arc(RADIUS, 90 - angle).Close().Face()
    for edge, name in zip(body.edges, ("side", "contact", "side", "top"), strict=True):
        edge.name = name
    body.edges["contact"].maxh = 2 * CONTACT / n
    return ShapeMesh(body, RADIUS / 4, order=order)


def Main(*, method=InteriorPenalty(), order=2, n=32, pull=PULL, solver=NestedNewtonSolver(), callback=None):
    return solver.Solve(Discretization(Problem(pull), method, Mesh(n, order), order=order), callback=callback)


def History(*, count=6, cycles=2, wear=WEAR, method=InteriorPenalty(), order=2, n=32, callback=None):
    """The LoadHistory of pressing, pulling to PULL in `count` increments, and cycles back and forth."""
    t = Parameter(0)
    # t from 0 to 1 presses, until 2 pulls; from then on each unit is a way from one side to the other.
    way = CF(1)
    for number in reversed(range(2 * cycles)):
        forth = 2 * (t - 2 - number) - 1
        way = IfPos(number + 3 - t, forth if number % 2 else -forth, way)
    turn = IfPos(2 - t, IfPos(t - 1, t - 1, 0), way)
    problem = Problem(PULL * turn, DOWN * IfPos(1 - t, t, 1), wear)
    times = [0.5, *np.linspace(1, 2, count + 1), *np.linspace(2, 2 + 2 * cycles, 4 * count * cycles + 1)[1:]]
    return SolveHistory(Discretization(problem, method, Mesh(n, order), order=order), parameter=t, times=times,
                        callback=callback)


def Compare(solution):
    """The sticking part of the contact after the first pull, from the zones and from the forces that act."""
    zones = solution.ZoneLengths()
    force = abs(float(solution.weights @ solution.friction[:, 0]))
    share = zones["stick"] / (zones["stick"] + zones["slip"])
    return [("stick/contact", share, sqrt(max(1 - force / (COEFFICIENT * solution.normalforce), 0)))]
