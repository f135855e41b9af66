"""Any object that keeps `contracts.Method` is a method, and ours keep it."""

import numpy as np
import pytest
from problems import Example

from ngdgc import Discretization, InteriorPenalty, Solve
from ngdgc.contracts import FluxForm, Form, Method, Missing
from ngdgc.mesh.facets import Csr
from ngdgc.meshes import RectangleMesh
from ngdgc.methods.registry import METHODS


class Outside:
    """A method without a base class: the form of interior penalty on a space of its own."""

    name, discontinuous, weak, conservative, iterative, symmetric = "outside", True, True, True, False, True
    row = InteriorPenalty()

    def Space(self, mesh, order, clamped):
        return self.row.Space(mesh, order, clamped)

    def ScalarSpace(self, mesh, order):
        return self.row.ScalarSpace(mesh, order)

    def Form(self, problem, facets, space, order, assembly):
        return self.row.Form(problem, facets, space, order, assembly)


@pytest.mark.parametrize("method", [*(row() for row in METHODS.values()), Outside()], ids=lambda method: method.name)
def test_contract_is_kept(method):
    """By the method and its form; what it answers of the space is what the space is."""
    disc = Discretization(Example(), method, RectangleMesh(2))
    assert Missing(method, Method) == [] and Missing(disc.form, FluxForm if method.conservative else Form) == []
    assert all(disc.space.FreeDofs()) == method.weak
    assert (disc.space.ndof == 2 * method.ScalarSpace(disc.mesh, 1).ndof == 2 * 3 * disc.mesh.ne) == method.discontinuous
    matrix = Csr(disc.matrix)
    assert (abs(matrix - matrix.T).max() < 1e-12 * abs(matrix).max()) == method.symmetric
    assert "Form" in Missing(object(), Method)      # control


def test_a_method_from_outside_solves_the_problem_with_forces():
    own, ours = (Solve(Discretization(Example(), method, RectangleMesh(4))) for method in (Outside(), InteriorPenalty()))
    assert np.array_equal(own.vector, ours.vector) and np.array_equal(own.Force("right"), ours.Force("right"))
