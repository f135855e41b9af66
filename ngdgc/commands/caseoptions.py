"""The options of `ngdgc run` as keyword arguments for functions of a case."""

from __future__ import annotations

from argparse import Namespace
from typing import Any

from ..contracts import Solver
from ..exceptions import ProblemError
from ..methods.registry import METHODS, Options
from ..tools.names import Known
from .adaptive import Adaptive


def CaseArguments(options: Namespace, known: Any) -> dict[str, Any]:
    """Keyword arguments for the case's Main, or History; an option that the case does not know is an error."""
    chosen = Known(options.method, METHODS, what="method")
    row = METHODS[chosen]
    given = {name: getattr(options, name) for name, default in (("penalty", "auto"), ("form", "edge"))
             if getattr(options, name) != default}
    for name in given:
        if name not in Options(row):
            raise ProblemError(f"--{name} does not apply to method {chosen!r}; leave it out")
    arguments = {"method": row(**given), "solver": _Solver(options)}
    for name in ("order", "n", "plane", "cells"):
        value = getattr(options, name)
        if value is not None:
            if name not in known:
                function = "History" if options.history else "Main"
                raise ProblemError(f"--{name} does not apply to this case, whose {function} has no such keyword; leave it out")
            arguments[name] = value
    return arguments


def _Solver(options: Namespace) -> Solver:
    """The solver of the options; one that the solver does not know is an error."""
    from ..solvers import NestedNewtonSolver, SemismoothNewtonSolver, UzawaSolver

    known = {"auto": (NestedNewtonSolver, ()), "newton": (SemismoothNewtonSolver, ("maxiter",)),
             "uzawa": (UzawaSolver, ("maxiter", "rho"))}
    chosen = Known(options.solver, known, what="solver")
    solver, names = known[chosen]
    given = {name: getattr(options, name) for name in ("maxiter", "rho") if getattr(options, name) is not None}
    for name in given:
        if name not in names:
            raise ProblemError(f"--{name} does not apply to solver {chosen!r}; leave it out")
    if options.error is None:
        return solver(tol=options.tol, **given)
    if chosen != "auto":
        raise ProblemError(f"--error does not apply to solver {chosen!r}, which solves on one mesh; leave one of them out")
    return Adaptive(error=options.error, tol=options.tol)
