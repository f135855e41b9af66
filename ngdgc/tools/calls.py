"""Calls of public classes and functions: an argument that is missing, misspelt or given by position is named."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

from .failures import Failure, ProblemError
from .kinds import Mistaken, Short
from .names import Meant

Public = TypeVar("Public")


def ByKeyword(thing: Public) -> Public:
    """Decorator of a public class or function: calls with other arguments than it has raise ProblemError, which names them.

    Of a class its constructor and public methods; signatures, docstrings and types stay what they are.

    >>> from ngdgc import HookeMaterial
    >>> HookeMaterial(2000, 0.3)
    Traceback (most recent call last):
    ...
    ngdgc.exceptions.ProblemError: HookeMaterial(...): 2000, 0.3 by position; its arguments are given by name: E=2000, nu=0.3
    """
    if not inspect.isclass(thing):
        return _Told(thing)
    for name, member in list(vars(thing).items()):
        if name.startswith("_") and name != "__init__":
            continue
        if isinstance(member, (classmethod, staticmethod)):
            setattr(thing, name, type(member)(_Told(member.__func__)))
        elif inspect.isfunction(member):
            setattr(thing, name, _Told(member))
    return thing


def _Told(function: Any) -> Any:
    @wraps(function)
    def Call(*arguments: Any, **keywords: Any) -> Any:
        try:
            return function(*arguments, **keywords)
        except Failure:
            raise
        except Exception as error:
            if words := _Cause(error, function, arguments, keywords):
                raise ProblemError(words) from error
            raise
    return Call


def _Cause(error: Exception, function: Callable[..., Any], arguments: tuple[Any, ...], keywords: dict[str, Any]) -> str | None:
    """Words for arguments that do not fit the signature, or one of the wrong kind; None if a call has failed otherwise."""
    try:
        given = inspect.signature(function).bind(*arguments, **keywords).arguments
    except TypeError:
        return _Mistake(function, arguments, keywords)
    if isinstance(error, OSError) and (path := given.get("path", given.get("folder"))) is not None:
        return f"{path} cannot be written: {error.strerror or error}; choose another file or folder"
    return next((words for name, value in given.items() if (words := Mistaken(name, value))), None)


def _Mistake(function: Callable[..., Any], arguments: tuple[Any, ...], keywords: dict[str, Any]) -> str:
    """What is wrong with a call that does not fit the signature."""
    parameters = list(inspect.signature(function).parameters.values())
    owner, _, name = function.__qualname__.rpartition(".")
    if owner and parameters and parameters[0].name in ("self", "cls"):
        if name == "__init__":      # which a subclass may have inherited
            name = type(arguments[0]).__name__
        parameters, arguments = parameters[1:], arguments[1:]
    words = f"{name}(...)"
    known = [parameter.name for parameter in parameters if parameter.kind is not parameter.VAR_POSITIONAL]
    for keyword in keywords:
        if keyword not in known:
            remedy = f"choose among {', '.join(known)}" if known else "leave it out"
            return f"{words}: there is no argument {keyword!r}; {remedy}{Meant(keyword, known)}"
    positional = [p.name for p in parameters if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    several = positional[:len(arguments)]
    if twice := [name for name in several if name in keywords]:
        return f"{words}: {twice[0]} is given twice, by position and by name; give it once"
    if extra := arguments[len(positional):]:
        free = [name for name in known if name not in positional and name not in keywords]
        if len(extra) > len(free):
            return (f"{words}: {len(arguments)} by position are too many; it takes {', '.join(known) or 'none'}, leave out the "
                    "rest")
        given = ", ".join(f"{name}={Short(value)}" for name, value in zip(free, extra))
        return (f"{words}: {', '.join(map(Short, extra))} by position; its arguments are given by name: {given}"
                if not positional else f"{words}: {', '.join(map(Short, extra))} by position; give it by name: {given}")
    missing = [p.name for p in parameters if p.default is p.empty and p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)
               and p.name not in several and p.name not in keywords]
    return f"{words}: {', '.join(missing)} missing; give {', '.join(f'{name}=...' for name in missing)}"
