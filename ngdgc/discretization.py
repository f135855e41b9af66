"""A problem on a mesh: space, matrix A, load f, inverse, and Gamma_C."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import GridFunction, Mesh, ds, dx

from .added import AddedForms
from .calls import ByKeyword
from .coefficients import LOADBONUS, OnFacets, Unfolded
from .contact import ContactBoundary
from .equations import LinearEquations
from .exceptions import ProblemError
from .facets import Csr, Facets, Native, Threads
from .inside import OnBoundary
from .inverses import Inverse, Kind
from .memory import CheckAssembly
from .motions import FreeMotions, ProjectedMotions
from .problem import ContactProblem
from .protocols import Array, Method
from .quadrature import ContactRules
from .restraints import Restraints
from .skeleton import Coefficients
from .stability import CheckCoercivity, CheckSum
from .state import AsRead, State
from .validation import CheckData, CheckMesh, CheckRegions
from .values import Among, Order

if TYPE_CHECKING:
    from .history import Step
    from .solution import ContactSolution

# What is computed when it is first asked for: from all data, and from material and added forms alone.
OFDATA = "restraints", "loads", "resultant", "prescribed"
OFMATRIX = "restraints", "form", "facetform", "matrix", "inverse", "inversekind"


@ByKeyword
class Discretization(LinearEquations):
    """The discrete problem A u = f - T' W t, t = law(T u), of a method of order k >= 1 on a mesh.

    Parameters
    ----------
    problem : ContactProblem
    method : a row of the `methods` module, such as LDG(form="lifting") or Conforming()
    mesh : ngsolve.Mesh, 2D or 3D; curve it (mesh.Curve(order)) before, if its boundary is curved
    order : polynomial degree k of the displacement
    assembly : "facet", blocks on facets and elements, or "skeleton", NGSolve's symbols: the same matrix, slower and readable
    inverse : what solves the linear equations (`inverses` module), "auto" by symmetry and size

    Raises ProblemError for data that do not fit the mesh, here, and for a lost coercivity or a body that only its
    foundation holds, when the matrix is first needed.

    Attributes
    ----------
    space : the NGSolve space V_h;  matrix : NGSolve's matrix A;  load : coefficients of f, (ndof,)
    form : B_h with its numerical fluxes;  contact : ContactBoundary
    solves : how often an inverse was applied;  factorisation : seconds that factorisations took
    """

    def __init__(self, problem: ContactProblem, method: Method, mesh: Mesh, *, order: int = 1, assembly: str = "facet",
                 inverse: str = "auto") -> None:
        super().__init__()
        if not isinstance(problem, ContactProblem):
            raise ProblemError(f"problem is {problem!r}; give a ContactProblem")
        if isinstance(method, type) or not hasattr(method, "Form"):
            raise ProblemError(f"method is {method!r}; give an object such as InteriorPenalty() or Conforming()")
        if not Among(assembly, ("facet", "skeleton")):
            raise ProblemError(f"assembly is {assembly!r}; choose 'facet' or 'skeleton'")
        CheckMesh(problem, mesh)
        order = Order(order, mesh.dim)
        CheckAssembly(mesh.ne, mesh.dim, order, discontinuous=method.discontinuous)
        self.method: Any = method
        self.problem, self.mesh, self.order, self.assembly = problem, mesh, order, assembly
        self.wanted = inverse
        self.facets = Facets(mesh)
        CheckRegions(problem, mesh, self.facets)
        self.space = method.Space(mesh, self.order, "|".join(problem.dirichlet))
        self.added = AddedForms(self.space, self.facets)
        self._Read()

    def _Read(self):
        """Evaluate the data as they are now."""
        self.state = State(self.problem, self.mesh)
        CheckData(self.problem, self.mesh, self.facets)
        scalar, rules = self.method.ScalarSpace(self.mesh, self.order), ContactRules(self.method, self.mesh.dim, self.order)
        self.contact = ContactBoundary(self.problem, self.facets, self.space, scalar, rules)

    def Current(self) -> Discretization:
        """The Discretization with the values that Parameters have now: this one if they are what they were, else a copy.

        Matrix and inverse go with the copy if no Parameter in the material or in an added form has changed.
        """
        self.state.CheckFixed()
        changed, added = self.state.Parameters(), self.added.Current()
        if not changed and added is self.added:
            return self
        current = object.__new__(type(self))
        current.__dict__.update(self.__dict__)
        same = added is self.added and not any(name.startswith("material") for name in changed)
        for name in OFDATA if same else OFDATA + OFMATRIX:
            current.__dict__.pop(name, None)
        current.added = added
        current._Read()
        return current

    def __repr__(self):
        return (f"Discretization({self.method.name}, order {self.order}, {self.mesh.ne} elements, "
                f"{self.space.ndof} dofs, {len(self.contact.weights)} contact points)")

    def __reduce_ex__(self, protocol: Any) -> Any:
        raise ProblemError("a Discretization has a mesh and a factorised matrix, which are not copied or pickled; make another "
                           "one, Discretization(problem, method, mesh, order=1): problems, methods and solvers can be pickled")

    @cached_property
    @AsRead
    def form(self) -> Any:
        """B_h of the method, before assembly."""
        return self.method.Form(self.problem, self.facets, self.space, self.order, self.assembly)

    @cached_property
    @AsRead
    def facetform(self) -> Any:
        """B_h of a discontinuous method from facet operators, whichever route assembles."""
        return self.form if self.assembly == "facet" else self.method.Form(self.problem, self.facets, self.space, self.order,
                                                                           "facet")

    def Add(self, form: Any) -> Discretization:
        """Add a BilinearForm or a LinearForm on `space` to B_h or to f, before anything is solved; returns the Discretization.

        What can be added are sums of integrals with dx, dx(skeleton=True), and on boundaries ds(skeleton=True, definedon=...).
        The sum must stay coercive, which an eigenvalue computation checks.  Springs hold the body where nothing else does.
        Forces of added forms appear as "added" in the balance.  Raises ProblemError for another kind of object, integral or
        space, or if the matrix is there already.

        >>> from ngsolve import BilinearForm, CF, dx
        >>> from ngdgc import *
        >>> from ngdgc.meshes import RectangleMesh
        >>> problem = ContactProblem(HookeMaterial(E=100, nu=0.3), Foundation("bottom", NormalCompliance(1)),
        ...                          dirichlet={"top": CF((0, 0))})
        >>> disc = Discretization(problem, LDG(), RectangleMesh(4))
        >>> u, v = disc.space.TnT()
        >>> disc.Add(BilinearForm(3 * u * v * dx)).matrix.height
        192
        """
        if {"matrix", "loads", "inverse"} & set(self.__dict__):
            raise ProblemError("the matrix or the load is there already; add forms right after the Discretization is made")
        self.state.CheckFixed()
        self.added.Add(form)
        for name in OFMATRIX:
            self.__dict__.pop(name, None)
        return self

    @cached_property
    @AsRead
    def matrix(self) -> Any:
        """NGSolve's matrix A of B_h, checked for coercivity."""
        self.restraints.Check()
        with Threads(self.mesh):
            matrix = self.form.Matrix()
            if self.added.matrix is not None:
                matrix = Native(Csr(matrix) + self.added.matrix)
            if not np.all(np.isfinite(matrix.AsVector().FV().NumPy())):
                raise ProblemError("the material is not finite at some quadrature point of the elements or facets; look for a "
                                   "division by zero or a root of a negative number")
            if self.added.matrix is not None:
                CheckSum(self.form, matrix, self.space.FreeDofs(), self.restraints.soft)
            else:
                CheckCoercivity(self.method, self.form, matrix, self.space.FreeDofs(), self.restraints.soft)
        return matrix

    @cached_property
    def restraints(self) -> Restraints:
        """What holds the body."""
        return Restraints(self.problem, self.facets, self.contact, self.space, self.added.matrix)

    @property
    def loose(self) -> str | None:
        """Words for the rigid motions that neither dirichlet nor roller resist, or None."""
        return self.restraints.loose

    @property
    def unresisted(self) -> str | None:
        """Words for the rigid motions that added forms do not resist either, so that only contact does, or None."""
        return self.restraints.unresisted

    @property
    def symmetric(self) -> bool:
        """True if A is symmetric, up to the round-off of assembly."""
        if self.added.matrix is None or not self.method.symmetric:
            return self.method.symmetric
        return abs(self.added.matrix - self.added.matrix.T).max() <= 1e-12 * abs(self.added.matrix).max()

    @cached_property
    @AsRead
    def loads(self) -> dict[tuple[str, str | None], Array]:
        """Coefficients of the loads, {(kind, region): (ndof,)}: body force, tractions, weakly prescribed displacements."""
        v, problem = self.space.TestFunction(), self.problem
        loads: dict[tuple[str, str | None], Array] = {}
        if problem.bodyforce is not None:
            loads["bodyforce", None] = Coefficients(Unfolded(problem.bodyforce) * v * dx(bonus_intorder=LOADBONUS))
        for region in problem.traction:
            measure = ds(skeleton=True, definedon=self.mesh.Boundaries(region), bonus_intorder=LOADBONUS)
            loads["traction", region] = Coefficients(OnFacets(problem, "traction", region, self.mesh) * v * measure)
        if self.added.load is not None:
            loads["added", None] = self.added.load
        loads |= {("prescribed", region): load for region, load in self.form.Prescribed().items()}
        for (kind, region), load in loads.items():
            if not np.all(np.isfinite(load)):
                name = f"{kind}[{region!r}]" if region else kind
                raise ProblemError(f"{name} is not finite at some quadrature point; look for a division by zero or a root of a "
                                   "negative number")
        return loads

    @property
    def load(self) -> Array:
        return sum(self.loads.values(), np.zeros(self.space.ndof))

    @cached_property
    def resultant(self) -> Array:
        """The sum of all loads, (d,) [stress length^(d-1)]."""
        return ProjectedMotions(self.space, np.zeros(self.mesh.dim))[:self.mesh.dim] @ self.load

    shift = 0.0     # displacement of Gamma_C that is not in the space, as `subspace.Subspace` has one

    @cached_property
    def motions(self) -> Array:
        """Coefficients (m, ndof) of the rigid motions that A does not resist (`motions.FreeMotions`)."""
        return FreeMotions(self)

    @cached_property
    @AsRead
    def prescribed(self) -> Array:
        """Coefficients (ndof,) of a function with the strongly prescribed boundary values, zero for DG."""
        function = GridFunction(self.space)
        if not self.method.discontinuous and self.problem.dirichlet:
            values = {region: OnBoundary(value, self.mesh.Boundaries(region), f"dirichlet[{region!r}]")
                      for region, value in self.problem.dirichlet.items()}
            function.Set(self.mesh.BoundaryCF(values, default=(0,) * self.mesh.dim),
                         definedon=self.mesh.Boundaries("|".join(self.problem.dirichlet)))
        return function.vec.FV().NumPy().copy()

    @cached_property
    def inverse(self) -> Any:
        """A^-1 on the free dofs; ProblemError for a body that only its foundation holds, whose A is singular."""
        self.restraints.Check()
        if self.unresisted:
            raise ProblemError(f"the body is held by its foundation alone: only contact resists {self.unresisted}.  The "
                               "elastic matrix is singular and this iteration has no first step; take Solve(disc) or "
                               "SemismoothNewtonSolver(), which put contact stiffness into it, or add dirichlet or roller")
        return self.Factorise(self.matrix)

    @cached_property
    def inversekind(self) -> str:
        """What solves the linear equations (`inverses` module)."""
        return Kind(self, self.wanted)

    def Inverse(self, matrix: Any) -> Any:
        return Inverse(self, matrix, self.inversekind)

    defaultsolver: Any = None       # set by the solvers, which are built on this class

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
        return self.defaultsolver(tol=tol, coarser=coarser).Solve(self, callback=callback)

    def SolveLinear(self, load: Array) -> Array:
        """A^-1 load on the free dofs, (ndof,) -> (ndof,)."""
        return self.ApplyInverse(self.inverse, load)

    def FreeSolution(self) -> Array:
        """u with B_h(u, v) = (f, v): the response to the loads without foundation, (ndof,)."""
        lift = self.prescribed
        load = self.load - self.Multiply(lift) if np.any(lift) else self.load
        free = lift + self.SolveLinear(load)
        if not np.all(np.isfinite(free)):
            raise ProblemError("the elastic matrix cannot be factorised: the response to the loads is not finite; look for "
                               "coefficients of extreme size and for degenerate elements")
        return free

    def Response(self, traction: Array) -> Array:
        """S t = A^-1 T' W t, the displacement caused by a traction t (n, d) on Gamma_C, as coefficients (ndof,)."""
        return self.SolveLinear(self.contact.Load(traction))
