"""What a step of conjugate gradients reads of its matrix, in units of what one thread can read: what bounds its time."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from ...discretization import Discretization
from ...linear.conjugategradients import IterativeInverse
from ...methods.variants import Variants
from ...tools.parallel import OneThread
from ..atlas.solvers import Point
from .solutions import TOL, Alone

LONG = 1 << 25      # numbers of a vector that no cache holds


@dataclass(frozen=True)
class Traffic:
    """Of the finest level, to which nearly all belongs.

    dofs : unknowns;  steps : of conjugate gradients;  seconds : of one;  bandwidth : bytes that one thread reads in a second
    bytes : of the matrix that a step reads, blocks of L three times, of L' and D^-1 twice (`linear.elementblocks`)
    """

    dofs: int
    steps: int
    seconds: float
    bytes: int
    bandwidth: float

    @property
    def fraction(self) -> float:
        """Of the bandwidth that is used."""
        return self.bytes / self.seconds / self.bandwidth

    def __str__(self) -> str:
        return (f"conjugate gradients, {self.dofs} unknowns: {self.bytes / 1e6:.3g} MB a step in {1e3 * self.seconds:.3g} ms, "
                f"{self.fraction:.2g} of the {self.bandwidth / 1e9:.3g} GB/s that one thread reads")


def MeasureTraffic(point: Point, *, length: int = LONG, repeat: int = 3) -> Traffic:
    """The `Traffic` for the elastic body of a Point alone, in a process of its own; the quickest of some runs.

    length : of the two vectors whose inner product tells the bandwidth
    """
    found: Traffic = Alone(_Measure, repeat, point, length)
    return found


def _Measure(point: Point, length: int, repeat: int) -> Traffic:
    disc: Any = Discretization(point.contactproblem, Variants()[point.method], point.Mesh(), order=point.order)
    inverse: Any = IterativeInverse(disc, disc.matrix, tol=TOL)
    times = []
    for _ in range(repeat):
        before, start = inverse.iterations, perf_counter()
        inverse.Solve(disc.load)
        times.append((perf_counter() - start) / (inverse.iterations - before))
    blocks = inverse.equations.blocks
    read = 3 * blocks.lower.data.nbytes + 2 * blocks.upper.data.nbytes + 2 * blocks.diagonal.data.nbytes
    return Traffic(disc.space.ndof, inverse.iterations // repeat, min(times), read, Bandwidth(length, repeat))


def Bandwidth(length: int, repeat: int) -> float:
    """Bytes that one thread reads in a second, from the inner product of two vectors."""
    first, second = np.ones(length), np.ones(length)
    times = []
    with OneThread():
        for _ in range(repeat + 1):     # the first one touches what is to be read
            start = perf_counter()
            first @ second
            times.append(perf_counter() - start)
    return 16 * length / min(times)
