"""The contact law as a graph: displacement and traction at a point of Gamma_C as functions of one vector.

With a scale gamma > 0 [stress/length] every q in R^d belongs to exactly one pair (u, t) that obeys the law (2.7)-(2.9) and

    t + gamma u = q,                                                                                        (*)

as long as p_n' and the slope of the friction bound in the slip stay above -gamma: Minty's parametrisation of a monotone graph.
Functions of q are piecewise smooth and Lipschitz however stiff the law is, also where t is no function of u (stick, u_t = 0)
and where it nearly is none (p_n' -> infinity).  With u = U(q), t = t(q):

    normal    p = p_n(r), r = u_n - g:    p + gamma r = q_n - gamma g, one scalar equation; p = 0 if that is <= 0
    stick     |q_t| <= p_t(r, p, 0):      t_t = q_t, u_t = 0
    slip      otherwise:                  |u_t| = s from p_t(r, p, s) + gamma s = |q_t|, t_t = p_t q_t/|q_t|
"""

from dataclasses import dataclass

import numpy as np

from ..exceptions import ProblemError
from ..problem.hypotheses import BoundDerivatives, SlipFactor
from ..problem.userlaws import CheckFinite, LawName

SEPARATION, STICK, SLIP = 0, 1, 2
ZONES = ("separation", "stick", "slip")
STEPS = 200     # of the safeguarded iteration for one scalar equation; bisection alone needs 60
LEAST = 1e-3    # scale of friction, relative to the tractions
MISSED = 1e-9   # of the scalar equation, relative: more is no round-off, its value jumps


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

    def __init__(self, contact, scale):
        self.contact = contact
        self.scale = np.broadcast_to(np.asarray(scale, dtype=float), contact.weights.shape)

    def Coordinates(self, displacement, traction):
        """q = t + gamma u, (n, d) [stress]."""
        return traction + self.scale[:, None] * displacement

    def At(self, q):
        """The GraphPoint of q (n, d); raises ProblemError if a law returns a value that is not finite."""
        contact, scale, normals = self.contact, self.scale, self.contact.normals
        qn = contact.Normal(q)
        qt = q - qn[:, None] * normals
        r, p, dr, dp = (np.empty(len(scale)) for _ in range(4))
        base, dbase, bound, slip, along, cross = (np.zeros(len(scale)) for _ in range(6))
        length = np.linalg.norm(qt, axis=1)
        for _, here, compliance, friction in contact.parts:
            gamma = scale[here]
            r[here], p[here], slope = NormalPart(compliance, gamma, qn[here] - gamma * contact.gap[here])
            dr[here], dp[here] = 1 / (gamma + slope), Share(slope, gamma)
            if friction is None:
                slip[here] = length[here] / gamma
                continue
            base[here] = friction.Bound(r[here], p[here])
            byr, byp = BoundDerivatives(friction, r[here], p[here])
            slip[here], factor, slope = SlipPart(friction, gamma, base[here], length[here])
            bound[here] = base[here] * factor
            dbase[here] = byr * dr[here] + byp * dp[here]
            along[here], cross[here] = Share(slope, gamma), dbase[here] * factor / (gamma + slope)
        sliding = length >= bound
        direction = qt / np.where(length > 0, length, 1)[:, None]
        friction = np.where(sliding, bound, length)
        traction = p[:, None] * normals + friction[:, None] * direction
        displacement = (r + contact.gap)[:, None] * normals + np.where(sliding, slip, 0)[:, None] * direction
        with np.errstate(all="ignore"):
            # It tells that nothing is wrong; where is asked only if something is.
            total = np.sum(p + r + dr + base + dbase + bound + along + slip) + np.sum(q)
        if not np.isfinite(total):
            self._CheckFinite(q, r, slip, {"Pressure": p + r, "PressureDerivative": dr, "Bound": base,
                                           "BoundDerivatives": dbase, "Coefficient": bound + along + slip})
        zones = np.where(p <= 0, SEPARATION, np.where(sliding, SLIP, STICK))
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

    def _CheckFinite(self, q, r, slip, values):
        if not np.all(np.isfinite(q)):
            raise ProblemError("displacement and traction of a contact point are not finite; look for data of extreme size")
        sought = (self.contact.Normal(q) / self.scale) - self.contact.gap       # of a law that is finite nowhere
        for method, found in values.items():
            where = (slip, "slip") if method == "Coefficient" else (np.where(np.isfinite(r), r, sought), "penetration")
            CheckFinite(self.contact, method, found, *where)


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


