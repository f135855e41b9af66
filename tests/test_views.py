"""Law plot, zones, comparison and history: a wrong solution shows, a right one lies on its graphs, all have a common scale."""

import json

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from netgen.geom2d import SplineGeometry
from ngsolve import CF, Mesh, x, y

from ngdgc import (LDG, Conforming, ContactProblem, ContactSolution, CoulombFriction, Discretization, Foundation, HookeMaterial,
                   InteriorPenalty, NestedNewtonSolver, NormalCompliance, ProblemError, SlipWeakeningFriction, TrescaFriction,
                   UzawaSolver)
from ngdgc.cases import example_4_1, example_4_2
from ngdgc.cli import Main
from ngdgc.graph import Distance
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.output import WriteResults
from ngdgc.plots import ZONE_COLOURS, ComparisonFigure, HistoryFigure, LawFigure, ZonesFigure
from ngdgc.plots.canvas import BLUE, ORANGE, VERMILION
from ngdgc.plots.solid import Cells

ROUNDOFF = 1e-12    # coordinates are of size 1
COLUMN = 3.5        # width of a column of a journal [inch]
LEGIBLE = 6         # size of letters in print [pt]


def Solve(foundation, mesh, u=(0.03, -0.05), *, method=InteriorPenalty(), order=1):
    """A block, E = 1000, nu = 0.3, pressed on its foundation by the displacement of its top."""
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, dirichlet={"top": CF(u)})
    return NestedNewtonSolver().Solve(Discretization(problem, method, mesh, order=order))


@pytest.fixture(scope="module")
def lifting():
    """Example 4.2: half of the bottom presses and slips."""
    return example_4_2.Main(n=8)


@pytest.fixture(scope="module")
def varying():
    """Two foundations, one with a stiffness that varies; separation, stick and slip."""
    return Solve((Foundation("bottom", NormalCompliance(2000 * (1 + x)), friction=CoulombFriction(0.3)),
                  Foundation("right", NormalCompliance(300, exponent=0.5), gap=0.01, friction=TrescaFriction(2))),
                 RectangleMesh(6), order=2)


@pytest.fixture(scope="module")
def solid():
    return Solve(Foundation("bottom", NormalCompliance(100), friction=CoulombFriction(0.4), gap=0.1 * x),
                 BoxMesh(2, cells="hex"), (0.05, 0.02, -0.04), method=LDG())


