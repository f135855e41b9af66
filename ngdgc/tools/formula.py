"""CoefficientFunctions as one writes them, and objects that hold some: what `repr` shows."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields
from functools import lru_cache
from typing import Any

import numpy as np
from ngsolve import CoefficientFunction

LONGEST = 70        # letters of a formula; longer ones are not read
SUM, PRODUCT, ATOM = range(3)   # how tightly a formula holds together
LEVELS = {"+": SUM, "-": SUM, "*": PRODUCT, "/": PRODUCT}


# What NGSolve prints, in a line, of functions made of numbers and coordinates alone.
PLAIN = re.compile(r"""coef\ |[-\d.e+]+\*\(|\)|(unary|binary)\ operation\ '[^']*'|coordinate\ [xyz]|scale\ |
                       (Vectorial|Component)(?=Coef)|Zero(CF)?|CoefficientFunction|N5ngfem(24IfPos|23Norm)CoefficientFunctionE|
                       innerproduct,\ fix\ size\ =|(matrix|scalar)-(matrix|vector)\ multiply|Identity\ matrix|reshape|
                       subtensor\ \[\ first:|num:|dist:|[()\]]|(Matrix\ |tensor-)transpose(\ \[)?|symmetric|trace|
                       real|dims?\ ?=|[-\d.e+x]+|inf|nan|[,\s]""", re.VERBOSE)

# The same of a Parameter: alone, and as a part of something.
PARAMETER = re.compile(r"ParameterCF, val =|N5ngfem28ParameterCoefficientFunctionIdEE")


def Plain(function: Any) -> bool:
    """True if a CoefficientFunction is made of numbers and coordinates alone, which it is not if that cannot be told.

    >>> from ngsolve import CF, Parameter, x
    >>> Plain(CF((1, 2 * x))), Plain(CF((1, Parameter(2) * x)))
    (True, False)
    """
    # A large function repeats its lines: a derivative has hundreds of kinds in ten thousand.
    return all(map(_PlainLine, set(str(function).split("\n"))))


def Numeric(function: Any) -> bool:
    """The same with Parameters: True for what has one value at a point, whichever element it is seen from."""
    return all(map(_PlainLine, set(PARAMETER.sub("", str(function)).split("\n"))))


@lru_cache(4096)
def _PlainLine(line: str) -> bool:
    return not PLAIN.sub("", line)


def Formula(function: Any) -> str:
    """A CoefficientFunction as a formula, `CF(dim=2)` and the like for what is no short one.

    NGSolve prints the tree of its operations, a line for each, indented below the operation that takes it.

    >>> from ngsolve import CF, sin, x, y
    >>> Formula(CF((200 * (5 - y), -190))), Formula(sin(x) / 2 - y)
    ('(200*(5 - y), -190)', '0.5*sin(x) - y')
    """
    if str(function) == "ZeroCoefficientFunction":
        return "0" if function.dim == 1 else str((0,) * function.dim)
    text = re.sub(r"^(-?[\d.e+-]+)\*\((.*?)\n?\)$", r"coef scale \1\n\2", str(function).strip(), flags=re.S)
    first, *others = text.splitlines()
    if first.startswith("coef scale"):
        others = ["  " + line for line in others]
    try:
        formula, _ = _Read(iter(_Tree([first, *others])))
    except (LookupError, StopIteration, RecursionError):
        formula = "?" * (LONGEST + 1)
    return formula if len(formula) <= LONGEST else f"CF(dim={function.dim})" if function.dim > 1 else "CF(...)"


def _Tree(lines: Iterable[str]) -> Iterator[tuple[str, int]]:
    """(operation, number of its operands), depth first."""
    depths = [len(line) - len(line.lstrip()) for line in lines]
    for number, (line, depth) in enumerate(zip(lines, depths)):
        operands = 0
        for below in depths[number + 1:]:
            if below <= depth:
                break
            operands += below == depth + 2
        name = re.sub(r", (real|complex)(, dim=\d+)?$", "", line.strip())
        yield name.removeprefix("coef ").removeprefix("N5ngfem24"), operands


def _Read(tree: Iterator[tuple[str, int]]) -> tuple[str, int]:
    """(formula, level) of the next operation and its operands; LookupError for one that is not known."""
    name, count = next(tree)
    operands = [_Read(tree) for _ in range(count)]
    quoted = re.fullmatch(r"(unary|binary) operation '(.*)'", name)
    if re.fullmatch(r"coordinate [xyz]", name):
        return name[-1], ATOM
    if not count and re.fullmatch(r"-?[\d.]+(e[+-]?\d+)?", name):
        return name, PRODUCT if name.startswith("-") else ATOM
    if not count and name == "ZeroCF":
        return "0", ATOM
    if not count and name.startswith("ParameterCF, val = "):
        return f"Parameter({name.partition('= ')[2]})", ATOM
    if name.startswith("scale ") and count == 1:
        factor = name.partition(" ")[2]
        return ("-" if factor == "-1" else factor + "*") + _Inside(operands[0], PRODUCT), PRODUCT
    if name == "VectorialCoefficientFunction":
        return f"({', '.join(text for text, _ in operands)})", ATOM
    if name.startswith("IfPos"):
        return f"IfPos({', '.join(text for text, _ in operands)})", ATOM
    if quoted and count == 1:
        return operands[0] if quoted[2] == " " else (f"{quoted[2]}({operands[0][0]})", ATOM)
    if quoted and count == 2 and quoted[2] in LEVELS:
        level = LEVELS[quoted[2]]
        sign = f" {quoted[2]} " if level == SUM else quoted[2]
        # a - (b - c) and a/(b*c): the second operand must hold together more tightly.
        return _Inside(operands[0], level) + sign + _Inside(operands[1], level + (quoted[2] in "-/")), level
    raise LookupError(name)


def _Inside(operand: tuple[str, int], level: int) -> str:
    text, own = operand
    return text if own >= level else f"({text})"


def Described(self: Any, *names: str) -> str:
    """A `__repr__` for dataclasses: as they are written, with formulas, without what is None, False or empty.

    names : of the attributes that are shown, all fields by default

    >>> from ngsolve import x
    >>> from ngdgc import Foundation, NormalCompliance
    >>> Foundation("bottom", NormalCompliance(100 * (1 + x)))
    Foundation(boundary='bottom', compliance=NormalCompliance(stiffness=100*(x + 1), exponent=1), gap=0.0)
    """
    given = ((name, getattr(self, name)) for name in names or [field.name for field in fields(self) if field.repr])
    words = [f"{name}={_Value(value)}" for name, value in given if value is not None and not _Empty(value)]
    return f"{type(self).__name__}({', '.join(words)})"


def _Empty(value: Any) -> bool:
    return value is False or isinstance(value, (Mapping, tuple)) and not value


def _Value(value: Any) -> str:
    if isinstance(value, CoefficientFunction):
        return Formula(value)
    if isinstance(value, np.ndarray):
        return f"<{value.size} values from {value.min(initial=np.inf):g} to {value.max(initial=-np.inf):g}>"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key!r}: {_Value(entry)}" for key, entry in value.items()) + "}"
    return repr(value)
