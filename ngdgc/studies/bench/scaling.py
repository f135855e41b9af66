"""Beyond one machine: what is measured of ranks, and what follows from it for many more of them.

A rank with m = N/p of the N unknowns on p ranks, its part of a cube, has s = 6 (1 - p^(-1/3)) sides in the mean; a box of n
cells per side has N = 72 n^3 unknowns of order 1 and 6 n^2 points on its bottom.  So

    ghosts      g s m^(-1/3)                    neighbours over own elements
    bytes       b s m^(2/3)                     that a rank sends in a step of conjugate gradients
    memory      m_0 + m_1 m + 8 q points        of a rank: the process, its unknowns for one equation, Gamma_C as on all ranks
    subspace    N/24 + x N^(2/3)                unknowns of X_h: three at each vertex, and all on the elements near Gamma_C
    factors     f X_h^(4/3)                     entries, of nested dissection in 3D
    steps       a + c log10 N                   of conjugate gradients for one equation

with constants that are fitted to what was measured.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from .ranks import ONEMACHINE, Measure, Spread, Task

SIZES = (3, 6, 10, 15)      # refined once: 15 552 to 1 944 000 unknowns
RANKS = (1, 2, 4, 8)
TIMED = 10                  # the size at which runs are timed
LARGEST = 20                # on two ranks: 4 608 000 unknowns
# Numbers at each contact point: some 200 products that Newton's method remembers, as pairs of vectors and as three of a basis.
GAMMA = 60 + 200 * 15
PLANS = ((10_000_000, 16), (100_000_000, 128), (1_000_000_000, 1000))


def Tasks(*, quick: bool = False, repeat: int = 3) -> list[Task]:
    """All runs of the study: one equation, contact, and `repeat` times the same beside each other."""
    sizes, ranks = ((1, 2), (1, 2)) if quick else (SIZES, RANKS)
    found = [Task(ranks=p, n=n) for n in sizes for p in ranks]
    found += [Task(ranks=p, n=n, contact=True) for n in sizes[:-1] for p in (ONEMACHINE, *ranks)]
    found += [Task(ranks=p, n=sizes[-1], contact=True) for p in ranks[::2]]
    return found + [Task(ranks=p, n=2 if quick else TIMED, contact=True) for _ in range(repeat - 1) for p in (ONEMACHINE, 1, 2)]


def Study(tasks: Iterable[Task], *, known: Sequence[Spread] = (), limit: float | None = None,
          callback: Callable[[str], object] | None = None) -> Iterable[Spread]:
    """A `Spread` of each Task; known : those of earlier runs, which are not run again."""
    left = list(known)
    for task in tasks:
        same = next((row for row in left if row.task == task), None)
        if same is not None:
            left.remove(same)
            yield same
            continue
        if callback:
            callback(f"{task.ranks or 'no'} ranks, n = {task.n * 2 ** task.refine}{', contact' * task.contact}")
        yield Measure(task, limit=limit)


def Line(row: Spread) -> str:
    """A line of JSON, which `Row` reads."""
    return json.dumps(asdict(row))


def Row(line: str) -> Spread:
    found: dict[str, Any] = json.loads(line)
    return Spread(Task(**found.pop("task")), **found)


@dataclass(frozen=True)
class Law:
    """The constants of the formulas above; `fixed` [MiB], `each` [kB] an unknown."""

    ghosts: float
    bytes: float
    fixed: float
    each: float
    subspace: float
    factors: float
    steps: tuple[float, float]

    @classmethod
    def Of(cls, rows: Sequence[Spread]) -> Law:
        """Fitted to rows: medians, and least squares for the steps."""
        single, contact = ([row for row in rows if row.task.ranks and row.task.contact == asked] for asked in (False, True))
        several = [row for row in single if row.task.ranks > 1]
        sizes = [(Sides(row.task.ranks), row.unknowns / row.task.ranks) for row in several]
        large = max(single, key=lambda row: (row.unknowns, row.task.ranks))
        direct = [row for row in contact if row.factors]
        slope, start = np.polyfit(np.log10([row.unknowns for row in single]), [row.steps["GAMG"] for row in single], 1)
        return cls(ghosts=_Median(row.ghosts / (s * m ** (-1 / 3)) for row, (s, m) in zip(several, sizes)),
                   bytes=_Median(row.bytes / (s * m ** (2 / 3)) for row, (s, m) in zip(several, sizes)),
                   fixed=_Median(float(np.mean(row.fixed)) for row in single), each=large.each,
                   subspace=_Median((row.subspace - row.unknowns / 24) / row.unknowns ** (2 / 3) for row in contact),
                   factors=_Median(row.factors / row.subspace ** (4 / 3) for row in direct), steps=(start, slope))

    def At(self, unknowns: float, ranks: int) -> dict[str, float]:
        """{name: value} for a number of unknowns and of ranks; memory in GB."""
        m, s, points = unknowns / ranks, Sides(ranks), 6 * (unknowns / 72) ** (2 / 3)
        subspace = unknowns / 24 + self.subspace * unknowns ** (2 / 3)
        return {"unknowns of a rank": m, "ghosts [%]": 100 * self.ghosts * s * m ** (-1 / 3),
                "kB a step": self.bytes * s * m ** (2 / 3) / 1e3, "steps": self.steps[0] + self.steps[1] * np.log10(unknowns),
                "unknowns [GB]": self.each * m / 1e6, "Gamma_C [GB]": 8 * GAMMA * points / 1e9, "points": points,
                "X_h": subspace, "factors [GB a rank]": 8 * self.factors * subspace ** (4 / 3) / ranks / 1e9}


def Sides(ranks: int) -> float:
    """Sides that a rank has in common with others, in the mean, if all are cubes of one cube."""
    return 6 * (1 - ranks ** (-1 / 3))


def _Median(values: Iterable[float]) -> float:
    return float(np.median(list(values)))
