"""The command `ngdgc`: run a case, or one of the studies."""

from __future__ import annotations

import argparse
import inspect
import sys
from argparse import Action, Namespace
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from types import ModuleType
from typing import Any, NoReturn, cast

from . import __version__
from .commands.arguments import Commands, Finite, Natural, NumberOrAuto, Positive
from .commands.attack import AddAttack
from .commands.bench import AddBench
from .commands.casefiles import CaseFiles, CaseParts, Compared, LoadCase
from .commands.caseoptions import CaseArguments
from .commands.check import AddCheck
from .commands.compare import AddCompare
from .commands.console import Console
from .commands.effectivity import AddEffectivity
from .commands.files import Files
from .commands.meshfile import AddMesh
from .commands.newcase import AddNew
from .commands.progress import AddProgress
from .commands.signals import SIGNALS
from .commands.studies import AddStudies, Show
from .commands.sweeps import AddSweeps
from .exceptions import NotConvergedError, ProblemError, SolveInterrupted
from .methods.registry import MethodWords
from .solution.solution import ContactSolution
from .tools.names import Meant

EPILOG = """examples:
  ngdgc cases                                                  list the cases
  ngdgc new block.py                                           a case of your own, to be changed
  ngdgc check block.py                                         what it is, and how long it takes, before it is solved
  ngdgc mesh part.msh                                          what is in the file of a mesh
  ngdgc run cases/example_4_1.py --method ip --n 16 --out results/
  ngdgc run example_4_2 --method h1 --order 2 --plane strain
  ngdgc compare example_4_2 --n 8                              one case by all methods, side by side
  ngdgc table3                                                 Table 3 of the paper beside ours
  ngdgc convergence --method all --order 1 2 --cells triangle  errors and orders on a smooth solution
  ngdgc locking                                                errors of nearly incompressible bodies
  ngdgc atlas --quick                                          what all solvers take, on a few small problems
  ngdgc bench --quick                                          what a solution costs, on a few small problems

exit codes: 0 solved, 1 not converged, 2 wrong input, or something could not be written; stopped by Ctrl-C 130, by SIGTERM 143:
what was computed is written in any case, and a line says into which files"""

# What other software says instead of MemoryError: C++, NGSolve, the loader of libraries, Python of threads.
SCARCE = "bad_alloc", "Could not allocate", "failed to map segment", "start new thread"


