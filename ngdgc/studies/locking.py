"""Volume locking: the error of a smooth solution while the body becomes incompressible, lam/mu to infinity.

On B2 (`exact.SmoothSlip`) with mu = 2 the displacement and all its derivatives stay bounded, and so does lam div u: a method
without locking keeps its error.  The error is |eps_h(u - u_h)|/|eps(u)| in L2, without C, in which lam would weigh its part.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from ngsolve import Mesh

from ..contracts import Method, Solver
from ..discretization import Discretization
from ..errors import StrainError
from ..exact import SmoothSlip
from ..exceptions import ProblemError
from ..meshes import UnitMesh
from ..methods.variants import Label
from ..solvers import UzawaSolver
from ..tools.calls import ByKeyword
from ..tools.tables import Aligned, Piped

SOLVER = UzawaSolver()
LAMBDA = tuple(10.0 ** power for power in range(7))


@ByKeyword
@dataclass(frozen=True)
class Sweep:
    """Relative strain errors of one method of one order for the values `lam` [stress] of Lame's parameter."""

    label: str
    order: int
    n: int
    lam: tuple[float, ...]
    errors: np.ndarray

    @property
    def factor(self) -> float:
        """Error at the last lam over that at the first: near 1 without locking."""
        return float(self.errors[-1] / self.errors[0])


@ByKeyword
def Study(method: Method, *, order: int = 1, n: int = 16, lam: Sequence[float] = LAMBDA, cells: str = "triangle",
          mesh: Callable[..., Mesh] = UnitMesh, solver: Solver = SOLVER,
          callback: Callable[[str], object] | None = None) -> Sweep:
    """Solve B2 for every `lam` on one mesh of the unit square or cube, mesh(n, cells), and return the Sweep.

    lam : values > 0 [stress], while mu = 2 [stress]
    callback : called with a line of progress before each solve

    Raises ProblemError for fewer than two values, and what mesh and solver raise.

    >>> from ngdgc import Conforming
    >>> Study(Conforming(), order=2, n=4, lam=(1, 1e4)).factor > 2
    True
    """
    if len(lam) < 2:
        raise ProblemError(f"lam is {lam}; a comparison needs at least two values, give for example 1 1e6")
    grid, errors = mesh(n, cells), []
    for value in lam:
        if callback:
            callback(f"{Label(method)}, order {order}, lam = {value:g}")
        exact = SmoothSlip(lam=value, dim=grid.dim)
        solution = solver.Solve(Discretization(exact.problem, method, grid, order=order))
        errors.append(StrainError(solution, exact.displacement))
    return Sweep(Label(method), order, n, tuple(lam), np.array(errors))


def _Cells(sweeps: Sequence[Sweep]) -> Iterator[tuple[str, ...]]:
    yield ("method", "order", *(f"lam = {lam:g}" for lam in sweeps[0].lam), "last/first")
    for sweep in sweeps:
        yield (sweep.label, str(sweep.order), *(f"{error:.3e}" for error in sweep.errors), f"{sweep.factor:.2f}")


@ByKeyword
def Text(sweeps: Sequence[Sweep]) -> str:
    """The table for a terminal."""
    return "\n".join(Aligned(_Cells(sweeps)))


@ByKeyword
def Markdown(sweeps: Sequence[Sweep]) -> str:
    """The table for a page."""
    return "\n".join(Piped(_Cells(sweeps)))
