"""What acts on a body, as tractions on its boundary and as coefficients of functionals on V_h."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from ngsolve import CF, CoefficientFunction, FESpace, GridFunction, ds, dx

from ..contracts import Array
from ..data.coefficients import LOADBONUS, ForFacets, Unfolded
from ..data.inside import OnBoundary
from ..exceptions import ProblemError
from ..linear.motions import ProjectedMotions
from ..methods.symbolform import Coefficients
from ..problem.problem import ContactProblem
from .checks import CheckPart


def GivenTractions(problem: ContactProblem, space: FESpace,
                   areas: Mapping[str, float] | None = None) -> dict[tuple[str, str], CoefficientFunction]:
    """{(kind, region): vector} on Gamma_F [stress]: tractions as they are given, forces over their areas.

    areas : of the regions of forces; None: as they are on the mesh of the space
    """
    found = {("traction", region): value for region, value in problem.traction.items()}
    return found | {("force", region): value / (areas[region] if areas else AreaOf(problem, region, space))
                    for region, value in problem.force.items()}


def AreaOf(problem: ContactProblem, region: str, space: FESpace) -> float:
    """Of a region, as loads of the space are integrated: a force over it has its total to round-off."""
    v, dim = space.TestFunction(), space.mesh.dim
    return float(ProjectedMotions(space, np.zeros(dim))[0] @ Coefficients(
        problem.frame.Integral(CF((1,) * dim) * v, _Measure(region, space))))


def _Measure(region: str, space: FESpace) -> Any:
    return ds(skeleton=True, definedon=space.mesh.Boundaries(region), bonus_intorder=LOADBONUS)


def Loads(disc: Any) -> dict[tuple[str, str | None], Array]:
    """Coefficients {(kind, region): (ndof,)} of the loads of a DiscreteProblem; ProblemError if one is not finite."""
    v, problem, space = disc.space.TestFunction(), disc.problem, disc.space
    Integral = problem.frame.Integral
    loads: dict[tuple[str, str | None], Array] = {}
    if problem.bodyforce is not None:
        loads["bodyforce", None] = Coefficients(Integral(Unfolded(problem.bodyforce) * v, dx(bonus_intorder=LOADBONUS)))
    for (kind, region), value in disc.tractions.items():
        loads[kind, region] = Coefficients(Integral(ForFacets(value, kind, region, disc.mesh) * v, _Measure(region, space)))
    if disc.added.load is not None:
        loads["added", None] = disc.added.load
    for region, load in disc.form.Prescribed().items():
        CheckPart(disc, load, f"Prescribed()[{region!r}]", 1)
        loads["prescribed", region] = load
    for (kind, named), load in loads.items():
        if not np.all(np.isfinite(load)):
            name = f"{kind}[{named!r}]" if named else kind
            raise ProblemError(f"{name} is not finite at some quadrature point; look for a division by zero or a root of a "
                               "negative number")
    return loads


def StrongValues(disc: Any) -> Array:
    """Coefficients (ndof,) of a function with the strongly prescribed boundary values, zero for DG."""
    function, mesh, dirichlet = GridFunction(disc.space), disc.mesh, disc.problem.dirichlet
    if not disc.method.weak and dirichlet:
        values = {region: OnBoundary(value, mesh.Boundaries(region), f"dirichlet[{region!r}]")
                  for region, value in dirichlet.items()}
        function.Set(mesh.BoundaryCF(values, default=(0,) * mesh.dim), definedon=mesh.Boundaries("|".join(dirichlet)))
    return function.vec.FV().NumPy().copy()
