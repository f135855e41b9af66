"""Tables and page of what is measured of ranks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...distributed.subspace import FACTORISED
from ...tools.tables import Aligned, Piped
from .ranks import COARSE, ONEMACHINE, Spread
from .scaling import GAMMA, PLANS, Law

EQUATION = ("unknowns", "ranks", *(f"steps, {name}" for name in COARSE), "ghosts [%]", "messages", "kB", "sums",
            "kB/unknown", "largest [MiB]")
CONTACT = ("unknowns", "ranks", "points", "corrections", "steps", "X_h", "factors", "kB/unknown", "largest [MiB]")
TIME = ("ranks", "seconds", "of one machine", "of one rank", "processor")


def Equations(rows: Sequence[Spread]) -> list[tuple[str, ...]]:
    """Cells on one linear equation, the head first."""
    cells: list[tuple[str, ...]] = [EQUATION]
    for row in rows:
        if not row.task.contact:
            steps = [str(row.steps.get(name, "")) for name in COARSE]
            cells.append((str(row.unknowns), str(row.task.ranks), *steps, f"{100 * row.ghosts:.1f}", f"{row.messages:.0f}",
                          f"{row.bytes / 1e3:.0f}", f"{row.sums:.1f}", *_Memory(row)))
    return cells


def Contacts(rows: Sequence[Spread]) -> list[tuple[str, ...]]:
    """Cells on the contact problem, the first run of each size and number of ranks."""
    cells: list[tuple[str, ...]] = [CONTACT]
    first = {row.task: row for row in reversed(rows) if row.task.contact}
    for row in sorted(first.values(), key=lambda row: (row.unknowns, row.task.ranks)):
        cells.append((str(row.unknowns), str(row.task.ranks or "one machine"), str(row.points), str(row.corrections),
                      str(row.cycles), str(row.subspace or ""), f"{row.factors:.3g}" if row.factors else "", *_Memory(row)))
    return cells


def _Memory(row: Spread) -> tuple[str, str]:
    return f"{row.each:.2f}", f"{max(row.peak):.0f}"


def Times(rows: Sequence[Spread]) -> list[tuple[str, ...]]:
    """Cells on runs of one size beside each other, medians; empty where each was run but once."""
    runs: dict[tuple[int, int], list[Spread]] = {}
    for row in rows:
        if row.task.contact:
            runs.setdefault((row.unknowns, row.task.ranks), []).append(row)
    repeated = {key: group for key, group in runs.items() if len(group) > 1}
    if not repeated:
        return []
    size = max(unknowns for unknowns, _ in repeated)
    medians = {ranks: float(np.median([row.seconds for row in group])) for (n, ranks), group in repeated.items() if n == size}
    cells: list[tuple[str, ...]] = [TIME]
    for ranks, seconds in sorted(medians.items()):
        busy = np.median([row.busy for row in repeated[size, ranks]])
        cells.append((str(ranks or "one machine"), f"{seconds:.1f}", f"{seconds / medians[ONEMACHINE]:.2f}",
                      f"{seconds / medians[1]:.2f}" if ranks else "", f"{busy:.1f}"))
    return cells


def Plans(rows: Sequence[Spread]) -> list[tuple[str, ...]]:
    """Cells on what the formulas say, of the largest run that was measured too."""
    law, largest = Law.Of(rows), max((row for row in rows if row.task.ranks > 1), key=lambda row: row.unknowns)
    points = [(largest.unknowns, largest.task.ranks), *PLANS]
    found = [law.At(*point) for point in points]
    cells: list[tuple[str, ...]] = [("unknowns", *(f"{n:.3g}" for n, _ in points)), ("ranks", *(str(p) for _, p in points))]
    return cells + [(name, *(f"{one[name]:.3g}" for one in found)) for name in found[0]]


def Text(rows: Sequence[Spread]) -> str:
    """The tables for a terminal."""
    tables = [Equations(rows), Contacts(rows), Times(rows), Plans(rows)]
    return "\n\n".join("\n".join(Aligned(table, numbers=True)) for table in tables if len(table) > 1)


INTRODUCTION = """# Many ranks

