"""Facets of a mesh, fixed once: neighbours, measures, diameters; and what else is asked of a mesh."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager, nullcontext
from functools import cached_property

import numpy as np
from ngsolve import (BND, CF, ET, HEX, PRISM, PYRAMID, QUAD, TET, TRIG, VOL, BaseMatrix, CoefficientFunction, Discontinuous,
                     FESpace, FacetFESpace, GridFunction, IfPos, IntegrationRule, L2, LinearForm, Mesh, Projector,
                     TaskManager, dx, x, y, z)
from ngsolve.la import SparseMatrixd

from ..contracts import Array
from ..problem.frames import CARTESIAN, Cartesian
from ..tools import sparse as sp
from ..tools.parallel import Idle
from .components import Components
from .interfaces import Interfaces
from .ofbody import OfBody

# Vertices of NGSolve's reference elements, in the order of Element.vertices.
REFERENCE_VERTICES = {
    ET.TRIG: [(1, 0, 0), (0, 1, 0), (0, 0, 0)],
    ET.QUAD: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)],
    ET.TET: [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)],
    ET.HEX: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
    ET.PRISM: [(1, 0, 0), (0, 1, 0), (0, 0, 0), (1, 0, 1), (0, 1, 1), (0, 0, 1)],
    ET.PYRAMID: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1)]}
THREADED = 3000     # elements from which threads pay
VOLUME_TYPES = {2: (TRIG, QUAD), 3: (TET, HEX, PRISM, PYRAMID)}
# Elements by their number of vertices, and how many facets they have.
TYPES = {1: {2: ET.SEGM}, 2: {3: ET.TRIG, 4: ET.QUAD}, 3: {4: ET.TET, 5: ET.PYRAMID, 6: ET.PRISM, 8: ET.HEX}}
# Vertices of Netgen's types of elements.
CORNERS = {10: 3, 11: 4, 12: 3, 13: 4, 14: 4, 20: 4, 21: 4, 22: 5, 23: 6, 24: 6, 25: 8, 26: 8, 27: 6, 28: 5}
# Vertices of the sides of an element, in NGSolve's order of sides, each counter-clockwise seen from outside.
SIDEVERTICES: dict[ET, list[tuple[int, ...]]] = {
    ET.TRIG: [(2, 0), (1, 2), (0, 1)],
    ET.QUAD: [(0, 1), (2, 3), (3, 0), (1, 2)],
    ET.TET: [(1, 3, 2), (0, 2, 3), (0, 3, 1), (0, 1, 2)],
    ET.HEX: [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (0, 4, 7, 3)],
    ET.PRISM: [(0, 2, 1), (3, 4, 5), (0, 3, 5, 2), (0, 1, 4, 3), (1, 2, 5, 4)],
    ET.PYRAMID: [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4), (0, 3, 2, 1)]}
SIDES = {2: {3: 3, 4: 4}, 3: {4: 4, 5: 5, 6: 5, 8: 6}}


def Csr(matrix: BaseMatrix) -> sp.csr_matrix:
    """A scipy copy of an NGSolve matrix; the view that CSR() gives dies with its matrix."""
    return sp.csr_matrix(matrix.CSR(), shape=(matrix.height, matrix.width), copy=True)


def Free(space: FESpace, *, inner: bool = True) -> np.ndarray:
    """True for the free dofs of a space, (ndof,); inner=False: without those inside of elements, which condensation removes."""
    ones = GridFunction(space).vec
    ones.FV().NumPy()[:] = 1
    Projector(space.FreeDofs(not inner), True).Project(ones)     # to ask a BitArray one by one takes long
    return ones.FV().NumPy() > 0


def Native(matrix: sp.csr_matrix) -> BaseMatrix:
    """NGSolve's matrix of a scipy matrix."""
    entries = matrix.tocoo()
    return SparseMatrixd.CreateFromCOO(entries.row, entries.col, entries.data, *matrix.shape)


