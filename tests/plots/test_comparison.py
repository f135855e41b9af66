"""Comparison and history have a common scale, figures can be read in a column, and commands write them."""

import json

import numpy as np
import pytest
from problems import Pressed

from ngdgc import Conforming, InteriorPenalty, ProblemError, UzawaSolver
from ngdgc.cases import example_4_1, example_4_2
from ngdgc.cli import Main
from ngdgc.plots.regions import BoundaryFunction
from ngdgc.meshes import BoxMesh
from ngdgc.commands.output import WriteResults
from ngdgc.plots import ComparisonFigure, HistoryFigure, LawFigure, ZonesFigure

LEGIBLE = 6         # size of letters in print [pt]
COLUMN = 3.5        # width of a column of a journal [inch]


def test_comparison_has_every_method_on_common_scales(lifting, varying, solid):
    """Curves are the solutions' own, limits are shared, and colours of maps have one range."""
    other = example_4_2.Main(n=4, method=Conforming())
    figure = ComparisonFigure({"IP": lifting, "H1": other}, scale=2)
    pressure, friction, *bodies = figure.axes
    for line, solution in zip(pressure.lines, (lifting, other)):
        assert np.array_equal(line.get_ydata(), solution.pressure[np.argsort(solution.points[:, 0])])
    assert bodies[0].get_xlim() == bodies[1].get_xlim() and bodies[0].get_ylim() == bodies[1].get_ylim()
    assert [len(axes.collections[0].get_paths()) for axes in bodies] == [128, 32]
    assert [axes.get_title() for axes in bodies] == ["IP", "H1"]
    assert np.allclose(friction.lines[0].get_ydata(), -1)           # it acts against the slip to the right
    assert len(ComparisonFigure({"first": varying}).axes) == 5
    orders = ComparisonFigure({1: lifting, 2: other})      # numbers are labels, too
    assert [axes.get_title() for axes in orders.axes[2:]] == ["1", "2"]
    coarse = Pressed(solid.disc.problem.foundation, BoxMesh(2), (0.05, 0.02, -0.04), method=Conforming())
    maps = [axes.collections[0] for axes in ComparisonFigure({"LDG": solid, "H1": coarse}).axes[:2]]
    top = max(solid.pressure.max(), coarse.pressure.max())
    assert [drawn.get_clim() for drawn in maps] == [(0, top)] * 2 and solid.pressure.max() != coarse.pressure.max()


def test_comparison_of_solids_has_friction_and_deformed_bodies(solid):
    """Frictions in the same colours for both; every face of the bodies moved by the same multiple of its displacement."""
    coarse = Pressed(solid.disc.problem.foundation, BoxMesh(2), (0.05, 0.02, -0.04), method=Conforming())
    figure = ComparisonFigure({"LDG": solid, "H1": coarse}, scale=2)
    drawings = [axes.collections[0] for axes in figure.axes if axes.collections]
    frictions = [drawn for drawn in drawings if drawn.get_gid() == "friction"]
    sizes = [np.linalg.norm(solution.friction, axis=1) for solution in (solid, coarse)]
    assert [drawn.get_clim() for drawn in frictions] == [(0, max(map(np.max, sizes)))] * 2
    for drawn, size in zip(frictions, sizes):
        assert set(drawn.get_array()) == set(size)
    bodies = [axes for axes in figure.axes if axes.name == "3d"]
    assert [axes.get_title() for axes in bodies] == ["LDG", "H1"]
    for axes, solution in zip(bodies, (solid, coarse)):
        corners, moved = BoundaryFunction(solution.disc.facets, solution.gfu)
        faces = np.asarray(axes.collections[0]._faces)
        for scale, same in ((2, True), (1, False)):
            expected = np.array([x + scale * u for x, u in zip(corners, moved)])
            assert np.allclose(faces, expected, atol=1e-12) == same


