"""A block on a wavy foundation that is given by nothing but its gap: crests touch, troughs do not.

Question: Which part of the block touches a wavy foundation, and how large is the pressure on the crests?
Domain: (0,20) x (0,20) [mm], two wave lengths of 10 mm wide; planes of symmetry on the left and on the right.
Problem: plane strain, E = 10000, nu = 0.3 [N/mm^2]; pressure 10 on top; gap 0.01 (1 - cos(2 pi x/10)) [mm], the crests touch;
    p_n = 1e7 r, nearly rigid, no friction.
What to look at: three times the load would flatten all of the waves; here contact ends at a distance from the crests that
    only the mean pressure decides.  The pressure on them is thrice the mean one.
Source: H. M. Westergaard 1939; K. L. Johnson, Contact Mechanics, section 13.2: p* = pi E* D/L flattens waves of amplitude D and
    length L, sin^2(pi b/L) = p/p* gives the half width b of a contact, 2 p/sin(pi b/L) the largest pressure.
Ask: Which pressure flattens the waves, computed and by the formula?  What becomes of the contact when the waves are half as
    long?  Which k_n is stiff enough to be called rigid here?
"""

from math import asin, pi, sqrt

from ngsolve import CF, cos, x

from ngdgc import (ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NestedNewtonSolver,
                   NormalCompliance)
from ngdgc.meshes import RectangleMesh

SIZE, WAVE, AMPLITUDE, PRESSURE, MODULUS = 20.0, 10.0, 0.01, 10.0, 10000 / (1 - 0.3 ** 2)


def Westergaard(amplitude=AMPLITUDE):
    """(part of the length in contact, largest pressure [N/mm^2])"""
    sine = sqrt(PRESSURE / (pi * MODULUS * amplitude / WAVE))
    return 2 * asin(sine) / pi, 2 * PRESSURE / sine


def Problem(amplitude=AMPLITUDE, stiffness=1e7):
    foundation = Foundation("bottom", NormalCompliance(stiffness), gap=amplitude * (1 - cos(2 * pi * x / WAVE)))
    return ContactProblem(HookeMaterial(E=10000, nu=0.3), foundation, roller={"left|right": 0},
                          traction={"top": CF((0, -PRESSURE))})


def Mesh(n=32, cells="triangle"):
    return RectangleMesh(n, upper=(SIZE, SIZE), cells=cells)


def Main(*, method=InteriorPenalty(), order=2, n=32, cells="triangle", solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(), method, Mesh(n, cells), order=order)
    return solver.Solve(disc, callback=callback)


def Compare(solution):
    part, pressure = Westergaard()
    return [("mean pressure [N/mm^2]", solution.normalforce / SIZE, PRESSURE),
            ("part of the length in contact", 1 - solution.ZoneLengths()["separation"] / SIZE, part),
            ("largest pressure [N/mm^2]", float(solution.pressure.max()), pressure)]
