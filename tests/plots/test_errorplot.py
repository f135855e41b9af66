"""The figure of the estimated error shows the share of every element."""

from dataclasses import replace

import numpy as np
import pytest

from ngdgc import LDG, Conforming, EstimateError
from ngdgc.cases import example_4_2
from ngdgc.estimates.residual import ResidualEstimate
from ngdgc.exact import SmoothSlip
from ngdgc.meshes import BoxMesh
from ngdgc.plots import ErrorFigure
from problems import Solved


def Brightness(figure):
    collection = next(c for c in figure.axes[0].collections if len(c.get_facecolors()) > 1)
    return collection.get_facecolors()[:, :3].sum(axis=1)


def test_elements_are_the_brighter_the_larger_their_share():
    solution = example_4_2.Main(n=4, method=LDG())
    estimate = EstimateError(solution)
    found = Brightness(ErrorFigure(solution, estimate=estimate))
    order = np.argsort(estimate.indicators)
    assert len(found) == solution.disc.mesh.ne and found[order[-1]] == found.max()
    assert np.all(np.diff(found[order]) > -1e-9) and found.max() > 2 * found.min()     # viridis grows brighter
    assert f"{estimate.value:.3g}" in ErrorFigure(solution).axes[0].get_title()


@pytest.mark.parametrize("squares, ends", [((4.0, 1.0), (1, 2)), ((1.0, 1e-12), (1e-4, 1)), ((9.0, 9.0), (1.5, 3)),
                                           ((0.0, 0.0), (1e-4, 1))], ids=["plain", "decades", "equal", "nothing"])
def test_colours_are_of_roots_in_four_decades_at_most(squares, ends):
    """Shares of the same size have half of it at the other end of their scale, and no error has a scale as well."""
    solution = example_4_2.Main(n=4, method=LDG())
    estimate = EstimateError(solution)
    indicators = np.resize(squares, solution.disc.mesh.ne)
    figure = ErrorFigure(solution, estimate=replace(estimate, indicators=indicators))
    assert figure.axes[1].get_ylim() == pytest.approx(ends)


def test_other_estimates_are_drawn_as_well():
    solution = example_4_2.Main(n=4, method=Conforming())
    assert len(Brightness(ErrorFigure(solution, estimate=ResidualEstimate(solution)))) == solution.disc.mesh.ne


@pytest.mark.slow
@pytest.mark.parametrize("cells, faces", [("tet", 48), ("hex", 24)])
def test_surface_of_a_solid(cells, faces):
    mesh = BoxMesh(2, cells=cells)
    figure = ErrorFigure(Solved(SmoothSlip(dim=3).problem, LDG(), mesh, 1))
    figure.draw_without_rendering()
    assert len(Brightness(figure)) == faces
