"""Convergence studies: errors and observed orders of any method on a problem with a known solution.

For a smooth solution the theory says |u - u_h|_{1,h} = O(h^k) in the energy norm and |u - u_h| = O(h^(k+1)) in L2.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from ngsolve import Mesh

from ..contracts import Array, Method, Solver
from ..discretization import Discretization
from ..errors import EnergyError, L2Error, Rates
from ..exact import Exact
from ..exceptions import ProblemError
from ..meshes import UnitMesh
from ..methods.variants import Label
from ..solvers import UzawaSolver
from ..tools.calls import ByKeyword
from ..tools.tables import Aligned, Piped

SOLVER = UzawaSolver()


@ByKeyword
@dataclass(frozen=True)
class Series:
    """Errors of one method of one order on meshes 1/n of one kind of cells.

    n : cells per side;  dofs : unknowns;  energy : |u - u_h|_{1,h} [sqrt(stress length^d)];  l2 : |u - u_h| [length^(1 + d/2)]
    """

    label: str
    cells: str
    order: int
    n: tuple[int, ...]
    dofs: tuple[int, ...]
    energy: np.ndarray
    l2: np.ndarray

    @property
    def rates(self) -> tuple[Array, Array]:
        """Observed orders (energy, L2), each one less than errors."""
        ratio: Any = np.divide(self.n[1:], self.n[:-1])
        return Rates(self.energy, ratio), Rates(self.l2, ratio)


@ByKeyword
def Study(exact: Exact, method: Method, *, order: int = 1, n: Sequence[int] = (4, 8, 16), cells: str = "triangle",
          mesh: Callable[..., Mesh] = UnitMesh, solver: Solver = SOLVER,
          callback: Callable[[str], object] | None = None) -> Series:
    """Solve an `Exact` problem on a sequence of meshes and return the Series of its errors.

    method, order : as for Discretization
    n : increasing cells per side, at least two
    cells : what `mesh(n, cells)` makes its meshes of; UnitMesh knows those of the unit square and cube
    callback : called with a line of progress before each solve

    Raises ProblemError for fewer than two meshes or sizes that do not increase, and what meshes and solver raise.

    >>> from ngdgc import InteriorPenalty
    >>> from ngdgc.exact import SmoothSlip
    >>> series = Study(SmoothSlip(), InteriorPenalty(), n=(4, 8))
    >>> bool(abs(series.rates[0][0] - 1) < 0.15)
    True
    """
    if len(n) < 2 or np.any(np.diff(n) <= 0):
        raise ProblemError(f"n is {n}; an order needs at least two sizes that increase, give for example 4 8 16")
    rows = []
    for size in n:
        if callback:
            callback(f"{Label(method)}, order {order}, {cells}, n = {size}")
        disc = Discretization(exact.problem, method, mesh(size, cells), order=order)
        solution = solver.Solve(disc)
        rows.append((disc.space.ndof, EnergyError(solution, exact.displacement), L2Error(solution, exact.displacement)))
    dofs, energy, l2 = zip(*rows)
    return Series(Label(method), cells, order, tuple(n), dofs, np.array(energy), np.array(l2))


HEADER = ("method", "cells", "order", "n", "dofs", "energy error", "rate", "L2 error", "rate")


@ByKeyword
def Rows(series: Sequence[Series]) -> Iterator[tuple[str, ...]]:
    """Cells of the table, one row per mesh, as text."""
    for one in series:
        rates = [["", *(f"{rate:.2f}" for rate in norm)] for norm in one.rates]
        for n, dofs, energy, up, l2, down in zip(one.n, one.dofs, one.energy, rates[0], one.l2, rates[1]):
            yield (one.label, one.cells, str(one.order), str(n), str(dofs), f"{energy:.3e}", up, f"{l2:.3e}", down)


@ByKeyword
def Text(series: Sequence[Series]) -> str:
    """The table for a terminal."""
    return "\n".join(Aligned([HEADER, *Rows(series)]))


@ByKeyword
def Summary(series: Sequence[Series]) -> str:
    """Markdown: one row per series with the errors on its finest mesh and the last observed orders."""
    rows = [("method", "cells", "order", "n", "energy error", "rate", "L2 error", "rate")]
    for one in series:
        energy, l2 = one.rates
        rows.append((one.label, one.cells, str(one.order), str(one.n[-1]), f"{one.energy[-1]:.3e}", f"{energy[-1]:.2f}",
                     f"{one.l2[-1]:.3e}", f"{l2[-1]:.2f}"))
    return "\n".join(Piped(rows))
