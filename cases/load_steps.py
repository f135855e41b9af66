"""A roller pressed onto a plane and dragged sideways in steps: where it sticks, and where it creeps.

Question: How does the part of the contact that sticks shrink while a roller is dragged, until it slides?
Domain: the lower half of a disc of radius 50 [mm]; 1.2 mm of its arc to both sides of the lowest point may touch.
Problem: plane strain, E = 3000, nu = 0.49 [N/mm^2]; the plane through the axis goes down by 0.01 mm and `pull` [mm] sideways;
    p_n = 1e7 r, nearly rigid, friction coefficient 0.5.
What to look at: the contact hardly changes, but slip enters from both of its ends.  `Steps` gives the solutions of a growing
    pull, to be shown one after the other.
Source: C. Cattaneo 1938, R. D. Mindlin 1949; K. L. Johnson, Contact Mechanics, section 7.2: c/b = sqrt(1 - Q/(mu P)), c and b
    the half widths of stick and contact, for bodies without coupling of pressure and slip; nu near 1/2 has little of it.
Ask: For which pull is the last point about to slide?  What does a state of `Steps` at half of the pull say that one step to
    it does not?  With `SolveHistory`, what friction is left when the pull has been taken back to 0?
"""

from math import sqrt

import numpy as np
from netgen.occ import WorkPlane
from ngsolve import CF, y

from ngdgc import (ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NestedNewtonSolver, NormalCompliance)
from ngdgc.meshes import ShapeMesh

RADIUS, CONTACT, DOWN, COEFFICIENT = 50.0, 1.2, 0.01, 0.5


def Problem(pull=0.003, coefficient=COEFFICIENT):
    foundation = Foundation("contact", NormalCompliance(1e7), friction=CoulombFriction(coefficient),
                            gap=y * RADIUS / (RADIUS - y))
    return ContactProblem(HookeMaterial(E=3000, nu=0.49), foundation, dirichlet={"top": CF((pull, -DOWN))})


def Mesh(n=32, order=2):
    """About n elements along the part that may touch, its boundary of degree `order`."""
    angle = np.degrees(CONTACT / RADIUS)
    path = WorkPlane().MoveTo(-RADIUS, RADIUS).Rotate(-90).Arc(RADIUS, 90 - angle).Arc(RADIUS, 2 * angle)
    body = path.Arc(RADIUS, 90 - angle).Close().Face()
    for edge, name in zip(body.edges, ("side", "contact", "side", "top"), strict=True):
        edge.name = name
    body.edges["contact"].maxh = 2 * CONTACT / n
    return ShapeMesh(body, RADIUS / 4, order=order)


def Main(*, method=InteriorPenalty(), order=2, n=32, pull=0.003, coefficient=COEFFICIENT, solver=NestedNewtonSolver(),
         callback=None):
    disc = Discretization(Problem(pull, coefficient), method, Mesh(n, order), order=order)
    return solver.Solve(disc, callback=callback)


def Steps(count=6, *, largest=0.006, method=InteriorPenalty(), order=2, n=32):
    """Solutions for `count` pulls from 0 to the largest [mm]; a list."""
    mesh = Mesh(n, order)
    return [NestedNewtonSolver().Solve(Discretization(Problem(pull), method, mesh, order=order))
            for pull in np.linspace(0, largest, count)]


def Compare(solution):
    """The sticking part of the contact, from the zones and from the forces that act."""
    zones = solution.ZoneLengths()
    ratio = float(np.abs(solution.weights @ solution.friction[:, 0])) / (COEFFICIENT * solution.normalforce)
    return [("sticking part of the contact", zones["stick"] / (zones["stick"] + zones["slip"]), sqrt(max(0, 1 - ratio)))]