def Main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; returns the exit code."""
    with SIGNALS.Ending() if arguments is None else nullcontext(), SIGNALS, Console() as console:
        try:
            return console.Code(_Code(arguments))
        except SystemExit as stop:      # of the parser: a mistake, or help
            stop.code = console.Code(cast(int, stop.code))
            raise


def _Code(arguments: Sequence[str] | None) -> int:
    """The exit code of a command; whatever ends it is one line."""
    try:
        options = _Parser().parse_args(arguments)
        return options.command(options)
    except ProblemError as error:
        code, message = 2, str(error)
    except NotConvergedError as error:
        code, message = 1, str(error)
    except KeyboardInterrupt:
        code, message = SIGNALS.code, SIGNALS.words
    except Exception as error:
        if SIGNALS.received is not None:
            # It came in the middle of other software, which made of it what it liked.
            code, message = SIGNALS.code, f"{SIGNALS.words} ({type(error).__name__}: {error})"
        elif isinstance(error, MemoryError) or any(words in str(error) for words in SCARCE):
            code, message = 2, "there is not enough memory; take a coarser mesh or a lower order"
        else:
            raise
    print(f"ngdgc: {message}", file=sys.stderr)
    return code


class _OneLine(argparse.ArgumentParser):
    """An argument parser whose errors are one line, without the usage, that points to its own help."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        # The parser of a command would hand what it does not know to the one above, whose help says nothing of it.
        namespace, unknown = super().parse_known_args(args, namespace)
        if unknown:
            options = [option for action in self._actions for option in action.option_strings]
            self.error(f"unrecognized arguments: {' '.join(unknown)}{Meant(unknown[0].partition('=')[0], options)}")
        return namespace, unknown

    def _check_value(self, action: Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            raise argparse.ArgumentError(action, f"invalid choice: {value!r}; choose one of {', '.join(action.choices)}"
                                         f"{Meant(value, action.choices)}")


def _Parser() -> _OneLine:
    parser = _OneLine(prog="ngdgc", description="Discontinuous Galerkin methods for frictional contact with normal compliance.",
                      epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--version", action="version", version=f"ngdgc {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    AddNew(commands)
    AddCheck(commands)
    _AddRun(commands)
    AddMesh(commands)
    listing = commands.add_parser("cases", help="list the cases that come with the package")
    listing.set_defaults(command=ListCases)
    AddStudies(commands)
    AddSweeps(commands)
    AddBench(commands)
    AddCompare(commands)
    AddAttack(commands)
    AddEffectivity(commands)
    AddProgress(commands)
    _AddStability(commands)
    return parser


def _AddStability(commands: Commands) -> None:
    stability = commands.add_parser("stability", help="critical penalties and the constants of the lemmas for a case",
                                    description="For all discontinuous methods: the critical penalty, what the element bound "
                                    "asks for, coercivity and boundedness with the automatic penalty, by sparse eigenvalues.")
    stability.add_argument("case", help="a file or the name of a case with Problem() and Mesh(n)")
    stability.add_argument("--form", type=str.lower, default="edge", help="edge or lifting (default edge)")
    stability.add_argument("--order", type=Positive, default=1, help="polynomial degree (default 1)")
    stability.add_argument("--n", type=Positive, default=16, help="cells per side (default 16)")
    stability.set_defaults(command=Stability)


def _AddRun(commands: Commands) -> None:
    run = commands.add_parser("run", help="solve a case; write report, figures, HTML page and VTK",
                              description="Solve a case and write report, figures, an HTML page, a VTK file and the solution.")
    run.add_argument("case", help="a file such as cases/example_4_1.py, or the name of a case that comes with the package")
    run.add_argument("--method", default="ip", help=f"{MethodWords()}; default ip")
    run.add_argument("--form", type=str.lower, default="edge", help="edge or lifting form of a discontinuous method (default "
                     "edge)")
    run.add_argument("--penalty", default="auto", type=NumberOrAuto, help="auto, or a number: for ip and ldg as in the "
                     "paper's eta = penalty mu order^2, for bassi and brezzi the factor of the lifting term")
    run.add_argument("--order", type=Positive, help="polynomial degree of the displacement (default: the case's own)")
    run.add_argument("--n", type=Positive, help="cells per side (default: the case's own)")
    run.add_argument("--refine", type=Natural, help="refine the mesh so often, spread over the processes of mpirun; needs "
                     "petsc4py, see the page 'Beyond one machine'")
    run.add_argument("--plane", type=str.lower, help="stress or strain (default: the case's own)")
    run.add_argument("--cells", type=str.lower, help="triangle, triangle-flipped or quad (default: the case's own)")
    run.add_argument("--solver", default="auto", help="auto (Newton on nested meshes), newton (this mesh alone) or uzawa (the "
                     "paper's iteration); default auto")
    run.add_argument("--rho", type=NumberOrAuto, help="step of Uzawa's friction update: auto (default) or a number")
    run.add_argument("--tol", type=Finite, default=1e-10, help="relative tolerance of the iteration (default 1e-10)")
    run.add_argument("--error", type=Finite, help="refine the mesh until its estimated error is at most this part of the "
                     "solution, in the energy norm: for example --n 4 --error 0.01")
    run.add_argument("--maxiter", type=Positive, help="limit of iterations (default 10000 for uzawa, 100 for newton)")
    run.add_argument("--scale", type=NumberOrAuto, default="auto", help="factor of the displacement in the pictures: 1 is "
                     "real, auto (default) enlarges it where it would not be seen")
    run.add_argument("--history", action="store_true", help="lead the case along its loads, History(...) in its file: forces, "
                     "energies, an animation, a time series, and all of the last state")
    run.add_argument("--out", default="results", help="folder for the results (default results/)")
    run.set_defaults(command=Run)


def ListCases(options: Namespace) -> int:
    width = max(map(len, CaseFiles())) + 2
    for name in CaseFiles():
        print(f"{name:<{width}}{(LoadCase(name).__doc__ or '').strip().splitlines()[0]}")
    return 0


def Run(options: Namespace) -> int:
    """Solve the case and write everything about it, also the last iterate of a solve that was stopped or failed."""
    from .commands.historyrun import RunHistory
    from .commands.output import DrawResults, Progress, SaveResults

    case = LoadCase(options.case)
    if options.refine is not None:
        from .commands.ranks import RunSpread

        return RunSpread(case, options)
    if options.history:
        return RunHistory(case, options)
    arguments = CaseArguments(options, inspect.signature(case.Main).parameters)
    with Files(options.out, "solution/", "report.json", "report.txt") as files:
        progress = Progress(sys.stdout)
        print(f"{Path(options.case).stem}: {arguments['method']}", flush=True)
        solution, code, message = _Solved(case, options.case, {"callback": progress, **arguments})
        progress.Close()
        if solution is not None:
            solution.case = Path(options.case).stem
            with SIGNALS.Held():
                try:
                    SaveResults(solution, files)
                finally:        # whatever could not be written
                    print(solution.Report(), flush=True)
            if solution.converged and hasattr(case, "Compare"):
                print(Compared(case.Compare(solution)), flush=True)
            DrawResults(solution, files, scale=options.scale)
    if message:
        print(f"ngdgc: {message}", file=sys.stderr)
    return code


def _Solved(case: ModuleType, name: str, arguments: dict[str, Any]) -> tuple[ContactSolution | None, int, str | None]:
    """(solution, exit code, message) of a case; the solution is None if it was stopped before there was one."""
    try:
        inspect.signature(case.Main).bind(**arguments)
    except TypeError as error:
        raise ProblemError(f"Main of {name} cannot be called: {error}; it needs the keywords method, order, n, solver and "
                           "callback") from error
    try:
        solution = case.Main(**arguments)
    except NotConvergedError as stop:
        return stop.solution, 1, str(stop)
    except SolveInterrupted as stop:
        return stop.solution, SIGNALS.code, f"{SIGNALS.words} after {len(stop.solution.history)} iterations"
    except KeyboardInterrupt:
        return None, SIGNALS.code, f"{SIGNALS.words} before the first iterate; there is nothing to write"
    if not isinstance(solution, ContactSolution):
        raise ProblemError(f"Main of {name} returned {type(solution).__name__}, not a ContactSolution; let it return what the "
                           "solver returns")
    return solution, 0, None


def Stability(options: Namespace) -> int:
    """Print what the lemmas say about a case, as far as it was computed also after Ctrl-C."""
    from .studies.stability import Constants, Study, Table, Text

    Problem, Mesh = CaseParts(LoadCase(options.case), options.case)
    rows: list[Constants] = []
    try:
        study = Study(Problem(), Mesh(options.n), order=options.order, form=options.form, rows=rows, callback=Show)
    except BaseException:
        if rows:
            print("\n".join(Table(rows)))
        raise
    print(Text(study))
    return 0


if __name__ == "__main__":
    sys.exit(Main())
