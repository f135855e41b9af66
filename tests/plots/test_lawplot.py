"""The law plot: points of a right solution lie on the graphs of the laws, and wrong ones are crossed and counted."""

import numpy as np
import pytest
from ngsolve import x
from problems import Pressed

from ngdgc import ContactSolution, CoulombFriction, Foundation, NormalCompliance, SlipWeakeningFriction
from ngdgc.cases import curved_body
from ngdgc.contact.graph import Distance
from ngdgc.meshes import RectangleMesh
from ngdgc.plots import HistoryFigure, LawFigure
from ngdgc.solution.history import Step


@pytest.fixture(scope="module")
def stiff():
    return Pressed(Foundation("bottom", NormalCompliance(1e9), friction=CoulombFriction(0.3), gap=0.05 * x), RectangleMesh(8),
                 (0.03, -0.03))


def Changed(solution, change):
    """The solution with the traction (n, d) at its contact points plus `change`."""
    return ContactSolution(solution.disc, solution.vector, solution.traction + change, history=solution.history)


def Drawn(axes, gid):
    """Points (n, 2) of the lines with this gid."""
    return np.concatenate([line.get_xydata() for line in axes.lines if line.get_gid() == gid])


def Sorted(points):
    return points[np.lexsort(points.T)]


@pytest.mark.parametrize("name", ["lifting", "varying", "solid", "stiff"])
def test_a_right_solution_lies_on_its_law(name, request):
    """Nothing is marked, every point is drawn with its own penetration and pressure, and friction over bound is at most 1."""
    solution = request.getfixturevalue(name)
    figure = LawFigure(solution)
    left, right = figure.axes
    assert figure.get_suptitle().startswith(f"all {len(solution.weights)} points on the law")
    assert len(Drawn(left, "off")) == len(Drawn(right, "off")) == 0
    expected = np.stack([solution.penetration, solution.pressure], axis=1)
    assert np.array_equal(Sorted(Drawn(left, "points")), Sorted(expected))
    slip, ratio = Drawn(right, "points").T
    assert len(slip) > 0 and np.abs(ratio).max() < 1 + 1e-8          # the solver's tolerance is 1e-10 of the tractions
    moving = np.abs(slip) > 1e-6
    assert np.allclose(np.abs(ratio[moving]), 1, atol=1e-6) and np.all(ratio[moving] * slip[moving] > 0)


