"""An atlas of solvers: iterations, applications of A^-1 and seconds of all iterations on a grid of contact problems.

Uzawa's iteration as in Xiao, Wang, Han 2018, its improvements, and Newton's method; one thing varies at a time around a base
point: the stiffness of the foundation, the friction coefficient, the mesh, the order, the method, the dimension.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from ngsolve import CF, x, y

from ...cases import example_4_1, example_4_2
from ...discretization import Discretization
from ...exceptions import NotConvergedError, ProblemError
from ...meshes import BoxMesh, RectangleMesh
from ...methods.variants import Variants
from ...problem.foundation import Foundation
from ...problem.laws import CoulombFriction, NormalCompliance
from ...problem.materials import HookeMaterial
from ...problem.problem import ContactProblem
from ...solvers import NestedNewtonSolver, SemismoothNewtonSolver, UzawaSolver
from ...tools.calls import ByKeyword

TOL = 1e-8          # the paper's
LIMIT = 1000        # iterations of Uzawa's kind
QUICK = 100         # the same for a quick atlas
STIFF = 1e3         # k_n/E of a foundation on which the explicit iteration has no chance
EXAMPLES = {"4.1": example_4_1, "4.2": example_4_2}
YOUNG = {"4.1": 2000, "4.2": 2500, "block": 1000, "box": 1000}      # E [stress]


@ByKeyword
def Solvers(*, tol: float = TOL, limit: int = LIMIT) -> dict[str, Any]:
    """{label: solver}, from the paper's iteration to the default of the package."""
    def Uzawa(**arguments: Any) -> UzawaSolver:
        return UzawaSolver(tol=tol, maxiter=limit, **arguments)

    return {"Uzawa": Uzawa(), "Uzawa, Anderson": Uzawa(acceleration="anderson"), "implicit": Uzawa(normal="implicit"),
            "implicit, adaptive": Uzawa(normal="implicit", rho="adaptive"),
            "implicit, Anderson": Uzawa(normal="implicit", acceleration="anderson"),
            "Newton": SemismoothNewtonSolver(tol=tol), "nested Newton": NestedNewtonSolver(tol=tol)}


@ByKeyword
@dataclass(frozen=True, kw_only=True)
class Point:
    """A discrete problem of the atlas.

    problem : "4.1" or "4.2", the paper's examples; "block", the unit square, pressed and sheared onto a rounded foundation so
        that its bottom sticks in the middle, slips beside it and is free at the ends; "box", the same in 3D
    stiffness : k_n/E [1/length] of p_n = k_n r, with Coulomb's friction; None: foundation and friction of the paper's example
    coefficient : of Coulomb's friction, no unit
    method : a label of `variants.Variants`;  order : k;  n : cells per side

    >>> Point(problem="box", n=2).Discretization().space.ndof
    576
    """

    problem: str = "block"
    stiffness: float | None = 0.1
    coefficient: float = 0.3
    method: str = "IP edge"
    order: int = 1
    n: int = 16

    def __post_init__(self) -> None:
        if self.problem not in YOUNG:
            raise ProblemError(f"problem is {self.problem!r}; choose one of {', '.join(YOUNG)}")
        if self.stiffness is None and self.problem not in EXAMPLES:
            raise ProblemError(f"stiffness is None, but problem {self.problem!r} has no foundation of its own; give k_n/E")

    @property
    def contactproblem(self) -> ContactProblem:
        if self.stiffness is None:
            return EXAMPLES[self.problem].Problem()
        law = NormalCompliance(self.stiffness * YOUNG[self.problem])
        friction = CoulombFriction(self.coefficient)
        if self.problem in EXAMPLES:
            problem = EXAMPLES[self.problem].Problem()
            return replace(problem, foundation=replace(problem.foundation[0], compliance=law, friction=friction))
        gap: Any = (x - 0.5) ** 2 / 10
        shift: tuple[float, ...] = (0.002, -0.02)
        if self.problem == "box":
            gap, shift = gap + (y - 0.5) ** 2 / 10, (0.002, 0.001, -0.02)
        return ContactProblem(HookeMaterial(E=YOUNG[self.problem], nu=0.3),
                              Foundation("bottom", law, friction=friction, gap=gap), dirichlet={"top": CF(shift)})

    def Mesh(self) -> Any:
        """The mesh of n cells per side."""
        mesh: Any = {"block": RectangleMesh, "box": BoxMesh}.get(self.problem) or EXAMPLES[self.problem].Mesh
        return mesh(self.n)

    def Discretization(self) -> Any:
        """A new one, with its matrix but without a factorisation."""
        disc = Discretization(self.contactproblem, Variants()[self.method], self.Mesh(), order=self.order)
        disc.matrix     # noqa: B018  made here: every solver needs it, and none is charged for it
        return disc


