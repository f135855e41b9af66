"""The residual estimator of the error in the energy norm, for every method."""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import (CoefficientFunction, GridFunction, IfPos, InnerProduct, Integrate, L2, LinearForm, OuterProduct, Sym, ds,
                     dx, specialcf, x)

from ..contracts import Array
from ..data.coefficients import ForFacets, OnFacets, Unfolded
from ..exceptions import ProblemError
from ..mesh.facets import Curved, Threads
from ..solution.solution import CheckSolution, ContactSolution
from ..tools.calls import ByKeyword
from .divergence import Divergence
from .estimate import ErrorEstimate, RefuseHistories, RefuseJoints, RefusePunches, RefuseSprings, Relative
from .contactresidual import ContactResidual, Softest

EXTRA = 4       # quadrature degrees beyond 2 k for body forces
REASON = "the constants of residual estimators depend on the shape of the elements; values are some 3 to 6 times the error"


@ByKeyword
def ResidualEstimate(solution: ContactSolution) -> ErrorEstimate:
    """What is left over of the equations on elements and facets, weighted with the size of the elements.

    With sigma_h = C eps(u_h), c the smallest eigenvalue of C (2 mu), and on facets [w] = sym(w (x) n), the square of the value
    is the sum over all elements K of

        equilibrium    h^2/(c k^2) |f + div sigma_h|^2                               in K
        tractions      h/(c k) |sigma_h n - sigma_hat n|^2                           on its facets but those of Gamma_C
        jumps          k^2/h C [u_h - u_hat]:[u_h - u_hat]                           on its facets
        law            1/gamma |t - t(t + gamma u_h)|^2,  t = -sigma_h n,  gamma = c k/h      on Gamma_C

    u_hat is the average, and what is prescribed on Gamma_D and rollers; sigma_hat n the numerical flux, of a method without one
    the average of sigma_h n, and on Gamma_F the traction itself.  t(q) is the point q of the graph of the law
    (`contact.graph`): it tells whether (u_h, t) obeys the law, also between the contact points and for stiff foundations.
    Of a body of revolution integrals are those over the body, div sigma_h has the hoop stress, and its radial component counts
    with min(h/k, r) instead of h/k, since |w_r/r| is a strain.

    Raises ProblemError for solutions of discretisations with springs, or with added forms, whose forces are no function on
    facets and elements.

    >>> from ngdgc import *
    >>> from ngdgc.exact import SmoothSlip
    >>> from ngdgc.errors import EnergyError
    >>> from ngdgc.meshes import RectangleMesh
    >>> exact = SmoothSlip()
    >>> solution = Solve(Discretization(exact.problem, Conforming(), RectangleMesh(8)))
    >>> 2 < ResidualEstimate(solution).value / EnergyError(solution, exact.displacement) < 6
    True
    """
    CheckSolution(solution)
    disc = solution.disc
    RefuseSprings(disc.problem)
    RefuseJoints(disc.problem)
    RefusePunches(disc.problem)
    RefuseHistories(disc)
    if disc.added:
        raise ProblemError("the solution has added forms, whose forces are no tractions on facets that could be compared; "
                           "estimate errors without them: write springs and loads as foundation, traction and bodyforce")
    with solution.state.Restored(), Threads(disc.mesh):
        residuals = _Residuals(solution)
        shares = {"equilibrium": residuals.Elements(), "tractions": residuals.Tractions(), "jumps": residuals.Jumps(),
                  "law": ContactResidual(solution)}
        indicators = sum(shares.values(), np.zeros(disc.mesh.ne))
        value = float(np.sqrt(indicators.sum()))
    return ErrorEstimate(value=value, relative=Relative(solution, value), indicators=indicators,
                         parts={name: float(np.sqrt(share.sum())) for name, share in shares.items()},
                         Theory=lambda: (None, REASON))


