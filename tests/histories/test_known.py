"""What a history knows of the compliance operator, against the operator itself as a matrix."""

import numpy as np
import pytest

from ngdgc.discrete.response import Apply
from ngdgc.histories import known as module
from ngdgc.histories.known import KnownResponse

N, DIM = 12, 2
rng = np.random.default_rng(7)
WEIGHTS = rng.uniform(0.5, 2, N)
ROOT = np.repeat(np.sqrt(WEIGHTS), DIM)


def Operator(void=0):
    """S in coordinates root s: symmetric, positive but on `void` tractions that it does not see, and ill conditioned."""
    vectors = np.linalg.qr(rng.normal(size=(N * DIM, N * DIM)))[0]
    return vectors * np.append(np.geomspace(1, 1e-3, N * DIM - void), np.zeros(void)) @ vectors.T


def Learnt(S, count, *, dense=True, monkeypatch=None, directions=None):
    """A KnownResponse of S that has learnt so many tractions, and the tractions."""
    if not dense:
        monkeypatch.setattr(module, "DENSE", 0)
    calls = []

    def Product(s):
        calls.append(s)
        return (S @ (ROOT * s.ravel()) / ROOT).reshape(s.shape)

    blocks = np.array([[[0.3, 0.05], [0.05, 0.2]]] * N)
    known = KnownResponse(Product, WEIGHTS, blocks)
    s = rng.normal(size=(count, N, DIM)) if directions is None else directions
    for direction in s:
        known.Learn(direction)
    assert len(calls) == len(s)
    return known, s


def Matrix(known):
    """S_V in coordinates root s."""
    units = np.eye(N * DIM) / ROOT
    return np.array([ROOT * known.Times(unit.reshape(N, DIM)).ravel() for unit in units]).T


@pytest.mark.parametrize("dense", [True, False])
@pytest.mark.parametrize("void", [0, 3])
def test_guess_is_the_operator_on_what_is_learnt_and_symmetric_and_positive_elsewhere(dense, void, monkeypatch):
    S = Operator(void)
    known, s = Learnt(S, 9, dense=dense, monkeypatch=monkeypatch)
    guess, learnt = Matrix(known), (ROOT * s.reshape(9, -1)).T
    # Round-off times the condition, 1e3.
    assert np.abs(guess @ learnt - S @ learnt).max() < 1e-12 * np.abs(learnt).max()
    assert np.abs(guess - guess.T).max() < 1e-13 and np.linalg.eigvalsh(guess)[0] > -1e-13
    assert np.abs(guess - S).max() > 1e-2       # control: not known elsewhere
    rest = known.Outside(rng.normal(size=(N, DIM)))
    assert np.abs(learnt.T @ S @ (ROOT * rest.ravel())).max() < 1e-12
    assert max(np.abs(known.Outside(direction)).max() for direction in s) < 1e-11


@pytest.mark.parametrize("void", [0, 3])
def test_all_is_known_after_as_many_tractions_as_there_are(void):
    """Also if some are seen by no displacement: there S_V is 0, as S."""
    S = Operator(void)
    known, _ = Learnt(S, N * DIM - 1)
    assert not known.complete
    known.Learn(known.Outside(rng.normal(size=(N, DIM))))
    assert known.complete and np.abs(Matrix(known) - S).max() < 1e-10


def test_nearly_the_same_traction_tells_what_is_new_in_it():
    """Differences of 1e-7, of which one orthogonalisation would leave 1e-9 of round-off: S_V stays S on all of them."""
    S = Operator()
    first = rng.normal(size=(N, DIM))
    near = np.array([first] + [first + 1e-7 * rng.normal(size=(N, DIM)) for _ in range(8)])
    known, _ = Learnt(S, 0, directions=near)
    basis = np.linalg.svd(ROOT * near.reshape(9, -1), full_matrices=False)[2]
    assert np.abs(known.V.T @ known.Y - np.eye(9)).max() < 1e-11
    # Of the difference of two near ones 1e-9 of the digits are left.
    assert np.abs(Matrix(known) @ basis.T - S @ basis.T).max() < 1e-7


@pytest.mark.parametrize("dense", [True, False])
@pytest.mark.parametrize("still, void, count", [(True, 0, 7), (False, 0, 7), (False, 3, N * DIM - 1)])
def test_small_equations_are_those_of_the_guess(dense, still, void, count, monkeypatch):
    """local x + S_V shifted x = b, also where the rows of `shifted` vanish, against one matrix: round-off."""
    known, _ = Learnt(Operator(void), count, dense=dense, monkeypatch=monkeypatch)
    local = np.eye(DIM) + 0.1 * rng.normal(size=(N, DIM, DIM))
    shifted = 0.5 * np.eye(DIM) + 0.1 * rng.normal(size=(N, DIM, DIM))
    if still:
        shifted[:, 1], shifted[3] = 0, 0
    b = rng.normal(size=(N, DIM))
    x = known.Solve(local, shifted, b)
    # Where the last tractions are nearly void their products have lost some digits.
    assert np.abs(Apply(local, x) + known.Times(Apply(shifted, x)) - b).max() < (1e-7 if void else 1e-12)
    assert np.all(np.isnan(known.Solve(0 * local, 0 * shifted, b)))


def test_learning_tells_how_far_the_guess_was_off():
    known, _ = Learnt(Operator(), 0)
    s = rng.normal(size=(N, DIM))
    guess = known.Times(s)
    off = known.Learn(s)
    change = ROOT * (known.Times(s) - guess).ravel()
    assert off == pytest.approx(np.linalg.norm(change) / np.linalg.norm(ROOT * guess.ravel()))
