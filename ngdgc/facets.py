"""Facets of a mesh, fixed once: neighbours, measures, diameters, and quadrature on boundary regions."""

from contextlib import nullcontext
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

import numpy as np
import scipy.sparse as sp
from ngsolve import (BND, CF, ET, HEX, PRISM, PYRAMID, QUAD, SEGM, TET, TRIG, VOL, BilinearForm, ElementId, FacetFESpace,
                     GridFunction, IfPos, IntegrationRule, L2, LinearForm, TaskManager, ds, dx, specialcf, x, y, z)
from ngsolve.la import SparseMatrixd

# Vertices of NGSolve's reference elements, in the order of Element.vertices.
REFERENCE_VERTICES = {
    ET.TRIG: [(1, 0, 0), (0, 1, 0), (0, 0, 0)],
    ET.QUAD: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)],
    ET.TET: [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)],
    ET.HEX: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
    ET.PRISM: [(1, 0, 0), (0, 1, 0), (0, 0, 0), (1, 0, 1), (0, 1, 1), (0, 0, 1)],
    ET.PYRAMID: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1)],
}
THREADED = 3000     # elements from which threads pay
VOLUME_TYPES = {2: (TRIG, QUAD), 3: (TET, HEX, PRISM, PYRAMID)}
BOUNDARY_TYPES = {2: (SEGM,), 3: (TRIG, QUAD)}


def Csr(matrix):
    """A scipy copy of an NGSolve matrix; the view that CSR() gives dies with its matrix."""
    return sp.csr_matrix(matrix.CSR(), shape=(matrix.height, matrix.width), copy=True)


def Native(matrix):
    """NGSolve's matrix of a scipy matrix."""
    entries = matrix.tocoo()
    return SparseMatrixd.CreateFromCOO(entries.row, entries.col, entries.data, *matrix.shape)


def Threads(mesh):
    """NGSolve's threads for a loop over this mesh: starting them costs more than a small mesh, much more on a busy machine."""
    return TaskManager() if mesh.ne > THREADED else nullcontext()


def Curved(mesh):
    """True if elements may be no images of the reference element by their vertices alone."""
    if mesh.GetCurveOrder() > 1 or mesh.deformation is not None:
        return True
    elements = mesh.ngmesh.Elements2D() if mesh.dim == 2 else mesh.ngmesh.Elements3D()
    # Netgen's second-order elements have nodes that are no vertices.
    return elements.NumPy()["nodes"].shape[1] > (4 if mesh.dim == 2 else 8)


def Coordinates(dim):
    """The CoefficientFunction (x, y) or (x, y, z)."""
    return CF((x, y, z)[:dim])


def VolumePoints(mesh, order):
    """Points of a quadrature rule of this order in all elements, as a numpy array of mesh points."""
    return mesh.MapToAllElements({et: IntegrationRule(et, order) for et in VOLUME_TYPES[mesh.dim]}, VOL)


