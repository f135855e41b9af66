"""Conforming finite elements, the reference."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from ngsolve import H1, Mesh, VectorH1

from ..blocks.operators import FacetOperators
from ..problem.problem import ContactProblem
from ..tools.calls import ByKeyword
from ..tools.parallel import Batched
from .guarantee import ALWAYS, Bounded
from .lifting import WeakFacets
from .penalty import Penalty
from .symbolform import Roller, SkeletonForm


@ByKeyword
@dataclass(frozen=True)
class Conforming:
    """H1-conforming finite elements of order k, the reference.

    Displacements prescribed on all components are imposed strongly; normal ones (rollers, inclined or curved) by the boundary
    terms of the interior penalty method with its computed penalty, as in Nitsche 1971.

    >>> Conforming().name
    'H1'
    """

    name: ClassVar[str] = "H1"
    discontinuous: ClassVar[bool] = False
    weak: ClassVar[bool] = False
    conservative: ClassVar[bool] = False
    iterative: ClassVar[bool] = False
    symmetric: ClassVar[bool] = True

    def Space(self, mesh: Mesh, order: int, clamped: str) -> Any:
        # Boundary elements that are no sides of elements would bring unknowns that nothing determines.
        return VectorH1(mesh, order=order, dirichlet=clamped, definedon=mesh.Materials(".*"))

    def ScalarSpace(self, mesh: Mesh, order: int) -> Any:
        return H1(mesh, order=order, definedon=mesh.Materials(".*"))

    @Batched
    def Form(self, problem: ContactProblem, facets: Any, space: Any, order: int, assembly: str) -> Any:
        """a(u, v), with the terms of E0 = rollers; `assembly` makes no difference."""
        _, rollers = WeakFacets(problem, facets)
        if not rollers.any():
            return SkeletonForm(problem, space, [], guarantee=ALWAYS)
        operators = FacetOperators(problem.material, facets, order, order, rollers.astype(float), rollers)
        rule = Penalty("auto", None, operators)
        return SkeletonForm(problem, space, [Roller(problem, facets, rule, region) for region in problem.roller],
                            guarantee=Bounded(rule.kappa))
