"""The numerical fluxes of Table 1 as functions on the facets, to be drawn and integrated."""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import GridFunction, LinearForm, ds

from ..blocks.operators import FacetOperators
from ..contracts import Array
from ..data.coefficients import LOADBONUS, ForFacets, SpringPull
from ..exceptions import ProblemError


def Flux(solution: Any) -> GridFunction:
    """sigma_hat n of a solution, a GridFunction with d components in F_h [stress].

    On E0 the flux of the method, on Gamma_F the traction f_2 and that of springs, -k u_h, on Gamma_C the traction -t of the
    foundation on the body, each as its L2 projection on F_h.  On the boundary n is outward, on a named boundary inside the body
    that of the side which `interfaces.Interfaces` tells, on other facets outward of the element with the smaller number.  With
    `facets.orientation`, which is 1 in the element whose normal it is and -1 in the other, the traction on element K is
    orientation * sigma_hat n; its integral over the boundary of K and that of the body force over K cancel, which is (3.10)
    tested with rigid motions.
    Forces of forms that were added are not in it.

    Raises ProblemError for the conforming method, which has no numerical flux.

    >>> from ngdgc import *
    >>> from ngdgc.exact import AffinePatch
    >>> from ngdgc.meshes import RectangleMesh
    >>> exact = AffinePatch("slip")
    >>> disc = Discretization(exact.problem, LDG(), RectangleMesh(2))
    >>> Flux(Solve(disc)).dim
    2
    """
    disc = solution.disc
    if not disc.method.conservative:
        raise ProblemError(f"method {disc.method.name} has no numerical flux; take a discontinuous one, or "
                           "solution.Traction(region), which every method has")
    form = disc.facetform
    function = form.FluxFunction(solution.gfu)
    values, operators = function.vec.FV().NumPy(), form.operators
    mu = operators.facetspace.TestFunction()
    given = [(region, ForFacets(value, kind, region, disc.mesh)) for (kind, region), value in disc.tractions.items()]
    given += [(region, -SpringPull(disc.problem, region, solution.gfu, disc.mesh)) for region in disc.problem.spring]
    for region, traction in given:
        measure = ds(skeleton=True, definedon=disc.mesh.Boundaries(region), bonus_intorder=LOADBONUS)
        moments = LinearForm(disc.problem.frame.Integral(traction * mu, measure)).Assemble().vec.FV().NumPy()
        for patch in operators.FacetPatches(disc.facets.On(region), weak=False):
            dofs = operators.FacetDofs(patch.facets)
            values[dofs] += operators.Apply(operators.inversemass(patch.sides[0]), moments[dofs][..., None])[..., 0]
    _AddContact(disc, operators, solution.traction, values)
    values *= np.tile(np.repeat(disc.facets.interfaces.sign, operators.facetsizes), disc.mesh.dim)
    return function


def _AddContact(disc: Any, operators: FacetOperators, traction: Array, values: Array) -> None:
    """Subtract the traction t (n, d) of the contact points, as coefficients in F_h, from the values on Gamma_C."""
    contact, dim = disc.contact, disc.mesh.dim
    facets = disc.facets.boundary[0][contact.boundaryelements]
    for part in contact.parts:
        here = part.points
        for patch in operators.FacetPatches(disc.facets.On(part.foundation.boundary), weak=False):
            side, dofs = patch.sides[0], operators.FacetDofs(patch.facets)
            traces, inverse = operators.tracevalues(side), operators.inversemass(side)
            for row, facet in enumerate(patch.facets):
                points = here.start + np.flatnonzero(facets[here] == facet)
                shapes = contact.trace[(points[:, None] * dim + np.arange(dim)).ravel()]
                # u at the points is the trace there: values of the facet functions, from those of the element; on a joint with
                # the sign that its first element has in the jump.
                local = operators.Dofs(patch.elements[row:row + 1, :1])[0]
                facetshapes = shapes[:, local].toarray() @ np.linalg.pinv(traces[row])
                load = facetshapes.T @ (contact.weights[points, None] * traction[points]).ravel()
                values[dofs[row]] -= operators.Apply(inverse[row:row + 1], load[None, :, None])[0, :, 0]
