"""What a class gets: `python docs/classroom.py students FOLDER`, `nbgrader FOLDER`, or `handout SITE FOLDER`.

students: notebooks, the package without formulas of right answers, and a script that installs it and opens JupyterLab
nbgrader: the notebooks as assignments, with model solutions, for the teacher alone
handout: the notebooks as PDF, printed by Chromium from a built site, with formulas and pictures
"""

import argparse
import base64
import csv
import hashlib
import io
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from tempfile import TemporaryDirectory

from check import CHROMIUM, OPTIONS
from grading import NOTEBOOKS, WriteAssignments
from tables import DOCS

EXERCISES = "ngdgc/exercises/"
# Of the exercises, in a package of students.
KEPT = {"__init__.py", "checker.py", "effectivity.py", "overview.py", "sealed.py"}
START = """#!/bin/sh
# Install what the notebooks need, the first time, and open them.
set -e
cd "$(dirname "$0")"
[ -x .venv/bin/jupyter ] || { python3 -m venv .venv && .venv/bin/pip install "$(ls "$PWD"/ngdgc-*.whl)[notebook]"; }
exec .venv/bin/jupyter lab "$@" notebooks
"""


def Wheel(folder):
    """The wheel of this checkout, built into a folder."""
    subprocess.run([sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", folder, DOCS.parent],
                   check=True)
    (wheel,) = Path(folder).glob("ngdgc-*.whl")
    return wheel


def WithoutAnswers(wheel, target, sealed):
    """Copy a wheel; in place of the modules that hold exercises stands a sealed file, bytes."""
    with zipfile.ZipFile(wheel) as given, zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as made:
        files = {name: given.read(name) for name in given.namelist()
                 if not name.startswith(EXERCISES) or name.removeprefix(EXERCISES) in KEPT}
        files[f"{EXERCISES}sealed.bin"] = sealed
        (record,) = (name for name in files if name.endswith(".dist-info/RECORD"))
        del files[record]
        table = io.StringIO()
        writer = csv.writer(table, lineterminator="\n")
        for name, content in files.items():
            made.writestr(name, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            writer.writerow((name, f"sha256={digest}", len(content)))
        writer.writerow((record, "", ""))
        made.writestr(record, table.getvalue())


def Students(folder, *, answers=True):
    """Write notebooks, the package for students, and the script that starts JupyterLab."""
    from ngdgc.exercises import EXERCISES as exercises
    from ngdgc.exercises.sealed import Seal

    folder = Path(folder)
    (folder / "notebooks").mkdir(parents=True, exist_ok=True)
    for path in NOTEBOOKS.glob("*.ipynb"):
        shutil.copy(path, folder / "notebooks")
    with TemporaryDirectory() as built:
        wheel = Wheel(built)
        WithoutAnswers(wheel, folder / wheel.name, Seal(exercises, answers=answers))
    start = folder / "start.sh"
    start.write_text(START, encoding="utf-8")
    start.chmod(0o755)


def Handout(site, folder):
    """Print the notebooks of a built site, each to a PDF; returns their paths."""
    chromium = next(filter(None, map(shutil.which, CHROMIUM)), None)
    if chromium is None:
        sys.exit("classroom: there is no Chromium here, which prints the pages; install it")
    pages = sorted(Path(site).resolve().glob("notebooks/[0-9]*.html"))
    if not pages:
        sys.exit(f"classroom: {site} has no notebooks; build the site first: sphinx-build docs {site}")
    Path(folder).mkdir(parents=True, exist_ok=True)
    written = []
    for page in pages:
        written.append(Path(folder).resolve() / f"{page.stem}.pdf")
        with TemporaryDirectory() as profile:
            subprocess.run([chromium, *OPTIONS, f"--user-data-dir={profile}", "--no-pdf-header-footer",
                            f"--print-to-pdf={written[-1]}", page.as_uri()], capture_output=True, check=True, timeout=180)
    return written


def Main(arguments=None):
    parser = argparse.ArgumentParser(prog="classroom.py", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    students = commands.add_parser("students", help="notebooks and the package without formulas of right answers")
    students.add_argument("folder")
    students.add_argument("--blind", action="store_true", help="no answers at all: the checker takes note, and you grade")
    commands.add_parser("nbgrader", help="assignments with model solutions, for the teacher").add_argument("folder")
    handout = commands.add_parser("handout", help="the notebooks as PDF")
    handout.add_argument("site", help="a built site, results/docs")
    handout.add_argument("folder")
    options = parser.parse_args(arguments)
    if options.command == "students":
        Students(options.folder, answers=not options.blind)
    elif options.command == "nbgrader":
        WriteAssignments(options.folder)
    else:
        Handout(options.site, options.folder)


if __name__ == "__main__":
    Main()
