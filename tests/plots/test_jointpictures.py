"""Pictures of joints: red double lines in the setting, zones and combs along them, curves with the first side on the left."""

import numpy as np
import pytest
from bodies import LINE, Crossed, Layers, Stacked
from ngsolve import x

from ngdgc import (LDG, Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, Joint,
                   NormalCompliance, Solve)
from ngdgc.plots import ComparisonFigure, ContactFigure, DeformedFigure, LawFigure, SettingFigure, ZonesFigure
from ngdgc.plots.curves import Along, Curves


def Solved(mesh, *, order=2, method=None):
    laws, up = {"compliance": NormalCompliance(5000), "friction": CoulombFriction(0.3)}, (0,) * (mesh.dim - 2)
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), [Foundation("bottom", **laws), Joint("mid", gap=0.002 * x, **laws)],
                             dirichlet={"top": (0.01, *up, -0.03)})
    return Solve(Discretization(problem, method or LDG(), mesh, order=order))


@pytest.mark.parametrize("mesh, extent", [(Layers(2), [0, 1]), (Crossed({"mid": [LINE[1:5]]}), [1 / 6, 2 / 3])],
                         ids=["through", "inside"])
@pytest.mark.parametrize("method", [LDG(), Conforming()], ids=repr)
def test_curves_of_a_joint_have_its_first_side_on_the_left(mesh, extent, method):
    disc = Solved(mesh, method=method).disc
    (curve,), (along,) = Curves(disc, "mid"), Along(disc, "mid")
    assert sorted(curve.coordinates[[0, -1], 0]) == pytest.approx(extent)
    normal = disc.contact.normals[disc.contact.joined][0]
    assert curve.normals == pytest.approx(np.tile(normal, (len(curve.normals), 1)))
    tangent = curve.coordinates[-1] - curve.coordinates[0]
    assert tangent @ [-normal[1], normal[0]] == pytest.approx(extent[1] - extent[0])
    s, numbers, _ = along
    assert np.all(np.diff(s) > 0) and set(numbers) == set(np.flatnonzero(disc.contact.joined))
    # The outline is that of the body alone.
    assert all(set(np.round(part.coordinates.ravel(), 9)) & {0.0, 1.0} for part in Curves(disc, ".*"))


@pytest.mark.parametrize("method", [LDG(), Conforming()], ids=repr)
def test_plane_figures(method):
    solution = Solved(Layers(2), method=method)
    pressed = solution.disc.contact.joined
    setting, deformed = SettingFigure(solution.disc).axes[0], DeformedFigure(solution).axes[0]
    assert [line.get_color() for line in setting.lines if line.get_gid() == "joint"] == ["#CC3311", "white"]
    assert any("mid\njoint\ng = 0 to 0.002" in text.get_text() for text in setting.texts)
    for axes in (setting, deformed):        # one block, for the foundation
        assert sum(patch.get_gid() == "foundation" for patch in axes.patches) == 1
    assert [line.get_ydata()[0] for line in deformed.lines if line.get_gid() == "joint"] == pytest.approx([0.4])
    combs = [comb for comb in ZonesFigure(solution).axes[0].collections if comb.get_gid() == "comb"]
    assert [len(comb.get_segments()) for comb in combs] == [np.sum(~pressed), np.sum(pressed)]
    titles = [axes.get_title() for axes in ContactFigure(solution).axes]
    assert "foundation of 'bottom'" in titles and "joint of 'mid'" in titles
    assert LawFigure(solution).axes and ComparisonFigure({"one": solution, "two": solution}).axes


@pytest.mark.parametrize("method", [LDG(), Conforming()], ids=repr)
def test_solid_figures(method):
    solution = Solved(Stacked(), order=1, method=method)
    assert "joint 'mid' inside" in SettingFigure(solution.disc).get_suptitle() + "".join(
        axes.get_title() for axes in SettingFigure(solution.disc).axes)
    assert "zones, 'mid'" in [axes.get_title() for axes in ContactFigure(solution).axes]
    assert len([axes for axes in ZonesFigure(solution).axes if "zones, " in axes.get_title()]) == 2
