"""What a run shows and leaves: progress of the iteration, and a folder with report, figures, page, VTK and solution."""

from __future__ import annotations

import json
import os
import shutil
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import IO, Any, Literal, cast

from ..exceptions import ProblemError
from ..solution.history import Level, Prediction, Step
from ..solution.solution import ContactSolution
from ..tools.calls import ByKeyword
from .files import Files

EVERY = 10          # iterations from one line of a log file to the next
DPI = 150           # of figures
SLOW = 4.0          # [s] after which the next iteration is a line, whatever its number
FIRST = 20          # iterations that a notebook shows at once; then one every PAUSE
PAUSE = 0.1         # [s]
UP = "\x1b[F\x1b[K"  # to the beginning of the line before, which is erased


@ByKeyword
class Progress:
    """A callback that shows how an iteration goes: `solver.Solve(disc, callback=Progress())`.

    In a terminal one line is rewritten, cut to its width; in a notebook one line of output is updated, at most ten times a
    second and at the end of the cell; in a file or a pipe the first, every tenth and slow iterations are a line each, written
    at once.  What is printed next begins on a new line, so nothing has to be closed; `Close()` shows the last iteration where
    it was left out.  One object may follow several solves.

    stream : where to write; None: the notebook or the standard output.  One that is closed, also a pipe whose reader has gone,
        silences the progress and does not disturb the iteration

    Ctrl-C raises `SolveInterrupted`, whose `solution` is the last iterate:

    >>> from ngdgc.cases import example_4_2
    >>> solution = example_4_2.Main(n=2, callback=Progress())       # doctest: +ELLIPSIS
    iteration     1   change ...
    """

    def __init__(self, stream: IO[str] | None = None) -> None:
        self.display = _Display(self.Close) if stream is None else None
        self.stream = sys.stdout if stream is None else stream
        self.live = self.display is None and self.stream.isatty() and os.environ.get("TERM") != "dumb"
        self.step: Step | None = None
        self.shown: Step | None = None
        self.time = 0.0

    def __call__(self, step: Step) -> None:
        if self.step is not None and step.number <= self.step.number:
            self.Close()        # of the mesh before
        self.step = step
        if self.live or step.number == 1 or self._Due(step.number):
            self._Show()

    def Predict(self, step: Step) -> None:
        """The same on a coarser mesh of a nested iteration."""
        self(step)

    def Reached(self, level: Level) -> None:
        """What came of a mesh of `SolveAdaptive`, on a line of its own."""
        self.Close()
        self._Write(f"{level.dofs:9d} unknowns: estimated error {level.error:.3g}", False)
        self.step = self.shown = None

    def Close(self) -> None:
        """Show the last iteration if it has not been shown."""
        if self.step is not self.shown:
            self._Show()

    def _Due(self, number: int) -> bool:
        since = time.perf_counter() - self.time
        if self.display is None:
            return number % EVERY == 0 or since >= SLOW
        return number <= FIRST or since >= PAUSE

    def _Show(self) -> None:
        step = cast(Step, self.step)
        follows = self.shown is not None and step.number > self.shown.number
        coarse = f"prediction with {step.unknowns} unknowns, " if isinstance(step, Prediction) else ""
        line = (f"{coarse}iteration {step.number:5d}   change {step.change:9.2e}   distance to the law {step.residual:9.2e}   "
                f"{step.seconds:7.2f} s")
        self.shown, self.time = step, time.perf_counter()
        self._Write(line, follows)

    def _Write(self, line: str, follows: bool) -> None:
        if self.display is not None:
            self.display(line, follows)
            return
        try:
            if self.live:
                # A line that the terminal breaks would be two lines up.
                line = (UP if follows else "") + line[:shutil.get_terminal_size().columns - 1]
            self.stream.write(line + "\n")
            self.stream.flush()
        except (OSError, ValueError):
            # Nobody reads any more; ValueError is what a closed file raises.
            self.stream, self.live = open(os.devnull, "w"), False


