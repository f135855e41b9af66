"""Benchmarks: what a contact solve costs beside the factorisation of its matrix, measured in one run.

Every measurement runs in a process of its own, which has a peak memory of its own, and takes the reference, NGSolve's sparse
Cholesky factorisation of the matrix and one solve with it, right after what is compared with it.
"""

from __future__ import annotations

import json
import multiprocessing
import resource
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np

from ...contracts import Array
from ...discretization import Discretization
from ...exceptions import ProblemError
from ...mesh.facets import Threads
from ...methods.variants import Variants
from ...problem.materials import HookeMaterial
from ...problem.problem import ContactProblem
from ..atlas.solvers import Point
from . import peers

MEGABYTE = 1 << 20
TOL = 1e-8          # of the law residual
FITS = 150_000      # unknowns in 3D up to which the reference is factorised: beyond, it takes minutes and gigabytes


@dataclass(frozen=True)
class Swollen(Point):
    """A Point of the atlas with another Poisson ratio."""

    nu: float = 0.3

    @property
    def contactproblem(self) -> ContactProblem:
        problem = super().contactproblem
        return replace(problem, material=HookeMaterial(E=problem.material.E, nu=self.nu))


@dataclass(frozen=True)
class Cost:
    """What solving a `Point` of the atlas to a law residual of 1e-8 took, times [s] as arrays over repeated runs.

    setup : Discretization, that is spaces, checks of the data and Gamma_C;  assembly : the matrix and its checks
    coarse : all coarser meshes;  inverse : factorisations, or preconditioners, on the finest mesh
    contact : what is left of the solver on the finest mesh, with the loads;  total : everything, from mesh to solution
    factorisation, solve : of the matrix by NGSolve's sparse Cholesky, the reference; empty where that was not run
    kind : of the inverse;  iterations : of the solver, on the finest mesh;  solves : applications of the inverse there
    cycles : steps of conjugate gradients there;  linear : those of one linear equation alone; 0 for a factorisation
    peak : largest memory of the process until the solution was there [MiB]
    """

    point: Point
    dofs: int
    entries: int
    kind: str
    iterations: int
    solves: int
    cycles: int
    linear: int
    peak: float
    setup: np.ndarray
    assembly: np.ndarray
    coarse: np.ndarray
    inverse: np.ndarray
    contact: np.ndarray
    total: np.ndarray
    factorisation: np.ndarray
    solve: np.ndarray

    @property
    def reference(self) -> Array:
        """Factorisation and one solve [s], an array over runs."""
        return self.factorisation + self.solve

    @property
    def ratio(self) -> float:
        """Median of total over reference, each pair measured one after the other; NaN without reference."""
        return float(np.median(self.total / self.reference)) if len(self.reference) else np.nan


def Measure(point: Point, *, repeat: int = 3, inverse: Any = "auto") -> Cost:
    """The `Cost` of a Point, in a process of its own.

    inverse : as for Discretization

    Raises ProblemError for repeat < 1, and what the solver raises.
    """
    return Alone(_Measure, repeat, point, inverse)


def Alone(function: Callable[..., Any], repeat: int, *arguments: Any) -> Any:
    """function(*arguments, repeat) in a process of its own; ProblemError for repeat < 1."""
    if repeat < 1:
        raise ProblemError(f"repeat is {repeat}; give the number of runs, at least one")
    # Ctrl-C reaches all processes; this one stops the other.
    with multiprocessing.get_context("spawn").Pool(1, signal.signal, (signal.SIGINT, signal.SIG_IGN)) as pool:
        return pool.apply(function, (*arguments, repeat))


def _Measure(point: Point, inverse: Any, repeat: int) -> Cost:
    mesh, problem, method, peak = point.Mesh(), point.contactproblem, Variants()[point.method], 0.0
    rows: list[list[float]] = []
    for _ in range(repeat):
        times = [perf_counter()]
        disc = Discretization(problem, method, mesh, order=point.order, inverse=inverse)
        times.append(perf_counter())
        matrix = disc.matrix
        times.append(perf_counter())
        finest = (solution := disc.Solve(tol=TOL)).levels[-1]
        times.append(perf_counter())
        peak = peak or PeakMemory()
        setup, assembly, solver = np.diff(times)
        contact = finest.seconds - finest.factorisation
        row = [setup, assembly, solver - finest.seconds, finest.factorisation, contact, times[-1] - times[0]]
        del solution    # its factors, before those of the reference are made
        known = (disc.space.ndof, matrix.nze, disc.inversekind, finest.iterations, finest.solves, finest.cycles, _Linear(disc))
        disc.elastic.pop("inverse", None)     # its memory is wanted for the reference
        rows.append([*row, *(_Reference(disc) if disc.mesh.dim == 2 or disc.space.ndof <= FITS else [])])
        del disc, matrix
    columns = [*np.array(rows).T, *([np.array([])] * 2 if len(rows[0]) == 6 else [])]
    return Cost(point, *known, peak, *columns)


