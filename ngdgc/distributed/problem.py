"""The discrete problem on all ranks: what Newton's method and its corrections see of it."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np

from ..contact.memory import Memory
from ..contracts import Array
from ..discrete.frozen import Twin
from ..discrete.placed import Placed
from ..exceptions import ProblemError
from ..linear.equations import LinearEquations
from ..solvers.newton.solver import SemismoothNewtonSolver
from ..tools import sparse as sp
from ..tools.calls import ByKeyword
from .contact import ReplicatedContact
from .covered import CheckCovered, CheckRoom
from .cycle import CycleInverse, NearNullSpace
from .local import LocalMesh
from .part import LocalProblem
from .petsc import Applied, GiveBack, OnAll, OnFirst, Plus, Rows, Summed, TripleProduct
from .rows import RowNumbering
from .solution import DistributedSolution
from .subspace import DistributedSubspace, NearContact


class SpreadForm:
    """What histories ask of a form, of all ranks together."""

    def __init__(self, local: LocalProblem, comm: Any) -> None:
        self.local, self.comm = local, comm

    def PrescribedEnergy(self) -> float:
        return float(Summed(self.comm, np.array(self.local.PrescribedEnergy())))


@ByKeyword
class DistributedProblem(LinearEquations, Placed):
    """What Discretization makes on a DistributedMesh; vectors are those of the own elements, contact points are those of all.

    Arguments as for Discretization.  Raises ProblemError, on all ranks alike, for what this storey does not cover.

    Attributes
    ----------
    local : the `part.LocalProblem` of this rank;  numbering : of its vectors;  contact : Gamma_C, the same on every rank
    matrix : A, PETSc's;  load : f of the own elements
    """

    iterates, inversekind = True, "PETSc: cg, pcmg, gamg"
    reduce, result, alone, symmetric, added = DistributedSubspace, DistributedSolution, True, True, ()
    assembly, wanted = "facet", "auto"
    unresisted, resultant, prescribed, shift = None, None, 0.0, 0.0

    def __init__(self, problem: Any, method: Any, mesh: Any, *, order: int = 1, assembly: str = "facet",
                 inverse: Any = "auto") -> None:
        super().__init__()
        self.problem, self.method, self.mesh, self.order = problem, method, mesh, order
        areas = OnFirst(mesh.comm, lambda: CheckCovered(problem, method, mesh, order, assembly, inverse))
        OnAll(mesh.comm, lambda: CheckRoom(mesh, order))
        self.contactregions = "|".join(foundation.boundary for foundation in problem.foundation)
        regions = np.flatnonzero(list(mesh.coarse.Boundaries(self.contactregions).Mask())).tolist()
        layers = 2 if getattr(method, "globallift", True) else 1
        local = LocalMesh(mesh.Spread(layers), mesh.coarse.GetMaterials(), mesh.coarse.GetBoundaries(), regions)
        self.numbering = RowNumbering(local, order)
        self._Read(LocalProblem(problem, method, local, order, areas), Memory())

    def _Read(self, local: LocalProblem, memory: Memory) -> None:
        """Take over the data as they are on this rank, and those of Gamma_C from all ranks."""
        self.local, self.elastic, self.state, self.space = local, local.elastic, local.state, local.space
        self.contact: Any = ReplicatedContact(self.problem, local.own, self.numbering.dofs, self.mesh.dim, self.mesh.comm)
        self._Remember(memory)

    def _Remember(self, memory: Memory) -> None:
        """Count slip from what all contact points remember, and the own ones on their rank."""
        self.memory, self.contact = memory, self.contact.After(*memory)
        if self.local.own is not None:
            self.local = Twin(self.local)
            mine = self.contact.mine
            self.local.contact = self.local.own.After(*(None if array is None else array[mine] for array in memory))

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):    # which copies and caches look for
            return object.__getattribute__(self, name)
        raise ProblemError(f"{name} is not known of a problem on a DistributedMesh; take an ngsolve.Mesh for what needs it")

    def __repr__(self) -> str:
        return (f"Discretization({self.method.name}, order {self.order}, {self.mesh!r}, {self.unknowns} dofs, "
                f"{len(self.contact.weights)} contact points)")

    @property
    def unknowns(self) -> int:
        return self.mesh.ne * self.numbering.block

    @cached_property
    def matrix(self) -> Any:
        form = self.local.form
        if not form.guarantee.holds:
            raise ProblemError(f"{form.guarantee.culprit} is not certain to be coercive, and on a DistributedMesh no "
                               "eigenvalue is computed; take penalty='auto'")
        blocks = self.numbering.Matrix(OnAll(self.mesh.comm, form.Matrix))
        GiveBack()
        springs, own = self.local.addedmatrix, self.numbering.dofs
        return blocks if springs is None else Plus(blocks, self.numbering.Added(springs[own][:, own].tocsr()))

    @cached_property
    def loads(self) -> dict[tuple[str, str | None], Array]:
        loads = OnAll(self.mesh.comm, lambda: self.local.loads)
        return {name: load[self.numbering.dofs] for name, load in loads.items()}

    @cached_property
    def load(self) -> Array:
        return sum(self.loads.values(), np.zeros(self.numbering.size))

    @property
    def facetform(self) -> SpreadForm:
        return SpreadForm(self.local, self.mesh.comm)

    @cached_property
    def reduced(self) -> tuple[Any, Any, Any]:
        """(P, Q, P' A P) of X_h, see `subspace.NearContact`."""
        prolongation, embedding = NearContact(self)
        return prolongation, embedding, TripleProduct(self.matrix, prolongation)

    @cached_property
    def _levels(self) -> tuple[Any, Any]:
        """(E, E' A E) of the cycle; E = P Q, and A is large."""
        numbering, dim = self.numbering, self.mesh.dim
        vertices, blocks = dim * int(numbering.local.ownvertices.sum()), (numbering.block, dim)
        embedding = Rows(numbering.Embedding(), numbering.size, vertices, self.mesh.comm, blocks)
        return embedding, TripleProduct(self.reduced[2], self.reduced[1])

    def Continuous(self, added: Any = None) -> Any:
        """E' (A + added) E with the rigid motions, for the cycles; added PETSc's, or None."""
        embedding, coarse = self._levels
        if added is not None:
            coarse = Plus(coarse, TripleProduct(added, embedding))
        coarse.setNearNullSpace(NearNullSpace(self.numbering.local))
        return coarse

    def FactoriseSum(self, added: sp.csr_matrix) -> Any:
        """The inverse of A + added, as `ReplicatedContact.Stiffness` has it."""
        return self.Factorise(self.numbering.Added(added))

    @cached_property
    def inverse(self) -> Any:
        return self.Factorise(None)

    def MakeInverse(self, matrix: Any) -> CycleInverse:
        """That of A and PETSc's matrix, or None, that is added to it."""
        coarse = self.Continuous(matrix)
        return CycleInverse(self.matrix if matrix is None else Plus(self.matrix, matrix), coarse, self._levels[0])

    @cached_property
    def _products(self) -> Applied:
        """Made once: vectors that are made are kept until ranks let go of them together."""
        return Applied(self.matrix)

    def Multiply(self, vector: Array) -> Array:
        return self._products(vector)

    def Norm(self, vector: Array) -> float:
        return float(np.sqrt(Summed(self.mesh.comm, np.array(vector @ vector))))

    def Product(self, one: Array, other: Array) -> float:
        return float(Summed(self.mesh.comm, np.array(one @ other)))

    @property
    def diagonal(self) -> Array:
        return self.matrix.getDiagonal().getArray().copy()

    @property
    def free(self) -> Any:
        return slice(None)

    def Current(self) -> DistributedProblem:
        """The same with the values that Parameters have now."""
        self.state.CheckFixed()
        changed = self.state.Parameters()
        if not changed:
            return self
        if any(name.startswith(("material", "spring")) for name in changed):
            return DistributedProblem(self.problem, self.method, self.mesh, order=self.order)
        current = Twin(self)
        for name in ("load", "loads"):
            current.__dict__.pop(name, None)
        current._Read(self.local.Current(), self.memory)
        return current

    def After(self, origin: Array | None, slid: Array | None = None, worn: Array | None = None) -> Any:
        other = Twin(self)
        other._Remember(Memory(origin, slid, worn))
        return other

    def Add(self, form: Any) -> Any:
        """Forms of the user's own are assembled by NGSolve, which drops what couples elements of several ranks."""
        raise ProblemError(f"{form!r} cannot be added on a DistributedMesh, where NGSolve would drop what couples elements of "
                           "several ranks; take an ngsolve.Mesh")

    def Solve(self, *, tol: float = 1e-10, coarser: Any = None, callback: Callable[[Any], object] | None = None) -> Any:
        """The `solution.DistributedSolution`, on every rank; callback is called on rank 0 alone."""
        if coarser is not None:
            raise ProblemError(f"coarser is {coarser!r}; on a DistributedMesh no coarser mesh predicts, leave it out")
        first: Any = callback if self.mesh.comm.rank == 0 else None
        return SemismoothNewtonSolver(tol=tol).Solve(self, callback=first)      # type: ignore[arg-type]
