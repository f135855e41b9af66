"""Fewer continuous piecewise linear functions: which are kept, and that all linear functions are among them."""

import numpy as np
import pytest
from netgen.occ import Box, Cylinder, Glue, OCCGeometry, Pnt, X, Z
from ngsolve import Mesh

from ngdgc.linear.multigrid import PartlyContinuous
from ngdgc.linear.thinning import Thinned, VertexGraph
from ngdgc.mesh.facets import Facets
from ngdgc.meshes import BoxMesh, RectangleMesh


def Round(size=0.3):
    return Mesh(OCCGeometry(Cylinder(Pnt(0, 0, 0), Z, r=1, h=1)).GenerateMesh(maxh=size))


MESHES = {"regular": lambda: BoxMesh(6), "hexahedra": lambda: BoxMesh(6, cells="hex"), "round": Round,
          "plane": lambda: RectangleMesh(12)}


def Parts(mesh, wanted):
    space = PartlyContinuous(Facets(mesh), 1)
    graph = VertexGraph(space)
    points = np.array(mesh.ngmesh.Coordinates())[space.vertex, :mesh.dim]
    mask = wanted(points)
    return points, graph, mask, Thinned(points, graph, mask)


@pytest.mark.parametrize("name", MESHES)
def test_linear_functions_are_kept_by_fewer(name):
    """Q v = v at all vertices for linear v of the kept ones, with weights from 0 to 1; no row knows one three edges away."""
    points, graph, mask, Q = Parts(MESHES[name](), lambda points: points[:, -1] < 0.2)
    one = Q.tocsr()
    kept = np.flatnonzero((np.diff(one.indptr) == 1) & (np.maximum.reduceat(one.data, one.indptr[:-1]) == 1))
    first = np.array([row for row in kept if one[row].indices[0] not in one[kept[kept < row]].indices])
    linear = np.column_stack([np.ones(len(points)), points])
    assert Q.shape[1] == len(first) < (0.6 if name != "round" else 0.9) * len(points)
    assert np.abs(Q @ linear[first] - linear).max() < 1e-10
    assert Q.data.min() >= -1e-12 and Q.data.max() <= 1 + 1e-12
    assert np.all(np.isin(np.flatnonzero(mask), first))
    near = (graph.neighbours @ graph.neighbours).toarray() > 0
    rows, columns = Q.nonzero()
    assert np.all(near[rows, first[columns]])
    # Negative control: a quadratic function is not.
    assert np.abs(Q @ points[first] ** 2 - points ** 2).max() > 1e-2


def test_the_set_is_independent_and_maximal():
    points, graph, mask, _ = Parts(BoxMesh(5), lambda points: points[:, 2] < 0.3)
    kept = graph.Independent(mask)
    others = np.flatnonzero(kept & ~mask)
    around = graph.neighbours.toarray() > 0
    assert np.all(around[np.ix_(others, others)].sum(axis=1) == 1)      # each has itself alone
    assert np.all(around[~kept][:, kept].any(axis=1))
    assert not np.all(around[~kept][:, mask].any(axis=1))               # not by the wanted ones


def test_sides_of_a_joint_do_not_know_each_other():
    """Two bodies that touch in one plane: no value of one depends on the other, unless they are joined there."""
    left, right = Box(Pnt(0, 0, 0), Pnt(1, 1, 1)), Box(Pnt(1, 0, 0), Pnt(2, 1, 1))
    left.faces.Max(X).name = "joint"
    mesh = Mesh(OCCGeometry(Glue([left, right])).GenerateMesh(maxh=0.4))

    def Mixed(joints):
        facets = Facets(mesh, joints)
        space = PartlyContinuous(facets, 1)
        graph = VertexGraph(space)
        points = np.array(mesh.ngmesh.Coordinates())[space.vertex]
        Q = Thinned(points, graph, np.zeros(len(points), dtype=bool))
        sides = np.array([np.any(points[row.indices, 0] > 1 + 1e-9) for row in graph.incidence])
        first, second = (graph.incidence[side].sum(axis=0) > 0 for side in (sides, ~sides))
        return np.any((first @ np.abs(Q)) > 0) and bool(np.any(np.multiply(first @ np.abs(Q), second @ np.abs(Q))))

    assert Mixed([]) and not Mixed(["joint"])


def test_points_in_one_plane_or_too_few_are_all_kept():
    points, graph, _, Q = Parts(BoxMesh(1), lambda points: points[:, 2] < 0)
    assert Q.shape[1] == len(points)
