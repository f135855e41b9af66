"""Batches of facets and of elements that look alike: the same element types around, the same number of shape functions."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from ngsolve import ET, VOL

from .cells import Cells
from .facets import THREADED
from .geometry import Equal
from .shapes import FACETS

TYPES = {2: {3: ET.TRIG, 4: ET.QUAD}, 3: {4: ET.TET, 5: ET.PYRAMID, 6: ET.PRISM, 8: ET.HEX}}      # by number of vertices
BATCH = 1 << 19     # matrix entries worked on at once: large enough for numpy, small enough for the cache and the memory


@dataclass(frozen=True)
class Side:
    """n sides of elements of one group: rows in the group, positions among its sides of this size."""

    group: int
    size: int
    rows: np.ndarray
    positions: np.ndarray
    sign: np.ndarray        # (n,), 1 where this element fixes the orientation, else -1


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

    elements (n, 1 + neighbours): the element first; arms: for each facet in E0 the own side, its number (n,), and the
    neighbour's side or None
    """

    group: int
    rows: np.ndarray
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
        self.slots = [self._SlotsBySize(cells) for cells in self.cells]
        self._TabulateSides()

    def _Groups(self, rollers):
        nodes = self._Vertices()
        counts = (nodes >= 0).sum(axis=1)
        sides = np.zeros(counts.max() + 1, dtype=np.int64)
        for count, et in TYPES[self.dim].items():
            sides[count:count + 1] = len(FACETS[et])
        starts = np.cumsum(sides[counts]) - sides[counts]
        for count in np.unique(counts):
            elements = np.flatnonzero(counts == count)
            numbers = self.facets.ofelements[starts[elements][:, None] + np.arange(sides[count])]
            yield Cells(self.mesh, self.material, TYPES[self.dim][count], elements, nodes[elements, :count], numbers,
                        rollers[numbers], self.order, self.liftorder)

    def _Vertices(self):
        """Vertex numbers of the elements (ne, most), filled up with -1."""
        elements = self.mesh.ngmesh.Elements2D() if self.dim == 2 else self.mesh.ngmesh.Elements3D()
        nodes = elements.NumPy()["nodes"].astype(np.int64) - 1
        if nodes.shape[1] > max(TYPES[self.dim]):       # with points on edges, which are no vertices
            found = [[vertex.nr for vertex in element.vertices] for element in self.mesh.Elements(VOL)]
            nodes = np.array([one + [-1] * (max(TYPES[self.dim]) - len(one)) for one in found])
        return nodes

    @staticmethod
    def _SlotsBySize(cells):
        slots = {}
        for s in cells.sides:
            slots.setdefault(cells.nm(s), []).append(s)
        return slots

    def _TabulateSides(self):
        """The sides of the elements, sorted by facet and element, as arrays; and where the sides of a facet begin."""
        columns = []
        for g, cells in enumerate(self.cells):
            for size, slots in self.slots[g].items():
                for position, s in enumerate(slots):
                    n = len(cells.elements)
                    columns.append(np.array([cells.facets[:, s], cells.elements, np.full(n, g), np.arange(n),
                                             np.full(n, size), np.full(n, position), np.full(n, s)]))
        table = np.concatenate(columns, axis=1)
        table = table[:, np.argsort(table[0] * self.mesh.ne + table[1])]
        (self._facet, self._element, self._group, self._row, self._size, self._position, self._slot) = table
        self._first = np.searchsorted(self._facet, np.arange(len(self.share)))
        self.tracesizes = self._size[self._first]

    def _Side(self, numbers):
        """The sides with these numbers in the table, all of one group and size."""
        return Side(int(self._group[numbers[0]]), int(self._size[numbers[0]]), self._row[numbers], self._position[numbers],
                    np.where(numbers == self._first[self._facet[numbers]], 1.0, -1.0))

    def FacetPatches(self, wanted=None, *, weak=True):
        """FacetPatches of the facets of E0, or of those where `wanted` is True; also of others with weak=False."""
        chosen = self.share > 0 if weak else np.ones(len(self.share), dtype=bool)
        chosen = np.flatnonzero(chosen if wanted is None else wanted & chosen)
        first, two = self._first[chosen], self.facets.neighbours[chosen] > 1
        second = np.minimum(first + 1, len(self._group) - 1)
        for members in Equal(self._group[first], self._slot[first], np.where(two, self._group[second], -1),
                             np.where(two, self._slot[second], -1)):
            paired = two[members[0]]
            entries = ((1 + paired) * self.dim * self.cells[0].na) ** 2
            for part in _Parts(members, entries):
                numbers = (first[part], first[part] + 1) if paired else (first[part],)
                yield FacetPatch(chosen[part], np.stack([self._element[number] for number in numbers], axis=1),
                                 tuple(self._Side(number) for number in numbers))

    def Stars(self, wanted=None):
        """Stars of all elements with facets in E0, or of those where `wanted` is True, over elements."""
        for g, cells in enumerate(self.cells):
            own, across = self._sidesof[g]
            active = self.share[cells.facets] > 0
            neighbour = np.where(active & (across >= 0), self._group[across], -1)
            rows = np.flatnonzero(active.any(axis=1) & (True if wanted is None else wanted[cells.elements]))
            for members in Equal(*active[rows].T, *neighbour[rows].T):
                for part in _Parts(rows[members], ((1 + len(cells.sides)) * self.dim * cells.na) ** 2):
                    arms, elements = [], [cells.elements[part]]
                    for s in np.flatnonzero(active[part[0]]):
                        beyond = None
                        if neighbour[part[0], s] >= 0:
                            beyond = self._Side(across[part, s])
                            elements.append(self._element[across[part, s]])
                        arms.append((self._Side(own[part, s]), cells.facets[part, s], beyond))
                    yield Star(g, part, np.stack(elements, axis=1), tuple(arms))

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


def _Parts(members, entries):
    """Batches of members whose matrices have that many entries each."""
    size = max(1, int(BATCH // max(entries, 1)))
    for begin in range(0, len(members), size):
        yield members[begin:begin + size]
