"""Table 3 of Xiao, Wang, Han 2018: |u_e - u_h|_{1,h} for the two examples, P1, in every reading of what was computed.

The paper leaves open plane strain or stress (it says stress, and prints the plane-strain lam), the diagonal of the
triangulation, and how u_h is compared with the reference u_e on the mesh 1/128.  The numbers fit the strain seminorm
without C, |v|^2 = sum_K int_K |eps(v)|^2.  Protocols:

* true error: eps(u_h) - eps(u_e) integrated on the fine mesh
* nodal interpolant: eps(u_h) - eps(I_h u_e) on the coarse mesh, I_h u_e taking at each vertex of an element the value of
  the fine element in its corner
* averaged interpolant: the same with u_e averaged over the fine elements around the vertex

The paper ran interior penalty alone, with eta = 30 mu.  LDG has the same penalty term and takes the same eta; the eta of
Bassi et al. and Brezzi et al. multiplies a lifting and takes the automatic value, twice the number of edges of a triangle.  The
edge form of interior penalty and H1 are computed in every reading; the others, whose references take far longer, in the one in
which the interpolants of interior penalty come closest to the published numbers: plane stress and `/` for Example 4.1, plane
strain and `\\` for Example 4.2.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from ngsolve import TRIG, VOL, IntegrationRule

from ..cases import example_4_1, example_4_2
from ..contracts import Array
from ..discretization import Discretization
from ..errors import Rates
from ..exceptions import ProblemError
from ..mesh.facets import Coordinates
from ..methods.variants import Variants
from ..solution.solution import ContactSolution
from ..solvers import UzawaSolver

EXAMPLES = {"4.1": example_4_1, "4.2": example_4_2}
PUBLISHED = {"4.1": (6.1438e-2, 3.0672e-2, 1.5566e-2, 7.4369e-3), "4.2": (1.0134e-1, 5.9611e-2, 3.3589e-2, 1.8337e-2)}
SIZES = (4, 8, 16, 32)
PAPER = "IP edge"                           # the method of the published numbers
EVERY = (PAPER, "H1")                       # computed in every reading
CLOSEST = {"4.1": ("stress", "triangle"), "4.2": ("strain", "triangle-flipped")}
PROTOCOLS = ("true error", "nodal interpolant", "averaged interpolant")
DIAGONALS = {"triangle": "/", "triangle-flipped": "\\"}


@dataclass(frozen=True)
class Reading:
    """One way to read the table: errors for the meshes 1/4 ... 1/32."""

    example: str
    method: str
    plane: str
    cells: str
    protocol: str
    errors: np.ndarray

    @property
    def ratios(self) -> Array:
        """Ours divided by the published numbers."""
        return self.errors / PUBLISHED[self.example]

    @property
    def distance(self) -> float:
        """Largest deviation of the ratios from 1."""
        return float(np.abs(self.ratios - 1).max())

    @property
    def spread(self) -> float:
        """Largest ratio over smallest, minus 1: zero if the orders are the published ones."""
        return float(self.ratios.max() / self.ratios.min() - 1)

    def __str__(self) -> str:
        return (f"{self.protocol}, plane {self.plane}, diagonal `{DIAGONALS[self.cells]}`, "
                f"ratios {self.ratios.min():.3f} to {self.ratios.max():.3f}")


class BrokenP1:
    """A piecewise linear displacement as vertex coordinates and one-sided vertex values, both (elements, 3, 2)."""

    def __init__(self, solution: ContactSolution) -> None:
        self.mesh = solution.disc.mesh
        vertices = IntegrationRule(points=[(1, 0), (0, 1), (0, 0)], weights=[0, 0, 0])
        points = self.mesh.MapToAllElements({TRIG: vertices}, VOL)
        self.vertices = np.asarray(Coordinates(2)(points)).reshape(-1, 3, 2)
        self.values = np.asarray(solution.gfu(points)).reshape(-1, 3, 2)
        self.centroids = self.vertices.mean(axis=1)
        edges = self.vertices[:, 1:] - self.vertices[:, :1]
        self.areas = np.abs(np.linalg.det(edges)) / 2

    def Strain(self, values: Array) -> Array:
        """eps of the linear function with these vertex values, (elements, 2, 2)."""
        edges = self.vertices[:, 1:] - self.vertices[:, :1]
        gradient = np.linalg.solve(edges, values[:, 1:] - values[:, :1])
        return (gradient + np.swapaxes(gradient, 1, 2)) / 2

    def Locate(self, points: Array) -> Any:
        """Numbers of the elements that contain the points (n, 2)."""
        return self.mesh(points[:, 0].copy(), points[:, 1].copy())["nr"]

    def Averaged(self) -> Array:
        """Vertex values averaged over the elements around each vertex, (elements, 3, 2)."""
        _, number = np.unique(np.round(self.vertices.reshape(-1, 2), 9), axis=0, return_inverse=True)
        number = np.ravel(number)
        means = [np.bincount(number, component) / np.bincount(number) for component in self.values.reshape(-1, 2).T]
        return np.stack([mean[number] for mean in means], axis=1).reshape(-1, 3, 2)


def Errors(coarse: BrokenP1, fine: BrokenP1) -> tuple[float, ...]:
    """Errors of a coarse against a fine BrokenP1 in the three protocols."""
    parents = coarse.Locate(fine.centroids)
    true = _Seminorm(coarse.Strain(coarse.values)[parents] - fine.Strain(fine.values), fine.areas)
    return (true, *(_Seminorm(coarse.Strain(coarse.values - _AtVertices(coarse, fine, values)), coarse.areas)
                    for values in (fine.values, fine.Averaged())))


def _Seminorm(strain: Array, areas: Array) -> float:
    return float(np.sqrt(np.einsum("kij,kij,k->", strain, strain, areas)))


def _AtVertices(coarse: BrokenP1, fine: BrokenP1, values: Array) -> Array:
    """Fine vertex values at the vertices of coarse elements, from the fine element in that corner, (elements, 3, 2)."""
    inward = coarse.vertices + 1e-3 * (coarse.centroids[:, None] - coarse.vertices)
    corner = fine.Locate(inward.reshape(-1, 2))
    distance = np.linalg.norm(fine.vertices[corner] - coarse.vertices.reshape(-1, 1, 2), axis=2)
    return values[corner, distance.argmin(axis=1)].reshape(-1, 3, 2)


def Methods(name: str = "all") -> dict[str, Any]:
    """{label: method} with the penalties of this table; `name` as for `variants.Variants`."""
    return Variants(name, penalty={"ip": 30, "ldg": 30})


def Study(n: int = 128, *, methods: Any = None, callback: Callable[[str], object] | None = None) -> list[Reading]:
    """All `Readings` as a list."""
    return list(Readings(n, methods=methods, callback=callback))


def Readings(n: int = 128, *, methods: Any = None, callback: Callable[[str], object] | None = None) -> Iterator[Reading]:
    """Yield every Reading; `n` is the reference mesh 1/n, a multiple of 32, and `callback(line)` reports progress.

    methods : {label: method}, by default Methods(), all nine
    """
    if n % max(SIZES) or n <= max(SIZES):
        raise ProblemError(f"n is {n}; the reference mesh must refine the meshes 1/4 ... 1/32: give a larger multiple of 32")
    for example, (name, method) in product(EXAMPLES, (methods or Methods()).items()):
        for plane, cells in product(("stress", "strain"), DIAGONALS) if name in EVERY else (CLOSEST[example],):
            if callback:
                callback(f"example {example}, {name}, plane {plane}, diagonal {DIAGONALS[cells]}")
            yield from _Read(example, name, method, plane, cells, n)


def _Read(example: str, name: str, method: Any, plane: str, cells: str, n: int) -> list[Reading]:
    """The protocols of one solution."""
    case = EXAMPLES[example]
    problem = case.Problem(plane)
    fine, *coarse = (BrokenP1(UzawaSolver().Solve(Discretization(problem, method, case.Mesh(size, cells), order=1)))
                     for size in (n, *SIZES))
    errors = np.array([Errors(solution, fine) for solution in coarse])
    # A continuous reference has nothing to average.
    protocols = PROTOCOLS if method.discontinuous else PROTOCOLS[:2]
    return [Reading(example, name, plane, cells, protocol, errors[:, column]) for column, protocol in enumerate(protocols)]


def _Sections(readings: Sequence[Reading]) -> Iterator[tuple[str, list[Any]]]:
    """(title, rows) of the tables: the methods in every reading, then all methods in the closest one; rows are (label, cells
    of the four meshes, orders)."""
    for example in EXAMPLES:
        own = [reading for reading in readings if reading.example == example]
        for method in EVERY:
            rows = [(f"{r.plane} {DIAGONALS[r.cells]} {r.protocol}", r) for r in own if r.method == method]
            if rows:
                yield f"Example {example}, {method}", [_Published(example), *(_Row(*row) for row in rows)]
        plane, cells = CLOSEST[example]
        rows = [(f"{protocol}, {r.method}", r) for protocol in PROTOCOLS for r in own
                if (r.plane, r.cells, r.protocol) == (plane, cells, protocol)]
        if not rows:
            continue
        yield (f"Example {example}, all methods, plane {plane}, diagonal {DIAGONALS[cells]}",
               [_Published(example), *(_Row(*row) for row in rows)])


def _Published(example: str) -> tuple[Any, ...]:
    return "published (IP)", [f"{value:.4e}" for value in PUBLISHED[example]], Rates(PUBLISHED[example])


def _Row(label: str, reading: Reading) -> tuple[Any, ...]:
    return label, [f"{e:.4e} ({r:.2f})" for e, r in zip(reading.errors, reading.ratios)], Rates(reading.errors)


def FormDifferences(readings: Sequence[Reading]) -> list[str]:
    """Sentences: largest relative difference of the errors of edge and lifting form, per example and method."""
    found: dict[tuple[str, str], float] = {}
    for edge, lifting in product(readings, readings):
        pair = edge.method.removesuffix(" edge"), lifting.method.removesuffix(" lifting")
        same = all(getattr(edge, name) == getattr(lifting, name) for name in ("example", "plane", "cells", "protocol"))
        if same and edge.method != lifting.method and pair[0] == pair[1]:
            difference = float(np.abs(edge.errors / lifting.errors - 1).max())
            found[edge.example, pair[0]] = max(difference, found.get((edge.example, pair[0]), 0))
    return [f"Example {example}, {name}: edge and lifting form, computed separately, differ by {difference:.1e} relatively."
            for (example, name), difference in found.items()]


def Verdict(readings: Sequence[Reading]) -> list[str]:
    """Sentences: which interior-penalty reading comes closest in each protocol, and whose orders agree best."""
    sentences = []
    for example in EXAMPLES:
        own = [reading for reading in readings if (reading.example, reading.method) == (example, PAPER)]
        if not own:
            continue
        for protocol in PROTOCOLS:
            best = min((reading for reading in own if reading.protocol == protocol), key=lambda reading: reading.distance)
            sentences.append(f"Example {example}, closest: {best}.")
        steady = min(own, key=lambda reading: reading.spread)
        sentences.append(f"Example {example}, orders closest to the published ones: {steady}, constant to "
                         f"{100 * steady.spread:.1f} %.")
    return sentences


def Text(readings: Sequence[Reading]) -> str:
    """The tables for a terminal."""
    lines = []
    for title, rows in _Sections(readings):
        lines += [f"{title}: |u_e - u_h|_(1,h) and its ratio to the published number",
                  f"{'':<38}" + "".join(f"{'1/' + str(size):>19}" for size in SIZES) + "   orders"]
        lines += [f"{label:<38}" + "".join(f"{cell:>19}" for cell in cells) + "   " + " ".join(f"{o:.3f}" for o in orders)
                  for label, cells, orders in rows]
        lines.append("")
    return "\n".join(lines + Verdict(readings) + FormDifferences(readings))


def Page(readings: Sequence[Reading]) -> str:
    """The documentation page, Markdown."""
    lines = ["# Table 3 of the paper, in every reading", "",
             "Written by `ngdgc table3 --page docs/table3.md`; nothing on this page is typed by hand.", "",
             *__doc__.split("\n")[2:],
             "Ratios to the published numbers are in parentheses; `/` and `\\` are the diagonals of the squares.", "",
             "## Which reading comes closest", "", *(f"* {sentence}" for sentence in Verdict(readings)), "",
             "## Do the two forms agree?", "",
             "They must for P1 on triangles, where C eps(V_h) lies in the lifting space.", "",
             *(f"* {sentence}" for sentence in FormDifferences(readings)), ""]
    for title, rows in _Sections(readings):
        lines += [f"## {title}", "", "| | " + " | ".join(f"1/{size}" for size in SIZES) + " | orders |",
                  "|---" * (len(SIZES) + 2) + "|"]
        lines += [f"| {label} | " + " | ".join(cells) + " | " + ", ".join(f"{o:.3f}" for o in orders) + " |"
                  for label, cells, orders in rows]
        lines.append("")
    return "\n".join(lines)
