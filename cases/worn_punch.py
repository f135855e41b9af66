"""A punch with a rounded foot that travels over a foundation and wears until all of the foot carries the same.

Question: How does the pressure under a punch change while it wears?
Domain: (-1,1) x (0,2) [mm], the punch; its foot y = 0 is rounded with a radius of 50 mm, a gap x^2/100.
Problem: plane strain, E = 1000, nu = 0.3 [N/mm^2]; guided by rollers at both sides, which move it along; pressed by 5 N/mm^2
    on its top; p_n = 1e4 r, friction coefficient 0.3, Archard's wear 2e-4 [mm^2/N].
What to look at: `History` (`--history`): at first the middle alone touches, with twice the mean pressure.  It wears most, the
    contact grows, and in the end pressure and wear are nearly even.  The worn volume is a straight line over the way.
Source: J. F. Archard, J. Appl. Phys. 24 (1953): volume = coefficient times force times way, `Compare` of the force, `Volume`.
    I. G. Goryacheva, Contact Mechanics in Tribology (1998), chapter 5: pressure of a punch that does not tilt becomes even.
Ask: After which way does the whole foot touch?  How does the way depend on coefficient and radius?  What changes with a
    foundation a hundred times as stiff?
"""

import numpy as np
from ngsolve import CF, Parameter, x

from ngdgc import (ArchardWear, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NestedNewtonSolver, NormalCompliance, SolveHistory)
from ngdgc.meshes import RectangleMesh

RADIUS, PRESSURE, WAY, WEAR = 50.0, 5.0, 10.0, 2e-4


def Problem(way=0.0):
    foundation = Foundation("bottom", NormalCompliance(1e4), friction=CoulombFriction(0.3), gap=x ** 2 / (2 * RADIUS),
                            wear=ArchardWear(WEAR))
    return ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, roller={"left": -way, "right": way},
                          traction={"top": CF((0, -PRESSURE))}, units=("mm", "N/mm^2"))


def Mesh(n=16, cells="triangle"):
    return RectangleMesh(n, lower=(-1, 0), upper=(1, 2), cells=cells)


def Main(*, method=InteriorPenalty(), order=2, n=16, way=0.0, cells="triangle", solver=NestedNewtonSolver(), callback=None):
    return solver.Solve(Discretization(Problem(way), method, Mesh(n, cells), order=order), callback=callback)


def History(*, count=20, way=WAY, method=InteriorPenalty(), order=2, n=16, callback=None):
    """The LoadHistory of a way [mm], in `count` increments, which are divided where they wear too much."""
    t = Parameter(0)
    disc = Discretization(Problem(way * t), method, Mesh(n), order=order)
    return SolveHistory(disc, parameter=t, times=np.linspace(0, 1, count + 1), callback=callback)


def Volume(history, way=WAY):
    """(worn volumes, those of Archard's formula) [mm^2] of all states."""
    return history.worn @ history[0].weights, WEAR * 2 * PRESSURE * way * history.times


def Compare(solution):
    """What the foot carries is what presses the punch."""
    return [("normal force [N/mm]", solution.normalforce, 2 * PRESSURE)]
