"""A body that is held, with few contact points and continuous laws, has a solution, and the path leads to it."""

import numpy as np
import pytest
from ngsolve import CF, L2, GridFunction, x, y
from ngsolve.meshes import MakeStructured2DMesh

from ngdgc import (Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, NormalCompliance,
                   NotConvergedError, SemismoothNewtonSolver, Solve)
from ngdgc.contact.stiffness import BodyStiffness
from ngdgc.discrete.response import ContactResponse
from ngdgc.solvers.newton.pathfollowing import Path
from ngdgc.solvers.newton.run import NewtonRun


def Strip():
    """Eighteen flat triangles, half of them a thousand times softer, pressed on four contact points with Coulomb's 0.7."""
    mesh = MakeStructured2DMesh(quads=False, nx=3, ny=3, mapping=lambda s, t: (s, 0.02 * t))
    modulus, soft = GridFunction(L2(mesh, order=0)), {0, 4, 7, 8, 9, 11, 14, 15, 16}
    modulus.vec.FV().NumPy()[:] = [2.928592606734367 if number in soft else 2928.592606734367 for number in range(mesh.ne)]
    motion = CF((0.032043408893408606 + 0.0024279086483539468 * x - 0.0085656472529131 * y,
                 0.0009843692026525884 + 0.00345956057767761 * x + 0.00120887919860908 * y))
    foundation = Foundation("right", NormalCompliance(1574.0402724175894), friction=CoulombFriction(0.7),
                            gap=0.006037913890034776)
    problem = ContactProblem(HookeMaterial(E=modulus, nu=0.0650645194016852), foundation, dirichlet={"left": motion},
                             bodyforce=(78.2079, -1.51539))
    return Discretization(problem, Conforming(), mesh, order=1)


def Bar(nx, seed):
    """A flat bar on its lower side, clamped at its left end, with random loads and friction up to 1.5."""
    rng = np.random.default_rng(seed)
    mesh = MakeStructured2DMesh(quads=True, nx=nx, ny=1, mapping=lambda s, t: (s, 0.1 * t))
    law, friction = NormalCompliance(10 ** rng.uniform(0, 4)), CoulombFriction(rng.uniform(0.3, 1.5))
    motion, weight = rng.uniform(-0.01, 0.01, 2), rng.uniform(-2, 2, 2)
    problem = ContactProblem(HookeMaterial(E=100, nu=0.3), Foundation("bottom", law, friction=friction),
                             dirichlet={"left": tuple(motion)}, bodyforce=tuple(weight))
    return Discretization(problem, Conforming(), mesh, order=1)


@pytest.mark.slow
def test_what_newton_cycles_on_is_solved_along_the_path(monkeypatch):
    """The value is that of a general root finder on the eight unknowns from forty random starts."""
    solution = SemismoothNewtonSolver().Solve(Strip())
    assert solution.normalforce == pytest.approx(0.765663, rel=1e-6) and list(solution.zones) == [1, 2, 1, 2]
    monkeypatch.setattr(NewtonRun, "AlongPath", lambda run, state, tol: None)
    with pytest.raises(NotConvergedError, match="given up at"):
        SemismoothNewtonSolver().Solve(Strip())


@pytest.mark.slow
@pytest.mark.parametrize("nx", [1, 3, 6])
def test_end_of_the_path_is_the_solution(nx):
    """The dense equation at s = 1 is that of the solver: one step of Newton's method is left, of round-off."""
    for seed in range(4):
        disc = Bar(nx, seed)
        point = Path(ContactResponse(disc), BodyStiffness(disc)).Follow()
        solution = SemismoothNewtonSolver().Solve(disc, start=(point.displacement, point.traction))
        assert len(solution.history) == 1
        assert np.abs(solution.displacement - point.displacement).max() < 1e-9 * np.abs(solution.displacement).max()


def test_a_path_turns_back_and_is_followed_nevertheless():
    """s falls somewhere along the path of the strip; without the orientation by the determinant it would be lost there."""
    disc, passed = Strip(), []
    path = Path(ContactResponse(disc), BodyStiffness(disc))
    Correct = path._Correct

    def Seen(z, normal):
        found = Correct(z, normal)
        passed.extend([] if found is None else [found[-1]])
        return found
    path._Correct = Seen
    assert path.Follow() is not None and min(np.diff(passed)) < -1e-3


def test_steps_are_limited():
    disc = Strip()
    assert Path(ContactResponse(disc), BodyStiffness(disc)).Follow(steps=0) is None
    assert Solve(disc).converged
