"""A stress in equilibrium with the loads on a body of revolution.

Its rows in the plane are those of `equilibrated`, with 2 pi r in the interior moments, and on facets s n = sigma_hat n, which
is a polynomial there; on the axis, whose sides have no area, s n is the radial stress of u_h.  The hoop stress is what
equilibrium along r leaves for it, and along z there is equilibrium but for what is orthogonal to V_h with the weight r:

    s_tt = s_rr + r (f_r + d_r s_rr + d_z s_rz),        int_K (f_z + d_r s_zr + d_z s_zz + s_zr/r) v r = 0,   v in V_h(K)

Since B_h(u_h, v) = load for v = (v_r, 0), s_tt and the hoop stress of u_h have the same moments, too.
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
