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
from ..discrete.punched import Enlarged
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
class _Pair:
    """u, t and b of a state, u without the motions of punches that were found."""

    displacement: Array
    traction: Array
    free: Array


class Increments:
    """The increments after a state with contact, of a Discretization whose matrix is symmetric and factorised.

    moment : the state;  tol : of the law residual
    """

    def __init__(self, moment: Instant, tol: float) -> None:
        disc, self.tol = moment.disc, tol
        equations = Enlarged(disc)
        setting, displacement = Setting.Of(equations), moment.displacement - disc.contact.found
        self.scale = setting.scale
        point = setting.graph.At(setting.graph.Coordinates(displacement, moment.traction))
        self.stiffness = setting.Stiffness(point)
        self.response = ContactResponse(equations, self.stiffness)
        dim = disc.contact.dim
        blocks = cast(Array, np.linalg.inv(self.stiffness + (self.scale / NEAR)[:, None, None] * np.eye(dim)))
        self.known = KnownResponse(lambda s: self.response.Product(s), disc.contact.weights, blocks)
        self.known.Learn(moment.traction - Apply(self.stiffness, displacement))
        self.loads = SpannedLoads(lambda load: self.response.Solve(load))
        # What is not known of S_D does not add up if all changes are counted from the first state.
        self.first = self.pair = _Pair(displacement=displacement, traction=moment.traction,
                                       free=self._Free(moment.loading)[0])
        self.moment = self._Moment(disc, moment.loading, self.pair, moment.residual)
        self.last = self.moment, self.pair
        self.left = WORK
        self.unsure = 1.0       # how far S_V has been off, relative

    def Next(self, disc: DiscreteProblem) -> Instant | None:
        """The state under the data of now, slip counted from the last one, or None if that was not found."""
        self.response = self.response.Moved(Enlarged(disc))
        loading = Loading.Of(disc)
        graph, free = ContactGraph(self.response.contact, self.scale), self._Free(loading)[0]
        q = graph.Coordinates(self.pair.displacement, self.pair.traction)
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
        error, self.last = self._Error(found), (self.moment, self.pair)
        self.pair = _Pair(displacement=found.point.displacement, traction=found.point.traction, free=free)
        self.moment = self._Moment(disc, loading, self.pair, error)
        return self.moment

    def Back(self) -> None:
        """Take the last `Next` back."""
        self.moment, self.pair = self.last

    def _Negligible(self, outside: Array, point: GraphPoint) -> bool:
        """Is what S_D may do to a part of s of which it is not known below the tolerance?"""
        return self._Unknown(outside, point) <= UNKNOWN * self.tol

    def _Unknown(self, outside: Array, point: GraphPoint) -> float:
        """What S_D may do to a part of s of which it is not known, relative."""
        return self._Relative(self.unsure * self.known.Times(outside), point)

    def _Relative(self, change: Array, point: GraphPoint) -> float:
        """A change of the displacement, and what it does to the traction, relative to these now or in the last state."""
        (u, t), (v, s) = (Scales(self.response.contact, at.displacement, at.traction) for at in (point, self.pair))
        pull = Apply(np.abs(self.stiffness), np.abs(change))
        return float(max(np.abs(change).max(initial=0) / max(u, v), pull.max(initial=0) / max(t, s)))

    def _Error(self, found: _Found) -> float:
        """How far the point of the graph is from equilibrium, relative."""
        return self._Relative(found.F, found.point) + self._Unknown(self.known.Outside(found.s), found.point)

    def _Free(self, loading: Loading) -> tuple[Array, Array]:
        """(b at the contact points (n, d), its coefficients (ndof + m,)): the response to the loads alone."""
        contact, still = self.response.contact, np.zeros(len(loading.pressed))
        load, lift = np.append(loading.load, loading.pressed), None
        if loading.lift is not None and loading.pull is not None:
            lift = np.append(loading.lift, still)
            load = load - np.append(loading.pull, still) - contact.Load(Apply(self.stiffness, contact.Displacement(lift)))
        vector = self.loads.Response(load)
        if lift is not None:
            vector = vector + lift
        return contact.Displacement(vector), vector

    def _Moment(self, disc: DiscreteProblem, loading: Loading, pair: _Pair, residual: float) -> Instant:
        contact, free, count = self.response.contact, self._Free(loading)[1], len(loading.pressed)
        s = contact.weights[:, None] * (pair.traction - Apply(self.stiffness, pair.displacement))

        def Product(x: Array) -> float:
            """x.u = x.(free response) - V x.(T' W s), for a symmetric matrix."""
            return float(x @ free - np.vdot(contact.Displacement(self.loads.Response(x)), s))

        motions = np.eye(count, len(free), len(free) - count)
        placed = disc.Moved(np.array([Product(motion) for motion in motions]) if count else None)
        return Instant(disc=placed, loading=loading, displacement=pair.displacement + placed.contact.found,
                       traction=pair.traction, residual=residual, Product=lambda x: Product(np.append(x, np.zeros(count))))

    def _BySteps(self, graph: ContactGraph, free: Array) -> _Found:
        """The state with S_V, by substeps of the load from the last state."""
        for halvings in range(1, SUBSTEPS + 1):
            q = graph.Coordinates(self.pair.displacement, self.pair.traction)
            for part in np.arange(1, 2 ** halvings + 1) / 2 ** halvings:
                found = self._Newton(graph, q, self.pair.free + part * (free - self.pair.free))
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
