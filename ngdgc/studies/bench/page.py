"""Tables, figure and page of the benchmark."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ...plots import GrowthFigure
from ...tools.tables import Aligned, Piped
from .solutions import TOL, Cost, Growth

HEADER = ("problem", "unknowns", "setup", "assembly", "coarse", "inverse", "contact", "total", "reference", "total/reference",
          "steps", "solves", "cycles", "alone", "by", "peak [GiB]")


def _Cells(cost: Cost) -> list[str]:
    point = cost.point
    medians = [f"{np.median(times):.2f}" for times in (cost.setup, cost.assembly, cost.coarse, cost.inverse, cost.contact,
                                                       cost.total)]
    reference = [f"{np.median(cost.reference):.2f}", f"{cost.ratio:.2f}"] if len(cost.reference) else ["", ""]
    cycles = [str(cost.cycles), str(cost.linear)] if cost.linear else ["", ""]
    return [f"{point.method}, k = {point.order}, n = {point.n}", f"{cost.dofs}", *medians, *reference, str(cost.iterations),
            str(cost.solves), *cycles, cost.kind, f"{cost.peak / 1024:.2f}"]


def _Growths(benches: Mapping[str, Sequence[Cost]]) -> list[tuple[str, float]]:
    """(name, exponent) of the benches in which only the size varies."""
    return [(name, Growth(costs)) for name, costs in benches.items()
            if len({cost.point.n for cost in costs}) == len(costs) > 1 and len({cost.point.order for cost in costs}) == 1]


def Text(benches: Mapping[str, Sequence[Cost]], peers: Iterable[str]) -> str:
    """The tables for a terminal.

    benches : {name: list of `bench.solutions.Cost`};  peers : lines of text
    """
    lines = []
    for name, costs in benches.items():
        lines += ["", name, *Aligned([HEADER, *map(_Cells, costs)], numbers=True)]
    lines += ["", *(f"{name}: time grows as unknowns^{exponent:.2f}" for name, exponent in _Growths(benches)), "", *peers]
    return "\n".join(lines[1:])


def Compared(name: str, result: Any, ours: Cost | None) -> str:
    """A line on a peer: a dict of `solutions.Peer` beside our Cost of the same problem, or the reason why there is none."""
    if isinstance(result, str) or ours is None:
        return f"{name}: skipped, {result}"
    what, own = ("the whole solution", ours.total) if name == "GetFEM" else ("the assembly", ours.assembly)
    seconds, own = result["seconds"], np.median(own)
    return (f"{name}: {seconds:.2f} s for {what} of {result['dofs']} unknowns, {seconds / own:.2g} times ours, {own:.2f} s for "
            f"{ours.dofs} unknowns")


def Figures(benches: Mapping[str, Sequence[Cost]]) -> dict[str, Figure]:
    """{name: figure}: growth in 2D and 3D."""
    panels: dict[str, Any] = {}
    for name, _ in _Growths(benches):
        solid = benches[name][0].point.problem == "box"
        panels.setdefault("Three dimensions" if solid else "Two dimensions", {})[name] = benches[name]
    return {"performance": GrowthFigure(panels)} if panels else {}


INTRODUCTION = """# Performance

Written by `ngdgc bench --page docs/performance.md`; nothing on this page is typed by hand but the explanations.  Seconds are
{runs} on {processors} processors, and vary with the machine; what counts are
ratios to the *reference* of the same run: NGSolve's sparse Cholesky factorisation of the same matrix and one solve with it
(where its factors are too large it is left out).  Everything is solved to a law residual of {tol:g} by `Solve(disc)`.

* setup: spaces, checks of the data, the contact boundary;  assembly: the matrix, with penalty and coercivity check
* coarse: everything on coarser meshes;  inverse: factorisation on the finest mesh, or the preconditioner
* contact: loads, Newton steps and their solves on the finest mesh;  total: from the mesh in memory to the solution
* steps: of Newton's method, or corrections, and solves: applications of the inverse, both on the finest mesh
* cycles: steps of conjugate gradients for all of that, where they are the inverse;  alone: for one linear equation to {tol:g}
* by: how the linear equations are solved, as chosen by the size;  peak: the largest memory of the process
"""


def Page(benches: Mapping[str, Sequence[Cost]], peers: Iterable[str], processors: int) -> str:
    """The page, Markdown; its figure is images/performance.png of `Figures`."""
    repeat = max(len(cost.total) for costs in benches.values() for cost in costs)
    runs = f"medians over {repeat} runs, of the largest problems over one," if repeat > 1 else "of one run"
    lines = [INTRODUCTION.format(tol=TOL, processors=processors, runs=runs)]
    if _Growths(benches):
        lines += ["![Time against unknowns](images/performance.png)", ""]
        lines += [*(f"* {name}: time grows as unknowns^{exponent:.2f}" for name, exponent in _Growths(benches)), ""]
    for name, costs in benches.items():
        lines += [f"## {name}", "", *Piped([HEADER, *map(_Cells, costs)]), ""]
    return "\n".join([*lines, "## Other codes, and memory", "", *(f"* {line}" for line in peers), ""])
