"""Batches of numpy work on all processors: numpy gives up Python's lock inside its loops."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import cache, wraps
from itertools import islice
from typing import Any, Generic, TypeVar, cast

from threadpoolctl import ThreadpoolController

Item = TypeVar("Item")
Result = TypeVar("Result")
Action = TypeVar("Action", bound=Callable[..., Any])


@cache
def _Blas() -> Any:
    return ThreadpoolController().select(user_api="blas")


class Cached(Generic[Result]):
    """functools.cached_property without its lock, at which before Python 3.12 all threads wait for one, whatever the object."""

    def __init__(self, function: Callable[[Any], Result]) -> None:
        self._function, self.__doc__ = function, function.__doc__

    def __set_name__(self, owner: Any, name: str) -> None:
        self._name = name

    def __get__(self, instance: Any, owner: Any = None) -> Result:
        if instance is None:
            return cast(Result, self)
        value = self._function(instance)
        instance.__dict__[self._name] = value
        return value


def Batched(function: Action) -> Action:
    """Decorator: run with one BLAS thread.

    In batches of small matrices further ones wait for each other, ten times as long as the work takes on a busy machine.
    """
    @wraps(function)
    def Wrapped(*arguments: Any, **options: Any) -> Any:
        with _Blas().limit(limits=1):
            return function(*arguments, **options)
    return cast(Action, Wrapped)


def Map(function: Callable[[Item], Result], items: Iterable[Item], *, threads: bool) -> Iterator[Result]:
    """function(item) for each item, in order; with `threads` on all processors, only few results ahead of the consumer."""
    workers = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if not threads or workers < 2:
        yield from map(function, items)
        return
    items = iter(items)
    with ThreadPoolExecutor(workers) as pool:
        pending = deque(pool.submit(function, item) for item in islice(items, 2 * workers))
        while pending:
            yield pending.popleft().result()
            pending.extend(pool.submit(function, item) for item in islice(items, 1))
