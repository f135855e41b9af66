"""Assembly in batches: parts of the elements, threads, connected parts of a mesh, bounds without matrices, memory."""

import os
import subprocess
import sys
import tracemalloc

import numpy as np
import pytest
import scipy.sparse as sp
from bodies import Distorted, Ring
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import VOL, LinearForm, Mesh, ds
from problems import GRADED, Example

from ngdgc import LDG, BassiEtAl, Discretization, HookeMaterial, InteriorPenalty
from ngdgc.mesh.facets import Coordinates, Csr, Facets
from ngdgc.mesh.quadrature import BoundaryQuadrature
from ngdgc.methods.lifting import WeakFacets
from ngdgc.meshes import BoxMesh, RectangleMesh, UnitMesh
from ngdgc.blocks.operators import FacetOperators
from ngdgc.methods.penalty import ElasticBound, LargestEigenvalues

HOOKE = HookeMaterial(mu=50, lam=80)


def Operators(mesh, material, order):
    facets = Facets(mesh)
    share, rollers = WeakFacets(Example(), facets)
    return FacetOperators(material, facets, order, order, share, rollers)


@pytest.mark.parametrize("mesh, material", [(Distorted("triangle"), HOOKE), (Distorted("triangle"), GRADED),
                                            (Distorted("quad"), HOOKE), (Ring(2, 0.5), GRADED), (BoxMesh(2), HOOKE)],
                         ids=["affine", "graded", "quads", "curved", "tets"])
def test_a_part_of_the_elements_has_their_matrices(mesh, material):
    (group,) = Operators(mesh, material, 2).groups
    rows = np.random.default_rng(1).permutation(len(group.elements))[:7]
    part = group.Part(rows)
    for matrices in (lambda one: one.energy, lambda one: one.Traction(1), lambda one: one.TraceValue(0),
                     lambda one: one.ElasticJump(2), lambda one: one.inverseliftmass, lambda one: one.weightedliftmass):
        whole, found = matrices(group), matrices(part)
        # One product for all elements or for few: the order of the sums may differ.
        assert np.abs(found - whole[rows]).max() <= 1e-13 * np.abs(whole).max()
    assert np.abs(part.energy - group.energy[np.sort(rows)]).max() > 1e-3 * np.abs(group.energy).max()


@pytest.mark.slow
@pytest.mark.parametrize("method", [InteriorPenalty(), LDG(form="lifting"), BassiEtAl()], ids=repr)
def test_threads_change_no_digit(method):
    """Workers write blocks of neighbours at the same time, each into entries of its own."""
    disc = Discretization(Example(), method, RectangleMesh(40))
    assert disc.form.operators.many
    threaded = Csr(disc.form.Matrix())
    disc.form.operators.many = False
    assert np.array_equal(Csr(disc.form.Matrix()).data, threaded.data)
    assert not np.array_equal(Csr(disc.form.Norm()).data, threaded.data)


WITHTHREADS = """import sys
import numpy as np
from ngsolve import TaskManager
from pyngcore import GetNumThreads
from ngdgc import Conforming, InteriorPenalty
from ngdgc.cases import example_4_1
from ngdgc.mesh.facets import THREADED
assert example_4_1.Mesh(40).ne > THREADED
with TaskManager():
    print(GetNumThreads())
np.savez(sys.argv[1], *(example_4_1.Main(method=method, n=40).displacement for method in (InteriorPenalty(), Conforming())))"""


@pytest.mark.slow
def test_threads_of_ngsolve_change_nothing_but_round_off(tmp_path):
    """The processes in which tests run side by side have one thread, a user's has one for each processor."""
    found = {}
    for count in (1, 2):
        done = subprocess.run([sys.executable, "-c", WITHTHREADS, f"{count}.npz"], capture_output=True, text=True, check=True,
                              cwd=tmp_path, env={**os.environ, "NGS_NUM_THREADS": str(count)})
        assert done.stdout.split() == [str(count)]
        found[count] = list(np.load(tmp_path / f"{count}.npz").values())
    scales = [np.abs(values).max() for values in found[1]]
    # A factorisation with threads is the same to 3e-12; Newton's method stops at 1e-10.
    assert all(np.abs(one - two).max() < 1e-9 * scale for one, two, scale in zip(found[1], found[2], scales))
    assert np.abs(found[1][0].max() - found[2][1].max()) > 1e-6 * scales[0]       # another method's differs by more


