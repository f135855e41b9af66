"""Conjugate residuals that remember their products: M s = s + P (S - B) s = b, dense ones as a reference."""

import numpy as np
import pytest
from dense import DIM, Compliance, Dense, N

from ngdgc.solvers.newton.recycling import Recycled


def Blocks(seed):
    return np.random.default_rng(seed).standard_normal((N, DIM, DIM))


def Equation(blocks):
    """(Local, dense P): Local(y, s) = P (y - 0.1 s)."""
    def Local(image, s):
        return np.einsum("nij,nj->ni", blocks, image - 0.1 * s)

    dense = np.zeros((N * DIM, N * DIM))
    for i, block in enumerate(blocks):
        dense[DIM * i:DIM * (i + 1), DIM * i:DIM * (i + 1)] = block
    return Local, dense


def Matrix(S, blocks):
    return np.eye(N * DIM) + Equation(blocks)[1] @ (S - 0.1 * np.eye(N * DIM))


@pytest.fixture
def weights():
    return np.random.default_rng(7).uniform(0.1, 1, N)


def Relative(weights, residual, b):
    """Norms in L2(Gamma_C)."""
    root = np.sqrt(weights)[:, None]
    return np.linalg.norm(root * residual) / np.linalg.norm(root * b)


@pytest.mark.parametrize("tol", [1e-2, 1e-6, 1e-12])
def test_solves_a_dense_equation_to_the_tolerance_asked_for(weights, tol):
    """The residual is below tol in the weighted norm and the image belongs to s; a sloppy tolerance is no exact one."""
    S, blocks, b = Compliance(), Blocks(1), np.random.default_rng(2).standard_normal((N, DIM))
    dense = Dense(S)
    s, y = Recycled(dense, weights).Solve(Equation(blocks)[0], b, tol=tol, maxiter=100)
    residual = b - (Matrix(S, blocks) @ s.ravel()).reshape(b.shape)
    # 1e-13: round-off of combinations of products.
    assert Relative(weights, residual, b) <= tol + 1e-13 and dense.count <= N * DIM
    assert y.ravel() == pytest.approx(S @ s.ravel(), abs=1e-12 * np.abs(s).max())
    assert Relative(weights, residual, b) > 1e-8 or tol < 1e-2
    wrong = b - (Matrix(2 * S, blocks) @ s.ravel()).reshape(b.shape)
    assert Relative(weights, wrong, b) > 1e-2


def test_a_second_equation_with_other_blocks_costs_fewer_applications(weights):
    """Blocks that differ by a per cent, another right-hand side: a fraction of the products of a start without past."""
    S, b = Compliance(), np.random.default_rng(2).standard_normal((2, N, DIM))
    blocks = Blocks(1)
    nearby = blocks + 0.01 * Blocks(3)
    counts = []
    for first in (True, False):
        dense = Dense(S)
        recycled = Recycled(dense, weights)
        if first:
            recycled.Solve(Equation(blocks)[0], b[0], tol=1e-8, maxiter=100)
        before = dense.count
        s, _ = recycled.Solve(Equation(nearby)[0], b[0] + 1e-3 * b[1], tol=1e-4, maxiter=100)
        counts.append(dense.count - before)
        assert s.ravel() == pytest.approx(np.linalg.solve(Matrix(S, nearby), (b[0] + 1e-3 * b[1]).ravel()), rel=0.01, abs=5e-3)
    assert counts[0] <= 1 and counts[1] >= 5


def test_the_same_equation_again_costs_nothing(weights):
    """And products asked for elsewhere are as good; products with another S would not be."""
    S, blocks, b = Compliance(), Blocks(1), np.random.default_rng(2).standard_normal((N, DIM))
    dense = Dense(S)
    recycled = Recycled(dense, weights)
    recycled.Solve(Equation(blocks)[0], b, tol=1e-9, maxiter=100)
    before = dense.count
    recycled.Solve(Equation(blocks)[0], b, tol=1e-8, maxiter=100)
    assert dense.count == before
    known = Recycled(Dense(S), weights)
    solution = np.linalg.solve(Matrix(S, blocks), b.ravel()).reshape(b.shape)
    known.Remember(solution, known.response.Product(solution))
    known.Solve(Equation(blocks)[0], b, tol=1e-10, maxiter=100)
    assert known.response.count == 1


