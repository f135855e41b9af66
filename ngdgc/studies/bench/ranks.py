"""What a body in contact costs that is spread over the ranks of MPI: this module is run on all of them.

`mpirun -n 4 python -m mpi4py -m ngdgc.studies.bench.ranks WORDS` prints a line of JSON, the fields of a `Spread`; WORDS are
those of `Task.words`.  `python -m ngdgc.studies.bench.ranks WORDS` is the same box on one machine without PETSc.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import asdict, dataclass
from contextlib import nullcontext, suppress
from time import perf_counter, process_time
from typing import Any

import numpy as np

from ...discretization import Discretization
from ...distributed import DistributedMesh
from ...distributed.subspace import DistributedSubspace
from ...distributed.petsc import Petsc, World
from ...exceptions import ProblemError
from ...meshes import BoxMesh
from ...methods.variants import Variants
from ...solvers import SemismoothNewtonSolver
from ...tools.calls import ByKeyword
from ..atlas.solvers import Point
from .solutions import TOL, PeakMemory

ONEMACHINE = 0      # ranks: without PETSc
COARSE = {"GAMG": "gamg", "BoomerAMG": "hypre"}      # PETSc's names; times, messages and memory are those of the first
OPTION = "ngdgc_pc_type"        # of PETSc, which of them
# More ranks than processors, which wait for each other without keeping them busy.
SETTING = {"OMP_NUM_THREADS": "1", "NGS_NUM_THREADS": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
           "OMPI_MCA_mpi_yield_when_idle": "1", "OMPI_MCA_hwloc_base_binding_policy": "none"}


@ByKeyword
@dataclass(frozen=True, kw_only=True)
class Task:
    """The box of the atlas, n 2^refine cells per side, on some ranks; 0: one machine without PETSc.

    contact : True to solve the whole problem, False for one linear equation alone
    """

    ranks: int
    n: int
    refine: int = 1
    contact: bool = False
    order: int = 1
    method: str = "IP edge"

    @property
    def words(self) -> str:
        return json.dumps(asdict(self))


@dataclass(frozen=True)
class Spread:
    """What a Task took.  Times are [s] of the slowest rank, memory [MiB] are arrays over ranks.

    unknowns, points : of V_h, and on Gamma_C
    steps : of conjugate gradients for one linear equation to 1e-8, {name: steps} of what is in COARSE and installed
    messages, bytes, sums : of one step, what the busiest rank sends, and global sums;  ghosts : the largest ratio of a rank's
        neighbours to its own elements
    mesh, assembly, inverse, linear, contact : to spread the mesh, for matrix and load, for the cycle, for one equation, and for
        the contact problem;  busy : processor time of all of that
    corrections, cycles, subspace : of the contact problem, cycles in V_h, unknowns of X_h;
        factors : entries of MUMPS's factors of its matrix; all 0 without it
    fixed, peak : memory before the mesh, and the largest
    """

    task: Task
    unknowns: int
    points: int
    steps: dict[str, int]
    messages: float
    bytes: float
    sums: float
    ghosts: float
    mesh: float
    assembly: float
    inverse: float
    linear: float
    contact: float
    busy: float
    corrections: int
    cycles: int
    subspace: int
    factors: int
    fixed: list[float]
    peak: list[float]

    @property
    def seconds(self) -> float:
        """From the coarse mesh to the solution, the linear equation left out."""
        return self.mesh + self.assembly + self.inverse + self.contact

    @property
    def each(self) -> float:
        """Memory of an unknown beyond what a process has before the mesh [kB]."""
        return (sum(self.peak) - sum(self.fixed)) * 1.048576e3 / self.unknowns


def Measure(task: Task, *, limit: float | None = None) -> Spread:
    """The `Spread` of a Task, in processes of its own; ProblemError if they fail, or take longer than `limit` seconds."""
    start = ["mpirun", "-n", str(task.ranks), sys.executable, "-m", "mpi4py"] if task.ranks else [sys.executable]
    try:
        run = subprocess.run([*start, "-m", __name__, task.words], capture_output=True, text=True, timeout=limit, check=True,
                             env={**os.environ, **SETTING})
    except (OSError, subprocess.SubprocessError) as error:
        words = (getattr(error, "stderr", None) or str(error)).strip().splitlines()[-1]
        raise ProblemError(f"{task.ranks} ranks came to no result: {words}; see the page 'Beyond one machine'") from error
    return Spread(task, **json.loads(run.stdout.splitlines()[-1]))


class _Clock:
    """Seconds between calls, {name: seconds}; and the processor time since it was made."""

    def __init__(self) -> None:
        self.times: dict[str, float] = {}
        self._begin, self._last = process_time(), perf_counter()

    def __call__(self, name: str) -> None:
        before, self._last = self._last, perf_counter()
        self.times[name] = self._last - before

    @property
    def busy(self) -> float:
        return process_time() - self._begin


def Box(task: Task) -> tuple[Any, Any]:
    """(problem, method)."""
    return Point(problem="box", stiffness=1.0).contactproblem, Variants()[task.method]


def OnMachine(task: Task) -> dict[str, Any]:
    """The fields of a Spread without PETSc."""
    fixed, clock, (problem, method) = PeakMemory(), _Clock(), Box(task)
    mesh = BoxMesh(task.n * 2 ** task.refine)
    clock("mesh")
    disc = Discretization(problem, method, mesh, order=task.order, inverse="iterative")
    _Prepare(disc, clock)
    steps = {}
    if not task.contact:
        steps[""] = _Linear(disc, clock, nullcontext())
    found = _Contact(task, disc, clock)
    return {**found, "steps": steps, "messages": 0, "bytes": 0, "sums": 0, "ghosts": 0, "busy": clock.busy,
            "unknowns": disc.space.ndof, "subspace": 0, "factors": 0, "fixed": [fixed], "peak": [PeakMemory()], **clock.times}


def OnRanks(task: Task) -> dict[str, Any]:
    """The fields of a Spread, on every rank."""
    petsc, coarse = Petsc(), BoxMesh(task.n)
    petsc.Log.begin()
    fixed, clock, (problem, method) = PeakMemory(), _Clock(), Box(task)
    mesh = DistributedMesh(coarse, refine=task.refine)
    disc: Any = Discretization(problem, method, mesh, order=task.order)
    clock("mesh")
    spaces: list[Any] = []

    def Reduce(disc: Any) -> Any:
        spaces.append(DistributedSubspace(disc))
        return spaces[-1]

    disc.reduce = Reduce
    _Prepare(disc, clock)
    steps, event, peak = {}, petsc.Log.Event("one equation"), 0.0
    busy = 0.0
    for name, kind in {} if task.contact else COARSE.items():
        petsc.Options()[OPTION] = kind
        with suppress(petsc.Error):     # not in every PETSc
            steps[name] = _Linear(disc, _Clock() if peak else clock, nullcontext() if peak else event)
            del disc.inverse
        peak, busy = peak or PeakMemory(), busy or clock.busy
    found, own, sent = _Contact(task, disc, clock), disc.numbering.local.own, event.getPerfInfo()
    mine = [[sent["numMessages"], sent["messageLength"], sent["numReductions"]], (~own).sum() / max(own.sum(), 1),
            list(clock.times.values()), busy or clock.busy, fixed, peak or PeakMemory()]
    messages, ghosts, times, busies, fixes, peaks = zip(*mesh.comm.allgather(mine))
    each = dict(zip(("messages", "bytes", "sums"), np.max(messages, axis=0) / steps.get("GAMG", 1)))
    return {**found, **each, **dict(zip(clock.times, np.max(times, axis=0))), "steps": steps, "busy": sum(busies),
            "unknowns": disc.unknowns, "ghosts": max(ghosts), "subspace": spaces[0].unknowns if spaces else 0,
            "factors": getattr(spaces[0].inverse, "entries", 0) if spaces else 0, "fixed": fixes, "peak": peaks}


def _Prepare(disc: Any, clock: _Clock) -> None:
    disc.load, disc.matrix      # noqa: B018  made here
    for name in ("assembly", "inverse", "linear"):
        clock(name)


def _Linear(disc: Any, clock: _Clock, event: Any) -> int:
    """Steps for the response to the loads without foundation, around which `event` is begun and ended."""
    inverse = disc.inverse
    clock("inverse")
    with event:
        inverse.Solve(disc.load, tol=TOL)
    clock("linear")
    return int(inverse.iterations)


def _Contact(task: Task, disc: Any, clock: _Clock) -> dict[str, Any]:
    """Counts of the contact problem, solved on one mesh alone."""
    clock("contact")
    if not task.contact:
        return {"points": len(disc.contact.weights), "cycles": 0, "corrections": 0}
    solution = SemismoothNewtonSolver(tol=TOL).Solve(disc)
    clock("contact")
    return {"points": len(disc.contact.weights), "cycles": disc.cycles, "corrections": len(solution.history)}


if __name__ == "__main__":
    asked = Task(**json.loads(sys.argv[1]))
    answer = OnRanks(asked) if asked.ranks else OnMachine(asked)
    if not asked.ranks or World().rank == 0:
        print(json.dumps(answer, default=float), flush=True)
