"""The contact law as a graph: displacement and traction at a point of Gamma_C as functions of one vector.

With a scale gamma > 0 [stress/length] every q in R^d belongs to exactly one pair (u, t) that obeys the law (2.7)-(2.9) and

    t + gamma u = q,                                                                                        (*)

as long as p_n' and the slope of the friction bound in the slip stay above -gamma: Minty's parametrisation of a monotone graph.
Functions of q are piecewise smooth and Lipschitz however stiff the law is, also where t is no function of u (stick, u_t = 0)
and where it nearly is none (p_n' -> infinity).  With u = U(q), t = t(q):

    normal    p = p_n(r), r = u_n - g:    p + gamma r = q_n - gamma g, one scalar equation; p = 0 if that is <= 0
    stick     |q_t| <= p_t(r, p, 0):      t_t = q_t, u_t = 0
    slip      otherwise:                  |u_t| = s from p_t(r, p, s) + gamma s = |q_t|, t_t = p_t q_t/|q_t|

In an increment of a history u_t is that since the last state, `ContactBoundary.origin`, in all of these.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..contracts import Array
from ..exceptions import ProblemError
from .boundary import ContactBoundary
from .parts import CheckFinite, ContactPart, OverParts
from .resolvent import Share

SEPARATION, STICK, SLIP = 0, 1, 2
ZONES = ("separation", "stick", "slip")
ROUNDOFF = 1e-14     # of displacements, in units of the gap
LEAST = 1e-3    # scale of friction, relative to the tractions


@dataclass(frozen=True)
class GraphPoint:
    """Points on the graph of the law: q, displacement u and traction t (n, d), derivative dt/dq (n, d, d), zones (n,)."""

    q: np.ndarray
    displacement: np.ndarray
    traction: np.ndarray
    derivative: np.ndarray
    zones: np.ndarray


class ContactGraph:
    """The laws of a ContactBoundary, parametrised with the scale gamma, a number or (n,) [stress/length]."""

    def __init__(self, contact: ContactBoundary, scale: float | Array) -> None:
        self.contact = contact
        self.scale = np.broadcast_to(np.asarray(scale, dtype=float), contact.weights.shape)

    def Coordinates(self, displacement: Array, traction: Array) -> Array:
        """q = t + gamma u, u_t since the origin of slip, (n, d) [stress]."""
        return traction + self.scale[:, None] * self.contact.SinceOrigin(displacement)

    def At(self, q: Array) -> GraphPoint:
        """The GraphPoint of q (n, d); raises ProblemError if a law returns a value that is not finite."""
        contact, scale, normals = self.contact, self.scale, self.contact.normals
        qn = contact.Normal(q)
        qt = q - qn[:, None] * normals
        length = np.linalg.norm(qt, axis=1)
        r, p, slope = OverParts(contact.parts, ContactPart.NormalPoint, scale, qn - scale * contact.gap)
        dr, dp = 1 / (scale + slope), Share(slope, scale)
        base = OverParts(contact.parts, ContactPart.Bound, r, p)
        byr, byp = OverParts(contact.parts, ContactPart.BoundDerivatives, r, p)
        slip, factor, slope = OverParts(contact.parts, ContactPart.SlipPoint, scale, base, length)
        bound, dbase = base * factor, byr * dr + byp * dp
        along, cross = Share(slope, scale), dbase * factor / (scale + slope)
        sliding = length >= bound
        direction = qt / np.where(length > 0, length, 1)[:, None]
        friction = np.where(sliding, bound, length)
        traction = p[:, None] * normals + friction[:, None] * direction
        displacement = (r + contact.gap)[:, None] * normals + np.where(sliding, slip, 0)[:, None] * direction
        if contact.origin is not None:
            displacement += contact.origin
        with np.errstate(all="ignore"):
            # It tells that nothing is wrong; where is asked only if something is.
            total = np.sum(p + r + dr + base + dbase + bound + along + slip) + np.sum(q)
        if not np.isfinite(total):
            self._CheckFinite(q, r, slip, {"Pressure": p + r, "PressureDerivative": dr, "Bound": base,
                                           "BoundDerivatives": dbase, "Coefficient": bound + along + slip})
        zones = np.where(p <= OverParts(contact.parts, ContactPart.Least, p), SEPARATION, np.where(sliding, SLIP, STICK))
        # dt_t/dq = (|t_t|/|q_t|)(P - e e') + dp_t/d|q_t| e e' + gamma ds/d(bound) dbound/dq_n e n', P = I - n n'.
        ratio = np.where(sliding, bound / np.where(length > 0, length, 1), 1)
        along = np.where(sliding, along, 1)
        normal, tangent = _Outer(normals, normals), _Outer(direction, direction)
        derivative = (dp[:, None, None] * normal
                      + ratio[:, None, None] * (np.eye(contact.dim) - normal - tangent) + along[:, None, None] * tangent
                      + np.where(sliding, scale * cross, 0)[:, None, None] * _Outer(direction, normals))
        # Without a direction the tangential derivative is that of stick or, where nothing resists, of a frictionless point.
        still = (length == 0) & ~sliding
        derivative[still] = (dp[:, None, None] * normal + np.eye(contact.dim) - normal)[still]
        return GraphPoint(q, displacement, traction, derivative, zones)

    def _CheckFinite(self, q: Array, r: Array, slip: Array, values: Mapping[str, Array]) -> None:
        if not np.all(np.isfinite(q)):
            raise ProblemError("displacement and traction of a contact point are not finite; look for data of extreme size")
        sought = (self.contact.Normal(q) / self.scale) - self.contact.gap       # of a law that is finite nowhere
        for method, found in values.items():
            where = (slip, "slip") if method == "Coefficient" else (np.where(np.isfinite(r), r, sought), "penetration")
            CheckFinite(self.contact.parts, method, found, *where)


@dataclass(frozen=True)
class GraphDistance:
    """Distance of pairs (u, t) to the graph, (n,), no unit, and the zones of the points of the graph they belong to, (n,).

    pressure (n,), friction (n, d) : normal and tangential part of t [stress], exactly 0 in separation and where p_t = 0; that
        is without what round-off, or an iteration on its way, leaves there, and pressure > 0 is the contact zone
    """

    distance: np.ndarray
    zones: np.ndarray
    pressure: np.ndarray
    friction: np.ndarray


def Scales(contact: ContactBoundary, displacement: Array, traction: Array) -> tuple[float, float]:
    """(u_s, t_s): t_s = max |t|, and u_s = max |u| or, if that is more, what t_s would do to the body, t_s L/mu.

    On a stiff foundation with friction u alone tends to zero on all of Gamma_C and would be no scale; where nothing is loaded
    u is the round-off of the gap, which then is the scale.
    """
    tscale = np.linalg.norm(traction, axis=1).max(initial=0)
    uscale = max(np.linalg.norm(displacement, axis=1).max(initial=0), tscale * contact.flexibility)
    gap = np.abs(contact.gap).max(initial=0)
    if uscale <= ROUNDOFF * gap:
        uscale, tscale = gap, gap / contact.flexibility
    return uscale or 1.0, tscale or 1.0


def Distance(contact: ContactBoundary, displacement: Array, traction: Array) -> GraphDistance:
    """How far displacement and traction (n, d) at the contact points are from the law; the same for soft and stiff foundations.

    Along (*) with gamma = t_s/u_s both coordinates of the graph are reached at once, and what is left, |u - U(q)|/u_s =
    |t - t(q)|/t_s, is at most min(|t - p(u)|/t_s, |u - p^-1(t)|/u_s) for a monotone law, and at least half of it unless p'
    passes t_s/u_s in between, as at the kink of a stiff law, where both terms of the minimum overrate the distance.  The scales
    are those of `Scales`; for friction t_s is max p_t.

    A law that is not monotone can have several points on the line (*), and the one found may be far off; then |t - p(u)|/t_s
    is smaller, and taken.
    """
    uscale, tscale = Scales(contact, displacement, traction)
    r, t = contact.Penetration(displacement), contact.Normal(traction)
    slip, friction = contact.Tangential(contact.SinceOrigin(displacement)), contact.Tangential(traction)
    gamma = np.full(len(r), tscale / uscale)
    depth, pressure, _ = OverParts(contact.parts, ContactPart.NormalPoint, gamma, t + gamma * r)
    above = OverParts(contact.parts, ContactPart.Pressure, r)
    straight = np.abs(t - above) < gamma * np.abs(r - depth)
    distance = np.where(straight, np.abs(t - above) / gamma, np.abs(r - depth)) / uscale
    depth, pressure = np.where(straight, (r, above), (depth, pressure))
    bound = OverParts(contact.parts, ContactPart.Bound, depth, pressure)
    # Below a part LEAST of the tractions the scale would be that of their round-off.
    gamma = np.full(len(r), (max(bound.max(initial=0), LEAST * tscale) if np.any(bound) else tscale) / uscale)
    q = friction + gamma[:, None] * slip
    length = np.linalg.norm(q, axis=1)
    slid = np.linalg.norm(slip, axis=1)
    creep, factor, _ = OverParts(contact.parts, ContactPart.SlipPoint, gamma, bound, length)
    limit, above = bound * factor, bound * OverParts(contact.parts, ContactPart.SlipFactor, slid)[0]
    sliding = length >= limit
    expected = np.where(sliding, creep, 0)[:, None] * q / np.where(length > 0, length, 1)[:, None]
    along = np.linalg.norm(slip - expected, axis=1)
    off = np.linalg.norm(friction - above[:, None] * slip / np.where(slid > 0, slid, 1)[:, None], axis=1) / gamma
    straight = (off < along) & (slid > 0)
    sliding |= straight
    distance = np.maximum(distance, np.where(straight, off, along) / uscale)
    least = OverParts(contact.parts, ContactPart.Least, pressure)
    zones = np.where(pressure <= least, SEPARATION, np.where(sliding, SLIP, STICK))
    # Where an iteration has left no number for the displacement only the traction tells.
    pressure = np.where(np.isnan(r), np.maximum(t, least),
                        np.where(zones == SEPARATION, least, np.where(t <= least, pressure, t)))
    return GraphDistance(distance, zones, pressure, np.where(limit[:, None] > 0, friction, 0))


def _Outer(a: Array, b: Array) -> Array:
    return a[:, :, None] * b[:, None, :]


def CheckEnds(contact: ContactBoundary, displacement: Array, traction: Array) -> None:
    """Raise ProblemError if displacement and traction (n, d) are where a law has ended.

    Beyond the last penetration, or slip, at which a law is finite its graph goes on as that of a rigid wall, so that iterations
    may pass there; a solution on the wall is none of the law.
    """
    uscale, tscale = Scales(contact, displacement, traction)
    gamma = np.full(len(contact.weights), tscale / uscale)
    q = contact.Normal(traction) + gamma * contact.Penetration(displacement)
    length = np.linalg.norm(contact.Tangential(traction + gamma[:, None] * contact.SinceOrigin(displacement)), axis=1)
    for part in contact.parts:
        part.CheckEnds(gamma[part.points], q[part.points], length[part.points])
