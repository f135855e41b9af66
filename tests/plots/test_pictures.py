"""Figures and files show the solution: element by element with its jumps, the foundation at its gap, everything in one page."""

import re
from collections import defaultdict
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from netgen.geom2d import SplineGeometry
from ngsolve import BND, TRIG, VOL, CF, IntegrationRule, Mesh, x

from ngdgc import (LDG, Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, ProblemError, UzawaSolver)
from ngdgc.cases import example_4_1, example_4_2
from ngdgc.export import WriteHTML, WriteVTK
from ngdgc.plots.regions import BoundaryFunction
from ngdgc.meshes import BoxMesh
from ngdgc.commands.output import WriteResults
from ngdgc.plots import ZONE_COLOURS, ContactFigure, DeformedFigure, HistoryFigure, SettingFigure

ROUNDOFF = 1e-12    # coordinates and displacements are of size 1
CORNERS = {TRIG: IntegrationRule(points=[(1, 0), (0, 1), (0, 0)], weights=[0, 0, 0])}


@pytest.fixture(scope="module")
def ip():
    return example_4_2.Main(n=4)


@pytest.fixture(scope="module")
def h1():
    return example_4_2.Main(n=4, method=Conforming())


def Annulus():
    """A ring, radii 1/2 and 1, whose inner boundary has a foundation in the hole; the gap varies."""
    geometry = SplineGeometry()
    geometry.AddCircle((0, 0), 1, bc="outer")
    geometry.AddCircle((0, 0), 0.5, leftdomain=0, rightdomain=1, bc="inner")
    foundation = Foundation("inner", NormalCompliance(1), gap=0.1 + 0.1 * x)
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), foundation, dirichlet={"outer": CF((0, 0))})
    return Discretization(problem, InteriorPenalty(), Mesh(geometry.GenerateMesh(maxh=0.3)).Curve(3), order=2)


def Polygons(figure):
    collection = next(c for c in figure.axes[0].collections if c.get_gid() == "elements")
    return np.array([path.vertices[:-1] for path in collection.get_paths()])


