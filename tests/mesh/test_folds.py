"""Elements that fold, are flat or overlap are refused, and moderate distortion is right."""

import numpy as np
import pytest
from badmeshes import CUBE, METHODS, SQUARE, Block, Body, Refined, Straightened, Turned
from netgen.occ import Circle, OCCGeometry, Rectangle
from ngsolve import CF, TET, TRIG, ElementId, GridFunction, Integrate, Mesh, VectorH1, specialcf, x

from ngdgc import ProblemError, Solve
from ngdgc.mesh.facets import REFERENCE_VERTICES, Facets
from ngdgc.mesh.checks import CheckElements, CheckSides
from ngdgc.meshes import BOXCELLS, CELLS, UnitMesh
from ngdgc.mesh.quadrature import BoundaryQuadrature


@pytest.mark.parametrize("corners, what", [
    ([(0, 0), (1, 0), (0, 1), (1, 1)], "folds"), ([(0, 0), (1, 0), (0.2, 0.2), (0, 1)], "folds"),
    ([(0, 0), (1, 0), (1, 0), (0, 1)], "collapses"), ([(0, 0), (1, 0), (0.5, 0.5), (0, 1)], None), (SQUARE, None)])
def test_folded_quadrilaterals_are_refused(corners, what):
    """Bow-tie, concave, with a side of no length; but a straight angle is the limit of what is right, and the square right."""
    for order in (corners, corners[::-1]):
        mesh = Body(2, order, range(4))
        if what is None:
            CheckElements(mesh)
        else:
            with pytest.raises(ProblemError, match=f"element 0 of the mesh, with corners .* has a map that {what}"):
                CheckElements(mesh)


@pytest.mark.parametrize("et", [et for et in REFERENCE_VERTICES if et not in (TRIG, TET)])
def test_elements_with_two_corners_exchanged_are_refused_if_their_determinant_has_both_signs(et):
    corners = np.array(REFERENCE_VERTICES[et], dtype=float)
    dim = 3 if np.any(corners[:, 2]) else 2
    points = np.random.default_rng(1).random((500, 3)) * (1, 1, dim - 2)
    inside = {"PRISM": points[:, 0] + points[:, 1] < 1, "PYRAMID": points[:, :2].max(axis=1) < 1 - points[:, 2]}
    points = points[inside.get(et.name, slice(None))]
    refused = 0
    for sign in (1, -1):
        CheckElements(Body(dim, corners[:, :dim] * (sign, 1, 1)[:dim], range(len(corners))))    # mirrored is right
        for i in range(len(corners)):
            for j in range(i):
                order = list(range(len(corners)))
                order[i], order[j] = j, i
                mesh = Body(dim, corners[:, :dim] * (sign, 1, 1)[:dim], order)
                jacobian, trafo = specialcf.JacobianMatrix(dim, dim), mesh.GetTrafo(mesh[ElementId(0)])
                signs = np.sign([np.linalg.det(np.reshape(jacobian(trafo(*point)), (dim, dim))) for point in points])
                try:
                    CheckElements(mesh)
                    assert len(set(signs)) == 1
                except ProblemError as error:
                    assert len(set(signs)) == 2 or "collapses" in str(error)
                    refused += 1
    assert refused >= 8


@pytest.mark.slow
@pytest.mark.parametrize("cells", BOXCELLS + CELLS)
def test_moderate_distortion_is_right_and_too_much_is_refused(cells):
    """A corner moved within its element, then through the opposite side."""
    for step, right in ((0.2, True), (1.5, False)):
        mesh = UnitMesh(2, cells)
        points = mesh.ngmesh.Coordinates()
        middle = np.flatnonzero(np.all(np.abs(points[:, :mesh.dim] - 0.5) < 1e-9, axis=1))[0]
        points[middle, :mesh.dim] += step * 0.5 * np.array((1, 0.9, 0.8))[:mesh.dim]
        if right:
            assert abs(Solve(Block(mesh, order=2)).normalforce - 5) < 1e-8
        else:
            with pytest.raises(ProblemError, match="folds|same side"):
                Block(mesh)
            # The control: with |det| the area of a folded mesh is that of the body and more, of all parts that overlap.
            assert Integrate(CF(1), mesh) > 1.05


@pytest.mark.parametrize("maxh", [2, 1, 0.5])
def test_coarse_meshes_of_a_disc_are_no_folds(maxh):
    """Where an element has two sides on a circle its determinant vanishes at the corner between them, to a power of h."""
    for order in (1, 2, 3, 4, 5):
        mesh = Mesh(OCCGeometry(Circle((0, 0), 1).Face(), dim=2).GenerateMesh(maxh=maxh)).Curve(order)
        CheckElements(mesh)
        CheckSides(Facets(mesh))


