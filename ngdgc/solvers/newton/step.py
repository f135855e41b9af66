"""One step of Newton's method: how well its equation is solved, what follows at no cost, and where it is shortened."""

from __future__ import annotations


import numpy as np

from ...contracts import Array
from ..driver import LawResidual
from .record import Record, Taken
from .reduced import ReducedResponse
from .stiffened import NewtonState

HOLD = 0.01         # part of the slope that holds it which every point has at first, where nothing but the foundation does
FORCING = 3e-3      # relative residual of the linear equations
ROUGH = 0.1         # the largest one, for tolerances that are near
ACCURATE = 1e-9     # the smallest one that is asked for
SAMEPIECE = 0.1     # change of dt/dq, which is between 0 and 1, that tells pieces of the graph apart
GOAL = 0.1          # part of the tolerance at which the last linear equation aims
HALVINGS = 8        # of a Newton step
REDUCED = 8         # reduced problems for one Newton step
GAIN = 0.6          # of the merit function, that asks for one more
DECREASE = 1e-4     # relative decrease of the merit function that a full step must bring


def NewtonStep(state: NewtonState, record: Record, tol: float) -> NewtonState:
    """The best state that one Newton step leads to, shortened until the merit falls; it is recorded."""
    if state.merit == 0:
        return state
    setting, least = state.body.setting, None
    if not setting.held:
        # Where all points slip, or none touches, nothing would hold the body: its step would be a flight.
        least = HOLD * np.sqrt(state.merit / max(record.largest, state.merit))
    step, length = _Direction(state, GOAL * tol / state.Error(), least), 1.0
    best = Corrected(state, state.point.q + step, least, tol)
    if best.merit > GAIN * state.merit:
        best, length = _Shortened(state, step, best)
    record.Add(best, Taken(length=length, merit=state.merit, ratio=best.merit / state.merit, least=least,
                           zones=best.point.zones))
    return best


def _Direction(state: NewtonState, enough: float, least: float | None) -> Array:
    """Newton's step in q, (n, d), accurate enough for a relative residual of the whole."""
    body = state.body
    step = body.Direction(state, float(np.clip(enough, FORCING, ROUGH)), least)
    trial = body.setting.graph.At(state.point.q + step)
    if enough < FORCING and np.abs(trial.derivative - state.point.derivative).max() < SAMEPIECE:
        # The step stays on one smooth piece, so its equation is the last one that matters, and worth solving well.
        step = body.Direction(state, max(enough, ACCURATE), least)
    return step


def _Shortened(state: NewtonState, step: Array, best: NewtonState) -> tuple[NewtonState, float]:
    """(best state, its length) of steps halved until the merit falls; `best` competes as a full one."""
    chosen = length = 1.0
    for _ in range(HALVINGS + 1):
        trial = state.At(state.point.q + length * step)
        if trial.merit < best.merit:
            best, chosen = trial, length
        if best.merit <= (1 - DECREASE * length) * state.merit:
            break
        length /= 2
    return best, chosen


def Corrected(state: NewtonState, q: Array, least: float | None, tol: float) -> NewtonState:
    """The best of the states to which problems with a `ReducedResponse` lead from q.

    One application of the inverse each; they know the zones that change on the way, which a linear equation cannot.
    """
    body, best = state.body, None
    for _ in range(REDUCED):
        q = ReducedResponse(body.recycled, body.blocks).Minimise(
            body.setting.graph, lambda point: body.Equation(point, least), body.Merit, state, q)
        trial = state.At(q)
        if best is None or trial.merit < best.merit:
            best = trial
        if trial.merit > GAIN * state.merit or LawResidual(body.setting.contact, best.equilibrium) <= tol:
            break
        state = trial
    return best or state