Written by `ngdgc bench ranks --page docs/scaling.md`; nothing on this page is typed by hand but the explanations.  A box of
tetrahedra of order 1, interior penalty, nu = 0.3, is pressed onto a foundation as stiff as itself with friction 0.3, and spread
over *ranks* ([beyond one machine](distributed.md)), all of them on one machine with {processors} processors.  With more ranks
than processors counts and memory are what they are elsewhere, times are not, and none are shown.  Rows may be kept from
earlier runs (`--rows`): such a one has the steps and the memory of the code of then.

## One linear equation

Steps of conjugate gradients to a relative residual of 1e-8.  ghosts: neighbours that a rank has beside its own elements;
messages, kB, sums: what the busiest rank sends in one step, and global sums; kB/unknown: memory of all ranks beyond what a
process has before there is a mesh, with all that was made on the way; largest: all memory of the largest rank.
"""
CONTACT_WORDS = """## Contact

The whole problem to a law residual of 1e-8, and the same on one machine without PETSc.  corrections and steps: of Newton's
method in X_h, and of conjugate gradients in V_h for all of them; X_h: unknowns of the subspace near Gamma_C; factors: entries
of those of its matrix; where there are none it is solved by conjugate gradients too.
"""
TIME_WORDS = """## Time

The contact problem with {unknowns} unknowns, medians of {runs} runs that took turns: seconds from the coarse mesh to the
solution, and of the processors.
"""
PLAN_WORDS = """## A billion unknowns on a thousand ranks

What was measured here goes to {ranks} ranks and {unknowns} unknowns; the rest of the table is extrapolated.  A rank with
m = N/p of the N unknowns is thought of as a cube in a cube of p of them: it has s = 6 (1 - p^(-1/3)) sides in the mean, and the
box of n cells per side has N = 72 n^3 unknowns and 6 n^2 contact points.  Constants are fitted to the tables above:

* ghosts = {law.ghosts:.2f} s m^(-1/3), neighbours over own elements
* bytes = {law.bytes:.1f} s m^(2/3), that a rank sends in a step
* steps = {start:.1f} + {slope:.2f} log10 N
* memory = {law.fixed:.0f} MiB + {law.each:.2f} kB m + {gamma} numbers at each contact point, as many on every rank, reckoned
* X_h = N/24 + {law.subspace:.1f} N^(2/3) unknowns, and {law.factors:.1f} X_h^(4/3) entries in its factors
"""
BREAKS = """What breaks first, in this order:

1. Gamma_C on every rank: its arrays, and above all the products that Newton's method remembers, do not get smaller with more
   ranks.  They are as large as a rank's part of the body at about a hundred million unknowns; beyond, they have to be spread
   over the ranks as well.  At a billion each application in X_h gathers {gathered:.0f} MB on every rank.
2. The factors of X_h, whose memory grows faster than the body: from {factorised} unknowns of X_h on conjugate gradients take
   their place, with the same cycle as in V_h, and then each application takes some 30 steps with their messages.
3. The coarse mesh, which every rank reads and rank 0 alone distributes: with some hundred elements a rank it has a hundred
   thousand for a thousand ranks.
4. Numbers of 32 bits, with which PETSc is built as a rule: they end at 2 147 483 647 unknowns.
"""


def Page(rows: Sequence[Spread], processors: int) -> str:
    """The page, Markdown."""
    law, largest = Law.Of(rows), max(rows, key=lambda row: row.unknowns)
    lines = [INTRODUCTION.format(processors=processors), *Piped(Equations(rows)), "", CONTACT_WORDS, *Piped(Contacts(rows)), ""]
    if times := Times(rows):
        timed = [row for row in rows if row.task.contact and row.task.ranks == ONEMACHINE]
        most = max(timed, key=lambda row: sum(other.task == row.task for other in timed))
        runs = sum(row.task == most.task for row in timed)
        lines += [TIME_WORDS.format(unknowns=most.unknowns, runs=runs), *Piped(times), ""]
    start, slope = law.steps
    lines += [PLAN_WORDS.format(law=law, start=start, slope=slope, gamma=GAMMA, unknowns=largest.unknowns,
                                ranks=max(row.task.ranks for row in rows)), *Piped(Plans(rows)), ""]
    points = law.At(*PLANS[-1])["points"]
    return "\n".join([*lines, BREAKS.format(factorised=FACTORISED, gathered=24 * points / 1e6)])
