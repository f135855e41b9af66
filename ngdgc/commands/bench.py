"""The command `ngdgc bench`: what things cost beside the factorisation of the matrix."""

from __future__ import annotations

import os
import sys
from argparse import Namespace

from ..exceptions import ProblemError
from ..methods.registry import METHODS, TakesForm
from .arguments import Commands, Positive
from .files import Files
from .scaling import AddRanks
from .studies import Page as StudyPage, Show, Write, WritePage


def AddBench(commands: Commands) -> None:
    """The parsers of the benchmarks, added to those of the command line."""
    bench = commands.add_parser("bench", help="what things cost beside the factorisation of the matrix",
                                description="Whole contact solutions, part by part, over sizes, methods and orders in 2D and "
                                "3D, beside a factorisation of the same matrix; and other codes, where they are installed.")
    bench.add_argument("--quick", action="store_true", help="tiny problems (half a minute; else with --repeat 1 twenty)")
    bench.add_argument("--repeat", type=Positive, default=3, help="runs, of which the medians are shown, of problems with up "
                       "to a million unknowns; one of larger ones (default 3)")
    bench.add_argument("--only", metavar="WORD", default="", help="only benches with this word in their names")
    bench.add_argument("--python", metavar="FILE", default=sys.executable, help="interpreter that has GetFEM or DOLFINx "
                       "(default: the one that runs this)")
    bench.add_argument("--page", metavar="FILE", help="the documentation page to write (in a checkout docs/performance.md)")
    bench.add_argument("--out", default="results", help="folder for table and figure (default results/)")
    bench.set_defaults(command=Bench)
    kinds = bench.add_subparsers(metavar="WHAT")
    AddRanks(kinds)
    assembly = kinds.add_parser(
        "assembly", help="assembly of a method on Example 4.1", description="Seconds for spaces and "
        "checks, for assembly (all operators, penalty, matrix) and for NGSolve's factorisation of "
        "the matrix, in one run: medians, and the peak memory of the assembly.")
    assembly.add_argument("--method", type=str.lower, nargs="+", default=["ip"], help=f"{', '.join(METHODS)} (default ip)")
    assembly.add_argument("--form", type=str.lower, default="edge", help="edge or lifting (default edge)")
    assembly.add_argument("--assembly", type=str.lower, default="facet", help="facet or skeleton, NGSolve's symbols (default "
                          "facet)")
    assembly.add_argument("--order", type=Positive, default=1, help="polynomial degree (default 1)")
    assembly.add_argument("--n", type=Positive, default=256, help="cells per side (default 256: 786 432 unknowns at order 1)")
    assembly.add_argument("--repeat", type=Positive, default=3, help="runs, of which the medians are shown (default 3)")
    assembly.set_defaults(command=BenchAssembly)


def Bench(options: Namespace) -> int:
    """Everything; what was computed is written and printed also after Ctrl-C."""
    from ..studies.bench import solutions as bench
    from ..studies.atlas.solvers import Point
    from ..studies.bench.page import Compared, Figures, Page, Text
    from ..studies.bench.traffic import LONG, MeasureTraffic

    benches = {name: points for name, points in bench.Benches(quick=options.quick).items() if options.only in name}
    if not benches:
        raise ProblemError(f"no bench has {options.only!r} in its name; choose among {', '.join(bench.Benches())}")
    costs: dict[str, list[bench.Cost]] = {}
    lines = []
    with Files(options.out, "performance.txt") as files, StudyPage(options.page) as page:
        try:
            for name, points in benches.items():
                for point in points:
                    Show(f"{name}: {point.method}, k = {point.order}, n = {point.n}")
                    large = point.problem == "box" and point.n > 16 or point.n > 256
                    costs.setdefault(name, []).append(bench.Measure(point, repeat=1 if large else options.repeat))
            for name, (point, n) in bench.Rivals(quick=options.quick).items():
                Show(name)
                result = bench.Peer(name.lower(), n, python=options.python)
                ours = None if isinstance(result, str) else bench.Measure(point, repeat=options.repeat)
                lines.append(Compared(name, result, ours))
            Show("memory")
            box = Point(problem="box", n=3 if options.quick else 15, stiffness=1.0)
            lines.append(str(MeasureTraffic(box, length=1 << 16 if options.quick else LONG)))
        finally:
            costs = {name: group for name, group in costs.items() if group}
            if costs:
                Write(files, "performance", Text(costs, lines), lambda: Figures(costs))
        if page:
            WritePage(page, Page(costs, lines, os.cpu_count() or 1), lambda: Figures(costs))
    return 0


def BenchAssembly(options: Namespace) -> int:
    """Assembly beside factorisation."""
    from ..methods.variants import Variants
    from ..studies.bench.assembly import MeasureAssembly, Text

    methods = [method for name in options.method
               for method in Variants(name, form=options.form if TakesForm(name) else None).values()]
    rows = []
    try:
        for method in methods:
            Show(f"{method!r}, order {options.order}, n = {options.n}")
            rows.append(MeasureAssembly(method, order=options.order, n=options.n, repeat=options.repeat,
                                        assembly=options.assembly))
    finally:
        if rows:
            print(Text(rows))
    return 0
