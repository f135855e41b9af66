"""A block pressed and sheared on a soft foundation: its base sticks, slips and lifts off.

Question: How much of the base lifts off when the shear force acts at the top, and how much of the rest slips?
Domain: (0,100) x (0,60) [mm], plane strain, gap 0; nothing but the foundation holds the block.
Problem: aluminium, E = 70000, nu = 0.33 [N/mm^2]; on top the pressure 1 and the shear 0.35 [N/mm^2]; p_n = 10 r, friction
    coefficient 0.5.
What to look at: P = 100 and Q = 35 N/mm meet the base Q H/P = 21 mm off its middle, outside the middle third.  A rigid block
    on springs keeps contact along 3 (50 - 21) = 87 mm, with the largest pressure 2 P/87; the elastic one nearly does.  It
    sticks in the middle and slips at both ends of the contact, although Q is less than friction could bear.
Source: the rule of the middle third; the formulas are in `Compare`.
Ask: At which shear does the block slide, and at which would it topple?  How much of the base sticks if the pressure is
    twice as large?  Why does a stiffer foundation let more of the base lift off?
"""

from ngsolve import CF

from ngdgc import (ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NestedNewtonSolver, NormalCompliance)
from ngdgc.meshes import RectangleMesh

LENGTH, HEIGHT = 100, 60
PRESSURE, SHEAR = 1.0, 0.35


def Problem(shear=SHEAR, coefficient=0.5):
    foundation = Foundation("bottom", NormalCompliance(stiffness=10), friction=CoulombFriction(coefficient))
    return ContactProblem(HookeMaterial(E=70000, nu=0.33), foundation, traction={"top": CF((shear, -PRESSURE))})


def Mesh(n=16, cells="triangle"):
    return RectangleMesh(n, upper=(LENGTH, HEIGHT), cells=cells)


def Main(*, method=InteriorPenalty(), order=2, n=16, cells="triangle", solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(), method, Mesh(n, cells), order=order)
    return solver.Solve(disc, callback=callback)


def Compare(solution):
    """Forces by balance; contact length and largest pressure of a rigid block on springs."""
    force, shear = PRESSURE * LENGTH, SHEAR * LENGTH
    length = 3 * (LENGTH / 2 - shear * HEIGHT / force)
    zones = solution.ZoneLengths()
    return [("normal force [N/mm]", solution.normalforce, force),
            ("friction force [N/mm]", float(solution.weights @ solution.friction[:, 0]), -shear),
            ("contact length [mm]", zones["stick"] + zones["slip"], length),
            ("largest pressure [N/mm^2]", float(solution.pressure.max()), 2 * force / length)]
