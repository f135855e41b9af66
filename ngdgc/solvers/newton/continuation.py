"""The load raised in steps that adapt, from rest: what reaches a solution where Newton's method does not."""

from __future__ import annotations

from dataclasses import dataclass

from .record import Record
from .step import NewtonStep
from .stiffened import NewtonState, StiffenedBody

FIRST = 0.25        # step of the load
LOADSTEP = 1 / 32   # smallest one
CORRECTIONS = 12    # Newton steps for one load
ENOUGH = 1e-6       # of the merit, that is left after them
WORK = 500          # applications of an inverse
UNKNOWNS = 5e7      # for which all these solve together at most; time would depend on what else the machine does


@dataclass(frozen=True, kw_only=True, eq=False)
class Raised:
    """The state under full load, None if that was given up, and the last part of the load that was held."""

    state: NewtonState | None
    load: float


def RaiseLoad(body: StiffenedBody, record: Record, tol: float) -> Raised:
    """Newton's method under a load that grows; its steps are recorded."""
    setting = body.setting
    state, load, increment = body.Evaluate(setting.graph.At(setting.Rest()), load=0.0), 0.0, FIRST
    disc = setting.disc
    end = disc.solves + min(WORK, UNKNOWNS / disc.unknowns)
    while disc.solves <= end:
        increment = min(increment, 1 - load)
        trial = record.Begin(body.Evaluate(state.point, load=load + increment))
        goal, count = ENOUGH * trial.merit, 0
        while trial.merit > goal and count < CORRECTIONS:
            trial, count = NewtonStep(trial, record, tol), count + 1
        if trial.merit > goal:
            increment /= 2
            if increment < LOADSTEP:
                break
            continue
        if load + increment >= 1:
            return Raised(state=trial, load=load)
        state, load = trial, load + increment
        increment *= 2 if count <= CORRECTIONS // 2 else 1
    return Raised(state=None, load=load)
