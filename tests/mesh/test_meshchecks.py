"""Meshes that say something twice or wrongly: the right answer, or one error that names the boundary or the element."""

import numpy as np
import pytest
from badmeshes import CUBE, METHODS, SQUARE, Block, Body, Diagonal, Doubled, Lost, Periodic, Refused, Side
from netgen.meshing import MeshPoint, Pnt
from netgen.occ import IdentificationType
from ngsolve import CF, Integrate, Mesh, VectorH1

from ngdgc import LDG, Conforming, Discretization, ProblemError, Solve
from ngdgc.mesh.facets import REFERENCE_VERTICES, Facets, Vertices
from ngdgc.mesh.checks import SIDEVERTICES, CheckBoundary, CheckElements, CheckSides, CheckSkeleton, Lattice
from ngdgc.meshes import BOXCELLS, CELLS, UnitMesh
from ngdgc.mesh.quadrature import ReferenceNormal


@pytest.mark.slow
@pytest.mark.parametrize("cells", CELLS + BOXCELLS)
@pytest.mark.parametrize("back", [False, True])
def test_what_is_twice_counts_once_or_is_refused(cells, back):
    assert "'bottom'" in Refused(Doubled(cells, back=back))
    both = Doubled(cells, "skin", back)
    for region in ("bottom|skin", ".*m|sk.*"):
        message = Refused(both, region=region)
        assert "'bottom' and 'skin'" in message and "twice" in message
    # A part that no condition names is there in vain, whichever of the two it is.
    for region in ("bottom", "skin"):
        solution = Solve(Block(both, region=region))
        assert abs(solution.normalforce - 5) < 1e-10 and abs(solution.weights.sum() - 1) < 1e-12
    # The control: without the check the mesh integrates the bottom twice.
    once, twice = (Integrate(CF(1), both, definedon=both.Boundaries(region)) for region in ("bottom", "bottom|skin"))
    assert abs(once - 1) < 1e-12 and abs(twice - 2) < 1e-12


@pytest.mark.parametrize("cells", ["triangle", "hex"])
def test_two_conditions_on_one_side_are_refused_under_whatever_names(cells):
    mesh = Doubled(cells, "skin")
    down = (0,) * (mesh.dim - 1) + (-0.03,)
    message = Refused(mesh, dirichlet={"top": down}, traction={"skin": down})
    assert "boundary 'bottom' and 'skin' is claimed twice, by traction 'skin' and by foundation 'bottom'" in message
    assert "claimed twice" in Refused(mesh, dirichlet={"top": down}, roller={"skin": 0})
    # Two tractions on one roller: the first condition on a part must not hide the second from the third.
    sides = {"dirichlet": {"top": down}, "roller": {"left": 0}}
    assert "claimed twice, by traction 'left'" in Refused(mesh, **sides, traction={"left": down, "left|right": down})
    # The control: a tangential traction on a roller is one of the allowed pairs.
    Block(mesh, **sides, traction={"left": down})


@pytest.mark.slow
@pytest.mark.parametrize("cells", ["triangle", "quad", "tet", "hex", "prism"])
@pytest.mark.parametrize("hanging", [False, True])
def test_boundary_elements_of_no_element_are_no_part_of_the_body(cells, hanging):
    mesh = Lost(cells, "axis", hanging)
    for method in METHODS:
        for order in (1, 2) if mesh.dim == 2 else (1,):
            solution = Solve(Block(mesh, method, order=order))
            assert abs(solution.normalforce - 5) < 1e-9 and solution.GlobalImbalance() < 1e-9
            assert np.abs(solution.Force("top")[-1] + 5) < 1e-9 > np.abs(solution.Mean("top")[-1] + 0.03)
    for region in ("bottom", "bottom|axis"):
        message = Refused(Lost(cells, None if region == "bottom" else "axis", hanging), region=region)
        assert f"boundary {'bottom' if region == 'bottom' else 'axis'!r} has an element" in message
    assert "boundary 'axis' has an element" in Refused(mesh, region="axis")
    # The control: NGSolve counts its measure as the region's.
    assert Integrate(CF(1), Lost(cells), definedon=Lost(cells).Boundaries("bottom")) > 1.4


