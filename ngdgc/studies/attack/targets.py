"""Public names, and valid arguments for every parameter that they have: what an attack spoils."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Callable
from functools import cached_property, partial
from pathlib import Path
from signal import SIGINT, raise_signal
from typing import Any

import numpy as np
from netgen.occ import Box, Rectangle
from ngsolve import CF, BilinearForm, GridFunction, LinearForm, Parameter, dx, x

from ... import exact
from ...contracts import Array
from ...discretization import Discretization
from ...histories.history import LoadHistory
from ...histories.solve import SolveHistory
from ...linear.conjugategradients import IterativeInverse
from ...meshes import BOXCELLS, CELLS, UnitMesh
from ...methods.registry import METHODS, Options
from ...methods.rows import LDG, InteriorPenalty
from ...problem.foundation import Foundation
from ...problem.laws import (ArchardWear, ComplianceLaw, CoulombFriction, FrictionLaw, NormalCompliance, PowerFriction,
                             SlipWeakeningFriction, TrescaFriction)
from ...problem.materials import HookeMaterial, Strain
from ...problem.problem import ContactProblem
from ...problem.punch import RigidPunch
from ...solution.solution import ContactSolution
from .results import RESULTS

MODULES = ("ngdgc", "ngdgc.meshes", "ngdgc.exact", "ngdgc.traces", "ngdgc.errors", "ngdgc.plots", "ngdgc.export",
           "ngdgc.methods.variants", "ngdgc.theory.lemmas", "ngdgc.theory.consistency")
# They take what the studies return.
STUDIES = "AtlasFigure", "GrowthFigure", "ConvergenceFigure", "AccuracyFigure", "LockingFigure", "SweepFigure", "LiftingBounds"
# What solvers and discretisations call of each other, with arguments of their own making.
CONTRACTS = ("Space", "ScalarSpace", "Form", "MakeInverse", "Factorise", "ApplyInverse", "Iterate", "CheckData", "Current",
             "Product")


def Public() -> dict[str, tuple[Any, str]]:
    """{name: (class or function, name of its method or property, or "")} of all that users may call."""
    found: dict[str, tuple[Any, str]] = {}
    for module in map(importlib.import_module, MODULES):
        names = getattr(module, "__all__", None) or [name for name, value in vars(module).items() if callable(value)
                                                     and getattr(value, "__module__", "").startswith(module.__name__)]
        for name in names:
            thing = getattr(module, name)
            if name.startswith("_") or name in STUDIES:
                continue
            found[name] = thing, ""
            for member in dir(thing) if inspect.isclass(thing) and thing.__module__.startswith("ngdgc") else ():
                of = getattr(thing, member)
                where = next(base for base in thing.__mro__ if member in vars(base)).__module__
                if not member.startswith("_") and where.startswith("ngdgc") and (callable(of) or isinstance(
                        of, (property, cached_property))):
                    found[f"{name}.{member}"] = thing, member
    return found


class Setting:
    """Valid things that belong together, drawn from random numbers: a small body, its problem, a solution of it."""

    def __init__(self, rng: np.random.Generator, folder: Path) -> None:
        self.rng, self.folder = rng, folder
        self.cells = str(rng.choice([*CELLS, *CELLS, *BOXCELLS]))
        self.dim, self.order = 2 if self.cells in CELLS else 3, int(rng.integers(1, 4 if self.cells in CELLS else 3))

    def Choose(self, *values: Any) -> Any:
        return values[self.rng.integers(len(values))]

    def Number(self, low: float, high: float) -> Any:
        """A number between two, equally likely in every decade, of any type."""
        value = float(np.exp(self.rng.uniform(np.log(low), np.log(high))))
        return self.Choose(float, float, np.float64, np.float32, np.array)(value)

    def Vector(self, size: float) -> Any:
        value = tuple((size * self.rng.uniform(-1, 1, self.dim)).tolist())
        return self.Choose(value, CF(value), list(value), np.array(value))

    @cached_property
    def mesh(self) -> Any:
        return UnitMesh(int(self.rng.integers(1, 4 if self.dim == 2 else 2)), self.cells)

    @cached_property
    def material(self) -> Any:
        return HookeMaterial(E=self.Number(10, 1e5), nu=self.rng.uniform(0, 0.49), plane=self.Choose("strain", "stress")
                             if self.dim == 2 else "strain")

    @cached_property
    def compliance(self) -> Any:
        return NormalCompliance(self.Choose(self.Number(1, 1e7), 100 * (1 + x)), self.Choose(1, 1, 0.5, 1.5))

    @cached_property
    def friction(self) -> Any:
        return self.Choose(None, CoulombFriction(self.Number(0.05, 0.5)), TrescaFriction(self.Number(0.1, 10)), PowerFriction(
            self.Number(1, 100)), SlipWeakeningFriction(0.3, 0.2, 1.0))

    @cached_property
    def foundation(self) -> Foundation:
        return Foundation("bottom", self.compliance, friction=self.friction, gap=self.Choose(0, 0.01, 0.01 * x))

    @cached_property
    def problem(self) -> ContactProblem:
        top = (*(0.01 * self.rng.uniform(-1, 1, self.dim - 1)).tolist(), -0.05)
        return ContactProblem(self.material, self.foundation, dirichlet={"top": top})

    @cached_property
    def method(self) -> Any:
        row = self.Choose(*METHODS.values())
        return row(form=self.Choose("edge", "lifting")) if "form" in Options(row) else row()

    @cached_property
    def disc(self) -> Discretization:
        return self.Discretization()

    def Discretization(self, **changes: Any) -> Discretization:
        data = {"problem": self.problem, "method": self.method, "mesh": self.mesh, "order": self.order, **changes}
        return Discretization(data.pop("problem"), data.pop("method"), data.pop("mesh"), **data)

    @cached_property
    def solution(self) -> ContactSolution:
        return self.disc.Solve()

    @cached_property
    def parameter(self) -> Parameter:
        return Parameter(0.0)

    @cached_property
    def led(self) -> Any:
        """Of a problem whose data depend on the parameter."""
        top = CF((0.02 * self.parameter,) * (self.dim - 1) + (-0.05,))
        return self.Discretization(problem=ContactProblem(self.material, self.foundation, dirichlet={"top": top}))

    @cached_property
    def loadhistory(self) -> LoadHistory:
        return SolveHistory(self.led, parameter=self.parameter, times=[0.5, 1])

    @cached_property
    def exact(self) -> Any:
        return exact.AffinePatch("slip", dim=self.dim)

    def Form(self) -> Any:
        u, v = self.disc.space.TnT()
        return self.Choose(BilinearForm(u * v * dx), LinearForm(CF((1,) * self.dim) * v * dx))

    def Points(self, size: float) -> Array:
        return size * self.rng.uniform(-1, 1, len(self.disc.contact.weights))

    def Saved(self) -> Path:
        self.solution.Save(self.folder / "saved")
        return self.folder / "saved"

    def File(self) -> str:
        """A file with the mesh."""
        path = str(self.folder / "mesh.vol")
        self.mesh.ngmesh.Save(path)
        return path

    def Of(self, parameter: str, owner: str = "") -> Any:
        """A valid value of a parameter of a public name; LookupError for one that nobody has thought of."""
        for name in (f"{owner}.{parameter}", parameter):
            if name in VALID:
                return VALID[name](self)
        raise LookupError(f"no valid value of {parameter} of {owner} is known; add one to VALID")

    def Object(self, kind: Any) -> Any:
        """A valid object of a public class."""
        ready = {ContactProblem: "problem", Discretization: "disc", ContactSolution: "solution", Foundation: "foundation",
                 LoadHistory: "loadhistory"}
        if kind in ready:
            return getattr(self, ready[kind])
        if kind is ComplianceLaw or kind is FrictionLaw:
            return self.compliance if kind is ComplianceLaw else TrescaFriction(1)
        if kind is exact.Exact:
            return self.exact
        return kind(**{name: self.Of(name, kind.__name__) for name, one in inspect.signature(kind).parameters.items()
                       if one.default is one.empty or name in NEEDED.get(kind.__name__, ())})


NEEDED = {"HookeMaterial": ("E", "nu")}     # parameters with defaults that are given all the same
LEFT = {"HookeMaterial": ("mu", "lam")}     # those that are not
SIGNATURES = {"Solve": ("disc",), "ProblemError": ("message",)}     # NGSolve's own, and an exception, do not tell theirs


def Parameters(name: str, function: Any) -> list[inspect.Parameter]:
    """The parameters of a public function, or of a constructor, that may be given."""
    if name in SIGNATURES:
        return [inspect.Parameter(one, inspect.Parameter.POSITIONAL_OR_KEYWORD) for one in SIGNATURES[name]]
    return [one for one in inspect.signature(function).parameters.values()
            if one.kind is not one.VAR_KEYWORD and one.name not in LEFT.get(name, ())]


def Interrupt(step: Any) -> None:
    """A callback that does what Ctrl-C does."""
    raise_signal(SIGINT)


RANGES = {
    "E": (10, 1e5), "mu": (1, 1e4), "lam": (0.1, 1e4), "stiffness": (1, 1e6), "exponent": (0.5, 2), "coefficient": (0.01, 0.6),
    "bound": (0.01, 10), "static": (0.3, 0.5), "dynamic": (0.1, 0.3), "distance": (0.1, 10), "penalty": (20, 200),
    "tol": (1e-9, 1e-6), "rho": (0.1, 10), "depth": (0.01, 1), "slip": (0.01, 1), "maxh": (0.3, 1), "scale": (0.1, 10),
    "height": (0.5, 2), "opening": (0.01, 0.03), "alpha": (0.01, 0.1), "reserve": (5, 10), "pressure": (1, 10)}
# {parameter, or method.parameter: function of a Setting}
VALID: dict[str, Callable[[Setting], Any]] = {
    **{name: partial(Setting.Number, low=low, high=high) for name, (low, high) in RANGES.items()},
    # Materials, laws, problems.
    "nu": lambda s: s.rng.uniform(0, 0.49),
    "plane": lambda s: s.Choose("strain", "stress"),
    "voigt": lambda s: 100 * np.eye(3 if s.dim == 2 else 6),
    "boundary": lambda s: s.Choose("bottom", "bott.*"),
    "compliance": lambda s: s.compliance,
    "friction": lambda s: s.friction,
    "gap": lambda s: s.Choose(0, 0.01, 0.01 * x),
    "tension": lambda s: s.Choose(0, 1.0, 1 + x),
    "material": lambda s: s.material,
    "foundation": lambda s: s.Choose(s.foundation, [s.foundation]),
    "FromTraces.foundation": lambda s: Foundation("bottom", NormalCompliance(100)),
    "dirichlet": lambda s: {"top": s.Vector(0.05)},
    "roller": lambda s: {"right": 0}, "spring": lambda s: {"left": s.Choose(5, (5,) * s.dim)},
    "traction": lambda s: {"left": s.Vector(0.1)}, "force": lambda s: {"right": (0.1,) * s.dim},
    "bodyforce": lambda s: s.Vector(0.1),
    "axisymmetric": lambda s: False, "turned": lambda s: False,
    "units": lambda s: s.Choose(None, ("mm", "MPa")),
    "r": lambda s: s.Points(1),
    "p": lambda s: abs(s.Points(1)),
    "Depth.slip": lambda s: abs(s.Points(1)),
    "Coefficient.slip": lambda s: abs(s.Points(1)),
    "npoints": lambda s: 1, "name": lambda s: "the law's ",
    "strain": lambda s: s.solution.strain,
    "OtherStress.strain": lambda s: Strain(s.disc.space.TrialFunction()),
    "points": lambda s: s.disc.contact.inside,
    "_": lambda s: (),
    # Meshes, methods, discretisations.
    "n": lambda s: int(s.rng.integers(1, 4)),
    "cells": lambda s: s.cells,
    "file": Setting.File,
    "RectangleMesh.cells": lambda s: s.Choose(*CELLS),
    "BoxMesh.cells": lambda s: s.Choose(*BOXCELLS),
    "RectangleMesh.lower": lambda s: (0, -1),
    "RectangleMesh.upper": lambda s: (1, 2),
    "BoxMesh.lower": lambda s: (0, -1, 0),
    "BoxMesh.upper": lambda s: (1, 2, 3),
    "shape": lambda s: Rectangle(1, 2).Face() if s.dim == 2 else Box((0, 0, 0), (1, 2, 1)),
    "weighting": lambda s: s.Choose("mu", "C"),
    "form": lambda s: s.Choose("edge", "lifting"),
    "liftorder": lambda s: s.order,
    "singular": lambda s: False,
    "problem": lambda s: s.problem,
    "method": lambda s: s.method,
    "CriticalPenalty.method": lambda s: s.Choose(LDG, InteriorPenalty),
    "Variants.method": lambda s: s.Choose("all", *METHODS),
    "mesh": lambda s: s.mesh,
    "order": lambda s: s.order,
    "assembly": lambda s: s.Choose("facet", "skeleton"),
    "inverse": lambda s: s.Choose("auto", "umfpack", "iterative"),
    "ApplyInverse.inverse": lambda s: s.disc.inverse,
    "Iterate.inverse": lambda s: IterativeInverse(s.disc, s.disc.matrix),
    "Iterate.start": lambda s: 0 * s.disc.load, "one": lambda s: s.disc.load, "other": lambda s: s.solution.vector,
    "Add.form": Setting.Form,
    "clamped": lambda s: "top",
    "facets": lambda s: s.disc.facets,
    "space": lambda s: s.disc.space,
    "matrix": lambda s: s.disc.matrix,
    "FactoriseSum.added": lambda s: s.disc.contact.Stiffness(np.zeros(s.disc.contact.normals.shape + (s.dim,))),
    "load": lambda s: s.disc.load.copy(),
    "vector": lambda s: s.solution.vector.copy(),
    "Response.traction": lambda s: s.solution.traction.copy(),
    "facet": lambda s: 0,
    "gfu": lambda s: GridFunction(s.disc.space),
    "functional": lambda s: s.disc.load.copy(),
    # Solvers.
    "disc": lambda s: s.disc,
    "maxiter": lambda s: int(s.rng.integers(50, 2000)),
    "SolveAdaptive.tol": lambda s: s.rng.uniform(0.2, 0.5),
    "goal": lambda s: s.Choose("energy", "force", ("pressure", "bottom")),
    "most": lambda s: 3000,
    "goals": lambda s: (),
    "normal": lambda s: s.Choose("explicit", "implicit"),
    "wear": lambda s: s.Choose(None, None, ArchardWear(1e-5)),
    "punch": lambda s: s.Choose(None, RigidPunch(displacement=(*(None,) * (s.dim - 1), 0.01))),
    "RigidPunch.force": lambda s: (*(None,) * (s.dim - 1), s.rng.uniform(0.1, 1)),
    "moment": lambda s: None, "motion": lambda s: None,
    "rotation": lambda s: s.Choose(None, 0.01 if s.dim == 2 else (None, None, 0.01)),
    "RigidPunch.displacement": lambda s: (0.01, *(None,) * (s.dim - 1)), "about": lambda s: s.Choose(None, (0.5,) * s.dim),
    "Foundation.normal": lambda s: (0,) * (s.dim - 1) + (-1,),
    "acceleration": lambda s: s.Choose(None, "anderson"),
    "coarser": lambda s: s.Choose(None, (), [UnitMesh(1, s.cells)]),
    "callback": lambda s: s.Choose(repr, Interrupt) if s.rng.random() < 0.1 else None,
    "start": lambda s: s.Choose(None, (s.solution.displacement, s.solution.traction)),
    "WriteSeries.solutions": lambda s: s.Choose(s.loadhistory, [s.solution, s.solution]),
    "WriteSeries.times": lambda s: s.Choose(None, (0, 1)),
    "count": lambda s: int(s.rng.integers(1, 4)),
    "seed": lambda s: int(s.rng.integers(10)),
    "penetration": lambda s: s.Points(0.1),
    "step": lambda s: s.rng.uniform(0, 1),
    **RESULTS}