def test_what_cannot_be_compared_is_refused(lifting, varying, solid):
    for solutions in ({}, [lifting], None):
        with pytest.raises(ProblemError, match="give a dictionary of ContactSolutions by their labels"):
            ComparisonFigure(solutions)
    for other in (varying, solid):
        with pytest.raises(ProblemError, match="solution 'b' has .*compare solutions of one problem"):
            ComparisonFigure({"a": lifting, "b": other})


def test_history_shows_the_levels_of_a_nested_iteration():
    """A bar for each mesh, hatched where it failed; another solver has none."""
    solution = example_4_1.Main(n=32)
    left, right = HistoryFigure(solution).axes
    assert [bar.get_width() for bar in right.patches] == [level.iterations for level in solution.levels]
    assert [text.get_text() for text in right.get_yticklabels()] == [str(level.dofs) for level in solution.levels]
    assert len(solution.levels) > 1 and not any(bar.get_hatch() for bar in right.patches)
    assert len(left.lines[0].get_xdata()) == len(solution.history)
    assert len(HistoryFigure(example_4_1.Main(n=4, solver=UzawaSolver())).axes) == 1
    assert [text.get_text() for text in HistoryFigure([]).axes[0].texts] == ["no iteration recorded"]


def Smallest(figure):
    """The size of the smallest letters in a column [pt]."""
    figure.draw_without_rendering()
    texts = [text for text in figure.findobj(lambda artist: hasattr(artist, "get_fontsize")) if text.get_text().strip()]
    return min(text.get_fontsize() for text in texts) * COLUMN / figure.get_figwidth()


@pytest.mark.slow
@pytest.mark.parametrize("Figure", [LawFigure, ZonesFigure, HistoryFigure, lambda solution: ComparisonFigure({"a": solution})])
def test_letters_can_be_read_in_a_column(Figure, lifting, solid):
    """No text is smaller than 6 pt when the figure fills a column, and axes have units; twice the width would be too much."""
    for solution in (lifting, solid):
        figure = Figure(solution)
        assert Smallest(figure) >= LEGIBLE
        labels = " ".join(text.get_text() for text in figure.findobj(lambda artist: hasattr(artist, "get_fontsize")))
        assert any(unit in labels for unit in ("[length]", "[stress]", "[1]"))
        figure.set_figwidth(2 * figure.get_figwidth())
        assert Smallest(figure) < LEGIBLE


@pytest.mark.slow
def test_run_leaves_law_and_zones(lifting, tmp_path):
    written = WriteResults(lifting, tmp_path)
    for name in ("law.png", "zones.png"):
        assert name in written and (tmp_path / name).read_bytes().startswith(b"\x89PNG")
    assert json.loads((tmp_path / "report.json").read_text())["zones"] == lifting.ZoneLengths()


def test_compare_writes_a_table_and_a_figure(tmp_path, capsys):
    """Its numbers are those of the cases; a method that does not exist is one line."""
    assert Main(["compare", "example_4_2", *"--n 2 --method ip h1 --order 2".split(), "--out", str(tmp_path)]) == 0
    rows = [line.split() for line in (tmp_path / "comparison.txt").read_text().splitlines()]
    assert [row[0] for row in rows] == ["method", "ip", "h1"]
    for row, method in zip(rows[1:], (InteriorPenalty(), Conforming())):
        solution = example_4_2.Main(n=2, order=2, method=method)
        assert row[1] == str(solution.disc.space.ndof) and float(row[-1]) == pytest.approx(solution.energy, rel=1e-5)
        assert float(row[-2]) == pytest.approx(solution.normalforce, rel=1e-5)
    assert rows[1][-1] != rows[2][-1] and (tmp_path / "comparison.png").stat().st_size > 10000
    capsys.readouterr()
    assert Main(["compare", "example_4_2", "--method", "fem", "--out", str(tmp_path)]) == 2
    assert "no method 'fem'; choose some of ip, bassi" in capsys.readouterr().err
