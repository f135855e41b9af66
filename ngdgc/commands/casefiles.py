"""Cases: the files that come with the package, and those of users."""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

from ..exceptions import ProblemError
from ..tools.names import Meant
from ..tools.tables import Aligned


def CaseFiles() -> dict[str, Path]:
    """The cases installed with the package, {name: path}."""
    folder = importlib.import_module("ngdgc.cases").__path__[0]
    return {path.stem: path for path in sorted(Path(folder).glob("*.py")) if not path.stem.startswith("_")}


def LoadCase(name: str) -> ModuleType:
    """The module of a case, from a file or by the name of an installed one; ProblemError if there is none."""
    path = Path(name) if Path(name).is_file() else CaseFiles().get(name.lower())
    if path is None:
        raise ProblemError(f"no case {name!r}: neither a file nor one of {', '.join(CaseFiles())}; give one of them "
                           f"or a file{Meant(Path(name).stem, CaseFiles())}")
    spec = importlib.util.spec_from_file_location(f"ngdgc_case_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise ProblemError(f"{name} is not a Python file; give one whose name ends in .py")
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise ProblemError(f"{name} cannot be loaded: {type(error).__name__}: {error}; mend the file") from error
    if not callable(getattr(module, "Main", None)):
        raise ProblemError(f"{name} has no function Main(method=..., order=..., n=...); write it, or give another case")
    return module


def CaseParts(case: ModuleType, name: str) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """The functions Problem and Mesh of a case; ProblemError if it has none."""
    if not (callable(getattr(case, "Problem", None)) and callable(getattr(case, "Mesh", None))):
        raise ProblemError(f"{name} has no functions Problem() and Mesh(n); write them, or give another case")
    return case.Problem, case.Mesh


def Compared(values: list[tuple[str, float, float]]) -> str:
    """A table of what `Compare(solution)` of a case returns: (quantity with unit, computed, expected)."""
    rows = [("", "computed", "expected", "difference")]
    for quantity, computed, expected in values:
        difference = f"{100 * (computed / expected - 1):+.2g} %" if expected else f"{computed - expected:.2g}"
        rows.append((quantity, f"{computed:.6g}", f"{expected:.6g}", difference))
    return "\n".join(Aligned(rows, numbers=True)) + "\n"
