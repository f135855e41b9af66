"""What adaptive meshes save."""

import pytest

from ngdgc.cases import example_4_2
from ngdgc.studies import savings
from ngdgc.studies.savings import Rate, Saving, SavingCells, Savings


@pytest.mark.parametrize("dim", [2, 3])
def test_orders_are_of_unknowns(dim):
    """Errors that fall as N^(-p/d)."""
    assert Rate([(n, 7 * n ** (-3 / dim)) for n in (10, 40, 300, 1000)], dim) == pytest.approx(3, rel=1e-9)


@pytest.mark.slow
def test_a_saving_is_that_of_a_uniform_mesh_that_would_do(monkeypatch):
    monkeypatch.setattr(savings, "ROWS", (("4.2", example_4_2.Problem, example_4_2.Mesh, 4, 2, 0.1),))
    monkeypatch.setattr(savings, "SERIES", 1000)
    solved, Solved = [], savings._Solved

    def Kept(*arguments):
        solved.append(Solved(*arguments))
        return solved[-1]
    monkeypatch.setattr(savings, "_Solved", Kept)
    one, = Savings()
    *_, last = solved
    assert one.adaptive < one.uniform <= last.disc.space.ndof < 1.5 * one.uniform
    assert savings.EstimateError(last).relative == pytest.approx(0.1, rel=0.2) and one.seconds[1] > 0
    monkeypatch.setattr(savings, "SOLVED", 0)
    assert next(Savings()).seconds[1] is None


def test_what_was_not_solved_has_no_seconds():
    *_, row = SavingCells([Saving("cube", 2, 0.05, 3000, 2e6, (1.0, 0.8), (9.0, None))])
    assert row == ("cube", "2", "0.05", "3000", "2e+06", "0.50", "0.40", "9.0", "-")
