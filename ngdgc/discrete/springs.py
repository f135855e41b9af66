"""Springs along the boundary, sigma n = -k u: a support that gives way."""

from __future__ import annotations

from typing import Any

from ngsolve import BilinearForm, FESpace, ds

from ..data.coefficients import LOADBONUS, SpringPull
from ..mesh.facets import Csr, Threads
from ..problem.problem import ContactProblem


def SpringMatrices(problem: ContactProblem, space: FESpace) -> dict[str, Any]:
    """{region: scipy CSR (ndof, ndof)} of int k_i u_i v_i over the regions with springs, on a vector space."""
    found, (u, v) = {}, space.TnT()
    with Threads(space.mesh):
        for region in problem.spring:
            measure = ds(skeleton=True, definedon=space.mesh.Boundaries(region), bonus_intorder=LOADBONUS)
            form = BilinearForm(problem.frame.Integral(SpringPull(problem, region, u, space.mesh) * v, measure))
            found[region] = Csr(form.Assemble().mat).copy()
    return found
