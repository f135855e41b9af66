"""Quantities that errors are estimated of: J(u) = int_GammaC t.j + c(u) [m components]."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Hashable, Iterator, Sequence
from copy import copy
from typing import Any

import numpy as np

from ..contact.boundary import ContactBoundary, TraceMatrix
from ..contracts import Array
from ..discrete.problem import DiscreteProblem
from ..exceptions import ProblemError
from ..solution.forces import DisplacementAt
from ..tools.kinds import Short

RADIUS = 1 / 8      # of a patch, in units of the extent of its foundation
CANDIDATES = 64     # contact points of largest pressure, one of which, or a vertex beside it, is the centre of the patch


class Goal(ABC):
    """A quantity.  kind : goals of one kind have one scale;  key : what its values are listed under"""

    kind: str
    key: Hashable

    def Placed(self, contact: ContactBoundary, traction: Array) -> Goal:
        """The goal with what depends on the tractions (n, d), which are known at the points of a fine quadrature."""
        return self

    @abstractmethod
    def Weights(self, contact: ContactBoundary) -> Array:
        """j at contact points, (m, n, d)."""

    def Functionals(self, disc: DiscreteProblem) -> Array:
        """c as coefficients, (m, ndof)."""
        return np.zeros((1, disc.space.ndof))

    def Value(self, solution: Any) -> Array:
        """J of a solution, (m,)."""
        disc = solution.disc
        tractions = np.einsum("mnd,nd,n->m", self.Weights(disc.contact), solution.traction, disc.contact.weights)
        return tractions + self.Functionals(disc) @ solution.vector


class ForceGoal(Goal):
    """The force of a foundation on the body, (d,) [stress length^(d-1)], as `Resultants` has it; part : its number."""

    kind = "force"

    def __init__(self, solution: Any, part: int) -> None:
        self.part, self.key = part, solution.disc.problem.foundation[part].boundary

    def Weights(self, contact: ContactBoundary) -> Array:
        weights = np.zeros((contact.dim, *contact.normals.shape))
        weights[:, contact.parts[self.part].points] = -np.eye(contact.dim)[:, None]
        return weights


class PressureGoal(Goal):
    """The largest mean of the pressure over a patch of a foundation, (1,) [stress].

    With weights 1 - |x - c|^2/R^2 about c, R = 1/8 of the extent of the foundation: a mean over a patch that no mesh changes
    has a limit also where the pressure itself has none, as at a corner.
    """

    kind = "pressure"
    centre: Array
    radius: float

    def __init__(self, solution: Any, part: int) -> None:
        self.disc, self.part = solution.disc, part
        self.key = ("pressure", solution.disc.problem.foundation[part].boundary)

    def Placed(self, contact: ContactBoundary, traction: Array) -> Goal:
        placed, here = copy(self), contact.parts[self.part].points
        places, pressure = contact.coordinates[here], contact.Normal(traction)[here]
        placed.radius = RADIUS * np.ptp(places, axis=0).max()
        deepest = np.argsort(-pressure, kind="stable")[:CANDIDATES]
        # The largest pressure may be at an end of the foundation, where no point of a quadrature is.
        near = np.unique(contact.boundaryelements[here.start + deepest])
        vertices = np.unique(self.disc.facets.boundary[2][near])
        ends = self.disc.mesh.ngmesh.Coordinates()[vertices[vertices >= 0], :contact.dim]
        centres = np.concatenate([places[deepest], ends])
        kernels = contact.weights[here] * placed._Kernel(places, centres)
        placed.centre = centres[np.argmax(kernels @ pressure / kernels.sum(axis=1))]
        return placed

    def _Kernel(self, places: Array, centres: Array) -> Array:
        """(centres, n)."""
        return np.maximum(1 - np.sum((places - centres[:, None]) ** 2, axis=2) / self.radius ** 2, 0)

    def Weights(self, contact: ContactBoundary) -> Array:
        here, weights = contact.parts[self.part].points, np.zeros((1, *contact.normals.shape))
        kernel = self._Kernel(contact.coordinates[here], self.centre[None])[0]
        if not kernel.any():        # a coarse mesh may have no contact point in the patch
            kernel[np.sum((contact.coordinates[here] - self.centre) ** 2, axis=1).argmin()] = 1
        weights[0, here] = (kernel / (contact.weights[here] @ kernel))[:, None] * contact.normals[here]
        return weights


class DisplacementGoal(Goal):
    """The displacement at a point, (d,) [length]."""

    kind = "displacement"

    def __init__(self, solution: Any, point: Any) -> None:
        DisplacementAt(solution, point)
        self.key = ("displacement", tuple(map(float, point)))
        self.point = solution.disc.mesh(*self.key[1])

    def Weights(self, contact: ContactBoundary) -> Array:
        return np.zeros((contact.dim, *contact.normals.shape))

    def Functionals(self, disc: DiscreteProblem) -> Array:
        at = np.zeros(1, dtype=[("x", float), ("y", float), ("z", float), ("nr", int)])
        for axis, coordinate in zip("xyz", self.point.pnt):
            at[axis] = coordinate
        at["nr"] = self.point.nr
        values: Array = TraceMatrix(disc.space, disc.method.ScalarSpace(disc.mesh, disc.order), at).toarray()
        return values


def Goals(solution: Any, wanted: Sequence[Any]) -> list[Goal]:
    """The quantities that are meant by "force", ("pressure", region) and ("displacement", point)."""
    return [goal for one in wanted for goal in _Meant(solution, one)]


def _Meant(solution: Any, wanted: Any) -> Iterator[Goal]:
    boundaries = [foundation.boundary for foundation in solution.disc.problem.foundation]
    if isinstance(wanted, str) and wanted == "force":
        yield from (ForceGoal(solution, part) for part in range(len(boundaries)))
        return
    if not isinstance(wanted, tuple) or len(wanted) != 2 or wanted[0] not in ("pressure", "displacement"):
        raise ProblemError(f"goal is {Short(wanted)}; give 'force', ('pressure', region) or ('displacement', point)")
    name, where = wanted
    if name == "displacement":
        yield DisplacementGoal(solution, where)
    elif where in boundaries:
        yield PressureGoal(solution, boundaries.index(where))
    else:
        raise ProblemError(f"goal is {Short(wanted)}, and there is no foundation of this region; give one of "
                           f"{', '.join(map(repr, boundaries))}")
