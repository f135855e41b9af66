"""Pictures of fields: colours are those of the values at their places, jumps are drawn, regions are named."""

import numpy as np
import pytest
from matplotlib import colormaps
from ngsolve import CF, Norm, x, y, z

from ngdgc import (LDG, Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial,
                   NormalCompliance, ProblemError, Solve)
from ngdgc.cases import curved_body, example_4_2
from ngdgc.meshes import BoxMesh
from ngdgc.plots import FieldFigure, LineFigure
from ngdgc.solution.fields import SpatialStress, VonMises

ROUNDOFF = 1e-11        # of fields of size 1


@pytest.fixture(scope="module")
def ip():
    return example_4_2.Main(n=4, order=2)


@pytest.fixture(scope="module", params=["tet", "hex", "prism"])
def solid(request):
    law = Foundation("bottom", NormalCompliance(100), friction=CoulombFriction(0.4))
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), law, dirichlet={"top": CF((0.05, 0.02, -0.02))})
    return Solve(Discretization(problem, LDG(), BoxMesh(2, cells=request.param), order=1))


def Drawn(figure):
    """(places of points (n, 2), their values, triangles) of a plane field."""
    mesh = next(c for c in figure.axes[0].collections if c.get_gid() == "field")
    return np.stack([mesh._triangulation.x, mesh._triangulation.y], axis=1), mesh.get_array(), mesh._triangulation.triangles


def Area(places, triangles):
    a, b, c = np.moveaxis(places[triangles], 1, 0)
    return np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]).sum() / 2


def Pixel(figure, place):
    """The colour in the picture at a place of the first axes."""
    figure.draw_without_rendering()
    figure.canvas.draw()
    column, row = figure.axes[0].transData.transform(place)
    picture = np.asarray(figure.canvas.buffer_rgba())
    return picture[int(picture.shape[0] - row), int(column), :3]


def test_the_picture_has_the_colours_of_the_values(ip):
    """Inside an element, off the lines: the colour of the colour bar at the value there, and no other's."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    figure = FieldFigure(ip, "uy")
    FigureCanvasAgg(figure)
    values = Drawn(figure)[1]
    for place in ((0.06, 0.1), (0.56, 0.6), (0.81, 0.1)):
        share = (ip.At(*place)[1] - values.min()) / np.ptp(values)
        expected, other = (255 * np.array(colormaps["viridis"](at)[:3]) for at in (share, (share + 0.3) % 1))
        drawn = Pixel(figure, place)
        # Two of 256 colours off: a pixel is 0.003 wide, and colours between corners are blended.
        assert np.abs(drawn - expected).max() < 6 < np.abs(drawn - other).max()


def test_elements_have_their_own_values(ip):
    """The triangles fill the square, have at their corners the values inside their element, and jump for DG alone."""
    h1 = example_4_2.Main(n=4, order=2, method=Conforming())
    for solution, jumps in ((ip, True), (h1, False)):
        places, values, triangles = Drawn(FieldFigure(solution, "ux"))
        assert Area(places, triangles) == pytest.approx(1, rel=1e-12)
        middles, means = places[triangles].mean(axis=1), values[triangles].mean(axis=1)
        expected = np.array([solution.At(*middle)[0] for middle in middles[::17]])
        # Of a quadratic function the mean of the corners is h^2/12 times its second derivatives off, h = 1/16.
        assert np.abs(means[::17] - expected).max() < 0.02 * np.ptp(values)
        groups = {}
        for place, value in zip(np.round(places, 9), values):
            groups.setdefault(tuple(place + 0.0), []).append(value)
        largest = max(np.ptp(group) for group in groups.values())
        assert (largest > 1e-3 * np.ptp(values)) if jumps else (largest < ROUNDOFF)


@pytest.mark.slow
def test_names_are_fields(ip):
    """By name or as functions of one's own; the stress across the plane is 0 in plane stress."""
    for name, function in (("ux", ip.gfu[0]), ("displacement", Norm(ip.gfu)), ("sxy", ip.stress[0, 1]), ("szz", CF(0)),
                           ("meanstress", (ip.stress[0, 0] + ip.stress[1, 1]) / 3), ("vonmises", VonMises(SpatialStress(ip)))):
        named, own = (Drawn(FieldFigure(ip, field))[1] for field in (name, function))
        assert np.allclose(named, own, rtol=1e-12, atol=1e-12)
    assert FieldFigure(ip, "SXY").axes[1].get_ylabel() == "$\\sigma_{xy}$ [stress]"
    strain = example_4_2.Main(n=4, plane="strain")
    assert np.abs(Drawn(FieldFigure(strain, "szz"))[1]).max() > 1
    with pytest.raises(ProblemError, match="field 'szy'"):
        FieldFigure(ip, "szy")


def test_regions_are_named_beside_them(ip):
    """On a curved body too; every name once, outside of the body."""
    figure = FieldFigure(ip)
    at = {text.get_text(): text.get_position() for text in figure.axes[0].texts}
    assert set(at) == {"left", "right", "bottom", "top"}
    assert at["left"][0] < 0 < 1 < at["right"][0] and at["bottom"][1] < 0 < 1 < at["top"][1]
    solution = curved_body.Main()
    names = [text.get_text() for text in FieldFigure(solution).axes[0].texts]
    assert sorted(names) == sorted(set(solution.disc.mesh.GetBoundaries()))