def test_unknowns_of_lost_elements_are_not_in_the_conforming_space():
    mesh, right = Lost("triangle", "axis"), UnitMesh(2, "triangle")
    for order in (1, 2, 3):
        free, expected, all = (space.FreeDofs().NumSet() for space in (
            Conforming().Space(mesh, order, "top"), Conforming().Space(right, order, "top"), VectorH1(mesh, order=order)))
        assert free == expected < all


def test_integrals_over_sides_by_ngsolve_are_refused_on_a_mesh_with_lost_elements():
    for mesh in (Lost("triangle", "axis"), Lost("tet", "axis", hanging=True)):
        for method, supports in ((LDG(), {}), (
                Conforming(), {"dirichlet": {"left": (0,) * mesh.dim}, "roller": {"top": 0}})):
            disc = Block(mesh, method, **supports)
            disc.assembly = "skeleton"
            with pytest.raises(ProblemError, match="boundary 'axis' has an element"):
                disc.method.Form(disc.problem, disc.facets, disc.space, 1, "skeleton")
    CheckSkeleton(Facets(UnitMesh(2, "triangle")))


@pytest.mark.parametrize("cells", ["quad", "hex", "prism"])
def test_boundary_elements_off_the_sides_are_refused(cells):
    """Diagonals join vertices of one element; of a face of a hexahedron NGSolve takes three corners for the face itself."""
    assert "boundary 'bottom' has an element" in Refused(Diagonal(cells))
    mesh = Diagonal(cells, "axis")
    assert "boundary 'axis' has an element" in Refused(mesh, region="bottom|axis")
    assert abs(Solve(Block(mesh)).normalforce - 5) < 1e-10
    if cells == "hex":
        facets = Facets(mesh)
        number, regions, _ = facets.boundary
        axis = mesh.GetBoundaries().index("axis")
        assert facets.neighbours[number[regions == axis]].min() > 0     # the control: the facet's number does not tell


def test_sides_are_told_apart_in_meshes_of_several_types():
    """A side that is none, of a prism, moves no number of a hexahedron's, whichever of the two is looked at first."""
    prism = [(3, 0, 0), (4, 0, 0), (3, 1, 0), (3, 0, 1), (4, 0, 1), (3, 1, 1)]
    sides = {"no side of the prism": (8, 9, 12), "bottom of the hexahedron": (0, 3, 2, 1), "its top": (4, 5, 6, 7),
             "no side of it": (0, 1, 5), "bottom of the prism": (8, 10, 9)}
    mesh = Body(3, CUBE + prism, range(8, 14), range(8)).ngmesh
    for name, corners in sides.items():
        Side(mesh, [corner + 1 for corner in corners], name)
    facets = Facets(Mesh(mesh))
    # All have the number of a facet of an element, which does not tell.
    assert np.all(facets.neighbours[facets.boundary[0]] == 1)
    assert {name: bool(side) for name, side in zip(facets.mesh.GetBoundaries(), facets.proper)} == {
        "skin": True} | {name: not name.startswith("no") for name in sides}


def test_vertices_of_no_element_change_nothing():
    """Far away they are no part of the size of the body, by which free motions and forces are measured."""
    mesh, right = Lost("tet", "axis", far=1e6), UnitMesh(2, "tet")
    supports = {"dirichlet": {}, "roller": {"left": 0, "back": 0}, "bodyforce": (0, 0, -1)}
    for method in (LDG(), Conforming()):
        found, expected = (Solve(Block(one, method, **(supports if method.discontinuous else {}))) for one in (mesh, right))
        assert abs(found.normalforce - expected.normalforce) < 1e-9 * expected.normalforce
    message, expected = (Refused(one, dirichlet={}, traction={"top": (1, 0, 0)}) for one in (mesh, right))
    assert message == expected and "rotation about" in message


