"""Exercises of notebook 11, error bars and meshes that find the place."""

from __future__ import annotations

from functools import cache, partial
from typing import Any

import numpy as np

from ..contracts import Array
from ..discretization import Discretization
from ..errors import EnergyError
from ..estimates.error import EstimateError
from ..estimates.estimate import ErrorEstimate
from ..estimates.marking import Fewest
from ..exact import CubicCompliance, SmoothSlip
from ..meshes import RectangleMesh
from ..methods.rows import InteriorPenalty
from ..solvers import SemismoothNewtonSolver, UzawaSolver
from .checker import Choice, Function
from .effectivity import Estimator, Series

METHOD = InteriorPenalty()
SOFT = 5.0          # stiffness of the foundation on which the iteration is stopped early
EARLY = 0.3         # its tolerance
Sample = tuple[ErrorEstimate, float]


def Cubic(n: int, method: InteriorPenalty = METHOD) -> Sample:
    exact = CubicCompliance(E=1000, nu=0.3)
    disc = Discretization(exact.problem, method, RectangleMesh(n, upper=(2, 1)), order=2)
    solution = SemismoothNewtonSolver().Solve(disc)
    return EstimateError(solution), EnergyError(solution, exact.displacement)


def Stopped(n: int) -> Sample:
    """An iteration that was stopped early."""
    exact = SmoothSlip(stiffness=SOFT)
    solution = UzawaSolver(tol=EARLY).Solve(Discretization(exact.problem, METHOD, RectangleMesh(n), order=2))
    return EstimateError(solution), EnergyError(solution, exact.displacement)


@cache
def Meshes() -> list[Sample]:
    return [Cubic(n) for n in (2, 4, 8)]


@cache
def Penalties() -> list[Sample]:
    return [Cubic(4, InteriorPenalty(penalty=penalty)) for penalty in (30, 300, 3000)]


@cache
def Early() -> list[Sample]:
    return [Stopped(n) for n in (4, 8, 16)]


REFINED = Series(words="On meshes that are refined", Samples=Meshes, wanted="steady")


def Parts(estimate: ErrorEstimate) -> dict[str, float]:
    return dict(estimate.parts)


def Root(parts: dict[str, float], *without: str) -> float:
    return float(np.sqrt(sum(share ** 2 for name, share in parts.items() if name not in without)))


def Shares(rng: np.random.Generator) -> tuple[Any, ...]:
    """A few elements with most of the error."""
    return rng.uniform(0.01, 1, 60) ** 2, 0.6


def Counted(indicators: Array, share: float) -> Array:
    """A share of the elements."""
    marked = np.zeros(len(indicators))
    marked[np.argsort(-indicators)[:round(share * len(indicators))]] = 1
    return marked


def OneLess(indicators: Array, share: float) -> Array:
    """Without the element that makes the share full."""
    marked = Fewest(indicators, share)
    marked[np.flatnonzero(marked)[np.argmin(indicators[marked])]] = False
    return marked


def Smallest(indicators: Array, share: float) -> Array:
    """The same share of the sum, of the elements with the least."""
    return np.argsort(np.argsort(indicators)) < np.searchsorted(np.cumsum(np.sort(indicators)), share * indicators.sum()) + 1


def Halved(rng: np.random.Generator) -> tuple[Any, ...]:
    """Unknowns and errors on meshes that are halved, of an order that finds itself, and a wanted error."""
    return 384 * 4 ** np.arange(5), 0.15 * np.cumprod(np.append(1, 2 ** -rng.uniform(0.7, 0.9, 4))), 0.002


def Needed(N: Array, errors: Array, wanted: float, *, last: int = -1, before: int = -2, square: float = 1.0) -> float:
    order = np.log(errors[before] / errors[last]) / np.log(N[last] / N[before])
    return float(N[-1] * (errors[-1] / wanted) ** (square / order))


