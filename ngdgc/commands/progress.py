"""ngdgc progress: which exercises of the notebooks in a folder are done."""

from __future__ import annotations

from argparse import Namespace

from .arguments import Commands


def AddProgress(commands: Commands) -> None:
    progress = commands.add_parser("progress", help="which exercises of the notebooks in a folder are done",
                                   description="What the checker said in the notebooks of a folder, as they were last saved: "
                                   "of one student, or of a class with a folder for each.")
    progress.add_argument("folder", nargs="?", default=".", help="folder with notebooks (default: this one)")
    progress.set_defaults(command=ShowProgress)


def ShowProgress(options: Namespace) -> int:
    from ..exercises.overview import Overview

    print(Overview(options.folder))
    return 0