def Threads(mesh: Mesh) -> AbstractContextManager[object]:
    """NGSolve's threads for a loop over this mesh, or one thread: starting them costs more than a small mesh.

    They wait for the slowest of them, so that on a processor that another process keeps busy all take twice as long as one.
    """
    return TaskManager() if mesh.ne > THREADED and Idle() else nullcontext()


def Curved(mesh: Mesh) -> bool:
    """True if elements may be no images of the reference element by their vertices alone."""
    return mesh.GetCurveOrder() > 1 or mesh.deformation is not None or SecondOrder(mesh)


def SecondOrder(mesh: Mesh) -> bool:
    """True for Netgen's elements of second order, which have nodes that are no vertices."""
    elements = mesh.ngmesh.Elements2D() if mesh.dim == 2 else mesh.ngmesh.Elements3D()
    return elements.NumPy()["nodes"].shape[1] > (4 if mesh.dim == 2 else 8)


def Coordinates(dim: int) -> CoefficientFunction:
    """The CoefficientFunction (x, y) or (x, y, z)."""
    return CF((x, y, z)[:dim])


def Vertices(mesh: Mesh, dim: int) -> np.ndarray:
    """Vertex numbers of the elements of this dimension in NGSolve's local order, (n, most), filled up with -1."""
    elements = (mesh.ngmesh.Elements1D, mesh.ngmesh.Elements2D, mesh.ngmesh.Elements3D)[dim - 1]().NumPy()
    most = max(TYPES[dim])
    nodes = elements["nodes"][:, :most].astype(np.int64) - 1
    if dim > 1 and elements["nodes"].shape[1] > most:       # further nodes lie on edges and are no vertices
        kinds, kind = np.unique(elements["type"], return_inverse=True)
        nodes[np.arange(nodes.shape[1]) >= np.array([CORNERS[int(one)] for one in kinds])[kind][:, None]] = -1
    return nodes


def ByType(vertices: np.ndarray, dim: int) -> Iterator[tuple[ET, np.ndarray]]:
    """(element type, its element numbers)."""
    counts = (vertices >= 0).sum(axis=1)
    for count in np.unique(counts):
        yield TYPES[dim][int(count)], np.flatnonzero(counts == count)


def VolumePoints(mesh: Mesh, order: int) -> np.ndarray:
    """Points of a quadrature rule of this order in all elements, as a numpy array of mesh points."""
    return mesh.MapToAllElements({et: IntegrationRule(et, order) for et in VOLUME_TYPES[mesh.dim]}, VOL)


