"""Exercises of the notebooks, and the checker that grades answers: Check("01.1", answer).

Here: exercises, answers and hints, a module for each notebook, and what a class needs of them.
Not here: the notebooks, which are documentation.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..exceptions import ProblemError
from ..tools.calls import ByKeyword
from .checker import Grade, Verdict
from .overview import Overview
from .sealed import Unseal

__all__ = ["EXERCISES", "Check", "Overview"]

SEALED = Path(__file__).with_name("sealed.bin")     # in a package of students, which has no `written`

if SEALED.exists():
    EXERCISES = Unseal(SEALED.read_bytes())
else:
    from .written import EXERCISES


@ByKeyword
def Check(exercise: Any, answer: Any) -> Verdict:
    """The `checker.Verdict` on an answer to an exercise, named as in its notebook (or "1.4" for "01.4"); `...` is no answer.

    A verdict shows itself in a notebook and is true if the answer is correct; if not, its words hint at the kind of mistake.

    Raises ProblemError for an exercise that does not exist.

    >>> Check("01.4", ("a", 1))
    01.4: not yet. Cut the column free just above the soil: which force must the soil balance?
    """
    text = exercise.strip().zfill(len("01.1")) if isinstance(exercise, str) else None
    if text is None or text not in EXERCISES:
        # 1.1 and 1.10 are the same number.
        advice = "" if isinstance(exercise, str) else '; give its name in quotes, such as "01.1"'
        raise ProblemError(f"no exercise {exercise!r}; there are {', '.join(EXERCISES)}{advice}")
    return Grade(text, EXERCISES[text], answer)