def _Linear(disc: Discretization) -> int:
    """Steps of conjugate gradients for the response to the loads without foundation."""
    if not disc.iterates:
        return 0
    disc.inverse.Solve(disc.load, tol=TOL)
    return disc.inverse.iterations


def _Reference(disc: Discretization) -> tuple[float, float]:
    """Seconds for NGSolve's sparse Cholesky factorisation, and for one solve with it once its memory has been touched."""
    vector = disc.matrix.CreateColVector()
    vector[:] = 1
    result = vector.CreateVector()
    with Threads(disc.mesh):
        start = perf_counter()
        inverse = disc.matrix.Inverse(disc.space.FreeDofs(), inverse="sparsecholesky" if disc.symmetric else "umfpack")
        factorised = perf_counter()
        result.data = inverse * vector
        begin = perf_counter()
        result.data = inverse * vector
        return factorised - start, perf_counter() - begin


def PeakMemory() -> float:
    """Largest resident memory of this process so far [MiB]."""
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / MEGABYTE


def Growth(costs: Sequence[Cost]) -> float:
    """Exponent p of total ~ dofs^p, least squares over the medians of at least two sizes, NaN for fewer."""
    if len(costs) < 2:
        return np.nan
    return float(np.polyfit(np.log([cost.dofs for cost in costs]), np.log([np.median(cost.total) for cost in costs]), 1)[0])


def Benches(*, quick: bool = False) -> dict[str, list[Point]]:
    """{name: points} of the whole benchmark: growth with the size, methods, orders, and the peers' problem."""
    def Sizes(sizes: Sequence[int], **base: Any) -> list[Point]:
        return [Point(n=n, **base) for n in sizes]

    plane, solid, fine, coarse = (((8, 16), (2, 3), 8, 4) if quick else ((64, 128, 256, 512), (6, 11, 24), 128, 8))
    smaller = plane if quick else plane[:-1]        # the largest ones, minutes each, once
    stiff: dict[str, Any] = {"stiffness": 500.0, "coefficient": 0.5}        # k_n = 1e6
    return {
        "Example 4.1, its own data": Sizes(plane, problem="4.1", stiffness=None),
        "Example 4.1, k_n = 1e6, Coulomb friction 0.5": Sizes(smaller, problem="4.1", **stiff),
        "Box, k_n = E": Sizes(solid, problem="box", stiffness=1.0),
        "Box, k_n = 1000 E": Sizes(solid if quick else (6, 11, 17), problem="box", stiffness=1e3),
        "Methods, k_n = 1e6, Coulomb friction 0.5": [Point(problem="4.1", method=label, n=fine, **stiff)
                                                     for label in Variants()],
        "Orders, k_n = 1e6, Coulomb friction 0.5": [Point(problem="4.1", order=order, n=round(fine / order ** 0.75), **stiff)
                                                    for order in (1, 2, 3, 4)],
        "Box of other methods and orders, k_n = E": [Point(problem="box", stiffness=1.0, n=coarse, method=label)
                                                     for label in ("Bassi edge", "Brezzi edge", "LDG edge", "H1")]
        + [Point(problem="box", stiffness=1.0, n=n, order=order)
           for order, n in (((2, 2), (3, 2)) if quick else ((2, 6), (3, 4)))],
        "Box, nearly incompressible, nu = 0.499, k_n = E": [Swollen(problem="box", stiffness=1.0, n=n, nu=0.499)
                                                            for n in (solid if quick else (6, 11, 14))]}


def Rivals(*, quick: bool = False) -> dict[str, tuple[Point, int]]:
    """{peer: (Point, n)}: what each one is compared with."""
    return {"GetFEM": (Point(problem="block", method="H1", order=2, n=8 if quick else 128), 8 if quick else 128),
            "DOLFINx": (Point(problem="block", n=8 if quick else 256), 8 if quick else 256)}


def Peer(name: str, n: int, *, python: str = sys.executable) -> dict[str, Any] | str:
    """What a peer took (`peers` module), run by an interpreter that has it: a dict; or why it did not run, a line of text."""
    run = subprocess.run([python, "-I", peers.__file__, name, str(n)], capture_output=True, text=True)
    if run.returncode:
        return (run.stderr.strip().splitlines() or [f"{python} ended with code {run.returncode}"])[-1]
    return json.loads(run.stdout.splitlines()[-1])
