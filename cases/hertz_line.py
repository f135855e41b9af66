"""A roller pressed onto a plane: the line contact of Hertz.

Question: How wide does a roller touch, and what is the largest pressure?
Domain: the lower half of a disc of radius 50 [mm], its left half removed (symmetry); the lowest 1.2 mm of the arc may touch.
Problem: plane strain, E = 3000, nu = 0.4 [N/mm^2] (a plastic); the force 20 N/mm (of the whole roller) as a pressure on the
    plane through the axis; p_n = 1e7 r, nearly rigid, no friction.
What to look at: the pressure over the arc is half an ellipse.  The gap is measured along the normal of the arc, g = y/cos a,
    and the mesh is curved, so that the shape of the roller is described once, by its geometry.
Source: H. Hertz 1882; K. L. Johnson, Contact Mechanics, section 4.2.  With b the half width, b^2 = 4 P R/(pi E*) and
    p_0 = 2 P/(pi b), for b << R: here b/R = 1.2e-2.  The foundation yields p_0/k_n, `Softness` = 6e-4 of b^2/(2R).
Ask: Which force makes the contact twice as wide?  With k_n = 1e5 in place of 1e7, how far is the pressure from half an
    ellipse?  Which order, and which mesh at the arc, does one per cent of the largest pressure need?
"""

from math import pi, sqrt

import numpy as np
from netgen.occ import WorkPlane
from ngsolve import CF, y

from ngdgc import (ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NestedNewtonSolver,
                   NormalCompliance)
from ngdgc.meshes import ShapeMesh

RADIUS, FORCE, MODULUS = 50.0, 20.0, 3000 / (1 - 0.4 ** 2)      # E* = E/(1 - nu^2)
CONTACT = 1.2       # length of the part of the arc that may touch, two half widths [mm]


def Hertz(radius=RADIUS):
    """(half width [mm], largest pressure [N/mm^2])"""
    half = sqrt(4 * FORCE * radius / (pi * MODULUS))
    return half, 2 * FORCE / (pi * half)


def Problem(stiffness=1e7):
    foundation = Foundation("contact", NormalCompliance(stiffness), gap=y * RADIUS / (RADIUS - y))
    return ContactProblem(HookeMaterial(E=3000, nu=0.4), foundation, roller={"axis": 0},
                          traction={"top": CF((0, -FORCE / (2 * RADIUS)))}, units=("mm", "N/mm^2"))


def Mesh(n=16, order=2):
    """About n elements along the part that may touch, its boundary of degree `order`."""
    angle = CONTACT / RADIUS
    path = WorkPlane().Arc(RADIUS, np.degrees(angle)).Arc(RADIUS, 90 - np.degrees(angle))
    body = path.LineTo(0, RADIUS).Close().Face()
    for edge, name in zip(body.edges, ("contact", "side", "top", "axis"), strict=True):
        edge.name = name
    body.edges["contact"].maxh = CONTACT / n
    return ShapeMesh(body, RADIUS / 5, order=order)


def Softness(stiffness=1e7):
    """Compression of the foundation relative to the indentation b^2/(2R), no unit."""
    half, pressure = Hertz()
    return pressure / stiffness / (half ** 2 / (2 * RADIUS))


def Main(*, method=InteriorPenalty(), order=2, n=16, solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(), method, Mesh(n, order), order=order)
    return solver.Solve(disc, callback=callback)


def Compare(solution):
    """The half width comes from the second moment of the pressure, which is b^2/4 of the force for half an ellipse."""
    half, pressure = Hertz()
    x = solution.points[:, 0]
    moment = (solution.weights * solution.pressure) @ x ** 2
    return [("force [N/mm]", 2 * solution.normalforce, FORCE),
            ("half width [mm]", float(2 * np.sqrt(moment / solution.normalforce)), half),
            ("largest pressure [N/mm^2]", float(solution.pressure.max()), pressure)]
