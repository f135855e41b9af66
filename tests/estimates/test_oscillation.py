"""What of the loads the polynomials of the order do not contain, against projections of the loads."""

import numpy as np
import pytest
from ngsolve import CF, GridFunction, InnerProduct, Integrate, VectorL2, dx, exp, y
from problems import Solved

from ngdgc import LDG, ContactProblem, EstimateError, Foundation, HookeMaterial, NormalCompliance
from ngdgc.meshes import BoxMesh, RectangleMesh

MU = 2.0


def Data(mesh, order, **loads):
    """The squares of the data's part, (elements,) summed, of a body that is loaded."""
    problem = ContactProblem(HookeMaterial(mu=MU, lam=3), Foundation("bottom", NormalCompliance(1)),
                             dirichlet={"top": CF((0,) * mesh.dim)}, **loads)
    return EstimateError(Solved(problem, LDG(), mesh, order)).parts["data"] ** 2


@pytest.mark.parametrize("cells, order", [("triangle", 1), ("triangle", 3), ("quad", 2), ("tet", 1)])
def test_body_forces_count_with_the_poincare_constant(cells, order):
    """f_1 + div s is f_1 minus its L2 projection on V_h; all elements have the diameter h, convex ones the constant h/pi."""
    mesh = BoxMesh(2) if cells == "tet" else RectangleMesh(3, cells=cells)
    force = CF((*[CF(0)] * (mesh.dim - 1), 5 * y ** (order + 1)))
    nearest = GridFunction(VectorL2(mesh, order=order))
    nearest.Set(force, bonus_intorder=4)
    rest = Integrate(InnerProduct(force - nearest, force - nearest) * dx(bonus_intorder=4), mesh)
    diameter = np.sqrt(3) / 2 if cells == "tet" else np.sqrt(2) / 3
    expected = (diameter / (np.pi * (order + 1))) ** 2 / (2 * MU) * rest
    # A polynomial of the next degree: no quadrature misses of it.
    assert Data(mesh, order, bodyforce=force) == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("roller", [False, True])
def test_tractions_count_on_their_sides_and_on_rollers_along_them(order, roller):
    """h/(2 mu (k + 1)) of the square of f_2 minus its L2 projection on polynomials of degree k along every side."""
    n = 3
    nodes, weights = np.polynomial.legendre.leggauss(12)
    rest = 0.0
    for number in range(n):
        places = (number + (1 + nodes) / 2) / n
        value, basis = np.exp(3 * places), np.polynomial.legendre.legvander(nodes, order)
        fit = np.polynomial.legendre.legval(nodes, (basis * weights[:, None]).T @ value * (np.arange(order + 1) + 0.5))
        rest += weights @ (value - fit) ** 2 / (2 * n)
    load = {"traction": {"left": CF((0, exp(3 * y)))}} | ({"roller": {"left": 0.1}} if roller else {})
    assert Data(RectangleMesh(n), order, **load) == pytest.approx(rest / (n * 2 * MU * (order + 1)), rel=1e-6)
