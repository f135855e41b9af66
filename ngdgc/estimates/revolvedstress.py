"""A stress in equilibrium with the loads on a body of revolution.

Its rows in the plane are those of `equilibrated`, with 2 pi r in the interior moments, and on facets s n = sigma_hat n, which
is a polynomial there; on the axis, whose sides have no area, s n is the radial stress of u_h.  Then along z there is
equilibrium but for what is orthogonal to V_h with the weight r,

    int_K (f_z + d_r s_zr + d_z s_zz + s_zr/r) v r = 0,   v in V_h(K)

and along r as well with the hoop stress, T_ij = C_ijtt,

    s_tt = C eps(u_h)_tt + g,    int_K g v = - theta sum_e share int_e [u].(T n) v      or theta int_K T:r_0[u] v

What is left over there, (t - s_tt)/r with t = s_rr + r (f_r + d_r s_rr + d_z s_rz), counts with h/(pi (k + 1)) like all such,
but with no more than r: |w_r/r| is a strain.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..blocks.reference import ReferenceElement
from ..blocks.revolved import RevolvedGroup
from ..contracts import Array
from ..discrete.section import OnAxis
from ..problem.frames import TURN
from ..problem.materials import StiffnessAt
from .equilibrated import EquilibratedStress, Stress, StressBatch
from .piola import PiolaElement


@dataclass(frozen=True)
class RevolvedBatch(StressBatch):
    """Stresses are (n, q, 3, 3) in the order r, z, theta; `divergence` is that of the body, which has the hoop stress."""

    space: Array

    @property
    def C(self) -> Array:
        return self.space


class RevolvedStress(EquilibratedStress):
    """The equilibrated stress of a body of revolution, in batches of elements."""

    def __init__(self, solution: Any) -> None:
        super().__init__(solution)
        self._axis = OnAxis(self.disc.facets)

    def _Plane(self, part: Any) -> tuple[Array, Array]:
        return part.Geometry()[0], part.Plain()

    def _Measure(self, part: Any, number: int = 0) -> Array:
        return TURN * part.Radii(number) * part.Plain(number)

    def _SideMeasure(self, part: Any, s: int) -> Array:
        return part.Plain(1 + s)

    def _Local(self, part: RevolvedGroup) -> Array:
        return self._vector[self.operators.Dofs(part.elements[:, None])].reshape(len(part.elements), part.dim, -1)

    def _Slopes(self, part: RevolvedGroup) -> tuple[Array, Array]:
        """(grad u_h, u_r/r), (n, q, i, j) and (n, q)."""
        local = self._Local(part)
        hoop = part.AtPoints(lambda shape: shape.v[:, None], local[:, :1])[..., 0, 0] / part.Radii()
        return part.AtPoints(lambda shape: shape.dv, local) @ part.Geometry()[0], hoop

    def _Computed(self, part: RevolvedGroup) -> Array:
        slopes, hoop = self._Slopes(part)
        return Stress(part.Stiffness(), slopes) + part.Tie(0)[0] * hoop[..., None, None]

    def _Coefficients(self, element: PiolaElement, part: RevolvedGroup, rows: np.ndarray, moments: Array) -> Array:
        shape = element.shape
        around = TURN * part.Radii()[rows] * shape.weights
        inside = np.einsum("nq,qIN->nIN", around, element.pairs, optimize=True)
        facets = np.broadcast_to(element.onfacets, (len(rows), *element.onfacets.shape))
        matrices = np.concatenate([facets, inside], axis=1)
        return np.swapaxes(np.linalg.solve(matrices, np.swapaxes(moments, 1, 2)), 1, 2)

    def _OnFacet(self, part: RevolvedGroup, s: int, shape: ReferenceElement, rows: np.ndarray, signs: Array) -> Array:
        moments = super()._OnFacet(part, s, shape, rows, signs)
        there = self._axis[part.facets[rows, s]]
        if there.any():
            facet, chosen = shape.facets[s], rows[there]
            slopes = np.einsum("qma,nia->nqim", facet.dv, self._Local(part)[chosen]) @ part.Geometry(1 + s)[0][chosen]
            # u_r/r is d_r u_r there, and the outward normal -e_r.
            stress = Stress(part.Stiffness(1 + s), slopes) + part.Tie(1 + s)[0] * slopes[..., :1, :1]
            radial = stress[..., 0, 0] * part.Plain(1 + s)[chosen] * facet.weights
            moments[there, 0] = -radial @ facet.mu
        return moments

    def _Batch(self, part: Any, fine: Any, points: Array, signs: Array, lifted: Array | None) -> StressBatch:
        batch, r = super()._Batch(part, fine, points, signs, lifted), fine.Radii()
        hoop = batch.computed[..., 2, 2] + self._theta * self._Jumped(part, fine, signs, lifted)
        near = np.minimum(1, np.pi * (self.disc.order + 1) * r / batch.diameters[:, None])
        batch.divergence[..., 0] += near * (batch.equilibrated[..., 2, 2] - hoop) / r
        batch.equilibrated[..., 2, 2] = hoop
        return batch

    def _Jumped(self, part: RevolvedGroup, fine: RevolvedGroup, signs: Array, lifted: Array | None) -> Array:
        """g at the points of `fine`, (n, q)."""
        found = np.zeros(fine.Radii().shape)
        if not self._theta:
            return found
        if lifted is not None:
            values = part.AtPoints(lambda shape: shape.p[:, None], lifted)[..., 0]      # n q c
            tied = part.Plain() * np.einsum("nqc,cij,nqij->nq", values, part.basis, part.Tie(0)[0], optimize=True)
        for (rows, shape), (_, other) in zip(part.rows, fine.rows):
            measure = np.broadcast_to(part.Plain(), part.Radii().shape)[rows] * shape.weights
            mass = np.einsum("nq,qa,qb->nab", measure, shape.v, shape.v, optimize=True)
            if lifted is not None:
                moments = (tied[rows] * shape.weights) @ shape.v
            else:
                moments = np.zeros((len(rows), shape.v.shape[1]))
                for s in part.sides:
                    facet, pull = shape.facets[s], part.Pull(s) * part.Plain(1 + s)[..., None]
                    pulled = np.einsum("nqi,nqi->nq", self._SideJump(part, s, shape, rows, signs), pull[rows])
                    moments -= (pulled * facet.weights) @ facet.v
            found[rows] = np.linalg.solve(mass, moments[..., None])[..., 0] @ other.v.T
        return found

    def _Whole(self, fine: RevolvedGroup, points: Array, equilibrated: Array, divergence: Array,
               diameters: Array) -> RevolvedBatch:
        r, force = fine.Radii(), self.disc.problem.bodyforce
        C = StiffnessAt(self.disc.problem.material, points.ravel(), 3).reshape(*points.shape, 3, 3, 3, 3)
        slopes, hoop = self._Slopes(fine)
        strain = np.zeros((*points.shape, 3, 3))
        strain[..., :2, :2], strain[..., 2, 2] = slopes, hoop
        batch = RevolvedBatch(fine, points, self._Measure(fine) * fine.reference.weights, Stress(C, strain),
                              np.zeros_like(strain), np.zeros_like(divergence), diameters, C)
        radial = batch.BodyForce(self.disc.problem)[..., 0] if force is not None else 0 * r
        batch.equilibrated[..., :2, :2] = equilibrated
        batch.equilibrated[..., 2, 2] = equilibrated[..., 0, 0] + r * (radial + divergence[..., 0])
        batch.divergence[..., 0] = -radial
        batch.divergence[..., 1] = divergence[..., 1] + equilibrated[..., 1, 0] / r
        return batch
