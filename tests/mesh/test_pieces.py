"""Divided sides of elements: the parts cover them, and integrate what is smooth on each of them."""

import numpy as np
import pytest

from ngdgc.mesh.facets import Facets
from ngdgc.mesh.pieces import Interval, Quarters
from ngdgc.mesh.quadrature import BoundaryQuadrature
from ngdgc.meshes import BoxMesh, RectangleMesh


@pytest.mark.parametrize("cells", ["tet", "hex", "prism"])
def test_parts_of_faces_cover_them(cells):
    facets = Facets(BoxMesh(1, cells=cells))
    whole = BoundaryQuadrature.On(facets, ".*", 5)
    corners = (facets.boundary[2] >= 0).sum(axis=1)
    pieces = {int(number): Quarters(corners[number], 2) for number in np.unique(whole.boundaryelements)[::2]}
    parts = BoundaryQuadrature.On(facets, ".*", 5, pieces=pieces)
    assert len(parts.weights) > 5 * len(whole.weights)
    for number in np.unique(whole.boundaryelements):
        one, other = (quadrature.boundaryelements == number for quadrature in (whole, parts))
        assert other.sum() == one.sum() * (16 if int(number) in pieces else 1)
        for power in range(6):      # the rule has degree 5: polynomials are integrated to round-off, divided or not
            first, second = (quadrature.weights[there] @ quadrature.coordinates[there] ** power
                             for quadrature, there in ((whole, one), (parts, other)))
            np.testing.assert_allclose(first, second, atol=1e-14)
        np.testing.assert_allclose(parts.normals[other], np.broadcast_to(whole.normals[one][0], (other.sum(), 3)), atol=1e-14)
    # The part of every point is inside of its element: else coordinates on both would differ.
    assert set(parts.elements) == set(whole.elements)


def test_kinks_between_parts_are_integrated_exactly():
    facets = Facets(RectangleMesh(2))
    whole = BoundaryQuadrature.On(facets, "bottom", 3)
    number = int(whole.boundaryelements[whole.coordinates[:, 0] < 0.5][0])

    def Error(end):
        pieces = {number: [Interval(0, end), Interval(end, 1)]}
        quadrature = BoundaryQuadrature.On(facets, "bottom", 3, pieces=pieces)
        return abs(quadrature.weights @ np.maximum(quadrature.coordinates[:, 0] - 0.15, 0) - 0.85 ** 2 / 2)

    # The edge from 0 to 0.5 is divided at 0.15, from whichever end its coordinate counts.
    assert min(Error(0.3), Error(0.7)) < 1e-15 and Error(0.5) > 1e-4
