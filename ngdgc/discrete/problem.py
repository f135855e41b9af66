"""A problem on a mesh: described, then frozen: space, matrix A, load f, inverse, and Gamma_C."""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import CoefficientFunction, Mesh

from ..contracts import Array, FluxForm, Form, Inverse, Inverter, Method, Missing
from ..exceptions import ProblemError
from ..linear.choice import CheckInverter, Chosen
from ..linear.equations import LinearEquations
from ..linear.motions import FreeMotions, ProjectedMotions
from ..linear.outside import Made
from ..mesh.doubling import Doubled
from ..mesh.facets import Csr, Facets, Free, Native, Threads
from ..mesh.pieces import Pieces
from ..problem.problem import ContactProblem
from ..tools.calls import ByKeyword
from ..tools.kinds import Short
from ..tools.memory import CheckAssembly
from ..tools.names import NameOf
from ..tools.values import Order
from .added import AddedForms
from .checks import CheckData, CheckJoints, CheckKinds, CheckMatrix, CheckMesh, CheckPart, CheckRegions, CheckSpace
from .divided import ContactOf
from .frozen import Frozen, OfMatrix, Twin
from .loads import GivenTractions, Loads, StrongValues
from .placed import Placed
from .restraints import Restraints
from .springs import SpringMatrices
from .state import State