class Facets:
    """Neighbours, measures |e| and diameters h_e of the facets of a mesh.

    `incidence` is the sparse (facets x elements) matrix with entry |e| where e is a facet of K; all other facet data
    are arrays over facets, in the numbering of FacetFESpace.
    """

    def __init__(self, mesh):
        self.mesh = mesh
        elements, self.space = L2(mesh, order=0), FacetFESpace(mesh, order=0)
        form = BilinearForm(trialspace=elements, testspace=self.space)
        form += elements.TrialFunction() * self.space.TestFunction() * dx(element_boundary=True)
        with Threads(mesh):
            form.Assemble()
        self.incidence = Csr(form.mat)

    @cached_property
    def ofelements(self):
        """Facet numbers of all elements, one element after the other, each in NGSolve's local order."""
        return np.fromiter(chain.from_iterable(element.dofs for element in self.space.Elements(VOL)), dtype=np.int64)

    @cached_property
    def distinct(self):
        """True if no two elements have two facets in common."""
        pairs = self.incidence.T @ self.incidence
        return pairs.nnz - self.mesh.ne == 2 * int(np.sum(self.neighbours > 1))

    @cached_property
    def neighbours(self):
        return np.diff(self.incidence.indptr)

    @cached_property
    def measure(self):
        return np.asarray(self.incidence.sum(axis=1)).ravel() / np.maximum(self.neighbours, 1)

    @cached_property
    def diameter(self):
        """Largest distance of two vertices; in 2D the length of the edge."""
        if self.mesh.dim == 2:
            return self.measure
        points = self.mesh.ngmesh.Coordinates()
        return np.array([max(np.linalg.norm(points[a.nr] - points[b.nr]) for a in facet.vertices for b in facet.vertices)
                         for facet in self.mesh.facets])

    @cached_property
    def orientation(self):
        """1 in the element that fixes the normal of a facet, the one with the smaller number, and -1 in the other one.

        A CoefficientFunction for integrals over element boundaries.
        """
        first = self.Function(self.incidence.indices[self.incidence.indptr[:-1]])
        number = GridFunction(L2(self.mesh, order=0))
        number.vec.FV().NumPy()[:] = np.arange(self.mesh.ne)
        return IfPos(0.25 - (first - number) ** 2, 1, -1)

    @cached_property
    def component(self):
        """Number of the connected part of the mesh, over elements; parts hang together through facets."""
        return sp.csgraph.connected_components(self.incidence.T @ self.incidence, directed=False)[1]

    def On(self, region):
        """True for the facets of a boundary region, over facets."""
        form = LinearForm(self.space.TestFunction() * ds(skeleton=True, definedon=self.mesh.Boundaries(region)))
        return form.Assemble().vec.FV().NumPy() > 0

    def Touching(self, facets):
        """True for the elements at any of the given facets (a mask), over elements."""
        return self.incidence.T @ facets.astype(float) > 0

    def Around(self, facets):
        """True for all facets of the elements at any of the given ones, over facets."""
        return self.incidence @ self.Touching(facets).astype(float) > 0

    def Function(self, values):
        """Piecewise constant function on the facets."""
        function = GridFunction(self.space)
        function.vec.FV().NumPy()[:] = values
        return function

    def LargestNeighbour(self, values):
        """max over the neighbours of a facet of values given on elements, over facets."""
        pattern = self.incidence.indptr[:-1][self.neighbours > 0]
        largest = np.zeros(len(self.neighbours))
        largest[self.neighbours > 0] = np.maximum.reduceat(values[self.incidence.indices], pattern)
        return largest


@dataclass(frozen=True)
class BoundaryQuadrature:
    """Points of a quadrature rule on a boundary region, n points in d dimensions.

    `points` are NGSolve mesh points on the boundary and `inside` the same points in the adjacent volume elements;
    `coordinates` (n, d), `normals` (n, d) outward, `weights` (n,) contain the surface measure; `elements` (n,) is the
    number of the adjacent volume element, `facets` (n,) of the boundary element.
    """

    points: np.ndarray
    inside: np.ndarray
    coordinates: np.ndarray
    normals: np.ndarray
    weights: np.ndarray

    @property
    def elements(self):
        return self.inside["nr"]

    @property
    def facets(self):
        return self.points["nr"]

    @classmethod
    def On(cls, facets, region, rules):
        """The quadrature by `rules`: {boundary element type: IntegrationRule}, or the degree of NGSolve's rules."""
        mesh, dim = facets.mesh, facets.mesh.dim
        rules = {et: rules[et] if isinstance(rules, dict) else IntegrationRule(et, rules) for et in BOUNDARY_TYPES[dim]}
        points = mesh.MapToAllElements(rules, mesh.Boundaries(region))
        jacobian = specialcf.JacobianMatrix(dim, dim - 1)(points).reshape(len(points), dim, dim - 1)
        measure = np.sqrt(np.linalg.det(np.swapaxes(jacobian, 1, 2) @ jacobian))
        weights, inside, normals = measure.copy(), points.copy(), np.empty((len(points), dim))
        inside["VorB"] = 0
        starts = np.flatnonzero(np.diff(points["nr"], prepend=-1))
        for start in starts:
            number = int(points["nr"][start])
            element = mesh[ElementId(BND, number)]
            here = slice(start, start + len(rules[element.type]))
            weights[here] *= rules[element.type].weights
            volume = mesh[ElementId(VOL, cls._Neighbour(facets, number))]
            vertices = np.array(REFERENCE_VERTICES[volume.type], dtype=float)
            corners = vertices[[list(volume.vertices).index(vertex) for vertex in element.vertices]]
            normals[here] = ReferenceNormal(corners, vertices.mean(axis=0), dim)
            inside["nr"][here] = volume.nr
            reference = VertexFunctions(element.type, points["x"][here], points["y"][here]) @ corners
            for axis, values in zip("xyz", reference.T):
                inside[axis][here] = values
        # NGSolve's normal at boundary points follows the orientation of the boundary element, which may point into the body
        # (holes, mirrored meshes); the reference normal of the adjacent element, mapped as a covector, always points outward.
        mapping = specialcf.JacobianMatrix(dim, dim)(inside).reshape(-1, dim, dim)
        normals = np.linalg.solve(np.swapaxes(mapping, 1, 2), normals[..., None])[..., 0]
        return cls(points=points, inside=inside, weights=weights,
                   coordinates=np.asarray(Coordinates(dim)(points)).reshape(-1, dim),
                   normals=normals / np.linalg.norm(normals, axis=1)[:, None])

    @staticmethod
    def _Neighbour(facets, number):
        facet = facets.space.GetDofNrs(ElementId(BND, number))[0]
        return int(facets.incidence.indices[facets.incidence.indptr[facet]])


