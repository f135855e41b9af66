"""Forces through named boundaries inside the body: one normal along each piece, balance of parts, Newton's third law."""

import numpy as np
import pytest
from bodies import LINE, RING, Crossed, Layers, Stacked
from checks import Body
from netgen.meshing import Element2D
from ngsolve import CF, Integrate, Mesh, exp, x, y
from problems import Loaded, Solved

from ngdgc import LDG, BassiEtAl, Conforming, InteriorPenalty, ProblemError
from ngdgc.mesh.facets import Facets
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.mesh.quadrature import BoundaryQuadrature

SEVERAL = [InteriorPenalty(), LDG(), BassiEtAl(form="lifting"), Conforming()]
NAMES = dict(ids=lambda method: method.name)


def Inclusion(cells):
    """The unit cube of 3^3 cells with the faces of the inner one named "shell"."""
    mesh = BoxMesh(3, cells=cells).ngmesh
    points = 3 * np.array([point.p for point in mesh.Points()])
    shell, centre = mesh.AddRegion("shell", dim=2), [1.5, 1.5, 1.5]
    faces = {"tet": [(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)],
             "hex": [(0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]}[cells]
    for element in mesh.Elements3D():
        nodes = np.array([vertex.nr for vertex in element.vertices])
        if np.abs(points[nodes - 1].mean(axis=0) - centre).max() < 0.5:
            for face in faces:
                corners = points[nodes[list(face)] - 1]
                if np.any((np.ptp(corners, axis=0) < 1e-9) & (np.abs(corners - centre).min(axis=0) > 0.4)):
                    mesh.Add(Element2D(shell, [int(node) for node in nodes[list(face)]]))
    return Mesh(mesh)


@pytest.mark.slow
@pytest.mark.parametrize("method", SEVERAL, **NAMES)
@pytest.mark.parametrize("mesh", [Crossed({"ring": [RING]}), Crossed({"ring": [RING]}, cells="quad"),
                                  Crossed({"ring": [RING]}, turn=31), Inclusion("tet"), Inclusion("hex")],
                         ids=["triangle", "quad", "numbered", "tet", "hex"])
def test_what_a_closed_interface_surrounds_is_in_balance(mesh, method):
    """Force plus body force inside is zero, for a flux of one normal all around; that of the smaller number is not."""
    name = "ring" if mesh.dim == 2 else "shell"
    solution = Solved(Loaded(mesh), method, mesh, order=2 if mesh.dim == 2 else 1)
    facets, inside = solution.disc.facets, np.array((1, 2, -5)[3 - mesh.dim:]) / 3 ** mesh.dim
    force, size = solution.Force(name), np.abs(solution.Force("top")).max()
    integral = np.array(Integrate(solution.Traction(name), mesh, definedon=mesh.Boundaries(name)))
    assert integral == pytest.approx(force, abs=1e-10 * size)
    assert np.abs(np.abs(force) - np.abs(inside)).max() < 1e-8 * size
    on = facets.On(name)
    numbered = facets.interfaces.sign[on] @ solution.facettractions.forces[on]
    assert np.abs(np.abs(numbered) - np.abs(inside)).max() > 1e-2 * size


@pytest.mark.parametrize("turn", range(0, 72, 17))
@pytest.mark.parametrize("path", [LINE, LINE[1:5], [(0, 3), (1, 3), (2, 3), (2, 2), (2, 1), (2, 0)]],
                         ids=["line", "slit", "corner"])
def test_normal_does_not_turn_along_an_interface(path, turn):
    """It stays on the left of the path or on its right, whatever the numbers of the elements; smaller numbers change sides."""
    pairs = list(zip(path, path[1:]))
    mesh = Crossed({"path": [path[:3], path[:1:-1]]}, turn=turn)     # two strokes that run towards each other
    facets = Facets(mesh)
    quadrature = BoundaryQuadrature.On(facets, "path", 0)
    numbers = facets.boundary[0][quadrature.boundaryelements]
    left = []
    for middle, normal in zip(6 * quadrature.coordinates, facets.interfaces.sign[numbers, None] * quadrature.normals):
        (a, b), = ((a, b) for a, b in pairs if np.allclose((np.array(a) + b) / 2, middle))
        left.append(np.dot([a[1] - b[1], b[0] - a[0]], normal) > 0)
    assert len(left) == len(pairs) and len(set(left)) == 1
    assert len(set(facets.interfaces.piece[numbers])) == 1


def test_smaller_numbers_change_sides():
    """The control of the test above: some numbering of the elements has both signs along the line."""
    assert any(len(set(Facets(mesh).interfaces.sign[Facets(mesh).On("path")])) == 2
               for mesh in (Crossed({"path": [RING]}, turn=turn) for turn in (0, 31)))


@pytest.mark.slow
@pytest.mark.parametrize("method", SEVERAL, **NAMES)
@pytest.mark.parametrize("dim", [2, 3])
def test_both_sides_of_an_interface(dim, method):
    """Action and reaction, each part in balance, and the material that comes first has the normal."""
    mesh = Layers(2) if dim == 2 else Stacked()
    solution = Solved(Loaded(mesh, traction={"front": (1, 0, 2)} if dim == 3 else {}), method, mesh, order=2 if dim == 2 else 1)
    size = np.abs(solution.Force("top")).max()
    soft, hard = (solution.Force("mid", material=name) for name in ("soft", "hard"))
    assert soft == pytest.approx(-hard, abs=1e-12 * size) and np.abs(soft).max() > 0.1
    assert solution.Force("mid") == pytest.approx(soft if mesh.GetMaterials()[0] == "soft" else hard, abs=1e-12 * size)
    for name in ("soft", "hard", "soft|hard"):
        assert solution.Force(".*", material=name) == pytest.approx(-Body(solution, name), abs=1e-9 * size)
    left = [solution.Force("left", material=name) for name in ("soft", "hard")]
    assert sum(left) == pytest.approx(solution.Force("left"), abs=1e-12 * size)
    assert not sum(left) == pytest.approx(left[0], abs=1e-2 * size)


@pytest.mark.parametrize("method", SEVERAL, **NAMES)
def test_slits_and_branches(method):
    """Along a slit both sides hang together, at branches pieces end: there a material or a name has to tell the side."""
    mesh = Crossed({"slit": [LINE[2:5]], "branch": [LINE[:2], [(1, 3), (1, 4), (1, 5)], [(1, 3), (1, 2)]]})
    solution = Solved(Loaded(mesh), method, mesh)
    integral = np.array(Integrate(solution.Traction("slit"), mesh, definedon=mesh.Boundaries("slit")))
    assert integral == pytest.approx(solution.Force("slit"), abs=1e-10 * np.abs(integral).max())
    pieces = solution.disc.facets.interfaces.piece[solution.disc.facets.On("branch")]
    assert len(set(pieces)) == 3
    with pytest.raises(ProblemError, match="interface of several pieces"):
        solution.Force("branch")


def test_conforming_tractions_converge_to_those_of_discontinuous_methods():
    """Through a line across the body: both converge, so their difference does; unequal supports keep the corners smooth."""
    problem = {"dirichlet": {"top": CF((0.05 * y, -0.1 * y))}, "roller": {}, "traction": {"right": CF((exp(y), 2 * x))}}
    differences = []
    for n in (1, 2):
        forces = []
        for method in (Conforming(), LDG()):
            mesh = Crossed({"line": [LINE]})
            for _ in range(n - 1):
                mesh.Refine()
            solution = Solved(Loaded(mesh, **problem), method, mesh)
            forces.append(solution.Force("line"))
        differences.append(np.abs(forces[0] - forces[1]).max())
    # Both forces balance the same loads below; only the contact force differs, by the square of the error.
    assert differences[1] < 0.5 * differences[0]


def test_sign_is_one_off_interfaces():
    facets = Facets(RectangleMesh(2))
    assert np.all(facets.interfaces.sign == 1) and np.all(facets.interfaces.piece == -1)
