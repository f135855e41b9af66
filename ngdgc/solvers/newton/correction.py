"""Contact in a subspace, equilibrium in the whole space, in turn: for equations that only an iteration can solve.

From u_0 in V_h, two steps:

    contact        u_0 + x, x in X_h (`subspace` module), solves the contact problem tested with X_h, by `NewtonRun`;
    equilibrium    A u = f - T' W (t + D (u - U)) in V_h, U, t and D the displacement, traction and slope of the law that
                   this gave, by conjugate gradients from u_0 + x; u is the next u_0.

Each error of zones and tractions that X_h cannot see is seen by the second step, and becomes load and displacement of the next
first one (a full approximation scheme with two spaces: Brandt 1977; for contact, Krause 2009).  What remains after both is a
tenth or less of what there was, so that as few steps of conjugate gradients are needed in all as for one linear equation.
"""

from dataclasses import replace

from ...contact.response import Compliance
from ..driver import LawResidual
from .run import SMALL, NewtonRun
from .subspace import Subspace

FIRST = 1e-2        # law residual of the first solution in X_h, about what it lacks
INNER = 0.05        # that of the later ones, relative to what the whole had
PART = 0.05         # of what is out of balance, that conjugate gradients leave
MOST = 1e-10        # of the loads, that they may leave in the end
OUTDATED = 40       # applications in the first run in X_h that tell that its matrix was made for other zones
PATIENCE = 6        # corrections in which the law residual must halve


class CorrectedRun:
    """One run on a Discretization whose inverse is an iteration; `solver` and `start` as for a `NewtonRun`.

    Attributes
    ----------
    residuals : law residual after every correction
    """

    def __init__(self, solver, disc, start):
        self.solver, self.disc, self.contact = solver, disc, disc.contact
        self.subspace = Subspace(disc)
        self.run = NewtonRun(replace(solver, tol=max(FIRST, solver.tol)), self.subspace, start)
        self.residuals = []

    def Iterates(self):
        iterates, compliance = self.run.Iterates(), None
        yield self._Whole(next(iterates))
        while self._Reach(iterates):
            point, vector = self.run.state.point, self._Whole(self.run.state.iterate).vector
            compliance = compliance or Compliance(self.disc, self.run.Stiffness(point))
            iterate = self._Balance(compliance, vector, point)
            self.residuals.append(LawResidual(self.contact, iterate))
            yield iterate
            if self._Stalled():
                return
            self.run.solver = replace(self.solver, tol=min(FIRST, INNER * self.residuals[-1]))
            self.subspace.Move(iterate.vector)
            iterates = self.run.Resume(renew=len(self.residuals) == 1 and self.subspace.solves > OUTDATED)
            next(iterates)

    def _Reach(self, iterates):
        """True once the run in X_h is as good as it has to be, after a step at least."""
        return any(LawResidual(self.contact, iterate) <= self.run.solver.tol for iterate in iterates)

    def _Balance(self, compliance, vector, point):
        """The iterate in equilibrium, nearly; entirely where the law holds, so that this can be believed."""
        for goal in ({"part": PART}, {"most": MOST}):
            iterate = compliance.Approach(vector, point.displacement, point.traction, **goal)
            if LawResidual(self.contact, iterate) > self.solver.tol:
                break
            vector = iterate.vector
        return iterate

    def _Whole(self, iterate):
        return replace(iterate, vector=self.subspace.Whole(iterate.vector))

    def _Stalled(self):
        return len(self.residuals) > PATIENCE and self.residuals[-1] > 0.5 * self.residuals[-1 - PATIENCE]

    def Diagnose(self, reason):
        """Cause and remedy of a failure."""
        if self._Stalled() and self.residuals[-1] > SMALL:
            return (f"contact in a subspace and equilibrium in the whole space, in turn, stay at a law residual of "
                    f"{self.residuals[-1]:.2g}: with strong friction the solution depends on what the subspace does not see.  "
                    "Remedy: inverse='sparsecholesky', which needs no subspace, or a finer mesh"), None
        self.run.solver = self.solver
        return self.run.Diagnose(reason)
