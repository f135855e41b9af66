"""The cases that wear: a punch that travels, and a roller that is rubbed without sliding."""

import numpy as np
import pytest

from ngdgc.cases import fretting_cycle, worn_punch


def test_a_punch_loses_the_volume_of_archards_formula_and_its_peak_of_pressure():
    """Under the same force it is coefficient, force, way once the foot slides, whose deformation changes by 1e-3 of the way."""
    history = worn_punch.History(n=6, order=1, count=2, way=1.0)
    volume, expected = worn_punch.Volume(history, way=1.0)
    assert max(increment.parts for increment in history.increments) > 1     # 0.5 mm wear too much at once
    assert expected[-1] == pytest.approx(2e-3) and volume[2] - volume[1] == pytest.approx(expected[2] - expected[1], rel=1e-3)
    pressed = [solution.normalforce for solution in history]
    assert pressed == pytest.approx([10.0] * 3)         # half of the pressure is on either side
    assert history[-1].pressure.max() < 0.95 * history[0].pressure.max()
    # Control: half of the wear is another volume.
    assert abs(volume[-1] - 0.5 * expected[-1]) > 0.4 * expected[-1]


def test_a_roller_wears_at_its_edges_alone_and_the_middle_carries_more():
    history = fretting_cycle.History(n=12, count=2, cycles=1)
    middle = np.all([np.isin(solution.zones, (0, 1)) for solution in history[2:]], axis=0) & (history[1].pressure > 0)
    first, last = history[1], history[-1]
    assert middle.any() and np.all(history.worn[-1][middle] == 0)
    slid = (first.pressure > 0) & ~middle
    assert history.worn[-1][slid].max() > 0 and last.pressure[middle].sum() > 1.02 * first.pressure[middle].sum()
    assert np.all(np.diff(history.worn, axis=0) >= 0)