def test_a_mesh_refined_after_it_was_curved_is_refused_where_that_matters():
    mesh = Refined()
    lost = Integrate(CF(1), mesh)
    assert abs(lost - np.pi) > 1e-2         # the control: straight edges, whatever the order says
    with pytest.raises(ProblemError, match=r"call mesh.Curve\(3\) after refinement"):
        CheckElements(mesh)
    mesh.Curve(3)
    CheckElements(mesh)
    assert abs(Integrate(CF(1), mesh) - np.pi) < 1e-4
    mesh.Curve(1)
    CheckElements(mesh)
    for straight in (Mesh(OCCGeometry(Rectangle(1, 1).Face(), dim=2).GenerateMesh(maxh=0.7)), UnitMesh(2, "triangle")):
        straight.Curve(3)
        straight.Refine()
        CheckElements(straight)


def test_boundary_elements_curved_otherwise_than_the_elements_are_refused():
    facets = Facets(Straightened())
    with pytest.raises(ProblemError, match="boundary elements of region 'default' lie up to 0.0"):
        BoundaryQuadrature.On(facets, "default", 2)
    # The control: their length is that of the polygon, beside the curved body.
    assert Integrate(CF(1), facets.mesh, definedon=facets.mesh.Boundaries("default")) < 2 * np.pi - 0.05


def test_a_deformation_that_folds_is_refused():
    mesh = UnitMesh(2, "triangle")
    moved = GridFunction(VectorH1(mesh, order=2))
    for size, folds in ((0.1, False), (-3, True)):
        moved.Set(CF((size * x * (1 - x), 0)))
        mesh.SetDeformation(moved)
        if folds:
            with pytest.raises(ProblemError, match="has a map that folds"):
                CheckElements(mesh)
        else:
            CheckElements(mesh)


def test_a_middle_point_off_its_edge_folds_a_second_order_element():
    mesh = UnitMesh(1, "triangle").ngmesh
    mesh.SecondOrder()
    CheckElements(Mesh(mesh))
    nodes = mesh.Elements2D().NumPy()["nodes"][0]
    mesh.Coordinates()[nodes[3:] - 1] += 0.9
    with pytest.raises(ProblemError, match="element 0 of the mesh"):
        CheckElements(Mesh(mesh))


def test_flat_elements_are_refused():
    for dim, corners in ((2, [(0, 0), (0.1, 0.1), (0.3, 0.3)]), (3, [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.3, 0.3, 0)])):
        with pytest.raises(ProblemError, match="area zero" if dim == 2 else "volume zero"):
            CheckElements(Body(dim, corners, range(len(corners))))
        # Thin ones are not: a layer of 1 : 1e6.
        corners[-1] = (*corners[-1][:-1], corners[-1][-1] + 1e-6)
        CheckElements(Body(dim, corners, range(len(corners))))


def test_triangles_and_tetrahedra_may_be_numbered_either_way_round():
    """Each has one sign; neighbours of different signs have the common side in the same order."""
    for dim, corners, elements in ((2, SQUARE, [(0, 1, 2), (0, 2, 3)]), (3, CUBE, [(0, 1, 2, 5), (0, 2, 7, 5)])):
        for flip in (False, True):
            first, second = elements
            mesh = Body(dim, corners, first, (second[1], second[0], *second[2:]) if flip else second)
            CheckElements(mesh)
            CheckSides(Facets(mesh))


@pytest.mark.slow
def test_a_mesh_of_mixed_orientation_has_the_solution_of_the_mesh_of_one():
    forces = [Solve(Block(Turned("triangle", number), method, order=2)).normalforce for number in (2, 3, 1)
              for method in METHODS]
    forces += [Solve(Block(Turned("tet", 3), method)).normalforce for method in METHODS]
    assert np.abs(np.array(forces) - 5).max() < 1e-9


def test_elements_that_overlap_across_a_side_are_refused():
    for flip in (False, True):
        second = (2, 0, 4) if flip else (0, 2, 4)
        mesh = Body(2, [*SQUARE, (0.7, 0.2)], (0, 1, 2), second)
        CheckElements(mesh)         # each is right by itself
        with pytest.raises(ProblemError, match="elements 0 and 1 of the mesh lie on the same side"):
            CheckSides(Facets(mesh))
    mesh = Body(3, [*CUBE, (0.9, 0.5, 0.3)], (0, 1, 2, 5), (0, 2, 8, 5))
    with pytest.raises(ProblemError, match="elements 0 and 1 of the mesh lie on the same side"):
        CheckSides(Facets(mesh))


def test_elements_that_occur_twice_are_refused():
    twice = Body(2, SQUARE, (0, 1, 2), (1, 2, 0), (0, 2, 3))
    with pytest.raises(ProblemError, match="elements 0, 1, 2 of the mesh have a side in common"):
        CheckSides(Facets(twice))
    alone = Body(3, CUBE, range(8), (1, 2, 3, 0, 5, 6, 7, 4))
    with pytest.raises(ProblemError, match="elements 0 and 1 of the mesh lie on the same side"):
        CheckSides(Facets(alone))
