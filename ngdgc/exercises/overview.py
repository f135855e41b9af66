"""Which exercises are done: what the checker said in notebooks that were run and saved, of one student or of a class."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from ..exceptions import ProblemError
from ..tools.calls import ByKeyword

ASKED = re.compile(r'^Check\("(\d\d\.\d+)"', re.M)
MARKS = {"correct": "+", "not yet": "-", "not answered yet": ".", "noted": "o", "not run": " "}
KEY = "+ correct, - not yet, . not answered, o noted, blank: not run"


@dataclass(frozen=True)
class Row:
    """A notebook: `file`, its path in the folder, and `states`, {exercise: "correct", "not yet", ..., or "not run"}."""

    file: str
    states: Mapping[str, str]

    @property
    def correct(self) -> int:
        return list(self.states.values()).count("correct")


@dataclass(frozen=True)
class Passed:
    """The `Row` of every notebook with exercises; shows itself as a table.

    >>> Passed([Row("01_column.ipynb", {"01.1": "correct", "01.2": "not yet"})])
    01_column.ipynb  + -  1 of 2
    1 of 2 exercises correct (+ correct, - not yet, . not answered, o noted, blank: not run)
    """

    rows: Sequence[Row]

    @property
    def correct(self) -> int:
        """How many exercises are correct."""
        return sum(row.correct for row in self.rows)

    @property
    def total(self) -> int:
        """How many there are."""
        return sum(len(row.states) for row in self.rows)

    def __str__(self) -> str:
        width = max(len(row.file) for row in self.rows)
        marks = max(len(row.states) for row in self.rows)
        lines = [f"{row.file:<{width}}  {' '.join(MARKS[state] for state in row.states.values()):<{2 * marks - 1}}  "
                 f"{row.correct} of {len(row.states)}" for row in self.rows]
        return "\n".join([*lines, f"{self.correct} of {self.total} exercises correct ({KEY})"])

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>"


@ByKeyword
def Overview(folder: str | Path) -> Passed:
    """What the checker said of every exercise in the notebooks of a folder, those of its folders too, as they were last saved.

    With a folder for each student it is the overview of a class.  It is read, not computed: what counts is graded anew.

    Raises ProblemError if there is no folder, no notebook with exercises in it, or a file that is no notebook.

    >>> Overview("nowhere")
    Traceback (most recent call last):
    ...
    ngdgc.exceptions.ProblemError: there is no folder 'nowhere'; give the one that holds the notebooks
    """
    path = Path(folder)
    if not path.is_dir():
        raise ProblemError(f"there is no folder {str(folder)!r}; give the one that holds the notebooks")
    files = sorted(file for file in path.rglob("*.ipynb") if ".ipynb_checkpoints" not in file.parts)
    rows = [Row(str(file.relative_to(path)), states) for file in files if (states := dict(_States(file)))]
    if not rows:
        raise ProblemError(f"no notebook in {str(folder)!r} has exercises; give the folder that holds the notebooks, saved")
    return Passed(rows)


def _States(file: Path) -> Iterator[tuple[str, str]]:
    """(exercise, state) of the cells of a notebook that ask the checker."""
    try:
        cells = json.loads(file.read_text(encoding="utf-8"))["cells"]
    except (ValueError, KeyError, TypeError) as error:
        raise ProblemError(f"{file} is no notebook; save it again in Jupyter, or take it out of the folder") from error
    for cell in cells:
        asked = ASKED.search("".join(cell["source"]))
        if cell["cell_type"] == "code" and asked:
            yield asked[1], _State(asked[1], cell.get("outputs", ()))


def _State(name: str, outputs: Sequence[Mapping[str, Any]]) -> str:
    text = "".join("".join(output.get("data", {}).get("text/plain", "")) for output in outputs)
    return next((state for state in MARKS if text.startswith(f"{name}: {state}.")), "not run")
