"""Exercises of the notebooks, and the checker that grades answers: Check("01.1", answer)."""

from ..exceptions import ProblemError
from . import fluxes, iteration, law, liftings, locking, newton, rigid, spaces, table, winkler
from .checker import Grade

EXERCISES = {name: exercise for module in (winkler, spaces, fluxes, liftings, iteration, newton, table, rigid, locking, law)
             for name, exercise in module.EXERCISES.items()}


def Check(exercise, answer):
    """The `checker.Verdict` on an answer to an exercise, named as in its notebook; `...` is no answer yet.

    A verdict shows itself in a notebook and is true if the answer is correct; if not, its words hint at the kind of mistake.

    Raises ProblemError for an exercise that does not exist.

    >>> Check("01.4", ("a", 1))
    01.4: not yet. Cut the column free just above the soil: which force must the soil balance?
    """
    if exercise not in EXERCISES:
        raise ProblemError(f"no exercise {exercise!r}; there are {', '.join(EXERCISES)}")
    return Grade(exercise, EXERCISES[exercise], answer)
