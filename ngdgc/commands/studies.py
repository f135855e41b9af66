"""The commands that compare methods and try solvers: Table 3, convergence, locking, atlas, sweep, grid."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

from ..methods.registry import METHODS, TakesForm
from .arguments import Commands, Finite, NumberOrAuto, Positive
from .files import Files

if TYPE_CHECKING:       # loaded by the commands that need them
    from matplotlib.figure import Figure

    from ..studies.atlas.solvers import Row, Sweep
    from ..studies.convergence import Series


def AddStudies(commands: Commands) -> None:
    """The parsers of the studies, added to those of the command line."""
    table = commands.add_parser("table3", help="print Table 3 of the paper, in every protocol, beside our numbers")
    _AddMethod(table)
    table.add_argument("--n", type=Positive, default=128, help="reference mesh 1/n (default 128, the paper's)")
    table.add_argument("--page", metavar="FILE", help="the documentation page to write (in a checkout, with all methods, "
                       "docs/table3.md)")
    table.set_defaults(command=Table3)
    _AddErrors(commands)
    survey = commands.add_parser("atlas", help="iterations, applications of an inverse and seconds of all solvers",
                                 description="All solvers on contact problems that vary stiffness, friction, mesh, order, "
                                 "method and dimension: tables, figures, and a file of all numbers that grows as they come.")
    survey.add_argument("--quick", action="store_true", help="a few tiny problems (a quarter of a minute; else ten minutes)")
    survey.add_argument("--page", metavar="FILE", help="the documentation page to write (in a checkout docs/atlas.md), with "
                        "figures in images/ and atlas.csv beside it")
    survey.add_argument("--out", default="results", help="folder for tables, figures and atlas.csv (default results/)")
    survey.set_defaults(command=Atlas)


def _AddErrors(commands: Commands) -> None:
    convergence = commands.add_parser("convergence", help="errors and observed orders on a smooth solution",
                                      description="Errors and observed orders on the smooth solution ngdgc.exact.SmoothSlip:"
                                      " a table, and a figure for each kind of cells.")
    _AddMethod(convergence, forms=True)
    convergence.add_argument("--order", type=Positive, nargs="+", default=[1, 2], help="polynomial degrees (default 1 2)")
    convergence.add_argument("--cells", type=str.lower, nargs="+", default=["triangle"],
                             help="triangle, triangle-flipped, quad; tet, hex, prism (default triangle)")
    convergence.add_argument("--n", type=Positive, nargs="+", default=[4, 8, 16], help="cells per side (default 4 8 16)")
    convergence.add_argument("--out", default="results", help="folder for table and figures (default results/)")
    convergence.set_defaults(command=Convergence)

    accuracy = commands.add_parser("accuracy", help="error against time on a smooth solution", description="Which method and "
                                   "order comes to 1 %, 0.1 %, 0.001 % the soonest: a table, and a figure for each kind of "
                                   "cells.")
    _AddMethod(accuracy)
    accuracy.add_argument("--order", type=Positive, nargs="+", default=[1, 2, 3, 4],
                          help="polynomial degrees (default 1 2 3 4)")
    accuracy.add_argument("--cells", type=str.lower, nargs="+", default=["triangle", "tet"],
                          help="as for convergence (default triangle tet)")
    accuracy.add_argument("--budget", type=Finite, default=5.0, help="seconds after which no finer mesh is tried (default 5)")
    accuracy.add_argument("--page", metavar="FILE", help="the documentation page to write (in a checkout docs/accuracy.md)")
    accuracy.add_argument("--out", default="results", help="folder for table and figures (default results/)")
    accuracy.set_defaults(command=Accuracy)

    locking = commands.add_parser("locking", help="errors of nearly incompressible bodies",
                                  description="Relative strain errors on ngdgc.exact.SmoothSlip as lam grows: table, figure.")
    _AddMethod(locking, forms=True)
    locking.add_argument("--order", type=Positive, nargs="+", default=[1, 2], help="polynomial degrees (default 1 2)")
    locking.add_argument("--n", type=Positive, default=16, help="cells per side (default 16)")
    locking.add_argument("--lam", type=Finite, nargs="+", default=[10.0 ** power for power in range(7)],
                         help="values of Lame's lam, with mu = 2 (default 1 10 ... 1e6)")
    locking.add_argument("--out", default="results", help="folder for table and figure (default results/)")
    locking.set_defaults(command=Locking)


def _AddMethod(parser: ArgumentParser, forms: bool = False) -> None:
    parser.add_argument("--method", type=str.lower, default="all", help=f"{', '.join(METHODS)}, or all: the paper's "
                        "four and h1 (default)")
    if forms:
        parser.add_argument("--form", type=str.lower, help="edge or lifting (default: both)")
        parser.add_argument("--penalty", default="auto", type=NumberOrAuto, help="of every discontinuous method, as for run")


def Show(line: str) -> None:
    """A line of progress."""
    print(line, file=sys.stderr, flush=True)


def Write(files: Files, name: str, text: str, Figures: Callable[[], Mapping[str, Figure]]) -> None:
    """Print and write a table, and then the figures {stem: figure} that a function draws, which takes its time."""
    print(text)
    files.Text(f"{name}.txt", text + "\n")
    for stem, figure in Figures().items():
        files.Write(f"{stem}.png", partial(figure.savefig, dpi=150))


def Page(file: str | None) -> AbstractContextManager[Files | None]:
    """The Files of a page of the documentation, for `WritePage`; without a file, nothing to write."""
    return Files(Path(file).parent, Path(file).name, option="--page") if file else nullcontext()


def WritePage(files: Files, text: str, Figures: Callable[[], Mapping[str, Figure]]) -> None:
    """Write a page, and the figures {stem: figure} that a function draws in images/ beside it."""
    files.Text(files.names[0], text)
    for stem, figure in Figures().items():
        files.Write(f"images/{stem}.png", partial(figure.savefig, dpi=110))


def Convergence(options: Namespace) -> int:
    """Errors of methods x orders x cells on the smooth solution; what was computed is written also if a solve fails."""
    from ..exact import SmoothSlip
    from ..meshes import BOXCELLS, UnitMesh
    from ..methods.variants import Variants
    from ..plots import ConvergenceFigure
    from ..studies.convergence import Study, Text

    methods = Variants(options.method, form=options.form, penalty=options.penalty)
    for cells in options.cells:
        UnitMesh(1, cells)      # unknown cells are an error before the first solve

    def Figures() -> dict[str, Figure]:
        return {f"convergence_{cells}": ConvergenceFigure(group) for cells, group in series.items()}

    series: dict[str, list[Series]] = {}
    with Files(options.out, "convergence.txt") as files:
        try:
            for cells, method, order in product(options.cells, methods.values(), options.order):
                study = Study(SmoothSlip(dim=3 if cells in BOXCELLS else 2), method, order=order, n=options.n, cells=cells,
                              callback=Show)
                series.setdefault(cells, []).append(study)
        finally:
            if series:
                Write(files, "convergence", Text([one for group in series.values() for one in group]), Figures)
    return 0


def Accuracy(options: Namespace) -> int:
    """Error against time of methods x orders x cells."""
    from ..exact import SmoothSlip
    from ..meshes import BOXCELLS, UnitMesh
    from ..methods.variants import Variants
    from ..plots import AccuracyFigure
    from ..studies import accuracy

    methods = Variants(options.method, form="edge" if TakesForm(options.method) else None)
    for cells in options.cells:
        UnitMesh(1, cells)

    def Figures() -> dict[str, Figure]:
        return {f"accuracy_{cells}": AccuracyFigure([one for one in series if one.cells == cells])
                for cells in dict.fromkeys(one.cells for one in series)}

    series = []
    with Files(options.out, "accuracy.txt") as files, Page(options.page) as page:
        try:
            for cells, method, order in product(options.cells, methods.values(), options.order):
                series.append(accuracy.Study(SmoothSlip(dim=3 if cells in BOXCELLS else 2), method, order=order, cells=cells,
                                             budget=options.budget, callback=Show))
        finally:
            if series:
                Write(files, "accuracy", accuracy.Text(series), Figures)
        if page:
            WritePage(page, accuracy.Page(series, budget=options.budget), Figures)
    return 0


def Locking(options: Namespace) -> int:
    """Errors of methods x orders for growing lam; what was computed is written also if a solve fails."""
    from ..methods.variants import Variants
    from ..plots import LockingFigure
    from ..studies.locking import Study, Text

    methods = Variants(options.method, form=options.form, penalty=options.penalty)
    sweeps = []
    with Files(options.out, "locking.txt") as files:
        try:
            for method, order in product(methods.values(), options.order):
                sweeps.append(Study(method, order=order, n=options.n, lam=options.lam, callback=Show))
        finally:
            if sweeps:
                Write(files, "locking", Text(sweeps), lambda: {"locking": LockingFigure(sweeps)})
    return 0


def Atlas(options: Namespace) -> int:
    """All solvers on all problems; what was computed is written and printed also after Ctrl-C."""
    from ..studies.atlas import solvers as atlas
    from ..studies.atlas.page import Figures, Table, Text

    sweeps, rows = atlas.QuickSweeps() if options.quick else atlas.Sweeps(), []
    with Files(options.out, "atlas.txt") as files, Page(options.page) as page:
        try:
            with files.Growing("atlas.csv") as file:
                table = Table(file)
                for row in atlas.Study(sweeps, limit=atlas.QUICK if options.quick else atlas.LIMIT, callback=Show):
                    rows.append(row)
                    table.Add(row)
        finally:
            if rows:
                Write(files, "atlas", Text(rows, sweeps), lambda: Figures(rows, sweeps))
        if page:
            AtlasPage(page, rows, sweeps)
    return 0


def AtlasPage(files: Files, rows: Sequence[Row], sweeps: Mapping[str, Sweep]) -> None:
    """The page of the atlas, its figures, and all rows in atlas.csv."""
    from ..studies.atlas.page import Figures, Page, Table

    WritePage(files, Page(rows, sweeps), lambda: Figures(rows, sweeps))
    with files.Growing("atlas.csv") as file:
        table = Table(file)
        for row in rows:
            table.Add(row)


def Table3(options: Namespace) -> int:
    """Print Table 3, as far as it was computed also after Ctrl-C; write the page if asked."""
    from ..studies import table3

    methods, readings = table3.Methods(options.method), []
    complete = options.method == "all" and Path("docs").is_dir()
    with Page(options.page or ("docs/table3.md" if complete else None)) as page:
        try:
            for reading in table3.Readings(options.n, methods=methods, callback=Show):
                readings.append(reading)
        finally:
            if readings:
                print(table3.Text(readings))
        if page:
            WritePage(page, table3.Page(readings), dict)
    return 0