class _Residuals:
    """The terms beside the law's, each (elements,) [stress length^d]."""

    def __init__(self, solution: ContactSolution) -> None:
        self.solution, self.disc = solution, solution.disc
        self.mesh, self.problem, self.order = self.disc.mesh, self.disc.problem, self.disc.order
        self.material, self.u, self.n = self.problem.material, solution.gfu, specialcf.normal(self.mesh.dim)
        self.frame = self.problem.frame
        self.stress, self.space = self.frame.Plane(solution.stress), L2(self.mesh, order=0, dgjumps=True)
        c = GridFunction(self.space)
        c.vec.FV().NumPy()[:] = Softest(self.disc)
        # NGSolve's mesh_size is |K|^(1/d) in an element, and on a facet the height of the element over it.
        self.own = h, c = specialcf.mesh_size, c
        self.other = h.Other(), c.Other()
        self.bonus = 2 * self.order + self.material.bonus + self.frame.bonus + (2 if Curved(self.mesh) else 0)

    def Elements(self) -> Array:
        residual = Divergence(self.disc, self.u)
        if self.problem.bodyforce is not None:
            residual = residual + Unfolded(self.problem.bodyforce)
        h, c = self.own
        if not self.frame.revolved:
            square = h ** 2 / c * InnerProduct(residual, residual) / self.order ** 2
        else:       # |w_r/r| is a strain: near the axis that is less than |w_r|/h
            near = IfPos(h - self.order * x, self.order * x, h)
            square = ((near * residual[0]) ** 2 + (h * residual[1]) ** 2) / (c * self.order ** 2)
        return np.array(Integrate(self.frame.Weighted(square), self.mesh, element_wise=True, order=self.bonus + EXTRA))

    def Tractions(self) -> Array:
        problem, facets = self.problem, self.disc.facets
        outer, rollers = facets.neighbours == 1, self._On(problem.roller)
        given = self._On([*problem.traction, *problem.force])
        contact = self._On([foundation.boundary for foundation in problem.foundation])
        roller = facets.Function(rollers)

        def Free(traction: CoefficientFunction) -> CoefficientFunction:
            """The part that no support takes."""
            return traction - roller * (traction * self.n) * self.n

        if self.disc.method.conservative:
            traction = self.stress * self.n - facets.orientation * self.solution.flux
            total = self._OnSides(self._Traction(traction, *self.own), ~contact & ~given)
        else:
            other = self.frame.Plane(self.material.OtherStress(self.frame.OtherStrain(self.u)))
            total = self._BetweenElements(lambda *side: self._Traction((self.stress - other) * self.n / 2, *side))
            free = outer & ~contact & ~given & ~self._On(problem.dirichlet)
            total += self._OnSides(self._Traction(Free(self.stress * self.n), *self.own), free)
        for (kind, region), value in self.disc.tractions.items():
            traction = self.stress * self.n - ForFacets(value, kind, region, self.mesh)
            total += self._OnBoundary(self._Traction(Free(traction), *self.own), region)
        return total

    def _Traction(self, traction: Any, h: Any, c: Any) -> Any:
        return h / c * InnerProduct(traction, traction) / self.order

    def Jumps(self) -> Array:
        total = np.zeros(self.mesh.ne)
        if self.disc.method.discontinuous:
            total += self._BetweenElements(lambda *side: self._Jump((self.u - self.u.Other()) / 2, *side))
        for region in self.problem.dirichlet:
            off = self.u - OnFacets(self.problem, "dirichlet", region, self.mesh)
            total += self._OnBoundary(self._Jump(off, *self.own), region)
        for region in self.problem.roller:
            off = (self.u * self.n - OnFacets(self.problem, "roller", region, self.mesh)) * self.n
            total += self._OnBoundary(self._Jump(off, *self.own), region)
        return total

    def _Jump(self, jump: Any, h: Any, _: Any) -> Any:
        tensor = Sym(OuterProduct(jump, self.n))
        return self.order ** 2 / h * InnerProduct(self.frame.InPlane(self.material).Stress(tensor), tensor)

    def _On(self, regions: Any) -> Any:
        """True for the facets on any of the regions, over facets."""
        return np.any([np.zeros(len(self.disc.facets.neighbours), bool), *map(self.disc.facets.On, regions)], axis=0)

    def _OnSides(self, square: Any, where: Array) -> Array:
        """Integrals over the sides of the elements that lie on these facets (a mask)."""
        there = self.disc.facets.Function(where)
        return self._Sum([(there * square, self.space.TestFunction(), dx(element_boundary=True, bonus_intorder=self.bonus))])

    def _BetweenElements(self, Square: Any) -> Array:
        """Integrals over inner facets of Square(h, c), with h and c of one side, for the element there, and of the other."""
        v, measure = self.space.TestFunction(), dx(skeleton=True, bonus_intorder=self.bonus)
        return self._Sum([(Square(*self.own), v, measure), (Square(*self.other), v.Other(), measure)])

    def _OnBoundary(self, square: Any, region: str) -> Array:
        measure = ds(skeleton=True, definedon=self.mesh.Boundaries(region), bonus_intorder=self.bonus)
        return self._Sum([(square, self.space.TestFunction(), measure)])

    def _Sum(self, terms: list[tuple[Any, Any, Any]]) -> Array:
        form = LinearForm(self.space)
        for square, v, measure in terms:
            form += self.frame.Integral(square * v, measure)
        return form.Assemble().vec.FV().NumPy().copy()
