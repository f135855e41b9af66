"""Bodies with a joint, whose states are known, and their balance."""

import numpy as np
from bodies import LINE, Crossed, Halves, Stacked
from ngsolve import CF, specialcf, y, z

from ngdgc import ContactProblem, CoulombFriction, HookeMaterial, Joint, NormalCompliance

K, P, NU, MID = 5000.0, 40.0, 0.3, 0.4      # stiffness of the joint, pressure, Poisson's ratio, height of the joint
MODULI = {"soft": 500.0, "hard": 1000.0}
BODIES = {2: Halves(), 3: Stacked()}


def Material(mesh):
    return HookeMaterial(E=mesh.MaterialCF(MODULI), nu=NU)


def Shear(E):
    return E / (2 * (1 + NU))


def Confined(E):
    """lam + 2 mu."""
    return E * (1 - NU) / ((1 + NU) * (1 - 2 * NU))


def Walls(dim):
    return "left|right" if dim == 2 else "left|right|front|back"


def Patch(dim, tau, slip, *, coefficient=0.3):
    """(problem, u): both parts under pressure P and shear tau in the first direction, the upper one displaced by `slip`."""
    mesh, up = BODIES[dim], y if dim == 2 else z
    pressed, sheared = ([{"soft": f / law(MODULI["soft"]) * up,
                          "hard": f / law(MODULI["soft"]) * MID + f / law(MODULI["hard"]) * (up - MID) + jump}
                         for law, f, jump in ((Confined, -P, -P / K), (Shear, tau, slip))])
    u = CF((mesh.MaterialCF(sheared), *(0,) * (dim - 2), mesh.MaterialCF(pressed)))
    top = [sum(f * length / law(MODULI[name]) for name, length in (("soft", MID), ("hard", 1 - MID))) + jump
           for law, f, jump in ((Shear, tau, slip), (Confined, -P, -P / K))]
    side = -P * NU / (1 - NU)
    stress = np.diag([side] * (dim - 1) + [-P]).astype(object)      # tau may depend on a Parameter
    stress[0, -1] = stress[-1, 0] = tau
    traction = CF(tuple(stress.ravel()), dims=(dim, dim)) * specialcf.normal(dim)
    problem = ContactProblem(Material(mesh), Joint("mid", NormalCompliance(K), friction=CoulombFriction(coefficient)),
                             dirichlet={"bottom": (0,) * dim, "top": (top[0], *(0,) * (dim - 2), top[1])},
                             traction={Walls(dim): traction})
    return problem, u


def Balanced(solution, tol=1e-11, *, parts=MODULI):
    """Every element of discontinuous methods, the whole, and every part: tractions on all its boundaries and on the joint."""
    size = np.abs(solution.Force("top")).max()
    elements = not solution.disc.method.discontinuous or np.abs(solution.ElementImbalance()).max() < tol
    return elements and solution.GlobalImbalance() < tol and all(
        np.abs(solution.Force(".*", material=name)).max() < tol * size for name in parts)


def Sheet(turn=0, path=LINE):
    """The unit square of one material with a path named "mid" in it."""
    return Crossed({"mid": [path]}, turn=turn)