def Blocks(figure):
    """Surface points of the drawn foundation blocks."""
    blocks = [patch.get_xy()[:-1] for patch in figure.axes[0].patches if patch.get_gid() == "foundation"]
    return [block[:len(block) // 2] for block in blocks]


def LargestSpread(places, values):
    """Largest distance of values that belong to the same place."""
    groups = defaultdict(list)
    for place, value in zip(np.round(places, 6), values):
        groups[tuple(place + 0.0)].append(value)
    return max(np.ptp(group, axis=0).max() for group in groups.values())


def test_elements_are_drawn_where_they_are(ip):
    """Scale 0 is the mesh itself; otherwise the middle of a P1 element moves by u_h there, so does not at another scale."""
    mesh, undeformed = ip.disc.mesh, Polygons(DeformedFigure(ip, scale=0))
    vertices = mesh.ngmesh.Coordinates()
    expected = np.array([vertices[[vertex.nr for vertex in element.vertices]].mean(axis=0) for element in mesh.Elements()])
    middles = undeformed.mean(axis=1)
    assert np.abs(middles - expected[:, :2]).max() < ROUNDOFF
    u = np.array([ip.At(*middle) for middle in middles])
    for scale in (1, 3):
        moved = Polygons(DeformedFigure(ip, scale=scale)).mean(axis=1)
        assert np.abs(moved - middles - scale * u).max() < scale * ROUNDOFF
        assert np.abs(moved - middles - 2 * scale * u).max() > 0.1


def test_jumps_are_drawn(ip, h1):
    """Corners that meet in the mesh move apart for IP and stay together for H1; the drawn jump is that of u_h."""
    places = Polygons(DeformedFigure(ip, scale=0)).reshape(-1, 2)
    assert LargestSpread(places, places) < ROUNDOFF
    assert LargestSpread(places, Polygons(DeformedFigure(h1)).reshape(-1, 2)) < ROUNDOFF
    assert LargestSpread(places, Polygons(DeformedFigure(ip)).reshape(-1, 2)) > 1e-2


@pytest.mark.slow
def test_foundation_lies_at_its_gap():
    """Below the square at y = 0; in the hole of a ring at radius 1/2 - g(x), so inside and not in the body; scaled with u."""
    solution = example_4_1.Main(n=2)
    for figure in (SettingFigure(solution.disc), DeformedFigure(solution)):
        (surface,) = Blocks(figure)
        assert np.abs(surface[:, 1]).max() < ROUNDOFF and np.ptp(surface[:, 0]) == pytest.approx(1)
    assert np.abs(Blocks(DeformedFigure(solution, scale=2))[0][:, 1] + 0.05).max() < ROUNDOFF
    (surface,) = Blocks(SettingFigure(Annulus()))
    radius, angle = np.hypot(*surface.T), np.arctan2(*surface.T[::-1])
    # Gamma_C is a cubic curve: a few 1e-4 off the circle, and so are its normals.
    assert np.abs(radius - (0.5 - (0.1 + 0.05 * np.cos(angle)))).max() < 3e-3
    assert np.ptp(radius) == pytest.approx(0.1, abs=3e-3)


def test_contact_figure_is_sorted_along_the_boundary(ip):
    """On the bottom of the square s = x; the order of the points in the solution is another one."""
    line = next(line for line in ContactFigure(ip).axes[0].lines if len(line.get_xdata()) == len(ip.weights))
    order = np.argsort(ip.points[:, 0])
    assert np.allclose(line.get_xdata(), ip.points[order, 0], rtol=0, atol=ROUNDOFF)
    assert np.array_equal(line.get_ydata(), ip.pressure[order])
    assert np.any(np.diff(ip.points[:, 0]) < 0)


def test_zone_band_shows_every_zone(ip):
    """Its stretches cover Gamma_C, in the colours of the zones; their lengths agree with the quadrature to one point."""
    drawn = dict.fromkeys(map(to_rgba, ZONE_COLOURS), 0.0)
    for bar in ContactFigure(ip).axes[-1].patches:
        drawn[bar.get_facecolor()] += bar.get_width()
    expected = list(ip.ZoneLengths().values())
    assert sum(drawn.values()) == pytest.approx(1) and min(expected[0], expected[2]) > 0
    assert np.abs(np.array(list(drawn.values())) - expected).max() <= ip.weights.max()


def test_history_figure_shows_every_step(ip):
    """From a solution or its history alone."""
    for given in (ip, ip.history):
        change, residual = HistoryFigure(given).axes[0].lines
        assert np.array_equal(change.get_ydata(), [step.change for step in ip.history])
        assert np.array_equal(residual.get_ydata(), [step.residual for step in ip.history])


def test_bars_of_colours_are_no_higher_than_the_map_of_a_long_foundation():
    law = Foundation("bottom", NormalCompliance(100))
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), law, dirichlet={"top": CF((0, 0, -0.02))})

    def Heights(upper):
        figure = ContactFigure(Discretization(problem, Conforming(), BoxMesh(2, cells="hex", upper=upper), order=1).Solve())
        figure.draw_without_rendering()
        pressure, *_, bar = (axes.get_position().height * figure.get_figheight() for axes in figure.axes)
        return pressure, bar, figure.get_figheight()

    for upper in ((12, 1, 1), (1, 12, 1)):
        pressure, bar, _ = Heights(upper)
        assert 0 < bar < pressure
    assert Heights((12, 1, 1))[2] < 0.6 * Heights((1, 1, 1))[2]     # no empty paper around a narrow map


