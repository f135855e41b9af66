"""A roller that is pressed and moved to and fro, against Cattaneo, Mindlin and Deresiewicz."""

from itertools import pairwise

import numpy as np
import pytest
from ngsolve import CF, IfPos, Parameter

from ngdgc import ContactProblem, Discretization, InteriorPenalty, SolveHistory
from ngdgc.cases import load_steps

PULL, STEPS, N = 0.007, 8, 24


def Fretted():
    """A history: pressed at 0, dragged by PULL until 1, back by twice that until 2, and there again at 3; (case, history)."""
    case, t = load_steps, Parameter(0)
    place = CF(PULL)
    for number, (a, b) in reversed(list(enumerate(pairwise((0.0, PULL, -PULL, PULL))))):
        place = IfPos(number + 1 - t, a + (t - number) * (b - a), place)
    still = case.Problem(0.0)
    problem = ContactProblem(still.material, still.foundation, dirichlet={"top": CF((place, -case.DOWN))})
    disc = Discretization(problem, InteriorPenalty(), case.Mesh(N), order=2)
    return case, SolveHistory(disc, parameter=t, times=np.linspace(0, 3, 3 * STEPS + 1))


@pytest.mark.slow
def test_the_loop_of_a_fretted_roller_is_that_of_mindlin_and_deresiewicz():
    """Pressure and slip are hardly coupled at nu = 0.49, so a way back is the first way, of twice the size (Masing).

    Forces within 0.3 %, of which the area of the loop, a twentieth of that without elasticity, can be off by 4 %.
    Stick at both ends within an element, 1/24 of the part that may touch.
    """
    case, history = Fretted()
    force, pressure = history.forces["contact"].T * [[-1], [1]]
    limit, first = case.COEFFICIENT * pressure.mean(), force[:STEPS + 1]
    back = first[-1] - 2 * first
    assert np.ptp(pressure) < 1e-3 * pressure.mean() and 0.8 * limit < first[-1] < 0.9 * limit
    for found, expected in ((force[STEPS:2 * STEPS + 1], back), (force[2 * STEPS:], -back)):
        assert np.abs(found - expected).max() < 0.003 * first[-1]
    ways = PULL * np.interp(history.times, range(4), (0, 1, -1, 1))[STEPS:]
    loop, expected = (np.trapezoid(forces, ways)
                      for forces in (force[STEPS:], np.concatenate([back, -back[1:]])))
    assert loop == pytest.approx(expected, rel=0.04) and loop > 0.04 * limit * PULL
    # What friction takes in a cycle is the area.
    assert history.dissipation[-1] - history.dissipation[STEPS] == pytest.approx(loop, rel=0.03)
    # c/b = sqrt(1 - Q/(mu P)) on the first way, and with (Q_0 - Q)/2 instead of Q on the way back.
    for place, change in enumerate([*first, *(0.5 * (first[-1] - force[STEPS + 1:2 * STEPS]))]):
        widths = history[place].ZoneLengths()
        mindlin = (widths["stick"] + widths["slip"]) * np.sqrt(max(1 - change / limit, 0))
        assert abs(widths["stick"] - mindlin) < 2 * 2 * case.CONTACT / N, place
    # Control: without memory nothing would be left at 0, by seven times the tolerance.
    assert abs(force[STEPS + STEPS // 2]) > 0.02 * first[-1] > 10 * abs(force[0])
