"""A block of two materials on a foundation whose stiffness and gap vary: it settles askew.

Question: How far does the block sink in at its two ends, and which part of the foundation carries how much?
Domain: (0,200) x (0,60) [mm]; steel for x < 100, aluminium beyond.
Problem: plane strain, steel E = 210000, nu = 0.3, aluminium E = 70000, nu = 0.33 [N/mm^2]; pressure 2 on top; stiffness of the
    foundation 5 (1 + x/100) [N/mm^3], gap 0.2 (x/200)^2 [mm], friction coefficient 0.2.
What to look at: the right end has the stiffer ground but stands off.  A rigid block on springs sinks in by d + t x - g(x) with
    d and t from the balance of force and moment; the elastic one bends a little over it.
Source: E. Winkler's foundation, two equations in `Rigid`.
Ask: Which gap would let the block settle level?  Where is the largest stress, at the foundation or at the interface?  Does
    the friction of 0.2 change forces that you would notice?
"""

import numpy as np
from netgen.occ import Glue, MoveTo
from ngsolve import CF, x

from ngdgc import (ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NestedNewtonSolver, NormalCompliance)
from ngdgc.meshes import ShapeMesh

LENGTH, HEIGHT, PRESSURE = 200.0, 60.0, 2.0


def Stiffness(x):
    return 5 * (1 + x / 100)


def Gap(x):
    return 0.2 * (x / LENGTH) ** 2


def Problem(gap=Gap):
    foundation = Foundation("bottom", NormalCompliance(Stiffness(x)), friction=CoulombFriction(0.2), gap=gap(x))
    # One value for each material of the mesh, in its order.
    material = HookeMaterial(E=CF([210000, 70000]), nu=CF([0.3, 0.33]))
    return ContactProblem(material, foundation, traction={"top": CF((0, -PRESSURE))})


def Mesh(n=16):
    """About n elements along the base, without structure; the interface is a line of the mesh."""
    halves = [MoveTo(left, 0).Rectangle(LENGTH / 2, HEIGHT).Face() for left in (0, LENGTH / 2)]
    for half, name in zip(halves, ("steel", "aluminium")):
        half.faces.name = name
    body = Glue(halves)
    for edge in body.edges:
        across, up, _ = edge.center
        edge.name = ("bottom" if up < 1e-6 else "top" if up > HEIGHT - 1e-6
                     else "interface" if abs(across - LENGTH / 2) < 1e-6 else "side")
    return ShapeMesh(body, LENGTH / n)


def Main(*, method=InteriorPenalty(), order=2, n=16, solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(), method, Mesh(n), order=order)
    return solver.Solve(disc, callback=callback)


def Rigid():
    """(x, d + t x - g(x)) [mm], places and penetrations of a rigid block all of whose base presses."""
    x = (np.arange(1000) + 0.5) / 1000 * LENGTH
    modes = np.array([np.ones_like(x), x])
    springs = Stiffness(x) * LENGTH / 1000
    loads = PRESSURE * LENGTH * np.array([1, LENGTH / 2]) + modes @ (springs * Gap(x))
    return x, np.linalg.solve((modes * springs) @ modes.T, loads) @ modes - Gap(x)


def Compare(solution):
    points, penetration = Rigid()
    right = points > LENGTH / 2
    carried = Stiffness(points) * penetration * LENGTH / 1000
    here = solution.points[:, 0]
    pressed = solution.weights * solution.pressure
    return [("force [N/mm]", solution.normalforce, PRESSURE * LENGTH),
            ("force on the right half [N/mm]", float(pressed[here > LENGTH / 2].sum()), float(carried[right].sum())),
            ("penetration on the left [mm]", float(solution.penetration[here.argmin()]), float(penetration[0])),
            ("penetration on the right [mm]", float(solution.penetration[here.argmax()]), float(penetration[-1]))]
