"""A seal ring of rubber in its groove: nearly incompressible, squeezed between two plates.

Question: With which force does an O-ring press on its groove, and how wide does it seal?
Domain: a ring of circular section, 5.3 mm thick and 100 mm across from middle to middle; the lower half of the section, of
    which the other half is the mirror image.
Problem: E = 4 [N/mm^2], nu = 0.4999; the middle plane goes down by half of 2 per cent of the thickness; the plate below is
    flat, p_n = 1e3 r, no friction (the ring is greased).
What to look at: the pressure is half an ellipse, as of a roller, and the mean stress inside is smooth: no locking, of order 2.
    The ring widens, so that its hoop force is 0: it is an eighth softer than a roller, which cannot give way along its axis.
Source: K. L. Johnson, Contact Mechanics, section 5.6: a roller of radius R between two plates, in plane strain, comes together
    by 4 P/(pi E*) (ln(4 R/b) - 1/2), with b^2 = 4 P R/(pi E*) and P the force per length.  Its axial force is -2 nu P R, which
    the ring takes back by the hoop strain 2 nu P/(pi E R), at which its thickness becomes less by 4 nu^2 P/(pi E).
Ask: What does order 1 on quadrilaterals give, with Conforming?  Which compression makes it seal 1 mm wide?  What does a
    friction with the coefficient 0.5 change, and a groove that does not let the ring widen?
"""

from math import log, pi, sqrt

from netgen.occ import WorkPlane
from ngsolve import CF, y
from scipy.optimize import brentq

from ngdgc import (ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NestedNewtonSolver,
                   NormalCompliance)
from ngdgc.meshes import ShapeMesh

THICKNESS, MIDDLE, COMPRESSION = 5.3, 50.0, 0.02
RUBBER = HookeMaterial(E=4, nu=0.4999)
RADIUS, MODULUS = THICKNESS / 2, RUBBER.E / (1 - RUBBER.nu ** 2)


def Squeezed(compression=COMPRESSION):
    """(force per length [N/mm], half width of the contact [mm]) of a ring between two plates."""
    def Width(force):
        return sqrt(4 * force * RADIUS / (pi * MODULUS))

    def Excess(force):
        roller = 4 * force / (pi * MODULUS) * (log(4 * RADIUS / Width(force)) - 0.5)
        return roller + 4 * RUBBER.nu ** 2 * force / (pi * RUBBER.E) - compression * THICKNESS

    force = brentq(Excess, 1e-6, MODULUS)
    return force, Width(force)


def Problem(compression=COMPRESSION, friction=None):
    foundation = Foundation("plate", NormalCompliance(1e3), friction=friction, gap=y, normal=CF((0, -1)))
    return ContactProblem(RUBBER, foundation, roller={"middle": -compression * RADIUS}, axisymmetric=True,
                          units=("mm", "N/mm^2"))


def Mesh(n=16, order=2):
    """About n elements across the contact, its boundary of degree `order`; the lowest point of the section at z = 0."""
    angle = 20
    path = WorkPlane().MoveTo(MIDDLE - RADIUS, RADIUS).Direction(0, -1).Arc(RADIUS, 90 - angle).Arc(RADIUS, 2 * angle)
    body = path.Arc(RADIUS, 90 - angle).Close().Face()
    for edge, name in zip(body.edges, ("inside", "plate", "outside", "middle"), strict=True):
        edge.name = name
    body.edges["plate"].maxh = 2 * 2 * Squeezed()[1] / n
    return ShapeMesh(body, RADIUS / 3, order=order)


def Main(*, method=InteriorPenalty(), order=2, n=16, solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(), method, Mesh(n, order), order=order)
    return solver.Solve(disc, callback=callback)


def Compare(solution):
    """Half width from the second moment of the pressure about its centre, b^2/4 of the force for half an ellipse."""
    force, width = Squeezed()
    shares = solution.weights * solution.pressure / solution.normalforce
    r = solution.points[:, 0]
    return [("force [N]", solution.normalforce, 2 * pi * MIDDLE * force),
            ("half width [mm]", 2 * sqrt(shares @ (r - shares @ r) ** 2), width)]
