"""Tables and figures of the atlas of solvers, for a terminal, a page of the documentation and a spreadsheet."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping, Sequence
from textwrap import fill
from typing import IO, Any

from matplotlib.figure import Figure

from ...plots import AtlasFigure
from ...tools.tables import Aligned, Piped
from . import solvers as atlas
from .solvers import Row, Sweep

TITLES = {"own": "The paper's examples", "stiffness": "Stiffness of the foundation", "coefficient": "Friction coefficient",
          "size": "Mesh size", "order": "Order", "method": "Method", "box": "Three dimensions"}
# Figures by the first word of their sweeps' names: the variable, and the quantities drawn.
FIGURES = {"stiffness": ("stiffness", ("iterations", "solves")), "coefficient": ("coefficient", ("iterations", "solves")),
           "size": ("n", ("solves", "seconds"))}


class Table:
    """Rows as comma-separated values in an open text file, each as soon as it comes, so that an interruption loses none."""

    def __init__(self, file: IO[str]) -> None:
        self.file = file
        self.writer: csv.DictWriter[str] | None = None

    def Add(self, row: Row) -> None:
        flat = row.Flat()
        if self.writer is None:
            self.writer = csv.DictWriter(self.file, flat, lineterminator="\n")
            self.writer.writeheader()
        self.writer.writerow({name: f"{value:.4g}" if isinstance(value, float) else value for name, value in flat.items()})
        self.file.flush()


def Sections(rows: Sequence[Row], sweeps: Mapping[str, Sweep]) -> tuple[list[Any], dict[str, int]]:
    """(sweep name, head, cells) of each sweep with rows: cells are texts, a line for each point and a column for each solver;
    then the reasons that they refer to by number, {reason: number}."""
    labels = [label for label in atlas.Solvers() if any(row.solver == label for row in rows)]
    reasons: dict[str, int] = {}
    found: list[Any] = []
    for name, sweep in sweeps.items():
        own = {(row.point, row.solver): row for row in rows if row.sweep == name}
        lines = []
        for point in sweep.points:
            if any(key[0] == point for key in own):
                value = getattr(point, sweep.variable)
                lines.append([f"{value:g}" if isinstance(value, float) else str(value),
                              *(_Cell(own.get((point, label)), reasons) for label in labels)])
        if lines:
            found.append((name, [atlas.VARIABLES[sweep.variable], *labels], lines))
    return found, reasons


def _Cell(row: Row | None, reasons: dict[str, int]) -> str:
    """Iterations / applications (+ those on coarser meshes) / seconds, or a dash and the number of the reason."""
    if row is None:
        return ""
    if not row.converged:
        return f"- ({reasons.setdefault(row.reason, len(reasons) + 1)})"
    coarser = f"+{row.coarser}" if row.coarser else ""
    return f"{row.iterations} / {row.solves}{coarser} / {row.seconds:.2g}"


def Reasons(rows: Sequence[Row], reasons: Mapping[str, int]) -> Iterator[str]:
    """Lines "(number) reason", with how long it took to see it."""
    for reason, number in reasons.items():
        counts = sorted({row.iterations for row in rows if row.reason == reason and row.iterations})
        span = " to ".join(str(count) for count in dict.fromkeys(counts[:1] + counts[-1:]))
        yield f"({number}) {reason}" + (f"; seen after {span} iterations" if counts else "")


def Agreement(rows: Sequence[Row]) -> str:
    """A sentence: how far the solutions of different solvers are apart."""
    differences = sorted(row.difference for row in rows if row.difference is not None)
    if not differences:
        return "No point was solved by two solvers."
    return (f"Of {len(differences)} solutions that can be compared with that of another solver at the same point, half agree\n"
            f"to {differences[len(differences) // 2]:.1e}, 95 % to {differences[int(0.95 * (len(differences) - 1))]:.1e}, and "
            f"the farthest are {differences[-1]:.1e} apart,\nrelative, in displacement and projected traction.")


def Text(rows: Sequence[Row], sweeps: Mapping[str, Sweep]) -> str:
    """The tables for a terminal."""
    sections, reasons = Sections(rows, sweeps)
    lines = ["iterations / applications of an inverse (+ on coarser meshes) / seconds"]
    for name, head, cells in sections:
        lines += ["", sweeps[name].what, *Aligned([head, *cells])]
    return "\n".join([*lines, "", *Reasons(rows, reasons), Agreement(rows)])


def Figures(rows: Sequence[Row], sweeps: Mapping[str, Sweep]) -> dict[str, Figure]:
    """{name: figure} against stiffness, friction coefficient and mesh size, of the sweeps that have rows."""
    figures = {}
    for kind, (variable, quantities) in FIGURES.items():
        panels = {sweep.what: [row for row in rows if row.sweep == name] for name, sweep in sweeps.items()
                  if name.split()[0] == kind}
        panels = {what: own for what, own in panels.items() if own}
        if panels:
            figures[f"atlas_{kind}"] = AtlasFigure(panels, variable, quantities)
    return figures


INTRODUCTION = """# Atlas of solvers

