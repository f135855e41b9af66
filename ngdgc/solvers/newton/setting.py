"""What stays the same all through a run: the graph of the law, its scale, and what holds the body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...contact.boundary import ContactBoundary
from ...contact.graph import STICK, ContactGraph, GraphPoint
from ...contact.stiffness import CAP, BodyStiffness, LawStiffness
from ...contracts import Array, LinearProblem
from .holding import Holding
from .pathfollowing import FEW

FLOOR = 1e-4        # smallest D where nothing but the foundation holds the body, in units of what holds it (`Holding`)
LOOSE = 1e-2        # the same where no point sticks, so that no other D resists a motion along the foundation
STICKING = 0.003    # least stiffness of stick there, in units of gamma: much more hides what a soft foundation does
TIMES = 10          # stiffness of stick there, in units of that of the foundation, between STICKING and CAP


@dataclass(frozen=True, kw_only=True, eq=False)
class Setting:
    """A Discretization, or a `subspace.Subspace`, with the graph of its law.

    scale : gamma (n,) of the graph, what the body opposes to a traction [stress/length]
    holding : how the foundation holds a body that nothing else holds, else None
    """

    disc: LinearProblem
    scale: Array
    graph: ContactGraph
    holding: Holding | None

    @classmethod
    def Of(cls, disc: LinearProblem) -> Setting:
        scale = BodyStiffness(disc)
        return cls(disc=disc, scale=scale, graph=ContactGraph(disc.contact, scale),
                   holding=Holding(disc, scale) if disc.unresisted else None)

    @property
    def contact(self) -> ContactBoundary:
        return self.disc.contact

    @property
    def held(self) -> bool:
        """True if more than the foundation holds the body."""
        return self.holding is None

    @property
    def few(self) -> bool:
        """True for a body that is held and has so few contact points that a `pathfollowing.Path` can be followed."""
        return self.held and self.contact.normals.size <= FEW

    def Rest(self) -> Array:
        """q (n, d) of rest, or of a start in contact where only that holds the body."""
        return np.zeros_like(self.contact.normals) if self.holding is None else self.holding.Rest()

    def Stiffness(self, point: GraphPoint) -> Array:
        """D (n, d, d) of the law at a point of the graph; it holds the body where nothing else does."""
        if self.holding is None:
            return LawStiffness(point, self.scale, self.contact.normals)
        sticking = np.clip(TIMES * self.holding.stiffness / self.scale, STICKING, CAP)
        floor = FLOOR if np.any(point.zones == STICK) else LOOSE
        return (LawStiffness(point, self.scale, self.contact.normals, sticking=sticking[:, None])
                + floor * self.scale[:, None, None] * self.holding.slope)
