"""Exercises of the notebooks, and the checker that grades answers: Check("01.1", answer).

Here: exercises, answers and hints, a module for each notebook.
Not here: the notebooks, which are documentation.
"""

from __future__ import annotations

from typing import Any

from ..exceptions import ProblemError
from . import estimates, fluxes, iteration, law, liftings, locking, newton, rigid, spaces, table, winkler
from .checker import Grade, Verdict

EXERCISES = {name: exercise for module in (winkler, spaces, fluxes, liftings, iteration, newton, table, rigid, locking, law,
                                             estimates)
             for name, exercise in module.EXERCISES.items()}


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
