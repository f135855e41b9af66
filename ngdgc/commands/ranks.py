"""`ngdgc run CASE --refine r`, by one process or by all that mpirun has started: rank 0 prints, and writes what is one file."""

from __future__ import annotations

import inspect
import os
import sys
import time
from argparse import Namespace
from collections.abc import Callable
from contextlib import ExitStack, redirect_stdout
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

from ..discretization import Discretization
from ..distributed import DistributedMesh
from ..distributed.petsc import OnFirst, World
from ..exceptions import NotConvergedError, ProblemError
from .casefiles import CaseParts
from .caseoptions import CaseArguments
from .files import Files

PATIENCE = 10.0     # seconds after which a rank knows that it is alone with a failure
UNKNOWN = ("history", "error", "maxiter", "rho")


def RunSpread(case: ModuleType, options: Namespace) -> int:
    """Solve a case on its mesh, refined on the ranks; the exit code."""
    comm = World().Dup()    # no other messages go over it
    with ExitStack() as stack:
        if comm.rank:
            nowhere = stack.enter_context(open(os.devnull, "w", encoding="utf-8"))
            stack.enter_context(redirect_stdout(nowhere))
        try:
            return _Run(case, options)
        except (NotConvergedError, ProblemError) as error:
            if not _Alone(comm) and comm.rank:
                return 1 if isinstance(error, NotConvergedError) else 2     # rank 0 says it
            raise


def _Alone(comm: Any) -> bool:
    """Has this rank failed while the others go on?"""
    request, end = comm.Ibarrier(), time.perf_counter() + PATIENCE
    while not request.Test():
        if time.perf_counter() > end:
            return True
        time.sleep(0.01)
    return False


def CheckOptions(options: Namespace) -> None:
    """Raise ProblemError for an option that would be ignored."""
    given = [name for name in UNKNOWN if getattr(options, name)] + ["solver uzawa"] * (options.solver.lower() == "uzawa")
    if given:
        raise ProblemError(f"--{given[0]} does not go with --refine, which spreads the mesh over processes; leave one of them "
                           "out")


def _Called(Function: Callable[..., Any], **given: Any) -> Any:
    """A function of a case with those of the options that are given and that it knows."""
    known = inspect.signature(Function).parameters
    return Function(**{name: value for name, value in given.items() if value is not None and name in known})


def _Run(case: ModuleType, options: Namespace) -> int:
    from .output import Progress

    CheckOptions(options)
    known = inspect.signature(case.Main).parameters
    arguments = {name: known[name].default for name in ("order", "n") if name in known} | CaseArguments(options, known)
    Problem, Mesh = CaseParts(case, options.case)
    problem, order = _Called(Problem, plane=options.plane), arguments.get("order", 1)
    mesh = DistributedMesh(_Called(Mesh, n=arguments.get("n"), cells=options.cells), refine=options.refine)
    code, message, files = 0, None, Files(options.out, "solution/", "report.json", "report.txt")
    with ExitStack() as stack:
        OnFirst(mesh.comm, lambda: stack.enter_context(files) and None)
        progress = Progress(sys.stdout)
        print(f"{Path(options.case).stem}: {arguments['method']} on {mesh!r}", flush=True)
        try:
            solution = Discretization(problem, arguments["method"], mesh, order=order).Solve(tol=options.tol, callback=progress)
        except NotConvergedError as stop:
            solution, code, message = stop.solution, 1, str(stop)
        progress.Close()
        solution.case = Path(options.case).stem
        _Write(solution, files, options, mesh.comm)
        print(solution.Report(), flush=True)
        OnFirst(mesh.comm, stack.close)
    if message and mesh.comm.rank == 0:
        print(f"ngdgc: {message}", file=sys.stderr)
    return code


def _Write(solution: Any, files: Files, options: Namespace, comm: Any) -> None:
    """Solution and VTK by all ranks, the rest by the first one."""
    from ..export import WriteContactVTK, WriteVTK
    from .output import DrawFigures, SaveReport

    solution.Save(files.folder / "solution")
    OnFirst(comm, partial(SaveReport, solution, files))
    WriteVTK(solution, files.folder / "body.pvtu")
    WriteContactVTK(solution, files.folder / "contact.pvtu")
    OnFirst(comm, lambda: DrawFigures(solution.picture, files, scale=options.scale))
    files.written += ["solution/", "body.pvtu", "contact.pvtu"]
