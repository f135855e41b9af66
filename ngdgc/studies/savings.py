"""What adaptive meshes save: unknowns and time until an estimated error is reached, beside uniform meshes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from time import process_time
from typing import Any

import numpy as np
from ngsolve import Mesh

from ..cases import example_4_1, example_4_2
from ..discretization import Discretization
from ..estimates.adaptive import SolveAdaptive
from ..estimates.error import EstimateError
from ..meshes import BoxMesh
from ..methods.rows import InteriorPenalty
from ..problem.foundation import Foundation
from ..problem.laws import CoulombFriction, NormalCompliance
from ..problem.materials import HookeMaterial
from ..problem.problem import ContactProblem
from ..solvers import NestedNewtonSolver
from ..tools.calls import ByKeyword

SERIES = 60_000     # unknowns up to which uniform meshes are halved
SOLVED = 400_000    # and up to which the one that would do is solved
SAVED = ("Until the estimated relative error is reached.  The errors on uniform meshes of cells that are halved again and",
         "again have the order that the last two show; the mesh that would do by this order is solved, and timed, where it has",
         f"no more than {SOLVED} unknowns.  Seconds are of CPU, for adaptive meshes with all meshes and estimates, for the",
         "uniform one the solution alone.")


@ByKeyword
@dataclass(frozen=True)
class Saving:
    """What adaptivity saves: unknowns for an estimated error `tol`, adaptive and on uniform meshes, and observed orders.

    order : k;  adaptive, uniform : unknowns, uniform as its own order has them
    rates : orders in unknowns^(-1/d), adaptive over the last four meshes and uniform over the last two
    seconds : of CPU, adaptive with all meshes, and of the solution on the uniform one, or None
    """

    name: str
    order: int
    tol: float
    adaptive: float
    uniform: float
    rates: tuple[float, float]
    seconds: tuple[float, float | None]


def Box() -> ContactProblem:
    """A cube with edges at which the stress is singular, held and pressed at its top, on a foundation with friction."""
    foundation = Foundation("bottom", NormalCompliance(1e4), friction=CoulombFriction(0.3))
    return ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, dirichlet={"top": (0.02, 0, -0.05)})


ROWS: tuple[tuple[str, Callable[[], ContactProblem], Callable[[int], Mesh], int, int, float], ...] = (
    *(("Example 4.1", example_4_1.Problem, example_4_1.Mesh, 4, order, 0.01) for order in (1, 2, 3)),
    *(("Example 4.2", example_4_2.Problem, example_4_2.Mesh, 4, order, 0.01) for order in (1, 2, 3)),
    ("cube in 3D", Box, BoxMesh, 2, 2, 0.05))


@ByKeyword
def Savings(*, callback: Callable[[str], object] | None = None) -> Iterator[Saving]:
    """Examples 4.1 and 4.2, orders 1 to 3, and a cube: `tol` by `SolveAdaptive` and by uniform meshes."""
    for name, Problem, Cells, n, order, tol in ROWS:
        if callback:
            callback(f"{name}, order {order}")
        begin = process_time()
        found = SolveAdaptive(Problem(), InteriorPenalty(), Cells(n), order=order, tol=tol)
        seconds = process_time() - begin
        adaptive = [(level.dofs, level.error) for level in found.levels]
        uniform: list[tuple[int, float]] = []
        dim = found.disc.mesh.dim
        while len(uniform) < 2 or uniform[-1][1] > tol and 2 ** dim * uniform[-1][0] <= SERIES:
            solution = _Solved(Problem(), Cells(n), order)
            uniform.append((solution.disc.space.ndof, EstimateError(solution).relative))
            n *= 2
        rates = Rate(adaptive[-4:], dim), Rate(uniform[-2:], dim)
        dofs, error = uniform[-1]
        factor = (error / tol) ** (1 / rates[1])
        wanted = dofs * factor ** dim
        taken = None
        if wanted <= SOLVED:
            begin = process_time()
            _Solved(Problem(), Cells(int(np.ceil(n / 2 * factor))), order)
            taken = process_time() - begin
        yield Saving(name, order, tol, adaptive[-1][0], wanted, rates, (seconds, taken))


def _Solved(problem: ContactProblem, mesh: Mesh, order: int) -> Any:
    return NestedNewtonSolver().Solve(Discretization(problem, InteriorPenalty(), mesh, order=order))


def Rate(pairs: Sequence[tuple[int, Any]], dim: int) -> float:
    """The order p of errors C dofs^(-p/dim), from pairs (dofs, error)."""
    dofs, errors = np.log(np.array(pairs, dtype=float).T)
    return float(-dim * np.polyfit(dofs, errors, 1)[0])


def SavingCells(savings: Iterable[Saving]) -> Iterator[tuple[str, ...]]:
    """Rows of a table."""
    yield ("problem", "k", "error", "unknowns, adaptive", "uniform", "order/k, adaptive", "uniform", "seconds, adaptive",
           "uniform")
    for one in savings:
        yield (one.name, str(one.order), f"{one.tol:g}", f"{one.adaptive:.0f}", f"{one.uniform:.2g}",
               *(f"{rate / one.order:.2f}" for rate in one.rates),
               *("-" if seconds is None else f"{seconds:.1f}" for seconds in one.seconds))
