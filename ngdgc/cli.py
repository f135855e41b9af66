"""The command `ngdgc`: run a case, or one of the studies."""

import argparse
import inspect
import sys
from pathlib import Path

from . import __version__
from .arguments import Finite, Folder, NumberOrAuto, Positive
from .benchcommands import AddBench
from .casefiles import CaseFiles, Compared, LoadCase
from .comparecommand import AddCompare
from .exceptions import NotConvergedError, ProblemError, SolveInterrupted
from .studies import AddStudies

EPILOG = """examples:
  ngdgc cases                                                  list the cases
  ngdgc run cases/example_4_1.py --method ip --n 16 --out results/
  ngdgc run example_4_2 --method h1 --order 2 --plane strain
  ngdgc compare example_4_2 --n 8                              one case by all methods, side by side
  ngdgc table3                                                 Table 3 of the paper beside ours
  ngdgc convergence --method all --order 1 2 --cells triangle  errors and orders on a smooth solution
  ngdgc locking                                                errors of nearly incompressible bodies
  ngdgc atlas --quick                                          what all solvers take, on a few small problems
  ngdgc bench --quick                                          what a solution costs, on a few small problems

exit codes: 0 solved, 1 not converged (what was computed is written), 2 wrong input, 130 interrupted"""


def Main(arguments=None):
    """Entry point; returns the exit code."""
    try:
        options = _Parser().parse_args(arguments)
        return options.command(options)
    except ProblemError as error:
        print(f"ngdgc: {error}", file=sys.stderr)
        return 2
    except NotConvergedError as error:
        print(f"ngdgc: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("ngdgc: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        sys.stderr.close()      # the reader of our output has gone, for example `| head`
        return 0


class _OneLine(argparse.ArgumentParser):
    """An argument parser whose errors are one line, without the usage."""

    def error(self, message):
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")


def _Parser():
    parser = _OneLine(prog="ngdgc", description="Discontinuous Galerkin methods for frictional contact with normal compliance.",
                      epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--version", action="version", version=f"ngdgc {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    _AddRun(commands)
    listing = commands.add_parser("cases", help="list the cases that come with the package")
    listing.set_defaults(command=ListCases)
    AddStudies(commands)
    AddBench(commands)
    AddCompare(commands)
    _AddStability(commands)
    return parser


def _AddStability(commands):
    stability = commands.add_parser("stability", help="critical penalties and the constants of the lemmas for a case",
                                    description="For all discontinuous methods: the critical penalty, what the element bound "
                                    "asks for, coercivity and boundedness with the automatic penalty, by sparse eigenvalues.")
    stability.add_argument("case", help="a file or the name of a case with Problem() and Mesh(n)")
    stability.add_argument("--form", default="edge", help="edge or lifting (default edge)")
    stability.add_argument("--order", type=Positive, default=1, help="polynomial degree (default 1)")
    stability.add_argument("--n", type=Positive, default=16, help="cells per side (default 16)")
    stability.set_defaults(command=Stability)


def _AddRun(commands):
    run = commands.add_parser("run", help="solve a case; write report, figures, HTML page and VTK",
                              description="Solve a case and write report, figures, an HTML page, a VTK file and the solution.")
    run.add_argument("case", help="a file such as cases/example_4_1.py, or the name of a case that comes with the package")
    run.add_argument("--method", default="ip", help="ip (interior penalty), bassi, brezzi, ldg, nipg, iipg "
                     "(unsymmetric interior penalty) or h1 (conforming); default ip")
    run.add_argument("--form", default="edge", help="edge or lifting form of a discontinuous method (default edge)")
    run.add_argument("--penalty", default="auto", type=NumberOrAuto, help="auto, or a number: for ip and ldg as in the "
                     "paper's eta = penalty mu order^2, for bassi and brezzi the factor of the lifting term")
    run.add_argument("--order", type=Positive, help="polynomial degree of the displacement (default: the case's own)")
    run.add_argument("--n", type=Positive, help="cells per side (default: the case's own)")
    run.add_argument("--plane", help="stress or strain (default: the case's own)")
    run.add_argument("--cells", help="triangle, triangle-flipped or quad (default: the case's own)")
    run.add_argument("--solver", default="auto", help="auto (Newton on nested meshes), newton (this mesh alone) or uzawa (the "
                     "paper's iteration); default auto")
    run.add_argument("--rho", type=NumberOrAuto, help="step of Uzawa's friction update: auto (default) or a number")
    run.add_argument("--tol", type=Finite, default=1e-10, help="relative tolerance of the iteration (default 1e-10)")
    run.add_argument("--maxiter", type=Positive, help="limit of iterations (default 10000 for uzawa, 100 for newton)")
    run.add_argument("--scale", type=Finite, default=1.0, help="factor of the displacement in the pictures (default 1, real)")
    run.add_argument("--out", default="results", help="folder for the results (default results/)")
    run.set_defaults(command=Run)


def ListCases(options):
    for name in CaseFiles():
        print(f"{name:<16}{(LoadCase(name).__doc__ or '').strip().splitlines()[0]}")
    return 0


def Run(options):
    """Solve the case and write everything about it."""
    from .output import Progress, WriteResults
    from .solution import ContactSolution

    case = LoadCase(options.case)
    arguments = _CaseArguments(case, options)
    folder = Folder(options.out)
    progress = Progress(sys.stdout)
    name = Path(options.case).stem
    print(f"{name}: {arguments['method']}")
    code, message = 0, None
    try:
        inspect.signature(case.Main).bind(callback=progress, **arguments)
    except TypeError as error:
        raise ProblemError(f"Main of {options.case} cannot be called: {error}; it needs the keywords method, order, "
                           "n, solver and callback") from error
    try:
        solution = case.Main(callback=progress, **arguments)
    except (NotConvergedError, SolveInterrupted) as stop:
        solution, message = stop.solution, str(stop)
        code = 1 if isinstance(stop, NotConvergedError) else 130
    progress.Close()
    if not isinstance(solution, ContactSolution):
        raise ProblemError(f"Main of {options.case} returned {type(solution).__name__}, not a "
                           "ContactSolution; let it return what the solver returns")
    try:
        written = WriteResults(solution, folder, scale=options.scale)
    except OSError as error:
        raise ProblemError(f"cannot write into {folder}: {error.strerror or error}; choose another --out") from error
    print((folder / "report.txt").read_text(encoding="utf-8"))
    if solution.converged and hasattr(case, "Compare"):
        print(Compared(case.Compare(solution)))
    print(f"written to {folder}/: {', '.join(written)}")
    if message:
        print(f"ngdgc: {message}", file=sys.stderr)
    return code


def Stability(options):
    """Print what the lemmas say about a case."""
    from .stabilitystudy import Study, Text

    case = LoadCase(options.case)
    if not (callable(getattr(case, "Problem", None)) and callable(getattr(case, "Mesh", None))):
        raise ProblemError(f"{options.case} has no functions Problem() and Mesh(n); write them, or give another case")
    print(Text(Study(case.Problem(), case.Mesh(options.n), order=options.order, form=options.form,
                     callback=lambda line: print(line, file=sys.stderr, flush=True))))
    return 0


def _CaseArguments(case, options):
    """Keyword arguments for the case's Main; an option that the case does not know is an error."""
    from .methods import METHODS

    if options.method not in METHODS:
        raise ProblemError(f"no method {options.method!r}; choose one of {', '.join(METHODS)}")
    row = METHODS[options.method]
    for name, default in (("penalty", "auto"), ("form", "edge")):
        if getattr(options, name) != default and not row.discontinuous:
            raise ProblemError(f"--{name} does not apply to method {options.method!r}; leave it out")
    method = row(penalty=options.penalty, form=options.form) if row.discontinuous else row()
    arguments = {"method": method, "solver": _Solver(options)}
    known = inspect.signature(case.Main).parameters
    for name in ("order", "n", "plane", "cells"):
        value = getattr(options, name)
        if value is not None:
            if name not in known:
                raise ProblemError(f"--{name} does not apply to this case, whose Main has no such keyword; leave it out")
            arguments[name] = value
    return arguments


def _Solver(options):
    """The solver of the options; one that the solver does not know is an error."""
    from .solvers import NestedNewtonSolver, SemismoothNewtonSolver, UzawaSolver

    known = {"auto": (NestedNewtonSolver, ()), "newton": (SemismoothNewtonSolver, ("maxiter",)),
             "uzawa": (UzawaSolver, ("maxiter", "rho"))}
    if options.solver not in known:
        raise ProblemError(f"no solver {options.solver!r}; choose one of {', '.join(known)}")
    solver, names = known[options.solver]
    given = {name: getattr(options, name) for name in ("maxiter", "rho") if getattr(options, name) is not None}
    for name in given:
        if name not in names:
            raise ProblemError(f"--{name} does not apply to solver {options.solver!r}; leave it out")
    return solver(tol=options.tol, **given)


if __name__ == "__main__":
    sys.exit(Main())
