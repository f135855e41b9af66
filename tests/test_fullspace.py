"""Newton's equations on the whole body: the same answer as with exact products with S_D."""

import numpy as np
import pytest

from ngdgc import Discretization, InteriorPenalty
from ngdgc.atlas import Point
from ngdgc.compliance import Apply, Compliance
from ngdgc.solvers.fullspace import FullSpace, Gmres
from ngdgc.solvers.recycling import Recycled
from ngdgc.solvers.stiffness import BodyStiffness


@pytest.mark.parametrize("steps, solved", [(12, True), (4, False)])
def test_gmres_solves_an_unsymmetric_system_in_as_many_steps_as_unknowns(steps, solved):
    """Fewer leave the best there is: a residual that no multiple of a direction lowers."""
    random = np.random.default_rng(0)
    matrix, right = np.eye(12) + 0.5 * random.standard_normal((12, 12)), random.standard_normal(12)
    x, taken = Gmres(lambda v: matrix @ v, right, 1e-10, steps)
    residual = right - matrix @ x
    assert taken <= steps and (np.linalg.norm(residual) < 1e-9) == solved
    krylov = [right]
    for _ in range(taken - 1):
        krylov.append(matrix @ krylov[-1])
    assert max(abs(residual @ (matrix @ v)) / np.linalg.norm(matrix @ v) for v in krylov) < 1e-9


def Equation(seed=0, stiff=True):
    """A Discretization that is iterated, D or None, and P, B at the points, unsymmetric."""
    disc = Discretization(Point(problem="box", n=3).contactproblem, InteriorPenalty(), Point(problem="box", n=3).Mesh(),
                          inverse="iterative")
    random, (n, dim) = np.random.default_rng(seed), disc.contact.normals.shape
    scale = BodyStiffness(disc)[:, None, None]
    unit = np.eye(dim) + 0.2 * random.standard_normal((n, dim, dim))
    return disc, scale * np.eye(dim) if stiff else None, 0.3 * scale * unit, 0.2 / scale * np.eye(dim)


@pytest.mark.parametrize("stiff", [True, False])
def test_both_unknowns_solve_the_equation_with_exact_products(stiff):
    """s + P (S_D - B) s = b, and the image is S_D s; another P gives another s."""
    disc, stiffness, P, B = Equation(stiff=stiff)
    b = BodyStiffness(disc)[:, None] * np.random.default_rng(1).standard_normal(disc.contact.normals.shape)
    compliance, weights = Compliance(disc, stiffness), disc.contact.weights

    def Local(image, s):
        return Apply(P, image - Apply(B, s))

    whole = FullSpace(compliance, weights)
    s, image = whole.Solve(Local, b, tol=1e-9, maxiter=200)
    exact, response = Recycled(compliance, weights).Solve(Local, b, tol=1e-10, maxiter=200)
    assert np.abs(s - exact).max() < 1e-6 * np.abs(exact).max() and 5 < whole.iterations < 200
    assert np.abs(image - response).max() < 1e-6 * np.abs(response).max()
    assert disc.contact.Displacement(whole.displacement) == pytest.approx(image, abs=1e-12 * np.abs(image).max())
    loose, _ = FullSpace(compliance, weights).Solve(Local, b, tol=0.1, maxiter=200)
    assert np.abs(loose - exact).max() > 1e-6 * np.abs(exact).max()
    other, _ = whole.Solve(lambda image, s: 2 * Local(image, s), b, tol=1e-9, maxiter=200)
    assert np.abs(other - exact).max() > 1e-2 * np.abs(exact).max()


def test_nothing_to_solve():
    disc, stiffness, P, _ = Equation()
    whole = FullSpace(Compliance(disc, stiffness), disc.contact.weights)
    s, image = whole.Solve(lambda image, s: Apply(P, image), np.zeros_like(disc.contact.normals), tol=1e-2, maxiter=20)
    assert not np.any(s) and not np.any(image) and not np.any(whole.displacement) and whole.iterations == 0


def test_an_iterated_equilibrium_makes_up_for_what_the_one_before_lacks():
    """Each is left inexact, the same one again comes closer, and `Exact` is; also where there is nothing to carry."""
    disc, stiffness, *_ = Equation()
    compliance, n = Compliance(disc, stiffness), disc.contact.normals
    exact = Compliance(Discretization(disc.problem, disc.method, disc.mesh, inverse="sparsecholesky"), stiffness).Meet(n, n)[0]
    first, *_ = compliance.Meet(n, n)
    last = compliance.Exact(n, n, compliance.Meet(n, n, near=first)[0])
    errors = [np.abs(one.vector - exact.vector).max() / np.abs(exact.vector).max() for one in (first, last)]
    assert errors[1] < 1e-8 < errors[0] < 1e-2
    disc.loads = {}
    unloaded, *_ = compliance.Meet(0 * n, 0 * n, near=compliance.Meet(0 * n, 0 * n)[0])
    assert np.abs(unloaded.vector).max() == 0
