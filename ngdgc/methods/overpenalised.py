"""A weakly over-penalised method, which has no terms with {C eps(u)}: jumps are penalised, their means much more."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from ngsolve import FESpace

from ..blocks.batches import FacetPatch
from ..blocks.operators import FacetOperators
from ..contracts import Array
from ..exceptions import ProblemError
from ..problem.problem import ContactProblem
from ..tools.calls import ByKeyword
from ..tools.parallel import Batched
from ..tools.values import PositiveNumber
from .blockform import FacetForm
from .discontinuous import BrokenSpace
from .guarantee import ALWAYS
from .lifting import WeakFacets
from .penalty import ScalarPenalty


@ByKeyword
@dataclass(frozen=True, kw_only=True, repr=False)
class WeaklyOverPenalised(BrokenSpace):
    """Weakly over-penalised symmetric interior penalty of order 1 (Brenner, Owens, Sung 2008), for elasticity.

    B_h(u,v) = int C eps_h(u):eps_h(v) + sum_e int_e eta_e/h_e ([u]:[v] + (L/h_e)^2 [Pi u]:[Pi v]);    flux -eta_e/h_e (...).

    penalty : eta_e = penalty * mu, any number > 0; L is the size of the body and Pi w the mean of a jump w on e

    The average of C eps(u) on the facets is left out, and B_h coercive for any penalty.  In place of the missing terms the
    means, against which a constant stress works, are penalised by h^-3; against the rest of the jump it does no work.  The rest
    is penalised by h^-1: for the Laplacian, as published, that is not needed, but rotations of the elements cost no strain, and
    where the means alone are penalised they make the matrix singular (no inequality of Korn's, Falk 1991).  The error is of
    order 1 in the energy norm and 2 in L2, and the condition number of order h^-4: not for fine meshes.  Higher orders would
    need h^-(2k+1), and are refused.
    Source: Brenner, Owens, Sung, Electron. Trans. Numer. Anal. 30 (2008); the second penalty as in Hansbo and Larson, M2AN 37
    (2003).

    >>> WeaklyOverPenalised(penalty=5).symmetric
    True
    """

    penalty: float = 10.0
    name: ClassVar[str] = "WOPSIP"
    symmetric: ClassVar[bool] = True
    iterative: ClassVar[bool] = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "penalty", PositiveNumber(self.penalty, "penalty", "give a positive number"))

    @Batched
    def Form(self, problem: ContactProblem, facets: Any, space: Any, order: int, assembly: str) -> Any:
        """B_h with E0 = interior facets, Gamma_D and rollers."""
        if order != 1:
            raise ProblemError(f"order is {order}; {self.name} is of first order, for higher ones its penalty is too weak: "
                               "take order=1, or another method")
        if assembly != "facet":
            raise ProblemError(f"assembly={assembly!r} does not apply to {self.name}, NGSolve's symbols have no means on "
                               "facets; take assembly='facet'")
        share, rollers = WeakFacets(problem, facets)
        return OverPenalisedForm(problem, space, FacetOperators(problem.material, facets, order, order, share, rollers),
                                 self.penalty)


class OverPenalisedForm(FacetForm):
    """B_h of a WeaklyOverPenalised method."""

    consistent = False

    def __init__(self, problem: ContactProblem, space: FESpace, operators: FacetOperators, value: float) -> None:
        super().__init__(problem, space, operators, rule=OverPenalty(value, operators), eta=None, lifted=False,
                         globallift=False, theta=0, guarantee=ALWAYS)


class OverPenalty:
    """eta_e/h_e ([w] + (L/h_e)^2 [Pi w])."""

    def __init__(self, value: float, operators: FacetOperators) -> None:
        self._operators, self._plain = operators, ScalarPenalty(value, operators)
        vertices = operators.facets.vertices
        points = operators.mesh.ngmesh.Coordinates()[vertices[vertices >= 0], :operators.dim]
        self._excess = np.square(np.ptp(points, axis=0).max() / operators.facets.diameter)

    def FacetMatrix(self, patch: FacetPatch) -> Array:
        """<P(mu):[nu]>, (n, r, r)."""
        plain = self._plain.FacetMatrix(patch)
        mass = np.linalg.inv(self._operators.inversemass(patch.sides[0]))
        mean = np.zeros_like(mass)
        mean[:, 0] = mass[:, 0] / mass[:, :1, 0]        # the first facet function is 1
        mean = np.kron(np.eye(self._operators.dim), mean)
        return plain + self._excess[patch.facets, None, None] * (np.swapaxes(mean, 1, 2) @ plain @ mean)
