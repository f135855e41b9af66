"""Elements of one type: their reference element, their geometry and C at quadrature points."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from ngsolve import ET, VOL, IntegrationRule, Mesh, specialcf

from ..contracts import Array
from ..mesh.facets import REFERENCE_VERTICES, VOLUME_TYPES, Curved, VolumePoints
from ..problem.materials import AnisotropicMaterial, HookeMaterial, StiffnessAt
from ..tools.parallel import Cached
from .reference import Reference, ReferenceElement, Shapes

if TYPE_CHECKING:       # of Python 3.11
    from typing import Self

BATCH = 1 << 19     # matrix entries worked on at once: large enough for numpy, small enough for the cache and the memory


class GroupGeometry:
    """A group: n elements of one type, and arrays over them and their quadrature points.

    elements (n,) numbers;  facets (n, s) numbers in NGSolve's local order;  rollers (n, s) True where a facet couples normal
    parts only;  vertices (n, corners) numbers;  order k;  liftorder l;  extra : degrees of quadrature beyond products of two
    functions of V_h or Q_h
    uniform : True if neither geometry nor C varies in any element
    """

    def __init__(self, mesh: Mesh, material: HookeMaterial | AnisotropicMaterial, et: ET, elements: np.ndarray,
                 vertices: np.ndarray, facets: np.ndarray, rollers: np.ndarray, order: int, liftorder: int,
                 extra: int = 0) -> None:
        self.et, self.dim = et, mesh.dim
        self.elements, self.facets, self.rollers = elements, facets, rollers
        self._kind, self._chosen = np.zeros(len(elements), dtype=np.int16), cast(Any, slice(None))      # or rows
        self._shapes: list[ReferenceElement] = []
        for kind, (rank, rows) in enumerate(_ByOrder(vertices)):
            self._kind[rows] = kind
            self._shapes.append(Reference(et, rank, order, liftorder, material.bonus + extra))
        self.reference = self._shapes[0]
        affine = self._AffineMaps(mesh, vertices)
        points = []
        if affine is None or material.bonus:
            every: list[Shapes] = [self.reference, *self.reference.facets]
            points = [self.MeshPoints(mesh, shapes) for shapes in every]
        self._geometry = self._Geometries(affine, points)
        self._boundary = self._Boundaries()
        self._stiffness = self._Stiffnesses(mesh, material, points)
        self.uniform = affine is not None and all(C.shape[1] == 1 for C in self._stiffness)
        self._Finish(mesh, vertices, points)

    def _Finish(self, mesh: Mesh, vertices: np.ndarray, points: Sequence[np.ndarray]) -> None:
        """What a frame makes of geometry and C; points (n, q) of the element and its sides where something varies in it."""

    def Part(self, rows: np.ndarray) -> Self:
        """Some of these elements, given by their rows; what is computed for them lives as long as the part."""
        part = object.__new__(type(self))
        part.et, part.dim, part.uniform, part._chosen = self.et, self.dim, self.uniform, rows
        part._shapes, part.reference, part._geometry, part._boundary, part._stiffness = (
            self._shapes, self.reference, self._geometry, self._boundary, self._stiffness)
        part.elements, part.facets, part.rollers, part._kind = (
            array[rows] for array in (self.elements, self.facets, self.rollers, self._kind))
        return part

    def With(self, make: Callable[[ReferenceElement], Any]) -> Self:
        """The same elements with other shapes, make(ReferenceElement), which see them at other points; `uniform` ones."""
        other = self.Part(np.arange(len(self.elements)))
        other._shapes = [make(shape) for shape in self._shapes]
        other.reference = other._shapes[0]
        return other

    def Parts(self, entries: int) -> Iterator[tuple[np.ndarray, Self]]:
        """(rows, Part) of batches of elements whose matrices have that many entries each."""
        for rows in Batches(np.arange(len(self.elements)), entries):
            yield rows, self.Part(rows)

    @Cached
    def rows(self) -> list[tuple[np.ndarray, ReferenceElement]]:
        """[(rows, ReferenceElement)] of the elements whose vertex numbers are ordered alike."""
        return [(rows, self._shapes[self._kind[rows[0]]]) for rows in Equal(self._kind)]

    @property
    def constant(self) -> bool:
        """True if C eps(u) is constant in every element."""
        return self.uniform and self.reference.constant

    @property
    def sides(self) -> range:
        return range(len(self.reference.facets))

    @property
    def na(self) -> int:
        """Scalar shape functions of V_h, how many letters a there are."""
        return self.reference.dv.shape[2]

    @property
    def nl(self) -> int:
        """Scalar shape functions of Q_h, letters p."""
        return self.reference.p.shape[1]

    def nb(self, s: int) -> int:
        """Scalar shape functions of F_h on side s, letters b."""
        return self.reference.facets[s].mu.shape[1]

    def _AffineMaps(self, mesh: Mesh, vertices: np.ndarray) -> Array | None:
        """dF_jm = d x_j/d xi_m, (n, 1, j, m), if all elements are affine images of the reference element, else None."""
        if Curved(mesh):
            return None
        reference = np.array(REFERENCE_VERTICES[self.et], dtype=float)[:, :self.dim]
        corners = np.asarray(mesh.ngmesh.Coordinates())[vertices][..., :self.dim]       # n, corners, j
        centred = corners - corners.mean(axis=1, keepdims=True)
        reference = reference - reference.mean(axis=0)
        maps = np.swapaxes(centred, 1, 2) @ np.linalg.pinv(reference).T
        # Round-off of the coordinates.
        straight = np.abs(centred - reference @ np.swapaxes(maps, 1, 2)).max() <= 1e-14 * np.abs(corners).max()
        return maps[:, None] if straight else None

    @property
    def samples(self) -> Self:
        """Elements of which every other one is an affine image with C constant in it; all of them if there are none such."""
        return self.Part(np.array([rows[0] for rows, _ in self.rows])) if self.uniform else self

    def MeshPoints(self, mesh: Mesh, shapes: Shapes) -> np.ndarray:
        """NGSolve mesh points (n, q) of the rule of a ReferenceElement or its FacetShapes."""
        rules = {et: IntegrationRule(et, 0) for et in VOLUME_TYPES[self.dim]}
        rules[self.et] = IntegrationRule(points=[tuple(point) for point in shapes.points[:, :self.dim]],
                                         weights=list(shapes.weights))
        mapped = mesh.MapToAllElements(rules, VOL)
        return mapped[np.isin(mapped["nr"], self.elements)].reshape(len(self.elements), len(shapes.weights))

    def _Geometries(self, affine: Array | None, points: Sequence[np.ndarray]) -> list[tuple[Array, Array]]:
        """[(G, volume)] of the element and its sides: G_mj = d xi_m/d x_j (n, q, m, j) and |det dF| (n, q)."""
        if affine is not None:
            return [_Inverse(affine)] * (1 + len(self.sides))
        return [_Inverse(_AtPoints(at, np.asarray(specialcf.JacobianMatrix(self.dim, self.dim)(at.ravel()))
                                   .reshape(-1, self.dim, self.dim))) for at in points]

    def _Stiffnesses(self, mesh: Mesh, material: HookeMaterial | AnisotropicMaterial,
                     points: Sequence[np.ndarray]) -> list[Array]:
        """C_ijkl at the points of the element and of its sides, (n or 1, q or 1, i, j, k, l) each [stress]."""
        if material.bonus == 0:
            anywhere = VolumePoints(mesh, 0)[:1]
            return [StiffnessAt(material, anywhere, self._directions)[None]] * (1 + len(self.sides))
        return [_AtPoints(at, StiffnessAt(material, at.ravel(), self._directions)) for at in points]

    @property
    def _directions(self) -> int:
        """Of the strains that C is for."""
        return self.dim

    def Geometry(self, number: int = 0) -> tuple[Array, Array]:
        """(G, volume) of the element (0) or of side number - 1."""
        G, volume = self._geometry[number]
        return G[self._chosen], volume[self._chosen]

    def Stiffness(self, number: int = 0) -> Array:
        return self._Chosen(self._stiffness[number])

    def _Chosen(self, values: Array) -> Array:
        """Values (n or 1, ...) of the elements of this part."""
        return values if len(values) == 1 else values[self._chosen]

    def _Boundaries(self) -> list[tuple[Array, Array]]:
        """[(normal (n, q, j), measure (n, q))] of the sides."""
        found = []
        for facet, (G, volume) in zip(self.reference.facets, self._geometry[1:]):
            normal = facet.normal @ G       # Nanson: n is along G' N, and |G' N| |det dF| the measure; n q j
            length = np.sqrt(np.square(normal).sum(axis=2))
            found.append((normal / length[..., None], length * volume))
        return found

    def Boundary(self, s: int) -> tuple[Array, Array]:
        """(normal (n, q, j), measure (n, q)) of side s."""
        n, measure = self._boundary[s]
        return n[self._chosen], measure[self._chosen]

    def _Transmitted(self, s: int) -> Array | None:
        """P_ij (n, q, i, j) on side s: n n' on rollers, which transmit the normal part only, else the identity, or None."""
        if not self.rollers[:, s].any():
            return None
        n, _ = self.Boundary(s)
        return np.where(self.rollers[:, s, None, None, None], n[..., :, None] * n[..., None, :], np.eye(self.dim))


