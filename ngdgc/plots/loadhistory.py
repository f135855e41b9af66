"""Forces and energies of a load history."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ..exceptions import ProblemError
from ..histories.history import LoadHistory
from ..tools.calls import ByKeyword
from ..tools.units import InUnits, UnitsOf
from ..tools.values import Reals
from .canvas import BLUE, FOUNDATION_COLOURS, GREEN, ORANGE, PURPLE, VERMILION, WIDTH, Panel

STYLES = "-", "--", ":"


@ByKeyword
def LoadHistoryFigure(history: LoadHistory, *, against: Any = None) -> Figure:
    """Forces of the foundations on the body, and where the work goes, along a `LoadHistory`.

    against : (m,), what is drawn on the abscissa of the forces, such as a prescribed displacement [length]; None: the times

    Left the components of the force of every foundation [stress length^(d-1)]; right work, energy, dissipation and abrasion
    over time [stress length^d], and their balance.  Raises ProblemError for anything but a LoadHistory, and values of another
    number.

    >>> from ngsolve import Parameter
    >>> from ngdgc import *
    >>> from ngdgc.meshes import RectangleMesh
    >>> t = Parameter(0)
    >>> problem = ContactProblem(HookeMaterial(E=10, nu=0.3), Foundation("bottom", NormalCompliance(5)),
    ...                          dirichlet={"top": (0, -0.1 * t)})
    >>> history = SolveHistory(Discretization(problem, LDG(), RectangleMesh(2)), parameter=t, times=[0, 0.5, 1])
    >>> figure = LoadHistoryFigure(history)
    """
    if not isinstance(history, LoadHistory) or not len(history):
        raise ProblemError(f"history is {history!r}; give a LoadHistory with states, which SolveHistory returns")
    abscissa = history.times if against is None else Reals(against, history.times.shape)
    if abscissa is None:
        raise ProblemError(f"against is {against!r}; give one number for each of the {len(history)} states")
    units, dim = UnitsOf(history[-1]), history[-1].disc.mesh.dim
    force = InUnits(f"force on the body [stress length{'^2' if dim == 3 else ''}]", units, bare=True)
    work = InUnits(f"work [stress length^{dim}]", units, bare=True)
    figure = Figure(figsize=(1.5 * WIDTH, 3.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    for colour, (region, forces) in zip(FOUNDATION_COLOURS * len(history.forces), history.forces.items()):
        for style, axis, component in zip(STYLES, "xyz", forces.T):
            left.plot(abscissa, component, style, color=colour, label=f"{region}, $F_{axis}$", marker=".", markersize=3)
    shown = "time" if against is None else InUnits("displacement [length]", units)
    Panel(left, xlabel=shown, ylabel=force).legend(frameon=False)
    parts = ["energy", "dissipation", *["abrasion"] * history.disc.contact.wears]
    for name, colour in zip(("work", *parts), (BLUE, GREEN, VERMILION, PURPLE)):
        right.plot(history.times, getattr(history, name), color=colour, label=name)
    balance = sum(getattr(history, name) for name in parts)
    if np.all(np.isfinite(balance)):
        right.plot(history.times, balance, ":", color=ORANGE, label=" + ".join(parts), linewidth=2.5, zorder=1)
    Panel(right, xlabel="time", ylabel=work).legend(frameon=False)
    return figure
