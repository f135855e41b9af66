"""Tables, figure and page of the benchmark."""

import numpy as np

from .bench import TOL, Growth
from .plots import GrowthFigure

HEADER = ("problem", "unknowns", "setup", "assembly", "coarse", "inverse", "contact", "total", "reference", "total/reference",
          "steps", "solves", "by", "peak [GiB]")


def _Cells(cost):
    point = cost.point
    medians = [f"{np.median(times):.2f}" for times in (cost.setup, cost.assembly, cost.coarse, cost.inverse, cost.contact,
                                                       cost.total)]
    reference = [f"{np.median(cost.reference):.2f}", f"{cost.ratio:.2f}"] if len(cost.reference) else ["", ""]
    return [f"{point.method}, k = {point.order}, n = {point.n}", f"{cost.dofs}", *medians, *reference, str(cost.iterations),
            str(cost.solves), cost.kind, f"{cost.peak / 1024:.2f}"]


def _Growths(benches):
    """(name, exponent) of the benches in which only the size varies."""
    return [(name, Growth(costs)) for name, costs in benches.items()
            if len({cost.point.n for cost in costs}) == len(costs) > 1 and len({cost.point.order for cost in costs}) == 1]


def Text(benches, peers):
    """The tables for a terminal.

    benches : {name: list of `bench.Cost`};  peers : lines of text
    """
    lines = []
    for name, costs in benches.items():
        cells = [HEADER, *map(_Cells, costs)]
        widths = [max(map(len, column)) for column in zip(*cells)]
        lines += ["", name, *("  ".join(cell.rjust(width) for cell, width in zip(row, widths)) for row in cells)]
    lines += ["", *(f"{name}: time grows as unknowns^{exponent:.2f}" for name, exponent in _Growths(benches)), "", *peers]
    return "\n".join(lines[1:])


def Compared(name, result, ours):
    """A line on a peer: a dict of `bench.Peer` beside our Cost of the same problem, or the reason why there is none."""
    if isinstance(result, str):
        return f"{name}: skipped, {result}"
    what, own = ("the whole solution", ours.total) if name == "GetFEM" else ("the assembly", ours.assembly)
    seconds, own = result["seconds"], np.median(own)
    return (f"{name}: {seconds:.2f} s for {what} of {result['dofs']} unknowns, {seconds / own:.2g} times ours, {own:.2f} s for "
            f"{ours.dofs} unknowns")


def Figures(benches):
    """{name: figure}: growth in 2D and 3D."""
    panels = {}
    for name, _ in _Growths(benches):
        solid = benches[name][0].point.problem == "box"
        panels.setdefault("Three dimensions" if solid else "Two dimensions", {})[name] = benches[name]
    return {"performance": GrowthFigure(panels)} if panels else {}


INTRODUCTION = """# Performance

Written by `ngdgc bench --page docs/performance.md`; nothing on this page is typed by hand but the explanations.  Seconds are
medians over {repeat} runs, of the largest problems over one, on {processors} processors, and vary with the machine; what
counts are ratios to the *reference* of the same run: NGSolve's sparse Cholesky factorisation of the same matrix and one solve
with it (where its factors are too large it is left out).  Everything is solved to a law residual of {tol:g} by `Solve(disc)`.

* setup: spaces, checks of the data, the contact boundary;  assembly: the matrix, with penalty and coercivity check
* coarse: everything on coarser meshes;  inverse: factorisation on the finest mesh, or the preconditioner
* contact: loads, Newton steps and their solves on the finest mesh;  total: from the mesh in memory to the solution
* steps: of Newton's method, and solves: applications of the inverse, both on the finest mesh
* by: how the linear equations are solved, as chosen by the size;  peak: the largest memory of the process
"""


def Page(benches, peers, processors):
    """The page, Markdown; its figure is images/performance.png of `Figures`."""
    repeat = max(len(cost.total) for costs in benches.values() for cost in costs)
    lines = [INTRODUCTION.format(tol=TOL, processors=processors, repeat=repeat)]
    if _Growths(benches):
        lines += ["![Time against unknowns](images/performance.png)", ""]
        lines += [*(f"* {name}: time grows as unknowns^{exponent:.2f}" for name, exponent in _Growths(benches)), ""]
    for name, costs in benches.items():
        lines += [f"## {name}", "", "| " + " | ".join(HEADER) + " |", "|---" * len(HEADER) + "|",
                  *("| " + " | ".join(_Cells(cost)) + " |" for cost in costs), ""]
    return "\n".join([*lines, "## Other codes", "", *(f"* {line}" for line in peers), ""])
