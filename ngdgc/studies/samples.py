"""Random contact problems, drawn from a seed: 2D and 3D, all methods, laws and loads, soft and stiff foundations."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from netgen.geom2d import unit_square
from netgen.occ import Axes, Box, OCCGeometry, Rectangle, WorkPlane, X, Y, Z
from ngsolve import CF, Mesh, cos, x, y, z

from ..discretization import Discretization
from ..exceptions import ProblemError
from ..meshes import BOXCELLS, CELLS, UnitMesh
from ..methods.conforming import Conforming
from ..methods.registry import Options
from ..methods.rows import LDG, BassiEtAl, BrezziEtAl, InteriorPenalty
from ..problem.foundation import Foundation
from ..problem.laws import CoulombFriction, NormalCompliance, PowerFriction, SlipWeakeningFriction, TrescaFriction
from ..problem.materials import HookeMaterial
from ..problem.problem import ContactProblem

ROWS = InteriorPenalty, BassiEtAl, BrezziEtAl, LDG, Conforming
FRICTIONS = "coulomb", "coulomb", "coulomb", "tresca", "power", "weakening"
LOADS = "top", "top", "side", "pressure", "pressure"
USUAL = 10_000      # unknowns of most problems, so that many are solved in a minute
SOLID = 4_000       # unknowns in 3D, where factors fill up
# Discontinuous unknowns of order k in one of the n^d squares or cubes that make a mesh.
UNKNOWNS = {"triangle": lambda k: 2 * (k + 1) * (k + 2), "quad": lambda k: 2 * (k + 1) ** 2,
            "tet": lambda k: 3 * (k + 1) * (k + 2) * (k + 3), "hex": lambda k: 3 * (k + 1) ** 3,
            "prism": lambda k: 3 * (k + 1) ** 2 * (k + 2)}


@dataclass(frozen=True)
class Sample:
    """A problem with what is needed to solve it, and the `words` that describe it.

    mesh : function without arguments that makes the mesh of size 1/n;  order : of the method
    stiffness : k_n/E [1/length];  coefficient : of friction [1];  kind : of the friction law, such as "coulomb"
    """

    problem: Any
    method: Any
    mesh: Any
    n: int
    order: int
    kind: str
    stiffness: float
    coefficient: float
    words: str

    def Disc(self) -> Discretization:
        """The Discretization."""
        return Discretization(self.problem, self.method, self.mesh(), order=self.order)


def BodyMesh(n: int, cells: str, order: int = 1) -> Mesh:
    """Mesh of the unit square or cube of size 1/n, the boundaries named as by `UnitMesh`.

    cells : one of CELLS or BOXCELLS; without structure "unstructured", triangles, and "delaunay", tetrahedra; from CAD "cad",
        triangles of a square with a round hole, curved by the order

    >>> sorted(BodyMesh(4, "cad").GetBoundaries())
    ['bottom', 'hole', 'left', 'right', 'top']
    """
    if cells == "unstructured":
        return Mesh(unit_square.GenerateMesh(maxh=1 / n))
    if cells == "cad":
        square = Rectangle(1, 1).Face()
        for name, edge in (("bottom", square.edges.Min(Y)), ("right", square.edges.Max(X)), ("top", square.edges.Max(Y)),
                           ("left", square.edges.Min(X))):
            edge.name = name
        disc = WorkPlane(Axes((0.5, 0.6, 0), Z)).Circle(0.2).Face()
        disc.edges.name = "hole"
        return Mesh(OCCGeometry(square - disc, dim=2).GenerateMesh(maxh=1 / n)).Curve(order)
    if cells == "delaunay":
        box = Box((0, 0, 0), (1, 1, 1))
        for name, face in (("back", box.faces.Min(X)), ("front", box.faces.Max(X)), ("left", box.faces.Min(Y)),
                           ("right", box.faces.Max(Y)), ("bottom", box.faces.Min(Z)), ("top", box.faces.Max(Z))):
            face.name = name
        return Mesh(OCCGeometry(box).GenerateMesh(maxh=1 / n))
    return UnitMesh(n, cells)


def Draw(seed: int, number: int, *, dofs: float = 150_000) -> Sample:
    """The `Sample` of this number in the sequence of a seed.

    Log-uniform: the friction coefficient over 0.05 to 1, k_n/E over 1e-3 to 1e9, and h over 1/8 to 1/256 in 2D, in 3D over 1/2
    to 1/16, as far as the mesh has not more than about `dofs` unknowns, in 19 of 20 problems not more than USUAL, in 3D not
    more than SOLID; uniform: order 1 to 4, Poisson's number 0 to 0.49.
    Loads are measured by what the foundation can bear, and the shear by what friction can, so that stick and slip meet.

    Raises ProblemError if `dofs` leaves no mesh.
    """
    rng = np.random.default_rng([seed, number])
    dim = 2 if rng.random() < 0.75 else 3
    row: Any = ROWS[rng.integers(len(ROWS))]
    method = row(form=str(rng.choice(["edge", "lifting"]))) if "form" in Options(row) else row()
    cells = str(rng.choice([*CELLS, "unstructured", "cad"] if dim == 2 else [*BOXCELLS, "delaunay"]))
    order, n = _Size(rng, dim, method, cells, dofs)
    nu, coefficient, stiffness = rng.uniform(0, 0.49), LogUniform(rng, 0.05, 1), LogUniform(rng, 1e-3, 1e9)
    depth, exponent = LogUniform(rng, 0.002, 0.02), float(rng.choice([1, 1, 1, 0.7, 1.5, 2]))
    pressure = min(stiffness, 1) * depth        # what is typical of this depth [E]
    kind = str(rng.choice(FRICTIONS))
    friction = _Friction(rng, kind, coefficient, pressure, stiffness, exponent, depth)
    gap, relief = _Gap(rng, dim, depth)
    law = NormalCompliance(stiffness * depth ** (1 - exponent), exponent)
    load, share = str(rng.choice(LOADS)), float(rng.choice([-1, 1])) * LogUniform(rng, 0.1, 3)
    shear = share * coefficient * pressure
    problem = ContactProblem(HookeMaterial(E=1, nu=nu), Foundation("bottom", law, friction=friction, gap=gap),
                             **_Load(rng, dim, load, shear, depth, pressure))
    words = (f"{dim}D {method!r} k={order} {cells} n={n} nu={nu:.2f} k_n={stiffness:.1e} m={exponent:g} {kind} "
             f"{coefficient:.2f} {load} depth {depth:.4f} shear {share:.2f} relief {relief:g}")
    return Sample(problem, method, partial(BodyMesh, n, cells, order), n, order, kind, stiffness, coefficient, words)


def LogUniform(rng: Any, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _Size(rng: Any, dim: int, method: Any, cells: str, dofs: float) -> tuple[int, int]:
    """(order, n): a mesh of at most about `dofs` unknowns."""
    order, wish = int(rng.integers(1, 5)), rng.uniform()
    known = {"triangle-flipped": "triangle", "unstructured": "triangle", "cad": "triangle", "delaunay": "tet"}
    smallest, largest = (8, 256) if dim == 2 else (2, 16)
    limit = min(dofs, rng.choice([np.inf] + 19 * [USUAL]), np.inf if dim == 2 else SOLID)
    while order > 0:
        percell = UNKNOWNS[known.get(cells, cells)](order) if method.discontinuous else dim * order ** dim
        most = min(largest, int((limit / percell) ** (1 / dim)))
        if most >= smallest:
            return order, round(np.exp(np.log(smallest) + wish * np.log(most / smallest)))
        order -= 1
    raise ProblemError(f"dofs is {dofs}; that is too few for a mesh with {smallest} cells per side, give more")


def _Friction(rng: Any, kind: str, coefficient: float, pressure: float, stiffness: float, exponent: float, depth: float) -> Any:
    steep = exponent + float(rng.choice([0, 0.5]))
    weaker, slip = rng.uniform(0.5, 1), pressure * LogUniform(rng, 0.1, 10)
    if kind == "coulomb":
        return CoulombFriction(coefficient)
    if kind == "tresca":
        return TrescaFriction(coefficient * pressure)
    if kind == "weakening":
        return SlipWeakeningFriction(coefficient, coefficient * weaker, slip)
    penetration = depth * min(1, 1 / stiffness) ** (1 / exponent)       # at the typical pressure
    return PowerFriction(coefficient * pressure / penetration ** steep, steep)


def _Gap(rng: Any, dim: int, depth: float) -> tuple[Any, float]:
    """A wavy or sloping foundation and its relief in units of the depth."""
    relief = float(rng.choice([0.0, *3 * [0.5], *5 * [1.0], 2.0]))
    waves, phase = rng.uniform(0.5, 3), rng.uniform(0, 2 * np.pi)
    gap = relief * depth * 0.5 * (1 + cos(waves * np.pi * x + phase))
    if dim == 3:
        gap = gap + relief * depth * 0.25 * (1 + cos(np.pi * y + rng.uniform(0, 2 * np.pi)))
    return gap, relief


def _Load(rng: Any, dim: int, load: str, shear: float, depth: float, pressure: float) -> dict[str, Any]:
    """Supports and loads: a top that is moved, a side that is pulled, or a body that only rollers and the foundation hold."""
    side, other = ("left", "right") if dim == 2 else ("back", "front")
    askew = rng.uniform(-1, 1)
    if load == "top":
        tilt = rng.uniform(-1, 1) * (x - 0.5)
        sunk = -depth * (1 + tilt)
        return {"dirichlet": {"top": CF((shear, sunk) if dim == 2 else (shear, askew * shear, sunk))}}
    if load == "side":
        force = (shear, -pressure) if dim == 2 else (shear, askew * shear, -pressure)
        return {"dirichlet": {other: CF((0,) * dim)}, "traction": {side: CF(force)}}
    height, push = y if dim == 2 else z, -pressure * (1 + rng.uniform(-1, 1) * (x - 0.5))
    top = (shear, push) if dim == 2 else (shear, 0, push)
    pull = (shear * (1 - height),) + (0,) * (dim - 1)
    return {"roller": {"right" if dim == 2 else "front|right": 0}, "traction": {"top": CF(top), side: CF(pull)}}
