"""Laws of users that return nonsense are named, and those that are right may be written as they like."""

import time

import numpy as np
import pytest

from ngdgc import (ComplianceLaw, Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, FrictionLaw,
                   HookeMaterial, InteriorPenalty, NestedNewtonSolver, NormalCompliance, ProblemError, SemismoothNewtonSolver,
                   Solve, UzawaSolver)
from ngdgc.problem.laws import LawAt
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.problem.userlaws import UserLaw, Watched


COULOMB = CoulombFriction(0.3)


def Disc(law, friction=COULOMB, *, method=None, dim=2, depth=0.1):
    mesh = RectangleMesh(6, upper=(2, 1)) if dim == 2 else BoxMesh(2)
    top = (0.05, -depth) if dim == 2 else (0.05, 0.01, -depth)
    problem = ContactProblem(HookeMaterial(E=2000, nu=0.3), Foundation("bottom", law, friction=friction, gap=0.02),
                             dirichlet={"top": top})
    return Discretization(problem, method or InteriorPenalty(), mesh, order=1)


class Own(ComplianceLaw):
    """p_n = 300 r_+, changed by a function of (r, p)."""

    def __init__(self, Change=lambda r, p: p, Derivative=lambda r: 300.0 * (r > 0)):
        self.Change, self.Derivative = Change, Derivative

    def Pressure(self, r):
        return self.Change(r, 300 * np.maximum(r, 0))

    def PressureDerivative(self, r):
        return self.Derivative(r)


class InPlace(ComplianceLaw):
    """Works on the array that it is given, and returns one array again and again."""

    def Pressure(self, r):
        r *= r > 0
        r *= 300
        return r

    def PressureDerivative(self, r):
        np.greater(r, 0, out=r)
        r *= 300
        return r


class OwnFriction(FrictionLaw):
    def __init__(self, Bound=lambda r, p: 0.3 * p, **methods):
        self.Own = Bound
        vars(self).update(methods)

    def Bound(self, r, p):
        return self.Own(r, p)


@pytest.mark.parametrize("law, friction, words", [
    (Own(lambda r, p: p * (1 + 1j)), None, "Own.Pressure returns complex values"),
    (Own(lambda r, p: list(p)), None, "Own.Pressure returns a list"),
    (Own(lambda r, p: None), None, "Own.Pressure returns a NoneType"),
    (Own(lambda r, p: p[:, None]), None, r"Own.Pressure returns shape \(1, 1\)"),
    (Own(lambda r, p: p["r"]), None, "Own.Pressure raises IndexError"),
    (Own(Derivative=lambda r: list(r)), None, "Own.PressureDerivative returns a list"),
    (Own(lambda r, p: np.where(r > -0.5, p, np.nan)), None, "Own on the foundation .* not zero at penetration -1, but nan"),
    (Own(lambda r, p: p.astype(np.float32)), None, "Own.Pressure returns float32"),
    (Own(lambda r, p: np.mean(p)), None, "Own.Pressure gives another value at a point alone"),
    (Own(lambda r, p, calls=[1]: calls.append(1) or p * (1 + 1e-3 * len(calls))), None, "when it is asked again"),
    (Own(), OwnFriction(lambda r, p: 0.3 * np.sort(p)[::-1]), "OwnFriction.Bound gives another value at a point alone"),
    (Own(), OwnFriction(Coefficient=lambda s: (0.0 * s + len(s), 0 * s)), "OwnFriction.Coefficient gives another value"),
    (Own(), OwnFriction(lambda r, p: p * 1j), "OwnFriction.Bound returns complex values"),
    (Own(), OwnFriction(lambda r, p: p.astype(str)), "OwnFriction.Bound returns an array of shape .* and type"),
    (Own(), OwnFriction(BoundDerivatives=lambda r, p: p), "OwnFriction.BoundDerivatives returns an array .* give the pair"),
    (Own(), OwnFriction(BoundDerivatives=lambda r, p: (p, list(r))), "OwnFriction.BoundDerivatives returns a list"),
    (Own(), OwnFriction(Coefficient=lambda s: [s]), "OwnFriction.Coefficient returns a list; give the pair"),
    (Own(), OwnFriction(Coefficient=lambda s: (1 + 0j * s, 0 * s)), "OwnFriction.Coefficient returns complex values")])
def test_what_a_law_must_not_return_is_named_when_the_foundation_is_made(law, friction, words):
    with pytest.raises(ProblemError, match=words):
        Foundation("bottom", law, friction=friction)
    Foundation("bottom", Own(), friction=OwnFriction())     # control: without the mistake


