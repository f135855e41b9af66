"""The part of a problem that one rank assembles: on its own elements and their neighbours."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..contact.memory import Memory
from ..contracts import Array
from ..discrete.added import AddedForms
from ..discrete.frozen import Frozen
from ..discrete.loads import GivenTractions
from ..discrete.problem import DiscreteProblem
from ..discrete.state import State
from ..linear.equations import LinearEquations
from ..linear.motions import ProjectedMotions
from ..tools.calls import ByKeyword
from .contact import NoContact, OwnContact
from .local import LocalFacets, LocalMesh
from .petsc import OnAll


@ByKeyword
class LocalProblem(DiscreteProblem):
    """A DiscreteProblem on a `LocalMesh`: right are the rows of the own elements, and the contact points are theirs.

    areas : {region: area} of those of the whole body with forces

    Attributes
    ----------
    own : ContactBoundary of the own elements, or None where none is on Gamma_C
    """

    contact: Any

    def __init__(self, problem: Any, method: Any, part: LocalMesh, order: int, areas: dict[str, float]) -> None:
        LinearEquations.__init__(self)
        self.problem, self.method, self.order, self.assembly, self.wanted = problem, method, order, "facet", "auto"
        self.part, self.areas, self.given = part, areas, part.mesh
        self.mesh, self.facets = part.mesh, LocalFacets(part, problem.frame)
        self.space = method.Space(self.mesh, order, "")
        self.derived, self.elastic, self.memory, self.pieces = {}, {}, Memory(), {}
        self.added = AddedForms(self.space, self.facets)
        self._Read(State(self.problem, self.mesh))

    def _Read(self, state: State) -> None:
        self.state = state
        self.own = OnAll(self.part.comm, lambda: OwnContact(self))
        self.contact = self.own or NoContact(self.space)

    def PrescribedEnergy(self) -> float:
        """The share of the own elements."""
        own = np.flatnonzero(self.part.own)
        with self.state.Restored():
            return float(self.form.PrescribedEnergy(np.diff(self.facets.incidence[:, own].tocsr().indptr) > 0))

    @Frozen
    def tractions(self) -> dict[tuple[str, str], Any]:
        return GivenTractions(self.problem, self.space, self.areas)

    @Frozen
    def rigidbasis(self) -> Array:
        """Coefficients (modes, ndof) of the rigid motions on the own elements: what is tested with them is their share."""
        own = np.tile(np.repeat(self.part.own, self.space.ndof // (self.mesh.dim * self.mesh.ne)), self.mesh.dim)
        return ProjectedMotions(self.space, np.zeros(self.mesh.dim)) * own
