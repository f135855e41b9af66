"""A run of the semismooth Newton method: steps, renewed matrices, and other ways where the steps come to an end."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

from ...contact.equilibrium import Equilibrium
from ...contracts import Array, LinearProblem
from ...discrete.response import ContactResponse
from .continuation import RaiseLoad
from .diagnosis import Diagnose
from .pathfollowing import Path
from .record import PATIENCE, Record
from .setting import Setting
from .step import NewtonStep
from .stiffened import NewtonState, StiffenedBody

RENEW = 20          # applications of an inverse that a factorisation without prediction serves at least
SETTLED = 1e-3      # ratio of merits after a step that hardly changed the zones
HASTE = 4           # PATIENCE where nothing but the foundation holds the body, as long as the load has not been raised in steps
TRIALS = 30         # Newton steps before a path is followed instead


class NewtonRun:
    """One run of the method on one discretisation.

    start : (displacement, traction), (n, d) each, or None: rest;  tol : of the law residual, in the end

    Attributes
    ----------
    body : with the first matrix;  start : the point of the graph where it begins;  given : True if that was not rest
    record : what has been done;  reached : part of the load up to which it was raised in steps
    """

    def __init__(self, disc: LinearProblem, start: tuple[Array, Array] | None, tol: float) -> None:
        setting, self.given, self.tol = Setting.Of(disc), start is not None, tol
        self.start = setting.graph.At(setting.Rest() if start is None else setting.graph.Coordinates(*start))
        self.body = StiffenedBody.At(setting, self.start, predicted=self.given)
        self.record, self.reached = Record(), 0.0

    @property
    def setting(self) -> Setting:
        return self.body.setting

    def Iterates(self) -> Iterator[Equilibrium]:
        """The equilibria of the states, for the driver."""
        return (state.equilibrium for state in self.States(self.tol))

    def States(self, tol: float) -> Iterator[NewtonState]:
        """States on the way to a tolerance, the first that of the start; they end when nothing helps."""
        setting, patient = self.setting, self.given or self.setting.held
        state = self.record.Begin(self.body.Evaluate(self.start))
        yield state
        # Few points have a sure way, which need not wait until slow steps come to an end.
        trials = TRIALS if setting.few and not self.given else None
        yield from islice(self._Newton(state, tol, PATIENCE if patient else HASTE), trials)
        # Continuation starts from rest whatever the start was; who gave one has his own next choice.
        if self.record.Roundoff() or self.given:
            return
        for Approach in (self.AlongPath, self.UnderLoad):
            found = Approach(self.record.state, tol)
            if found is not None:
                yield from self._Newton(self.record.Begin(found), tol, PATIENCE)

    def Resume(self, disc: LinearProblem, tol: float, *, renew: bool) -> Iterator[NewtonState]:
        """States from the last one on, for a problem with another right-hand side and the same matrix, nothing else.

        renew : put the stiffness of the law at that point into the matrix first
        """
        state = self.record.state
        body = state.body.Moved(disc)
        if renew:
            body = body.Renewed(state.point)
        state = self.record.Begin(body.Evaluate(state.point))
        yield state
        yield from self._Newton(state, tol, PATIENCE)

    def _Newton(self, state: NewtonState, tol: float, patience: int) -> Iterator[NewtonState]:
        """States under full load until the steps bring no more."""
        record = self.record
        while not record.Stalled(patience):
            state = NewtonStep(state, record, tol)
            yield state
            if not record.steps:
                return
            near = record.steps[-1].ratio < SETTLED or record.Roundoff()
            if near and not state.body.predicted and len(state.body.recycled.images) > RENEW:
                # The zones are nearly known now: with their stiffness in the matrix round-off and the work that is left shrink.
                state = record.Move(state.Renewed())
            elif record.Roundoff():
                return

    def AlongPath(self, state: NewtonState, tol: float) -> NewtonState | None:
        """The state at the end of a `Path`, where the body is held and has few contact points; or None."""
        setting = self.setting
        point = Path(ContactResponse(setting.disc), setting.scale).Follow() if setting.few else None
        return None if point is None else state.To(point)

    def UnderLoad(self, state: NewtonState, tol: float) -> NewtonState | None:
        """The state under full load, reached by raising it in steps, or None."""
        raised = RaiseLoad(state.body, self.record, tol)
        self.reached = raised.load
        return raised.state

    def Diagnose(self, reason: str) -> tuple[str, None]:
        """Cause and remedy of a failure."""
        return Diagnose(reason, self.record, self.setting, tol=self.tol, reached=None if self.given else self.reached)
