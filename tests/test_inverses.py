"""What solves the linear equations."""

import numpy as np
import pytest

from ngdgc import LDG, Discretization, InteriorPenalty, ProblemError, inverses
from ngdgc.atlas import Point
from ngdgc.methods import NonsymmetricInteriorPenalty


def Disc(method=None, inverse="auto"):
    point = Point(n=4)
    return Discretization(point.contactproblem, method or InteriorPenalty(), point.Mesh(), inverse=inverse)


def test_all_inverses_solve_the_same_problem():
    first, second = Disc().Solve(), Disc(inverse="umfpack").Solve()
    assert (first.disc.inversekind, second.disc.inversekind) == ("sparsecholesky", "umfpack")
    assert np.abs(first.vector - second.vector).max() < 1e-11 < np.abs(first.vector).max()


def test_the_choice_follows_symmetry_and_what_is_installed(monkeypatch):
    assert Disc(NonsymmetricInteriorPenalty()).inversekind == "umfpack"
    monkeypatch.setattr(inverses, "HasPardiso", lambda: True)
    assert Disc().inversekind == "pardisospd" and Disc(NonsymmetricInteriorPenalty()).inversekind == "umfpack"
    monkeypatch.setattr(inverses, "HasPardiso", lambda: False)
    assert Disc().inversekind == "sparsecholesky"


def test_a_choice_that_cannot_be_names_the_remedy(monkeypatch):
    monkeypatch.setattr(inverses, "HasPardiso", lambda: False)
    with pytest.raises(ProblemError, match=r"pip install ngdgc\[mkl\]"):
        Disc(LDG(), "pardisospd").Solve()
    with pytest.raises(ProblemError, match="inverse is 'lu'; choose auto, sparsecholesky"):
        Disc(LDG(), "lu").Solve()
    with pytest.raises(ProblemError, match="is for symmetric matrices, and this form is not; take inverse='auto'"):
        Disc(NonsymmetricInteriorPenalty(), "sparsecholesky").Solve()
