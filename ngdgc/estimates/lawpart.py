"""The law's part of the error: how far an admissible displacement and an equilibrated traction are from the graph of the law.

At a point of Gamma_C with v of `potential`, r = v_n - g, and t = -s n of `equilibrated`, p = (t_n)_+:

    normal      Phi(r) + Phi*(p) - p r = int_(r*)^r (p_n(z) - p) dz,    p_n(r*) = p        Fenchel and Young's inequality
    friction    b |v_t| - t_t.v_t,    b = p_t(r*, p, |v_t|),  |t_t| <= b,

both are >= 0, and 0 where (v, t) obeys the law.  A stiff foundation makes much of a penetration that v could be rid of at the
price of some elastic energy: instead of these gaps their Moreau envelopes

    min_w  gap(w) + gamma/2 |v - w|^2,    gamma = 2 mu k^2/h

are taken, whose minimiser is the point of the graph that `ContactPart.NormalPoint` finds.  What of t no law can give, tension
and friction beyond the bound, is cut off; where all contact points of a facet slip t_h is on the bound up to quadrature, and
|t_h| is taken for the bound.  A soft foundation makes much of a traction that is off the law between the points of the
quadrature: instead t may be replaced, on a whole facet, by the point of the graph on the line t + gamma v.  A traction that is
replaced costs

    h/(2 mu) (|d - m|^2 + (1 + log_2(L/h)) |m|^2),      d the difference, m its mean over the facet, L the extent of Gamma_C:

a load of mean 0 is a matter of its facet, one with a mean a matter of all sizes between h and L, in equal parts.  Of both ways
the facet takes the one that costs less.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..contact.directions import LawNormals
from ..contact.graph import SLIP
from ..contact.parts import ContactPart
from ..contracts import Array
from ..data.coefficients import ValuesAt
from ..mesh.quadrature import BoundaryQuadrature
from .equilibrated import EquilibratedStress
from .facetsizes import FacetSizes
from .potential import Potential

DEGREE = 12     # of the quadrature beyond 2 k: zones end within facets
NODES, FACTORS = np.polynomial.legendre.leggauss(12)
SOFT = 1e-12    # of gamma, a slope that no law's is below
FAR = 100.0     # times the penetrations that occur: there a law has its largest pressure


@dataclass(frozen=True)
class LawGaps:
    """At m points of Gamma_C: elements (m,) behind, weights (m,) [length^(d-1)], and densities (m,) [stress length].

    gap : Fenchel and Young's, normal and friction;  envelope : what counts of it in an estimate;
    infeasible : h/(2 mu) |what of t was replaced|^2;  cut : that of what no law can give alone, which belongs to `gap`
    softgap, softcut : gap, and what was replaced, with the tractions of the graph on facets where that costs less
    """

    elements: Any
    weights: Array
    gap: Array
    envelope: Array
    infeasible: Array
    cut: Array
    softgap: Array
    softcut: Array


def LawPart(solution: Any, potential: Potential, stress: EquilibratedStress) -> list[LawGaps]:
    """The LawGaps of every foundation."""
    disc = solution.disc
    slips = np.ones(len(disc.facets.boundary[0]), dtype=bool)       # boundary elements all of whose contact points slip
    slips[disc.contact.boundaryelements[solution.zones[disc.contact.members] != SLIP]] = False
    return [FoundationPoints(disc, foundation, potential).Gaps(stress, slips) for foundation in disc.problem.foundation]


def Pushed(solution: Any, potential: Potential, stress: EquilibratedStress) -> Potential | None:
    """The potential lowered by hat functions where it is deeper in the foundation than its traction, or None if nowhere."""
    disc, dim = solution.disc, solution.disc.mesh.dim
    shift, normals = np.zeros(disc.mesh.nv), np.zeros((disc.mesh.nv, dim))
    vertices = disc.facets.boundary[2]
    for foundation in disc.problem.foundation:
        points = FoundationPoints(disc, foundation, potential)
        excess, quadrature = points.Excess(stress), points.quadrature
        for corner in vertices[quadrature.boundaryelements].T:
            there = corner >= 0
            np.maximum.at(shift, corner[there], excess[there])
            normals[corner[there]] = points.normals[there]
    moved = -shift[:, None] * normals
    for region in disc.problem.dirichlet:
        held = vertices[disc.facets.On(region)[disc.facets.boundary[0]]]
        moved[held[held >= 0]] = 0
    for region in disc.problem.roller:
        # Along them it may move.
        quadrature = BoundaryQuadrature.On(disc.facets, region, 1)
        for corner in vertices[quadrature.boundaryelements].T:
            there, n = corner[corner >= 0], quadrature.normals[corner >= 0]
            moved[there] -= np.einsum("mi,mi->m", moved[there], n)[:, None] * n
    return potential.Moved(moved) if np.any(moved) else None


class FoundationPoints:
    """The m points of a fine quadrature on one foundation, its law and v there; `normals` (m, d), along which the law acts."""

    def __init__(self, disc: Any, foundation: Any, potential: Any) -> None:
        mesh, dim = disc.mesh, disc.mesh.dim
        self.quadrature = quadrature = BoundaryQuadrature.On(disc.facets, foundation.boundary, 2 * disc.order + DEGREE)
        region = mesh.Boundaries(foundation.boundary)
        self.normals = LawNormals(foundation, quadrature, region)
        self._part = ContactPart.On(foundation, slice(0, len(self.normals)), quadrature.points, region)
        gap = ValuesAt(foundation.gap, quadrature.points, f"foundation {foundation.boundary!r}: gap", region)
        v = np.asarray(potential.gfu(quadrature.points)).reshape(-1, dim)
        self._r = self._Normal(v) - gap
        self._slip = v - self._Normal(v)[:, None] * self.normals
        _, self._facet = np.unique(quadrature.boundaryelements, return_inverse=True)
        self._measure = np.bincount(self._facet, quadrature.weights)
        size, shear = FacetSizes(disc, quadrature), disc.problem.material.ShearAt(quadrature.inside)
        self._sizes = 1 + np.log2(np.maximum(np.ptp(quadrature.coordinates, axis=0).max() / size, 1))
        self._gamma, self._price = 2 * shear * disc.order ** 2 / size, size / (2 * shear)

    def _Normal(self, vectors: Array) -> Array:
        return np.einsum("mi,mi->m", vectors, self.normals)

    def Gaps(self, stress: EquilibratedStress, slips: Array) -> LawGaps:
        """The LawGaps of an equilibrated traction."""
        t = -stress.Traction(self.quadrature)
        normal = self._Normal(t)
        friction = t - normal[:, None] * self.normals
        given = _Pair(self, np.maximum(normal, 0), friction, slips[self.quadrature.boundaryelements])
        replaced = t - given.p[:, None] * self.normals - given.friction
        kept = given.envelope, self._price * (np.square(replaced).sum(axis=1) + given.missed ** 2)
        pair = _Pair(self, np.maximum(normal, 0), friction, False)
        replaced = t - pair.near[0][:, None] * self.normals - pair.near[1]
        mean = self._Mean(replaced)
        moved = pair.moved, self._price * (np.square(replaced - mean).sum(axis=1) + self._sizes * np.square(mean).sum(axis=1))
        cost = [np.bincount(self._facet, self.quadrature.weights * (2 * law + rest)) for law, rest in (kept, moved)]
        better = (cost[1] < cost[0])[self._facet]
        envelope, infeasible = (np.where(better, moved[n], kept[n]) for n in (0, 1))
        whole, graph = (given.gap, kept[1]), (pair.left, moved[1])
        cost = [np.bincount(self._facet, self.quadrature.weights * (2 * gap + rest)) for gap, rest in (whole, graph)]
        softer = (cost[1] < cost[0])[self._facet]
        soft = (np.where(softer, graph[n], whole[n]) for n in (0, 1))
        return LawGaps(self.quadrature.elements, self.quadrature.weights, given.gap, envelope, infeasible, kept[1], *soft)

    def Excess(self, stress: EquilibratedStress) -> Array:
        """By how much v is to be lowered at the points, (m,) [length]: to r*, on facets where that costs less than the gap.

        The costs are p (r - r*) and mu (r - r*)^2/h of the body.
        """
        normal = -self._Normal(stress.Traction(self.quadrature))
        p = np.maximum(normal, 0)
        depth, p = _Depth(self._part, self._gamma, p, np.abs(self._r))
        excess, weights = np.maximum(self._r - depth, 0), self.quadrature.weights
        gap = np.bincount(self._facet, weights * _Young(self._part, depth, self._r, p))
        cost = np.bincount(self._facet, weights * (p + self._gamma * excess) * excess)
        return np.where((gap > cost)[self._facet], excess, 0)

    def _Mean(self, values: Array) -> Array:
        """The mean over the facet of each point."""
        weights = self.quadrature.weights
        columns = values.reshape(len(values), -1)
        means = np.stack([np.bincount(self._facet, weights * column) / self._measure for column in columns.T], axis=1)
        return means[self._facet].reshape(values.shape)


class _Pair:
    """v and a feasible traction near a given one.

    p (m,), friction (m, d) : it;  missed (m,) : bound that the law would have beyond it, where it slips
    gap, envelope (m,) : of both parts
    near : pressure and friction of the points of the graph on the lines t + gamma u;  moved (m,) : gamma/2 |v - theirs|^2
    left (m,) : gap of v and that traction
    """

    def __init__(self, at: FoundationPoints, p: Array, friction: Array, slipping: bool | np.ndarray) -> None:
        part, gamma, r, slip = at._part, at._gamma, at._r, at._slip
        deep = part.NormalPoint(gamma, p + gamma * r)[0]
        self._depth, self.p = _Depth(part, gamma, p, np.maximum(np.abs(r), np.abs(deep)))
        length = np.linalg.norm(friction, axis=1)
        bound = part.Bound(self._depth, self.p) * part.SlipFactor(np.linalg.norm(slip, axis=1))[0]
        self.missed = np.where(slipping, bound - length, 0)
        bound = np.where(slipping, length, bound)
        self.friction = friction * np.minimum(1, bound / np.where(length > 0, length, 1))[:, None]
        q = self.friction + gamma[:, None] * slip
        pull = np.linalg.norm(q, axis=1)
        pulled = q * np.minimum(1, bound / np.where(pull > 0, pull, 1))[:, None]
        left = (q - pulled) / gamma[:, None]
        self.near = self.p + gamma * (r - deep), pulled
        self.moved = gamma / 2 * ((r - deep) ** 2 + np.square(slip - left).sum(axis=1))
        self.left = _Young(part, deep, r, self.near[0]) + _Dissipation(bound, pulled, slip)
        raw, rubbed = _Young(part, self._depth, r, self.p), _Dissipation(bound, self.friction, slip)
        self.gap = raw + rubbed
        self.envelope = np.minimum(raw, _Young(part, self._depth, deep, self.p) + gamma / 2 * (r - deep) ** 2)
        self.envelope += np.minimum(rubbed, _Dissipation(bound, self.friction, left)
                                    + gamma / 2 * np.square(slip - left).sum(axis=1))


def _Depth(part: ContactPart, gamma: Array, p: Array, scale: Array) -> tuple[Array, Array]:
    """(r*, p_n(r*)): where the law has the pressure p, or its largest one."""
    depth = part.NormalPoint(SOFT * gamma, p)[0]
    far = FAR * np.maximum(scale, scale.max(initial=0))
    reached = depth <= far
    depth = np.where(reached, np.maximum(depth, 0), far)
    with np.errstate(all="ignore"):
        largest = part.Pressure(depth)
    return depth, np.where(reached | ~np.isfinite(largest), p, np.minimum(p, largest))


def _Young(part: ContactPart, depth: Array, r: Array, p: Array) -> Array:
    """int_(r*)^r (p_n - p), >= 0."""
    upper = np.maximum(r, 0)
    total = -p * np.minimum(r, 0)
    with np.errstate(all="ignore"):
        for node, factor in zip(NODES, FACTORS):
            z = depth + (upper - depth) * (1 + node) / 2
            total = total + factor / 2 * (upper - depth) * (part.Pressure(z) - p)
    return np.maximum(np.where(np.isfinite(total), total, np.inf), 0)


def _Dissipation(bound: Array, friction: Array, slip: Array) -> Array:
    """b |v_t| - t_t.v_t, >= 0."""
    return np.maximum(bound * np.linalg.norm(slip, axis=1) - np.einsum("mi,mi->m", friction, slip), 0)
