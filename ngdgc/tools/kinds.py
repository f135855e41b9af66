"""What a parameter of a public name takes, by its name: looked at after a call has failed, to say whether that is why."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from ngsolve import CoefficientFunction


def _Is(*classes: str) -> Callable[[Any], bool]:
    """Is a value of one of these classes?  By their names: they are defined on top of this module."""
    return lambda value: any(base.__name__ in classes for base in type(value).__mro__)


def _Numbers(value: Any) -> bool:
    try:
        return np.asarray(value).dtype.kind in "fiu"
    except ValueError:      # rows of different lengths
        return False


def _Array(value: Any) -> bool:
    """A list is none: -[0.1] is nothing, and 2 * [0.1] another list.  Nor is an integer that numpy makes none of its own of."""
    huge = isinstance(value, int) and abs(value) >= 2 ** 63
    return not isinstance(value, (list, tuple)) and not huge and _Numbers(value)


def _Matrix(value: Any) -> bool:
    return len(getattr(value, "dims", ())) == 2


def _Path(value: Any) -> bool:
    return isinstance(value, (str, os.PathLike)) and "\0" not in str(value)


def _Evaluated(value: Any) -> bool:
    """False for a law of the package with data that are functions."""
    return not hasattr(value, "CheckData") or not any(isinstance(one, CoefficientFunction) for one in vars(value).values())


FUNCTION = _Is("CoefficientFunction"), "give a CoefficientFunction with d components"
MATRIX = _Matrix, "give a CoefficientFunction with d x d components"
NUMBERS = _Numbers, "give real numbers, an array such as a ContactSolution has"
ARRAY = _Array, NUMBERS[1]
PATH = _Path, "give the name of a file or folder"
# {parameter: (does a value fit?, what to give)}
KINDS: dict[str, tuple[Callable[[Any], bool], str]] = {
    "disc": (_Is("DiscreteProblem"), "give Discretization(problem, method, mesh, order=1), that of a solution is "
                                     "solution.disc"),
    "solution": (_Is("ContactSolution"), "give a ContactSolution, which Solve(disc) returns"),
    "problem": (_Is("ContactProblem"), "give a ContactProblem"),
    "material": (_Is("HookeMaterial", "AnisotropicMaterial"), "give a HookeMaterial or an AnisotropicMaterial"),
    "foundation": (_Is("Foundation"), "give a Foundation"),
    "compliance": (lambda value: hasattr(value, "Pressure"), "give a law such as NormalCompliance(stiffness=450)"),
    "wear": (lambda value: value is None or hasattr(value, "Depth"), "give a law such as ArchardWear(1e-6), or None"),
    "friction": (lambda value: value is None or hasattr(value, "Bound"), "give a law such as CoulombFriction(0.3), or None"),
    "method": (lambda value: hasattr(value, "Form"), "give a method, such as LDG() or Conforming()"),
    "mesh": (_Is("Mesh"), "give an ngsolve.Mesh, for example RectangleMesh(8)"),
    "points": (_Is("ndarray"), "give mesh points, an array that mesh.MapToAllElements(rule, VOL) returns"),
    "solutions": (lambda value: isinstance(value, (Mapping, list, tuple)), "give ContactSolutions, which Solve(disc) returns"),
    "self": (_Evaluated, "its data are CoefficientFunctions, with values at points of a mesh only: take the law in "
                         "Discretization(...).contact.parts"),
    **dict.fromkeys(("displacement", "u"), FUNCTION), **dict.fromkeys(("stress", "strain"), MATRIX),
    **dict.fromkeys(("r", "p", "slip", "load", "vector", "traction", "functional", "penetration", "origin", "slid", "worn"),
                    ARRAY),
    **dict.fromkeys(("errors", "ratio"), NUMBERS),
    **dict.fromkeys(("history", "levels"), (lambda value: isinstance(value, (list, tuple)), "give a list, such as that of a "
                                            "ContactSolution")),
    **dict.fromkeys(("path", "folder"), PATH)}


def Mistaken(name: str, value: Any) -> str | None:
    """Words for an argument that is of no kind that its parameter takes, or None."""
    Fits, remedy = KINDS.get(name, (None, ""))
    if Fits is None or Fits(value):
        return None
    return f"{type(value).__name__ if name == 'self' else name} is {Short(value)}; {remedy}"


def Short(value: Any) -> str:
    """`repr` in one short line."""
    words = " ".join(repr(value).split())
    return words if len(words) <= 60 else words[:57] + "..."