VARIABLES = {"problem": "problem", "stiffness": "stiffness k_n/E", "coefficient": "friction coefficient",
             "n": "cells per side n = 1/h", "order": "order k", "method": "method"}


@ByKeyword
@dataclass(frozen=True)
class Sweep:
    """Points that differ in one attribute, `variable`, one of VARIABLES; `what` they have in common, as a title."""

    what: str
    variable: str
    points: tuple[Point, ...]

    @property
    def title(self) -> str:
        return f"{self.what}: {VARIABLES[self.variable]}"


def _Vary(what: str, variable: str, values: Iterable[Any], **base: Any) -> Sweep:
    return Sweep(what, variable, tuple(Point(**{**base, variable: value}) for value in values))


@ByKeyword
def Sweeps() -> dict[str, Sweep]:
    """{name: Sweep} of the whole atlas."""
    stiffness = (1e-3, 1e-2, 0.1, 1, 10, 100, 1e3, 1e5, 1e7, 1e9)
    sweeps = {"own": _Vary("The paper's examples", "problem", tuple(EXAMPLES), stiffness=None),
              "stiffness": _Vary("Block", "stiffness", stiffness)}
    for name in EXAMPLES:
        sweeps[f"stiffness {name}"] = _Vary(f"Geometry of Example {name}", "stiffness", stiffness, problem=name)
    for suffix, base in (("", {}), (" stiff", {"stiffness": STIFF})):
        foundation = f"k_n = {base.get('stiffness', Point.stiffness):g} E"
        block = f"Block, {foundation}"
        sweeps |= {
            f"coefficient{suffix}": _Vary(block, "coefficient", (0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0), **base),
            f"size{suffix}": _Vary(block, "n", (8, 16, 32, 64, 128, 256), **base),
            f"order{suffix}": _Vary(f"{block}, n = 8", "order", (1, 2, 3, 4), n=8, **base),
            f"method{suffix}": _Vary(block, "method", tuple(Variants()), **base),
            f"box{suffix}": _Vary(f"Box of tetrahedra, {foundation}", "n", (2, 3, 4), problem="box", **base)}
    return sweeps


@ByKeyword
def QuickSweeps() -> dict[str, Sweep]:
    """{name: Sweep} of a few tiny problems that show what the atlas does, not what it finds."""
    return {"own": _Vary("The paper's examples", "problem", tuple(EXAMPLES), stiffness=None, n=2),
            "stiffness": _Vary("Block", "stiffness", (0.1, STIFF), n=2),
            "coefficient": _Vary("Block", "coefficient", (0.3, 0.5), n=2), "size": _Vary("Block", "n", (2, 4)),
            "order": _Vary("Block", "order", (1, 2), n=2), "method": _Vary("Block", "method", ("IP edge", "H1"), n=2),
            "box": _Vary("Box of tetrahedra", "n", (1,), problem="box")}


