"""A history in a folder: its last state as any solution, and of the others what is on Gamma_C."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from ngsolve import Parameter

from ..contact.memory import Memory
from ..contracts import Array, Inverter
from ..discrete.problem import DiscreteProblem
from ..exceptions import ProblemError
from ..solution import archive
from ..solution.solution import ContactSolution
from ..solution.storage import FIELDS
from .recall import Restoring
from .states import Increment, LoadState

NUMBERS, PUNCHES = "state numbers", "state punches"
POINTS = tuple(f"state {name}" for name in ("displacement", "traction", "origin", "before", "after"))


def CheckIsParameter(parameter: Any) -> None:
    """Raise ProblemError unless it is a Parameter of NGSolve."""
    if not isinstance(parameter, Parameter):
        raise ProblemError(f"parameter is {parameter!r}; give the ngsolve.Parameter on which the data depend, t = Parameter(0)")


def KeepStates(last: ContactSolution, states: Sequence[LoadState], folder: str | PathLike[str]) -> None:
    """Write states and the solution of the last one into a folder."""
    still, none = np.zeros_like(last.traction), np.zeros_like(last.weights)

    def Scalars(memory: Memory) -> Array:
        """Its path and depth worn off, (2, n)."""
        return np.array([none if array is None else array for array in memory[1:]])
    arrays = {"state displacement": np.array([state.displacement for state in states]),
              "state traction": np.array([state.traction for state in states]),
              "state origin": np.array([still if (u := state.before.displacement) is None else u for state in states]),
              "state before": np.array([Scalars(state.before) for state in states]),
              "state after": np.array([Scalars(state.after) for state in states]),
              **({} if states[0].punches is None else {PUNCHES: np.array([state.punches for state in states])}),
              NUMBERS: np.array([(state.time, state.work, state.energy, state.dissipation, state.increment.parts,
                                  state.increment.solves, state.increment.residual, state.increment.seconds, state.abrasion)
                                 for state in states], dtype=float)}
    with last.state.Restored():
        archive.Keep(last, folder, more=arrays)


def ReadStates(folder: str | PathLike[str], problem: Any, parameter: Any, added: Sequence[Any],
         inverse: str | Inverter | None) -> tuple[DiscreteProblem, list[LoadState]]:
    """(DiscreteProblem, states) from a folder, as `LoadHistory.Load` has them."""
    CheckIsParameter(parameter)
    try:
        with np.load(Path(folder) / FIELDS, allow_pickle=False) as fields:
            arrays = {name: fields[name] for name in (NUMBERS, *POINTS)}
            punches = fields.get(PUNCHES)       # which folders of problems without them have not
        times = arrays[NUMBERS][:, 0].tolist()
    except Exception as error:      # whatever a damaged file leads to
        raise ProblemError(f"{folder} holds no history: {' '.join(str(error).split()) or type(error).__name__}; give a folder "
                           "that LoadHistory.Save has written") from error
    with Restoring(parameter):
        parameter.Set(times[-1])
        last = ContactSolution.Load(folder, problem, added=added, inverse=inverse)
    displacement, traction, origin, before, after = (arrays[name] for name in POINTS)
    states = [LoadState(time=row[0], displacement=displacement[place], traction=traction[place],
                        before=Memory(origin[place], *before[place]) if place or np.any(origin[place]) else Memory(),
                        after=Memory(displacement[place] if punches is None else None, *after[place]),
                        work=row[1], energy=row[2], dissipation=row[3],
                        increment=Increment(row[0], int(row[4]), int(row[5]), row[6], row[7]), abrasion=row[8],
                        vector=last.vector if place == len(times) - 1 else None,
                        punches=None if punches is None else punches[place])
              for place, row in enumerate(arrays[NUMBERS].tolist())]
    return last.disc.After(None), states