@ByKeyword
class DiscreteProblem(LinearEquations, Placed):
    """The discrete problem A u = f - T' W t, t = law(T u), of a method of order k >= 1 on a mesh.

    It is described here and by `Add`.  What follows from that (`Frozen`) is computed once, when it is asked for, and belongs to
    what is described now: another form, or other values of Parameters, and all of it is another.

    Arguments and attributes are those of `Discretization`, the public class, which adds how it is solved by default.

    Attributes
    ----------
    given : the mesh that was given;  mesh : the same, or of continuous methods one whose nodes are doubled along joints
    pieces : of the boundary elements on Gamma_C whose quadrature is divided, {number: parts} as `pieces.Pieces`
    derived : {name: value} of what is frozen, if it was asked for;  elastic : the same for what follows from the matrix alone,
        which copies with other loads share
    """

    def __init__(self, problem: ContactProblem, method: Method, mesh: Mesh, *, order: int = 1, assembly: str = "facet",
                 inverse: str | Inverter = "auto") -> None:
        super().__init__()
        CheckKinds(problem, method, assembly)
        CheckInverter(inverse)
        CheckMesh(problem, mesh)
        order = Order(order, mesh.dim)
        CheckAssembly(mesh.ne, mesh.dim, order, discontinuous=method.discontinuous)
        self.method: Any = method
        self.problem, self.given, self.order, self.assembly = problem, mesh, order, assembly
        self.wanted = inverse
        self.facets = Facets(mesh, problem.joints, frame=problem.frame)
        CheckJoints(problem, method, mesh, assembly)
        CheckRegions(problem, mesh, self.facets)
        if problem.joints and not method.discontinuous:
            self.facets = Doubled(self.facets)
        self.mesh = self.facets.mesh
        self.space = method.Space(self.mesh, self.order, "|".join(problem.dirichlet))
        self.derived: dict[str, Any] = {}
        self.elastic: dict[str, Any] = {}
        self.pieces: Pieces = {}
        self._Read(State(self.problem, self.given))
        self.added = AddedForms(self.space, self.facets)

    def _Read(self, state: State) -> None:
        """Evaluate the data as they are now."""
        self.state = state
        CheckData(self.problem, self.mesh, self.facets)
        scalar = self.method.ScalarSpace(self.mesh, self.order)
        CheckSpace(self.method, self.space, scalar, self.mesh, "|".join(self.problem.dirichlet))
        self.contact = ContactOf(self, scalar)

    def Current(self) -> DiscreteProblem:
        """The same with the values that Parameters have now: this one if they are what they were, else a copy.

        A copy shares matrix and inverse if no Parameter in the material, in a spring or in an added form has changed.
        """
        self.state.CheckFixed()
        changed, added = self.state.Parameters(), self.added.Current()
        if not changed and added is self.added:
            return self.Moved(None)
        current = Twin(self)
        current.motion = None
        same = added.SameMatrix(self.added) and not any(name.startswith(("material", "spring")) for name in changed)
        current.derived, current.elastic, current.added = {}, self.elastic if same else {}, added
        current._Read(self.state.Now())
        return current

    def __repr__(self) -> str:
        return (f"Discretization({self.method.name}, order {self.order}, {self.mesh.ne} elements, "
                f"{self.space.ndof} dofs, {len(self.contact.weights)} contact points)")

    def __reduce_ex__(self, protocol: Any) -> Any:
        raise ProblemError("a Discretization has a mesh and a factorised matrix, which are not copied or pickled; make another "
                           "one, Discretization(problem, method, mesh, order=1): problems, methods and solvers can be pickled")

    @OfMatrix
    def form(self) -> Any:
        """B_h of the method, before assembly."""
        return self._Form(self.assembly)

    @OfMatrix
    def facetform(self) -> Any:
        """B_h of a discontinuous method from facet operators, whichever route assembles."""
        return self.form if self.assembly == "facet" else self._Form("facet")

    def _Form(self, assembly: str) -> Any:
        form = self.method.Form(self.problem, self.facets, self.space, self.order, assembly)
        contract = FluxForm if self.method.conservative and assembly == "facet" else Form
        if missing := Missing(form, contract):
            raise ProblemError(f"method {self.method.name} makes {Short(form)}, which has no {', '.join(missing)}; return an "
                               f"object as contracts.{contract.__name__} describes it")
        return form

    def Add(self, form: Any) -> DiscreteProblem:
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
        if not {"matrix", "loads", "inverse"}.isdisjoint([*self.elastic, *self.derived]):
            raise ProblemError("the matrix or the load is there already; add forms right after the Discretization is made")
        self.state.CheckFixed()
        self.added, self.derived, self.elastic = self.added.And(form), {}, {}
        return self

    @OfMatrix
    def matrix(self) -> Any:
        """NGSolve's matrix A of B_h, checked for coercivity."""
        self.restraints.Check()
        with Threads(self.mesh):
            elastic = self.form.Matrix()
            CheckPart(self, elastic, "Matrix()", 2)
            matrix = elastic if self.addedmatrix is None else Native(Csr(elastic) + self.addedmatrix)
            CheckMatrix(self, matrix, elastic)
        return matrix

    @Frozen
    def restraints(self) -> Restraints:
        """What holds the body."""
        return Restraints(self.problem, self.facets, self.contact, self.space, self.addedmatrix)

    @OfMatrix
    def springs(self) -> dict[str, Any]:
        """{region: scipy CSR} of int k u.v over the regions with springs."""
        return SpringMatrices(self.problem, self.space)

    @OfMatrix
    def addedmatrix(self) -> Any:
        """What is added to B_h, scipy CSR or None: springs, and the bilinear forms of the user's own."""
        parts = [*self.springs.values(), *([] if self.added.matrix is None else [self.added.matrix])]
        return sum(parts[1:], parts[0]) if parts else None

    @property
    def loose(self) -> str | None:
        """Words for the rigid motions that neither dirichlet nor roller resist, or None."""
        return self.restraints.loose

    @property
    def unresisted(self) -> str | None:
        """Words for the rigid motions that springs and added forms do not resist either, so that only contact does, or None."""
        return self.restraints.unresisted

    @property
    def symmetric(self) -> bool:
        """True if A is symmetric, up to the round-off of assembly."""
        if self.added.matrix is None or not self.method.symmetric:
            return self.method.symmetric
        return abs(self.added.matrix - self.added.matrix.T).max() <= 1e-12 * abs(self.added.matrix).max()

    @Frozen
    def tractions(self) -> dict[tuple[str, str], CoefficientFunction]:
        """{(kind, region): vector}, what acts on Gamma_F [stress]: tractions as they are given, forces over their areas."""
        return GivenTractions(self.problem, self.space)

    @Frozen
    def loads(self) -> dict[tuple[str, str | None], Array]:
        """Coefficients of the loads, {(kind, region): (ndof,)}: body force, tractions, forces, weakly imposed displacements."""
        return Loads(self)

    @property
    def load(self) -> Array:
        return sum(self.loads.values(), np.zeros(self.space.ndof))

    @Frozen
    def resultant(self) -> Array:
        """The sum of all loads, (d,) [stress length^(d-1)]."""
        return ProjectedMotions(self.space, np.zeros(self.mesh.dim))[:self.mesh.dim] @ self.load

    reduce: Any = None      # what makes a `subspace.Subspace` of it; None: that class
    shift = 0.0     # displacement of Gamma_C that is not in the space, as `subspace.Subspace` has one

    @Frozen
    def motions(self) -> Array:
        """Coefficients (m, ndof) of the rigid motions that A does not resist (`motions.FreeMotions`)."""
        return FreeMotions(self)

    @Frozen
    def prescribed(self) -> Array:
        """Coefficients (ndof,) of a function with the strongly prescribed boundary values, zero for DG."""
        return StrongValues(self)

    @property
    def unknowns(self) -> int:
        return int(self.space.ndof)

    @property
    def free(self) -> Any:
        return Free(self.space)

    @Frozen
    def rigidbasis(self) -> Array:
        """Coefficients of the rigid motions, (modes, ndof), rotations about the origin."""
        return ProjectedMotions(self.space, np.zeros(self.mesh.dim))

    @OfMatrix
    def inverse(self) -> Inverse:
        """A^-1 on the free dofs; ProblemError for a body that only its foundation holds, whose A is singular."""
        self.restraints.Check()
        if self.unresisted:
            raise ProblemError(f"the body is held by its foundation alone: only contact resists {self.unresisted}.  The "
                               "elastic matrix is singular and this iteration has no first step; take Solve(disc) or "
                               "SemismoothNewtonSolver(), which put contact stiffness into it, or add dirichlet or roller")
        return self.Factorise(self.matrix)

    @OfMatrix
    def inverter(self) -> Inverter:
        """What makes inverses (`linear.choice` module)."""
        return Chosen(self, self.wanted)

    @property
    def inversekind(self) -> str:
        """The name of what solves the linear equations."""
        return NameOf(self.inverter)

    @property
    def iterates(self) -> bool:
        """True if inverses are iterations, which give as many digits as they are asked for."""
        return bool(getattr(self.inverter, "iterates", False))

    def MakeInverse(self, matrix: Any) -> Inverse:
        return Made(self.inverter, matrix, self)

    def Solve(self, *, tol: float = 1e-10, coarser: Any = None, callback: Any = None) -> Any:
        raise ProblemError("a solution that was loaded has no default solver; take NestedNewtonSolver().Solve(solution.disc), "
                           "or Solve(Discretization(problem, method, mesh, order=1))")

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
