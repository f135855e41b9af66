"""Units of length and stress: words of figures and reports in those of a problem."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar, cast

from .failures import ProblemError
from .names import Meant

LENGTHS = ("m", "mm", "cm", "km", "µm", "um", "in", "ft")
STRESSES = ("Pa", "kPa", "MPa", "GPa", "N/mm^2", "daN/mm^2", "N/m^2", "kN/m^2", "MN/m^2", "bar", "psi", "ksi")
# Of stress length^2, where there is a name for it.
FORCES = {("m", "Pa"): "N", ("m", "N/m^2"): "N", ("mm", "MPa"): "N", ("mm", "N/mm^2"): "N", ("mm", "daN/mm^2"): "daN",
          ("m", "kPa"): "kN", ("m", "kN/m^2"): "kN", ("mm", "GPa"): "kN", ("m", "MPa"): "MN", ("m", "MN/m^2"): "MN",
          ("m", "GPa"): "GN", ("in", "psi"): "lbf", ("in", "ksi"): "kip"}
BRACKETS = re.compile(r" *\[([^][]*\b(?:length|stress)\b[^][]*)\]")
PRODUCT = re.compile(r"stress length(?:\^(\d))?")
Units = tuple[str, str]
Making = TypeVar("Making", bound=Callable[..., Any])


def CheckUnits(units: Any) -> Units | None:
    """(length, stress) as given, or None; ProblemError unless both are known.  Case counts: mPa would not be MPa."""
    if units is None:
        return None
    words = 'give those of length and stress of all data, such as units=("mm", "MPa")'
    if not isinstance(units, (tuple, list)) or len(units) != 2 or not all(isinstance(unit, str) for unit in units):
        raise ProblemError(f"units is {units!r}; {words}")
    for unit, known, kind in zip(units, (LENGTHS, STRESSES), ("length", "stress")):
        if unit not in known:
            raise ProblemError(f"no unit {unit!r} of {kind}; choose one of {', '.join(known)}{Meant(unit, known)}")
    return units[0], units[1]


def InUnits(text: str, units: Units | None, *, bare: bool = False) -> str:
    """A text whose [length], [stress], [stress length^2], ... are in units; `bare`: without units these words are left out.

    >>> InUnits("pressure [stress], force [stress length^2], s [length]", ("mm", "MPa"))
    'pressure [MPa], force [N], s [mm]'
    >>> InUnits("moment [stress length^2] in the plane", ("m", "psi"))
    'moment [psi m^2] in the plane'
    >>> InUnits("s [length]", None), InUnits("s [length]", None, bare=True)
    ('s [length]', 's')
    """
    if units is None:
        return BRACKETS.sub("", text) if bare else text
    length, stress = units

    def Product(found: re.Match[str]) -> str:
        power = int(found[1] or 1)
        if units not in FORCES:
            return f"{stress} {length}" + (f"^{power}" if power > 1 else "")
        return {1: f"{FORCES[units]}/{length}", 2: FORCES[units]}.get(power, f"{FORCES[units]} {length}" + (
            f"^{power - 2}" if power > 3 else ""))

    def Inside(found: re.Match[str]) -> str:
        words = PRODUCT.sub(Product, found[0])
        return re.sub(r"\bstress\b", stress, re.sub(r"\blength\b", length, words))
    return BRACKETS.sub(Inside, text)


def WithUnits(Make: Making) -> Making:
    """Decorator of a function that draws: all words of its figure are in the units of the problem of its first argument."""
    @wraps(Make)
    def Drawn(*arguments: Any, **keywords: Any) -> Any:
        figure = Make(*arguments, **keywords)
        units = UnitsOf(next(iter((*arguments, *keywords.values()))))
        if units is not None:
            for text in figure.findobj(lambda artist: hasattr(artist, "set_text") and hasattr(artist, "get_text")):
                words = text.get_text()
                if isinstance(words, str) and words != (new := InUnits(words, units)):
                    text.set_text(new)
        return figure
    return cast(Making, Drawn)


def UnitsOf(shown: Any) -> Units | None:
    """Of a solution, a discrete problem or a problem, or of the first of several; else None."""
    if isinstance(shown, dict):
        shown = next(iter(shown.values()), None)
    problem = getattr(getattr(shown, "disc", shown), "problem", shown)
    return getattr(problem, "units", None)
