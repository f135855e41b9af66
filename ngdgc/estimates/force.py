"""The errors of forces, of the largest pressure and of displacements."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..contracts import Array
from ..exceptions import ProblemError
from ..solution.solution import CheckSolution
from ..tools.calls import ByKeyword
from ..tools.values import HIGHEST
from .adjoint import Adjoint
from .estimate import RefuseHistories, RefuseJoints, RefusePunches
from .goals import Goals


@ByKeyword
@dataclass(frozen=True, kw_only=True)
class ForceEstimate:
    """Quantities of a solution with their estimated errors, {key: (m,)} each.

    Keys are the regions of the foundations for forces (d,) [stress length^(d-1)], ("pressure", region) for the largest pressure
    (1,) [stress], ("displacement", point) for displacements (d,) [length].

    value : as computed;  error : what is added to it, with its sign;  corrected : value + error
    shares : {key: (elements, m)}, summands of the errors
    relative : the largest error over the largest value (length of the vector), the larger one if there are several kinds
    indicators : (elements,) sums of the absolute shares, in the same units: their sum is at least `relative`

    >>> from ngdgc import EstimateForce
    >>> from ngdgc.cases import example_4_2
    >>> solution = example_4_2.Main(n=4)
    >>> force = EstimateForce(solution)
    >>> bool(np.all(force.corrected["bottom"] == force.value["bottom"] + force.error["bottom"]))
    True
    """

    value: Mapping[Hashable, Array]
    error: Mapping[Hashable, Array]
    relative: float
    indicators: Array = field(repr=False)
    shares: Mapping[Hashable, Array] = field(repr=False)

    @property
    def corrected(self) -> dict[Hashable, Array]:
        return {key: value + self.error[key] for key, value in self.value.items()}

    def __str__(self) -> str:
        lines = []
        for key, value in self.value.items():
            name = key if isinstance(key, str) else f"{key[0]} {key[1]}"        # type: ignore[index]
            numbers = ", ".join(f"{one:.6g} {error:+.2g}" for one, error in zip(value, self.error[key]))
            lines.append(f"{name}: {numbers}")
        return "\n".join([*lines, f"largest error relative to the largest value {self.relative:.2g}"])


@ByKeyword
def EstimateForce(solution: Any, *goals: Any) -> ForceEstimate:
    """The error of the force of every foundation on the body, component by component, as a `ForceEstimate`.

    Dual weighted residuals (Becker and Rannacher, Acta Numerica 10, 2001): with z the solution of the adjoint problem of order
    k + 1 on the same mesh, K' z = J'(u_h), K the derivative of the contact problem at u_h,

        error = J(u_h) - J_h + R(u_h; z).

    J_h is the value, J(u_h) that of a quadrature which is divided where zones end: for k >= 2 this difference is most of the
    error.  R(u_h; z) is what u_h leaves over in the equations of order k + 1, on Gamma_C in Nitsche's form, in which stick and
    stiff laws lock nothing (`nitsche` module; shares of the elements: `adjoint` module).  What it does not see is how far order
    k + 1 is from the truth, which at singular corners is not much less: where the error changes its sign it may be wrong.

    solution : ContactSolution of any method, 2D or 3D
    goals : "force", which they are without any; ("pressure", region), the largest mean over a patch of a foundation
        (`goals.PressureGoal`); ("displacement", point), at a point (d,).  All of them take one factorisation

    Raises ProblemError if the solution has not converged or is of the highest order; for another goal, a region that is no
    foundation's, a point outside of the body; with forms that were added.

    >>> from ngdgc import *
    >>> from ngdgc.cases import example_4_2
    >>> estimate = EstimateForce(example_4_2.Main(order=2, n=8))
    >>> print(f"{estimate.value['bottom'][1]:.3f} {estimate.corrected['bottom'][1]:.3f}, 25.143 on fine meshes")
    25.159 25.142, 25.143 on fine meshes
    """
    _Check(solution)
    with solution.state.Restored():
        wanted = Goals(solution, goals or ("force",))
        adjoint = Adjoint(solution)
        wanted = [goal.Placed(adjoint.contact.contact, adjoint.contact.traction) for goal in wanted]
        found = [adjoint.Errors(goal) for goal in wanted]
    value = {goal.key: goal.Value(solution) for goal in wanted}
    sizes: dict[str, float] = {}
    for goal in wanted:
        sizes[goal.kind] = max(sizes.get(goal.kind, 0.0), float(np.linalg.norm(value[goal.key])))
    largest = [np.abs(dual.error).max() / (sizes[goal.kind] or np.inf) for goal, dual in zip(wanted, found)]
    indicators = sum((np.abs(dual.shares).sum(axis=1) / (sizes[goal.kind] or np.inf) for goal, dual in zip(wanted, found)),
                     np.zeros(solution.disc.mesh.ne))
    return ForceEstimate(value=value, error={goal.key: dual.error for goal, dual in zip(wanted, found)},
                         shares={goal.key: dual.shares for goal, dual in zip(wanted, found)}, relative=float(max(largest)),
                         indicators=indicators)


def _Check(solution: Any) -> None:
    CheckSolution(solution)
    disc = solution.disc
    if not solution.converged:
        raise ProblemError("the solution has not converged, and errors of forces would be those of its iteration; give one "
                           "that has")
    if disc.order >= HIGHEST[disc.mesh.dim]:
        raise ProblemError(f"the solution is of order {disc.order}, the highest one, and errors of forces are estimated by the "
                           f"next; take order {disc.order - 1}")
    RefuseJoints(disc.problem)
    RefusePunches(disc.problem)
    disc.problem.frame.Refuse("EstimateForce")
    RefuseHistories(disc)
    if disc.added:
        raise ProblemError("forms were added, which are not known on the space of the next order; errors of forces are "
                           "estimated of problems without them")
