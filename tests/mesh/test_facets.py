"""Data of facets."""

import numpy as np
import pytest
from problems import OPEN

from ngdgc import ContactProblem, Discretization, HookeMaterial, InteriorPenalty, Solve
from ngdgc.mesh.facets import Facets
from ngdgc.meshes import UnitMesh


@pytest.mark.parametrize("cells", ["triangle", "tet"])
def test_diameters_of_a_mesh_that_was_halved(cells):
    """It keeps the facets that were halved; the diameters are those of the sides of its elements, edges of which they are."""
    mesh = UnitMesh(2, cells)
    for element in mesh.Elements():
        mesh.SetRefinementFlag(element, element.nr == 0)
    mesh.Refine()
    facets = Facets(mesh)
    assert len(facets.diameter) == len(facets.neighbours) < mesh.nfacet         # control: there are more facets than sides
    points = np.array([vertex.point for vertex in mesh.vertices])
    for element in mesh.Elements():
        own = facets.ofelements[facets.starts[element.nr]:facets.starts[element.nr + 1]]
        corners = points[[vertex.nr for vertex in element.vertices]]
        edges = np.linalg.norm(corners[:, None] - corners, axis=2)
        assert facets.diameter[own].max() == pytest.approx(edges.max())
        assert np.all(np.abs(facets.diameter[own][:, None] - edges.ravel()).min(axis=1) < 1e-12)
    if cells == "tet":
        problem = ContactProblem(HookeMaterial(E=1, nu=0.3), OPEN, dirichlet={"top": (0, 0, 0)}, traction={"left": (1, 0, 0)})
        assert Solve(Discretization(problem, InteriorPenalty(penalty=40), mesh)).converged
