"""Where the error is: the shares of the elements in an estimate."""

from __future__ import annotations

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from ..estimates.error import EstimateError
from ..estimates.estimate import ErrorEstimate
from ..exceptions import ProblemError
from ..mesh.checks import Sides
from ..mesh.facets import Coordinates
from ..solution.solution import CheckSolution, ContactSolution
from ..tools.calls import ByKeyword
from ..tools.units import WithUnits
from .canvas import Frame, PlaneAxes
from .curves import ElementOutlines, SplitByElement
from .surface import Surface

DECADES = 4     # of shares at most that have colours of their own


@ByKeyword
@WithUnits
def ErrorFigure(solution: ContactSolution, *, estimate: ErrorEstimate | None = None) -> Figure:
    """The elements in the colours of their shares in the estimated error, on a logarithmic scale [sqrt(stress length^d)].

    estimate : of the solution, by default `EstimateError(solution)`

    Where all elements have the same colour the mesh suits the problem.  In 3D the elements at the surface, from below and
    beside it from above.

    >>> from ngdgc.cases import example_4_2
    >>> figure = ErrorFigure(example_4_2.Main(n=4))
    """
    CheckSolution(solution)
    disc, estimate = solution.disc, EstimateError(solution) if estimate is None else estimate
    if not isinstance(estimate, ErrorEstimate):
        raise ProblemError(f"estimate is {estimate!r}; give an ErrorEstimate, which EstimateError(solution) returns")
    if len(estimate.indicators) != disc.mesh.ne:
        raise ProblemError(f"estimate has indicators of {len(estimate.indicators)} elements, the mesh of the solution has "
                           f"{disc.mesh.ne}; give the estimate of this solution")
    shares = np.sqrt(estimate.indicators)
    largest = shares.max() or 1.0
    least = max(shares.min(), 10.0 ** -DECADES * largest)
    colours = ScalarMappable(LogNorm(min(least, largest / 2), largest), "viridis")
    title = (f"{disc.method.name}, order {disc.order}, {disc.mesh.ne} elements\n"
             f"estimated error {estimate.value:.3g}, {estimate.relative:.2g} of the solution")
    label = f"share of an element [sqrt(stress length^{disc.mesh.dim})]"
    shares = np.maximum(shares, least)
    if disc.mesh.dim == 3:
        points, shown = disc.mesh.ngmesh.Coordinates(), np.flatnonzero(Sides(disc.facets, ".*"))
        facets, _, vertices = (array[shown] for array in disc.facets.boundary)
        behind = disc.facets.incidence.indices[disc.facets.incidence.indptr[facets]]
        faces = [points[corners[corners >= 0]] for corners in vertices]
        figure = Surface(faces, colours.to_rgba(shares[behind]), title, {})
        figure.colorbar(colours, ax=figure.axes, label=label, shrink=0.7)
        return figure
    figure, axes = PlaneAxes()
    outlines = ElementOutlines(disc)
    drawn = PolyCollection(SplitByElement(outlines, np.asarray(Coordinates(2)(outlines))), gid="elements",
                           facecolors=colours.to_rgba(shares), edgecolors="#222222", linewidths=0.3)
    axes.add_collection(drawn)
    axes.set_title(title, fontsize=10)
    figure.colorbar(colours, ax=axes, label=label)
    return Frame(axes)
