"""Work on all processors, if other processes leave them: numpy gives up Python's lock inside its loops."""

from __future__ import annotations

import os
import sys
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager
from functools import cache, wraps
from itertools import islice
from typing import Any, Generic, TypeVar, cast

import psutil
from threadpoolctl import ThreadpoolController

# What processors spend their time with, as systems call it; "user" has that of guests in it.
BUSY = ("user", "nice", "system", "irq", "softirq", "steal", "interrupt", "dpc")
Item = TypeVar("Item")
Result = TypeVar("Result")
Action = TypeVar("Action", bound=Callable[..., Any])


@cache
def _Blas(scipy: bool) -> Any:
    """The libraries that are loaded, without that of scipy or with it."""
    return ThreadpoolController().select(user_api="blas")


def OneThread() -> AbstractContextManager[Any]:
    """BLAS in one thread, that of numpy and, if it is loaded already, the other one of scipy.linalg."""
    return cast(AbstractContextManager[Any], _Blas("scipy.linalg" in sys.modules).limit(limits=1))


def Processors() -> list[int]:
    """The numbers of the processors that this process may use."""
    return sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else list(range(os.cpu_count() or 1))


class Others:
    """How many of this process's processors others keep busy, measured from the times that the system counts anyway.

    Attributes
    ----------
    busy : between the last two measurements, at least LATELY seconds apart; 0 before there are two
    """

    LATELY = 0.25

    def __init__(self) -> None:
        self.busy = 0.0
        self._before = self._Times()

    def Measure(self) -> float:
        now = self._Times()
        elapsed, every, own = (b - a for a, b in zip(self._before, now))
        if elapsed >= self.LATELY:
            self.busy, self._before = max(every - own, 0.0) / elapsed, now
        return self.busy

    @staticmethod
    def _Times() -> tuple[float, float, float]:
        """(clock, busy time of the processors, processor time of this process) [s]."""
        mine, every = set(Processors()), psutil.cpu_times(percpu=True)
        busy = sum(getattr(times, name, 0.0) for number, times in enumerate(every) if number in mine for name in BUSY)
        return time.perf_counter(), busy, time.process_time()


@cache
def _Others() -> Others:
    return Others()


def Idle() -> bool:
    """True unless other processes have lately kept half a processor busy, of those that this one may use."""
    return _Others().Measure() < 0.5


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
        with OneThread():
            return function(*arguments, **options)
    return cast(Action, Wrapped)


def Map(function: Callable[[Item], Result], items: Iterable[Item], *, threads: bool) -> Iterator[Result]:
    """function(item) for each item, in order; with `threads` on all processors, only few results ahead of the consumer."""
    workers = len(Processors())
    if not threads or workers < 2:
        yield from map(function, items)
        return
    items = iter(items)
    with ThreadPoolExecutor(workers) as pool:
        pending = deque(pool.submit(function, item) for item in islice(items, 2 * workers))
        while pending:
            yield pending.popleft().result()
            pending.extend(pool.submit(function, item) for item in islice(items, 1))