@pytest.mark.parametrize("name", ["lifting", "varying", "solid"])
def test_a_wrong_solution_leaves_it(name, request):
    """Three tractions are changed, normally or tangentially: exactly these are crossed and counted."""
    solution = request.getfixturevalue(name)
    change = np.zeros_like(solution.traction)
    worst = np.argsort(solution.pressure)[[-1, -2, len(change) // 2]]
    change[worst] = 0.2 * np.abs(solution.traction).max()
    figure = LawFigure(Changed(solution, change))
    wrong = Changed(solution, change)
    assert figure.get_suptitle().startswith(f"3 of {len(change)} points off the law")
    expected = np.stack([wrong.penetration, wrong.disc.contact.Normal(wrong.traction)], axis=1)
    assert np.array_equal(Sorted(Drawn(figure.axes[0], "off")), Sorted(expected[worst]))
    assert len(Drawn(figure.axes[1], "off")) == 3
    assert "off the law" in [text.get_text() for text in figure.legends[0].get_texts()]
    largest = Distance(solution.disc.contact, wrong.displacement, wrong.traction).distance.max()
    assert f"largest distance {largest:.1e}" in figure.get_suptitle() and largest > 1e-3


def test_friction_in_the_wrong_direction_shows_in_space(solid):
    """Its modulus is right: only a plot along the slip tells."""
    contact = solid.disc.contact
    turned = Changed(solid, -2 * contact.Tangential(solid.traction))
    assert np.allclose(np.linalg.norm(turned.friction, axis=1), np.linalg.norm(solid.friction, axis=1))
    touching = np.sum(solid.pressure > 0)
    assert LawFigure(turned).get_suptitle().startswith(f"{touching} of {len(solid.weights)} points off")
    assert Drawn(LawFigure(turned).axes[1], "off")[:, 1].min() < 0 < Drawn(LawFigure(solid).axes[1], "points")[:, 1].min()


def test_the_drawn_graph_is_the_law(lifting, varying):
    """A line p = 250 r, or a band between 2000 r and 4000 r; the root of the other foundation is a line again."""
    (line,) = [line for line in LawFigure(lifting).axes[0].lines if line.get_gid() == "law"]
    r, p = line.get_xydata().T
    assert r.max() == lifting.penetration.max() and np.allclose(p, 250 * r)
    axes = LawFigure(varying).axes[0]
    (band,) = [drawn for drawn in axes.collections if drawn.get_gid() == "law"]
    r, p = band.get_paths()[0].vertices.T
    steepness = p[r > 1e-6] / r[r > 1e-6]
    # The points are inside of the ends of Gamma_C.
    assert 2000 < steepness.min() < 2050 and 3950 < steepness.max() < 4000
    (line,) = [line for line in axes.lines if line.get_gid() == "law"]
    r, p = line.get_xydata().T
    assert np.allclose(p, 300 * np.sqrt(r)) and not np.allclose(p, 300 * r)


def test_slip_weakening_is_over_its_own_bound():
    """p_t falls with the slip by more than a tenth, friction over p_t stays 1."""
    foundation = Foundation("bottom", NormalCompliance(2000), friction=SlipWeakeningFriction(static=0.4, dynamic=0.1,
                                                                                            distance=0.05))
    solution = Pressed(foundation, RectangleMesh(4), (0.1, -0.05))
    sliding = solution.zones == 2
    factor = np.linalg.norm(solution.friction, axis=1)[sliding] / solution.pressure[sliding]
    slip, ratio = Drawn(LawFigure(solution).axes[1], "points").T
    assert np.any(sliding) and factor.max() < 0.36 and np.allclose(np.abs(ratio[np.abs(slip) > 1e-6]), 1, atol=1e-8)


def test_a_stiff_law_can_be_read(stiff, lifting):
    """Penetrations of 1e-8 beside gaps of 1e-2 have half of the axis, with a logarithm beyond; a soft law has none."""
    axes = LawFigure(stiff).axes[0]
    assert axes.get_xscale() == "symlog" and LawFigure(lifting).axes[0].get_xscale() == "linear"
    deepest, widest = stiff.penetration.max(), -stiff.penetration.min()
    ends = axes.transAxes.inverted().transform(axes.transData.transform([[0, 0], [deepest, 0], [-widest, 0]]))[:, 0]
    assert widest > 1e4 * deepest and ends[1] - ends[0] > 0.1 and ends[2] > 0


def test_frictionless_says_so():
    solution = Pressed(Foundation("bottom", NormalCompliance(1000)), RectangleMesh(2))
    left, right = LawFigure(solution).axes
    assert [text.get_text() for text in right.texts] == ["no friction"] and not right.lines
    assert len(Drawn(left, "points")) == len(solution.weights)
    rubbing = np.zeros_like(solution.traction)
    rubbing[0, 0] = 0.1 * solution.pressure.max()
    assert LawFigure(Changed(solution, rubbing)).get_suptitle().startswith("1 of")


def test_numbers_on_the_axes_do_not_run_into_each_other():
    """Penetrations of 1e-5 have long numbers."""
    figure = LawFigure(curved_body.Main())
    figure.draw_without_rendering()
    boxes = [label.get_window_extent() for label in figure.axes[0].get_xticklabels() if label.get_text()]
    assert len(boxes) > 1 and not any(a.overlaps(b) for a, b in zip(boxes, boxes[1:]))


def test_iterations_are_counted_in_whole_numbers():
    """Also a single one."""
    figure = HistoryFigure([Step(number=1, change=1e-8, residual=1e-16, solves=1, seconds=0.1)])
    low, high = figure.axes[0].get_xlim()
    assert [tick for tick in figure.axes[0].get_xticks() if low <= tick <= high] == [1]