def test_a_crack_is_no_mistake():
    """Sides at the same place between different vertices: two parts, each held by itself."""
    corners = [*SQUARE, (1, 0), (2, 0), (2, 1), (1, 1)]
    mesh = Body(2, corners, (0, 1, 2, 3), (4, 5, 6, 7))
    CheckElements(mesh)
    facets = Facets(mesh)
    CheckSides(facets)
    assert facets.component.max() == 1


@pytest.mark.parametrize("dim", [2, 3])
def test_identified_sides_are_refused_by_every_method_and_assembly(dim):
    mesh = Periodic(dim)
    for method, assembly in ((LDG(), "facet"), (LDG(), "skeleton"), (Conforming(), "facet")):
        problem = Block(UnitMesh(1, CELLS[0] if dim == 2 else BOXCELLS[0])).problem
        with pytest.raises(ProblemError, match="sides of the mesh are identified with each other, boundary left, right"):
            Discretization(problem, method, mesh, assembly=assembly)
    # Other identifications couple nothing: both assemblies solve the same.
    mesh = Periodic(dim, IdentificationType.UNDEFINED)
    for assembly in ("facet", "skeleton"):
        solution = Solve(Discretization(problem, LDG(), mesh, assembly=assembly))
        assert abs(solution.normalforce - 5) < 1e-9 and solution.GlobalImbalance() < 1e-9


def test_sides_are_ngsolves_sides_seen_from_outside():
    for et, sides in SIDEVERTICES.items():
        corners = np.array(REFERENCE_VERTICES[et], dtype=float)
        dim = 3 if np.any(corners[:, 2]) else 2
        mesh = Body(dim, corners[:, :dim], range(len(corners)))
        numbers = Facets(mesh).ofelements
        nodes = mesh.edges if dim == 2 else mesh.faces
        expected = [sorted(vertex.nr for vertex in nodes[number].vertices) for number in numbers]
        assert [sorted(side) for side in sides] == expected
        for side in sides:
            edges = (corners[list(side)] - corners[side[0]])[1:, :dim]
            turned = np.array([edges[0][1], -edges[0][0]]) if dim == 2 else np.cross(edges[0], edges[1])
            assert turned @ ReferenceNormal(corners[list(side)], corners.mean(axis=0), dim) > 0


def test_vertices_are_ngsolves_vertices_with_middle_points_too():
    for cells in CELLS + BOXCELLS:
        for second in (False, True):
            mesh = UnitMesh(1, cells)
            if second:
                mesh.ngmesh.SecondOrder()
                mesh = Mesh(mesh.ngmesh)
            expected = [[vertex.nr for vertex in element.vertices] for element in mesh.Elements()]
            assert [[one for one in row if one >= 0] for row in Vertices(mesh, mesh.dim).tolist()] == expected


def test_lattices_lie_in_the_reference_elements():
    counts = {"TRIG": 6, "QUAD": 9, "TET": 10, "HEX": 27, "PRISM": 18, "PYRAMID": 9}
    for et, corners in REFERENCE_VERTICES.items():
        points = Lattice(et, 2)
        assert len(points) == counts[et.name] and len(np.unique(points, axis=0)) == len(points)
        base = [corner for corner in corners if et.name != "PYRAMID" or corner[2] == 0]
        assert all(np.any(np.all(points == corner, axis=1)) for corner in base)
        assert np.all(points >= 0) and np.all(points <= 1)


def test_a_boundary_element_twice_inside_the_body_is_no_matter_where_it_is_not_used():
    mesh = UnitMesh(2, "triangle").ngmesh
    inside = next(iter(mesh.Elements2D())).vertices
    for _ in range(2):
        Side(mesh, inside[1:], 1 + len(UnitMesh(2, "triangle").GetBoundaries())) if _ else Side(mesh, inside[1:], "crease")
    mesh.Add(MeshPoint(Pnt(3, 3, 0)))
    mesh = Mesh(mesh)
    assert abs(Solve(Block(mesh)).normalforce - 5) < 1e-10
    assert "crease" in Refused(mesh, region="crease|bottom")
    with pytest.raises(ProblemError, match="twice in the mesh, in boundary 'crease'"):
        CheckBoundary(Facets(mesh), "crease")