Written by `ngdgc atlas --page docs/atlas.md`, which `python docs/regenerate.py` runs; nothing on this page is typed by hand
but the explanations.  To our knowledge it is the first published comparison of this kind for discontinuous Galerkin
methods with friction.

| name | solver |
|---|---|
{solvers}

* Uzawa: the paper's iteration, with the normal compliance explicit and rho = "auto".
* implicit: its normal compliance and friction by a proximal step, which no stiffness of the foundation can break.
* Newton: semismooth, from rest, on the given mesh alone; nested Newton: the same on coarser meshes first, the default.

The tolerance is {tol:g}, the paper's, and Uzawa's iterations end after {limit}.  A cell reads iterations / applications of an
inverse / seconds, those of nested iteration `on this mesh + on the coarser ones`; figures show those on this mesh.
Applications count everything: the response to the loads, the estimates behind rho = "auto", line searches.  Seconds are of
one run and vary with the machine and with what else it does: all of the solver with its factorisations and coarser meshes,
without the matrix of the mesh itself.  All runs are in [atlas.csv](atlas.csv), which has the factorisation by itself.

Problems: the paper's examples with their own data; their geometries and loads with p_n = k_n r and Coulomb friction; and the
block, a unit square with E = 1000 and nu = 0.3 that is pressed by 0.02 and sheared by 0.002 onto a rounded foundation, gap
(x - 1/2)^2/10, so that it sticks in the middle, slips beside it and is free at the ends.  Unless varied: plane strain for the
block and plane stress for the examples, interior penalty (edge form, automatic penalty), k = 1, n = {n}, k_n = {stiffness:g} E,
coefficient {coefficient:g}.  A soft foundation is k_n = {stiffness:g} E, a stiff one k_n = {stiff:g} E.
"""

LOOK = {
    "own": "What the paper solves: slip nearly everywhere and a soft foundation.  Everything converges, and the prices differ "
           "by a small factor.",
    "stiffness": "Explicit lines end where |p_n' S_nn| comes near 1, whatever rho is; acceleration shifts that little.  "
                 "Implicit ones can go on to the rigid limit, where nothing depends on the stiffness any more.  The plain one "
                 "pays with the ratio of the extreme eigenvalues of S, Anderson's with something like its root.  The adaptive "
                 "step is cheap where all points slip; where some stick its residual may rest so long that the driver takes it "
                 "for lost, and its line has holes.  Newton's lines are level.",
    "coefficient": "The jump on the soft foundation is where the first points stick: their error shrinks with the smallest "
                   "eigenvalue of S, while slipping points only follow.  Beyond it the coefficient matters little.",
    "size": "The smallest eigenvalue of S falls with h, so refinement makes every iteration of first order slower, and "
            "Newton's steps from rest become more.  Nested iteration starts next to the solution: its steps on the finest "
            "mesh do not grow.",
    "order": "Higher order spreads the eigenvalues of S as refinement does; nested iteration does not notice.  (The mesh n = 8 "
             "has no coarser one for k = 1: 20 contact points or fewer need no prediction.)",
    "method": "The methods differ in the body, not in the law: prices differ by a factor of two or so, although the driver "
              "may lose patience with one method and not with another.  Edge and lifting form are the same "
              "matrices on triangles with constant data, and round-off is all that parts them.",
    "box": "Friction with two tangential components."}


def Page(rows: Sequence[Row], sweeps: Mapping[str, Sweep]) -> str:
    """The page, Markdown; its figures are images/NAME.png of `Figures`."""
    sections, reasons = Sections(rows, sweeps)
    base, figures = atlas.Point(), Figures(rows, sweeps)
    lines = [INTRODUCTION.format(solvers="\n".join(f"| {name} | `{solver!r}` |" for name, solver in atlas.Solvers().items()),
                                 tol=atlas.TOL, limit=atlas.LIMIT, n=base.n, stiffness=base.stiffness,
                                 coefficient=base.coefficient, stiff=atlas.STIFF), "## Do they agree?", "", Agreement(rows), ""]
    if reasons:
        lines += ["## Why there is no number", "", *(f"* {line}" for line in Reasons(rows, reasons)), ""]
    for kind, text in LOOK.items():
        own = [section for section in sections if section[0].split()[0] == kind]
        if own:
            lines += [f"## {TITLES[kind]}", "", fill(text, 118), ""]
            lines += [f"![{TITLES[kind]}](images/atlas_{kind}.png)", ""] if f"atlas_{kind}" in figures else []
            for name, head, cells in own:
                lines += [f"### {sweeps[name].what}", "", *Piped([head, *cells]), ""]
    return "\n".join(lines)
