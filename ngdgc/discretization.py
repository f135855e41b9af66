"""A problem on a mesh: space, matrix A, load f, inverse, and Gamma_C."""

from functools import cached_property

import numpy as np
from ngsolve import BilinearForm, GridFunction, InnerProduct, LinearForm, TaskManager, ds, dx

from .coefficients import Unfolded
from .contact import ContactBoundary
from .elasticity import Strain
from .exceptions import ProblemError
from .facets import Facets
from .problem import ContactProblem
from .stability import CheckCoercivity
from .validation import CheckProblem, UnresistedMotion

LOADBONUS = 2       # quadrature degrees for loads that are no polynomials of the order of the displacement


class Discretization:
    """The discrete problem A u = f - T' W t, t = law(T u), of a method of order k >= 1 on a mesh.

    Parameters
    ----------
    problem : ContactProblem
    method : InteriorPenalty or Conforming
    mesh : ngsolve.Mesh, 2D or 3D; curve it (mesh.Curve(order)) before, if its boundary is curved
    order : polynomial degree k of the displacement

    Raises ProblemError for data that do not fit the mesh, here, and for a lost coercivity or a body that only its
    foundation holds, when the matrix is first needed.

    Attributes
    ----------
    space : the NGSolve space V_h;  form : BilinearForm of A;  load : coefficients of f, (ndof,)
    contact : ContactBoundary;  facetsets : the parts of E0 with their numerical fluxes
    solves : how often the inverse was applied
    """

    def __init__(self, problem, method, mesh, *, order=1):
        if not isinstance(problem, ContactProblem):
            raise ProblemError(f"problem is {problem!r}; give a ContactProblem")
        if not hasattr(method, "FacetSets"):
            raise ProblemError(f"method is {method!r}; give InteriorPenalty() or Conforming()")
        if isinstance(order, bool) or not isinstance(order, (int, np.integer)) or order < 1:
            raise ProblemError(f"order is {order!r}; it must be an integer of at least 1, "
                               "piecewise constants carry no strain")
        self.problem, self.method, self.mesh, self.order = problem, method, mesh, int(order)
        self.facets = Facets(mesh)
        CheckProblem(problem, mesh, self.facets)
        self.unresisted = UnresistedMotion(problem, self.facets)
        self.space = method.Space(mesh, self.order, "|".join(problem.dirichlet))
        self.contact = ContactBoundary(problem, self.facets, self.space, method.ScalarSpace(mesh, self.order), self.order)
        self.solves = 0

    def __repr__(self):
        return (f"Discretization({self.method.name}, order {self.order}, {self.mesh.ne} elements, "
                f"{self.space.ndof} dofs, {len(self.contact.weights)} contact points)")

    @cached_property
    def facetsets(self):
        return self.method.FacetSets(self.problem, self.facets, self.order)

    @cached_property
    def form(self):
        """B_h, checked for coercivity."""
        u, v = self.space.TnT()
        form = self._Energy()
        # One integral a term: NGSolve takes four times as long for their sum in one integral.
        for part in self.facetsets:
            form += -part.Jump(v) * part.Mean(u) * part.measure
            form += -part.Jump(u) * part.Mean(v) * part.measure
        self._AddPenalty(form)
        with TaskManager():
            form.Assemble()
            CheckCoercivity(self.method, self.facetsets, form, self._Norm, self.space.FreeDofs())
        return form

    def _Energy(self):
        u, v = self.space.TnT()
        material = self.problem.material
        form = BilinearForm(self.space)
        form += InnerProduct(material.Stress(Strain(u)), Strain(v)) * dx(bonus_intorder=material.bonus)
        return form

    def _AddPenalty(self, form):
        u, v = self.space.TnT()
        for part in self.facetsets:
            form += part.Penalty(part.Jump(u)) * part.Jump(v) * part.measure

    def _Norm(self):
        form = self._Energy()
        self._AddPenalty(form)
        return form.Assemble()

    @cached_property
    def loads(self):
        """Coefficients of the loads, {(kind, region): (ndof,)}: body force, tractions, weakly prescribed displacements."""
        v, problem = self.space.TestFunction(), self.problem
        integrals = {}
        if problem.bodyforce is not None:
            integrals["bodyforce", None] = Unfolded(problem.bodyforce) * v * dx(bonus_intorder=LOADBONUS)
        for region, value in problem.traction.items():
            integrals["traction", region] = Unfolded(value) * v * ds(
                skeleton=True, definedon=self.mesh.Boundaries(region), bonus_intorder=LOADBONUS)
        for part in self.facetsets:
            if part.value is not None:
                integrals["prescribed", part.region] = (part.Penalty(part.value) * part.Jump(v) * part.measure
                                                        - part.value * part.Mean(v) * part.measure)
        with TaskManager():
            return {key: self.Integrate(integral) for key, integral in integrals.items()}

    @property
    def load(self):
        return sum(self.loads.values(), np.zeros(self.space.ndof))

    def Integrate(self, integral):
        """Coefficients (ndof,) of a linear form on the space, for example of a numerical flux against the jump."""
        return LinearForm(integral).Assemble().vec.FV().NumPy().copy()

    @cached_property
    def prescribed(self):
        """Coefficients (ndof,) of a function with the strongly prescribed boundary values, zero for DG."""
        function = GridFunction(self.space)
        if not self.method.discontinuous and self.problem.dirichlet:
            function.Set(self.mesh.BoundaryCF(dict(self.problem.dirichlet), default=(0,) * self.mesh.dim),
                         definedon=self.mesh.Boundaries("|".join(self.problem.dirichlet)))
        return function.vec.FV().NumPy().copy()

    @cached_property
    def inverse(self):
        if self.unresisted:
            raise ProblemError(f"the body is held by its foundation alone: only contact resists {self.unresisted}.  That is a "
                               "legitimate problem, but the elastic matrix is singular and this iteration has no first "
                               "step; until the contact stiffness is part of the matrix, add dirichlet or roller")
        with TaskManager():
            return self.form.mat.Inverse(self.space.FreeDofs(), inverse="sparsecholesky")

    def Multiply(self, vector):
        """A u, (ndof,) -> (ndof,)."""
        source, target = self.form.mat.CreateRowVector(), self.form.mat.CreateColVector()
        source.FV().NumPy()[:] = vector
        with TaskManager():
            target.data = self.form.mat * source
        return target.FV().NumPy().copy()

    def Solve(self, load):
        """A^-1 load on the free dofs, (ndof,) -> (ndof,)."""
        source, target = self.form.mat.CreateColVector(), self.form.mat.CreateRowVector()
        source.FV().NumPy()[:] = load
        with TaskManager():
            target.data = self.inverse * source
        self.solves += 1
        return target.FV().NumPy().copy()

    def FreeSolution(self):
        """u with B_h(u, v) = (f, v): the response to the loads without foundation, (ndof,)."""
        lift = self.prescribed
        load = self.load - self.Multiply(lift) if np.any(lift) else self.load
        return lift + self.Solve(load)

    def Response(self, traction):
        """S t = A^-1 T' W t, the displacement caused by a traction t (n, d) on Gamma_C, as coefficients (ndof,)."""
        return self.Solve(self.contact.Load(traction))
