"""Settings of solids say what acts where, from two sides; displacements too small to be seen are enlarged."""

import numpy as np
import pytest
from ngsolve import CF, x

from ngdgc import (LDG, Conforming, ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, Solve)
from ngdgc.cases import example_4_1, example_4_2, hertz_sphere, machine_part
from ngdgc.export import Scene
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.plots import ComparisonFigure, DeformedFigure, SettingFigure
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


@pytest.mark.slow
def test_words_lie_on_no_other_words():
    """Of a ball whose spot of contact is a hundredth of it, and of a lug with small rings; a pair that does is seen."""
    for case in (hertz_sphere, machine_part):
        figure = SettingFigure(Discretization(case.Problem(), InteriorPenalty(), case.Mesh()))
        figure.draw_without_rendering()
        for axes in figure.axes:
            boxes = [text.get_window_extent() for text in axes.texts]
            assert len(boxes) > 2 and not any(a.overlaps(b) for number, a in enumerate(boxes) for b in boxes[:number])
        axes.texts[0].set_position_3d(axes.texts[1].get_position_3d())
        assert axes.texts[0].get_window_extent().overlaps(axes.texts[1].get_window_extent())


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
