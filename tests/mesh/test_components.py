"""Connected parts of graphs, as scipy has them."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from ngdgc.mesh.components import Connected


@pytest.mark.parametrize("edges", [0, 30, 60, 200])
def test_parts_of_random_graphs(edges):
    n = 100
    first, second = np.random.default_rng(edges).integers(n, size=(2, edges))
    graph = sp.coo_matrix((np.ones(edges), (first, second)), shape=(n, n))
    count, labels = connected_components(graph, directed=False)
    assert np.array_equal(Connected(n, first, second), labels)
    assert 1 < count <= n


def test_a_long_chain_in_any_order_is_one_part():
    n = 10_000
    places = np.random.default_rng(1).permutation(n)
    assert np.all(Connected(n, places[:-1], places[1:]) == 0)
    assert Connected(n, places[:-2], places[1:-1]).max() == 1       # control: the last one is apart
