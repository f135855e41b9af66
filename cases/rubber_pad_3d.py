"""A round rubber bearing under a plate: nearly incompressible, in three dimensions.

Question: How stiff is a round bearing, and which order is worth its unknowns?
Domain: a quarter of a disc of radius 40 and height 10 [mm], bonded to the plate on top, greased below.
Problem: rubber, E = 1.5 [N/mm^2], nu = 0.499; the plate goes down by 0.1 mm; p_n = 1e4 r, rigid, no friction.
What to look at: greased below, it is half of a bearing of height 20 that is bonded on both sides, of the shape factor S = 1: it
    resists like a material of modulus E (1 + 2 S^2).  H1 of order 1 locks, order 2 does not.
Source: A. N. Gent, P. B. Lindley, Proc. Inst. Mech. Eng. 173 (1959), for a disc of incompressible rubber; an estimate, of wide
    discs, that is good to some per cent.
Ask: Which order finds the force to 2 per cent with the fewest unknowns?  How much stiffer is a bearing of half the height?
    Is the pressure on the plate uniform?
"""

from math import pi

from netgen.occ import Circle, Rectangle, Z
from ngsolve import CF

from ngdgc import (ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NestedNewtonSolver,
                   NormalCompliance)
from ngdgc.meshes import ShapeMesh

RADIUS, HEIGHT, DOWN, MODULUS = 40.0, 10.0, 0.1, 1.5


def Problem(nu=0.499):
    foundation = Foundation("bottom", NormalCompliance(1e4))
    return ContactProblem(HookeMaterial(E=MODULUS, nu=nu), foundation, roller={"symmetry": 0},
                          dirichlet={"top": CF((0, 0, -DOWN))}, units=("mm", "N/mm^2"))


def Mesh(n=8, order=2):
    """About n elements along a radius, curved by the order."""
    quarter = (Circle((0, 0), RADIUS).Face() * Rectangle(RADIUS, RADIUS).Face()).Extrude(HEIGHT * Z)
    for face in quarter.faces:
        a, b, c = face.center
        face.name = ("symmetry" if min(abs(a), abs(b)) < 1e-6 else "bottom" if c < 1e-6
                     else "top" if c > HEIGHT - 1e-6 else "side")
    return ShapeMesh(quarter, RADIUS / n, order=order)


def Main(*, method=InteriorPenalty(), order=2, n=5, nu=0.499, solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(nu), method, Mesh(n, order), order=order)
    return solver.Solve(disc, callback=callback)


def Compare(solution):
    shape = RADIUS / (4 * HEIGHT)       # loaded area pi R^2 over free area 2 pi R 2H of the bearing that is twice as high
    return [("force of the whole bearing [N]", 4 * solution.normalforce,
             MODULUS * (1 + 2 * shape ** 2) * DOWN / HEIGHT * pi * RADIUS ** 2)]
