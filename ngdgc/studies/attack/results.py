"""Valid arguments of what takes solutions, files and exact solutions, as functions of a Setting."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from ngsolve import CF, x

RESULTS: dict[str, Callable[[Any], Any]] = {
    # Solutions, files, pictures.
    "solution": lambda s: s.solution,
    "solutions": lambda s: {"one": s.solution},
    "Animation.solutions": lambda s: [s.solution, s.solution],
    "ContactSolution.traction": lambda s: s.solution.traction.copy(),
    "history": lambda s: [],
    "levels": lambda s: [],
    "converged": lambda s: True,
    "solver": lambda s: "none",
    "Predict": lambda s: None,
    "message": lambda s: "an iteration that failed",
    "contraction": lambda s: None,
    "region": lambda s: s.Choose("top", "bottom", ".*"),
    "Force.material": lambda s: s.Choose(None, ".*"),
    "point": lambda s: tuple(s.rng.uniform(0.1, 0.9, s.dim).tolist()),
    "folder": lambda s: s.folder / "out",
    "Load.folder": lambda s: s.Saved(),
    "added": lambda s: (),
    "path": lambda s: str(s.folder / "file.html"),
    "ContactFigure.slip": lambda s: s.Choose(True, False),
    "a": lambda s: (0.1,) * s.dim, "b": lambda s: (0.8,) + (0.9,) * (s.dim - 1),
    "field": lambda s: s.Choose("vonmises", "displacement", "uy"),
    "Largest.field": lambda s: "vonmises", "LineFigure.field": lambda s: s.Choose("vonmises", "ux"),
    "FieldFigure.field": lambda s: s.Choose("vonmises", "sxy", "uy"),
    "view": lambda s: None, "cut": lambda s: None, "limits": lambda s: s.Choose(None, (0, 1)),
    "LoadHistoryFigure.history": lambda s: s.loadhistory, "against": lambda s: None,
    "stress": lambda s: s.solution.stress,
    "estimate": lambda s: None,
    # Histories.
    "origin": lambda s: s.solution.displacement.copy(),
    "slid": lambda s: np.linalg.norm(s.solution.slip, axis=1),
    "worn": lambda s: abs(s.solution.penetration),
    "change": lambda s: s.Choose(None, 0.2),
    "parameter": lambda s: s.parameter,
    "times": lambda s: s.Choose([0.5, 1], np.array([0.3, 1, 2])),
    "SolveHistory.disc": lambda s: s.led,
    "SolveHistory.solver": lambda s: None,
    "SolveHistory.start": lambda s: None,
    "states": lambda s: None,
    "LoadHistory.states": lambda s: s.loadhistory.states,
    "recall": lambda s: None,
    # Exact solutions and errors.
    "dim": lambda s: s.dim,
    "u": lambda s: CF((x, 0, 0)[:s.dim]),
    "displacement": lambda s: CF((x,) * s.dim),
    "zone": lambda s: s.Choose("slip", "stick", "open"),
    "zones": lambda s: s.exact.zones,
    "sides": lambda s: s.Choose("dirichlet", "roller", "traction"),
    "coulomb": lambda s: s.Choose(None, 0.3),
    "un": lambda s: 0.1,
    "ut": lambda s: 0.0,
    "FromTraces.pressure": lambda s: 10.0,
    "shear": lambda s: 0.0,
    "ends": lambda s: (0.25, 0.75),
    "ThreeZones.un": lambda s: 0.02,
    "ThreeZones.ut": lambda s: 0.02,
    "power": lambda s: 2,
    "errors": lambda s: [4.0, 2.0, 1.0],
    "ratio": lambda s: 2}
