"""A square hanging from its top, sheared over a soft foundation: part of the bottom lifts off.

Question: Which part of the base lifts off when a hanging block is sheared?
Domain: (0,1) x (0,1) [mm], clamped on top, touching the foundation (gap 0).
Problem: E = 2500, nu = 0.2 [daN/mm^2]; traction (880, 0) on the left; p_n = 250 r, friction bound 1.
What to look at: the left half of the bottom presses and slips, the right half lifts off.
Source: Example 4.2 of Xiao, Wang, Han, Numer. Funct. Anal. Optim. 2018.
Ask: How far does the lifted part grow when the foundation is ten times as stiff?  Do meshes 1/8, 1/16, 1/32 agree on where
    contact ends, and how well?  Why is there stress without bound in the upper corners, and what does it do to the order?
"""

from ngsolve import CF

from ngdgc import (ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NestedNewtonSolver,
                   NormalCompliance, TrescaFriction)
from ngdgc.meshes import RectangleMesh


def Problem(plane="stress"):
    foundation = Foundation("bottom", NormalCompliance(stiffness=250, exponent=1), friction=TrescaFriction(1))
    return ContactProblem(HookeMaterial(E=2500, nu=0.2, plane=plane), foundation,
                          dirichlet={"top": CF((0, 0))}, traction={"left": CF((880, 0))})


def Mesh(n=16, cells="triangle"):
    return RectangleMesh(n, cells=cells)


def Main(*, method=InteriorPenalty(), order=1, n=16, plane="stress", cells="triangle", solver=NestedNewtonSolver(),
         callback=None):
    disc = Discretization(Problem(plane), method, Mesh(n, cells), order=order)
    return solver.Solve(disc, callback=callback)
