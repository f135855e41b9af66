"""What the assembly of a method costs beside the factorisation of its matrix, measured in one run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from ...cases import example_4_1
from ...discretization import Discretization
from ...mesh.facets import Threads
from ...methods.variants import Label
from ...tools.tables import Aligned
from .solutions import Alone, PeakMemory


@dataclass(frozen=True)
class Assembly:
    """Times [s] of repeated runs of one method, arrays (repeat,), and the memory of its process [MiB].

    setup : Discretization, that is spaces, checks of the data and Gamma_C;  assembly : all operators, the penalty and the
    matrix, ready for NGSolve's inverse;  factorisation : NGSolve's of that matrix
    before : memory before the mesh;  peak : its largest value until the matrix is there, the factorisation excluded
    """

    label: str
    dofs: int
    entries: int
    setup: np.ndarray
    assembly: np.ndarray
    factorisation: np.ndarray
    before: float
    peak: float

    @property
    def ratio(self) -> float:
        """Median of assembly over factorisation, each pair measured one after the other."""
        return float(np.median(self.assembly / self.factorisation))


def MeasureAssembly(method: Any, *, order: int = 1, n: int = 256, repeat: int = 3, assembly: str = "facet") -> Assembly:
    """The `Assembly` of a method on the geometry of Example 4.1, n x n x 2 triangles, in a process of its own.

    Raises ProblemError for repeat < 1, and what Discretization raises.
    """
    return Alone(_Measure, repeat, method, order, n, assembly)


def _Measure(method: Any, order: int, n: int, assembly: str, repeat: int) -> Assembly:
    before, peak, rows = PeakMemory(), 0.0, []
    mesh, problem = example_4_1.Mesh(n), example_4_1.Problem()
    for _ in range(repeat):
        times = [perf_counter()]
        disc = Discretization(problem, method, mesh, order=order, assembly=assembly)
        times.append(perf_counter())
        with Threads(mesh):
            matrix = disc.form.Matrix()
        times.append(perf_counter())
        peak = peak or PeakMemory()
        with Threads(mesh):
            inverse = matrix.Inverse(disc.space.FreeDofs(), inverse="sparsecholesky" if method.symmetric else "umfpack")
        times.append(perf_counter())
        rows.append(np.diff(times))
        dofs, entries = disc.space.ndof, matrix.nze
        del inverse, matrix, disc       # only one at a time
    setup, whole, factorisation = np.array(rows).T
    return Assembly(Label(method), dofs, entries, setup, whole, factorisation, before, peak)


HEADER = ("method", "dofs", "entries", "setup [s]", "assembly [s]", "factorisation [s]", "assembly/factorisation", "peak [MiB]")


def Text(rows: Sequence[Assembly]) -> str:
    """The table for a terminal: medians, and the peak memory of the assembly."""
    cells: list[tuple[str, ...]] = [HEADER]
    for row in rows:
        medians = [f"{np.median(times):.2f}" for times in (row.setup, row.assembly, row.factorisation)]
        cells.append((row.label, str(row.dofs), str(row.entries), *medians, f"{row.ratio:.2f}", f"{row.peak:.0f}"))
    return "\n".join(Aligned(cells, numbers=True))
