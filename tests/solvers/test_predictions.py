"""What is tried where a prediction does not lead to the solution depends on the problem, not on how long it takes."""

import time
from itertools import count
from types import SimpleNamespace

import numpy as np
import pytest
from mistakes import Disc
from scipy.spatial import cKDTree

from ngdgc import NotConvergedError
from ngdgc.solvers import nested

PREDICTION = ("displacement", "traction")


class Failing:
    """A solver that fails from every start but one kind, and notes what it was asked for."""

    def __init__(self, Good=lambda start: False):
        self.Good, self.starts = Good, []

    def Solve(self, disc, *, start, callback):
        self.starts.append("prediction" if start is PREDICTION else "rest" if start is None else "other")
        if self.Good(start):
            return SimpleNamespace(start=start)
        raise NotConvergedError(self.starts[-1], SimpleNamespace(history=[]))


def test_rest_follows_a_prediction_however_long_that_took(monkeypatch):
    hours = count(0, 3600)
    monkeypatch.setattr(time, "perf_counter", lambda: float(next(hours)))
    solver = Failing(lambda start: start is None)
    found, _ = nested.FromPrediction(solver, Disc(), PREDICTION, None)
    assert found.start is None and solver.starts == ["prediction", "rest"]


@pytest.mark.parametrize("unknowns, others", [(0, 5), (59_999, 5), (60_001, 4), (300_001, 0)])
def test_larger_problems_get_fewer_other_starts(unknowns, others, monkeypatch):
    disc = Disc()
    monkeypatch.setattr(nested, "UNKNOWNS", nested.UNKNOWNS * disc.space.ndof // unknowns if unknowns else 10 ** 9)
    solver = Failing()
    with pytest.raises(NotConvergedError, match="rest"):
        nested.FromPrediction(solver, disc, PREDICTION, None)
    assert solver.starts == ["prediction", "rest"] + others * ["other"]


@pytest.mark.parametrize("pairs", [nested.PAIRS, 0], ids=["computed", "tree"])
@pytest.mark.parametrize("dim", [2, 3])
def test_nearest_points(dim, pairs, monkeypatch):
    monkeypatch.setattr(nested, "PAIRS", pairs)
    points, targets = np.random.default_rng(1).random((3000, dim)), np.random.default_rng(2).random((30, dim))
    for most in (1, 4, 300):
        distances, nearest = nested.Nearest(points, targets, most)
        wanted, numbers = cKDTree(points).query(targets, k=np.arange(1, most + 1))
        assert np.array_equal(nearest, numbers) and np.allclose(distances, wanted, rtol=1e-15, atol=0)
