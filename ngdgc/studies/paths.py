"""Random load histories: the problems of the sweep, led along random loads, and what became of every increment."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import IO, Any

import numpy as np
from ngsolve import CF, IfPos, Parameter

from ..exceptions import NotConvergedError, ProblemError
from ..histories.solve import SolveHistory
from ..tools.calls import ByKeyword
from .records import Recorded
from .samples import Sample
from .sweep import SHARP, Samples, Violation

LOADS = "dirichlet", "traction"


@ByKeyword
@dataclass(frozen=True)
class PathRecord:
    """What became of one history; lists have one entry for each state.

    violation : `sweep.Violation` of the law, its largest value;  solves : applications of an inverse
    parts : into which increments were divided;  seconds : in all;  error : why it failed, "" if it did not
    """

    number: int
    words: str
    dofs: int = 0
    violation: tuple[float, ...] = ()
    solves: tuple[int, ...] = ()
    parts: tuple[int, ...] = ()
    seconds: float = 0.0
    error: str = ""

    @property
    def failed(self) -> bool:
        return bool(self.error) or not max(self.violation) <= SHARP


@ByKeyword
def Led(sample: Sample, *, steps: int = 10, seed: int = 1) -> tuple[Sample, Parameter]:
    """(the Sample with loads that change, the Parameter that is their time): at the times 1, ..., steps they are random.

    What acts along the foundation is multiplied by numbers from -1 to 1, what presses by others from 0.2 to 1.2, linear in
    between: stick, slip, reversal, and separation where there is a gap.
    """
    rng, t = np.random.default_rng([seed, steps]), Parameter(1)
    along, press = Through(t, rng.uniform(-1, 1, steps)), Through(t, rng.uniform(0.2, 1.2, steps))
    problem = sample.problem
    loads = {}
    for kind in LOADS:
        loads[kind] = {region: CF((*(along * value[component] for component in range(value.dim - 1)),
                                   press * value[value.dim - 1]))
                       for region, value in ((region, CF(value)) for region, value in getattr(problem, kind).items())}
    return replace(sample, problem=replace(problem, **loads)), t


@ByKeyword
def Through(t: Any, values: Any) -> Any:
    """The piecewise linear function of t with these values at t = 1, 2, ...

    >>> from ngsolve import Parameter
    >>> t = Parameter(1)
    >>> Through(t, [2, 4, 3]), t.Set(2.5)       # doctest: +ELLIPSIS
    (<ngsolve.fem.CoefficientFunction object at ...>, None)
    """
    found = CF(float(values[-1]))
    for place in range(len(values) - 2, -1, -1):
        here, there = float(values[place]), float(values[place + 1])
        found = IfPos(place + 2 - t, here + (t - place - 1) * (there - here), found)
    return found


@ByKeyword
def RunPath(number: int, sample: Sample, *, steps: int = 10, seed: int = 1) -> PathRecord:
    """The PathRecord of a Sample, led by `Led`."""
    led, t = Led(sample, steps=steps, seed=seed)
    begin = perf_counter()
    disc = led.Disc()
    try:
        history = SolveHistory(disc, parameter=t, times=range(1, steps + 1))
    except (NotConvergedError, ProblemError) as error:
        return PathRecord(number=number, words=sample.words, dofs=disc.space.ndof, seconds=perf_counter() - begin,
                          error=f"{type(error).__name__}: {error}")
    seconds = perf_counter() - begin
    return PathRecord(number=number, words=sample.words, dofs=disc.space.ndof, seconds=seconds,
                      violation=tuple(float(Violation(solution).max()) for solution in history),
                      solves=tuple(increment.solves for increment in history.increments),
                      parts=tuple(increment.parts for increment in history.increments))


@ByKeyword
def Paths(seed: int, count: int, file: IO[str], *, dofs: float = 150_000, steps: int = 10,
          callback: Callable[[PathRecord], object] | None = None) -> list[PathRecord]:
    """The PathRecords of the first `count` problems of a seed, as `sweep.Sweep` has its Records."""
    made = (RunPath(number, sample, steps=steps, seed=seed + number) for number, sample in Samples(seed, count, dofs=dofs))
    return Recorded(made, file, callback)


@ByKeyword
def PathLine(record: PathRecord) -> str:
    """One line for the terminal."""
    state = record.error or f"violation {max(record.violation):.1e} applications {list(record.solves)}"
    return f"{record.number}: {record.words}: {'FAILED ' * record.failed}{state}, {record.seconds:.1f} s"


@ByKeyword
def PathTally(records: Sequence[PathRecord]) -> str:
    """What to say about the records: how many failed and which, the worst violation, applications and halved increments."""
    solved = [record for record in records if not record.error]
    lines = [f"{len(records)} histories, {sum(record.failed for record in records)} failed"]
    if solved:
        worst = max(solved, key=lambda record: max(record.violation))
        later = np.concatenate([record.solves[1:] for record in solved])
        lines += [f"law violation: at most {max(worst.violation):.1e} (number {worst.number})",
                  f"applications of an inverse, first state: {_Quantiles([record.solves[0] for record in solved])}",
                  f"applications of an inverse, increments:  {_Quantiles(later)}",
                  f"increments that were halved: {sum(part > 1 for record in solved for part in record.parts)}",
                  f"{sum(record.seconds for record in records):.0f} s in all"]
    return "\n".join([*lines, *(PathLine(record) for record in records if record.failed)])


def _Quantiles(counts: Any) -> str:
    return f"median {np.median(counts):.0f}, 95 % at most {np.percentile(counts, 95):.0f}, at most {np.max(counts)}"
