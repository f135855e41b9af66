"""Names that users type: found in whatever case they are written, and what was meant where they are not found."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any

from .failures import ProblemError


def Meant(name: str, known: Iterable[str]) -> str:
    """A question to end a message with, or nothing if no known name is near.

    >>> Meant("exmaple_4_1", ["example_4_1", "hertz_line"])
    " (did you mean 'example_4_1'?)"
    >>> Meant("sphere", ["example_4_1", "hertz_line"])
    ''
    """
    plain = {one.lower(): one for one in known}
    near = get_close_matches(name.lower(), plain, n=1)
    return f" (did you mean {plain[near[0]]!r}?)" if near else ""


def Known(name: str, known: Iterable[str], *, what: str, choose: str = "choose one of") -> str:
    """The known name that is meant, in whatever case it is written; ProblemError if there is none.

    >>> Known("LDG", ["ip", "ldg"], what="method")
    'ldg'
    """
    known = tuple(known)
    for one in known:
        if one.lower() == name.lower():
            return one
    raise ProblemError(f"no {what} {name!r}; {choose} {', '.join(known)}{Meant(name, known)}")


def NameOf(thing: Any) -> str:
    """The name of an object: its own, that of a function or class, or that of its class.

    >>> NameOf(NameOf), NameOf(3)
    ('NameOf', 'int')
    """
    name = getattr(thing, "name", None)
    return name if isinstance(name, str) else getattr(thing, "__name__", type(thing).__name__)
