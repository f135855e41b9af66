"""Increments on Gamma_C alone: one matrix, its factors and all products so far serve for all of them.

With D the stiffness of the law in a state with contact and b the displacement of Gamma_C that A + T' W D T gives under the
loads alone, each state is a point of the graph of the law with

    U(q) = u + (change of b) - S_D s,     s = t(q) - t - D (U(q) - u),

u and t those of the first state.

Of S_D the S_V of `KnownResponse` is known, b for loads that are combinations of earlier ones (`SpannedLoads`).  Newton's method
solves the equation with S_V, which costs no application; what s has outside of the span becomes the next known
direction, until what that might change is below the tolerance.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np

from ..contact.graph import ContactGraph, GraphPoint, Scales
from ..contracts import Array
from ..discrete.problem import DiscreteProblem
from ..discrete.response import Apply, ContactResponse
from ..solvers.newton.setting import Setting
from ..solvers.newton.stiffened import NEAR
from .known import KnownResponse
from .loading import Loading, Instant
from .spanned import SpannedLoads

DIRECTIONS = 200    # new ones in an increment, after which it has failed
STEPS = 40          # of Newton's method with S_V
HALVINGS = 8        # of one of them
DECREASE = 1e-4     # relative decrease of |F|^2 that a full step must bring,
LEAPS = 5           # but for so many, which may lead out of a local minimum
WORK = 8000         # of all these steps in an increment, after which it has failed
SUBSTEPS = 6        # the load of an increment is divided into 2^6 parts at most, where Newton's method fails though S_V is S_D
GOAL = 0.02         # of the tolerance, for Newton's method with S_V
ROUNDOFF = 1e-13    # what it leaves at best, relative
EARLY = 0.1        # of what S_V may be off, at which that method can stop
UNKNOWN = 0.5       # of the tolerance, that what is not known of S_D may change


@dataclass(frozen=True, kw_only=True, eq=False)
class _Found:
    """A point of the graph, s, the change of t - D U that led there, F, and whether F is small enough."""

    point: GraphPoint
    s: Array
    F: Array
    solved: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class _First:
    """u, t and b of the state from which all changes are counted: what is not known of S_D does not add up."""

    displacement: Array
    traction: Array
    free: Array


class Increments:
    """The increments after a state with contact, of a Discretization whose matrix is symmetric and factorised.

    moment : the state;  tol : of the law residual
    """

    def __init__(self, moment: Instant, tol: float) -> None:
        disc, self.tol = moment.disc, tol
        setting = Setting.Of(disc)
        self.scale = setting.scale
        point = setting.graph.At(setting.graph.Coordinates(moment.displacement, moment.traction))
        self.stiffness = setting.Stiffness(point)
        self.response = ContactResponse(disc, self.stiffness)
        dim = disc.contact.dim
        blocks = cast(Array, np.linalg.inv(self.stiffness + (self.scale / NEAR)[:, None, None] * np.eye(dim)))
        self.known = KnownResponse(lambda s: self.response.Product(s), disc.contact.weights, blocks)
        self.known.Learn(moment.traction - Apply(self.stiffness, moment.displacement))
        self.loads = SpannedLoads(lambda load: self.response.Solve(load))
        self.moment = self._Moment(disc, moment.loading, moment, moment.residual)
        self.free = self._Free(disc, moment.loading)[0]
        self.first = _First(displacement=moment.displacement, traction=moment.traction, free=self.free)
        self.last = self.moment, self.free
        self.left = WORK
        self.unsure = 1.0       # how far S_V has been off, relative

    def Next(self, disc: DiscreteProblem) -> Instant | None:
        """The state under the data of now, slip counted from the last one, or None if that was not found."""
        contact, self.response = disc.contact, self.response.Moved(disc)
        loading = Loading.Of(disc)
        graph, free = ContactGraph(contact, self.scale), self._Free(disc, loading)[0]
        q = graph.Coordinates(self.moment.displacement, self.moment.traction)
        self.left = WORK
        for _ in range(DIRECTIONS):
            found = self._Newton(graph, q, free)
            outside = self.known.Outside(found.s)
            known = self._Negligible(outside, found.point)
            if known and not found.solved:      # not for want of knowledge
                found = self._BySteps(graph, free)
                outside = self.known.Outside(found.s)
                known = self._Negligible(outside, found.point)
            if known and found.solved:
                break
            if self.known.complete or self.left <= 0:
                return None
            if known:       # what F asks for may lead on
                asked = np.linalg.solve(self.known.blocks, found.F[..., None])[..., 0]
                outside = self.known.Outside(cast(Array, asked))
            q, self.unsure = found.point.q, max(self.known.Learn(outside), 0.5 * self.unsure)
        else:
            return None
        self.last = self.moment, self.free
        self.moment, self.free = self._Moment(disc, loading, found.point, self._Error(found)), free
        return self.moment

    def Back(self) -> None:
        """Take the last `Next` back."""
        self.moment, self.free = self.last

    def _Negligible(self, outside: Array, point: GraphPoint) -> bool:
        """Is what S_D may do to a part of s of which it is not known below the tolerance?"""
        return self._Unknown(outside, point) <= UNKNOWN * self.tol

    def _Unknown(self, outside: Array, point: GraphPoint) -> float:
        """What S_D may do to a part of s of which it is not known, relative."""
        return self._Relative(self.unsure * self.known.Times(outside), point)

    def _Relative(self, change: Array, point: GraphPoint) -> float:
        """A change of the displacement, and what it does to the traction, relative to these now or in the last state."""
        contact, last = self.moment.disc.contact, self.moment
        (u, t), (v, s) = (Scales(contact, pair.displacement, pair.traction) for pair in (point, last))
        pull = Apply(np.abs(self.stiffness), np.abs(change))
        return float(max(np.abs(change).max(initial=0) / max(u, v), pull.max(initial=0) / max(t, s)))

    def _Error(self, found: _Found) -> float:
        """How far the point of the graph is from equilibrium, relative."""
        return self._Relative(found.F, found.point) + self._Unknown(self.known.Outside(found.s), found.point)

    def _Free(self, disc: DiscreteProblem, loading: Loading) -> tuple[Array, Array]:
        """(b at the contact points (n, d), its coefficients (ndof,)): the response to the loads alone."""
        contact, load = disc.contact, loading.load
        if loading.lift is not None and loading.pull is not None:
            load = load - loading.pull - contact.Load(Apply(self.stiffness, contact.Displacement(loading.lift)))
        vector = self.loads.Response(load)
        if loading.lift is not None:
            vector = vector + loading.lift
        return contact.Displacement(vector), vector

    def _Moment(self, disc: DiscreteProblem, loading: Loading, pair: GraphPoint | Instant, residual: float) -> Instant:
        displacement, traction = pair.displacement, pair.traction
        contact, free = disc.contact, self._Free(disc, loading)[1]
        s = contact.weights[:, None] * (traction - Apply(self.stiffness, displacement))

        def Product(x: Array) -> float:
            """x.u = x.(free response) - V x.(T' W s), for a symmetric matrix."""
            return float(x @ free - np.vdot(contact.Displacement(self.loads.Response(x)), s))

        return Instant(disc=disc, loading=loading, displacement=displacement, traction=traction, residual=residual,
                      Product=Product)

    def _BySteps(self, graph: ContactGraph, free: Array) -> _Found:
        """The state with S_V, by substeps of the load from the last state."""
        for halvings in range(1, SUBSTEPS + 1):
            q = graph.Coordinates(self.moment.displacement, self.moment.traction)
            for part in np.arange(1, 2 ** halvings + 1) / 2 ** halvings:
                found = self._Newton(graph, q, self.free + part * (free - self.free))
                q = found.point.q
                if not found.solved:
                    break
            if found.solved:
                break
        return found

    def _Newton(self, graph: ContactGraph, q: Array, free: Array) -> _Found:
        """A zero of F(q) = U - u - (change of b) + S_V s, or where Newton's method ended."""
        D, weights, first = self.stiffness, graph.contact.weights[:, None], self.first

        def Evaluate(q: Array) -> tuple[GraphPoint, Array, Array, float]:
            point = graph.At(q)
            s = point.traction - first.traction - Apply(D, point.displacement - first.displacement)
            F = point.displacement - first.displacement - (free - first.free) + self.known.Times(s)
            return point, s, F, float(np.sum(weights * F ** 2))

        goal, leaps = max(GOAL * self.tol, ROUNDOFF), LEAPS
        point, s, F, merit = Evaluate(q)
        for _ in range(STEPS):
            if self._Relative(F, point) <= max(goal, EARLY * self._Unknown(self.known.Outside(s), point)):
                return _Found(point=point, s=s, F=F, solved=True)
            self.left -= 1
            relief = (np.eye(graph.contact.dim) - point.derivative) / self.scale[:, None, None]
            step = self.known.Solve(relief, point.derivative - D @ relief, -F)
            if not np.all(np.isfinite(step)):
                break
            trials = (Evaluate(point.q + step / 2 ** halvings) for halvings in range(HALVINGS + 1))
            better = next((trial for trial in trials if trial[3] <= (1 - DECREASE) * merit), None)
            if better is None:
                if not leaps:
                    break
                leaps, better = leaps - 1, Evaluate(point.q + step)
            point, s, F, merit = better
        return _Found(point=point, s=s, F=F, solved=self._Relative(F, point) <= goal)
