"""Gamma_C on all ranks: every rank has all points and the laws there, and the traces of its own elements."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from types import SimpleNamespace
from typing import Any

import numpy as np
from ngsolve import CoefficientFunction

from ..contact.boundary import ContactBoundary
from ..contact.parts import ContactPart
from ..contracts import Array
from ..discrete.state import ROLES
from ..mesh.quadrature import ContactRules
from ..problem.userlaws import UserLaw, Watched
from ..tools import sparse as sp

SCALARS = ("weights", "gap", "measures", "shear", "depth", "tension")


def OwnContact(local: Any) -> Any:
    """The ContactBoundary of a rank's own elements, or None if there is none on Gamma_C; its own foundations alone."""
    problem, facets = local.problem, local.facets
    here = tuple(foundation for foundation in problem.foundation if np.any(facets.On(foundation.boundary)))
    if not here:
        return None
    part = SimpleNamespace(foundation=here, material=problem.material)
    rules = ContactRules(local.method, facets.mesh.dim, local.order)
    return ContactBoundary(part, facets, local.space, local.method.ScalarSpace(facets.mesh, local.order), rules)     # type: ignore[arg-type]


class ReplicatedContact(ContactBoundary):
    """All contact points, the same arrays on every rank; vectors are those of the own elements, as `rows` numbers them.

    own : this rank's ContactBoundary or None;  dofs : for each entry of a vector its dof in the local space

    Attributes
    ----------
    mine : numbers of the own points among all (n,), in the order of `own`
    """

    def __init__(self, problem: Any, own: Any, dofs: np.ndarray, dim: int, comm: Any) -> None:
        self.comm = comm
        counts = np.zeros(len(problem.foundation), dtype=np.int64)
        if own is not None:
            at = [number for part in own.parts for number, one in enumerate(problem.foundation) if one is part.foundation]
            counts[at] = [part.points.stop - part.points.start for part in own.parts]
        # Foundation after foundation, of each the points of rank 0, 1, ...
        self._order = np.argsort(np.concatenate(comm.allgather(np.repeat(np.arange(len(counts)), counts))), kind="stable")
        end, count = comm.scan(int(counts.sum())), int(counts.sum())
        self.mine = np.argsort(self._order)[end - count:end]
        for name in ("coordinates", "normals", "outward"):
            setattr(self, name, self._All(np.empty((0, dim)) if own is None else getattr(own, name)))
        for name in SCALARS:
            setattr(self, name, self._All(np.empty(0) if own is None else getattr(own, name)))
        self.joined, self.given = np.zeros(len(self.weights), dtype=bool), self.gap
        self.path, self.worn = np.zeros((2, len(self.weights)))
        self.flexibility = np.ptp(self.coordinates, axis=0).max() / self.shear.min()
        ends = np.cumsum([0, *comm.allreduce(counts)])
        local = {} if own is None else {id(part.foundation): part for part in own.parts}
        self.parts = [self._Part(foundation, slice(int(a), int(b)), local.get(id(foundation)))
                      for foundation, a, b in zip(problem.foundation, ends[:-1], ends[1:])]
        self.trace = sp.csr_matrix((0, len(dofs))) if own is None else own.trace[:, dofs].tocsr()
        load = self.trace.T.tocsr()
        self._ways: tuple[Callable[[Array], Array], Callable[[Array], Array]] = self.trace.__matmul__, load.__matmul__

    def _All(self, values: Array) -> Array:
        """Arrays over the own points, of all ranks, in the order of all points."""
        return np.concatenate(self.comm.allgather(values))[self._order]

    def _Part(self, foundation: Any, points: slice, own: ContactPart | None) -> ContactPart:
        laws = {role: self._Law(getattr(foundation, role), own and getattr(own, role)) for role in ROLES}
        return ContactPart(foundation=foundation, points=points, **laws)

    def _Law(self, law: Any, own: Any) -> Any:
        """A law with the data at all points of a part, in place of those at the own ones."""
        if law is None:
            return None
        everywhere, given = copy(law), own.law if isinstance(own, UserLaw) else own
        for name, value in vars(law).items():
            if isinstance(value, CoefficientFunction):
                values = self.comm.allgather(np.empty(0) if given is None else getattr(given, name))
                object.__setattr__(everywhere, name, np.concatenate(values))
        return Watched(everywhere)

    def Through(self, To: Callable[[Array], Array], Back: Callable[[Array], Array]) -> ReplicatedContact:
        """The same points for functions of a subspace: To is the trace at the own points, Back its adjoint."""
        other = copy(self)
        other._ways = To, Back
        return other

    def Displacement(self, vector: Array) -> Array:
        return self._All(self._ways[0](vector).reshape(-1, self.dim))

    def Load(self, traction: Array) -> Array:
        return self._ways[1]((self.weights[:, None] * traction)[self.mine].ravel())

    def Stiffness(self, stiffness: Array) -> sp.csr_matrix:
        """T' W D T of the own elements; in a subspace too."""
        n, weighted = len(self.mine), (self.weights[:, None, None] * stiffness)[self.mine]
        if not n:
            return sp.csr_matrix((self.trace.shape[1],) * 2)
        blocks = sp.bsr_matrix((weighted, np.arange(n), np.arange(n + 1)), shape=(n * self.dim,) * 2).tocsr()
        return (self.trace.T @ blocks @ self.trace).tocsr()


class NoContact:
    """What stands for the ContactBoundary of a rank without an element on Gamma_C, for functions of a space."""

    def __init__(self, space: Any) -> None:
        self._size, dim = space.ndof, space.mesh.dim
        self.coordinates, self.weights, self.parts = np.empty((0, dim)), np.empty(0), list[ContactPart]()
        self.boundaryelements, self.trace = np.empty(0, dtype=np.int64), sp.csr_matrix((0, space.ndof))

    def Load(self, traction: Array) -> Array:
        return np.zeros(self._size)
