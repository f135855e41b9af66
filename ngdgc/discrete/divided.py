"""Contact points of a problem on a mesh, also those of a quadrature that is divided."""

from __future__ import annotations

from typing import Any

from ngsolve import FESpace

from ..contact.boundary import ContactBoundary
from ..mesh.pieces import Pieces
from ..mesh.quadrature import ContactRules
from .frozen import Twin


def ContactOf(disc: Any, scalar: FESpace) -> ContactBoundary:
    """The contact points of a DiscreteProblem with its `pieces` and `memory`; scalar : space of one component."""
    rules = ContactRules(disc.method, disc.mesh.dim, disc.order)
    return ContactBoundary(disc.problem, disc.facets, disc.space, scalar, rules, disc.pieces).After(*disc.memory)


def OnPieces(disc: Any, pieces: Pieces) -> Any:
    """The same DiscreteProblem with the contact points of a quadrature that is divided; nothing else is another."""
    other = Twin(disc)
    other.pieces, other.motion, other.solves, other.cycles, other.factorisation = pieces, None, 0, 0, 0.0
    with disc.state.Restored():
        other.contact = ContactOf(other, disc.method.ScalarSpace(disc.mesh, disc.order))
    return other
