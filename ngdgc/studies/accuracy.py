"""Error against time on a smooth solution: which method and order comes to an accuracy the soonest?

On meshes 1/n, 2/n, ... the time from the mesh in memory to the solution by `Solve(disc)`, and the relative strain error.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from ..contracts import Method
from ..discretization import Discretization
from ..errors import StrainError
from ..exact import Exact
from ..exceptions import ProblemError
from ..meshes import UnitMesh
from ..methods.variants import Label
from ..solvers import NestedNewtonSolver
from ..tools.calls import ByKeyword
from ..tools.tables import Aligned, Piped

SOLVER = NestedNewtonSolver(tol=1e-8)
GOALS = 1e-2, 1e-3, 1e-5        # relative errors that are asked for
FINEST = 256                    # cells per side at most


@ByKeyword
@dataclass(frozen=True)
class Series:
    """Runs of one method of one order on refined meshes.

    n : cells per side;  dofs : unknowns;  seconds : from mesh to solution;  error : |eps_h(u - u_h)|/|eps(u)|, no unit
    """

    label: str
    cells: str
    order: int
    n: np.ndarray
    dofs: np.ndarray
    seconds: np.ndarray
    error: np.ndarray

    def At(self, goal: float) -> tuple[float, ...] | None:
        """(seconds, unknowns) for an error, interpolated between meshes on logarithmic scales; None outside of them.

        >>> times = np.array([1.0, 10.0])
        >>> [float(value) for value in Series("", "", 1, times, times, times, np.array([1e-2, 1e-4])).At(1e-3)]
        [3.162, 3.162]
        """
        if not self.error[-1] <= goal <= self.error[0]:
            return None
        place = np.log(self.error[::-1])
        return tuple(round(float(np.exp(np.interp(np.log(goal), place, np.log(values[::-1])))), 3)
                     for values in (self.seconds, self.dofs))


@ByKeyword
def Study(exact: Exact, method: Method, *, order: int = 1, cells: str = "triangle", budget: float = 5.0,
          callback: Callable[[str], object] | None = None) -> Series:
    """The Series of an `Exact` problem on UnitMesh(n, cells), n = 2, 4, 8, ..., until a run takes more than `budget` seconds.

    callback : called with a line of progress before each run

    Raises ProblemError for a budget that is not positive, and what meshes and solver raise.
    """
    if not budget > 0:
        raise ProblemError(f"budget is {budget:g}; give a positive number of seconds")
    rows: list[Any] = []
    n = 2
    while not rows or rows[-1][2] <= budget and n <= FINEST:
        if callback:
            callback(f"{Label(method)}, order {order}, {cells}, n = {n}")
        mesh = UnitMesh(n, cells)
        start = perf_counter()
        solution = SOLVER.Solve(Discretization(exact.problem, method, mesh, order=order))
        rows.append((n, solution.disc.space.ndof, perf_counter() - start, StrainError(solution, exact.displacement)))
        n *= 2
    return Series(Label(method), cells, order, *np.array(rows, dtype=float).T)


@ByKeyword
def Rows(series: Sequence[Series]) -> Iterator[list[str]]:
    """Cells of the table: for every goal seconds and unknowns, a dash where no mesh came so far, or all did better."""
    for one in series:
        found = [one.At(goal) for goal in GOALS]
        yield [one.label, one.cells, str(one.order), *("-" if at is None else f"{at[0]:.2g} s, {at[1]:.2g}" for at in found)]


HEADER = ("method", "cells", "order", *(f"{100 * goal:g} %" for goal in GOALS))


@ByKeyword
def Text(series: Sequence[Series]) -> str:
    """The table for a terminal."""
    return "\n".join(Aligned([HEADER, *Rows(series)]))


INTRODUCTION = """# Error against time

Written by `ngdgc accuracy --budget {budget:g} --page docs/accuracy.md`; nothing on this page is typed by hand but the
explanations.  The smooth solution `ngdgc.exact.SmoothSlip` on meshes 1/2, 1/4, ..., from the mesh in memory to the solution by
`Solve(disc)`, until a run takes more than {budget:g} s; the error is that of the strain, relative, in L2.  Cells read seconds,
unknowns, interpolated between meshes; a dash stands where no mesh was fine enough, or where all of them were too fine.
"""


@ByKeyword
def Page(series: Sequence[Series], *, budget: float) -> str:
    """The page, Markdown, of studies with a budget [s]; its figures are images/accuracy_CELLS.png."""
    lines = [INTRODUCTION.format(budget=budget)]
    for cells in dict.fromkeys(one.cells for one in series):
        own = [one for one in series if one.cells == cells]
        lines += [f"## Cells: {cells}", "", f"![Error against time](images/accuracy_{cells}.png)", "",
                  *Piped([HEADER, *Rows(own)]), ""]
        for goal in GOALS:
            known = [(at[0], one) for one in own if (at := one.At(goal))]
            if known:
                best = min(known, key=lambda pair: pair[0])[1]
                lines.append(f"* {100 * goal:g} %: {best.label}, k = {best.order}, is the soonest.")
        lines.append("")
    return "\n".join(lines)