def _AtPoints(points: np.ndarray, values: Array) -> Array:
    """Values (n q, ...) at mesh points (n, q) as (n, q, ...), or (n, 1, ...) where they vary in no element."""
    values = values.reshape(*points.shape, *values.shape[1:])
    first = values[:, :1]
    return first.copy() if np.abs(values - first).max() <= 1e-14 * np.abs(values).max() else values


def _ByOrder(vertices: np.ndarray) -> Iterator[tuple[tuple[int, ...], np.ndarray]]:
    """(order of the vertex numbers as a tuple of ranks, rows where they have this order)."""
    count = vertices.shape[1]
    ranks = [cast(np.ndarray, sum((vertices[:, j] < vertices[:, i]).astype(np.int8) for j in range(count)))
             for i in range(count)]
    for rows in Equal(*ranks):
        yield tuple(int(rank[rows[0]]) for rank in ranks), rows


def Equal(*keys: np.ndarray) -> Iterator[np.ndarray]:
    """Index arrays, ascending, of the entries for which all keys (small integers >= -1) agree."""
    if len(keys[0]) and all((key == key[0]).all() for key in keys):     # most often
        yield np.arange(len(keys[0]))
        return
    code = np.zeros(len(keys[0]), dtype=np.int64)
    for key in keys:
        code = code * (int(key.max(initial=0)) + 2) + key + 1
    if code.max(initial=0) >= 1 << 15:
        code = np.unique(code, return_inverse=True)[1]
    if code.max(initial=0) < 1 << 15:
        code = code.astype(np.int16)        # numpy sorts these in linear time
    order = np.argsort(code, kind="stable")
    if len(order):
        yield from np.split(order, np.flatnonzero(np.diff(code[order])) + 1)


def Batches(members: np.ndarray, entries: int) -> Iterator[np.ndarray]:
    """Batches of members whose matrices have that many entries each."""
    size = max(1, int(BATCH // max(entries, 1)))
    for begin in range(0, len(members), size):
        yield members[begin:begin + size]


def _Inverse(maps: Array) -> tuple[Array, Array]:
    """(dF^-1, |det dF|) for Jacobians dF (n, q, j, m), by cofactors: LAPACK takes ten times as long for matrices this small."""
    minors = np.stack([_Cross(maps, row) for row in range(maps.shape[-1])], axis=-1)
    determinant = np.einsum("nqj,nqj->nq", maps[..., 0, :], minors[..., 0])
    return minors / determinant[..., None, None], np.abs(determinant)


def _Cross(maps: Array, row: int) -> Array:
    """The cofactors of a row."""
    if maps.shape[-1] == 2:
        return np.stack([maps[..., 1 - row, 1], -maps[..., 1 - row, 0]], axis=-1) * (-1) ** row
    return np.cross(maps[..., (row + 1) % 3, :], maps[..., (row + 2) % 3, :])
