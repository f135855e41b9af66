"""Rigid punches in figures of the deformed body: they are where they have moved to."""

import numpy as np
import pytest

from ngdgc import (ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NormalCompliance, RigidPunch,
                   Solve)
from ngdgc.meshes import RectangleMesh
from ngdgc.plots import DeformedFigure


@pytest.mark.parametrize("punch", [RigidPunch(displacement=(0.02, -0.05), rotation=0.03, about=(1, 1)),
                                   RigidPunch(force=(None, -0.1), moment=0, about=(0.3, 1))], ids=["moved", "pressed"])
def test_a_punch_is_drawn_where_it_is(punch):
    """x + scale (a + w x (x - x_0)); a foundation that is none stays at y = 0."""
    problem = ContactProblem(HookeMaterial(E=10, nu=0.3), [
        Foundation("top", NormalCompliance(5), punch=punch), Foundation("bottom", NormalCompliance(50))], roller={"left": 0})
    solution = Solve(Discretization(problem, InteriorPenalty(), RectangleMesh(2)))
    a, b, w = solution.punches["top"]
    assert abs(w) > 1e-3 and abs(b) > 1e-3
    patches = DeformedFigure(solution, scale=2).axes[0].patches
    surfaces = [patch.get_xy()[:len(patch.get_xy()) // 2] for patch in patches if patch.get_gid() == "foundation"]
    for surface in surfaces:
        drawn = surface[np.argsort(surface[:, 0])]
        if drawn[0, 1] < 0.5:
            assert np.abs(drawn[:, 1]).max() < 1e-12
            continue
        x = np.array([[0, 1], [1, 1]])
        moved = x + 2 * np.column_stack([a - w * (x[:, 1] - punch.about[1]), b + w * (x[:, 0] - punch.about[0])])
        assert drawn[[0, -1]] == pytest.approx(moved, abs=1e-9)
    assert len(surfaces) == 2
