"""A ball pressed onto a plane, as a body of revolution: Hertz's contact on half a section.

Question: How many unknowns does a ball need whose section is all that is meshed?
Domain: a quarter of a disc of radius 50 [mm], half of the section of the lower half of the ball; the lowest 2 mm of the arc may
    touch.
Problem: E = 3000, nu = 0.4 [N/mm^2] (a plastic); the force 100 N as a pressure on the plane through the centre; the
    foundation is flat, with the normal along the axis and the gap z, p_n = 1e6 r, nearly rigid, no friction.
What to look at: the pressure over r is half an ellipse, with its peak on the axis.  The same ball in space is
    `hertz_sphere`, with a hundred times the unknowns.
Source: H. Hertz 1882; K. L. Johnson, Contact Mechanics, section 3.4.  With a the radius of the spot, a^3 = 3 F R/(4 E*) and
    p_0 = 3 F/(2 pi a^2), for a << R: here a/R = 2e-2.
Ask: Which mesh does one per mille of the peak need?  With a hole of radius 0.2 mm along the axis, where is the pressure
    largest?  What does a friction with the coefficient 0.3 change, and why is it radial?
"""

from math import pi

import numpy as np
from netgen.occ import WorkPlane
from ngsolve import CF, y

from ngdgc import (ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NestedNewtonSolver,
                   NormalCompliance)
from ngdgc.meshes import ShapeMesh

RADIUS, FORCE, MODULUS = 50.0, 100.0, 3000 / (1 - 0.4 ** 2)     # E* = E/(1 - nu^2)
CONTACT = 2.0       # length of the arc from the lowest point that may touch, two radii of the spot [mm]


def Hertz(radius=RADIUS):
    """(radius of the spot [mm], largest pressure [N/mm^2], approach [mm])"""
    spot = (3 * FORCE * radius / (4 * MODULUS)) ** (1 / 3)
    return spot, 3 * FORCE / (2 * pi * spot ** 2), spot ** 2 / radius


def Problem(stiffness=1e6):
    foundation = Foundation("contact", NormalCompliance(stiffness), gap=y, normal=CF((0, -1)))
    return ContactProblem(HookeMaterial(E=3000, nu=0.4), foundation, force={"top": (0, -FORCE)}, axisymmetric=True,
                          units=("mm", "N/mm^2"))


def Mesh(n=32, order=2):
    """About n elements along the part that may touch, its boundary of degree `order`."""
    angle = CONTACT / RADIUS
    path = WorkPlane().Arc(RADIUS, np.degrees(angle)).Arc(RADIUS, 90 - np.degrees(angle))
    body = path.LineTo(0, RADIUS).Close().Face()
    for edge, name in zip(body.edges, ("contact", "side", "top", "axis"), strict=True):
        edge.name = name
    body.edges["contact"].maxh = CONTACT / n
    return ShapeMesh(body, RADIUS / 5, order=order)


def Main(*, method=InteriorPenalty(), order=2, n=32, solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(), method, Mesh(n, order), order=order)
    return solver.Solve(disc, callback=callback)


def Compare(solution):
    """The radius comes from the second moment of the pressure, which is 2/5 a^2 of the force for half an ellipsoid."""
    spot, pressure, _ = Hertz()
    moment = (solution.weights * solution.pressure) @ solution.points[:, 0] ** 2
    return [("force [N]", solution.normalforce, FORCE),
            ("radius of the spot [mm]", float(np.sqrt(5 / 2 * moment / solution.normalforce)), spot),
            ("largest pressure [N/mm^2]", float(solution.pressure.max()), pressure)]
