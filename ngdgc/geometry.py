"""Elements of one type: their reference element, their geometry and C at quadrature points."""

from functools import cached_property

import numpy as np
from ngsolve import VOL, IntegrationRule, specialcf

from .elasticity import StiffnessAt
from .facets import REFERENCE_VERTICES, VOLUME_TYPES, Curved, VolumePoints
from .shapes import Reference


class CellGeometry:
    """Arrays over n elements and quadrature points.

    elements (n,) numbers;  vertices (n, nv), facets (n, nf) numbers in NGSolve's local order;  rollers (n, nf) True where a
    facet couples normal parts only;  order k;  liftorder l
    """

    def __init__(self, mesh, material, et, elements, vertices, facets, rollers, order, liftorder):
        self.mesh, self.material, self.et, self.dim = mesh, material, et, mesh.dim
        self.elements, self.facets, self.rollers = elements, facets, rollers
        self.rows, self.shapes = [], []
        for rank, rows in _ByOrder(vertices):
            self.rows.append(rows)
            self.shapes.append(Reference(et, rank, order, liftorder, material.bonus))
        self._reference = self.shapes[0]
        self._affine = self._AffineMaps(vertices)

    @property
    def sides(self):
        return range(len(self._reference.facets))

    @property
    def na(self):
        """Scalar shape functions of V_h."""
        return self._reference.dv.shape[2]

    @property
    def nl(self):
        """Scalar shape functions of Q_h."""
        return self._reference.p.shape[1]

    def nm(self, s):
        """Scalar shape functions of F_h on side s."""
        return self._reference.facets[s].m.shape[1]

    def _AffineMaps(self, vertices):
        """dF (n, 1, d, d) if all elements are affine images of the reference element, else None."""
        if Curved(self.mesh):
            return None
        reference = np.array(REFERENCE_VERTICES[self.et], dtype=float)[:, :self.dim]
        corners = np.asarray(self.mesh.ngmesh.Coordinates())[vertices][..., :self.dim]
        centred = corners - corners.mean(axis=1, keepdims=True)
        reference = reference - reference.mean(axis=0)
        maps = np.swapaxes(centred, 1, 2) @ np.linalg.pinv(reference).T
        # Round-off of the coordinates.
        straight = np.abs(centred - reference @ np.swapaxes(maps, 1, 2)).max() <= 1e-14 * np.abs(corners).max()
        return maps[:, None] if straight else None

    @property
    def samples(self):
        """Elements of which every other one is an affine image with C constant in it; all of them if there are none such."""
        if self._affine is not None and all(C.shape[1] == 1 for C in self.C):
            return [rows[0] for rows in self.rows]
        return slice(None)

    @cached_property
    def _meshpoints(self):
        """NGSolve mesh points of the element rule and the side rules, each (n, q)."""
        found = []
        for shapes in (self._reference, *self._reference.facets):
            rules = {et: IntegrationRule(et, 0) for et in VOLUME_TYPES[self.dim]}
            rules[self.et] = IntegrationRule(points=[tuple(point) for point in shapes.points[:, :self.dim]],
                                             weights=list(shapes.weights))
            mapped = self.mesh.MapToAllElements(rules, VOL)
            found.append(mapped[np.isin(mapped["nr"], self.elements)].reshape(len(self.elements), len(shapes.weights)))
        return found

    def _AtPoints(self, number, values):
        """Values (n q, ...) at mesh points as (n, q, ...), or (n, 1, ...) where they vary in no element."""
        values = values.reshape(*self._meshpoints[number].shape, *values.shape[1:])
        first = values[:, :1]
        return first if np.abs(values - first).max() <= 1e-14 * np.abs(values).max() else values

    @cached_property
    def _geometry(self):
        """[(G, volume)] of the element and its sides: G_mj = d xi_m/d x_j (n, q, d, d) and |det dF| (n, q)."""
        if self._affine is not None:
            return [_Geometry(self._affine)] * (1 + len(self.sides))
        return [_Geometry(self._AtPoints(number, np.asarray(specialcf.JacobianMatrix(self.dim, self.dim)(points.ravel()))
                                         .reshape(-1, self.dim, self.dim)))
                for number, points in enumerate(self._meshpoints)]

    @cached_property
    def C(self):
        """C_ijkl at the points of the element and of its sides, (n or 1, q or 1, d, d, d, d) each [stress]."""
        if self.material.bonus == 0:
            anywhere = VolumePoints(self.mesh, 0)[:1]
            return [StiffnessAt(self.material, anywhere, self.dim)[None]] * (1 + len(self.sides))
        return [self._AtPoints(number, StiffnessAt(self.material, points.ravel(), self.dim))
                for number, points in enumerate(self._meshpoints)]

    @cached_property
    def _boundary(self):
        """[(n (n, q, d), measure (n, q))] of the sides."""
        result = []
        for facet, (G, volume) in zip(self._reference.facets, self._geometry[1:]):
            normal = facet.normal @ G
            length = np.linalg.norm(normal, axis=2)
            result.append((normal / length[..., None], length * volume))
        return result

    @cached_property
    def _transmitted(self):
        """P_ij (n, q, d, d) on each side: n n' on rollers, which transmit the normal part only, the identity elsewhere."""
        return [np.where(self.rollers[:, s, None, None, None], n[..., :, None] * n[..., None, :], np.eye(self.dim))
                if self.rollers[:, s].any() else None for s, (n, _) in enumerate(self._boundary)]


def _ByOrder(vertices):
    """(order of the vertex numbers as a tuple of ranks, rows where they have this order)."""
    count = vertices.shape[1]
    ranks = [sum((vertices[:, j] < vertices[:, i]).astype(np.int8) for j in range(count)) for i in range(count)]
    for rows in Equal(*ranks):
        yield tuple(int(rank[rows[0]]) for rank in ranks), rows


def Equal(*keys):
    """Index arrays, ascending, of the entries for which all keys (small integers >= -1) agree."""
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


def _Geometry(maps):
    """(dF^-1, |det dF|) for Jacobians dF (n, q, d, d)."""
    return np.linalg.inv(maps), np.abs(np.linalg.det(maps))

