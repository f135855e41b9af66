"""A block wedged into a notch of rock, with a joint on each flank: a weight presses it in, and it slides down.

Question: How hard does a block that is wedged in press against the rock, and how much of its weight does friction carry?
Domain: (-4,4) x (0,5) [m]; the block widens from 2 at y = 2 to 2 + 6/sqrt(3) at y = 5, its flanks lean outward by 30 degrees.
Problem: plane strain, E = 20000 for the rock and 40000 for the block, nu = 0.25 [MPa]; base and sides of the rock do not move
    across themselves; pressure 1 [MPa] on top of the block; joints p_n = 200 r [MPa/m], friction coefficient 0.3; the bottom of
    the block stands off by a gap that it never closes.
What to look at: both joints slip all over, so that friction is 0.3 of the pressure and balance tells both: with W the load and
    a = 30 degrees, W/2 = N sin a + S cos a, S = 0.3 N.  The block is a hundred times stiffer than its joints: it goes down as a
    rigid one, and slides by cot a times what the joints are pressed.
Source: limit equilibrium of a block, R. E. Goodman, Introduction to Rock Mechanics, chapter 8.
Ask: From which friction coefficient on does the block stick?  What changes if one joint is twice as stiff as the other?  With
    `SolveHistory`, which friction is left when the load is taken off?
"""

from math import cos, pi, sin, tan

import numpy as np
from netgen.occ import Glue, MoveTo
from ngsolve import CF

from ngdgc import (ContactProblem, CoulombFriction, Discretization, HookeMaterial, InteriorPenalty, Joint, NestedNewtonSolver,
                   NormalCompliance)
from ngdgc.meshes import ShapeMesh

ANGLE, DEPTH, WIDTH = pi / 6, 3.0, 2.0      # of the flanks to the vertical; of the notch [m]; of its bottom [m]
STIFFNESS, COEFFICIENT, PRESSURE = 200.0, 0.3, 1.0
TOP = WIDTH + 2 * DEPTH * tan(ANGLE)
LOAD = PRESSURE * TOP


def Problem(coefficient=COEFFICIENT, stiffness=STIFFNESS):
    law = {"compliance": NormalCompliance(stiffness), "friction": CoulombFriction(coefficient)}
    joints = [Joint("left", **law), Joint("right", **law), Joint("below", NormalCompliance(stiffness), gap=0.1)]
    # One value for each material of the mesh, in its order.
    material = HookeMaterial(E=CF([20000, 40000]), nu=0.25)
    return ContactProblem(material, joints, roller={"base|side": 0}, traction={"top": (0, -PRESSURE)}, units=("m", "MPa"))


def Mesh(n=16):
    """About n elements along the width; rock and block."""
    reach = DEPTH * tan(ANGLE)
    block = MoveTo(-WIDTH / 2, 2).LineTo(WIDTH / 2, 2).LineTo(WIDTH / 2 + reach, 2 + DEPTH)
    block = block.LineTo(-WIDTH / 2 - reach, 2 + DEPTH).Close().Face()
    rock = MoveTo(-4, 0).Rectangle(8, 2 + DEPTH).Face() - block
    rock.faces.name, block.faces.name = "rock", "block"
    body = Glue([rock, block])
    for edge in body.edges:
        across, up, _ = edge.center
        edge.name = ("base" if up < 1e-6 else "side" if abs(across) > 4 - 1e-6
                     else ("free" if abs(across) > TOP / 2 else "top") if up > 5 - 1e-6
                     else "below" if abs(across) < 1e-6 else "left" if across < 0 else "right")
    return ShapeMesh(body, 8 / n)


def Main(*, method=InteriorPenalty(), order=2, n=16, coefficient=COEFFICIENT, solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(coefficient), method, Mesh(n), order=order)
    return solver.Solve(disc, callback=callback)


def Wedge(coefficient=COEFFICIENT):
    """Force across each flank [MN/m] of a block that slides on both."""
    return LOAD / 2 / (sin(ANGLE) + coefficient * cos(ANGLE))


def Compare(solution):
    force = Wedge()
    across = force * cos(ANGLE) / DEPTH / STIFFNESS         # p/k
    rows = []
    for part in solution.disc.contact.parts[:2]:
        here, name = part.points, part.foundation.boundary
        weights = solution.weights[here]
        rows.append((f"force across the joint {name} [MN/m]", float(weights @ solution.pressure[here]), force))
        slide = np.linalg.norm(solution.slip[here], axis=1)
        rows.append((f"slip on the joint {name} [m]", float(weights @ slide / weights.sum()), across / tan(ANGLE)))
    return rows
