"""What solves the linear equations."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import psutil
import pytest
from ngsolve import CF

from ngdgc import (LDG, Conforming, ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NonsymmetricInteriorPenalty, NormalCompliance, ProblemError)
from ngdgc.linear import choice as inverses
from ngdgc.studies.atlas.solvers import Point
from ngdgc.meshes import BoxMesh


def Disc(method=None, inverse="auto"):
    point = Point(n=4)
    return Discretization(point.contactproblem, method or InteriorPenalty(), point.Mesh(), inverse=inverse)


def test_all_inverses_solve_the_same_problem():
    first, second = Disc().Solve(), Disc(inverse="umfpack").Solve()
    assert (first.disc.inversekind, second.disc.inversekind) == ("sparsecholesky", "umfpack")
    assert np.abs(first.vector - second.vector).max() < 1e-11 < np.abs(first.vector).max()
    assert "linear solves by umfpack" in second.Report() and "by sparsecholesky" in first.Report()


def test_the_choice_follows_symmetry_and_what_is_installed(monkeypatch):
    assert Disc(NonsymmetricInteriorPenalty()).inversekind == "umfpack"
    monkeypatch.setattr(inverses, "HasPardiso", lambda: True)
    # In 2D MKL's takes longer, and more memory.
    assert Solid().inversekind == "pardisospd" and Disc().inversekind == "sparsecholesky"
    assert Disc(NonsymmetricInteriorPenalty()).inversekind == "umfpack"
    monkeypatch.setattr(inverses, "HasPardiso", lambda: False)
    assert Solid().inversekind == "sparsecholesky"


def Solid(nu=0.3, inverse="auto", method=None, cells="tet"):
    point = Point(problem="box", n=2)
    problem = replace(point.contactproblem, material=HookeMaterial(E=1000, nu=nu))
    return Discretization(problem, method or InteriorPenalty(), BoxMesh(2, cells=cells), inverse=inverse)


def test_large_solids_are_iterated_and_larger_ones_if_they_are_nearly_incompressible(monkeypatch):
    monkeypatch.setattr(inverses, "HasPardiso", lambda: False)
    assert Solid().inversekind == "sparsecholesky"
    monkeypatch.setattr(inverses, "LARGE", 1e5)
    assert Solid().inversekind == "iterative" and Solid(nu=0.42).inversekind == "iterative"
    assert Solid(nu=0.44).inversekind == "sparsecholesky" and Solid(nu=0.499).inversekind == "sparsecholesky"
    assert Solid(method=Conforming()).inversekind == "sparsecholesky" and Disc().inversekind == "sparsecholesky"
    monkeypatch.setattr(inverses, "HUGE", 1e5)
    assert Solid(nu=0.44).inversekind == "iterative" and Solid(nu=0.499).inversekind == "iterative"
    # On other cells than simplices there are no levels for that.
    assert Solid(nu=0.44, cells="hex").inversekind == "iterative"
    assert Solid(nu=0.46, cells="hex").inversekind == "sparsecholesky"
    assert inverses.Swelling(Solid().problem.material, Solid().mesh) == pytest.approx(1 + 1.5 * 2 * 0.3 / 0.4)


@pytest.mark.parametrize("nu", [0.3, 0.499])
def test_a_nearly_incompressible_solid_is_iterated_to_the_solution_of_a_factorisation(nu):
    direct, iterated = (Solid(nu=nu, inverse=inverse).Solve(coarser=()) for inverse in ("sparsecholesky", "iterative"))
    # A residual of 1e-10 says the less of the displacement the larger lam is.
    error = 1e-8 / (1 - 2 * nu)
    assert np.abs(direct.displacement - iterated.displacement).max() < error * np.abs(direct.displacement).max()
    assert np.abs(Solid(nu=0.4).Solve(coarser=()).displacement - direct.displacement).max() > (
        1e-3 * np.abs(direct.displacement).max())


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [1.0, 1e3, 1e7])
@pytest.mark.parametrize("order", [1, 2])
def test_iterated_solutions_are_those_of_a_factorisation(stiffness, order):
    """In displacement and traction, with friction that matters: half the coefficient is another solution."""
    def Solved(inverse, coefficient=0.3):
        point = Point(problem="box", n=3, stiffness=stiffness, coefficient=coefficient)
        return Discretization(point.contactproblem, InteriorPenalty(), point.Mesh(), order=order, inverse=inverse).Solve()

    direct, iterated, half = Solved("sparsecholesky"), Solved("iterative"), Solved("sparsecholesky", 0.15)
    assert iterated.disc.inversekind == "iterative" and iterated.history[-1].residual <= 1e-10
    for name in ("displacement", "traction"):
        ours, theirs, other = (getattr(one, name) for one in (iterated, direct, half))
        assert np.abs(ours - theirs).max() < 1e-7 * np.abs(theirs).max()
        assert np.abs(other - theirs).max() > 1e-4 * np.abs(theirs).max()


def test_a_body_that_only_its_foundation_holds_is_iterated():
    side = {"roller": {"left": 0, "front": 0}, "traction": {"top": CF((0, 0, -1))}}
    problem = ContactProblem(HookeMaterial(E=100, nu=0.3), Foundation("bottom", NormalCompliance(50)), **side)
    solution = Discretization(problem, InteriorPenalty(), BoxMesh(3), inverse="iterative").Solve()
    assert solution.normalforce == pytest.approx(1, rel=1e-9)


def test_what_does_not_fit_is_refused_before_it_is_begun(monkeypatch):
    """By an estimate that is right for what can be factorised."""
    memory = SimpleNamespace(available=1e4)
    monkeypatch.setattr(psutil, "virtual_memory", lambda: memory)
    with pytest.raises(ProblemError, match="of 576 unknowns would take about .* GB.*take inverse='iterative', a coarser mesh"):
        Solid().Solve(coarser=())
    with pytest.raises(ProblemError, match="take a discontinuous method with inverse='iterative'"):
        Solid(method=Conforming()).Solve(coarser=())
    with pytest.raises(ProblemError, match="of 342 unknowns would take about .* GB.*take a smaller foundation, a coarser mesh"):
        Solid(inverse="iterative").Solve(coarser=())
    memory.available = 1e6      # enough for the subspace alone
    with pytest.raises(ProblemError, match="of 576 unknowns"):
        Solid().Solve(coarser=())
    assert Solid(inverse="iterative").Solve(coarser=()).converged
    memory.available = 1e9
    assert Solid().Solve(coarser=()).converged


def test_a_choice_that_cannot_be_names_the_remedy(monkeypatch):
    monkeypatch.setattr(inverses, "HasPardiso", lambda: False)
    with pytest.raises(ProblemError, match=r"needs the library MKL and NGSolve .*pip install .*ngdgc\[mkl\]"):
        Disc(LDG(), "pardisospd").Solve()
    with pytest.raises(ProblemError, match="inverse is 'lu'; choose auto, sparsecholesky"):
        Disc(LDG(), "lu").Solve()
    with pytest.raises(ProblemError, match="is for symmetric matrices, and this form is not; take inverse='auto'"):
        Disc(NonsymmetricInteriorPenalty(), "sparsecholesky").Solve()