@pytest.fixture(scope="module")
def stiff():
    return Solve(Foundation("bottom", NormalCompliance(1e9), friction=CoulombFriction(0.3), gap=0.05 * x), RectangleMesh(8),
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
    expected = np.stack([wrong.penetration, wrong.pressure], axis=1)
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
    solution = Solve(foundation, RectangleMesh(4), (0.1, -0.05))
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
    solution = Solve(Foundation("bottom", NormalCompliance(1000)), RectangleMesh(2))
    left, right = LawFigure(solution).axes
    assert [text.get_text() for text in right.texts] == ["no friction"] and not right.lines
    assert len(Drawn(left, "points")) == len(solution.weights)
    rubbing = np.zeros_like(solution.traction)
    rubbing[0, 0] = 0.1 * solution.pressure.max()
    assert LawFigure(Changed(solution, rubbing)).get_suptitle().startswith("1 of")


def test_zones_lie_on_the_boundary(lifting):
    """Their stretches cover the bottom of the square; those of a zone have its length to one point; teeth are pressures."""
    axes = ZonesFigure(lifting).axes[0]
    (zones,) = [drawn for drawn in axes.collections if drawn.get_gid() == "zones"]
    lengths = dict.fromkeys(map(to_rgba, ZONE_COLOURS), 0.0)
    for path, colour in zip(zones.get_paths(), zones.get_colors()):
        assert np.abs(path.vertices[:, 1]).max() < ROUNDOFF
        lengths[tuple(colour)] += np.ptp(path.vertices[:, 0])
    expected = lifting.ZoneLengths()
    assert sum(lengths.values()) == pytest.approx(1) and min(expected["separation"], expected["slip"]) > 0.3
    assert np.allclose(list(lengths.values()), list(expected.values()), atol=lifting.weights.max())
    (comb,) = [drawn for drawn in axes.collections if drawn.get_gid() == "comb"]
    teeth = np.array([path.vertices for path in comb.get_paths()])
    order = np.argsort(lifting.points[:, 0])
    assert np.allclose(teeth[:, 0], lifting.points[order])
    heights = teeth[:, 0, 1] - teeth[:, 1, 1]
    assert np.allclose(heights * lifting.pressure.max(), heights.max() * lifting.pressure[order])
    assert f"= {lifting.pressure.max():.4g} [stress]" in axes.get_title()


def test_zones_of_a_ring_lie_on_its_circle():
    """A closed cubic curve is drawn as it is, not as the chords of its edges, which are up to 0.02 inside."""
    geometry = SplineGeometry()
    geometry.AddCircle((0, 0), 1, bc="outer")
    geometry.AddCircle((0, 0), 0.5, leftdomain=0, rightdomain=1, bc="inner")
    mesh = Mesh(geometry.GenerateMesh(maxh=0.4)).Curve(3)
    foundation = Foundation("outer", NormalCompliance(1000), friction=CoulombFriction(0.2), gap=0.02 - 0.02 * y)
    problem = ContactProblem(HookeMaterial(E=100, nu=0.3), foundation, dirichlet={"inner": CF((0.05, -0.05))})
    solution = NestedNewtonSolver().Solve(Discretization(problem, InteriorPenalty(), mesh, order=1))
    (zones,) = [drawn for drawn in ZonesFigure(solution).axes[0].collections if drawn.get_gid() == "zones"]
    paths = [path.vertices for path in zones.get_paths()]
    radius = np.hypot(*np.concatenate(paths).T)
    assert np.abs(radius - 1).max() < 4e-3 and len(np.unique(solution.zones)) > 1
    length = sum(np.linalg.norm(np.diff(path, axis=0), axis=1).sum() for path in paths)
    assert length == pytest.approx(2 * np.pi, rel=4e-3)


def Areas(polygons):
    return [0.5 * abs(np.sum(p[:, 0] * np.roll(p[:, 1], -1) - p[:, 1] * np.roll(p[:, 0], -1))) for p in polygons]


def test_cells_of_points_are_nearest_to_them():
    square, points = np.array([[0., 0], [1, 0], [1, 1], [0, 1]]), np.array([[0.2, 0.3], [0.7, 0.2], [0.6, 0.9]])
    cells = Cells(square, points)
    assert sum(Areas(cells)) == pytest.approx(1)
    for number, cell in enumerate(cells):
        distances = np.linalg.norm(cell.mean(axis=0) - points, axis=1)
        assert distances.argmin() == number


def test_map_of_a_solid_covers_its_foundation(solid):
    """Every contact point has a part of the bottom, in the colour of its zone and with its pressure."""
    zones, pressure = (next(drawn for drawn in axes.collections if drawn.get_gid() == name)
                       for axes, name in zip(ZonesFigure(solid).axes, ("zones", "pressure")))
    cells = [path.vertices[:-1] for path in zones.get_paths()]
    assert sum(Areas(cells)) == pytest.approx(1)
    inside = np.array([path.contains_points(solid.points[:, :2]) for path in zones.get_paths()])
    assert np.array_equal(inside.sum(axis=0), np.ones(len(cells))) and np.array_equal(inside.sum(axis=1), np.ones(len(cells)))
    own = inside.argmax(axis=1)
    assert np.array_equal(zones.get_array(), solid.zones[own]) and len(np.unique(solid.zones)) > 1
    assert np.array_equal(pressure.get_array(), solid.pressure[own]) and np.ptp(solid.pressure) > 1


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
    coarse = Solve(solid.disc.problem.foundation, BoxMesh(2), (0.05, 0.02, -0.04), method=Conforming())
    maps = [axes.collections[0] for axes in ComparisonFigure({"LDG": solid, "H1": coarse}).axes[:2]]
    top = max(solid.pressure.max(), coarse.pressure.max())
    assert [drawn.get_clim() for drawn in maps] == [(0, top)] * 2 and solid.pressure.max() != coarse.pressure.max()


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


def test_zone_colours_differ_in_grey():
    """So that they can be told apart without colours; so do marks on and off the law."""
    def Grey(colour):
        return np.dot(to_rgba(colour)[:3], (0.2126, 0.7152, 0.0722))

    greys = sorted(map(Grey, ZONE_COLOURS))
    assert min(np.diff(greys)) > 0.15 and set(ZONE_COLOURS[1:]) == {BLUE, ORANGE}
    assert abs(Grey(BLUE) - Grey(VERMILION)) > 0.01


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
