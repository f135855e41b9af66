"""One step of the Uzawa iterations, as a map of what is known at the points of Gamma_C.

A step is `Start(u)` -> state, `At(state)` -> (traction, memory) by the contact law, and `Next(memory, u)` -> state, linear,
with u = u_f - S traction the response of the body.  `metric` makes the components of states comparable.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...contact.boundary import ContactBoundary, Scale
from ...contact.graph import ContactGraph
from ...contracts import Array


class ExplicitStep:
    """State (u, lambda), (2, n, d): t = p_n(u_n - g) n + p_t P(lambda + rho p_t u_t), P the projection onto the unit ball.

    `rho` is the paper's [1/(stress length)], or None for rho = step/p_t^2 with the `step` [stress/length] of the friction
    traction.
    """

    def __init__(self, contact: ContactBoundary, rho: float | None, step: float | None) -> None:
        self.contact, self.rho, self.step = contact, rho, step

    def Start(self, u: Array) -> Array:
        self.metric = np.sqrt(self.contact.weights)[:, None] / np.array([Scale(u), 1.0])[:, None, None]
        return np.stack([u, np.zeros_like(u)])

    def Rho(self, bound: Array) -> Array:
        """rho at every point, (n,); where there is no friction lambda does not matter and rests."""
        if self.rho is not None:
            return np.full(len(bound), self.rho)
        return np.where(bound > 0, self.step / np.where(bound > 0, bound, 1) ** 2, 0)

    def At(self, state: Array) -> tuple[Array, Any]:
        contact, (u, multiplier) = self.contact, state
        r = contact.Penetration(u)
        bound = contact.Bound(r, contact.Slip(u))
        multiplier = _OntoUnitBall(multiplier + (self.Rho(bound) * bound)[:, None] * contact.Tangential(contact.SinceOrigin(u)))
        return contact.Pressure(r)[:, None] * contact.normals + bound[:, None] * multiplier, multiplier

    def Next(self, memory: Any, u: Array) -> Array:
        return np.stack([u, memory])


class ImplicitStep:
    """State q = t + gamma u, (n, d): t and U(q) are the point of the law's graph with t + gamma U = q (`ContactGraph`)."""

    def __init__(self, contact: ContactBoundary, gamma: float) -> None:
        self.contact, self.gamma, self.metric = contact, gamma, np.sqrt(contact.weights)[:, None]

    def Start(self, u: Array) -> Array:
        return self.Next(np.zeros_like(u), u)

    def At(self, state: Array) -> tuple[Array, Any]:
        traction = ContactGraph(self.contact, self.gamma).At(state).traction
        return traction, traction

    def Next(self, memory: Any, u: Array) -> Array:
        return memory + self.gamma * u


class AdaptiveStep(ImplicitStep):
    """The implicit step with gamma of Barzilai, Borwein, IMA J. Numer. Anal. 8 (1988).

    With dt and du = -S dt the changes of the last step, gamma = |dt|^2/(dt, S dt): the inverse of a mean eigenvalue of S over
    what is left of the error.  It may be large, and then the residual |u - U(q)| grows for a while.  Where a projection is
    involved such steps can cycle (Dai, Fletcher, Numer. Math. 100, 2005); so when the residual exceeds GROWTH times its
    smallest value over the last MEMORY steps, gamma falls back to the inverse of the largest eigenvalue seen, which is safe.
    """

    GROWTH = 100    # a factor of 10 spoils half of the fast steps of stiff problems
    MEMORY = 10

    def Start(self, u: Array) -> Array:
        self.last, self.largest = (np.zeros_like(u), u), 1 / self.gamma
        self.residuals: list[float] = []
        return super().Next(*self.last)

    def At(self, state: Array) -> tuple[Array, Any]:
        point = ContactGraph(self.contact, self.gamma).At(state)
        return point.traction, (point.traction, point.displacement)

    def Next(self, memory: Any, u: Array) -> Array:
        traction, expected = memory
        dt, du = self.metric * (traction - self.last[0]), self.metric * (self.last[1] - u)
        self.last = traction, u
        product = np.vdot(dt, du)
        # Nothing moved at the start, and S vanishes where the trace space is smaller than the set of points.
        if product > 0:
            self.largest = max(self.largest, np.vdot(du, du) / product)
            residual = float(np.linalg.norm(self.metric * (u - expected)))
            self.residuals = self.residuals[-self.MEMORY:] + [residual]
            grown = residual > self.GROWTH * min(self.residuals)
            self.gamma = 1 / self.largest if grown else np.vdot(dt, dt) / product
        return super().Next(traction, u)


UzawaStep = ExplicitStep | ImplicitStep


class Anderson:
    """Anderson's acceleration (type II) of a map x -> G(x), after Walker, Ni, SIAM J. Numer. Anal. 49 (2011).

    From the last pairs of x and f = G(x) - x the next x is G(x) - dG c with |f - dF c| least, dG and dF being differences of
    successive G and f.  If |f| exceeds GROWTH times its smallest value, the past is forgotten and a plain step G(x) made:
    without this the kinks of the law let the iteration wander.
    """

    WINDOW = 30     # differences kept; 10 take twice the steps on stiff problems, 100 are misled by zones long left
    GROWTH = 2
    RCOND = 1e-10   # differences that depend on each other up to round-off are left out

    def __init__(self, metric: Array) -> None:
        self.metric, self.best = metric, np.inf
        self.images: list[Array] = []
        self.residuals: list[Array] = []

    def __call__(self, state: Array, image: Array) -> Array:
        """The next x, from x and G(x), arrays of one shape."""
        residual = (self.metric * (image - state)).ravel()
        length = float(np.linalg.norm(residual))
        if length > self.GROWTH * self.best:
            self.images, self.residuals = [], []
        self.best = min(self.best, length)
        self.images = self.images[-self.WINDOW:] + [image]
        self.residuals = self.residuals[-self.WINDOW:] + [residual]
        if len(self.images) == 1:
            return image
        coefficients = np.linalg.lstsq(np.diff(self.residuals, axis=0).T, residual, rcond=self.RCOND)[0]
        return image - np.tensordot(coefficients, np.diff(self.images, axis=0), axes=1)


def _OntoUnitBall(vectors: Array) -> Array:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1), 1)[:, None]
