"""The command `ngdgc compare`: one case by all methods, as a figure and a table."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Mapping

import numpy as np

from ..exceptions import NotConvergedError, SolveInterrupted
from ..methods.registry import METHODS, PAPER
from ..solution.solution import ContactSolution
from ..tools.names import Known
from ..tools.tables import Aligned
from ..tools.units import InUnits
from .arguments import Commands, Positive
from .casefiles import LoadCase
from .files import Files
from .studies import Show, Write

TITLES = ("method", "unknowns", "iterations", "solves", "seconds", "max |u| [length]", "max p_n [stress]", "int p_n{force}",
          "energy{energy}")


def AddCompare(commands: Commands) -> None:
    """The parser of the command, added to those of the command line."""
    compare = commands.add_parser("compare", help="solve a case by several methods; a figure and a table",
                                  description="Solve a case by several methods on the same mesh; write and print a table, and "
                                  "draw pressure, friction and deformed bodies side by side.")
    compare.add_argument("case", help="a file, or the name of a case that comes with the package")
    compare.add_argument("--method", nargs="+", default=list(PAPER),
                         help=f"{', '.join(METHODS)} (default {' '.join(PAPER)})")
    compare.add_argument("--order", type=Positive, help="polynomial degree of the displacement (default: the case's own)")
    compare.add_argument("--n", type=Positive, help="cells per side (default: the case's own)")
    compare.add_argument("--out", default="results", help="folder for comparison.png and comparison.txt (default results/)")
    compare.set_defaults(command=Compare)


def Compare(options: Namespace) -> int:
    """Solve, print and draw; the exit code is 1 if a method did not converge, whose last iterate is shown.

    What was computed is written also after Ctrl-C, the last iterate of the method at which it came included.
    """
    from ..plots import ComparisonFigure

    names = [Known(name, METHODS, what="method", choose="choose some of") for name in options.method]
    case, solutions = LoadCase(options.case), {}
    given = {name: getattr(options, name) for name in ("order", "n") if getattr(options, name) is not None}
    with Files(options.out, "comparison.txt") as files:
        try:
            for name in names:
                Show(name)
                try:
                    solutions[name] = case.Main(method=METHODS[name](), **given)
                except NotConvergedError as stop:
                    solutions[name] = stop.solution
                except SolveInterrupted as stop:
                    if stop.solution.history:
                        solutions[name] = stop.solution
                    raise
        finally:
            if solutions:
                Write(files, "comparison", Table(solutions), lambda: {"comparison": ComparisonFigure(solutions, scale="auto")})
    return 0 if all(solution.converged for solution in solutions.values()) else 1


def Table(solutions: Mapping[str, ContactSolution]) -> str:
    """A line of text for each of {label: solution}: its size and cost, the elastic energy, and on Gamma_C the largest |u|
    [length] and p_n [stress], and the integral of p_n."""
    disc = next(iter(solutions.values())).disc
    force, energy = (f" [stress length^{power}]" for power in (disc.mesh.dim - 1, disc.mesh.dim))
    rows: list[tuple[str, ...]] = [tuple(InUnits(title.format(force=force, energy=energy), disc.problem.units, bare=True)
                                         for title in TITLES)]
    for label, solution in solutions.items():
        last = solution.history[-1]
        values = (np.linalg.norm(solution.displacement, axis=1).max(), solution.pressure.max(), solution.normalforce,
                  solution.energy)
        rows.append((label + ("" if solution.converged else " (not converged)"), str(solution.disc.space.ndof),
                     str(last.number), str(last.solves), f"{last.seconds:.2f}", *(f"{value:.6g}" for value in values)))
    return "\n".join(Aligned(rows, numbers=True))
