"""A matrix in the order of the elements is the same one, and its sweeps are what formulas say; for two types of elements."""

import numpy as np
import pytest
from bodies import Mixed
from iterated import Block
from ngsolve import ET, L2, VOL

from ngdgc.linear.elementblocks import ElementBlocks, ElementOrder
from ngdgc.linear.multigrid import VCycle
from ngdgc.mesh.facets import Csr

ROUND = 1e-12


@pytest.fixture(scope="module")
def ordered():
    """(disc, A as a dense matrix in the order of the elements, blocks, which entries of a vector are dofs)."""
    mesh = Mixed()
    assert {element.type for element in mesh.Elements(VOL)} == {ET.TRIG, ET.QUAD}
    disc = Block(mesh)
    order = ElementOrder(L2(mesh, order=1), 2)
    A, here = np.eye(order.length), np.zeros(order.length, dtype=bool)
    here[order.place] = True
    A[np.ix_(order.place, order.place)] = Csr(disc.matrix).toarray()
    return disc, A, ElementBlocks(disc.matrix, order), here


def Off(found, wanted):
    return np.abs(found - wanted).max() / np.abs(wanted).max()


def test_dofs_of_an_element_stand_together(ordered):
    disc, _, blocks, here = ordered
    order, scalar = blocks.order, L2(disc.mesh, order=1)
    for number, element in enumerate(scalar.Elements(VOL)):
        dofs = np.concatenate([np.array(element.dofs), np.array(element.dofs) + disc.space.ndof // 2])
        assert set(order.place[dofs] // order.block) == {number}
    vector = np.arange(1.0, disc.space.ndof + 1)
    assert np.array_equal(order.From(order.To(vector)), vector) and np.all(order.To(vector)[~here] == 0)
    assert not np.all(here)


def test_products_and_sweeps(ordered):
    disc, A, blocks, _ = ordered
    x = blocks.order.To(np.random.default_rng(1).standard_normal(disc.space.ndof))
    element = np.arange(len(A)) // blocks.order.block
    sides = [np.where(np.sign(np.subtract.outer(element, element)) == sign, A, 0) for sign in (1, 0, -1)]
    L, D, U = sides
    assert Off(blocks.Product(x), A @ x) < ROUND
    for part, whole in ((blocks.lower, L), (blocks.diagonal, D), (blocks.upper, U)):
        assert Off(part.toarray(), whole) < ROUND
    assert Off(blocks.Forwards(x), np.linalg.solve(D + L, x)) < ROUND
    assert Off(blocks.Backwards(x), np.linalg.solve(D + U, x)) < ROUND
    # Negative control: the order of the sweep matters.
    assert Off(blocks.Forwards(x), np.linalg.solve(D + U, x)) > 1e-2


def test_pieces_of_any_length_give_the_same(ordered, monkeypatch):
    disc, _, blocks, _ = ordered
    monkeypatch.setattr("ngdgc.linear.elementblocks.CHUNK", 500)
    other = ElementBlocks(disc.matrix, blocks.order)
    for name in ("lower", "diagonal", "upper"):
        assert np.array_equal(getattr(other, name).toarray(), getattr(blocks, name).toarray())


def test_the_cycle_tells_what_the_matrix_makes_of_its_result(ordered):
    disc, A, _, here = ordered
    cycle = VCycle(disc.matrix, None, disc)
    b = cycle.To(disc.load)
    z, product = cycle.Precondition(b)
    assert Off(product, A @ z) < ROUND and np.all(z[~here] == 0)
    assert Off(product, b) < 1          # a step of Richardson's iteration, not the solution
    assert Off(product, b) > 1e-3