EXERCISES = {
    "11.1": Estimator(
        series=(REFINED,), Given=lambda estimate: estimate.indicators.copy(), words="Total",
        insight="The root of the sum, as for Pythagoras: the elements are pieces of one integral.", mistakes={
            "You add up shares: the effectivity goes to infinity, like the root of the number of elements.  What adds up are "
            "squares.": lambda indicators: np.sqrt(indicators).sum(),
            "The largest share stands for one element: the effectivity goes to 0, the more elements there are.":
                lambda indicators: np.sqrt(indicators.max()),
            "A mean over elements: the effectivity goes to 0, as each element has less and less of the error.":
                lambda indicators: np.sqrt(indicators.mean()),
            "An energy, not its root: indicators are squares, and so is their sum.": lambda indicators: indicators.sum()}),
    "11.2": Estimator(
        series=(REFINED, Series(words="With an iteration that is stopped at the same residual on finer and finer meshes",
                                Samples=Early, wanted="falls")),
        Given=Parts, words="Deaf",
        insight="It sees a stress in equilibrium, but not that it belongs to another traction than the law has.  On converged "
                "solutions nobody would notice.", mistakes={
            "Nothing is left out: this one sees the iteration, too.": Root,
            "Nearly: what of the traction no law can give is the law's part, too.": lambda parts: Root(parts, "law"),
            "Nearly: how far displacement and traction are from the graph of the law is still in.":
                lambda parts: Root(parts, "feasibility"),
            "That is what is to be left out.  Without it the rest should remain.":
                lambda parts: float(np.hypot(parts["law"], parts["feasibility"])),
            "The root is missing, and the effectivity has a unit.": lambda parts: Root(parts, "law", "feasibility") ** 2}),
    "11.3": Estimator(
        series=(REFINED, Series(words="With a penalty that grows", Samples=Penalties, wanted="falls")),
        Given=Parts, words="Naive",
        insight="The penalty makes jumps small, not the error.  What a computed stress lacks is balance, and that has to be "
                "measured.", mistakes={
            "Nothing is left out.  Which distances vanish if s is the computed stress itself?": Root,
            "The computed stress is symmetric: another part vanishes with it.": lambda parts: Root(parts, "stress"),
            "The distance of s from the computed stress is still in.": lambda parts: Root(parts, "skew"),
            "The jumps compare the computed stress with that of a continuous displacement: they stay, s does not occur.":
                lambda parts: Root(parts, "jumps"),
            "The law knows both, the displacement and the traction, and stays; so do the jumps.":
                lambda parts: Root(parts, "stress", "skew", "jumps")}),
    "11.4": Function(
        Right=Fewest, Data=Shares, words="Mark", hint="Sort them, the largest first, and add up until there is enough.",
        insight="Doerfler 1996.  For linear problems meshes by this rule are proved to have the best order that there is.",
        mistakes={
            "That is a share of the elements; it is a share of the sum that is asked for.": Counted,
            "That compares with the largest one; how much of the sum these have is left to chance.":
                lambda indicators, share: indicators >= share * indicators.max(),
            "One is missing: the share has to be reached.": OneLess,
            "You begin with the smallest ones: those are the most elements, not the fewest.": Smallest,
            "The indicators are squares already.": lambda indicators, share: Fewest(indicators ** 2, share),
            "The roots are not what adds up: the indicators themselves do.":
                lambda indicators, share: Fewest(np.sqrt(indicators), share),
            "The other way round: True is for elements that are refined.":
                lambda indicators, share: np.logical_not(Fewest(indicators, share)),
            "As indices these are right; make a mask of all elements, True where an element is refined.":
                lambda indicators, share: np.flatnonzero(Fewest(indicators, share))}),
    "11.5": Function(
        Right=Needed, Data=Halved, tol=1e-6, words="Needed",
        hint="A straight line through the last two points, in logarithms of both.",
        insight="An order below 1, that of the corner: a digit costs hundreds of times the unknowns, for any degree.",
        mistakes={
            "That is a straight line without logarithms: an error does not become negative.":
                lambda N, errors, wanted: N[-1] + (wanted - errors[-1]) * (N[-1] - N[-2]) / (errors[-1] - errors[-2]),
            "That is the order in 1/h; in the plane the unknowns are its square.": partial(Needed, square=0.5),
            "Your order is already that in unknowns; it was squared once more.": partial(Needed, square=2.0),
            "That takes the error for proportional to 1/N: measure the order.":
                lambda N, errors, wanted: N[-1] * errors[-1] / wanted,
            "The first two meshes are the coarsest: take the last two.": partial(Needed, last=1, before=0),
            "Between the first and the last mesh the order changes: take the last two.": partial(Needed, before=0),
            "That is how many times more; multiply by the unknowns of the last mesh.":
                lambda N, errors, wanted: Needed(N, errors, wanted) / N[-1]}),
    "11.6": Choice(
        right=("c", 1), choices={"a": "Look at the lines of uniform meshes for both degrees: do their slopes differ?",
                                 "b": "Which part of the estimate would have shown it?"},
        reasons={2: "They are, but look at the picture of the shares: are they where the error is?",
                 3: "A constant factor moves a line, it does not turn it."},
        insight="Small elements where derivatives are large, and degrees count again.")}
