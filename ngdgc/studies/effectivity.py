"""How good estimates of the error are: against exact solutions, and on random problems against fine adaptive ones.

The effectivity is the estimate over the true error in the energy norm: at 1 the estimate is right, below it promises too much.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from ngsolve import TET, TRIG, IntegrationRule, specialcf

from ..discretization import Discretization
from ..errors import EnergyError
from ..estimates.adaptive import SolveAdaptive
from ..estimates.error import EstimateError
from ..exact import Exact, SmoothSlip
from ..exceptions import NotConvergedError
from ..mesh.facets import Coordinates, VolumePoints
from ..meshes import BOXCELLS, UnitMesh
from ..methods.rows import LDG, BassiEtAl, InteriorPenalty
from ..methods.variants import Label
from ..problem.materials import StiffnessAt
from ..problem.problem import ContactProblem
from ..solution.solution import ContactSolution
from ..solvers import NestedNewtonSolver
from ..tools.calls import ByKeyword
from ..tools.tables import Aligned, Piped
from ..traces import ThreeZones
from .samples import BodyMesh, Draw
from .savings import SAVED, Saving, SavingCells

SIZES = {2: 6, 3: 3}            # cells per side of the mesh whose error is estimated
ORDERS = {2: 3, 3: 2}           # largest order there
COARSE = {2: (4, "triangle", 4, 8000), 3: (2, "tet", 3, 20000)}     # of the reference: n, cells, order, unknowns
FINER = 0.05                    # relative error of the reference in units of the estimated one
PLANE, SOLID = ("triangle", "quad"), ("tet", "hex", "prism")
METHODS = (InteriorPenalty(), LDG(), BassiEtAl(form="lifting"))


@ByKeyword
@dataclass(frozen=True)
class Estimated:
    """An estimate beside the true error, both in the energy norm [sqrt(stress length^d)].

    words : of problem, method and mesh;  simplices : triangles or tetrahedra;  stiffness : k_n/E [1/length], or nan
    bound : or None;  reason : what it holds for, or why there is none
    """

    words: str
    simplices: bool
    stiffness: float
    true: float
    value: float
    bound: float | None
    reason: str

    @property
    def effectivity(self) -> float:
        """value/true, no unit."""
        return self.value / self.true


def _Estimated(solution: ContactSolution, true: float, words: str, cells: str, stiffness: float) -> Estimated:
    estimate = EstimateError(solution)
    simplices = cells not in ("quad", "hex", "prism")
    return Estimated(words, simplices, stiffness, true, estimate.value, estimate.bound, estimate.reason)


@ByKeyword
def Exacts(*, callback: Callable[[str], object] | None = None) -> Iterator[Estimated]:
    """Exact solutions that no method has in its space, methods, cells and orders, one after the other.

    callback : called with a line of progress before each solve
    """
    problems: list[tuple[str, Exact, Sequence[str]]] = [
        ("smooth slip", SmoothSlip(), PLANE), ("nu = 0.4999", SmoothSlip(mu=2, lam=9998), PLANE),
        ("three zones", ThreeZones(), PLANE), ("smooth slip", SmoothSlip(dim=3), SOLID),
        ("nu = 0.4999", SmoothSlip(dim=3, mu=2, lam=9998), SOLID)]
    for name, exact, shapes in problems:
        for cells in shapes:
            for method in METHODS:
                for order in range(1, 3 if cells in BOXCELLS else 4):
                    words = f"{name}, {Label(method)}, order {order}, {cells}"
                    if callback:
                        callback(words)
                    disc = Discretization(exact.problem, method, UnitMesh(3 if cells in BOXCELLS else 7, cells), order=order)
                    solution = NestedNewtonSolver().Solve(disc)
                    yield _Estimated(solution, EnergyError(solution, exact.displacement), words, cells, np.nan)


@ByKeyword
def Randoms(seed: int, count: int, *, dim: int = 2, callback: Callable[[str], object] | None = None) -> Iterator[Estimated]:
    """The first `count` random problems (`samples.Draw`) of a dimension with discontinuous methods and without curved sides.

    They are solved on coarse meshes, with order 3 at most in 2D and 2 in 3D; the true error is the difference from an adaptive
    solution of order 4, or 3, whose estimated error is a twentieth of that, or which has 8 000, 20 000 unknowns.
    """
    number = found = 0
    while found < count:
        sample = Draw(seed, number)
        number, cells = number + 1, sample.mesh.args[1]
        if (3 if cells in (*BOXCELLS, "delaunay") else 2) != dim or not sample.method.discontinuous or cells == "cad":
            continue
        found += 1
        if callback:
            callback(f"{number - 1}: {sample.words}")
        order = min(sample.order, ORDERS[dim])
        disc = Discretization(sample.problem, sample.method, BodyMesh(SIZES[dim], cells), order=order)
        solution = NestedNewtonSolver().Solve(disc)
        true = Difference(Reference(sample.problem, dim, EstimateError(solution).relative), solution)
        words = sample.words.replace(f"k={sample.order}", f"k={order}").replace(f"n={sample.n}", f"n={SIZES[dim]}")
        yield _Estimated(solution, true, f"{number - 1}: {words}", cells, sample.stiffness)


def Reference(problem: ContactProblem, dim: int, relative: float) -> ContactSolution:
    """An adaptive solution of high order whose error is small against `relative`, as far as its unknowns allow."""
    n, cells, order, most = COARSE[dim]
    try:
        return SolveAdaptive(problem, InteriorPenalty(), UnitMesh(n, cells), order=order, tol=min(FINER * relative, 0.5),
                             most=most)
    except NotConvergedError as error:
        if error.solution is None:
            raise
        return error.solution


def Difference(fine: ContactSolution, coarse: ContactSolution) -> float:
    """The energy norm of the difference of two solutions, integrated on the mesh of the first [sqrt(stress length^d)]."""
    # The points of NGSolve's rule of degree 2 lie on edges, where the other mesh may see another element.
    mesh, order, dim = fine.disc.mesh, 2 * fine.disc.order + 2, fine.disc.mesh.dim
    points = VolumePoints(mesh, order)
    jacobian = np.asarray(specialcf.JacobianMatrix(dim, dim)(points)).reshape(-1, dim, dim)
    weights = np.abs(np.linalg.det(jacobian)) * np.tile(IntegrationRule(TRIG if dim == 2 else TET, order).weights, mesh.ne)
    there = coarse.disc.mesh(*np.asarray(Coordinates(dim)(points)).reshape(-1, dim).T)
    difference = (np.asarray(fine.strain(points)) - np.asarray(coarse.strain(there))).reshape(-1, dim, dim)
    C = StiffnessAt(fine.disc.problem.material, points, dim)
    return float(np.sqrt(weights @ np.einsum("nij,nijkl,nkl->n", difference, C, difference, optimize=True)))


def _Number(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


def _Cells(rows: Iterable[Estimated]) -> Iterator[tuple[str, ...]]:
    yield "problem", "true error", "estimate/true", "bound/true"
    for row in rows:
        yield row.words, f"{row.true:.2e}", f"{row.effectivity:.2f}", _Number(row.bound and row.bound / row.true)


def _Tally(rows: Sequence[Estimated]) -> Iterator[str]:
    """What random problems say."""
    values = np.array([row.effectivity for row in rows])
    stiffness = np.array([row.stiffness for row in rows])
    slope = np.polyfit(np.log10(stiffness), np.log10(values), 1)[0] if len(rows) > 2 else 0.0
    bounds = np.array([row.bound / row.true for row in rows if row.bound is not None])
    yield (f"* estimate/true of {len(rows)} problems: {values.min():.2f} to {values.max():.2f}, median "
           f"{np.median(values):.2f}; in [0.9, 3]: {100 * np.mean((values >= 0.9) & (values <= 3)):.0f} %")
    yield f"* slope of its logarithm against that of k_n/E: {slope:.3f}"
    if len(bounds):
        yield (f"* bound/true, given for {100 * len(bounds) / len(rows):.0f} %: {bounds.min():.2f} to {bounds.max():.2f}, "
               f"median {np.median(bounds):.2f}")
    reasons = Counter(row.reason.split(", q =")[0] for row in rows if row.bound is None)
    for reason, count in reasons.most_common():
        yield f"* no bound for {count}: {reason}"


@ByKeyword
def Text(exact: Sequence[Estimated], random: Sequence[Estimated], savings: Sequence[Saving]) -> str:
    """The tables for a terminal."""
    lines = [*Aligned(_Cells(exact)), ""] if exact else []
    lines += [*_Tally(random), "", *Aligned(_Cells(random)), ""] if random else []
    return "\n".join([*lines, *Aligned(SavingCells(savings))] if savings else lines)


INTRODUCTION = """# How good the estimates are

