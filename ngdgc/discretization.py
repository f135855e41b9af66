"""The problem on a mesh that users make and solve."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from inspect import signature
from typing import Any

from ngsolve import Mesh

from .contracts import Inverter, Method
from .discrete.problem import DiscreteProblem
from .problem.problem import ContactProblem
from .solution.history import Step
from .solution.solution import ContactSolution
from .solvers.nested import NestedNewtonSolver
from .tools.calls import ByKeyword


@ByKeyword
class Discretization(DiscreteProblem):
    """The discrete problem A u = f - T' W t, t = law(T u), of a method of order k >= 1 on a mesh.

    Parameters
    ----------
    problem : ContactProblem
    method : a row of the family, such as LDG(form="lifting") or Conforming(), or what keeps `contracts.Method`
    mesh : ngsolve.Mesh, 2D or 3D; curve it (mesh.Curve(order)) before, if its boundary is curved
    order : polynomial degree k of the displacement
    assembly : "facet", blocks on facets and elements, or "skeleton", NGSolve's symbols: the same matrix, slower and readable
    inverse : what solves the linear equations: a name (`linear.choice`), "auto" by symmetry and size, or a function or class of
        your own that makes an inverse of a matrix (`contracts.Inverter`)

    Raises ProblemError for data that do not fit the mesh, here, and for a lost coercivity or a body that only its
    foundation holds, when the matrix is first needed.

    Attributes
    ----------
    space : the NGSolve space V_h;  matrix : NGSolve's matrix A;  load : coefficients of f, (ndof,)
    form : B_h with its numerical fluxes;  contact : ContactBoundary
    solves : how often an inverse was applied;  factorisation : seconds that factorisations took

    >>> from ngdgc import LDG
    >>> from ngdgc.exact import SmoothSlip
    >>> from ngdgc.meshes import RectangleMesh
    >>> disc = Discretization(SmoothSlip().problem, LDG(), RectangleMesh(4), order=2)
    >>> disc.space.ndof, disc.Solve().converged
    (384, True)
    """

    def __new__(cls, *arguments: Any, **options: Any) -> Any:
        mesh = options.get("mesh", arguments[2] if len(arguments) > 2 else None)
        if hasattr(mesh, "Discretize"):     # which is spread over processes, a `distributed.DistributedMesh`
            return Spread(*arguments, **options)
        return super().__new__(cls)

    def __init__(self, problem: ContactProblem, method: Method, mesh: Mesh, *, order: int = 1, assembly: str = "facet",
                 inverse: str | Inverter = "auto") -> None:
        super().__init__(problem, method, mesh, order=order, assembly=assembly, inverse=inverse)

    # Which `__new__` would hide.
    __signature__ = signature(__init__).replace(parameters=list(signature(__init__).parameters.values())[1:])

    def Solve(self, *, tol: float = 1e-10, coarser: Sequence[Mesh] | None = None,
              callback: Callable[[Step], object] | None = None) -> ContactSolution:
        """The ContactSolution by the default solver, `NestedNewtonSolver(tol=tol, coarser=coarser)`, which needs no choices.

        NGSolve's function `Solve(disc, ...)` is the same, as it is for NGSolve's own equations.

        >>> from ngdgc import *
        >>> from ngdgc.meshes import RectangleMesh
        >>> stiff = Foundation("bottom", NormalCompliance(1e9), friction=CoulombFriction(0.5))
        >>> problem = ContactProblem(HookeMaterial(E=100, nu=0.3), stiff, dirichlet={"top": (0.01, -0.1)})
        >>> Solve(Discretization(problem, LDG(), RectangleMesh(8), order=1)).converged
        True
        """
        return NestedNewtonSolver(tol=tol, coarser=coarser).Solve(self, callback=callback)


def Spread(problem: Any, method: Any, mesh: Any, *, order: int = 1, assembly: str = "facet", inverse: Any = "auto") -> Any:
    """What a mesh that is spread over processes makes of the arguments of a Discretization."""
    return mesh.Discretize(problem, method, order=order, assembly=assembly, inverse=inverse)