def test_limits_are_those_of_the_colours(ip):
    figure = FieldFigure(ip, limits=(0, 100))
    assert figure.axes[1].get_ylim() == (0, 100)
    assert FieldFigure(ip).axes[1].get_ylim() != (0, 100)


@pytest.mark.slow
def test_a_cut_is_where_the_plane_is(solid):
    """Through elements, along their sides and across corners: the section's area, and a linear field exact at its points."""
    field = 3 * x - y + 2 * z
    for point, normal, area in (((0.3, 0, 0), (2, 0, 0), 1), ((0.5, 0, 0), (1, 0, 0), 1), ((0, 0, 0), (1, -1, 0), 2**0.5),
                                ((0.5, 0.5, 0.5), (1, 1, 1), 0.75 * 3**0.5)):
        figure = FieldFigure(solid, field, cut=(point, normal))
        places, values, triangles = Drawn(figure)
        assert Area(places, triangles) == pytest.approx(area, rel=1e-7)
        if normal == (2, 0, 0):     # the axes are y and z
            assert np.abs(values - (0.9 - places[:, 0] + 2 * places[:, 1])).max() < ROUNDOFF
            assert figure.axes[0].get_xlabel() == "y [length]"
            assert {text.get_text() for text in figure.axes[0].texts} == {"left", "right", "bottom", "top"}
    assert np.ptp(Drawn(FieldFigure(solid, x, cut=((0.3, 0, 0), (1, 0, 0))))[1]) < ROUNDOFF


@pytest.mark.slow
def test_outlines_on_a_cut_are_those_of_the_elements(solid):
    """Parallel to sides of a cube of 2^3 cells, through cells: at least 4 squares, the lines inside counted from both sides."""
    figure = FieldFigure(solid, "uz", cut=((0, 0, 0.3), (0, 0, 1)))
    lines = next(c for c in figure.axes[0].collections if c.get_gid() == "outlines")
    pieces = np.array(lines.get_segments())
    length = np.linalg.norm(pieces[:, 1] - pieces[:, 0], axis=1).sum()
    # 4 squares of side 1/2; of prisms their diagonals, twice; tetrahedra are cut in more ways.
    squares, diagonals = 8, 8 * 0.5**0.5
    shape = len(next(iter(solid.disc.mesh.Elements())).vertices)
    if shape == 4:
        assert length > squares + 0.5 * diagonals
    else:
        assert length == pytest.approx(squares + (diagonals if shape == 6 else 0), rel=1e-7)


def test_the_surface_of_a_solid_has_the_values_inside(solid):
    """From below and from above; colours of the faces are those of the means of the field over them; all of the surface."""
    figure = FieldFigure(solid, x + 2 * z)
    first, second = figure.axes[:2]
    assert first.elev < 0 < second.elev and first.azim % 360 != second.azim % 360
    for axes in (first, second):
        (surface,) = axes.collections
        faces = np.asarray(surface._faces)
        area = np.linalg.norm(np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0]), axis=1).sum() / 2
        assert area == pytest.approx(6, rel=1e-12)
        means = faces.mean(axis=1) @ (1, 0, 2)
        colours = surface._facecolor3d
        assert np.allclose(colours, colormaps["viridis"](means / 3), atol=0.02)
        assert not np.allclose(colours, colormaps["viridis"](faces.mean(axis=1) @ (2, 0, 1) / 3), atol=0.02)
    below, above = ({text.get_text() for text in axes.texts} for axes in (first, second))
    assert "bottom" in below - above and "top" in above - below and len(below | above) == 6
    (axes, _) = FieldFigure(solid, view=(10, 20)).axes
    assert (axes.elev, axes.azim) == (10, 20)


def test_a_line_breaks_where_elements_end(ip):
    """Values are those of the solution there; across each of the three inner sides of the elements the line is broken."""
    (line,) = LineFigure(ip, (0, 0.1), (1, 0.1), field="uy").axes[0].lines
    s, values = line.get_data()
    there = ~np.isnan(s)
    expected = [ip.At(at, 0.1)[1] for at in s[there][1:-1:50]]
    assert np.abs(values[there][1:-1:50] - expected).max() < 1e-6 * np.abs(values[there]).max()
    breaks = s[np.flatnonzero(np.isnan(s)) - 1]
    assert len(breaks) == 7         # three vertical sides and four diagonals
    assert np.abs(np.subtract.outer((0.25, 0.5, 0.75), breaks)).min(axis=1).max() < 2 / 800


def test_a_line_along_sides_is_on_one_side_of_them(ip):
    """Not now on this and now on that: the field is that of the elements above."""
    (line,) = LineFigure(ip, (0, 0.5), (1, 0.5), field="syy").axes[0].lines
    s, values = line.get_data()
    there = ~np.isnan(s)
    above = LineFigure(ip, (0, 0.5 + 1e-6), (1, 0.5 + 1e-6), field="syy").axes[0].lines[0].get_ydata()
    below = LineFigure(ip, (0, 0.5 - 1e-6), (1, 0.5 - 1e-6), field="syy").axes[0].lines[0].get_ydata()
    near, far = (np.abs(values[there] - side[~np.isnan(side)]).max() for side in (above, below))
    assert min(near, far) < 1e-3 * max(near, far)


def test_a_line_through_nothing_is_left_out():
    """Below the arch of the curved body there is nothing to draw."""
    (line,) = LineFigure(curved_body.Main(), (0, 0), (3, 1)).axes[0].lines
    s, values = line.get_data()
    at = s[~np.isnan(values)]
    assert 1.99 < at.min() < 2.02 and 2.48 < at.max() < 2.51
