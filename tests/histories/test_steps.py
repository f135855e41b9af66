"""Increments that are halved because they change too much: where there is wear, and where zones change."""

from types import SimpleNamespace

import numpy as np
import pytest
from ngsolve import CF, Parameter
from problems import Along

from ngdgc import (LDG, ArchardWear, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial,
                   InteriorPenalty, NormalCompliance, SolveHistory)
from ngdgc.contact.graph import SEPARATION, SLIP, STICK
from ngdgc.histories import solve
from ngdgc.histories.increments import Increments
from ngdgc.histories.steps import _ZoneChange
from ngdgc.meshes import RectangleMesh


def test_an_increment_that_wears_too_much_is_halved():
    """C k |s| = 1.6 would leave the body above its foundation; a fifth of what it yields is worn at most in each part."""
    t, rate = Parameter(0), 1.6 / 3000
    foundation = Foundation("bottom", NormalCompliance(3000), wear=ArchardWear(rate))
    problem = ContactProblem(HookeMaterial(mu=4e9, lam=0.0), foundation,
                             dirichlet={"top|left|right": CF((Along(t, [0, 0, 1]), -0.02))})
    history = SolveHistory(Discretization(problem, LDG(), RectangleMesh(1)), parameter=t, times=(1, 2))
    parts = history.increments[1].parts
    # The body is rigid but for 1e-6.
    assert parts == 8 and history.worn[1] == pytest.approx(0.02 * (1 - (1 - 1.6 / parts) ** parts), rel=1e-4)



def Dragged(times, monkeypatch, **options):
    """(history, times and sizes of all parts) of a block that is pressed, dragged until all of it slides, and brought back."""
    t, steps = Parameter(0), []
    size = solve.Steps.Size
    monkeypatch.setattr(solve.Steps, "Size", lambda self, old, new: steps.append(
        (t.Get(), _ZoneChange(old, new))) or size(self, old, new))
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), Foundation("bottom", NormalCompliance(1e4), CoulombFriction(0.3)),
                             dirichlet={"top": CF((Along(t, [0, 0, 0.02, 0]), -0.02))})
    disc = Discretization(problem, InteriorPenalty(), RectangleMesh(4))
    return SolveHistory(disc, parameter=t, times=times, **options), steps


def test_increments_that_change_too_many_zones_are_halved_and_the_balance_is_that_of_the_parts(monkeypatch):
    """States, work and dissipation are those of a history through the parts; a body that begins to stick does so at once."""
    taken_back, Back = [], Increments.Back

    def Recorded(increments):
        refused = increments.moment
        Back(increments)
        taken_back.append(increments.moment is not refused)

    with monkeypatch.context() as patched:
        patched.setattr(Increments, "Back", Recorded)
        adapted, steps = Dragged([1, 2, 3], patched, change=0.3)
    assert taken_back and all(taken_back)       # the next part begins at the state before
    parts = [increment.parts for increment in adapted.increments]
    taken = [time for time, after in zip([time for time, _ in steps], [*[time for time, _ in steps[1:]], 4]) if after > time]
    assert parts[0] == 1 and 4 <= max(parts) <= 16 and len(taken) == sum(parts[1:])
    fine, through = Dragged([1, *taken], monkeypatch)
    same = [0, *(1 + taken.index(time) for time in (2, 3))]
    for name in ("traction", "work", "energy", "dissipation"):
        expected = getattr(fine, name)[same]
        assert np.abs(getattr(adapted, name) - expected).max() < 1e-8 * np.abs(expected).max()
    # Where it is more than was asked for the whole of it changes at once, and a half no less: the way back begins.
    large = [time for time, change in through if change > 0.3]
    assert len(large) <= 1 and all(2 < time <= 2.5 for time in large)
    # Control: without it all zones change in the first of two increments, and friction takes another work.
    coarse, first = Dragged([1, 2, 3], monkeypatch)
    assert first[0][1] > 0.4 and abs(coarse.dissipation[-1] - fine.dissipation[-1]) > 1e-3 * fine.dissipation[-1]


def test_the_change_of_zones_counts_points_in_contact_alone():
    """By weights: here one of the three that touch before or after, of weight 2, of 5; those that never do count nothing."""
    def At(*zones):
        contact = SimpleNamespace(weights=np.array([1.0, 2, 2, 40, 50]))
        return SimpleNamespace(disc=SimpleNamespace(contact=contact), law=SimpleNamespace(zones=np.array(zones)))

    before, after = At(SLIP, STICK, STICK, SEPARATION, SEPARATION), At(SLIP, STICK, SLIP, SEPARATION, SEPARATION)
    assert _ZoneChange(before, after) == pytest.approx(2 / 5)
    assert _ZoneChange(At(*5 * [SEPARATION]), At(*5 * [SEPARATION])) == 0
