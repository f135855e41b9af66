"""What a history begins with: a Parameter that is its time, and perhaps the end of another history."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..discrete.problem import DiscreteProblem
from ..exceptions import ProblemError
from ..solution.fingerprint import Differs, Fingerprint
from ..solution.solution import ContactSolution
from .history import LoadHistory
from .recall import Recall
from .saved import CheckIsParameter


def CheckParameter(disc: DiscreteProblem, parameter: Any) -> None:
    """Raise ProblemError unless it is a Parameter on which data depend, and not the material."""
    CheckIsParameter(parameter)
    names = disc.state.Following(parameter)
    if material := [name for name in names if name.startswith("material")]:
        raise ProblemError(f"{material[0]} depends on the parameter; a history keeps its matrix: give the time to loads, "
                           "prescribed displacements, gaps and laws alone")
    if not names and not disc.added:
        raise ProblemError("parameter: no datum of the problem depends on it, all states would be the same; use it in "
                           "dirichlet, roller, traction, bodyforce, a gap or a law, dirichlet={'top': CF((0.03 * t, -0.02))}")


def CheckStart(start: Any, recall: Recall) -> None:
    """Raise ProblemError unless a LoadHistory has a last state that is one of the problem of `recall`."""
    if not isinstance(start, LoadHistory) or not len(start):
        raise ProblemError(f"start is {start!r}; give a LoadHistory with at least one state, which SolveHistory returns")
    disc, last = recall.disc, start.states[-1]
    if start.disc is disc:
        return
    if start.disc.space.ndof != disc.space.ndof or last.traction.shape != disc.contact.normals.shape:
        raise ProblemError(f"start is of {start.disc!r}, and this is {disc!r}; give the same mesh, method and order")
    old = start[-1]
    new = ContactSolution(recall.Disc(last), old.vector, old.traction)
    slip, numbering = old.disc.contact.Slip(old.displacement), np.arange(disc.space.ndof)
    tables = (Fingerprint(solution, old.penetration, slip, numbering) for solution in (old, new))
    for (name, stored), (_, found) in zip(*tables):
        if Differs(stored, found):
            raise ProblemError(f"start was computed with another problem: at time {last.time:g} its {name} differ; give the "
                               "problem, mesh and method that it was computed with")
