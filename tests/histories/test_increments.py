"""The ways an increment can take where it is hard: all of them lead to the same states."""

from dataclasses import replace

import numpy as np
import pytest
from ngsolve import CF, IfPos, Parameter

from ngdgc import (ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, SolveHistory)
from ngdgc.histories import increments
from ngdgc.histories.increments import Increments
from ngdgc.histories.known import KnownResponse
from ngdgc.histories.solve import _Run
from ngdgc.meshes import RectangleMesh


def Dragged(n=6, times=(1, 2, 3, 4)):
    """A block pressed until 1, dragged until 2, and brought back until 4: large increments."""
    t = Parameter(0)
    top = CF((0.03 * IfPos(1 - t, 0, IfPos(2 - t, t - 1, 0.5 * (4 - t))), -0.02 * IfPos(1 - t, t, 1)))
    foundation = Foundation("bottom", NormalCompliance(1e5), friction=CoulombFriction(0.3))
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, dirichlet={"top": top})
    return SolveHistory(Discretization(problem, InteriorPenalty(), RectangleMesh(n), order=1), parameter=t, times=times)


@pytest.fixture
def seen(monkeypatch):
    """How often each way is taken."""
    counts = {}

    def Count(kind, name):
        function, counts[name] = getattr(kind, name), 0

        def Counted(*arguments, **options):
            counts[name] += 1
            return function(*arguments, **options)

        monkeypatch.setattr(kind, name, Counted)

    for kind, name in ((_Run, "_Solved"), (KnownResponse, "Learn"), (Increments, "__init__")):
        Count(kind, name)
    return counts


@pytest.fixture(scope="module")
def usual():
    return Dragged()


@pytest.mark.parametrize("failing, taken", [(0, [2]), (1, [1, 4]), (2, [1, 1, 8])])
def test_substeps_lead_to_the_same_states(usual, seen, monkeypatch, failing, taken):
    """Newton's method is made to fail in one go, and in the first substep of so many divisions; the tolerance is 1e-10."""
    BySteps, Newton = Increments._BySteps, Increments._Newton
    loads = []                      # of first substeps
    inside, divisions = [], []      # which calls begin at the last state, while there are substeps; how many those were

    def Divided(run, graph, free):
        inside.append([])
        found = BySteps(run, graph, free)
        begins = inside.pop()
        divisions.append(np.diff([*np.flatnonzero(begins), len(begins)]).tolist())
        assert loads[-1] == pytest.approx((free - run.pair.free) / divisions[-1][-1])
        return found

    def Failing(run, graph, q, free):
        nonlocal loads
        found = Newton(run, graph, q, free)
        if not inside:
            known = run._Negligible(run.known.Outside(found.s), found.point)
            return replace(found, solved=found.solved and not known)
        begins = np.array_equal(q, graph.Coordinates(run.moment.displacement, run.moment.traction))
        inside[-1].append(begins)
        loads += [free - run.pair.free] * begins
        return replace(found, solved=found.solved and not (begins and sum(inside[-1]) <= failing))

    monkeypatch.setattr(Increments, "_BySteps", Divided)
    monkeypatch.setattr(Increments, "_Newton", Failing)
    history = Dragged()
    assert len(divisions) >= 3 and divisions[-1] == taken and seen["_Solved"] == 1
    for name in ("displacement", "traction", "work", "dissipation"):
        expected = getattr(usual, name)
        assert np.abs(getattr(history, name) - expected).max() < 1e-9 * np.abs(expected).max()


@pytest.mark.parametrize("limit", ["WORK", "DIRECTIONS"])
def test_an_increment_that_fails_takes_newtons_method_of_a_state_and_goes_on(usual, seen, monkeypatch, limit):
    monkeypatch.setattr(increments, limit, 1)
    history = Dragged()
    assert seen["_Solved"] > 1 and seen["__init__"] > 1
    for name in ("displacement", "traction"):
        expected = getattr(usual, name)
        assert np.abs(getattr(history, name) - expected).max() < 1e-9 * np.abs(expected).max()


def test_no_product_is_asked_for_when_all_are_known(seen):
    """Two elements at the foundation: eight components of the traction, and as many products in all."""
    history = Dragged(2, np.linspace(0, 4, 41)[1:])
    assert seen["_Solved"] == 1 and 4 <= seen["Learn"] <= 8
    assert np.abs(history.forces["bottom"][-1, 0]) > 0.1 * np.abs(history.forces["bottom"][:, 0]).max()


def test_solves_are_those_of_products_and_loads(usual, seen):
    history = Dragged()
    loads = 2       # pressing and dragging, of which all others are combinations
    assert sum(increment.solves for increment in history.increments[1:]) <= seen["Learn"] + 2 * loads
    assert [a.solves for a in history.increments] == [a.solves for a in usual.increments]
