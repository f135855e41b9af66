"""Nearly incompressible bodies are iterated in a number of steps that does not grow with lam, due to all levels."""

from functools import cache

import numpy as np
import pytest
from iterated import NEARLY, Block, Steps, WithContact
from netgen.csg import unit_cube
from ngsolve import H1, ConvertOperator, HDiv, Mesh, VectorH1, VectorL2

from ngdgc import LDG, BassiEtAl, BrezziEtAl, InteriorPenalty, ProblemError
from ngdgc.linear import solenoidal
from ngdgc.linear.conjugategradients import IterativeInverse
from ngdgc.linear.cycles import Corners, Entries, Galerkin
from ngdgc.mesh.facets import Csr
from ngdgc.meshes import BoxMesh, RectangleMesh


@pytest.mark.slow
@pytest.mark.parametrize("nu", [0.44, 0.49, NEARLY, 0.4999])
def test_steps_do_not_grow_with_lam(nu):
    disc = Block(BoxMesh(5), nu=nu)
    assert Steps(disc, WithContact(disc, 1e3)) <= 45


@pytest.mark.slow
def test_steps_do_not_grow_with_the_number_of_elements_of_nearly_incompressible_bodies():
    few, many = (Steps(disc, disc.matrix) for disc in (Block(BoxMesh(n), nu=NEARLY) for n in (5, 8)))
    assert few <= 40 and many <= 45


@pytest.mark.slow
@pytest.mark.parametrize(("mesh", "order", "method", "bound"), [
    (BoxMesh(3), 2, None, 35), (BoxMesh(2), 3, None, 35), (Mesh(unit_cube.GenerateMesh(maxh=0.3)), 1, None, 35),
    (RectangleMesh(16), 1, None, 45), (RectangleMesh(8), 3, None, 50), (BoxMesh(4), 1, BassiEtAl(), 60),
    (BoxMesh(4), 1, BrezziEtAl(), 60), (BoxMesh(4), 1, LDG(), 60), (BoxMesh(4), 1, InteriorPenalty(penalty=7000), 45)])
def test_nearly_incompressible_bodies_of_all_orders_and_methods(mesh, order, method, bound):
    disc = Block(mesh, method, order=order, nu=NEARLY)
    assert Steps(disc, disc.matrix) <= bound


@pytest.mark.slow
def test_a_nearly_incompressible_body_that_only_contact_holds():
    body = Block(BoxMesh(4), held=False, nu=NEARLY)
    for D in (1, 1e3):
        assert Steps(body, WithContact(body, D, D)) <= 50


def Facetwise(space, facets):
    """Blocks without the stars' curls: the dofs of each facet, and of each element."""
    elements, dofs = Corners(space)
    inner = [space.GetDofNrs(facet) for facet in space.mesh.facets]
    return [list(block) for block in inner] + [dofs[elements == number].tolist() for number in range(space.mesh.ne)]


@cache
def Nearly():
    """A body, and the steps that it takes with all levels."""
    disc = Block(BoxMesh(4), nu=NEARLY)
    return disc, Steps(disc, disc.matrix)


@pytest.mark.slow
@pytest.mark.parametrize(("level", "factor"), [
    (("SWOLLEN", np.inf), 10), (("OVER", 0), 1.4), (("OVER", 1), 1.2), (("VertexStars", Facetwise), 1.8)],
    ids=["all", "potentials", "overcorrection", "stars"])
def test_without_one_of_their_levels_it_takes_more_steps(monkeypatch, level, factor):
    disc, usual = Nearly()
    monkeypatch.setattr(solenoidal, *level)
    with pytest.raises(ProblemError, match=f"in {int(factor * usual)} steps"):
        IterativeInverse(disc, disc.matrix, maxiter=int(factor * usual)).Solve(disc.load)


@pytest.mark.parametrize("mesh", [BoxMesh(3), RectangleMesh(4)], ids=["3D", "2D"])
def test_curls_of_potentials_cost_what_they_cost_without_lam(mesh):
    """Inside the body; at a clamped side their normal components cost lam."""
    def Energies(nu):
        disc = Block(mesh, held=False, nu=nu)
        space, functions = HDiv(mesh, order=1), VectorH1(mesh, order=1)
        potentials = H1(mesh, order=1) if mesh.dim == 2 else functions
        matrix = Csr(disc.matrix) * 2 * (1 + nu)        # in units of mu = E/(2 (1 + nu))
        inner = Galerkin(matrix, Entries(ConvertOperator(space, VectorL2(mesh, order=1))))
        return [Galerkin(inner, Entries(operator)) for operator in (
            ConvertOperator(potentials, space, trial_cf=solenoidal.Curl(potentials)), ConvertOperator(functions, space))]
    (soft, softwithlam), (stiff, stiffwithlam) = Energies(0.3), Energies(NEARLY)
    assert abs(stiff - soft).max() < 1e-10 * abs(soft).max()
    assert abs(stiffwithlam).max() > 10 * abs(softwithlam).max()