@ByKeyword
@dataclass(frozen=True, kw_only=True)
class Row:
    """What one solver took for one point.

    iterations : on the finest mesh;  solves : applications of an inverse there, those that estimate a step included
    coarser : applications on coarser meshes of a nested iteration, whose matrices are smaller
    seconds : of the solver in all, factorisations and coarser meshes included, the matrix of the finest mesh excluded
    factorisation : seconds of it that factorised on the finest mesh
    difference : of displacement and projected traction from the first solution of the point, the larger one relative to the
        largest values, no unit; None for the first one and where there is none
    reason : why there is no solution, "" if there is one;  message : the solver's own words
    """

    point: Point
    solver: str
    sweep: str = ""
    dofs: int = 0
    iterations: int = 0
    solves: int = 0
    coarser: int = 0
    seconds: float = 0.0
    factorisation: float = 0.0
    difference: float | None = None
    reason: str = ""
    message: str = ""

    @property
    def converged(self) -> bool:
        return not self.reason

    def Flat(self) -> dict[str, Any]:
        """{name: value} of point and row, for a table."""
        values = asdict(self)
        return {"sweep": values.pop("sweep"), **values.pop("point"), **values}


@ByKeyword
def Run(point: Point, label: str, solver: Any, references: list[Any]) -> Row:
    """The Row of one solver for one point, on a Discretization of its own so that it pays for its factorisations itself.

    references : list of (displacement, projected traction), (n, d) each, to which the first solution of the point is added
    """
    disc = point.Discretization()
    start = time.perf_counter()
    try:
        solution, message = solver.Solve(disc), ""
    except NotConvergedError as error:
        solution, message = error.solution, str(error)
    seconds = time.perf_counter() - start
    row = Row(point=point, solver=label, dofs=disc.space.ndof, iterations=len(solution.history), solves=disc.solves,
              coarser=sum(level.solves for level in solution.levels[:-1]), seconds=seconds, factorisation=disc.factorisation,
              reason=Cause(message), message=message)
    if message:
        return row
    found = solution.displacement, disc.contact.TraceProjection(solution.traction)
    if not references:
        references.append(found)
        return row
    return replace(row, difference=max(float(np.abs(a - b).max() / np.abs(b).max()) for a, b in zip(found, references[0])))


@ByKeyword
def Cause(message: str) -> str:
    """What a NotConvergedError says before numbers and remedies.

    >>> Cause("Uzawa cannot converge for any rho: the contraction number |p_n' S_nn| is 5")
    'Uzawa cannot converge for any rho'
    """
    return re.split(r"[:(]| and |, and ", message)[0].strip()


TOOSLOW = "not run, the coarser mesh took too many iterations"
TOOLARGE = "not run on this mesh"
FINEST = {"nested Newton": 256, "Newton": 128}     # cells per side for which a solver is quick enough; others 64


@ByKeyword
def Study(sweeps: Mapping[str, Sweep], *, limit: int = LIMIT, callback: Callable[[str], object] | None = None) -> Iterator[Row]:
    """Yield the Rows of every point of the sweeps, a dictionary such as `Sweeps()`, and all `Solvers`, as they come.

    limit : of iterations
    callback : called with a line of progress before each point
    """
    solvers = Solvers(limit=limit)
    known: dict[Any, Row] = {}
    references: dict[Point, list[Any]] = {}
    for name, sweep in sweeps.items():
        slow = set()
        for point in sweep.points:
            if callback:
                callback(f"{sweep.title}: {getattr(point, sweep.variable)}")
            # The last solver, the most reliable one, gives the reference of the others.
            for label, solver in reversed(solvers.items()):
                if sweep.variable == "n" and (label in slow or point.n > FINEST.get(label, 64)):
                    yield Row(sweep=name, point=point, solver=label, reason=TOOSLOW if label in slow else TOOLARGE)
                    continue
                if (point, label) not in known:
                    known[point, label] = Run(point, label, solver, references.setdefault(point, []))
                row = replace(known[point, label], sweep=name)
                if not row.converged and row.iterations == getattr(solver, "maxiter", None):
                    slow.add(label)
                yield row