Written by `ngdgc effectivity --seed {seed} --count {count} --solids {solids} --page docs/effectivity.md`; nothing on this
page is typed by hand but the explanations.  Estimate and bound (`EstimateError`) over the true error in the energy norm.
"""


@ByKeyword
def Page(exact: Sequence[Estimated], random: Sequence[Estimated], savings: Sequence[Saving], *, seed: int, count: int,
         solids: int) -> str:
    """The page, Markdown."""
    plane = [row for row in random if ": 2D" in row.words]
    space = [row for row in random if ": 3D" in row.words]
    lines = [INTRODUCTION.format(seed=seed, count=count, solids=solids), "## Exact solutions", "", *Piped(_Cells(exact)), ""]
    for title, rows, fine in (("Random problems in 2D", plane, "order 4 with 8 000 unknowns at most"),
                              ("Random problems in 3D", space, "order 3 with 20 000 unknowns at most")):
        if rows:
            worst = sorted(rows, key=lambda row: abs(np.log(row.effectivity / 1.4)))[-5:]
            lines += [f"## {title}", "", f"Against adaptive solutions of {fine}, on coarse meshes.", "", *_Tally(rows), "",
                      "The five farthest from the middle:", "", *Piped(_Cells(worst)), ""]
    lines += ["## What adaptivity saves", "", *SAVED, "",
              *Piped(SavingCells(savings)), ""]
    return "\n".join(lines)
