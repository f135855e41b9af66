"""How often a solver fails: random problems solved one after the other, every result written as it comes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import IO, Any

import numpy as np

from ..contracts import Array, Solver
from ..discretization import Discretization
from ..exceptions import NotConvergedError, ProblemError
from ..problem.laws import CoulombFriction, PowerFriction, SlipWeakeningFriction, TrescaFriction
from ..solution.solution import ContactSolution
from ..solvers import NestedNewtonSolver
from ..tools.calls import ByKeyword
from .records import Recorded
from .samples import Draw, Sample

SHARP = 1e-8        # of the law violation
ALLOWED = 0.02      # part of the problems that may fail
STEPS, SOLVES = 5, 60       # on the finest of several meshes
FROMREST = 32       # cells per side up to which iterations from rest are counted


@ByKeyword
@dataclass(frozen=True)
class Record:
    """What became of one problem; lists have one entry for each mesh, the finest last.

    zones : parts of Gamma_C that separate, stick, slip [1];  violation : `Violation` of the law, its largest value
    steps, solves : Newton steps and applications of an inverse;  seconds : in all
    fromzero : Newton steps from rest without coarser meshes, 0 if that failed, None if it was not tried
    error : why it failed, "" if it did not
    """

    number: int
    words: str
    kind: str
    stiffness: float
    coefficient: float
    dofs: int = 0
    zones: tuple[float, ...] = ()
    violation: float = float("nan")
    steps: tuple[int, ...] = ()
    solves: tuple[int, ...] = ()
    seconds: float = 0.0
    fromzero: int | None = None
    error: str = ""

    @property
    def threezones(self) -> bool:
        return bool(self.zones) and min(self.zones) > 0


@ByKeyword
def Run(number: int, sample: Sample, *, solver: Solver | None = None, fromzero: Solver | None = None) -> Record:
    """The `Record` of a Sample, solved by a solver, by default the one that `Discretization.Solve` takes.

    fromzero : a second solver, `SemismoothNewtonSolver()`, whose steps from rest are recorded as well where h >= 1/32
    """
    known: dict[str, Any] = {"number": number, "words": sample.words, "kind": sample.kind, "stiffness": sample.stiffness,
             "coefficient": sample.coefficient}
    start = perf_counter()
    disc = sample.Disc()
    try:
        solution = (solver or NestedNewtonSolver()).Solve(disc)
    except (NotConvergedError, ProblemError) as error:
        return Record(**known, dofs=disc.space.ndof, seconds=perf_counter() - start, error=f"{type(error).__name__}: {error}")
    seconds, lengths = perf_counter() - start, np.array(list(solution.ZoneLengths().values()))
    return Record(**known, dofs=disc.space.ndof, zones=tuple((lengths / lengths.sum()).tolist()),
                  violation=float(Violation(solution).max()),
                  # Of a solver that has no coarser meshes all is on one.
                  steps=tuple(level.iterations for level in solution.levels) or (len(solution.history),),
                  solves=tuple(level.solves for level in solution.levels) or (disc.solves,), seconds=seconds,
                  fromzero=_Steps(fromzero, disc) if fromzero and sample.n <= FROMREST else None)


def _Steps(solver: Any, disc: Discretization) -> int:
    try:
        return len(solver.Solve(disc).history)
    except NotConvergedError:
        return 0


@ByKeyword
def Violation(solution: ContactSolution) -> Array:
    """min(|p - p_n(r)|/t_s, |r - p_n^-1(p)|/u_s) and the same for friction, the larger one at every point, (n,), no unit.

    For power laws p_n and the friction laws of the package; p_n^-1(0) is all of r <= 0, friction |t| <= p_t belongs to u_t = 0,
    and friction of the size p_t to all u_t against it.  t_s and u_s are the largest traction and displacement on Gamma_C, u_s
    not less than what t_s does to a body of the size of Gamma_C; the scale of friction is its largest bound, at least 1e-3 t_s.
    The bound belongs to the nearest point of the normal law: from r itself round-off times k_n would come in.
    """
    contact, problem = solution.disc.contact, solution.disc.problem
    # Of the traction that was found: `pressure` and `friction` are 0 where the law is.
    p, friction = contact.Normal(solution.traction), -contact.Tangential(solution.traction)
    r, slip = solution.penetration, contact.Tangential(contact.SinceOrigin(solution.displacement))
    slid, tscale = np.linalg.norm(slip, axis=1), np.sqrt(p ** 2 + np.sum(friction ** 2, axis=1)).max() or 1.0
    extent = np.ptp(solution.points, axis=0).max()
    uscale = max(np.linalg.norm(solution.displacement, axis=1).max(), tscale * extent / problem.material.ShearAt(
        contact.inside).min())
    normal, bound = np.empty_like(r), np.zeros_like(r)
    for part in contact.parts:
        here, law = part.points, part.compliance
        above = law.stiffness * np.maximum(r[here], 0) ** law.exponent
        inverse = np.where(p[here] > 0, (np.maximum(p[here], 0) / law.stiffness) ** (1 / law.exponent), np.minimum(r[here], 0))
        vertical = np.abs(p[here] - above) / tscale
        # A negative pressure is off the law by its size, wherever the point is.
        horizontal = np.where(p[here] < 0, np.inf, np.abs(r[here] - inverse) / uscale)
        normal[here] = np.minimum(vertical, horizontal)
        nearest = np.where(vertical < horizontal, (r[here], above), (inverse, p[here]))
        bound[here] = _Bound(part.friction, nearest[0], nearest[1], contact.path[here] + slid[here])
    fscale = max(bound.max(), 1e-3 * tscale)
    size = np.linalg.norm(friction, axis=1)
    stick = np.maximum(slid / uscale, (size - bound) / fscale)
    direction = slip / np.where(slid > 0, slid, 1)[:, None]
    sliding = np.where(slid > 0, np.linalg.norm(friction + bound[:, None] * direction, axis=1) / fscale, np.inf)
    # Friction of the size of the bound belongs to any slip against it: what is off is the part of the slip beside that ray.
    against = -friction / np.where(size > 0, size, 1)[:, None]
    along = np.maximum(np.sum(slip * against, axis=1), 0)
    beside = np.linalg.norm(slip - along[:, None] * against, axis=1) / uscale
    return np.maximum(normal, np.min([stick, sliding, np.maximum(np.abs(size - bound) / fscale, beside)], axis=0))


def _Bound(law: Any, r: Array, p: Array, slid: Array) -> Array:
    """p_t (n,) [stress] at points (r, p) of the normal law and paths of the slip."""
    if law is None:
        return 0 * r
    if isinstance(law, CoulombFriction):
        return law.coefficient * p
    if isinstance(law, TrescaFriction):
        return law.bound + 0 * r
    if isinstance(law, PowerFriction):
        return law.stiffness * np.maximum(r, 0) ** law.exponent
    if isinstance(law, SlipWeakeningFriction):
        return (law.dynamic + (law.static - law.dynamic) * np.exp(-slid / law.distance)) * p
    raise ProblemError(f"friction is {law!r}; its bound is known for the laws of the package alone, take one of them")


@ByKeyword
def Sweep(samples: Iterable[tuple[int, Sample]], file: IO[str], *, callback: Callable[[Record], object] | None = None,
          **options: Any) -> list[Record]:
    """The list of Records of `samples`, pairs (number, Sample); the rest are arguments of `Run`.

    Each Record goes into the text file as one line of JSON as soon as it is there, and then to `callback(record)`; Ctrl-C
    returns what is there.
    """
    return Recorded((Run(number, sample, **options) for number, sample in samples), file, callback)


@ByKeyword
def Samples(seed: int, count: int, *, dofs: float = 150_000) -> Iterator[tuple[int, Sample]]:
    """Pairs (number, Sample) of a seed; see `Draw`."""
    for number in range(count):
        yield number, Draw(seed, number, dofs=dofs)


@ByKeyword
def Tally(records: Sequence[Record]) -> str:
    """What to say about the records: how many failed and which, zones, worst violation, steps and applications."""
    solved = [record for record in records if not record.error]
    failed = [record for record in records if record.error]
    if not solved:
        return "\n".join([f"{len(records)} problems, none solved", *map(_Failure, failed)])
    three, finest = sum(record.threezones for record in solved), [record for record in solved if len(record.steps) > 1]
    worst = max(solved, key=lambda record: record.violation)
    lines = [f"{len(records)} problems, {len(failed)} failed ({100 * len(failed) / len(records):.1f} %); "
             f"all three zones in {three} ({100 * three / len(records):.0f} %)",
             f"law violation: at most {worst.violation:.1e} (number {worst.number})",
             f"largest problem: {max(r.dofs for r in solved)} unknowns; {sum(r.seconds for r in records):.0f} s in all",
             f"Newton steps, one mesh alone:            {_Spread(sum(r.steps) for r in solved if len(r.steps) == 1)}",
             f"Newton steps, finest of several meshes:  {_Spread(r.steps[-1] for r in finest)}",
             f"applications of an inverse, finest:      {_Spread(r.solves[-1] for r in solved)}",
             f"applications of an inverse, all meshes:  {_Spread(sum(r.solves) for r in solved)}"]
    fromzero = [record.fromzero for record in solved if record.fromzero is not None]
    if fromzero:
        lines.append(f"Newton steps from rest:                  {_Spread(fromzero)}; failed: {fromzero.count(0)}")
    for name, slow in ((f"more than {STEPS} steps on the finest mesh", [r for r in finest if r.steps[-1] > STEPS]),
                       (f"more than {SOLVES} applications on the finest mesh", [r for r in solved if r.solves[-1] > SOLVES])):
        lines += [f"{name}: {len(slow)}", *(f"  {r.number}: {r.steps[-1]} steps, {r.solves[-1]} applications; {r.words}"
                                            for r in slow)]
    kinds, lost = Counter(r.kind for r in records), Counter(r.kind for r in failed)
    lines.append("failed by law: " + ", ".join(f"{kind} {lost[kind]} of {kinds[kind]}" for kind in sorted(kinds)))
    (weak, weaklost), (strong, stronglost) = ([sum((r.coefficient > 0.5) == high for r in group) for group in (records, failed)]
                                              for high in (False, True))
    lines.append(f"failed by coefficient: up to 0.5 {weaklost} of {weak}, above {stronglost} of {strong}")
    return "\n".join([*lines, *map(_Failure, failed)])


def _Failure(record: Record) -> str:
    return f"FAILED {record.number}: {record.words}\n  {record.error}"


def _Spread(values: Any) -> str:
    values = list(values)
    if not values:
        return "none"
    return f"median {np.median(values):.0f}, 95 % at most {np.percentile(values, 95):.0f}, largest {max(values)}"


@ByKeyword
def Line(record: Record) -> str:
    """One line for the terminal."""
    state = "FAILED" if record.error else f"steps {list(record.steps)} applications {list(record.solves)}"
    return f"{record.number}: {record.words}: {state}, {record.seconds:.1f} s"
