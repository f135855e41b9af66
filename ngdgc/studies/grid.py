"""A grid of parameters on which the default solver is tried: geometry x coefficient of friction x k_n/E x h x order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache, partial
from itertools import product

from ngsolve import CF, x

from ..cases import example_4_1, example_4_2
from ..methods.rows import InteriorPenalty
from ..problem.foundation import Foundation
from ..problem.laws import CoulombFriction, NormalCompliance
from ..problem.materials import HookeMaterial
from ..problem.problem import ContactProblem
from ..tools.calls import ByKeyword
from ..tools.names import Known
from .samples import BodyMesh, Sample

# Geometries: the paper's examples, and a pressed and sheared block on three kinds of meshes.
CELLS = {"block": "triangle", "unstructured": "unstructured", "cad": "cad"}
CASES = {"4.1": example_4_1, "4.2": example_4_2}
# (coefficients, k_n/E, (n, order)): a part for some minutes, and everything.
PART = (0.05, 0.3, 0.5, 1.0), (1e-3, 1.0, 1e3, 1e9), ((8, 3), (16, 2), (32, 1))
EVERYTHING = ((0.05, 0.1, 0.2, 0.5, 0.7, 1.0), tuple(10.0 ** power for power in range(-3, 10, 2)),
              tuple(product((8, 16, 32, 64, 128, 256), (1, 2, 3, 4))))


@ByKeyword
def Grid(geometries: Sequence[str] | None = None, *, everything: bool = False) -> list[tuple[int, Sample]]:
    """The grid as a list of pairs (number, `Sample`), interior penalty.

    geometries : some of "4.1", "4.2", "block", "unstructured", "cad"; None: all

    >>> len(Grid(["4.1"]))
    48
    """
    known = (*CASES, *CELLS)
    geometries = [Known(geometry, known, what="geometry") for geometry in geometries or known]
    coefficients, stiffnesses, sizes = EVERYTHING if everything else PART
    problem = cache(_Problem)   # one for all sizes
    points = product(geometries, sizes, stiffnesses, coefficients)
    return [(number, _Sample(problem(geometry, stiffness, coefficient), geometry, *size, stiffness, coefficient))
            for number, (geometry, size, stiffness, coefficient) in enumerate(points)]


def _Problem(geometry: str, stiffness: float, coefficient: float) -> ContactProblem:
    if geometry not in CASES:
        return Block(stiffness, coefficient)
    case = CASES[geometry]
    problem = case.Problem()
    law = NormalCompliance(stiffness * (2000 if case is example_4_1 else 2500))
    return replace(problem, foundation=replace(problem.foundation[0], compliance=law, friction=CoulombFriction(coefficient)))


def _Sample(problem: ContactProblem, geometry: str, n: int, order: int, stiffness: float, coefficient: float) -> Sample:
    mesh = partial(CASES[geometry].Mesh, n) if geometry in CASES else partial(BodyMesh, n, CELLS[geometry], order)
    words = f"{geometry} k={order} n={n} k_n={stiffness:.0e} coulomb {coefficient:g}"
    return Sample(problem, InteriorPenalty(), mesh, n, order, "coulomb", stiffness, coefficient, words)


@ByKeyword
def Block(stiffness: float, coefficient: float, *, depth: float = 0.01) -> ContactProblem:
    """A unit square with E = 1, its top lowered by `depth` [length] and sheared over a slope: it separates, sticks and slips.

    The shear is a part of what friction on this foundation can bear, so that all three zones are there for all parameters.
    """
    shear = 0.5 * coefficient * min(stiffness, 1) * depth
    foundation = Foundation("bottom", NormalCompliance(stiffness), friction=CoulombFriction(coefficient), gap=2 * depth * x)
    return ContactProblem(HookeMaterial(E=1, nu=0.3), foundation, dirichlet={"top": CF((shear, -depth))})