def Scales(contact, displacement, traction):
    """(u_s, t_s): t_s = max |t|, and u_s = max |u| or, if that is more, what t_s would do to the body, t_s L/mu.

    On a stiff foundation with friction u alone tends to zero on all of Gamma_C and would be no scale.
    """
    tscale = np.linalg.norm(traction, axis=1).max(initial=0)
    uscale = max(np.linalg.norm(displacement, axis=1).max(initial=0), tscale * contact.flexibility)
    return uscale or 1.0, tscale or 1.0


def Distance(contact, displacement, traction):
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
    slip, friction = contact.Tangential(displacement), contact.Tangential(traction)
    gamma = np.full(len(r), tscale / uscale)
    depth, pressure, bound, distance = (np.zeros(len(r)) for _ in range(4))
    for _, here, compliance, law in contact.parts:
        depth[here], pressure[here], _ = NormalPart(compliance, gamma[here], t[here] + gamma[here] * r[here])
        above = compliance.Pressure(r[here])
        straight = np.abs(t[here] - above) < gamma[here] * np.abs(r[here] - depth[here])
        distance[here] = np.where(straight, np.abs(t[here] - above) / gamma[here], np.abs(r[here] - depth[here])) / uscale
        depth[here], pressure[here] = np.where(straight, (r[here], above), (depth[here], pressure[here]))
        if law is not None:
            bound[here] = law.Bound(depth[here], pressure[here])
    # Below a part LEAST of the tractions the scale would be that of their round-off.
    gamma = np.full(len(r), (max(bound.max(initial=0), LEAST * tscale) if np.any(bound) else tscale) / uscale)
    q = friction + gamma[:, None] * slip
    length = np.linalg.norm(q, axis=1)
    creep, limit, above, slid = length / gamma, np.zeros(len(r)), np.zeros(len(r)), np.linalg.norm(slip, axis=1)
    for _, here, _, law in contact.parts:
        if law is not None:
            creep[here], factor, _ = SlipPart(law, gamma[here], bound[here], length[here])
            limit[here] = bound[here] * factor
            above[here] = bound[here] * SlipFactor(law, slid[here])[0]
    sliding = length >= limit
    expected = np.where(sliding, creep, 0)[:, None] * q / np.where(length > 0, length, 1)[:, None]
    along = np.linalg.norm(slip - expected, axis=1)
    off = np.linalg.norm(friction - above[:, None] * slip / np.where(slid > 0, slid, 1)[:, None], axis=1) / gamma
    straight = (off < along) & (slid > 0)
    sliding |= straight
    distance = np.maximum(distance, np.where(straight, off, along) / uscale)
    zones = np.where(pressure <= 0, SEPARATION, np.where(sliding, SLIP, STICK))
    # Where an iteration has left no number for the displacement only the traction tells.
    pressure = np.where(np.isnan(r), np.maximum(t, 0), np.where(zones == SEPARATION, 0, np.where(t <= 0, pressure, t)))
    return GraphDistance(distance, zones, pressure, np.where(limit[:, None] > 0, friction, 0))


def _Outer(a, b):
    return a[:, :, None] * b[:, None, :]


