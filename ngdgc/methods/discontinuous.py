"""What the discontinuous methods of Table 2 share: their space, and B_h as a row of a few entries."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import fields
from typing import Any, ClassVar

from ngsolve import L2, Mesh, VectorL2

from ..blocks.operators import FacetOperators
from ..exceptions import ProblemError
from ..problem.problem import ContactProblem
from ..tools.calls import ByKeyword
from ..tools.parallel import Batched
from ..tools.values import Among
from .blockform import FacetForm
from .guarantee import Guarantee
from .lifting import WeakFacets
from .symbolform import Clamped, Interior, Part, Roller, SkeletonForm
from .symbollifting import LiftedSkeletonForm


class BrokenSpace:
    """V_h without any continuity, and what follows from that.

    What a method answers (`contracts.Method`): its functions jump, displacements on Gamma_D are weak, every element is in
    balance with the numerical flux, and conjugate gradients with the cycle of `linear.multigrid` solve symmetric ones.
    """

    discontinuous: ClassVar[bool] = True
    weak: ClassVar[bool] = True
    conservative: ClassVar[bool] = True
    iterative: ClassVar[bool] = True

    def __repr__(self) -> str:
        """The class with the arguments that are not the defaults."""
        given = [f"{field.name}={getattr(self, field.name)!r}" for field in fields(self)    # type: ignore[arg-type]
                 if getattr(self, field.name) != field.default]
        return f"{type(self).__name__}({', '.join(given)})"

    def Space(self, mesh: Mesh, order: int, clamped: str) -> Any:
        space = VectorL2(mesh, order=order, dgjumps=True)
        # Functions of L2 have no values on boundary elements; NGSolve, asked to integrate there, may end the process.
        space.SetDefinedOn(~mesh.Boundaries(".*"))
        space.FinalizeUpdate()
        return space

    def ScalarSpace(self, mesh: Mesh, order: int) -> Any:
        return L2(mesh, order=order)


@ByKeyword
class DiscontinuousGalerkin(BrokenSpace, ABC):
    """What the rows of Table 2 share; a method is a row of class variables and a stabilisation.

    form : "edge", B^(1)_h with averages of C eps(u) on the facets, or "lifting", B^(2)_h with C eps(u) against r_0([v])

    Rows: `globallift`, the term (C r_0[u], r_0[v]); `theta`, the factor of -<[u],{C eps(v)}>, 1 for a symmetric form;
    `_Stabilised`, the degree of the lifting space Q_h and what makes the form coercive.
    """

    form: str
    name: ClassVar[str]
    globallift: ClassVar[bool]
    theta: ClassVar[int] = 1

    def _CheckForm(self) -> None:
        if not Among(self.form, ("edge", "lifting")):
            raise ProblemError(f"form is {self.form!r}; choose 'edge' or 'lifting'")

    @property
    def symmetric(self) -> bool:
        """True if B_h(u, v) = B_h(v, u)."""
        return self.theta == 1

    @abstractmethod
    def _Stabilised(self, lifting: Callable[[int], FacetOperators], material: Any, mesh: Mesh,
                   order: int) -> tuple[FacetOperators, Any, float | None, Guarantee]:
        """(operators, penalty of the jumps or None, eta of eta sum_e (C r_e, r_e) or None, what is known of the coercivity).

        lifting(l) : the operators with liftings of degree l;  order : k
        """

    @Batched
    def Form(self, problem: ContactProblem, facets: Any, space: Any, order: int, assembly: str) -> Any:
        """B_h with E0 = interior facets, Gamma_D and rollers."""
        share, rollers = WeakFacets(problem, facets)

        def Lifting(liftorder: int) -> FacetOperators:
            return FacetOperators(problem.material, facets, order, liftorder, share, rollers)

        operators, rule, eta, guarantee = self._Stabilised(Lifting, problem.material, facets.mesh, order)
        terms: dict[str, Any] = {"lifted": self.form == "lifting", "globallift": self.globallift, "theta": self.theta,
                                 "guarantee": guarantee}
        if assembly == "facet":
            return FacetForm(problem, space, operators, rule=rule, eta=eta, **terms)
        parts: list[Part] = [Interior(problem, facets.mesh, rule),
                 *(Clamped(problem, facets, rule, region) for region in problem.dirichlet),
                 *(Roller(problem, facets, rule, region) for region in problem.roller)]
        if self.form == "edge" and not self.globallift and eta is None:
            return SkeletonForm(problem, space, parts, theta=self.theta, guarantee=guarantee)
        return LiftedSkeletonForm(problem, space, parts, facets, liftorder=operators.liftorder, eta=eta, **terms)