def test_products_serve_matrices_with_another_stiffness(weights):
    """(S^-1 + D)^-1 for two D: all products with one make those with the other; taken for the same D they do not."""
    S, blocks, b = Compliance(), Blocks(1), np.random.default_rng(2).standard_normal((N, DIM))
    first, other = Dense(S), Dense(S)
    for seed, dense in enumerate((first, other)):
        dense.stiffness = np.random.default_rng(seed).uniform(0, 20, N * DIM)
        dense.matrix = np.linalg.inv(np.linalg.inv(S) + np.diag(dense.stiffness))
    for told, fresh in ((other.stiffness, 0), (first.stiffness, 1)):
        recycled = Recycled(first, weights)
        for unit in np.eye(N * DIM):
            recycled.Remember(unit.reshape(N, DIM), first.Product(unit.reshape(N, DIM)))
        recycled, truth, other.count = recycled.With(other), other.stiffness, 0
        other.stiffness = told
        s, y = recycled.Solve(Equation(blocks)[0], b, tol=1e-9, maxiter=100)
        other.stiffness = truth
        wrong = np.abs(Matrix(other.matrix, blocks) @ s.ravel() - b.ravel()).max()
        assert other.count == 0 and (wrong > 0.1 if fresh else wrong < 1e-7)


@pytest.mark.parametrize("scale", [1e-150, 1e-12, 1e12, 1e150])
def test_units_do_not_matter(weights, scale):
    """Counts are the same whatever the size of tractions."""
    S, blocks, b = Compliance(), Blocks(1), np.random.default_rng(2).standard_normal((N, DIM))
    dense = Dense(S)
    s, _ = Recycled(dense, weights).Solve(Equation(blocks)[0], scale * b, tol=1e-8, maxiter=100)
    reference = Dense(S)
    Recycled(reference, weights).Solve(Equation(blocks)[0], b, tol=1e-8, maxiter=100)
    assert abs(dense.count - reference.count) <= 1
    assert (s / scale).ravel() == pytest.approx(np.linalg.solve(Matrix(S, blocks), b.ravel()), rel=1e-5, abs=1e-5)


def test_a_singular_consistent_equation_ends(weights):
    """M = I - e e' W-free projector: b in its range is solved, one outside keeps its residual, and both end early."""
    blocks = np.broadcast_to(-np.eye(DIM), (N, DIM, DIM))
    projector = np.zeros((N * DIM, N * DIM))
    projector[:3, :3] = np.eye(3)

    class Projection(Dense):
        pass

    def Local(image, s):
        return np.einsum("nij,nj->ni", blocks, image)       # M = I - S, S a projector

    inside = np.zeros((N, DIM))
    inside[4:] = np.random.default_rng(1).standard_normal((N - 4, DIM))
    dense = Projection(projector)
    s, _ = Recycled(dense, weights).Solve(Local, inside, tol=1e-10, maxiter=100)
    assert s == pytest.approx(inside, abs=1e-12) and dense.count <= 2
    outside = inside.copy()
    outside[0] = 1.0
    dense = Projection(projector)
    s, _ = Recycled(dense, weights).Solve(Local, outside, tol=1e-10, maxiter=100)
    residual = outside - (s - (projector @ s.ravel()).reshape(s.shape))
    assert dense.count < 100 and np.all(np.isfinite(s))
    assert residual[0] == pytest.approx([1.0, 1.0], abs=1e-10) and np.abs(residual[4:]).max() < 1e-10


def test_no_more_than_the_limit_of_applications(weights):
    """And what is returned is the best on them: no other combination of the directions has a smaller residual."""
    S, blocks, b = 30 * Compliance(), Blocks(1), np.random.default_rng(2).standard_normal((N, DIM))
    lengths = []
    for limit in range(0, 10, 3):
        dense = Dense(S)
        s, _ = Recycled(dense, weights).Solve(Equation(blocks)[0], b, tol=1e-12, maxiter=limit)
        assert dense.count == limit
        lengths.append(Relative(weights, b - (Matrix(S, blocks) @ s.ravel()).reshape(b.shape), b))
    assert lengths[0] == 1 and np.all(np.diff(lengths) <= 1e-14) and lengths[-1] > 1e-12


def test_nothing_to_solve(weights):
    """A zero right-hand side and a zero product ask for nothing and divide by nothing."""
    dense = Dense(Compliance())
    recycled = Recycled(dense, weights)
    recycled.Remember(np.zeros((N, DIM)), dense.Product(np.zeros((N, DIM))))
    assert not recycled.images
    s, y = recycled.Solve(Equation(Blocks(1))[0], np.zeros((N, DIM)), tol=1e-8, maxiter=10)
    assert not np.any(s) and not np.any(y) and dense.count == 1
