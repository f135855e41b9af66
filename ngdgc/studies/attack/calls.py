"""Public names called with wrong, extreme and hostile values: a solution, a value, or one clear error must come of it."""

from __future__ import annotations

import inspect
import io
import multiprocessing
import os
import tempfile
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterable
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from pathlib import Path
from time import perf_counter
from typing import IO, Any

import numpy as np
from ngsolve import Mesh

from ...exact import Exact
from ...exceptions import NotConvergedError, ProblemError, SolveInterrupted
from ...problem.foundation import Foundation
from ...problem.laws import ComplianceLaw, FrictionLaw
from ...problem.materials import AnisotropicMaterial, HookeMaterial
from ...problem.problem import ContactProblem
from ...solution.solution import ContactSolution
from ...tools.kinds import Short
from ..records import Recorded
from .targets import CONTRACTS, NEEDED, SIGNATURES, Parameters, Public, Setting
from .values import Hostile, Spoiled

WRONG = 0.6         # part of the calls with something hostile in them; the others are right, with numbers of many types
MISSHAPEN = 0.1     # part of those whose arguments are misplaced or misnamed
GIVEN = 0.5         # part of the optional arguments that are given
LARGE = 200         # elements of a mesh up to which something is solved on it
LIMIT = 60          # seconds for one call, with all that is made for it
TOLD = {ProblemError: "problem", NotConvergedError: "not converged", SolveInterrupted: "interrupted"}
ENDS = ("solution", "value", *TOLD.values())


@dataclass(frozen=True)
class Record:
    """What came of one call.

    outcome : one of ENDS, "ended" or "hung" for the process, or the type of an exception that should not have come
    detail : of an error its message, of one that should not have come the place as well
    """

    number: int
    name: str
    words: str
    outcome: str
    detail: str = ""
    seconds: float = 0.0

    @property
    def fault(self) -> bool:
        return self.outcome not in ENDS


class Call:
    """The call of this number in the sequence of a seed: `words` say what it is, `Make()` makes it."""

    def __init__(self, seed: int, number: int, folder: Path) -> None:
        self.rng, names = np.random.default_rng([seed, number]), Public()
        turn, place = divmod(number, len(names))        # each turn calls all of them
        self.name = list(names)[np.random.default_rng([seed, turn]).permutation(len(names))[place]]
        self.setting, self.words = Setting(self.rng, folder), self.name
        self._thing, self._member = names[self.name]

    def Make(self) -> str:
        """"solution" if a converged one came out, or was made with what came out, else "value"."""
        setting, function = self.setting, self._thing
        if self._member:
            of = setting.Object(self._thing)
            if not callable(getattr(self._thing, self._member)):
                return self._Used(getattr(of, self._member))
            function = getattr(of, self._member)
        arguments, keywords = self._Arguments(function)
        self.words = f"{self.name}({', '.join([*map(Short, arguments), *(f'{k}={Short(v)}' for k, v in keywords.items())])})"
        return self._Used(function(*arguments, **keywords))

    def _Arguments(self, function: Callable[..., Any]) -> tuple[list[Any], dict[str, Any]]:
        """(positional, keywords) of the call, hostile or not."""
        rng, setting, owner = self.rng, self.setting, self._member or self.name
        arguments: list[Any] = []
        keywords: dict[str, Any] = {}
        for one in Parameters(self.name, function):
            if one.default is not one.empty and rng.random() > GIVEN and one.name not in NEEDED.get(self.name, ()):
                continue
            value = setting.Of(one.name, owner)
            if one.kind is one.VAR_POSITIONAL:
                arguments += value
            elif one.kind is one.KEYWORD_ONLY or keywords or one.default is not one.empty:
                keywords[one.name] = value
            else:
                arguments.append(value)
        if self.name in SIGNATURES or owner in CONTRACTS or rng.random() > WRONG:
            return arguments, keywords
        if rng.random() < MISSHAPEN:
            return self._Misshapen(arguments, keywords)
        for place in rng.permutation(len(arguments) + len(keywords))[:rng.integers(1, 3)]:
            if place < len(arguments):
                arguments[place] = Spoiled(arguments[place], rng, setting.mesh)
            else:
                name = list(keywords)[place - len(arguments)]
                keywords[name] = Spoiled(keywords[name], rng, setting.mesh)
                if name == "callback" and callable(keywords[name]):
                    keywords[name] = "print"    # whatever a callback raises is whose it is
        return arguments, keywords

    def _Misshapen(self, arguments: list[Any], keywords: dict[str, Any]) -> tuple[list[Any], dict[str, Any]]:
        kind = self.rng.integers(4)
        if kind == 0:
            return [*arguments, *keywords.values(), Hostile(self.rng, self.setting.mesh)], {}
        if kind == 1:
            return arguments[1:], keywords
        if kind == 2:
            return arguments, {f"{name}x": value for name, value in keywords.items()} or {"nobody": 1}
        return [], keywords

    def _Used(self, result: Any) -> str:
        """What came out, put into a problem and solved."""
        setting = self.setting
        solution = self._Solved(result)
        if isinstance(solution, list):
            solution = solution[0] if solution and isinstance(solution[0], ContactSolution) else None
        if not isinstance(solution, ContactSolution):
            solution = vars(setting).get("solution") or (vars(setting)["disc"].Solve() if "disc" in vars(setting) else None)
        return "solution" if solution is not None and solution.converged is True else "value"

    def _Solved(self, result: Any) -> Any:
        setting, problem = self.setting, None
        if isinstance(result, Mesh):
            fits = result.ne <= LARGE and {"top", "bottom"} <= set(result.GetBoundaries()) and result.dim == setting.dim
            return setting.Discretization(mesh=result).Solve() if fits else None
        if isinstance(result, ContactProblem):
            problem = result
        elif isinstance(result, (HookeMaterial, AnisotropicMaterial)):
            problem = replace(setting.problem, material=result)
        elif isinstance(result, Foundation):
            problem = replace(setting.problem, foundation=result)
        elif isinstance(result, ComplianceLaw):
            problem = replace(setting.problem, foundation=Foundation("bottom", result))
        elif isinstance(result, FrictionLaw):
            problem = replace(setting.problem, foundation=Foundation("bottom", setting.compliance, friction=result))
        elif isinstance(result, Exact):
            problem = result.problem
        if problem is not None:
            return setting.Discretization(problem=problem).Solve()
        if hasattr(result, "Form") and hasattr(result, "Space"):
            return setting.Discretization(method=result).Solve()
        if hasattr(result, "Solve"):
            # An inverse solves for a load, and has nothing to do with contact.
            takes = "space" if hasattr(result, "space") else [*inspect.signature(result.Solve).parameters][0]
            return {"space": result.Solve, "disc": lambda: result.Solve(setting.disc)}.get(takes, lambda: result)()
        return result


