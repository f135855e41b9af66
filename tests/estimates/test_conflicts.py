"""Prescribed displacements that contradict each other where their regions meet."""

import pytest
from ngsolve import CF, x, y, z

from ngdgc import ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NormalCompliance, SolveAdaptive
from ngdgc.estimates.conflicts import Conflict
from ngdgc.exceptions import NotConvergedError
from ngdgc.meshes import RectangleMesh, UnitMesh


def Held(**dirichlet):
    return ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("bottom", NormalCompliance(1)), dirichlet=dirichlet)


def Words(mesh, **dirichlet):
    return Conflict(Discretization(Held(**dirichlet), InteriorPenalty(), mesh))


@pytest.mark.parametrize("cells", ["triangle", "quad"])
def test_values_at_a_corner_of_the_plane(cells):
    mesh = RectangleMesh(3, upper=(2, 1), cells=cells)
    assert "'top' and 'left' differ by 0.05 at (0, 1)" in Words(mesh, top=(0, -0.05), left=(0, 0))
    # Control: they differ elsewhere alone; regions that do not meet.
    assert Words(mesh, top=(0, -0.05 * x), left=(0, 0.1 * (1 - y))) == Words(mesh, right=(0, -0.05), left=(0, 0)) == ""
    assert Words(mesh, top=(0.1, 0), left=(0.1, 1e-8)) == ""       # round-off


@pytest.mark.parametrize("cells", ["tet", "hex", "prism"])
def test_values_along_an_edge_in_space(cells):
    """The largest of all differences is named, at the vertex where it is."""
    mesh = UnitMesh(2, cells)
    words = Words(mesh, top=CF((0, 0, 0.1 * x)), left=CF((0, 0, 0)))
    assert "'top' and 'left' differ by 0.1 at (1, 0, 1)" in words
    assert Words(mesh, top=CF((0, 0, y)), left=CF((0, 0, 1 - z))) == ""


def test_a_run_that_cannot_get_on_says_why():
    with pytest.raises(NotConvergedError, match=r"'top' and 'left' differ by 0.05\S* at \(0, 1\)"):
        SolveAdaptive(Held(top=(0, -0.05), left=(0, 0)), InteriorPenalty(), RectangleMesh(3), order=2, tol=0.01)
