"""The paper's examples on foundations of any stiffness, and the iterations that solve them."""

from dataclasses import replace


from problems import METHODS

from ngdgc import Discretization, NormalCompliance, UzawaSolver
from ngdgc.cases import example_4_1, example_4_2

IMPLICIT = {"plain": UzawaSolver(normal="implicit"),
            "adaptive": UzawaSolver(normal="implicit", rho="adaptive"),
            "anderson": UzawaSolver(normal="implicit", acceleration="anderson")}
FAST = [IMPLICIT["adaptive"], IMPLICIT["anderson"]]
EXAMPLES = {"4.1": (example_4_1, 2000), "4.2": (example_4_2, 2500)}


def Stiff(name, ratio, friction, *, n=8, method=METHODS[0]):
    """An example with k_n = ratio E and its own or Coulomb's friction."""
    case, modulus = EXAMPLES[name]
    problem = case.Problem("strain")
    foundation = replace(problem.foundation[0], compliance=NormalCompliance(ratio * modulus), friction=friction)
    return Discretization(replace(problem, foundation=foundation), method, case.Mesh(n), order=1)
