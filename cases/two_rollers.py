"""Two equal rollers pressed together and rubbed to and fro: Hertz's contact and Mindlin's loop, on a joint of two bodies.

Question: How much work does friction take in a cycle between two rollers that stick in the middle and slip at the edges?
Domain: (-10,10) x (-10,10) [mm], the parts of two rollers of radius 50 next to their contact, y < 0 and y > 0; the joint at
    y = 0 has the gap x^2/50, twice the x^2/2R of one roller.
Problem: plane strain, E = 3000, nu = 0.4 [N/mm^2] for both; the lower side is held, the upper one goes down by 0.012 mm and
    `pull` [mm] sideways; p_n = 1e6 r, nearly rigid, friction coefficient 0.5.
What to look at: the pressure over x is half an ellipse.  Two equal bodies give way alike, so that friction does not change
    it; on a foundation, which does not give way sideways, that is so only for nu = 1/2.  `History` presses, drags, and goes
    back and forth (`--history`): the loop of force over pull closes, and its area is what friction takes.
Source: H. Hertz 1882; C. Cattaneo 1938, R. D. Mindlin and H. Deresiewicz 1953; K. L. Johnson, Contact Mechanics, sections 4.2,
    7.2 and 7.4.  Without coupling the slide is mu times the difference of the approaches under P and under P - Q/mu
    (M. Ciavarella 1998), whose derivative is const - ln(P)/(pi E*): over a cycle the constant drops out, `LoopArea`.
Ask: What happens to the loop if the pull is doubled?  Which part of the contact never slips?  With upper and lower halves of
    different moduli, is the pressure still that of Hertz?
"""

from math import pi, sqrt

import numpy as np
from netgen.occ import Glue, MoveTo
from ngsolve import IfPos, Parameter, x

from ngdgc import (ContactProblem, CoulombFriction, Discretization, HookeMaterial, InteriorPenalty, Joint, NestedNewtonSolver,
                   NormalCompliance, SolveHistory)
from ngdgc.meshes import ShapeMesh

RADIUS, SIZE, CONTACT, COEFFICIENT = 50.0, 10.0, 0.6, 0.5
MODULUS = 3000 / (1 - 0.4 ** 2) / 2     # E* of two bodies: 1/E* = 2 (1 - nu^2)/E
DOWN, PULL = 0.012, 0.006


def Hertz(force):
    """(half width [mm], largest pressure [N/mm^2]) of two rollers of this radius, together as one of half of it."""
    half = sqrt(4 * force * (RADIUS / 2) / (pi * MODULUS))
    return half, 2 * force / (pi * half)


def LoopArea(force, shear):
    """Work that friction takes in a cycle between the shears -Q and Q under the force P [N mm/mm].

    -4/(pi E*) int_0^Q (2 q - Q) ln(1 - q/(mu P)) dq
    """
    nodes, weights = np.polynomial.legendre.leggauss(40)
    q = shear * (nodes + 1) / 2
    return float(-4 / (pi * MODULUS) * shear / 2 * weights @ ((2 * q - shear) * np.log(1 - q / (COEFFICIENT * force))))


def Problem(pull=0.0, down=DOWN, coefficient=COEFFICIENT):
    joint = Joint("joint", NormalCompliance(1e6), friction=CoulombFriction(coefficient), gap=x ** 2 / RADIUS)
    return ContactProblem(HookeMaterial(E=3000, nu=0.4), joint, dirichlet={"bottom": (0, 0), "top": (pull, -down)},
                          units=("mm", "N/mm^2"))


def Mesh(n=32):
    """About n elements along the part of the joint that may touch."""
    halves = []
    for low, name in ((-SIZE, "lower"), (0, "upper")):
        middle = MoveTo(-CONTACT, low).Rectangle(2 * CONTACT, SIZE).Face()
        halves += [MoveTo(-SIZE, low).Rectangle(SIZE - CONTACT, SIZE).Face(), middle,
                   MoveTo(CONTACT, low).Rectangle(SIZE - CONTACT, SIZE).Face()]
        for part in halves[-3:]:
            part.faces.name = name
    body = Glue(halves)
    for edge in body.edges:
        across, up, _ = edge.center
        edge.name = ("joint" if abs(up) < 1e-9 else "bottom" if up < 1e-9 - SIZE else "top" if up > SIZE - 1e-9
                     else "side" if abs(across) > SIZE - 1e-9 else "inside")
        if edge.name == "joint" and abs(across) < CONTACT:
            edge.maxh = 2 * CONTACT / n
    return ShapeMesh(body, SIZE / 3)


def Main(*, method=InteriorPenalty(), order=2, n=32, pull=PULL, solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(pull), method, Mesh(n), order=order)
    return solver.Solve(disc, callback=callback)


def History(*, count=8, largest=PULL, method=InteriorPenalty(), order=2, n=32, callback=None):
    """The LoadHistory of pressing, pulling to `largest` [mm] in `count` increments, and one cycle back and forth."""
    t = Parameter(0)
    # t from 0 to 1 presses; from then on the pull goes by the largest one for every unit, up, down and up.
    turn = IfPos(t - 2, IfPos(t - 4, t - 5, 3 - t), IfPos(t - 1, t - 1, 0))
    problem = Problem(pull=largest * turn, down=DOWN * IfPos(t - 1, 1, t))
    return SolveHistory(Discretization(problem, method, Mesh(n), order=order), parameter=t,
                        times=np.linspace(0, 6, 6 * count + 1), callback=callback)


def Compare(solution):
    """Half width from the second moment of the pressure, which is b^2/4 of the force for half an ellipse."""
    force = solution.normalforce
    half, pressure = Hertz(force)
    moment = (solution.weights * solution.pressure) @ solution.points[:, 0] ** 2
    return [("half width [mm]", float(2 * np.sqrt(moment / force)), half),
            ("largest pressure [N/mm^2]", float(solution.pressure.max()), pressure)]
