"""Settings of solids say what acts where, from two sides; displacements too small to be seen are enlarged."""

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from mpl_toolkits.mplot3d import proj3d
from ngsolve import CF, x

from ngdgc import (LDG, Conforming, ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, Solve)
from ngdgc.cases import example_4_1, example_4_2, hertz_sphere, machine_part, step_part
from ngdgc.export import Scene
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.plots import ComparisonFigure, DeformedFigure, SettingFigure, surface
from ngdgc.plots.canvas import VERMILION
from ngdgc.plots.surface import TextBox
from ngdgc.plots.words import Span
from ngdgc.solution.magnification import Magnification


def Setting(sign, view=None):
    """A block that is pushed down on its top, or pulled up."""
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("bottom", NormalCompliance(1), gap=0.1 * x),
                             dirichlet={"left": (0, 0, 0), "right": (0, 0.2, 0)}, traction={"top": CF((0, 0, sign * 3))},
                             bodyforce=(0, 0, -7))
    return SettingFigure(Discretization(problem, Conforming(), BoxMesh(2, cells="hex")), view=view)


def Arrows(axes):
    """(tails (n, 3), heads (n, 3)) of all arrows; an arrow is a line that begins at its head, and two more."""
    arrows = [np.asarray(drawn._segments3d) for drawn in axes.collections[1:]]
    return np.array([arrow[0][1] for arrow in arrows]), np.array([arrow[0][0] for arrow in arrows])


def test_words_say_what_acts_on_each_side():
    below, above = ({text.get_text() for text in axes.texts} for axes in Setting(-1).axes)
    assert below | above == {"bottom\nfoundation\ng = 0 to 0.1", "left\nclamped", "right\nprescribed\nu = (0, 0.2, 0)",
                             "top\ntraction\n$f_2$ = (0, 0, -3)", "front\nfree", "back\nfree"}
    assert "bottom\nfoundation\ng = 0 to 0.1" in below - above and "top\ntraction\n$f_2$ = (0, 0, -3)" in above - below
    figure = Setting(-1)
    assert figure.get_suptitle() == "setting, body force $f_1$ = (0, 0, -7)"


@pytest.mark.parametrize("sign", [-1, 1])
def test_arrows_show_on_which_side_a_load_acts(sign):
    """Of a pressure they end at the side, of a tension they begin there: above the block in both cases, and parallel to it."""
    tails, heads = Arrows(Setting(sign).axes[1])
    onto = np.abs(tails[:, :2] - heads[:, :2]).max(axis=1) < 1e-9
    onto &= np.all(np.minimum(tails, heads)[:, :2] > 0, axis=1) & np.all(np.maximum(tails, heads)[:, :2] < 1, axis=1)
    assert onto.sum() == 4          # one on every face of the top
    near, far = (heads, tails) if sign < 0 else (tails, heads)
    assert np.all(np.sign(heads[onto] - tails[onto])[:, 2] == sign)
    assert np.allclose(near[onto][:, 2], 1, atol=0.02) and np.allclose(far[onto][:, 2], 1.2, atol=0.03)
    below, _ = Arrows(Setting(sign, view=(-60, -60)).axes[0])
    assert not np.any(np.all(np.abs(below[:, :2] - 0.5) < 0.49, axis=1))      # the top is not seen from below


def Overlaps(axes):
    boxes = [TextBox(axes, text) for text in axes.texts]
    return [(a, b) for number, a in enumerate(boxes) for b in boxes[:number] if a.overlaps(b)]


@pytest.mark.slow
@pytest.mark.parametrize("case, n", [(hertz_sphere, 8), (machine_part, 8), (machine_part, 4), (step_part, 4)])
def test_words_lie_on_no_other_words(case, n, monkeypatch):
    """Of a ball whose spot of contact is a hundredth of it, and of lugs with small rings and bores, where they are drawn."""
    disc = Discretization(case.Problem(), InteriorPenalty(), case.Mesh(n))
    figure = SettingFigure(disc)
    figure.draw_without_rendering()
    assert all(len(axes.texts) > 2 and Overlaps(axes) == [] for axes in figure.axes)
    monkeypatch.setattr(surface, "_Part", lambda axes: None)
    assert case is hertz_sphere or any(Overlaps(axes) for axes in SettingFigure(disc).axes)


def test_a_text_in_space_is_where_it_is_drawn():
    """Its middle is the projection of its place, which its own extent knows nothing of; drawing leaves it as it is."""
    axes = Setting(-1).axes[0]
    text = axes.texts[0]
    place = np.array(text.get_position_3d())
    expected = axes.transData.transform(proj3d.proj_transform(*place, axes.get_proj())[:2])
    box = TextBox(axes, text)
    assert np.allclose([box.intervalx.mean(), box.intervaly.mean()], expected, atol=2)
    assert np.array_equal(text.get_position_3d(), place)


