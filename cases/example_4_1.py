"""A square pressed and dragged onto a soft foundation, with a constant friction bound.

Question: How deep does a corner sink that is pulled down and dragged, and does a constant friction bound matter?
Domain: (0,1) x (0.05,1.05) [mm], clamped on the right, gap 0.05 above the foundation.
Problem: E = 2000, nu = 0.4 [daN/mm^2]; traction (200 (5-y), -190) on the left; p_n = 450 r, friction bound 1.
What to look at: the lower left corner sinks 0.5 mm into the foundation; the friction bound is 1 against tractions near 1000
    and hardly shows.
Source: Example 4.1 of Xiao, Wang, Han, Numer. Funct. Anal. Optim. 2018, which states plane stress.
Ask: By how much does the corner move when the friction bound is 0, or 100?  What changes with `--plane strain`?  Which
    number of the report would tell that the body sinks in too deep for a linear theory?
"""

from ngsolve import CF, y

from ngdgc import (ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NestedNewtonSolver,
                   NormalCompliance, TrescaFriction)
from ngdgc.meshes import RectangleMesh


def Problem(plane="stress"):
    foundation = Foundation("bottom", NormalCompliance(stiffness=450, exponent=1), friction=TrescaFriction(1), gap=0.05)
    return ContactProblem(HookeMaterial(E=2000, nu=0.4, plane=plane), foundation,
                          dirichlet={"right": CF((0, 0))}, traction={"left": CF((200 * (5 - y), -190))})


def Mesh(n=16, cells="triangle"):
    return RectangleMesh(n, lower=(0, 0.05), upper=(1, 1.05), cells=cells)


def Main(*, method=InteriorPenalty(), order=1, n=16, plane="stress", cells="triangle", solver=NestedNewtonSolver(),
         callback=None):
    disc = Discretization(Problem(plane), method, Mesh(n, cells), order=order)
    return solver.Solve(disc, callback=callback)