@pytest.mark.slow
def test_figures_of_a_solid(tmp_path):
    """The maps show the values at the contact points, the surface every face moved by its displacement."""
    law = Foundation("bottom", NormalCompliance(100), friction=CoulombFriction(0.4), gap=0.05 * x)
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), law, dirichlet={"top": CF((0.05, 0.02, -0.02))})
    solution = UzawaSolver(tol=1e-6).Solve(Discretization(problem, LDG(), BoxMesh(2, cells="prism"), order=1))
    pressure, friction, zones = (axes.collections[0] for axes in ContactFigure(solution).axes[:3])
    # Every point has a patch beside it, in its own values: of those nearest to the patch, which may be at one place.
    middles = np.array([path.vertices[:-1].mean(axis=0) for path in pressure.get_paths()])
    distances = np.linalg.norm(middles[:, None] - solution.points[:, :2], axis=2)
    near = distances < distances.min(axis=1)[:, None] + 1e-9
    size = np.linalg.norm(solution.friction, axis=1)
    for drawn, values in ((pressure, solution.pressure), (friction, size), (zones, solution.zones)):
        array = np.asarray(drawn.get_array(), dtype=float)
        assert np.allclose(np.sort(array), np.sort(values))
        assert np.all(np.min(np.abs(array[:, None] - values), axis=1, where=near, initial=np.inf) < 1e-9)
        assert not np.all(np.min(np.abs(array[::-1, None] - values), axis=1, where=near, initial=np.inf) < 1e-9)
    assert np.ptp(solution.pressure) > 0.1 and len(np.unique(solution.zones)) > 1
    arrows = ContactFigure(solution).axes[1].collections[-1]
    assert np.allclose(np.stack([arrows.U, arrows.V], axis=1), solution.friction[:, :2])
    surface = DeformedFigure(solution, scale=2).axes[0].collections[0]
    mesh = solution.disc.mesh
    assert len(surface.get_facecolor()) == mesh.GetNE(BND)
    corners, moved = BoundaryFunction(solution.disc.facets, solution.gfu)
    top = [u for face, u in zip(corners, moved) if np.all(face[:, 2] > 1 - 1e-9)]
    assert len(top) == 8 and np.allclose(np.concatenate(top), (0.05, 0.02, -0.02), atol=0.01)
    assert {"setting.png", "deformed.png", "contact.png", "history.png"} <= set(WriteResults(solution, tmp_path))


def test_setting_of_a_solid_is_coloured_by_what_acts():
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("bottom", NormalCompliance(1)),
                             dirichlet={"top": CF((0, 0, 0))}, traction={"left": CF((1, 0, 0))})
    mesh = BoxMesh(2, cells="hex")
    figure = SettingFigure(Discretization(problem, Conforming(), mesh))
    colours = figure.axes[0].collections[0].get_facecolor()
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert names == ["dirichlet", "traction", "foundation", "free"]
    counts = {tuple(row): sum(np.allclose(row[:3], other[:3]) for other in colours) for row in colours}
    assert sorted(counts.values()) == [4, 4, 4, 12] and len(colours) == mesh.GetNE(BND)


def External(page):
    """What a page loads from elsewhere."""
    return re.findall(r"<(?:script|link|img|iframe)\b[^>]*\b(?:src|href)\s*=[^>]*>", page)


def test_page_needs_no_network(ip, tmp_path):
    """Nothing is loaded from elsewhere, unlike in the pages of some versions of NGSolve; the camera sees the deformed body."""
    page = WriteHTML(ip, tmp_path / "u.html", scale=2).read_text(encoding="utf-8")
    assert not External(page)
    assert "render_data" in page and '"scale": 2' in page and page.rstrip().endswith("</html>")
    assert External(page.replace("<head>", '<head><script src="https://example.org/viewer.js"></script>'))


