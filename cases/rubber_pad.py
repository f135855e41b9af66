"""A rubber pad under a plate: nearly incompressible, and far stiffer than its modulus says.

Question: How stiff is a pad that cannot flow out, and which elements find that instead of locking?
Domain: (0,40) x (0,20) [mm], half of a pad 80 mm wide, symmetric about x = 0; bonded to the plate on top, greased below.
Problem: rubber in plane strain, E = 1.5 [N/mm^2], nu = 0.499; the plate goes down by 0.2 mm; p_n = 1e5 r, rigid, no friction.
What to look at: greased below, it is half of a pad of thickness 40 that is bonded on both sides, of the shape factor S = 1: it
    resists like a material of modulus 4/3 E (1 + S^2).  H1 of order 1 finds several times that force: it locks.
Source: A. N. Gent, P. B. Lindley, Proc. Inst. Mech. Eng. 173 (1959), for a long strip of incompressible rubber; an estimate, of
    wide pads, that is good to some per cent.
Ask: How wrong is `--method h1 --order 1`, and how wrong with `--n 64`?  From which Poisson number on does it matter?  What
    does the pad do when its lower side sticks?
"""

from ngsolve import CF

from ngdgc import (ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NestedNewtonSolver,
                   NormalCompliance)
from ngdgc.meshes import RectangleMesh

WIDTH, HEIGHT, DOWN, MODULUS = 40.0, 20.0, 0.2, 1.5


def Problem(nu=0.499):
    foundation = Foundation("bottom", NormalCompliance(1e5))
    return ContactProblem(HookeMaterial(E=MODULUS, nu=nu), foundation, roller={"left": 0},
                          dirichlet={"top": CF((0, -DOWN))}, units=("mm", "N/mm^2"))


def Mesh(n=16, cells="triangle"):
    return RectangleMesh(n, upper=(WIDTH, HEIGHT), cells=cells)


def Main(*, method=InteriorPenalty(), order=2, n=16, nu=0.499, cells="triangle", solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(nu), method, Mesh(n, cells), order=order)
    return solver.Solve(disc, callback=callback)


def Compare(solution):
    shape = 2 * WIDTH / (4 * HEIGHT)        # loaded area over free area of the pad that is twice as thick
    force = 4 / 3 * MODULUS * (1 + shape ** 2) * DOWN / HEIGHT * 2 * WIDTH
    return [("force of the whole pad [N/mm]", 2 * solution.normalforce, force)]
