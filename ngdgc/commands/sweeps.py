"""The commands that solve many problems and count failures: random ones, random histories, and a grid of parameters."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from .arguments import Commands, Positive
from .files import Files
from .signals import SIGNALS
from .studies import Show, Write

if TYPE_CHECKING:       # loaded by the commands that need it
    from ..studies.samples import Sample


def AddSweeps(commands: Commands) -> None:
    """The parsers of `sweep` and `grid`, added to those of the command line."""
    sweep = commands.add_parser("sweep", help="solve random problems and count failures", description="Random problems in 2D "
                                "and 3D with all methods and laws, soft and stiff foundations: every result is a line of "
                                "sweep.jsonl as soon as it is there; a tally and a figure at the end, also after Ctrl-C.")
    sweep.add_argument("--count", type=Positive, default=500, help="number of problems (default 500)")
    sweep.add_argument("--seed", type=Positive, default=1, help="seed of the random numbers (default 1)")
    sweep.add_argument("--dofs", type=Positive, default=150_000, help="largest number of unknowns, about (default 150000)")
    sweep.add_argument("--histories", action="store_true", help="lead every problem along ten random loads "
                       "(histories.jsonl, histories.txt)")
    sweep.add_argument("--out", default="results", help="folder for results, tally and figure (default results/)")
    sweep.set_defaults(command=RandomSweep)

    grid = commands.add_parser("grid", help="solve problems on a grid of parameters and count failures", description="Geometry "
                               "x coefficient of friction x k_n/E x h x order with interior penalty, the default solver and "
                               "Newton's method from rest; files and Ctrl-C as for sweep.")
    grid.add_argument("--geometry", type=str.lower, nargs="+", help="4.1, 4.2, block, unstructured, cad (default: all)")
    grid.add_argument("--all", action="store_true", help="the whole grid, up to h = 1/256 and order 4, for a night; by default "
                      "a part of it, for some minutes")
    grid.add_argument("--out", default="results", help="folder for results, tally and figure (default results/)")
    grid.set_defaults(command=ParameterGrid)


def RandomSweep(options: Namespace) -> int:
    """Random problems, or histories."""
    from ..studies.sweep import Samples

    if options.histories:
        return _Lead(options)
    title = f"sweep, seed {options.seed}, {options.count} problems"
    return _Solve("sweep", title, Samples(options.seed, options.count, dofs=options.dofs), options.count, options.out)


def ParameterGrid(options: Namespace) -> int:
    """The grid of parameters."""
    from ..solvers import SemismoothNewtonSolver
    from ..studies.grid import Grid

    samples = Grid(options.geometry, everything=options.all)
    return _Solve("grid", f"grid, {len(samples)} problems", samples, len(samples), options.out,
                  fromzero=SemismoothNewtonSolver())


def _Lead(options: Namespace) -> int:
    """Random histories; 1 if one failed."""
    from ..studies.paths import PathLine, Paths, PathTally

    title = f"histories, seed {options.seed}, {options.count} problems"
    with Files(options.out, "histories.jsonl", "histories.txt") as files:
        print(title, flush=True)
        with files.Growing("histories.jsonl") as file:
            records = Paths(options.seed, options.count, file, dofs=options.dofs,
                            callback=lambda record: Show(PathLine(record)))
        if records:
            Write(files, "histories", f"{title}\n{PathTally(records)}", dict)
    if len(records) < options.count:
        Show(f"ngdgc: {SIGNALS.words}")
        return SIGNALS.code
    return int(any(record.failed for record in records))


def _Solve(name: str, title: str, samples: Iterable[tuple[int, Sample]], count: int, out: str, **options: Any) -> int:
    """Solve samples, write and print what became of them, also after Ctrl-C; 1 if too many failed."""
    from ..plots import SweepFigure
    from ..studies.sweep import ALLOWED, Line, Sweep, Tally

    with Files(out, f"{name}.jsonl", f"{name}.txt") as files:
        print(title, flush=True)
        with files.Growing(f"{name}.jsonl") as file:
            records = Sweep(samples, file, callback=lambda record: Show(Line(record)), **options)
        if records:
            Write(files, name, f"{title}\n{Tally(records)}", lambda: {name: SweepFigure(records)})
    if len(records) < count:
        Show(f"ngdgc: {SIGNALS.words}")
        return SIGNALS.code
    return int(sum(bool(record.error) for record in records) > ALLOWED * count)