def CheckEnds(contact, displacement, traction):
    """Raise ProblemError if displacement and traction (n, d) are where a law has ended.

    Beyond the last penetration, or slip, at which a law is finite its graph goes on as that of a rigid wall, so that iterations
    may pass there; a solution on the wall is none of the law.
    """
    uscale, tscale = Scales(contact, displacement, traction)
    gamma = np.full(len(contact.weights), tscale / uscale)
    q = contact.Normal(traction) + gamma * contact.Penetration(displacement)
    length = np.linalg.norm(contact.Tangential(traction + gamma[:, None] * displacement), axis=1)
    for _, here, compliance, friction in contact.parts:
        _RaiseWhere(f"{LawName(compliance)}.Pressure", "penetration", *Resolvent(
            compliance.Pressure, compliance.PressureDerivative, gamma[here], q[here]))
        if friction is not None:
            base = friction.Bound(*NormalPart(compliance, gamma[here], q[here])[:2])
            _RaiseWhere(f"{LawName(friction)}.Coefficient", "slip", *_Slip(friction, gamma[here], base, length[here]))


def _RaiseWhere(method, word, values, ended):
    if np.any(ended):
        raise ProblemError(f"{method} is not finite beyond {word} {values[ended].min():.6g}, and more would be needed: the law "
                           f"ends there; give it values for larger {word}s, or make the loads smaller")


def NormalPart(law, gamma, q):
    """(r, p, p_n'(r)) with p = p_n(r) and p + gamma r = q, arrays (n,); where the law has ended, a rigid wall."""
    r, ended = Resolvent(law.Pressure, law.PressureDerivative, gamma, q)
    with np.errstate(all="ignore"):
        slope = np.where(r > 0, law.PressureDerivative(np.where(r > 0, r, 0)), 0)
        slope = np.where(ended, np.inf, slope)
        # Where the law is stiff p_n(r) would multiply the round-off of r by p_n'.
        p = np.where(r > 0, np.where(slope < gamma, law.Pressure(r), q - gamma * r), 0)
        return r, p, slope


def Share(slope, gamma):
    """slope/(gamma + slope), the share of q that is traction, also for a slope that is infinite: nothing cancels."""
    with np.errstate(divide="ignore"):
        return 1 / (1 + gamma / slope)


def SlipPart(law, gamma, base, length):
    """(s, factor, d(base factor)/ds) with base factor(s) + gamma s = length where length > base factor(0), else s = 0."""
    slip, ended = _Slip(law, gamma, base, length)
    factor, slope = SlipFactor(law, slip)
    if np.any(ended):
        return slip, np.where(ended, (length - gamma * slip) / base, factor), np.where(ended, np.inf, base * slope)
    return slip, factor, base * slope


def _Slip(law, gamma, base, length):
    """`Resolvent` of the friction at points with these bounds without slip."""
    return Resolvent(lambda s: base * SlipFactor(law, s)[0], lambda s: base * SlipFactor(law, s)[1], gamma, length)


def Resolvent(Value, Derivative, gamma, q):
    """(x, ended): x >= 0 with Value(x) + gamma x = q where q > Value(0), else min(q, 0)/gamma.

    By Newton's iteration inside a bracket.  Arguments and results are arrays (n,); Value >= 0.  A value that is not finite
    counts as too large: a law may end somewhere.
    Where that decides, x is the last point at which Value is finite, and `ended` True.  Finite nowhere gives nan.
    """
    start = np.zeros_like(q)
    with np.errstate(all="ignore"):
        free = ~(q <= Value(start))
        low, high = start, np.maximum(q, 0) / gamma
        x = high.copy()
        for _ in range(STEPS):
            excess = Value(x) + gamma * x - q
            low, high = np.where(excess <= 0, x, low), np.where(excess <= 0, high, x)
            new = x - excess / (gamma + Derivative(x))
            new = np.where((new > low) & (new < high), new, 0.5 * (low + high))
            # A Newton step that leaves the bracket by round-off has converged.
            done = (np.abs(excess) <= 4e-16 * q) | (high - low <= 4e-16 * high) | ~free
            if np.all(done):
                break
            x = np.where(done, x, new)
        else:
            excess = Value(x) + gamma * x - q
        ended = free & ~(np.abs(excess) <= MISSED * q)
        if np.any(ended):
            ended &= ~np.isfinite(Value(high))
            x = np.where(np.isfinite(excess), x, np.where(low > 0, low, np.nan))
    return np.where(free, x, np.minimum(q, 0) / gamma), ended
