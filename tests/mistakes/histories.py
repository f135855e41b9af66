"""Mistakes with load histories, as in `mistakes`."""

from unittest.mock import patch

import numpy as np
from ngsolve import CF, Parameter

from ngdgc import (ContactProblem, CoulombFriction, Discretization, EstimateError, EstimateForce, EstimateZones, Foundation,
                   HookeMaterial, InteriorPenalty, LoadHistory, NormalCompliance, SolveHistory, UzawaSolver)
from ngdgc.estimates.residual import ResidualEstimate
from ngdgc.histories import solve
from ngdgc.meshes import RectangleMesh
from ngdgc.plots import LoadHistoryFigure


def History(data=lambda t: {"dirichlet": {"top": CF((0.01 * t, -0.02))}}, *, times=(1, 2), n=2, friction=0.3, E=1000,
            **options):
    """A block on its foundation, led along a time."""
    t = Parameter(0)
    foundation = Foundation("bottom", NormalCompliance(1e4), friction=CoulombFriction(friction))
    material = HookeMaterial(E=E if not callable(E) else E(t), nu=0.3)
    problem = ContactProblem(material, foundation, **data(t))
    disc = Discretization(problem, InteriorPenalty(), RectangleMesh(n))
    return SolveHistory(disc, **{"parameter": t, "times": times, **options})


def Still(_):
    return {"dirichlet": {"top": CF((0.01, -0.02))}}


def Dragged(t):
    """A force that in the end is more than friction holds."""
    return {"traction": {"top": CF((t, -10))}}


def Failing():
    """In the third of its states, and not in ever smaller parts of its increment, which takes longer."""
    with patch.object(solve, "HALVINGS", 0):
        History(Dragged, times=(1, 2, 8))


def Interrupted():
    """Ctrl-C in the second increment."""
    def Stop(increment):
        if increment.time == 2:
            raise KeyboardInterrupt

    History(callback=Stop)


HISTORIES = [
    (lambda _: History(parameter=1), "parameter is 1 | the ngsolve.Parameter on which the data depend | give"),
    (lambda _: History(parameter=Parameter(0)), "no datum of the problem depends on it | dirichlet={'top': | use it in"),
    (lambda _: History(Still), "no datum of the problem depends on it | would be the same | use it in"),
    (lambda _: History(E=lambda t: 1000 + t), "depends on the parameter | keeps its matrix | give the time to loads"),
    (lambda _: History(times=3), "times is 3 | numbers that increase | give"),
    (lambda _: History(times=()), "times is empty | np.linspace(0, 1, 21) | give"),
    (lambda _: History(times=(0, "1")), "a time is '1' | numbers that increase | give"),
    (lambda _: History(times=(0, 1, 0.5)), "times run backwards | 0.5 comes after 1 | give numbers that increase"),
    (lambda _: History(start=3), "start is 3 | a LoadHistory with at least one state | give"),
    (lambda _: History(start=History(times=(1, 3))), "times begin at 1 | start ends at 3 | give times from there on"),
    (lambda _: History(start=History(times=(0, 1), n=4)), "start is of Discretization(IP | 32 elements | give the same mesh"),
    (lambda _: History(start=History(times=(0, 1), friction=0.4)),
     "start was computed with another problem | at time 1 its bounds differ | give the problem"),
    (lambda _: History(solver=UzawaSolver()), "solver is UzawaSolver( | which start from the last state | give"),
    (lambda _: History().disc.After(np.zeros((3, 2))), "shape (3, 2) | this Gamma_C (4, 2) | give arrays of a state"),
    (lambda _: History(change=1), "change is 1 | between 0 and 1 | such as 0.1"),
    (lambda _: History(callback=3), "callback is 3 | a function of a Step | give"),
    (lambda _: History()[2], "history[2] | there are 2 states | give an integer from -2 to 1"),
    (lambda _: History(lambda t: {"dirichlet": {"top": CF((0.01 / (t - 2), -0.02))}}),
     "at time 2: dirichlet['top'] | not finite | look"),
    (lambda _: Failing(), "at time 8: | push it along harder than friction holds | 2 states before"),
    (lambda folder: History()[:0].Save(folder), "the history has no state yet | that has | save one"),
    (lambda folder: LoadHistory.Load(folder / "none", None, parameter=Parameter(0)),
     "holds no history | LoadHistory.Save has written | give"),
    (lambda folder: LoadHistory.Load(folder, None, parameter=3),
     "parameter is 3 | the ngsolve.Parameter on which the data depend | give"),
    (lambda _: LoadHistoryFigure(3), "history is 3 | which SolveHistory returns | give"),
    (lambda _: LoadHistoryFigure(History(), against=[1]), "against is [1] | each of the 2 states | give one number"),
    (lambda _: EstimateError(History()[1]), "a state of a history | slip counts from the state before | from rest"),
    (lambda _: EstimateForce(History()[1]), "a state of a history | slip counts from the state before | from rest"),
    (lambda _: EstimateZones(History()[1]), "a state of a history | slip counts from the state before | from rest"),
    (lambda _: ResidualEstimate(History()[1]), "a state of a history | slip counts from the state before | from rest"),
    (lambda _: Interrupted(), "interrupted after 2 states | they are | its attribute states")]
