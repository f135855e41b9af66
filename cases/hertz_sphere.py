"""A ball pressed onto a plane: the point contact of Hertz.

Question: How large is the spot in which a ball touches, and what is the largest pressure?
Domain: the lower half of a ball of radius 50 [mm], of which two planes of symmetry leave a quarter; a cap of 2 mm may touch.
Problem: E = 3000, nu = 0.4 [N/mm^2] (a plastic); the force 100 N (of the whole ball) as a pressure on the plane through the
    centre; p_n = 1e6 r, nearly rigid, no friction.
What to look at: the pressure over the spot is half an ellipsoid.  The spot has a hundredth of the diameter of the ball: the
    mesh is fine at the cap, ten times coarser elsewhere, and curved.
Source: H. Hertz 1882; K. L. Johnson, Contact Mechanics, section 3.4.  With a the radius of the spot, a^3 = 3 F R/(4 E*) and
    p_0 = 3 F/(2 pi a^2), for a << R: here a/R = 2e-2.  The foundation yields p_0/k_n, `Softness` = 2e-3 of a^2/R.
Ask: Which force makes the spot twice as wide, and why is it not that of the roller?  How much of the error is that of
    Hertz's own theory, which takes a/R for small?  What would the shear of a friction with the coefficient 0.3 change?
"""

from math import pi

import numpy as np
from netgen.occ import Axes, Axis, WorkPlane, X, Y, Z
from ngsolve import CF, z

from ngdgc import (ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NestedNewtonSolver,
                   NormalCompliance)
from ngdgc.meshes import ShapeMesh

RADIUS, FORCE, MODULUS = 50.0, 100.0, 3000 / (1 - 0.4 ** 2)     # E* = E/(1 - nu^2)
CONTACT = 2.0       # length of the arc from the lowest point to the edge of the cap, two radii of the spot [mm]


def Hertz(radius=RADIUS):
    """(radius of the spot [mm], largest pressure [N/mm^2])"""
    spot = (3 * FORCE * radius / (4 * MODULUS)) ** (1 / 3)
    return spot, 3 * FORCE / (2 * pi * spot ** 2)


def Problem(stiffness=1e6):
    foundation = Foundation("contact", NormalCompliance(stiffness), gap=z * RADIUS / (RADIUS - z))
    return ContactProblem(HookeMaterial(E=3000, nu=0.4), foundation, roller={"symmetry": 0},
                          traction={"top": CF((0, 0, -FORCE / (pi * RADIUS ** 2)))}, units=("mm", "N/mm^2"))


def Mesh(n=12, order=2):
    """About n/2 elements from the middle of the cap to its edge, its boundary of degree `order`."""
    angle = np.degrees(CONTACT / RADIUS)
    # The profile in the plane y = 0: x to the right, z up.
    path = WorkPlane(Axes((0, 0, 0), n=-Y, h=X)).Arc(RADIUS, angle).Arc(RADIUS, 90 - angle)
    body = path.LineTo(0, RADIUS).Close().Face().Revolve(Axis((0, 0, 0), Z), 90)
    for face in body.faces:
        a, b, c = face.center
        face.name = ("symmetry" if min(abs(a), abs(b)) < 1e-6 else "top" if abs(c - RADIUS) < 1e-6
                     else "contact" if c < CONTACT else "side")
    body.faces["contact"].maxh = 2 * CONTACT / n
    return ShapeMesh(body, RADIUS / 2, order=order)


def Softness(stiffness=1e6):
    """Compression of the foundation relative to the approach a^2/R, no unit."""
    spot, pressure = Hertz()
    return pressure / stiffness / (spot ** 2 / RADIUS)


def Main(*, method=InteriorPenalty(), order=2, n=12, solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(), method, Mesh(n, order), order=order)
    return solver.Solve(disc, callback=callback)


def Compare(solution):
    """The radius comes from the second moment of the pressure, which is 2/5 a^2 of the force for half an ellipsoid."""
    spot, pressure = Hertz()
    squares = np.sum(solution.points[:, :2] ** 2, axis=1)
    moment = (solution.weights * solution.pressure) @ squares
    return [("force [N]", 4 * solution.normalforce, FORCE),
            ("radius of the spot [mm]", float(np.sqrt(5 / 2 * moment / solution.normalforce)), spot),
            ("largest pressure [N/mm^2]", float(solution.pressure.max()), pressure)]
