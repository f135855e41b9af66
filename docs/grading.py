"""Notebooks as assignments of nbgrader: a cell for every answer, with its model solution, and a locked one that grades it."""

import json
import re
from pathlib import Path

from tables import DOCS

NOTEBOOKS = DOCS / "notebooks"
SCHEMA = 3
POINTS = {"Choice": 1, "Value": 2}      # and 3 for functions, laws and estimators
BEGIN, END = "### BEGIN {}\n", "### END {}\n"
ANSWER = re.compile(r'(answer_\d+ = \.\.\.)\n(Check\("(\d\d\.\d+)", (answer_\d+)\))')


def Solutions(path):
    """{exercise such as "01.2": source of its model solution}; what stands before the first one belongs to it.

    >>> Solutions(NOTEBOOKS / "solutions" / "01_winkler_column.py")["01.4"].splitlines()[-1]
    "answer_4 = ('b', 2)"
    """
    _, _, text = path.read_text(encoding="utf-8").split('"""', 2)
    before, *parts = re.split(r"^(?=# \d+\.\d+  )", text.strip(), flags=re.M)
    named = {re.match(r"# (\d+\.\d+)", part)[1].zfill(len("01.1")): part.strip() + "\n" for part in parts}
    first = next(iter(named))
    return {**named, first: before + named[first]}


def Assignment(notebook, solutions):
    """A notebook as a source of nbgrader's: `solutions` of `Solutions`."""
    cells = []
    for cell in notebook["cells"]:
        found = ANSWER.search("".join(cell["source"]))
        cells += Graded(found, solutions[found[3]]) if found else [cell]
    return {**notebook, "cells": cells}


def Graded(asked, solution):
    """The two cells in place of one that asks the checker, a match of ANSWER."""
    empty, check, name, answer = asked[1], asked[2], asked[3], asked[4]
    own = BEGIN.format("SOLUTION") + solution + END.format("SOLUTION")
    test = f'assert Check("{name}", {answer}), Check("{name}", {answer})\n'
    hidden = BEGIN.format("HIDDEN TESTS") + test + END.format("HIDDEN TESTS")
    return [Cell(f"answer-{name}", f"{empty}\n{own}", solution=True),
            Cell(f"check-{name}", f"{check}\n{hidden}", grade=True, locked=True, points=Points(name))]


def Cell(name, source, *, grade=False, solution=False, locked=False, points=None):
    """A cell with nbgrader's metadata; its id takes letters, digits and hyphens only."""
    name = name.replace(".", "-")
    marked = {"grade": grade, "grade_id": name, "locked": locked, "schema_version": SCHEMA, "solution": solution, "task": False,
              **({"points": points} if grade else {})}
    return {"cell_type": "code", "execution_count": None, "id": name, "metadata": {"nbgrader": marked}, "outputs": [],
            "source": source.rstrip("\n").splitlines(keepends=True)}


def Points(name):
    from ngdgc.exercises import EXERCISES

    return POINTS.get(type(EXERCISES[name]).__name__, 3)


def WriteAssignments(folder):
    """Write source/NAME/NAME.ipynb for every notebook, and a configuration that nbgrader finds there; returns their paths."""
    folder = Path(folder)
    written = []
    for path in sorted(NOTEBOOKS.glob("*.ipynb")):
        notebook = Assignment(json.loads(path.read_text(encoding="utf-8")),
                              Solutions(NOTEBOOKS / "solutions" / f"{path.stem}.py"))
        written.append(folder / "source" / path.stem / path.name)
        written[-1].parent.mkdir(parents=True, exist_ok=True)
        written[-1].write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    (folder / "nbgrader_config.py").write_text('c = get_config()\nc.CourseDirectory.course_id = "ngdgc"\n'
                                               "c.ExecutePreprocessor.timeout = 300\n", encoding="utf-8")
    return written
