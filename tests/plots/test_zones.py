"""Zones lie along the boundary in two dimensions and cover it in three, in colours that can be told apart."""

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from netgen.geom2d import SplineGeometry
from ngsolve import CF, Mesh, y

from ngdgc import (ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NestedNewtonSolver, NormalCompliance)
from ngdgc.plots import ZONE_COLOURS, ZonesFigure
from ngdgc.plots.canvas import BLUE, ORANGE, VERMILION
from ngdgc.plots.solid import Cells

ROUNDOFF = 1e-12    # coordinates are of size 1


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


def test_zone_colours_differ_in_grey():
    """So that they can be told apart without colours; so do marks on and off the law."""
    def Grey(colour):
        return np.dot(to_rgba(colour)[:3], (0.2126, 0.7152, 0.0722))

    greys = sorted(map(Grey, ZONE_COLOURS))
    assert min(np.diff(greys)) > 0.15 and set(ZONE_COLOURS[1:]) == {BLUE, ORANGE}
    assert abs(Grey(BLUE) - Grey(VERMILION)) > 0.01
