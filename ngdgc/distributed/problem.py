"""The discrete problem on all ranks: what Newton's method and its corrections see of it."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np

from ..contracts import Array
from ..discrete.loads import AreaOf
from ..discrete.problem import DiscreteProblem
from ..exceptions import ProblemError
from ..linear.equations import LinearEquations
from ..linear.solenoidal import Swelling
from ..solvers.newton.solver import SemismoothNewtonSolver
from ..tools import sparse as sp
from ..tools.calls import ByKeyword
from .contact import ReplicatedContact
from .cycle import CycleInverse, NearNullSpace
from .local import CUT, FOREIGN, LocalMesh
from .part import LocalProblem
from .petsc import OnFirst, Rows, Summed
from .rows import RowNumbering
from .solution import DistributedSolution
from .subspace import DistributedSubspace

STIFFEST = 49.5     # largest lam/mu, that of nu = .49: for more the continuous functions of the cycle lock


@ByKeyword
class DistributedProblem(LinearEquations):
    """What Discretization makes on a DistributedMesh; vectors are those of the own elements, contact points are those of all.

    Arguments as for Discretization.  Raises ProblemError, on all ranks alike, for what this storey does not cover.

    Attributes
    ----------
    local : the `part.LocalProblem` of this rank;  numbering : of its vectors;  contact : Gamma_C, the same on every rank
    matrix : A, PETSc's;  load : f of the own elements
    """

    iterates, inversekind, reduce = True, "PETSc: cg, pcmg, gamg", DistributedSubspace
    unresisted, resultant, prescribed, shift = None, None, 0.0, 0.0

    def __init__(self, problem: Any, method: Any, mesh: Any, *, order: int = 1, assembly: str = "facet",
                 inverse: Any = "auto") -> None:
        super().__init__()
        self.problem, self.method, self.mesh, self.order = problem, method, mesh, order
        areas = OnFirst(mesh.comm, lambda: CheckCovered(problem, method, mesh, order, assembly, inverse))
        self.contactregions = "|".join(foundation.boundary for foundation in problem.foundation)
        regions = np.flatnonzero(list(mesh.coarse.Boundaries(self.contactregions).Mask())).tolist()
        layers = 2 if getattr(method, "globallift", True) else 1
        local = LocalMesh(mesh.Spread(layers), mesh.coarse.GetMaterials(), mesh.coarse.GetBoundaries(), regions)
        self.numbering = RowNumbering(local, order)
        self.local = LocalProblem(problem, method, local, order, areas)
        self.contact = ReplicatedContact(problem, self.local.own, self.numbering.dofs, mesh.dim, mesh.comm)
        self.state, self.space = self.local.state, self.local.space

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
        matrix = form.Matrix()
        return self.numbering.Matrix(matrix if self.local.addedmatrix is None else self.local.Whole(matrix))

    @cached_property
    def load(self) -> Array:
        return self.local.load[self.numbering.dofs]

    @cached_property
    def _levels(self) -> tuple[Any, Any]:
        """(E, rigid motions) of the cycle."""
        local, dim = self.numbering.local, self.mesh.dim
        vertices = dim * int(local.ownvertices.sum())
        return Rows(self.numbering.Embedding(), self.numbering.size, vertices, self.mesh.comm), NearNullSpace(local)

    def Sum(self, added: sp.csr_matrix | None) -> Any:
        """A + added, PETSc's; added scipy, as `ReplicatedContact.Stiffness` has it."""
        if added is None:
            return self.matrix
        total, PETSc = self.matrix.copy(), type(self.matrix)
        total.axpy(1.0, self.numbering.Added(added, self.matrix.getOwnershipRange()[0]), PETSc.Structure.SUBSET)
        return total

    def FactoriseSum(self, added: sp.csr_matrix) -> Any:
        return self.Factorise(self.Sum(added))

    def MakeInverse(self, matrix: Any) -> CycleInverse:
        return CycleInverse(matrix, *self._levels)

    def Multiply(self, vector: Array) -> Array:
        source, target = self.matrix.createVecs()
        source.setArray(vector)
        self.matrix.mult(source, target)
        return target.getArray().copy()

    def Norm(self, vector: Array) -> float:
        return float(np.sqrt(Summed(self.mesh.comm, np.array(vector @ vector))))

    @property
    def diagonal(self) -> Array:
        return self.matrix.getDiagonal().getArray().copy()

    @property
    def free(self) -> Any:
        return slice(None)

    def Current(self) -> DistributedProblem:
        """The same with the values that Parameters have now."""
        self.state.CheckFixed()
        if not self.state.Parameters():
            return self
        return DistributedProblem(self.problem, self.method, self.mesh, order=self.order)

    def Add(self, form: Any) -> Any:
        """Forms of the user's own are assembled by NGSolve, which drops what couples elements of several ranks."""
        raise ProblemError(f"{form!r} cannot be added on a DistributedMesh, where NGSolve would drop what couples elements of "
                           "several ranks; take an ngsolve.Mesh")

    def Solve(self, *, tol: float = 1e-10, coarser: Any = None, callback: Callable[[Any], object] | None = None) -> Any:
        """The `solution.DistributedSolution`, on every rank; callback is called on rank 0 alone."""
        if coarser is not None:
            raise ProblemError(f"coarser is {coarser!r}; on a DistributedMesh no coarser mesh predicts, leave it out")
        solver = SemismoothNewtonSolver(tol=tol)
        found = solver.Solve(self, callback=callback if self.mesh.comm.rank == 0 else None)     # type: ignore[arg-type]
        return DistributedSolution(found.disc, found.vector, found.traction, history=found.history, solver=repr(solver))


def CheckCovered(problem: Any, method: Any, mesh: Any, order: int, assembly: str, inverse: Any) -> dict[str, float]:
    """Areas of the regions with forces; ProblemError for mistakes in the problem, seen on the coarse mesh, and for the rest."""
    coarse = DiscreteProblem(problem, method, mesh.coarse, order=order, assembly=assembly)
    remedy = "take an ngsolve.Mesh on one machine"
    iterative = method.discontinuous and method.conservative and method.symmetric and method.iterative
    wrong = {f"method {method.name}, which PETSc's cycle is not made for; take a symmetric one of Table 2": not iterative,
             "assembly='skeleton'; take 'facet'": assembly != "facet",
             "another inverse than 'auto'; leave it out": inverse != "auto",
             f"joints; {remedy}": bool(problem.joints), f"rigid punches; {remedy}": coarse.contact.punches is not None,
             f"bodies of revolution; {remedy}": problem.axisymmetric,
             f"friction bonds with a tension; {remedy}": any(part.bond for part in coarse.contact.parts)}
    for words, asked in wrong.items():
        if asked:
            raise ProblemError(f"a DistributedMesh is not for {words}")
    coarse.restraints.Check()
    if coarse.unresisted:
        raise ProblemError(f"a DistributedMesh is not for a body that only its foundation holds: only contact resists "
                           f"{coarse.unresisted}; add dirichlet, roller or spring")
    if Swelling(problem.material, mesh.coarse) > 1 + mesh.dim * STIFFEST / 2:
        raise ProblemError("the material is nearer to incompressible than nu = .49, for which the levels of PETSc's cycle are "
                           f"not made; {remedy}, which has others")
    for kind, region in problem.Regions():
        if any(re.fullmatch(region, name) for name in (CUT, FOREIGN)):
            raise ProblemError(f"{kind} region {region!r} also matches {CUT!r}, which the sides between ranks are called; name "
                               "the boundaries")
    return {region: AreaOf(problem, region, coarse.space) for region in problem.force}