def test_names_of_axes_of_a_flat_body_are_within_the_figure(monkeypatch):
    """Of a pad of a fifth of its width, the axes are made smaller; else the name on the right would be cut off."""
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("bottom", NormalCompliance(1)),
                             dirichlet={"top": (0, 0, -0.1)})
    disc = Discretization(problem, Conforming(), BoxMesh(2, upper=(40, 40, 8), cells="hex"))

    def Right():
        figure = SettingFigure(disc)
        figure.draw_without_rendering()
        boxes = [axis.label.get_window_extent() for axes in figure.axes for axis in (axes.xaxis, axes.yaxis, axes.zaxis)]
        return figure.bbox.width - max(box.x1 for box in boxes), min(box.x0 for box in boxes)

    assert min(Right()) >= 0
    monkeypatch.setattr(surface, "_Fit", lambda figure: None)
    assert min(Right()) < 0


def test_forces_of_a_region_are_totals_and_body_forces_have_an_arrow():
    """The words of `force` are the total, its arrows point along it; the body force has one beside the body in each view."""
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("bottom", NormalCompliance(1)),
                             dirichlet={"left": (0, 0, 0)}, force={"top": (0, 0, -12), "front": (8, 0, 0)},
                             bodyforce=(0, -7, 0))
    figure = SettingFigure(Discretization(problem, Conforming(), BoxMesh(2, cells="hex", upper=(1, 1, 2))))
    assert figure.get_suptitle() == "setting, body force $f_1$ = (0, -7, 0)"
    words = {text.get_text() for axes in figure.axes for text in axes.texts}
    assert {"top\nforce\nF = (0, 0, -12)", "front\nforce\nF = (8, 0, 0)"} <= words
    for axes, along in zip(figure.axes, ((1, 0, 0), (0, 0, -1))):
        tails, heads = Arrows(axes)
        ways = heads - tails
        colours = [tuple(drawn.get_color()[0]) for drawn in axes.collections[1:]]
        beside = np.array([colour == to_rgba(VERMILION) for colour in colours])
        # 8 over the area 2 of the front are a third of 12 over the area 1 of the top, of which the arrows are 0.2 of the body.
        assert beside.sum() == 1 and np.allclose(ways[beside], (0, -0.4, 0)) and np.all(tails[beside] > [1, 1, 2])
        assert np.allclose(ways[~beside], 0.4 * np.array(along) / (3 if along[0] else 1)) and (~beside).sum() == 4


def test_noise_of_a_gap_is_no_number():
    assert Span("g", np.array([9.7e-13, 0.0144])) == "g = 0 to 0.0144"
    assert Span("g", np.array([1e-6, 0.5])) == "g = 1e-06 to 0.5"


def test_a_displacement_that_is_not_seen_is_enlarged():
    """To at most 6 % of the body, by 1, 2 or 5 times a power of 10; what is seen stays, and the title says it."""
    assert Magnification(example_4_2.Main(n=2), "auto") == 1 and Magnification(example_4_2.Main(n=2), 3) == 3
    for u in (1e-3, 3e-6):
        foundation = Foundation("bottom", NormalCompliance(1))
        problem = ContactProblem(HookeMaterial(E=1, nu=0.3), foundation, dirichlet={"top": (0, u)})
        solution = Solve(Discretization(problem, InteriorPenalty(), RectangleMesh(2)))
        scale = Magnification(solution, "auto")
        assert 0.02 < scale * u <= 0.0601 and f"{scale:g}"[0] in "125" and np.log10(scale) >= 1
        assert f"displacement and gap x {scale:g}" in DeformedFigure(solution, scale="auto").axes[0].get_title()
        assert "displacement x 1" in DeformedFigure(solution).axes[0].get_title()
        assert Scene(solution, scale="auto").scale == scale
        labels = [text.get_text() for text in ComparisonFigure({"a": solution}, scale="auto").findobj(
            lambda artist: hasattr(artist, "get_fontsize"))]
        assert f"x [length], displacement x {scale:g}" in labels


def test_a_gap_is_enlarged_within_limits():
    """A gap of a tenth of the body grows to no more than 30 %, however small the displacement."""
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("bottom", NormalCompliance(1), gap=0.1),
                             dirichlet={"top": (0, -1e-5)})
    assert Magnification(Solve(Discretization(problem, LDG(), RectangleMesh(2))), "auto") == 2
    assert Magnification(example_4_1.Main(n=2), "auto") >= 1


def test_axes_do_not_cover_the_names_of_others():
    """Those on the right have no background: the name on the right of the left ones reaches under them."""
    figure = Setting(-1)
    assert all(axes.patch.get_facecolor()[3] == 0 for axes in figure.axes)
