"""The command that is installed, as tests run it, and what it leaves."""

import sys
from pathlib import Path

from ngdgc import ContactSolution
from ngdgc.cases import example_4_1

COMMAND = Path(sys.executable).with_name("ngdgc")
RUN = [str(COMMAND), *"run example_4_1 --n 2 --out".split()]
PRECIOUS = {"solution/", "report.json", "report.txt"}


def Left(folder):
    """Names of all files in a folder and below."""
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


def Loaded(folder):
    return ContactSolution.Load(folder / "solution", example_4_1.Problem())
