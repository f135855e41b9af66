"""Axes, colours and foundation blocks that the figures of a body share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from ..contracts import Array
from ..discrete.problem import DiscreteProblem
from ..solution.solution import ContactSolution
from .curves import Curve, Left, OutlinePoints

# Okabe and Ito's colours, which colour-blind readers tell apart; the foundation is red as in the paper.
BLUE, ORANGE, VERMILION, GREEN, RED = "#0072B2", "#E69F00", "#D55E00", "#009E73", "#CC3311"
SKY, PURPLE = "#56B4E9", "#CC79A7"
ZONE_COLOURS = ("#DDDDDD", BLUE, ORANGE)      # separation, stick, slip
FOUNDATION_COLOURS = (BLUE, ORANGE, GREEN, PURPLE, SKY)
WIDTH = 5.8     # of a figure [inch]: its 10 pt letters have 6 pt in a column of 3.5 inch
THICKNESS = 0.18    # of a foundation block, relative to the body
STOUT = 0.5         # and at most, relative to its length: a narrow one would be a spike
VISIBLE = 0.02      # but not less than that for its narrowness, relative to the body
STILL = 2e-3        # change of limits, relative to the body, that is not seen
APART = 4           # texts [pixel]
PLACED = "placed"   # gid of figures whose layout is done when they are returned
NOISE = 1e-12       # tractions that are round-off, relative to the largest


def PlaneAxes() -> tuple[Figure, Any]:
    figure = Figure(figsize=(7, 5), layout="constrained")
    axes = figure.add_subplot(aspect="equal")
    axes.spines[["top", "right"]].set_visible(False)
    axes.margins(0.03)
    return figure, axes


def Panel(axes: Any, **settings: Any) -> Any:
    """Axes without a frame on the right and on top, over a pale grid."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(color="#DDDDDD", linewidth=0.6)
    axes.set(axisbelow=True, **settings)
    return axes


def HideNoise(axes: Any, solutions: Iterable[ContactSolution]) -> None:
    """Wide limits for axes that show nothing but round-off of the tractions of some solutions."""
    largest = max(np.abs(solution.traction).max(initial=0) for solution in solutions)
    if np.abs(axes.get_ylim()).max() < NOISE * (largest or 1):
        axes.set_ylim(-1, 1)


def Unconverged(solution: ContactSolution) -> str:
    """What the title of a figure adds."""
    return "" if solution.converged else ", NOT CONVERGED"


def Labels(disc: DiscreteProblem) -> tuple[str, str]:
    """Of the axes of a plane mesh, which those of a body of revolution have other names for."""
    letters = disc.problem.frame.axes
    return f"{letters[0]} [length]", f"{letters[1]} [length]"


def Frame(axes: Any, xlabel: str = "x [length]", ylabel: str = "y [length]") -> Figure:
    """Limits around everything, texts included, and a figure of the same shape."""
    figure = axes.figure
    figure.set_gid(PLACED)
    axes.set(xlabel=xlabel, ylabel=ylabel)
    before = np.full(4, np.nan)
    for _ in range(3):
        axes.autoscale_view()
        limits = np.array([*axes.get_xlim(), *axes.get_ylim()])
        if np.all(np.abs(limits - before) <= STILL * np.ptp(limits.reshape(2, 2), axis=1).max()):
            break       # no text has moved them
        before = limits
        shape = np.ptp(axes.get_ylim()) / np.ptp(axes.get_xlim())
        height = np.clip((WIDTH - 0.8) * shape, 1.8, 5.0)
        figure.set_size_inches(np.clip(height / shape, 4.4, WIDTH - 0.8) + 0.8, height + 0.8)
        # The layout alone, as a drawing that nobody sees would begin with it.
        figure.get_layout_engine().execute(figure)
        axes.apply_aspect()
        _Part(axes)
        for text in axes.texts:
            axes.update_datalim(axes.transData.inverted().transform(text.get_window_extent().get_points()))
    return figure


def _Part(axes: Any) -> None:
    """Move texts above or below a body farther away from it until they lie on no earlier one."""
    for number, text in enumerate(axes.texts):
        for other in axes.texts[:number]:
            # Somewhat apart, as the limits of the axes still change.
            own, taken = text.get_window_extent(), other.get_window_extent().padded(APART)
            if text.get_va() in ("bottom", "top") and own.overlaps(taken):
                way = taken.y0 - own.y1 if text.get_va() == "top" else taken.y1 - own.y0
                place = axes.transData.transform(text.get_position()) + [0, way]
                text.set_position(axes.transData.inverted().transform(place))


def Thickness(disc: DiscreteProblem, curve: Curve) -> float:
    """Of a block behind a curve: a part of the body's extent along the normals, less where it is narrow or would fold."""
    outline = OutlinePoints(disc)
    wanted = THICKNESS * np.ptp(outline @ curve.normals.T, axis=0).mean()
    wanted = min(wanted, max(STOUT * curve.s[-1], VISIBLE * np.ptp(outline, axis=0).max()))
    along, turn = np.diff(curve.coordinates, axis=0), np.diff(curve.normals, axis=0)
    folding = np.sum(along * turn, axis=1)
    folds = folding < -1e-9 * np.linalg.norm(along, axis=1)
    return min(wanted, 0.7 * np.min(np.sum(along[folds]**2, axis=1) / -folding[folds], initial=np.inf))


def DrawBlock(axes: Any, curve: Curve, gap: Array, thickness: float, reach: Sequence[float] = (0, 0)) -> None:
    """The block whose surface is x + gap n; pale where it is drawn beyond its ends by `reach` along the tangents [length].

    Its back is parallel to Gamma_C, `thickness` below the deepest point: below a steep surface, as a large scale makes one of
    a narrow hill, a slab would be a pair of spikes.
    """
    surface = curve.coordinates + gap[:, None] * curve.normals
    back = curve.coordinates + (gap.max() + thickness) * curve.normals
    axes.add_patch(Polygon(np.concatenate([surface, back[::-1]]), facecolor=RED, edgecolor="none", gid="foundation"))
    for end, sign, length in ((0, -1, reach[0]), (-1, 1, reach[1])):
        if length > 0:
            beyond = sign * length * Left(curve.normals[end])
            axes.add_patch(Polygon([surface[end], surface[end] + beyond, back[end] + beyond, back[end]], facecolor=RED,
                                   alpha=0.35, edgecolor="none", gid="beyond"))


def LabelAt(axes: Any, curve: Curve, distance: float, words: str) -> None:
    """Words outside a body at the middle of a curve; of a closed one around a hole, in the hole."""
    (x,), (n,) = curve.Spaced(curve.s[-1])
    offsets = curve.coordinates - curve.coordinates.mean(axis=0)
    if curve.closed and np.sum(offsets * curve.normals) < 0:
        x, n = curve.coordinates.mean(axis=0), np.zeros(2)
    LabelBeside(axes, x, n, distance, words)


def LabelBeside(axes: Any, x: Array, n: Array, distance: float, words: str) -> None:
    """Words at x + distance n/|n| that grow away from x; n = 0 puts them on x."""
    n = n / (np.linalg.norm(n) or 1)
    horizontal = "center" if abs(n[0]) < 0.5 else "left" if n[0] > 0 else "right"
    vertical = "center" if abs(n[1]) < 0.5 else "bottom" if n[1] > 0 else "top"
    axes.text(*(x + distance * n), words, ha=horizontal, va=vertical, fontsize=9, zorder=4,
              bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1})
