"""Contact in a subspace, equilibrium in the whole space, in turn: for equations that only an iteration can solve.

From u_0 in V_h, two steps:

    contact        u_0 + x, x in X_h (`subspace` module), solves the contact problem tested with X_h, by `NewtonRun`;
    equilibrium    A u = f - T' W (t + D (u - U)) in V_h, U, t and D the displacement, traction and slope of the law that
                   this gave, by conjugate gradients from u_0 + x; u is the next u_0.

Each error of zones and tractions that X_h cannot see is seen by the second step, and becomes load and displacement of the next
first one (a full approximation scheme with two spaces: Brandt 1977; for contact, Krause 2009).  What remains after both is a
tenth or less of what there was, so that as few steps of conjugate gradients are needed in all as for one linear equation.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import cast

from ...contact.equilibrium import Equilibrium
from ...contact.graph import GraphPoint
from ...contracts import Array
from ...discrete.problem import DiscreteProblem
from ...discrete.response import ContactResponse
from ..driver import LawResidual
from .record import SMALL
from .run import NewtonRun
from .stiffened import NewtonState
from .subspace import Subspace

FIRST = 1e-2        # law residual of the first solution in X_h, about what it lacks
INNER = 0.05        # that of the later ones, relative to what the whole had
PART = 0.05         # of what is out of balance, that conjugate gradients leave
MOST = 1e-10        # of the loads, that they may leave in the end
OUTDATED = 40       # applications in the first run in X_h that tell that its matrix was made for other zones
PATIENCE = 6        # corrections in which the law residual must halve


class CorrectedRun:
    """One run on a Discretization whose inverse is an iteration; arguments as for a `NewtonRun`.

    Attributes
    ----------
    run : that in X_h;  residuals : law residual after every correction
    most : of the loads, that may be left out of balance in the end
    """

    def __init__(self, disc: DiscreteProblem, start: tuple[Array, Array] | None, tol: float) -> None:
        self.disc, self.tol, self.most = disc, tol, MOST
        self.residuals: list[float] = []
        self.run = NewtonRun((disc.reduce or Subspace)(disc), start, tol)

    def Iterates(self) -> Iterator[Equilibrium]:
        subspace, goal = cast(Subspace, self.run.setting.disc), max(FIRST, self.tol)
        response: ContactResponse | None = None
        states = self.run.States(goal)
        yield _Whole(subspace, next(states))
        while (state := self._Reach(states, goal)) is not None:
            response = response or ContactResponse(self.disc, self.run.setting.Stiffness(state.point))
            iterate = self._Balance(response, _Whole(subspace, state).vector, state.point)
            self.residuals.append(LawResidual(self.disc.contact, iterate))
            yield iterate
            if self._Stalled():
                return
            goal, renew = min(FIRST, INNER * self.residuals[-1]), len(self.residuals) == 1 and subspace.solves > OUTDATED
            subspace = subspace.Moved(iterate.vector)
            states = self.run.Resume(subspace, goal, renew=renew)
            next(states)

    def _Reach(self, states: Iterator[NewtonState], goal: float) -> NewtonState | None:
        """The first state, after a step at least, that is as good as it has to be, or None."""
        return next((state for state in states if LawResidual(self.disc.contact, state.equilibrium) <= goal), None)

    def _Balance(self, response: ContactResponse, vector: Array, point: GraphPoint) -> Equilibrium:
        """The iterate in equilibrium, nearly; entirely where the law holds, so that this can be believed."""
        for goal in ({"part": PART}, {"most": self.most}):
            iterate = response.Approach(vector, point.displacement, point.traction, **goal)
            if LawResidual(self.disc.contact, iterate) > self.tol:
                break
            vector = iterate.vector
        return iterate

    def _Stalled(self) -> bool:
        return len(self.residuals) > PATIENCE and self.residuals[-1] > 0.5 * self.residuals[-1 - PATIENCE]

    def Diagnose(self, reason: str) -> tuple[str, None]:
        """Cause and remedy of a failure."""
        if self._Stalled() and self.residuals[-1] > SMALL:
            return (f"contact in a subspace and equilibrium in the whole space, in turn, stay at a law residual of "
                    f"{self.residuals[-1]:.2g}: with strong friction the solution depends on what the subspace does not see.  "
                    "Remedy: inverse='sparsecholesky', which needs no subspace, or a finer mesh"), None
        return self.run.Diagnose(reason)


def _Whole(subspace: Subspace, state: NewtonState) -> Equilibrium:
    """The equilibrium of a state in X_h with the coefficients of u in V_h."""
    return replace(state.equilibrium, vector=subspace.Whole(state.equilibrium.vector))
