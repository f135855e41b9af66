"""A case along its load history: what `ngdgc run CASE --history` leaves."""

from __future__ import annotations

import inspect
import sys
from argparse import Namespace
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

from ..exceptions import NotConvergedError, ProblemError, SolveInterrupted
from ..histories.history import LoadHistory
from ..histories.states import Increment
from ..tools.tables import Aligned
from . import output
from .caseoptions import CaseArguments
from .files import Files
from .signals import SIGNALS


def RunHistory(case: ModuleType, options: Namespace) -> int:
    """Lead the case along its loads and write all states, those before a failure too, and everything about the last one."""
    known = _Keywords(case, options.case)
    if options.error is not None:
        raise ProblemError("--error does not apply to a history, which stays on one mesh; leave one of them out")
    arguments = CaseArguments(options, known)
    if "solver" not in known:
        del arguments["solver"]
    with Files(options.out, "history/", "solution/", "history.txt", "report.json", "report.txt") as files:
        history, code, message = _Lead(case, options.case, arguments)
        with SIGNALS.Held():
            try:
                _Save(history, files)
                output.SaveResults(history[-1], files)
            finally:
                print(Table(history) + "\n" + history[-1].Report(), flush=True)
        _Draw(history, files, scale=options.scale)
        output.DrawResults(history[-1], files, scale=options.scale)
    if message:
        print(f"ngdgc: {message}", file=sys.stderr)
    return code


def _Tell(increment: Increment) -> None:
    """A line of progress."""
    parts = f", in {increment.parts} parts" if increment.parts > 1 else ""
    print(f"time {increment.time:9.4g}   {increment.solves:4d} applications   distance to the law {increment.residual:9.2e}   "
          f"{increment.seconds:7.2f} s{parts}", flush=True)


def _Lead(case: ModuleType, name: str, arguments: dict[str, Any]) -> tuple[LoadHistory, int, str | None]:
    """(the states that there are, exit code, message) of History(...) of a case."""
    try:
        history = case.History(callback=_Tell, **arguments)
    except (NotConvergedError, SolveInterrupted) as stop:
        states = getattr(stop, "states", None)
        if states is None or not len(states):
            raise
        interrupted = isinstance(stop, SolveInterrupted)
        return states, *((SIGNALS.code, f"{SIGNALS.words}: {stop}") if interrupted else (1, str(stop)))
    if not isinstance(history, LoadHistory):
        raise ProblemError(f"History of {name} returned {type(history).__name__}, not a LoadHistory; let it return what "
                           "SolveHistory returns")
    return history, 0, None


def _Keywords(case: ModuleType, name: str) -> Any:
    """The parameters of History(...) of a case."""
    if not callable(getattr(case, "History", None)):
        raise ProblemError(f"{name} has no function History(method=..., order=..., n=..., callback=...) that returns what "
                           "SolveHistory returns; write it, or leave --history out")
    known = inspect.signature(case.History).parameters
    if missing := {"method", "callback"} - known.keys():
        raise ProblemError(f"History of {name} has no keyword {sorted(missing)[0]!r}; it needs method and callback")
    return known


def Table(history: LoadHistory) -> str:
    """Forces of the foundations on the body, motions of rigid punches, where the work goes, the largest depth worn off."""
    axes = "xyz"[:history[0].disc.mesh.dim]
    worn = {"abrasion": history.abrasion, "worn": history.worn.max(axis=1)} if history.disc.contact.wears else {}
    turns = [f"turned {axis}" for axis in axes] if len(axes) == 3 else ["turned"]
    moved = {f"{name} {word}": motion for name, motions in history.punches.items()
             for word, motion in zip([*(f"moved {axis}" for axis in axes), *turns], motions.T)}
    rows = [("time", *(f"force {name} {axis}" for name in history.forces for axis in axes), *moved, "work", "energy",
             "dissipation", *worn)]
    forces = [history.forces[name][:, i] for name in history.forces for i in range(len(axes))]
    sums = history.work, history.energy, history.dissipation
    for values in zip(history.times, *forces, *moved.values(), *sums, *worn.values()):
        rows.append(tuple(f"{float(value):.6g}" for value in values))
    return "\n".join(Aligned(rows, numbers=True)) + "\n"


def _Save(history: LoadHistory, files: Files) -> None:
    """Write what must not be lost: the states, and the table."""
    try:
        files.Write("history/", history.Save, precious=True)
    finally:
        files.Text("history.txt", Table(history))


def _Draw(history: LoadHistory, files: Files, *, scale: Any) -> None:
    """Write the forces and energies as a figure, all states as an animation and as a time series for ParaView."""
    from ..export import Animation, WriteSeries
    from ..plots import LoadHistoryFigure

    files.Write("forces.png", partial(output.DrawInto, lambda: LoadHistoryFigure(history)))
    files.Write("animation.html", lambda path: Animation(list(history), scale=scale).Write(path))

    def Series(folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        WriteSeries(history, folder / "history")
    files.Write("series/", Series)
