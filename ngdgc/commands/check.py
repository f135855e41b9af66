"""The command `ngdgc check`: what a case is, whether it can be solved, how long that takes; before it is solved."""

from __future__ import annotations

from argparse import Namespace
from functools import partial
from typing import Any

import numpy as np
from ngsolve import Integrate

from ..contracts import Array
from ..exceptions import ProblemError
from ..linear.choice import Best
from ..methods.registry import METHODS, MethodWords
from ..tools.formula import Formula
from ..tools.memory import GIGABYTE, FreeMemory
from ..tools.names import Known
from ..tools.tables import Aligned
from ..tools.units import InUnits
from .arguments import Commands, Positive
from .casefiles import LoadCase
from .files import Files

# Of docs/performance.md, from the mesh to the solution: a factor of two is usual, nearly incompressible bodies take longer.
START, SECONDS = 0.5, {2: 1e-5, 3: 1e-4}            # [s], and for an unknown, times order + 1 in 2D and order in 3D
IDLE, BYTES = 0.15e9, {2: 1e3, 3: 4e3}              # of the process, and for an unknown in the same way
VARIANCE = 3                                        # what is said may be wrong by this


class Looker:
    """A solver that solves nothing and ends the case by an error; what it was given is its attribute disc."""

    disc: Any = None

    def Solve(self, disc: Any, *, callback: Any = None) -> Any:
        self.disc = disc
        raise ProblemError("the case is looked at and not solved here; take ngdgc run")


def AddCheck(commands: Commands) -> None:
    """The parser of the command, added to those of the command line."""
    check = commands.add_parser("check", help="check a case, say its size, time and memory, draw its setting",
                                description="Make mesh and equations of a case as `ngdgc run` does, with all checks, and say "
                                "what acts where, how many unknowns there are, and about how long it takes; draw the setting; "
                                "nothing is solved.")
    check.add_argument("case", help="a file, or the name of a case that comes with the package")
    check.add_argument("--method", default="ip", help=f"{MethodWords()}; default ip")
    check.add_argument("--order", type=Positive, help="polynomial degree of the displacement (default: the case's own)")
    check.add_argument("--n", type=Positive, help="cells per side (default: the case's own)")
    check.add_argument("--out", default="results", help="folder for setting.png (default results/)")
    check.set_defaults(command=Check)


def Check(options: Namespace) -> int:
    """Print what the case is and draw its setting."""
    from ..plots import SettingFigure
    from .meshfile import MeshWords
    from .output import DrawInto

    case = LoadCase(options.case)
    row = METHODS[Known(options.method, METHODS, what="method")]
    given = {name: getattr(options, name) for name in ("order", "n") if getattr(options, name) is not None}
    looker = Looker()
    try:
        case.Main(method=row(), solver=looker, **given)
    except TypeError as error:
        raise ProblemError(f"Main of {options.case} cannot be called: {error}; it needs the keywords method, order, n, solver "
                           "and callback") from error
    except ProblemError:
        if looker.disc is None:
            raise
    if looker.disc is None:
        raise ProblemError(f"{options.case} was solved without the solver that its Main was given; call solver.Solve(disc, "
                           "callback=callback) there")
    disc = looker.disc
    disc.restraints.Check()
    print(f"{options.case}: {disc.method!r}, order {disc.order}\n\n{MeshWords(disc.mesh)}\n")
    print("\n".join(_Setting(disc)), flush=True)
    print(Expected(disc.space.ndof, disc.mesh.dim, disc.order, Best(disc)))
    with Files(options.out, "setting.png") as files:
        files.Write("setting.png", partial(DrawInto, partial(SettingFigure, disc)))
    return 0


def _Setting(disc: Any) -> list[str]:
    """What acts where, and what holds the body."""
    problem = disc.problem
    rows = [(kind, region, Formula(value)) for kind in ("dirichlet", "roller", "traction", "force", "spring")
            for region, value in getattr(problem, kind).items()]
    rows += [("foundation", foundation.boundary, repr(foundation)) for foundation in problem.foundation]
    if problem.bodyforce is not None:
        rows.append(("bodyforce", "", Formula(problem.bodyforce)))
    lines = ["material " + repr(problem.material)]
    named = {name for _, region in problem.Regions()
             for name, found in zip(disc.mesh.GetBoundaries(), disc.mesh.Boundaries(region).Mask()) if found}
    numbers, regions, _ = disc.facets.boundary
    outer = set(np.array(disc.mesh.GetBoundaries())[np.unique(regions[disc.facets.neighbours[numbers] == 1])])
    free = [name for name in dict.fromkeys(disc.mesh.GetBoundaries()) if name in outer - named]
    if free:
        rows.append(("free", ", ".join(free), ""))
    dim = disc.mesh.dim
    total = InUnits(f"[stress length{'^2' if dim == 3 else ''}]", problem.units)
    lines += Aligned([(kind, region, " ".join(value.split())) for kind, region, value in rows])
    lines.append(f"loads    ({', '.join(f'{value:.6g}' for value in _Loads(disc))}) {total} in all")
    lines.append(f"held     {'by supports' if disc.unresisted is None else 'by contact alone against ' + disc.unresisted}")
    return lines


def _Loads(disc: Any) -> Array:
    """The sum of tractions, forces and body force, (d,)."""
    mesh = disc.mesh
    Weighted = disc.problem.frame.Weighted
    parts = [Integrate(Weighted(value), mesh, definedon=mesh.Boundaries(region))
             for (_, region), value in disc.tractions.items()]
    if disc.problem.bodyforce is not None:
        parts.append(Integrate(Weighted(disc.problem.bodyforce), mesh))
    return np.sum([np.zeros(mesh.dim), *map(np.array, parts)], axis=0)


def Expected(unknowns: int, dim: int, order: int, inverse: str) -> str:
    """Words for size, time and memory of a solution."""
    seconds, memory = Cost(unknowns, dim, order)
    free = FreeMemory()
    words = (f"solving  {unknowns} unknowns by {inverse}: about {_Time(seconds)} and {memory / GIGABYTE:.2g} GB, within a "
             f"factor of {VARIANCE}; {free / GIGABYTE:.2g} GB are free")
    return words + ("; take a coarser mesh or a lower order" if memory > free else "")


def Cost(unknowns: int, dim: int, order: int) -> tuple[float, float]:
    """Seconds and bytes that a solution takes, about."""
    weight = unknowns * (order + 1 if dim == 2 else order)
    return START + SECONDS[dim] * weight, IDLE + BYTES[dim] * weight


def _Time(seconds: float) -> str:
    return f"{seconds:.2g} s" if seconds < 100 else f"{seconds / 60:.2g} min" if seconds < 6000 else f"{seconds / 3600:.2g} h"
