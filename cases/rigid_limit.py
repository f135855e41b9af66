"""From a soft to a rigid foundation: normal compliance as a penalty for unilateral contact with Coulomb friction.

Question: How stiff must a foundation be to stand for a rigid one?
Domain: (0,1) x (0,1), contact on the bottom with gap 0; no units.
Problem: E = 2500, nu = 0.2; p_n = k r, friction coefficient 0.4; loads and Dirichlet values of a unilateral solution that
    sticks for x < 1/4, slips up to 3/4 and lifts off beyond (`ngdgc.traces.RigidLimit`).
What to look at: the distance of u_k from the unilateral solution falls like 1/k.  `Study` shows nothing but that, because the
    limit is a piecewise polynomial of degree 4 and the mesh has vertices where its zones end.
Source: penalty theory of Chouly and Hild, Appl. Numer. Math. 65 (2013): with 1/k of the size of h the rate in h is optimal.
Ask: How stiff must the foundation be for 1 per cent in the energy norm?  Why does the distance not fall any more below some
    k, on a mesh whose vertices are not at the ends of zones?  Which p_n other than a line would fall faster?
"""

from ngdgc import Discretization, InteriorPenalty, NestedNewtonSolver
from ngdgc.errors import EnergyError, Rates
from ngdgc.meshes import RectangleMesh
from ngdgc.traces import RigidLimit


def Problem(stiffness=1e3):
    return RigidLimit(stiffness=stiffness).problem


def Mesh(n=4, cells="triangle"):
    """n a multiple of 4 has vertices at the ends of the zones."""
    return RectangleMesh(n, cells=cells)


def Main(*, method=InteriorPenalty(), order=4, n=4, stiffness=1e3, cells="triangle", solver=NestedNewtonSolver(),
         callback=None):
    disc = Discretization(Problem(stiffness), method, Mesh(n, cells), order=order)
    return solver.Solve(disc, callback=callback)


def Study(stiffnesses, **arguments):
    """(errors, rates) in the energy norm against the unilateral solution, for growing stiffnesses; rates are powers of 1/k."""
    errors = [EnergyError(Main(stiffness=stiffness, **arguments), RigidLimit(stiffness=stiffness).displacement)
              for stiffness in stiffnesses]
    return errors, Rates(errors, ratio=[b / a for a, b in zip(stiffnesses[:-1], stiffnesses[1:])])