@pytest.mark.parametrize("cells", ["triangle", "tet"])
def test_ratio_of_surface_and_volume_is_the_eigenvalue_of_constant_strains(cells):
    """c_K = max int_dK w C eps:eps / int_K C eps:eps; with strains that vary the ratio is no bound."""
    mesh = Distorted("triangle") if cells == "triangle" else BoxMesh(2, upper=(1, 2, 3))
    for order, same in ((1, True), (2, False)):
        (group,) = Operators(mesh, HOOKE, order).groups
        weights = np.random.default_rng(2).uniform(1, 2, group.facets.shape)
        eigenvalues = LargestEigenvalues(group.ElasticPencil(weights), group)
        ratios = group.SurfaceRatios(weights)
        assert group.constant == same
        assert ElasticBound(group, weights) == pytest.approx(eigenvalues, rel=1e-10)
        assert np.allclose(ratios, eigenvalues, rtol=1e-10) == same
        assert np.all(ratios <= eigenvalues * (1 + 1e-10))


def Separate(count):
    """Squares of four triangles side by side, without contact, the triangles numbered at random."""
    points, triangles = [], []
    for part in range(count):
        points += [(2 * part + a, b, 0) for a, b in [(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0.5)]]
        triangles += [[5 * part + a for a in (side, (side + 1) % 4, 4)] for side in range(4)]
    mesh = NetgenMesh()
    mesh.dim = 2
    mesh.AddPoints(np.array(points, dtype=float))
    order = np.random.default_rng(4).permutation(len(triangles))
    mesh.AddElements(dim=2, index=mesh.AddRegion("all", dim=2), data=np.array(triangles, dtype=np.int32)[order], base=0)
    return Mesh(mesh), order // 4


def test_connected_parts():
    mesh, belongs = Separate(5)
    parts = Facets(mesh).component
    assert np.array_equal(parts[:, None] == parts, belongs[:, None] == belongs)
    facets = Facets(Distorted("mixed"))
    count, expected = sp.csgraph.connected_components(facets.incidence.T @ facets.incidence, directed=False)
    assert count == 1 and np.array_equal(facets.component, expected)


MESHES = {**{cells: UnitMesh(3, cells) for cells in ("triangle", "quad", "tet", "hex", "prism")},
          "mixed": Distorted("mixed"), "ring": Ring(3, 0.5)}


@pytest.mark.parametrize("mesh", MESHES.values(), ids=MESHES)
def test_facets_of_elements_and_of_regions(mesh):
    facets = Facets(mesh)
    expected = [number for element in facets.space.Elements(VOL) for number in element.dofs]
    assert facets.ofelements.tolist() == expected
    vertices = [[vertex.nr for vertex in element.vertices] for element in mesh.Elements(VOL)]
    assert [[number for number in row if number >= 0] for row in facets.vertices.tolist()] == vertices
    for region in set(mesh.GetBoundaries()):
        form = LinearForm(facets.space.TestFunction() * ds(skeleton=True, definedon=mesh.Boundaries(region)))
        on = form.Assemble().vec.FV().NumPy() > 0
        assert np.array_equal(facets.On(region), on) and 0 < on.sum() < len(on)


@pytest.mark.parametrize("mesh", MESHES.values(), ids=MESHES)
def test_boundary_points_lie_where_their_images_inside_do(mesh):
    facets = Facets(mesh)
    for region in set(mesh.GetBoundaries()):
        quadrature = BoundaryQuadrature.On(facets, region, 3)
        at = Coordinates(mesh.dim)(quadrature.inside)
        assert np.abs(at - quadrature.coordinates).max() < 1e-13
        assert np.abs(np.roll(at, 1, axis=0) - quadrature.coordinates).max() > 1e-2
        incident = facets.incidence[facets.boundary[0][quadrature.boundaryelements], quadrature.elements]
        assert np.all(np.asarray(incident) > 0)


@pytest.mark.slow
def test_assembly_keeps_little_beside_the_matrix():
    """An entry of the matrix takes 12 bytes, value and column; tables of the blocks of all sides took 1.5 times that."""
    tracemalloc.start()
    try:
        form = Discretization(Example(), InteriorPenalty(), RectangleMesh(48)).form
        matrix = 12 * form.Matrix().nze
        assert tracemalloc.get_traced_memory()[0] < 0.4 * matrix
        (group,) = form.operators.groups
        tables = [(group.Traction(side), group.TraceValue(side)) for side in group.sides]
        assert tables and tracemalloc.get_traced_memory()[0] > 0.8 * matrix
    finally:
        tracemalloc.stop()
