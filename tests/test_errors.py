"""Every error of the library is raised and read: its message names the culprit, what was expected, and what to do."""

import ast
import inspect
import io
import re
from contextlib import redirect_stderr, redirect_stdout
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from mistakes.calls import CALLS
from mistakes.commands import COMMANDS
from mistakes.contracts import CONTRACTS
from mistakes.data import DATA
from mistakes.distributed import DISTRIBUTED
from mistakes.estimates import ESTIMATES
from mistakes.forces import FORCES
from mistakes.histories import HISTORIES
from mistakes.iterations import FAILURES
from mistakes.laws import LAWS
from mistakes.meshes import MESHES
from mistakes.problems import PROBLEMS
from mistakes.results import RESULTS
from mistakes.revolution import REVOLUTION
from mistakes.saved import SAVED
from mistakes.solvers import SOLVERS
from mistakes.studies import STUDIES

import ngdgc

PACKAGE = Path(ngdgc.__file__).parent
# Their exercises and files have tests of their own.
SOURCES = [path for path in PACKAGE.rglob("*.py") if path.relative_to(PACKAGE).parts[0] not in ("exercises", "cases")]
# Functions that make messages, or parts of them, of words.
MAKERS = ("Diagnose", "_Remedy", "remedies", "CheckLaw", "_Mistake")
ROWS = (CALLS + CONTRACTS + DATA + DISTRIBUTED + ESTIMATES + FORCES + HISTORIES + LAWS + MESHES + PROBLEMS + RESULTS
        + REVOLUTION + SAVED + SOLVERS + STUDIES + COMMANDS + FAILURES)


@cache
def Made(number):
    """(message, raise statements on the way) of a mistake: what the user reads, and {(module, line)}."""
    with TemporaryDirectory() as folder, redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()) as shown:
        try:
            ROWS[number][0](Path(folder))
        except BaseException as error:
            # The parser writes and exits; of the others the message is what the command writes, beside lines of progress.
            message = shown.getvalue() if isinstance(error, SystemExit) else str(error)
            return message, frozenset(Lines(error))
    raise AssertionError(f"no error where there should be one: {ROWS[number][1]}")


def Lines(error):
    """(module, line) of the package in the tracebacks of an error and of those that led to it."""
    while error is not None:
        trace = error.__traceback__
        while trace is not None:
            path = Path(trace.tb_frame.f_code.co_filename)
            if PACKAGE in path.parents:
                yield path.relative_to(PACKAGE).as_posix(), trace.tb_lineno
            trace = trace.tb_next
        error = error.__cause__ or error.__context__


def Sites(source):
    """(first line, last line, words) of the raise statements of a module that tell a user something, its words to find them by.

    A LookupError is what `formula` says to itself, a KeyboardInterrupt is handed on.
    """
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Raise) and node.exc is not None:
            words = ast.unparse(node)
            if "LookupError" not in words and "KeyboardInterrupt" not in words:
                yield node.lineno, node.end_lineno, words[:90]


def Phrases(source):
    """Literal pieces of at least three words in the functions that make messages."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef) and node.name in MAKERS:
            body = node.body[1:] if ast.get_docstring(node) else node.body
            for part in (part for statement in body for part in ast.walk(statement)):
                if isinstance(part, ast.Constant) and isinstance(part.value, str):
                    # What stands between the fields of `format`.
                    yield from (piece for piece in re.split(r"{.*?}", part.value) if len(piece.split()) >= 3)


def Unread(sources, lines, messages):
    """What is raised nowhere or read nowhere: words of raise statements and phrases, of {module: source}."""
    for module, source in sources.items():
        for first, last, words in Sites(source):
            if not any((module, line) in lines for line in range(first, last + 1)):
                yield f"{module}:{first} {words}"
        for phrase in Phrases(source):
            if not any(phrase in message for message in messages):
                yield f"{module}: {phrase!r}"


def Told(message, pattern):
    """Does a message contain culprit, expectation and remedy, the three parts of a pattern, in whatever order?"""
    return all(part.strip() in message for part in pattern.split(" | "))


@pytest.mark.slow
@pytest.mark.parametrize("number", range(len(ROWS)), ids=[pattern for _, pattern in ROWS])
def test_message_names_culprit_expectation_and_remedy(number):
    message, _ = Made(number)
    pattern = ROWS[number][1]
    assert pattern.count(" | ") == 2 and Told(message, pattern), message
    assert "Traceback" not in message and "\n" not in message.strip()


@pytest.mark.slow
def test_every_error_is_raised_and_read():
    found = [Made(number) for number in range(len(ROWS))]
    messages, lines = [message for message, _ in found], set().union(*(lines for _, lines in found))
    sources = {path.relative_to(PACKAGE).as_posix(): path.read_text(encoding="utf-8") for path in SOURCES}
    assert list(Unread(sources, lines, messages)) == []
    assert len(list(site for source in sources.values() for site in Sites(source))) > 150
    # An error that nobody makes, or a phrase that nobody reads, is found.
    new = "def Diagnose():\n    return 'nobody has read this'\n\n\ndef Check(n):\n    raise ProblemError(f'n is {n}')\n"
    assert len(list(Unread({"new.py": new}, lines, messages))) == 2
    assert list(Unread({"new.py": new}, {("new.py", 6)}, ["nobody has read this"])) == []


def test_control_a_message_without_a_part_is_refused():
    message, pattern = "tol is 2; give a number between 0 and 1", "tol is 2 | a number between 0 and 1 | give"
    assert Told(message, pattern)
    for part in pattern.split(" | "):
        assert not Told(message.replace(part, ""), pattern)


def test_every_error_is_a_problem_or_an_iteration_that_failed():
    """Raised by name: the errors of `exceptions`, argparse's own for one word, and what storage itself then reports."""
    kinds = {re.match(r"raise (\w+)", words)[1] for path in SOURCES for _, _, words in Sites(path.read_text(encoding="utf-8"))}
    assert kinds <= {"ProblemError", "NotConvergedError", "SolveInterrupted", "argparse", "FileNotFoundError", "_Missing",
                     "error", "failure"}
    assert issubclass(ngdgc.ProblemError, ValueError) and inspect.isclass(ngdgc.NotConvergedError)