class Facets(OfBody):
    """Neighbours, measures |e| and diameters h_e of the facets of a mesh.

    `ofelements` are the facet numbers of all elements, one element after the other, each in NGSolve's local order; `incidence`
    is the sparse (facets x elements) matrix with entry |e| where e is a facet of K; all other facet data are arrays over
    facets, in the numbering of FacetFESpace.

    joints : their regions
    doubled : (2, n), boundary elements of their first and second sides where a mesh has its nodes `doubling.Doubled`; or None
    frame : in which integrals over the mesh are those over the body;  |e| and h_e are those of the mesh
    """

    def __init__(self, mesh: Mesh, joints: Iterable[str] = (), doubled: np.ndarray | None = None,
                 frame: Cartesian = CARTESIAN) -> None:
        self.mesh, self.space, self.joints, self.doubled = mesh, FacetFESpace(mesh, order=0), tuple(joints), doubled
        self.frame = frame
        # The dofs of this space are the sides of the elements, in the elements' local order.
        v, number = Discontinuous(self.space).TestFunction(), self.Function(np.arange(self.space.ndof))
        with Threads(mesh):
            measure, moment = (LinearForm(f * v * dx(element_boundary=True)).Assemble().vec.FV().NumPy().copy()
                               for f in (CF(1), number))
        self.ofelements = np.rint(moment / measure).astype(np.int64)                # over sides, element by element
        # Of sides, by the number of vertices.
        counts = np.array([SIDES[mesh.dim].get(number, 0) for number in range(self.vertices.shape[1] + 1)])
        self.starts = np.concatenate([[0], np.cumsum(counts[(self.vertices >= 0).sum(axis=1)])])
        sides = sp.csr_matrix((measure, self.ofelements, self.starts), shape=(mesh.ne, self.space.ndof))
        self.incidence = sides.T.tocsr()

    @cached_property
    def vertices(self) -> np.ndarray:
        """Vertex numbers of the elements in NGSolve's local order, (ne, most), filled up with -1."""
        return Vertices(self.mesh, self.mesh.dim)

    @cached_property
    def adjacency(self) -> sp.csr_matrix:
        """Sparse (ne, ne), nonzero for elements with a common facet and on the diagonal."""
        return self.incidence.T @ self.incidence

    @property
    def distinct(self) -> bool:
        """True if no two elements have two facets in common."""
        return self.adjacency.nnz - self.mesh.ne == 2 * int(np.sum(self.neighbours > 1))

    @cached_property
    def neighbours(self) -> np.ndarray:
        return np.diff(self.incidence.indptr)

    @cached_property
    def measure(self) -> Array:
        # A facet of a boundary element that is no side of an element takes part in nothing, and is divided by.
        return np.asarray(self.incidence.sum(axis=1)).ravel() / np.maximum(self.neighbours, 1) + (self.neighbours == 0)

    @cached_property
    def diameter(self) -> Array:
        """Largest distance of two vertices; in 2D the length of the edge."""
        if self.mesh.dim == 2:
            return self.measure
        points, found = self.mesh.ngmesh.Coordinates(), np.ones(self.space.ndof)
        for facet in self.mesh.facets:      # also those that refinement has halved, to which the space gives no number
            found[[*self.space.GetDofNrs(facet)]] = max(np.linalg.norm(points[a.nr] - points[b.nr])
                                                        for a in facet.vertices for b in facet.vertices)
        return found

    @cached_property
    def orientation(self) -> CoefficientFunction:
        """1 in the element that fixes the normal of a facet and -1 in the other one.

        It is the one with the smaller number, on named boundaries inside the body the one on the side that `Interfaces` tells.
        A CoefficientFunction for integrals over element boundaries.
        """
        second = (self.interfaces.sign < 0) & (self.neighbours > 1)                 # over facets, as all that follows
        # Facets of boundary elements that are no side of an element have none.
        known, first = self.neighbours > 0, np.zeros(self.space.ndof)
        first[known] = self.incidence.indices[(self.incidence.indptr[:-1] + second)[known]]
        number = GridFunction(L2(self.mesh, order=0))
        number.vec.FV().NumPy()[:] = np.arange(self.mesh.ne)
        return IfPos(0.25 - (self.Function(first) - number) ** 2, 1, -1)

    @cached_property
    def interfaces(self) -> Interfaces:
        """Which side's outward normal is that of a named boundary inside the body."""
        return Interfaces(self)

    @cached_property
    def cut(self) -> np.ndarray:
        """True for the facets of joints, across which nothing hangs together, over facets."""
        cut = np.zeros(len(self.neighbours), dtype=bool)
        for region in self.joints:
            cut |= self.On(region)
        return cut

    @cached_property
    def beyond(self) -> np.ndarray:
        """True for the facets of the second sides of joints where nodes are doubled, over facets."""
        beyond = np.zeros(len(self.neighbours), dtype=bool)
        if self.doubled is not None:
            beyond[self.boundary[0][self.doubled[1]]] = True
        return beyond

    @cached_property
    def component(self) -> np.ndarray:
        """Number of the connected part of the mesh, over elements; parts hang together through facets that are no joints."""
        return Components(self)

    @cached_property
    def boundary(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of the boundary elements: numbers of facet (n,) and region (n,), vertex numbers (n, most) filled up with -1."""
        pairs = [(element.dofs[0], element.index) for element in self.space.Elements(BND)]
        return *np.array(pairs, dtype=np.int64).reshape(-1, 2).T, Vertices(self.mesh, self.mesh.dim - 1)

    @cached_property
    def proper(self) -> np.ndarray:
        """True for the boundary elements whose vertices are those of a side of an element, (n,)."""
        numbers, _, vertices = self.boundary
        proper = self.neighbours[numbers] > 0
        near = np.flatnonzero(proper)
        elements = self.incidence.indices[self.incidence.indptr[numbers[near]]]
        for et, rows in ByType(self.vertices[elements], self.mesh.dim):
            here, sides = near[rows], np.full((len(SIDEVERTICES[et]), vertices.shape[1]), -1)
            for side, local in enumerate(SIDEVERTICES[et]):
                sides[side, :len(local)] = local
            own = self.ofelements[self.starts[elements[rows]][:, None] + np.arange(len(sides))]
            local = sides[(own == numbers[here, None]).argmax(axis=1)]
            expected = np.where(local >= 0, np.take_along_axis(self.vertices[elements[rows]], local, axis=1), -1)
            proper[here] = np.all(np.sort(expected, axis=1) == np.sort(vertices[here], axis=1), axis=1)
        return proper

    def On(self, region: str) -> np.ndarray:
        """True for the facets of a boundary region that are sides of elements, over facets."""
        facets, regions, _ = self.boundary
        on = np.zeros(self.space.ndof, dtype=bool)
        on[facets[np.array(list(self.mesh.Boundaries(region).Mask()))[regions]]] = True
        return on & (self.neighbours > 0)

    def Touching(self, facets: np.ndarray) -> np.ndarray:
        """True for the elements at any of the given facets (a mask), over elements."""
        return self.incidence.T @ facets.astype(float) > 0

    def Around(self, facets: np.ndarray) -> np.ndarray:
        """True for all facets of the elements at any of the given ones, over facets."""
        return self.incidence @ self.Touching(facets).astype(float) > 0

    def Function(self, values: Array) -> GridFunction:
        """Piecewise constant function on the facets."""
        function = GridFunction(self.space)
        function.vec.FV().NumPy()[:] = values
        return function

    def LargestNeighbour(self, values: Array) -> Array:
        """max over the neighbours of a facet of values given on elements, over facets."""
        pattern = self.incidence.indptr[:-1][self.neighbours > 0]
        largest = np.zeros(len(self.neighbours))
        largest[self.neighbours > 0] = np.maximum.reduceat(values[self.incidence.indices], pattern)
        return largest


def Projected(space: FESpace, function: CoefficientFunction) -> Array:
    """Coefficients (ndof,) of a vector CoefficientFunction in a space, by NGSolve's `Set`, component by component.

    All components at once would take element matrices out of a heap of fixed size, which hexahedra of order 5 overflow.
    """
    projection = GridFunction(space)
    for number, component in enumerate(projection.components):
        # With its default rule Set reproduces functions of the space on curved elements too; with a bonus it does not.
        component.Set(function[number])
    return projection.vec.FV().NumPy().copy()


def RigidMotions(dim: int) -> list[CoefficientFunction]:
    """CoefficientFunctions of a basis of the rigid motions: translations along the axes, then rotations about the origin.

    Tested with a traction, they give the components of the resultant force and of its moment about the origin.
    """
    if dim == 2:
        return [CF((1, 0)), CF((0, 1)), CF((-y, x))]
    return [CF((1, 0, 0)), CF((0, 1, 0)), CF((0, 0, 1)), CF((0, -z, y)), CF((z, 0, -x)), CF((-y, x, 0))]


def RigidMotionsAt(coordinates: Array) -> Array:
    """The same basis at points (n, d), as an array (modes, n, d)."""
    n, dim = coordinates.shape
    modes = [np.tile(axis, (n, 1)) for axis in np.eye(dim)]
    for a, b in [(0, 1)] if dim == 2 else [(1, 2), (2, 0), (0, 1)]:
        rotation = np.zeros((n, dim))
        rotation[:, a], rotation[:, b] = -coordinates[:, b], coordinates[:, a]
        modes.append(rotation)
    return np.array(modes)
