"""How a foundation holds a body that nothing else holds: by its own stiffness, at the depth where it carries the loads."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...contact.parts import ContactPart, OverParts
from ...contact.resolvent import Resolvent, Share
from ...contracts import Array, LinearProblem

DEEPEST = 1e-12     # stiffness in units of the body's, that limits the depth where a law ends before it carries the loads
TOUCH = 1e-6        # penetration that counts as contact, in units of the extent of Gamma_C


class Holding:
    """The depth at which the foundation carries the loads if it is the same everywhere, and how stiff it is from there on.

    scale : gamma (n,) of the graph [stress/length]

    Attributes
    ----------
    depth : r > 0 with int_GammaC p_n(r) = |loads| [length], 0 without loads
    stiffness : p_n(r)/r at that depth (n,) [stress/length]
    slope : dt/dq (n, d, d) with the secant stiffness p_n(r)/r along the normal, and that of stick where there is friction.
        A soft foundation holds a body as well as a stiff one: what counts as little is measured by this, not by the body
    """

    def __init__(self, disc: LinearProblem, scale: Array) -> None:
        contact = self.contact = disc.contact
        self.scale, weights = scale, contact.weights / contact.weights.sum()
        load = np.linalg.norm(disc.resultant) / contact.weights.sum()
        depth, _ = Resolvent(lambda r: np.array([weights @ self._AtDepth(ContactPart.Pressure, r[0])]),
                             lambda r: np.array([weights @ self._AtDepth(ContactPart.PressureDerivative, r[0])]),
                             DEEPEST * scale.min(), np.array([load]))
        self.depth = float(depth[0])
        stiffness = self.stiffness = self._AtDepth(ContactPart.Pressure, self.depth) / self.depth if self.depth > 0 else scale
        normal = contact.normals[:, :, None] * contact.normals[:, None, :]
        self.slope = Share(stiffness, scale)[:, None, None] * normal
        for part in contact.parts:
            if part.friction is not None:
                self.slope[part.points] += np.eye(contact.dim) - normal[part.points]

    def _AtDepth(self, Law: Callable[..., Array], r: float) -> Array:
        """A law of ContactPart (n,) at one penetration; it may not be finite, where a law has ended."""
        return OverParts(self.contact.parts, Law, np.full(len(self.scale), r))

    def Rest(self) -> Array:
        """q (n, d) of a start in contact everywhere, or the first step would be a flight.

        It is as deep as if all points carried the loads: a law that starts flat, like r^3, has no slope at touch.
        """
        contact, q = self.contact, np.zeros(len(self.scale))
        if self.depth > 0:
            r = max(self.depth, TOUCH * np.ptp(contact.coordinates, axis=0).max())
            q = self._AtDepth(ContactPart.Pressure, self.depth) + self.scale * (r + contact.gap)
        return q[:, None] * contact.normals
