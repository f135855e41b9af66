"""A problem on a mesh: space, matrix A, load f, inverse, and Gamma_C."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.sparse as sp
from ngsolve import CF, BilinearForm, GridFunction, LinearForm, Mesh, Norm, ds, dx

from .calls import ByKeyword
from .coefficients import LOADBONUS, OnFacets, Unfolded
from .contact import ContactBoundary
from .equations import LinearEquations
from .exceptions import ProblemError
from .facets import Csr, Facets, Native, Projected, Threads
from .inside import OnBoundary
from .inverses import Inverse, Kind
from .memory import CheckAssembly
from .problem import ContactProblem
from .protocols import Array, Method
from .quadrature import ContactRules
from .skeleton import Coefficients
from .stability import CheckCoercivity, CheckSum
from .validation import CheckMesh, CheckProblem, FreeMotion, Springs, Supports

if TYPE_CHECKING:
    from .solution import ContactSolution, Step

SOFT = 1e-3     # stiffness of Gamma_C, relative to that of the body, that holds it while its coercivity is looked at


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
        if isinstance(order, bool) or not isinstance(order, (int, np.integer)) or order < 1:
            raise ProblemError(f"order is {order!r}; it must be an integer of at least 1, piecewise constants carry no strain")
        if assembly not in ("facet", "skeleton"):
            raise ProblemError(f"assembly is {assembly!r}; choose 'facet' or 'skeleton'")
        CheckMesh(problem, mesh)
        CheckAssembly(mesh.ne, mesh.dim, int(order), discontinuous=method.discontinuous)
        self.method: Any = method
        self.problem, self.mesh, self.order, self.assembly = problem, mesh, int(order), assembly
        self.facets = Facets(mesh)
        CheckProblem(problem, mesh, self.facets)
        self.space = method.Space(mesh, self.order, "|".join(problem.dirichlet))
        scalar = method.ScalarSpace(mesh, self.order)
        self.contact = ContactBoundary(problem, self.facets, self.space, scalar, ContactRules(method, mesh.dim, self.order))
        self._supports = Supports(problem, self.facets, self.contact)
        self.wanted, self._curved = inverse, mesh.GetCurveOrder()
        self.addedmatrices, self.addedloads = list[Any](), list[Any]()

    def __repr__(self):
        return (f"Discretization({self.method.name}, order {self.order}, {self.mesh.ne} elements, "
                f"{self.space.ndof} dofs, {len(self.contact.weights)} contact points)")

    def __reduce_ex__(self, protocol: Any) -> Any:
        raise ProblemError("a Discretization has a mesh and a factorised matrix, which are not copied or pickled; make another "
                           "one, Discretization(problem, method, mesh, order=1): problems, methods and solvers can be pickled")

    @cached_property
    def form(self) -> Any:
        """B_h of the method, before assembly."""
        if self.mesh.ne != self.facets.incidence.shape[1] or self.mesh.GetCurveOrder() != self._curved:
            raise ProblemError("the mesh was refined or curved after the Discretization was made; make a new one")
        return self.method.Form(self.problem, self.facets, self.space, self.order, self.assembly)

    @cached_property
    def facetform(self) -> Any:
        """B_h of a discontinuous method from facet operators, whichever route assembles."""
        return self.form if self.assembly == "facet" else self.method.Form(self.problem, self.facets, self.space, self.order,
                                                                           "facet")

    def Add(self, form: Any) -> Discretization:
        """Add a BilinearForm or a LinearForm on `space` to B_h or to f, before anything is solved; returns the Discretization.

        The sum must stay coercive, which an eigenvalue computation checks.  Forces of added forms appear as "added" in the
        balance.  Raises ProblemError for another kind of object, another space, or if the matrix is there already.

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
        if not isinstance(form, (BilinearForm, LinearForm)):
            raise ProblemError(f"form is {form!r}; give an NGSolve BilinearForm or LinearForm on disc.space")
        if form.space is not self.space:
            raise ProblemError("form lives on another space; make it on disc.space")
        if {"matrix", "loads", "inverse"} & set(self.__dict__):
            raise ProblemError("the matrix or the load is there already; add forms right after the Discretization is made")
        with Threads(self.mesh):
            form.Assemble()
        if isinstance(form, BilinearForm):
            self._CheckAdded(form)
        values = form.mat.AsVector() if isinstance(form, BilinearForm) else form.vec
        if not np.all(np.isfinite(values.FV().NumPy())):
            raise ProblemError("the added form is not finite; look for a division by zero or a root of a negative number")
        (self.addedmatrices if isinstance(form, BilinearForm) else self.addedloads).append(form)
        for name in ("addedmatrix", "unresisted"):
            self.__dict__.pop(name, None)
        return self

    def _CheckAdded(self, form):
        """Raise ProblemError unless the BilinearForm is a sparse matrix on the space, and linear."""
        if form.condense or not hasattr(form.mat, "CSR") or form.mat.shape != (self.space.ndof, self.space.ndof):
            raise ProblemError("form is no sparse square matrix; make it BilinearForm(disc.space), without condense, "
                               "nonassemble, diagonal or another test space")
        vector, once, twice = (form.mat.CreateColVector() for _ in range(3))
        vector.FV().NumPy()[:] = np.random.default_rng(1).standard_normal(self.space.ndof)
        with Threads(self.mesh):
            form.Apply(vector, once)
            vector.data = 2 * vector
            form.Apply(vector, twice)
        if Norm(twice - 2 * once) > 1e-9 * Norm(twice):
            raise ProblemError("form is not linear in the trial function; only bilinear forms can be added")

    @cached_property
    def matrix(self) -> Any:
        """NGSolve's matrix A of B_h, checked for coercivity."""
        with Threads(self.mesh):
            matrix = self.form.Matrix()
            if self.addedmatrices:
                matrix = Native(Csr(matrix) + self.addedmatrix)
            if not np.all(np.isfinite(matrix.AsVector().FV().NumPy())):
                raise ProblemError("the material is not finite at some quadrature point of the elements or facets; look for a "
                                   "division by zero or a root of a negative number")
            if self.addedmatrices:
                CheckSum(self.form, matrix, self.space.FreeDofs(), self._held)
            else:
                CheckCoercivity(self.method, self.form, matrix, self.space.FreeDofs(), self._held)
        return matrix

    @property
    def loose(self) -> str | None:
        """Words for the rigid motions that neither dirichlet nor roller resist, or None."""
        return FreeMotion(self.facets, self._supports)

    @cached_property
    def unresisted(self) -> str | None:
        """Words for the rigid motions that added forms do not resist either, so that only contact does, or None."""
        if not self.loose or not self.addedmatrices:
            return self.loose
        size = np.trace(self._supports, axis1=1, axis2=2)[:, None, None]
        springs = Springs(self.facets, self.space, self.addedmatrix)
        return FreeMotion(self.facets, self._supports / np.where(size > 0, size, 1) + springs)

    @property
    def _held(self):
        """A soft stiffness of Gamma_C, scipy CSR, that makes norms definite where dirichlet and roller do not, or None."""
        if not self.loose:
            return None
        contact = self.contact
        weights = np.repeat(SOFT / contact.flexibility * contact.weights, contact.dim)
        return (contact.trace.T @ sp.diags(weights) @ contact.trace).tocsr()

    @cached_property
    def addedmatrix(self) -> Any:
        """The sum of the added bilinear forms as scipy CSR."""
        return sum(Csr(form.mat) for form in self.addedmatrices)

    @property
    def symmetric(self) -> bool:
        """True if A is symmetric, up to the round-off of assembly."""
        if not self.addedmatrices or not self.method.symmetric:
            return self.method.symmetric
        return abs(self.addedmatrix - self.addedmatrix.T).max() <= 1e-12 * abs(self.addedmatrix).max()

    @cached_property
    def loads(self) -> dict[tuple[str, str | None], Array]:
        """Coefficients of the loads, {(kind, region): (ndof,)}: body force, tractions, weakly prescribed displacements."""
        v, problem = self.space.TestFunction(), self.problem
        loads: dict[tuple[str, str | None], Array] = {}
        if problem.bodyforce is not None:
            loads["bodyforce", None] = Coefficients(Unfolded(problem.bodyforce) * v * dx(bonus_intorder=LOADBONUS))
        for region in problem.traction:
            measure = ds(skeleton=True, definedon=self.mesh.Boundaries(region), bonus_intorder=LOADBONUS)
            loads["traction", region] = Coefficients(OnFacets(problem, "traction", region, self.mesh) * v * measure)
        for form in self.addedloads:
            loads["added", None] = loads.get(("added", None), 0) + form.vec.FV().NumPy()
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
        return np.array([Projected(self.space, CF(tuple(axis))) @ self.load for axis in np.eye(self.mesh.dim)])

    shift = 0.0     # displacement of Gamma_C that is not in the space, as `subspace.Subspace` has one

    @cached_property
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