def NodalRules(order):
    """Rules for traces of continuous functions of degree k, {boundary element type: IntegrationRule}.

    On edges and quadrilaterals Gauss-Lobatto's k + 1 points in each direction, of degree 2 k - 1; on triangles the vertices for
    k = 1 and NGSolve's rule of degree 2 k - 2 else, which for k = 2 are the midpoints of the edges.
    """
    legendre = np.polynomial.legendre.Legendre.basis(order)
    nodes = np.concatenate([[-1], legendre.deriv().roots(), [1]])
    weights = 1 / (order * (order + 1) * legendre(nodes) ** 2)
    nodes = (1 + nodes) / 2
    vertices = IntegrationRule([(0, 0), (1, 0), (0, 1)], [1 / 6] * 3)
    return {SEGM: IntegrationRule([(s,) for s in nodes], weights.tolist()),
            QUAD: IntegrationRule([(s, t) for s in nodes for t in nodes], np.outer(weights, weights).ravel().tolist()),
            TRIG: vertices if order == 1 else IntegrationRule(TRIG, 2 * order - 2)}


def ReferenceNormal(corners, centre, dim):
    """Normal of a facet of the reference element, (dim,), pointing away from its centre; any length."""
    edges = (corners - corners[0])[1:, :dim]
    normal = np.array([edges[0][1], -edges[0][0]]) if dim == 2 else np.cross(edges[0], edges[1])
    return normal * np.sign(normal @ (corners[0] - centre)[:dim])


def VertexFunctions(et, s, t):
    """Values of the vertex functions of a facet's reference element, (points, vertices)."""
    if et == ET.SEGM:
        return np.stack([s, 1 - s], axis=1)
    if et == ET.TRIG:
        return np.stack([s, t, 1 - s - t], axis=1)
    return np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t], axis=1)


def BoundaryFunction(facets, gfu):
    """(vertices (n, d), one-sided values of gfu there (n, d)) of every boundary element, two lists."""
    mesh, corners, values = facets.mesh, [], []
    points = mesh.ngmesh.Coordinates()
    for element in mesh.Elements(BND):
        volume = mesh[ElementId(VOL, BoundaryQuadrature._Neighbour(facets, element.nr))]
        trafo = mesh.GetTrafo(ElementId(VOL, volume.nr))
        inside = [REFERENCE_VERTICES[volume.type][list(volume.vertices).index(vertex)] for vertex in element.vertices]
        corners.append(np.array([points[vertex.nr] for vertex in element.vertices]))
        values.append(np.array([gfu(trafo(*corner)) for corner in inside]))
    return corners, values


def RigidMotions(dim):
    """CoefficientFunctions of a basis of the rigid motions: translations along the axes, then rotations about the origin.

    Tested with a traction, they give the components of the resultant force and of its moment about the origin.
    """
    if dim == 2:
        return [CF((1, 0)), CF((0, 1)), CF((-y, x))]
    return [CF((1, 0, 0)), CF((0, 1, 0)), CF((0, 0, 1)), CF((0, -z, y)), CF((z, 0, -x)), CF((-y, x, 0))]


def RigidMotionsAt(coordinates):
    """The same basis at points (n, d), as an array (modes, n, d)."""
    n, dim = coordinates.shape
    modes = [np.tile(axis, (n, 1)) for axis in np.eye(dim)]
    for a, b in [(0, 1)] if dim == 2 else [(1, 2), (2, 0), (0, 1)]:
        rotation = np.zeros((n, dim))
        rotation[:, a], rotation[:, b] = -coordinates[:, b], coordinates[:, a]
        modes.append(rotation)
    return np.array(modes)
