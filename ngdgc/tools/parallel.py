"""Batches of numpy work on all processors: numpy gives up Python's lock inside its loops."""

import os
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from functools import cache, wraps
from itertools import islice

from threadpoolctl import ThreadpoolController


@cache
def _Blas():
    return ThreadpoolController().select(user_api="blas")


class Cached:
    """functools.cached_property without its lock, at which before Python 3.12 all threads wait for one, whatever the object."""

    def __init__(self, function):
        self._function, self.__doc__ = function, function.__doc__

    def __set_name__(self, owner, name):
        self._name = name

    def __get__(self, instance, owner=None):
        if instance is None:
            return self
        value = instance.__dict__[self._name] = self._function(instance)
        return value


def Batched(function):
    """Decorator: run with one BLAS thread.

    In batches of small matrices further ones wait for each other, ten times as long as the work takes on a busy machine.
    """
    @wraps(function)
    def Wrapped(*arguments, **options):
        with _Blas().limit(limits=1):
            return function(*arguments, **options)
    return Wrapped


def Map(function, items, *, threads):
    """function(item) for each item, in order; with `threads` on all processors, only few results ahead of the consumer."""
    workers = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    if not threads or workers < 2:
        yield from map(function, items)
        return
    items = iter(items)
    with ThreadPoolExecutor(workers) as pool:
        pending = deque(pool.submit(function, item) for item in islice(items, 2 * workers))
        while pending:
            yield pending.popleft().result()
            pending.extend(pool.submit(function, item) for item in islice(items, 1))
