"""A plate pressed from above and from its sides onto a rigid plane with Coulomb friction: the benchmark of the GRECO group.

Question: How far does each point of a pressed plate slide, on a plane that friction lets it stick to in the middle?
Domain: (0,0.04) x (0,0.04) [m], half of a body 0.08 wide, symmetric about x = 0.04; the plane carries it vertically.
Problem: plane strain, E = 1.3e11, nu = 0.2 [Pa]; pressure 5e7 on top, 15e7 on x = 0; friction coefficient 1; p_n = k r with
    k = 1e16 [Pa/m] for the rigid plane: u_x at the reference points differs from the limit by less than 1e-3 of its size.
What to look at: the plate slides towards its middle, where it sticks, and lifts off a little at its edge x = 0; u_x on
    Gamma_C is REFERENCE, given to 5 per cent.
Source: SSNV128 in the validation manual of code_aster, after the group "Grandes deformations et endommagement" (GRECO).
Ask: Where does the stick zone end for the coefficients 0.5 and 2?  What is left of u_x without the pressure on the side?
    Would you believe a result that agrees with a reference of 5 per cent to 1e-4?
"""

from ngsolve import CF

from ngdgc import (ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NestedNewtonSolver, NormalCompliance)
from ngdgc.meshes import RectangleMesh

SIDE = 0.04
REFERENCE = {0: 2.86e-5, 0.00125: 2.72e-5, 0.005: 2.28e-5, 0.0075: 1.98e-5, 0.01125: 1.50e-5}      # {x: u_x(x, 0)} [m]


def Problem(stiffness=1e16, coefficient=1.0):
    foundation = Foundation("bottom", NormalCompliance(stiffness), friction=CoulombFriction(coefficient))
    return ContactProblem(HookeMaterial(E=1.3e11, nu=0.2), foundation, roller={"right": 0},
                          traction={"top": CF((0, -5e7)), "left": CF((15e7, 0))}, units=("m", "Pa"))


def Mesh(n=32, cells="triangle"):
    """n a multiple of 32 has vertices at all points of REFERENCE."""
    return RectangleMesh(n, upper=(SIDE, SIDE), cells=cells)


def Main(*, method=InteriorPenalty(), order=2, n=32, cells="triangle", solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(), method, Mesh(n, cells), order=order)
    return solver.Solve(disc, callback=callback)


def Compare(solution):
    """u_x at the points of REFERENCE, which are vertices of the mesh for n a multiple of 32."""
    return [(f"u_x at x = {1e3 * place:g} mm [mm]", 1e3 * float(solution.At(place, 0)[0]), 1e3 * value)
            for place, value in REFERENCE.items()]