def _Display(Close: Callable[[], object]) -> Callable[[str, bool], None] | None:
    """In a notebook, a function (line, update) that shows a line or replaces the last one shown; elsewhere None.

    `Close` is called at the end of the cell.
    """
    shell: Any = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    if not hasattr(shell, "kernel"):
        return None
    from IPython.display import display

    handle: Any = None

    def AtEnd(*_: object) -> None:
        shell.events.unregister("post_run_cell", AtEnd)
        Close()

    def Display(line: str, update: bool) -> None:
        nonlocal handle
        content = {"text/plain": line}
        if update:
            handle.update(content, raw=True)
        else:
            handle = display(content, raw=True, display_id=True)
            shell.events.register("post_run_cell", AtEnd)
    return Display


def _Estimate(solution: ContactSolution) -> None:
    """Estimate the errors of a converged solution, those of forces only on meshes that were made for an error.

    Some have no estimate, as with added forms, and none is worth a run that is finished.
    """
    from ..estimates.force import EstimateForce
    from ..estimates.measures import Energy
    from ..estimates.zonelengths import EstimateZones

    if not solution.converged:
        return
    with suppress(ProblemError):
        solution.zoneerrors = EstimateZones(solution)
    with suppress(ProblemError):
        solution.estimate = solution.estimate or Energy(solution).estimate
    if any(level.error is not None for level in solution.levels):
        with suppress(ProblemError):
            solution.forceerrors = EstimateForce(solution)


def SaveResults(solution: ContactSolution, files: Files) -> None:
    """Write what must not be lost to `files.Files`: the solution, the numbers and the report, with an estimate of its error."""
    try:
        files.Write("solution/", solution.Save, precious=True)
    finally:        # also of what cannot be saved, such as a method of one's own
        _Estimate(solution)
        SaveReport(solution, files)


def SaveReport(solution: ContactSolution, files: Files) -> None:
    """Write the numbers and the report."""
    files.Text("report.json", json.dumps(solution.ToJSON(), indent=2, allow_nan=False) + "\n")
    files.Text("report.txt", solution.Report())


def DrawResults(solution: ContactSolution, files: Files, *, scale: float | Literal["auto"] = "auto") -> None:
    """Write page, VTK and figures; `scale` multiplies the displacement in the pictures, "auto" so that it is seen.

    With a number other than 1 the deformed body is drawn at that scale too, beside the one in real size.
    """
    from ..export import WriteContactVTK, WriteVTK

    files.Write("solution.vtu", partial(WriteVTK, solution))
    files.Write("contact.vtu", partial(WriteContactVTK, solution))
    DrawFigures(solution, files, scale=scale)


def DrawFigures(solution: ContactSolution, files: Files, *, scale: float | Literal["auto"]) -> None:
    """Write the page and the figures."""
    from ..export import WriteHTML
    from ..plots import (ContactFigure, DeformedFigure, ErrorFigure, FieldFigure, HistoryFigure, LawFigure, SettingFigure,
                         ZonesFigure)

    files.Write("solution.html", partial(WriteHTML, solution, scale=scale))
    first: float | Literal["auto"] = "auto" if scale == "auto" else 1
    figures = {"setting": lambda: SettingFigure(solution.disc), "deformed": lambda: DeformedFigure(solution, scale=first),
               "contact": lambda: ContactFigure(solution), "law": lambda: LawFigure(solution),
               "zones": lambda: ZonesFigure(solution), "history": lambda: HistoryFigure(solution)}
    if hasattr(solution.estimate, "parts"):     # of the energy
        figures["error"] = lambda: ErrorFigure(solution, estimate=solution.estimate)
    if scale not in (1, "auto"):
        figures["deformed-scaled"] = lambda: DeformedFigure(solution, scale=scale)
    figures["vonmises"] = lambda: FieldFigure(solution)
    for name, Figure in figures.items():
        files.Write(f"{name}.png", partial(DrawInto, Figure))


def DrawInto(Figure: Callable[[], Any], path: Path) -> None:
    """As savefig does, which draws everything once before only to place it."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    from ..plots.canvas import PLACED

    figure = Figure()
    if figure.get_gid() == PLACED:
        figure.set_layout_engine("none")
    figure.set_dpi(DPI)
    FigureCanvasAgg(figure).print_png(path)


@ByKeyword
def WriteResults(solution: ContactSolution, folder: str | Path, *, scale: float | Literal["auto"] = "auto") -> list[str]:
    """Write into a folder all that `ngdgc run` leaves; the list of names."""
    files = Files(folder)
    SaveResults(solution, files)
    DrawResults(solution, files, scale=scale)
    return files.written
