"""Problems of the tests, the methods that they are solved with, and solutions."""

from itertools import pairwise

from ngsolve import CF, IfPos, x, y

from ngdgc import (LDG, AnisotropicMaterial, BassiEtAl, BrezziEtAl, Conforming, ContactProblem, CoulombFriction, Discretization,
                   Foundation, HookeMaterial, InteriorPenalty, NestedNewtonSolver, NormalCompliance, PenaltyFreeLDG,
                   SemismoothNewtonSolver, TrescaFriction)
from ngdgc.cases import example_4_1, example_4_2

METHODS = [InteriorPenalty(), InteriorPenalty(penalty=30), Conforming()]
ROWS = (InteriorPenalty, BassiEtAl, BrezziEtAl, LDG)
TEN = [row(form=form) for row in (*ROWS, PenaltyFreeLDG) for form in ("edge", "lifting")]


def Example(stiffness=450.0, *, plane="strain", friction=1.0, **replacements):
    """Example 4.1 with some data replaced."""
    arguments = {"material": HookeMaterial(E=2000, nu=0.4, plane=plane),
                 "foundation": Foundation("bottom", NormalCompliance(stiffness), friction=TrescaFriction(friction), gap=0.05),
                 "dirichlet": {"right": CF((0, 0))}, "traction": {"left": CF((200 * (5 - y), -190))}, **replacements}
    return ContactProblem(**arguments)


def Pressed(foundation, mesh, u=(0.03, -0.05), *, method=InteriorPenalty(), order=1):
    """The solution of a block, E = 1000, nu = 0.3, pressed on its foundation by the displacement of its top."""
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, dirichlet={"top": CF(u)})
    return NestedNewtonSolver().Solve(Discretization(problem, method, mesh, order=order))


OPEN = Foundation("bottom", NormalCompliance(1.0), gap=100.0)
ORTHOTROPIC = AnisotropicMaterial([[300, 80, 20], [80, 150, -10], [20, -10, 60]])
GRADED = HookeMaterial(mu=50 * (1 + x + 2 * y), lam=80 * (2 - x * y))


def Loaded(mesh, **changes):
    """Supports, a roller, contact with friction, and a body force; the rest of the boundary is free."""
    dim, solid = mesh.dim, (0.01,) * (mesh.dim - 2)
    foundation = Foundation("bottom", NormalCompliance(100), friction=CoulombFriction(0.3))
    data = {"dirichlet": {"top": (0.05, *solid, -0.1), "left": (0.02, *solid, -0.05)}, "roller": {"right": -0.01},
            "bodyforce": (1, 2, -5)[3 - dim:]}
    return ContactProblem(HookeMaterial(E=200, nu=0.3), foundation, **(data | changes))


def Solved(problem, method, mesh, order=2, assembly="facet"):
    return SemismoothNewtonSolver(tol=1e-11).Solve(Discretization(problem, method, mesh, order=order, assembly=assembly))


FOUNDATION = Foundation("bottom", NormalCompliance(1.0))


def Held(dim=2, **material):
    """A body held on the right."""
    return ContactProblem(HookeMaterial(**(material or {"mu": 1.0, "lam": 4.0})), FOUNDATION,
                          dirichlet={"right": CF((0,) * dim)})


CASES = {"4.1": example_4_1, "4.2": example_4_2}


def Adjustable(*, E=1000.0, nu=0.3, k=300.0, exponent=1.0, mu=0.4, gap=0.01, top=-0.03, side=0.002, pull=2.0, weight=-3.0):
    """Supports, roller, traction, body force, foundation: every datum a number that can be changed a little."""
    foundation = Foundation("bottom", NormalCompliance(k, exponent), friction=CoulombFriction(mu), gap=gap * x)
    return ContactProblem(HookeMaterial(E=E, nu=nu), foundation, dirichlet={"top": CF((0.01, top))}, roller={"left": side},
                          traction={"right": CF((pull * y, 0.5))}, bodyforce=CF((0, weight)))


REGIONS = {"hole": "hole", "quarter": "inner|outer", "csg": "rim", "hex": "bottom", "prism": "bottom", "quad": "bottom",
           "names": r"a .ring.\nof.*"}


def Resting(name):
    """A body that starts 0.01 inside a foundation around it, or under a top that is pressed down."""
    size, dim = 1e-9 if name == "tiny" else 1, 3 if name.startswith("solid") or name in ("csg", "hex", "prism") else 2
    flat = name in ("hex", "prism", "quad", "names", "tiny")
    push = (0.003 * size,) * (dim - 1) + (-0.02 * size,)
    foundation = Foundation(REGIONS.get(name, "ring"), NormalCompliance(1000 / size), friction=TrescaFriction(1),
                            gap=-0.01 * size)
    return ContactProblem(HookeMaterial(E=100, nu=0.3), foundation, dirichlet={"top": push} if flat else None)


def Along(t, values):
    """The piecewise linear function of t with these values at 0, 1, 2, ..."""
    found = values[-1]
    for number, (a, b) in reversed(list(enumerate(pairwise(values)))):
        found = IfPos(number + 1 - t, a + (t - number) * (b - a), found)
    return found
