"""Batches of facets and of elements that look alike: the same element types around, the same number of shape functions."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from ngsolve import EDGE, FACE, FacetFESpace, NodeId

from ..mesh.facets import SIDES, THREADED, TYPES
from ..tools.parallel import Cached
from .elements import Batches, Equal
from .integrals import Cells


@dataclass(frozen=True)
class Side:
    """n sides of elements of one group with one number of facet functions: rows in the group, local numbers of the sides."""

    group: int
    cells: Cells
    rows: np.ndarray
    slots: np.ndarray
    sign: np.ndarray        # (n,), 1 where this element fixes the orientation, else -1

    @Cached
    def _parts(self):
        """[(members, their elements, s)]."""
        return [(members, self.cells.Part(self.rows[members]), int(self.slots[members[0]])) for members in Equal(self.slots)]

    def Blocks(self, compute):
        """compute(cells, s) of the sides, (n, ...)."""
        result = None
        for members, part, s in self._parts:
            computed = compute(part, s)
            if len(self._parts) == 1:
                return computed
            if result is None:
                result = np.empty((len(self.rows), *computed.shape[1:]))
            result[members] = computed
        return result


@dataclass(frozen=True)
class FacetPatch:
    """n facets with their one or two elements: facets (n,), elements (n, 1 or 2), sides one for each column.

    No element occurs twice in a column.
    """

    facets: np.ndarray
    elements: np.ndarray
    sides: tuple


@dataclass(frozen=True)
class Star:
    """n elements of one group with their neighbours across E0.

    rows in the group, cells : its Part of them
    elements (n, 1 + neighbours): the element first; arms: for each facet in E0 the own side, its number (n,), and the
    neighbour's side or None
    """

    group: int
    rows: np.ndarray
    cells: Cells
    elements: np.ndarray
    arms: tuple


class Patches:
    """The elements of a mesh by type, their sides, and batches of facets and of elements with their neighbours.

    Parameters
    ----------
    material, facets : of the Discretization;  order : k;  liftorder : l
    share : weight of a side in the averages, over facets: 1/2 inside, 1 on Gamma_D and rollers, 0 off E0
    rollers : True for roller facets, over facets
    """

    def __init__(self, material, facets, order, liftorder, share, rollers):
        mesh = facets.mesh
        self.mesh, self.dim, self.material, self.facets, self.share = mesh, mesh.dim, material, facets, share
        self.order, self.liftorder, self.many = order, liftorder, mesh.ne > THREADED
        self.cells = list(self._Groups(rollers))
        self._TabulateSides()

    def _Groups(self, rollers):
        nodes, facets = self.facets.vertices, self.facets
        counts = (nodes >= 0).sum(axis=1)
        for count in np.unique(counts):
            elements = np.flatnonzero(counts == count)
            numbers = facets.ofelements[facets.starts[elements][:, None] + np.arange(SIDES[self.dim][count])]
            yield Cells(self.mesh, self.material, TYPES[self.dim][count], elements, nodes[elements, :count], numbers,
                        rollers[numbers], self.order, self.liftorder)

    def _TabulateSides(self):
        """The sides of the elements, sorted by facet and element, as arrays; and where the sides of a facet begin."""
        columns, sizes = [], []
        for g, cells in enumerate(self.cells):
            for s in cells.sides:
                n = len(cells.elements)
                columns.append(np.array([cells.facets[:, s], cells.elements, np.full(n, g), np.arange(n), np.full(n, s)]))
                sizes.append(np.full(n, cells.nm(s)))
        facet, element, group, row, slot = np.concatenate(columns, axis=1)
        order = np.argsort(facet * self.mesh.ne + element)
        self._facet, self._element, self._row = (column[order].astype(np.int32) for column in (facet, element, row))
        self._group, self._slot = (column[order].astype(np.int8) for column in (group, slot))
        self._first = np.searchsorted(self._facet, np.arange(len(self.share), dtype=np.int32))
        self.tracesizes = self._TraceSizes(np.concatenate(sizes)[order])

    def _TraceSizes(self, sizes):
        """Scalar dofs of F_h on each facet, from those of the sides in the table."""
        found = np.empty(len(self.share), dtype=np.int64)
        found[self._facet] = sizes
        # A boundary element that is no side of an element has a facet in NGSolve's numbering.
        lost = np.flatnonzero(self.facets.neighbours == 0)
        if len(lost):
            space, kind = FacetFESpace(self.mesh, order=self.order), EDGE if self.dim == 2 else FACE
            found[lost] = [len(space.GetDofNrs(NodeId(kind, int(facet)))) for facet in lost]
        return found

    def _Side(self, numbers):
        """The sides with these numbers in the table, all of one group and size."""
        group = int(self._group[numbers[0]])
        return Side(group, self.cells[group], self._row[numbers], self._slot[numbers],
                    np.where(numbers == self._first[self._facet[numbers]], 1.0, -1.0))

    def FacetPatches(self, wanted=None, *, weak=True):
        """FacetPatches of the facets of E0, or of those where `wanted` is True; also of others with weak=False."""
        chosen = (self.share if weak else self.facets.neighbours) > 0
        chosen = np.flatnonzero(chosen if wanted is None else wanted & chosen)
        first, two = self._first[chosen], self.facets.neighbours[chosen] > 1
        second = np.minimum(first + 1, len(self._group) - 1)
        for members in Equal(self._group[first], self._slot[first], np.where(two, self._group[second], -1),
                             np.where(two, self._slot[second], -1)):
            paired = two[members[0]]
            entries = ((1 + paired) * self.dim * self.cells[0].na) ** 2
            for part in Batches(members, entries):
                numbers = (first[part], first[part] + 1) if paired else (first[part],)
                yield FacetPatch(chosen[part], np.stack([self._element[number] for number in numbers], axis=1).astype(np.int64),
                                 tuple(self._Side(number) for number in numbers))

    def Stars(self, wanted=None):
        """Stars of all elements with facets in E0, or of those where `wanted` is True, over elements."""
        for g, cells in enumerate(self.cells):
            own, across = self._sidesof[g]
            active = self.share[cells.facets] > 0
            neighbour = np.where(active & (across >= 0), self._group[across], -1)
            rows = np.flatnonzero(active.any(axis=1) & (True if wanted is None else wanted[cells.elements]))
            for members in Equal(*active[rows].T, *neighbour[rows].T):
                for part in Batches(rows[members], ((1 + len(cells.sides)) * self.dim * cells.na) ** 2):
                    arms, elements = [], [cells.elements[part]]
                    for s in np.flatnonzero(active[part[0]]):
                        beyond = None
                        if neighbour[part[0], s] >= 0:
                            beyond = self._Side(across[part, s])
                            elements.append(self._element[across[part, s]])
                        arms.append((self._Side(own[part, s]), cells.facets[part, s], beyond))
                    yield Star(g, part, cells.Part(part), np.stack(elements, axis=1), tuple(arms))

    @cached_property
    def _sidesof(self):
        """For each group: numbers (n, nf) of the elements' sides in the table, and of the sides across, -1 on the boundary."""
        found = [(np.empty(cells.facets.shape, dtype=np.int64), np.full(cells.facets.shape, -1)) for cells in self.cells]
        for g, (own, across) in enumerate(found):
            numbers = np.flatnonzero(self._group == g)
            own[self._row[numbers], self._slot[numbers]] = numbers
            first = self._first[self._facet[numbers]]
            two = self.facets.neighbours[self._facet[numbers]] > 1
            across[self._row[numbers], self._slot[numbers]] = np.where(two, 2 * first + 1 - numbers, -1)
        return found

