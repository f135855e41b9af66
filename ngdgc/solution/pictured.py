"""What pictures are drawn of: the solution itself, or of one that is spread over processes its picture on a coarser mesh."""

from __future__ import annotations

from typing import Any

from .solution import CheckSolution, ContactSolution


def Pictured(solution: Any, name: str = "solution") -> ContactSolution:
    """The ContactSolution to draw; ProblemError unless one is given."""
    CheckSolution(solution, name)
    picture: ContactSolution = getattr(solution, "picture", solution)
    return picture
