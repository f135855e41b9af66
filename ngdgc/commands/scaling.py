"""The command `ngdgc bench ranks`: what a body costs that is spread over processes."""

from __future__ import annotations

import argparse
import os
from argparse import Namespace
from itertools import chain
from typing import TYPE_CHECKING

from .arguments import Commands, Finite, Positive
from .files import Files
from .studies import Page, Show, WritePage

if TYPE_CHECKING:       # loaded by the command
    from ..studies.bench.ranks import Spread


def AddRanks(commands: Commands) -> None:
    """The parser of the command, added to those of the benchmarks."""
    parser = commands.add_parser("ranks", help="a body that is spread over processes by PETSc", description="Steps, messages, "
                                 "memory and time of a box on a DistributedMesh, on 1 to 8 ranks of MPI, and what follows from "
                                 "them for a thousand.")
    parser.add_argument("--quick", action="store_true", help="tiny boxes on two ranks (a minute; else an hour)")
    parser.add_argument("--repeat", type=Positive, default=3, help="runs beside each other, of which the medians are shown "
                        "(default 3)")
    parser.add_argument("--limit", type=Finite, default=1800.0, help="seconds that a run may take (default 1800)")
    parser.add_argument("--rows", metavar="FILE", type=Rows, default=[], nargs="+", help="scaling.json of earlier runs, which "
                        "are not run again")
    parser.add_argument("--page", metavar="FILE", help="the documentation page to write (in a checkout docs/scaling.md)")
    parser.add_argument("--out", default="results", help="folder for scaling.txt and scaling.json (default results/)")
    parser.set_defaults(command=BenchRanks)


def Rows(file: str) -> list[Spread]:
    """What a file of earlier runs has."""
    from ..studies.bench.scaling import Row

    try:
        with open(file, encoding="utf-8") as lines:
            return [Row(line) for line in lines]
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise argparse.ArgumentTypeError(f"{file!r} does not have rows of an earlier run ({error}); "
                                         "give its scaling.json") from error


def BenchRanks(options: Namespace) -> int:
    """Run, print and write; what was measured is written also after Ctrl-C."""
    from ..studies.bench import scaling
    from ..studies.bench.scalingpage import Page as Written, Text

    rows: list[Spread] = []
    with Files(options.out, "scaling.txt") as files, Page(options.page) as page:
        try:
            with files.Growing("scaling.json") as file:
                tasks = scaling.Tasks(quick=options.quick, repeat=options.repeat)
                for row in scaling.Study(tasks, known=list(chain(*options.rows)), limit=options.limit, callback=Show):
                    rows.append(row)
                    file.write(scaling.Line(row) + "\n")
                    file.flush()
        finally:
            if rows:
                print(text := Text(rows))
                files.Text("scaling.txt", text + "\n")
        if page:
            WritePage(page, Written(rows, os.cpu_count() or 1), dict)
    return 0
