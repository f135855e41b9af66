"""Batches of facets and of elements that look alike: the same element types around, the same number of shape functions."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np
from ngsolve import EDGE, FACE, FacetFESpace, NodeId

from ..contracts import Array
from ..mesh.facets import SIDES, THREADED, TYPES, Facets
from ..problem.materials import AnisotropicMaterial, HookeMaterial
from ..tools.parallel import Cached
from .elements import Batches, Equal
from .integrals import ElementGroup
from .revolved import RevolvedGroup


@dataclass(frozen=True)
class Side:
    """n sides of elements of one group with one number of facet functions."""

    number: int             # of the group
    group: ElementGroup
    rows: np.ndarray        # (n,) of the elements in the group
    slots: np.ndarray       # (n,) local numbers s of the sides
    sign: np.ndarray        # (n,) 1 where this element fixes the orientation, else -1

    @Cached
    def _parts(self) -> list[tuple[np.ndarray, ElementGroup, int]]:
        """[(members, their elements, s)]."""
        return [(members, self.group.Part(self.rows[members]), int(self.slots[members[0]])) for members in Equal(self.slots)]

    def Blocks(self, compute: Callable[[ElementGroup, int], Array]) -> Array:
        """compute(group, s) of the sides, (n, ...)."""
        result: Array | None = None
        for members, part, s in self._parts:
            computed = compute(part, s)
            if len(self._parts) == 1:
                return computed
            if result is None:
                result = np.empty((len(self.rows), *computed.shape[1:]))
            result[members] = computed
        return cast(Array, result)


@dataclass(frozen=True)
class FacetPatch:
    """n facets with their one or two elements; no element occurs twice in a column."""

    facets: np.ndarray      # (n,)
    elements: np.ndarray    # (n, e), e = 1 or 2
    sides: tuple[Side, ...]     # one for each column e


@dataclass(frozen=True)
class Star:
    """n elements of one group with their neighbours across E0.

    number of the group, rows in it, group : its Part of them
    elements (n, 1 + neighbours): the element first; arms: for each facet in E0 the own side, its number (n,), and the
    neighbour's side or None
    """

    number: int
    rows: np.ndarray
    group: ElementGroup
    elements: np.ndarray
    arms: tuple[tuple[Side, np.ndarray, Side | None], ...]


class Patches:
    """The elements of a mesh by type, their sides, and batches of facets and of elements with their neighbours.

    Parameters
    ----------
    material, facets : of the Discretization;  order : k;  liftorder : l
    share : weight of a side in the averages, over facets: 1/2 inside, 1 on Gamma_D and rollers, 0 off E0
    rollers : True for roller facets, over facets;  extra : degrees of quadrature beyond products of two functions
    """

    def __init__(self, material: HookeMaterial | AnisotropicMaterial, facets: Facets, order: int, liftorder: int, share: Array,
                 rollers: np.ndarray, extra: int = 0) -> None:
        mesh = facets.mesh
        self.mesh, self.dim, self.material, self.facets, self.share = mesh, mesh.dim, material, facets, share
        self.order, self.liftorder, self.many = order, liftorder, mesh.ne > THREADED
        self.groups = list(self._Groups(rollers, extra))
        self._TabulateSides()

    def _Groups(self, rollers: np.ndarray, extra: int) -> Iterator[ElementGroup]:
        nodes, facets = self.facets.vertices, self.facets
        counts = (nodes >= 0).sum(axis=1)
        for count in np.unique(counts):
            elements = np.flatnonzero(counts == count)
            numbers = facets.ofelements[facets.starts[elements][:, None] + np.arange(SIDES[self.dim][count])]
            Group = RevolvedGroup if facets.frame.revolved else ElementGroup
            yield Group(self.mesh, self.material, TYPES[self.dim][count], elements, nodes[elements, :count], numbers,
                        rollers[numbers], self.order, self.liftorder, extra + facets.frame.bonus)

    def _TabulateSides(self) -> None:
        """The sides of the elements, sorted by facet and element, as arrays; and where the sides of a facet begin."""
        columns, sizes = [], []
        for number, group in enumerate(self.groups):
            for s in group.sides:
                n = len(group.elements)
                columns.append(np.array([group.facets[:, s], group.elements, np.full(n, number), np.arange(n), np.full(n, s)]))
                sizes.append(np.full(n, group.nb(s)))
        facet, element, number, row, slot = np.concatenate(columns, axis=1)     # each over all sides
        order = np.argsort(facet * self.mesh.ne + element)
        self._facet, self._element, self._row = (column[order].astype(np.int32) for column in (facet, element, row))
        self._group, self._slot = (column[order].astype(np.int8) for column in (number, slot))
        self._first = np.searchsorted(self._facet, np.arange(len(self.share), dtype=np.int32))
        self.facetsizes = self._FacetSizes(np.concatenate(sizes)[order])

    def _FacetSizes(self, sizes: np.ndarray) -> np.ndarray:
        """Scalar dofs of F_h on each facet, from those of the sides in the table."""
        found = np.empty(len(self.share), dtype=np.int64)
        found[self._facet] = sizes
        # A boundary element that is no side of an element has a facet in NGSolve's numbering.
        lost = np.flatnonzero(self.facets.neighbours == 0)
        if len(lost):
            space, kind = FacetFESpace(self.mesh, order=self.order), EDGE if self.dim == 2 else FACE
            found[lost] = [len(space.GetDofNrs(NodeId(kind, int(facet)))) for facet in lost]
        return found

    def _Side(self, numbers: np.ndarray) -> Side:
        """The sides with these numbers in the table, all of one group and size."""
        number = int(self._group[numbers[0]])
        return Side(number, self.groups[number], self._row[numbers], self._slot[numbers],
                    np.where(numbers == self._first[self._facet[numbers]], 1.0, -1.0))

    def FacetPatches(self, wanted: np.ndarray | None = None, *, weak: bool = True) -> Iterator[FacetPatch]:
        """FacetPatches of the facets of E0, or of those where `wanted` is True; also of others with weak=False."""
        possible = (self.share if weak else self.facets.neighbours) > 0
        chosen = np.flatnonzero(possible if wanted is None else wanted & possible)
        first, two = self._first[chosen], self.facets.neighbours[chosen] > 1
        second = np.minimum(first + 1, len(self._group) - 1)
        for members in Equal(self._group[first], self._slot[first], np.where(two, self._group[second], -1),
                             np.where(two, self._slot[second], -1)):
            paired = two[members[0]]
            entries = ((1 + paired) * self.dim * self.groups[0].na) ** 2        # (k e a) squared
            for part in Batches(members, entries):
                numbers = (first[part], first[part] + 1) if paired else (first[part],)
                yield FacetPatch(chosen[part], np.stack([self._element[number] for number in numbers], axis=1).astype(np.int64),
                                 tuple(self._Side(number) for number in numbers))

    def Stars(self, wanted: np.ndarray | None = None) -> Iterator[Star]:
        """Stars of all elements with facets in E0, or of those where `wanted` is True, over elements."""
        for number, group in enumerate(self.groups):
            own, across = self._sidesof[number]
            active = self.share[group.facets] > 0       # n, s
            neighbour = np.where(active & (across >= 0), self._group[across], -1)
            rows = np.flatnonzero(active.any(axis=1) & (True if wanted is None else wanted[group.elements]))
            for members in Equal(*active[rows].T, *neighbour[rows].T):
                for part in Batches(rows[members], ((1 + len(group.sides)) * self.dim * group.na) ** 2):
                    arms, elements = [], [group.elements[part]]
                    for s in np.flatnonzero(active[part[0]]):
                        beyond = None
                        if neighbour[part[0], s] >= 0:
                            beyond = self._Side(across[part, s])
                            elements.append(self._element[across[part, s]])
                        arms.append((self._Side(own[part, s]), group.facets[part, s], beyond))
                    yield Star(number, part, group.Part(part), np.stack(elements, axis=1), tuple(arms))

    def Signs(self, number: int) -> Array:
        """1 where the element fixes the orientation of the facet, else -1, on the sides (n, s) of a group."""
        own, _ = self._sidesof[number]
        return np.where(own == self._first[self.groups[number].facets], 1.0, -1.0)

    @cached_property
    def _sidesof(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """For each group: numbers (n, s) of the elements' sides in the table, and of the sides across, -1 on the boundary."""
        found = [(np.empty(group.facets.shape, dtype=np.int64), np.full(group.facets.shape, -1)) for group in self.groups]
        for number, (own, across) in enumerate(found):
            numbers = np.flatnonzero(self._group == number)
            own[self._row[numbers], self._slot[numbers]] = numbers
            first = self._first[self._facet[numbers]]
            two = self.facets.neighbours[self._facet[numbers]] > 1
            across[self._row[numbers], self._slot[numbers]] = np.where(two, 2 * first + 1 - numbers, -1)
        return found