@pytest.mark.slow
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("method", [InteriorPenalty(), Conforming()], ids=["ip", "h1"])
@pytest.mark.parametrize("solver", [NestedNewtonSolver(), SemismoothNewtonSolver(), UzawaSolver(normal="implicit", tol=1e-4)],
                         ids=["nested", "newton", "uzawa"])
def test_a_law_that_ends_before_the_solution_is_named_with_the_penetration(solver, method, dim):
    """NaN above r = .01, where the body is pressed much deeper: in seconds, and neither friction nor round-off is blamed."""
    disc, start = Disc(Own(lambda r, p: np.where(r > 0.01, np.nan, p)), method=method, dim=dim), time.perf_counter()
    with pytest.raises(ProblemError, match="Own.Pressure is not finite beyond penetration 0.01, and more would be needed"):
        solver.Solve(disc)
    assert time.perf_counter() - start < 10


def test_a_law_that_ends_beyond_the_solution_is_right():
    """Also where iterations pass its end: the response without foundation lies at r = .08."""
    expected = Solve(Disc(NormalCompliance(300)))
    deepest = expected.penetration.max()
    assert 0.0747 < deepest < 0.08 - 1e-3
    found = Solve(Disc(Own(lambda r, p: np.where(r > 1.01 * deepest, np.nan, p))))
    assert found.pressure == pytest.approx(expected.pressure, abs=1e-8 * expected.pressure.max())
    with pytest.raises(ProblemError, match="not finite beyond"):        # control: it ends just before the solution
        Solve(Disc(Own(lambda r, p: np.where(r > 0.99 * deepest, np.nan, p))))


@pytest.mark.parametrize("law, friction, words", [
    (Own(Derivative=lambda r: np.where(r > 0.03, np.nan, 300.0 * (r > 0))), None,
     "Own.PressureDerivative is nan at penetration 0.0"),
    (Own(), OwnFriction(lambda r, p: np.where(r > 0.02, np.nan, 0.3 * p)), "OwnFriction.Bound is nan at penetration 0.0"),
    (Own(lambda r, p: np.where(r > 0, np.nan, p)), None, "Own.Pressure is nan at penetration 0.0"),
    (Own(), OwnFriction(BoundDerivatives=lambda r, p: (0 * r, np.where(p > 9, np.nan, 0.3))),
     "OwnFriction.BoundDerivatives is nan at penetration 0.0")])
def test_values_that_are_no_numbers_where_the_solution_lies_are_named(law, friction, words):
    with pytest.raises(ProblemError, match=words):
        Solve(Disc(law, friction))


def test_who_is_not_finite_is_named_by_every_solver():
    """The pressure of a penetration without one, and not the friction law that is made of it, nor the bound for its factor."""
    holes = OwnFriction(Coefficient=lambda s: (np.where((s > 0.0317) & (s < 0.0562), np.nan, 1), 0 * s))
    for disc, words in ((Disc(Own(lambda r, p: np.where(r > 0.03, np.nan, p))), "^Own.Pressure is nan at penetration"),
                        (Disc(Own(), holes), "^OwnFriction.Coefficient is nan at slip 0.0"),
                        (Disc(Own(), OwnFriction(lambda r, p: np.where(r > 0.03, np.nan, p))), "^OwnFriction.Bound is nan")):
        with pytest.raises(ProblemError, match=words):
            UzawaSolver().Solve(disc)


def test_laws_may_work_in_place_and_return_integers_or_numbers():
    expected = Solve(Disc(NormalCompliance(300))).traction
    for law in (InPlace(), Own(), Own(Derivative=lambda r: 300 * (r > 0)), Own(Derivative=lambda r: 300)):
        assert Solve(Disc(law)).traction == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())
    # Control: without copies the law would spoil the penetrations of whoever asks.
    r = np.array([-1.0, 2.0])
    assert list(UserLaw(InPlace()).Pressure(r)) == [0, 600] and list(r) == [-1, 2]
    assert list(InPlace().Pressure(r)) == [0, 600] == list(r)


def test_the_laws_of_the_package_are_called_as_they_are():
    law = NormalCompliance(3)
    assert Watched(law) is law and LawAt(law, None) is law and Watched(None) is None

    class Derived(NormalCompliance):
        """Somebody's own."""

    assert isinstance(Watched(Derived(3)), UserLaw) and Watched(Derived(3)).stiffness == 3
    assert Watched(Watched(Derived(3))).Pressure(np.ones(2)).tolist() == [3, 3]