def Attempt(seed: int, number: int) -> Record:
    """Make one call, in a folder of its own that is the current one, and record what came of it."""
    start, here = perf_counter(), os.getcwd()
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings(), redirect_stdout(io.StringIO()), redirect_stderr(
            io.StringIO()):
        warnings.simplefilter("ignore")
        os.chdir(folder)
        call = Call(seed, number, Path(folder))
        try:
            outcome, detail = call.Make(), ""
        except BaseException as error:
            outcome, detail = TOLD.get(type(error), type(error).__name__), " ".join(str(error).split())
            if outcome not in ENDS:
                last = traceback.extract_tb(error.__traceback__)[-1]
                detail += f" ({Path(last.filename).name}:{last.lineno})"
        finally:
            os.chdir(here)
    return Record(number, call.name, call.words, outcome, detail, perf_counter() - start)


def _Serve(connection: Connection, seed: int, Make: Callable[[int, int], Record]) -> None:
    """What a process does: the calls whose numbers come."""
    while True:
        connection.send(Make(seed, connection.recv()))


class _Process:
    """A process that makes calls, and another one after it has ended or hung."""

    def __init__(self, seed: int, Make: Callable[[int, int], Record]) -> None:
        self.seed, self.Make = seed, Make
        self._Start()

    def _Start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.connection, theirs = context.Pipe()
        self.process = context.Process(target=_Serve, args=(theirs, self.seed, self.Make), daemon=True)
        self.process.start()
        theirs.close()

    def Attempt(self, number: int, limit: float) -> Record:
        name = Call(self.seed, number, Path(".")).name
        try:
            self.connection.send(number)
            if self.connection.poll(limit):
                return self.connection.recv()
            outcome, detail = "hung", f"longer than {limit} s"
        except (EOFError, ConnectionError):
            self.process.join()
            outcome, detail = "ended", f"exit code {self.process.exitcode}"
        self.Close()
        self._Start()
        return Record(number, name, name, outcome, detail, limit if outcome == "hung" else 0.0)

    def Close(self) -> None:
        self.process.kill()
        self.process.join()
        self.connection.close()


def Attack(seed: int, numbers: Iterable[int], file: IO[str], *, limit: float = LIMIT,
           callback: Callable[[Record], object] | None = None, Make: Callable[[int, int], Record] = Attempt) -> list[Record]:
    """The Records of the calls of these numbers in the sequence of a seed, each a line of the file as soon as it is there.

    `Make(seed, number)` makes one, in a process of its own, so that one that ends or hangs is noticed; Ctrl-C returns what is
    there.
    """
    process = _Process(seed, Make)
    try:
        return Recorded((process.Attempt(number, limit) for number in numbers), file, callback)
    finally:
        process.Close()


def Tally(records: list[Record]) -> str:
    """What to say about the records: how they ended, which should not have, which names were not called, the slowest."""
    counts, called = Counter(record.outcome for record in records), {record.name for record in records}
    faults, slow = [record for record in records if record.fault], sorted(records, key=lambda record: -record.seconds)[:5]
    missing = [name for name in Public() if name not in called]
    lines = [f"{len(records)} calls of {len(called)} public names: " + ", ".join(f"{count} {name}" for name, count in
                                                                               counts.most_common()),
             f"with a solution: {100 * counts['solution'] / max(len(records), 1):.0f} %",
             "names not called: " + (", ".join(missing) or "none"),
             "slowest: " + "; ".join(f"{record.number} {record.name} {record.seconds:.1f} s" for record in slow)]
    return "\n".join([*lines, f"faults: {len(faults)}", *map(Line, faults)])


def Line(record: Record) -> str:
    """One line for the terminal."""
    words = f"{record.number}: {record.words}: {record.outcome}"
    return f"FAULT {words}: {record.detail}" if record.fault else words
