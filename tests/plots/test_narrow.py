"""Narrow foundations in figures: blocks that are no spikes, and labels that do not lie on each other."""

from itertools import combinations

import numpy as np
import pytest
from netgen.occ import MoveTo, OCCGeometry
from ngsolve import CF, Mesh, x

from ngdgc import ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NormalCompliance
from ngdgc.plots import DeformedFigure, SettingFigure, canvas
from ngdgc.plots.canvas import STOUT, THICKNESS, VISIBLE


def Column(foot, height=6, gap=0.0):
    """A column, one wide, that stands on a foot of this width."""
    shape = MoveTo(0, 0).Line(foot).Line(1 - foot).Rotate(90).Line(height).Rotate(90).Line(1).Close().Face()
    for edge in shape.edges:
        low, high = edge.center.y < 1e-9, edge.center.y > height - 1e-9
        edge.name = "top" if high else "side" if not low else "foot" if edge.center.x < foot else "bottom"
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("foot", NormalCompliance(1), gap=gap),
                             dirichlet={"top": CF((0, -1))})
    return Discretization(problem, InteriorPenalty(), Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=0.5)), order=1)


def Drawn(figure):
    """Width and height of the one foundation block of a figure."""
    (block,) = [patch for patch in figure.axes[0].patches if patch.get_gid() == "foundation"]
    return np.ptp(block.get_xy(), axis=0)


@pytest.mark.slow
def test_narrow_foundations_are_no_spikes():
    """Not higher than half as wide, unless that could not be seen or the body went through; wide ones have their share."""
    for foot in (0.3, 0.6):
        assert Drawn(SettingFigure(Column(foot))) == pytest.approx([foot, STOUT * foot])
        assert THICKNESS * 6 > foot         # control: by the height of the body alone it would be a spike
    assert Drawn(SettingFigure(Column(0.05))) == pytest.approx([0.05, VISIBLE * 6])
    assert Drawn(SettingFigure(Column(0.6, height=1))) == pytest.approx([0.6, THICKNESS])
    solution = Column(0.3).Solve()
    assert Drawn(DeformedFigure(solution)) == pytest.approx([0.3, 1.3 * solution.penetration.max()])


def Area(figure):
    (block,) = [patch for patch in figure.axes[0].patches if patch.get_gid() == "foundation"]
    s, t = block.get_xy()[:-1].T
    return 0.5 * abs(np.dot(s, np.roll(t, -1)) - np.dot(t, np.roll(s, -1)))


def test_below_a_steep_surface_the_block_is_filled():
    """A gap that grows to 4 over a width of 0.3: a triangle above a rectangle, not a slab of the rectangle's area."""
    figure, foot = SettingFigure(Column(0.3, gap=4 * x / 0.3)), 0.3 * STOUT
    assert Drawn(figure) == pytest.approx([0.3, 4 + foot])
    assert Area(figure) == pytest.approx(0.3 * (4 / 2 + foot))
    assert Area(SettingFigure(Column(0.3, gap=4))) == pytest.approx(0.3 * foot)


def Overlaps(figure):
    figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in figure.axes[0].texts if text.get_text()]
    return [pair for pair in combinations(boxes, 2) if pair[0].overlaps(pair[1])]


def test_labels_of_narrow_boundaries_are_apart(monkeypatch):
    assert not Overlaps(SettingFigure(Column(0.2)))
    monkeypatch.setattr(canvas, "_Part", lambda axes: None)
    assert Overlaps(SettingFigure(Column(0.2)))