def ReadVTK(path):
    """Arrays of a .vtu file with raw appended data: a UInt32 number of bytes before each array."""
    header, _, raw = path.read_bytes().partition(b'<AppendedData encoding="raw">')
    root = ElementTree.fromstring(header + b"</VTKFile>")
    raw = raw[raw.index(b"_") + 1:]
    arrays = {}
    for array in root.iter("DataArray"):
        if array.get("type") == "Float64":
            start = int(array.get("offset"))
            size = int(np.frombuffer(raw, "<u4", 1, start)[0])
            values = np.frombuffer(raw, "<f8", size // 8, start + 4)
            arrays[array.get("Name")] = values.reshape(-1, int(array.get("NumberOfComponents")))
    return arrays


def test_vtk_keeps_the_jumps(ip, h1, tmp_path):
    """Points are duplicated, IP values differ there and H1 values do not; every element's mean is u_h at its middle."""
    for solution, name in ((ip, "ip"), (h1, "h1.vtu")):
        path = WriteVTK(solution, tmp_path / name)
        assert path.suffix == ".vtu" and path.exists()
        arrays = ReadVTK(path)
        points, u = arrays["Points"], arrays["displacement"]
        assert len(points) == 3 * solution.disc.mesh.ne and np.all(u[:, 2] == 0)
        middles, means = points.reshape(-1, 3, 3).mean(axis=1), u.reshape(-1, 3, 3).mean(axis=1)
        expected = np.array([solution.At(*middle[:2]) for middle in middles])
        assert np.abs(means[:, :2] - expected).max() < ROUNDOFF
        spread = LargestSpread(points, u)
        assert spread > 1e-2 if name == "ip" else spread < ROUNDOFF


def test_von_mises(ip, tmp_path):
    """sqrt of half the squared differences of the principal stresses; the out-of-plane stress is that of the plane state."""
    strain = example_4_2.Main(n=4, plane="strain")
    for solution, nu in ((ip, 0), (strain, 0.2)):
        arrays = ReadVTK(WriteVTK(solution, tmp_path / "s"))
        stress = arrays["stress"].reshape(-1, 3, 3)
        a, b, c = np.linalg.eigvalsh(stress).T
        expected = np.sqrt(((a - b)**2 + (b - c)**2 + (c - a)**2) / 2)
        assert np.abs(arrays["vonmises"][:, 0] - expected).max() < 1e-10 * expected.max()
        assert np.abs(stress[:, 2, 2] - nu * (stress[:, 0, 0] + stress[:, 1, 1])).max() < 1e-10 * expected.max()


def test_unwritable_paths_raise(ip, tmp_path):
    for Write in (WriteHTML, WriteVTK):
        with pytest.raises(ProblemError, match="file.* cannot be written: No such file or directory"):
            Write(ip, tmp_path / "missing" / "file")


def AssertInside(figure):
    """No text is cut off at the rim of the figure."""
    figure.draw_without_rendering()
    for text in (*figure.axes[0].texts, figure.axes[0].title):
        low, high = text.get_window_extent().get_points()
        assert np.all(low >= -1) and np.all(high <= figure.bbox.max + 1), text      # pixels


def test_titles_are_not_cut_off():
    """Not even over the narrow body of example 4.1 at its longest."""
    solution = example_4_1.Main(n=2)
    solution.converged = False
    AssertInside(DeformedFigure(solution, scale=0.125))


@pytest.mark.slow
def test_every_setting_and_solution_can_be_drawn(tmp_path):
    """Quads, rollers, tractions, body force, two foundations: all names and values are in the picture, nothing outside it."""
    foundations = (Foundation("bottom", NormalCompliance(20), friction=CoulombFriction(0.3)),
                   Foundation("right", NormalCompliance(20), gap=0.1))
    problem = ContactProblem(HookeMaterial(E=100, nu=0.3), foundations, roller={"left": 0.1}, dirichlet={"top": CF((0, -0.2))},
                             bodyforce=CF((0, -1)))
    solution = UzawaSolver().Solve(Discretization(problem, InteriorPenalty(), example_4_2.Mesh(4, "quad"), order=2))
    figure = SettingFigure(solution.disc)
    words = " ".join(text.get_text() for text in figure.axes[0].texts)
    for word in ("bottom", "right", "left", "top", "roller", "prescribed", "g = 0.1", "u = (0, -0.2)", "body force"):
        assert word in words
    AssertInside(figure)
    for figure in (ContactFigure(solution, slip=True), DeformedFigure(solution), HistoryFigure(solution)):
        figure.savefig(tmp_path / "figure.png")
    assert len(ContactFigure(solution).axes) == 2 * 4


def test_colours_of_the_page_span_the_displacement(ip, tmp_path):
    """The viewer's range is that of |u|, not of one component."""
    page = WriteHTML(ip, tmp_path / "u.html").read_text(encoding="utf-8")
    top = float(re.search(r'"funcmax": ([-+.e0-9]+)', page).group(1))
    corners = np.asarray(ip.gfu(ip.disc.mesh.MapToAllElements(CORNERS, VOL)))
    assert top == pytest.approx(np.linalg.norm(corners, axis=1).max(), rel=1e-6)
    assert top > 1.01 * np.abs(corners).max()
