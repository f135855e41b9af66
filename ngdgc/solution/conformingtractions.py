"""Tractions of the conforming method: stresses corrected by what its equations leave over.

The method has no numerical flux, and sigma(u_h) n is in balance with nothing.  But the residual

    R(v) = int C eps(u_h):eps(v) - (f_1, v) - (f_2, v)_GammaF + (t, v)_GammaC

vanishes for all v in V_h that are 0 on Gamma_D; a v that is not, or that jumps across an interface Gamma_I, tests the tractions
there.  On Gamma_D and Gamma_I they are lambda = {C eps(u_h)} n + w with the smallest w in F_h such that

    int_(GammaD + GammaI) lambda.[v] = R(v)      for all continuous v that are cut open along Gamma_I.

So every part of the body that interfaces and its boundary enclose is in balance to round-off, and so are the two sides of an
interface; where C eps(u_h) is exact w is 0.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
from ngsolve import VOL, BilinearForm, ElementId, GridFunction, ds, dx

from ..contact.boundary import TraceMatrix
from ..contact.sides import Faces
from ..contracts import Array
from ..data.coefficients import LOADBONUS, ForFacets, SpringPull, Unfolded
from ..discrete.springs import SpringMatrices
from ..mesh.facets import Free, Threads
from ..mesh.quadrature import BoundaryQuadrature, ContactRules
from ..methods.symbolform import Coefficients
from ..tools import sparse as sp
from .cuts import CutSpace
from .tractions import FacetFunctions, FacetTractions


def ConformingTractions(solution: Any) -> FacetTractions:
    """The `FacetTractions` of a solution of the conforming method, on all boundaries with a name.

    On Gamma_F it is the traction f_2 and on rollers, which are imposed weakly, the numerical flux, both projected on F_h; on
    Gamma_C it has the values -t at the contact points.
    """
    disc, facets = solution.disc, solution.disc.facets
    functions = FacetFunctions(facets, disc.order)
    sides = [BoundaryQuadrature.On(facets, ".*", 2 * disc.order + 4, side=side) for side in (0, 1)]
    shapes = functions.Matrix(sides[0])
    mass = shapes.T @ sp.diags(sides[0].weights) @ shapes
    held = _Held(solution, sides, shapes, mass)
    moments = _Given(solution, functions.space) + shapes.T @ held
    forces = np.zeros((len(facets.neighbours), disc.mesh.dim))
    forces[facets.boundary[0]] = moments[functions.dofs[:, 0]]       # the first function is 1
    used = np.flatnonzero(mass.diagonal())
    values = np.zeros_like(moments)
    values[used] = sp.linalg.splu(mass[used][:, used].tocsc()).solve(moments[used])
    _AddContact(solution, functions, values, forces)
    sign = np.ones(len(values))
    sign[functions.dofs[functions.dofs >= 0]] = np.repeat(facets.interfaces.sign[facets.boundary[0]],
                                                          (functions.dofs >= 0).sum(axis=1))
    function = GridFunction(functions.space)
    function.vec.FV().NumPy()[:] = (sign[:, None] * values).T.ravel()
    return FacetTractions(function, facets.interfaces.sign[:, None] * forces, (sides[0], held))


def _Given(solution: Any, space: Any) -> Array:
    """Moments (functions, d) of the tractions f_2 and of the numerical fluxes of rollers."""
    disc, mu = solution.disc, space.TestFunction()
    integrals = [part.Integral(part.Flux(solution.gfu) * mu) for part in disc.form.parts]
    given = [(region, ForFacets(value, kind, region, disc.mesh)) for (kind, region), value in disc.tractions.items()]
    given += [(region, -SpringPull(disc.problem, region, solution.gfu, disc.mesh)) for region in disc.problem.spring]
    integrals += [disc.problem.frame.Integral(
        traction * mu, ds(skeleton=True, definedon=disc.mesh.Boundaries(region), bonus_intorder=LOADBONUS))
        for region, traction in given]
    moments = sum((Coefficients(integral) for integral in integrals), np.zeros(space.ndof))
    return moments.reshape(disc.mesh.dim, -1).T


def _Held(solution: Any, sides: list[BoundaryQuadrature], shapes: Any, mass: Any) -> Array:
    """Weighted values w_q lambda (n, d) at the points, the normal that of the first side; 0 off Gamma_D and interfaces."""
    disc, facets, dim = solution.disc, solution.disc.facets, solution.disc.mesh.dim
    facet = facets.boundary[0][sides[0].boundaryelements]
    held = np.any([facets.interfaces.piece >= 0, *map(facets.On, disc.problem.dirichlet)], axis=0)
    there, found = held[facet], np.zeros(sides[0].normals.shape)
    if not there.any():
        return found
    cut, within = CutSpace(disc.space, facets, held), facets.neighbours[facet[there]] > 1
    scalar, weights = disc.method.ScalarSpace(disc.mesh, disc.order), sides[0].weights[there, None]
    here, beyond = (TraceMatrix(cut.broken, scalar, side.inside[there]) @ cut.parts for side in sides)
    jump = here - sp.diags(np.repeat(within.astype(float), dim)) @ beyond
    stress = disc.problem.frame.Plane(solution.stress)
    first, second = (np.asarray(stress(side.inside[there])).reshape(-1, dim, dim) for side in sides)
    mean = np.einsum("nij,nj->ni", np.where(within[:, None, None], (first + second) / 2, first), sides[0].normals[there])
    rest = cut.parts.T @ _Residual(solution, cut.broken) - _Shares(solution, cut) - jump.T @ (weights * mean).ravel()
    # The functions on a facet are orthogonal, up to curvature: the diagonal of their mass gives the norm of w.
    size = np.repeat(np.where(mass.diagonal() > 0, mass.diagonal(), 1), dim)
    shapes = sp.kron(shapes[there], sp.identity(dim)).tocsr()
    coupling = jump.T @ sp.diags(np.repeat(weights.ravel(), dim)) @ shapes
    w = _Smallest(coupling, size, rest, cut.Independent(~Free(disc.space)))
    found[there] = weights * (mean + (shapes @ w).reshape(-1, dim))
    return found


def _Smallest(coupling: Any, size: Array, rest: Array, rows: Any) -> Array:
    """The w of least w.(size w) with coupling w = rest, of which the given rows are independent and imply the others."""
    coupling = coupling[rows]
    gram = (coupling @ sp.diags(1 / size) @ coupling.T).tocsc()
    return coupling.T @ sp.linalg.splu(gram).solve(rest[rows]) / size


def _Residual(solution: Any, space: Any) -> Array:
    """R(v) for the functions of the broken space, (ndof,)."""
    disc, v, form = solution.disc, space.TestFunction(), solution.disc.form
    frame = disc.problem.frame
    residual = _Elastic(solution, space)
    for matrix in SpringMatrices(disc.problem, space).values():
        residual += matrix @ _Broken(solution, space).vec.FV().NumPy()
    if disc.problem.bodyforce is not None:
        residual -= Coefficients(frame.Integral(Unfolded(disc.problem.bodyforce) * v, dx(bonus_intorder=LOADBONUS)))
    for (kind, region), value in disc.tractions.items():
        measure = ds(skeleton=True, definedon=disc.mesh.Boundaries(region), bonus_intorder=LOADBONUS)
        residual -= Coefficients(frame.Integral(ForFacets(value, kind, region, disc.mesh) * v, measure))
    for part in form.parts:
        residual -= Coefficients(part.Integral(part.Flux(solution.gfu) * v))
        residual -= form.theta * Coefficients(part.Integral((part.Jump(solution.gfu) - part.value) * part.Mean(v)))
    for quadrature, traction in ContactTractions(solution):
        trace = TraceMatrix(space, disc.method.ScalarSpace(disc.mesh, disc.order), quadrature.inside)
        residual += trace.T @ (quadrature.weights[:, None] * traction).ravel()
    return residual


def _Broken(solution: Any, space: Any) -> GridFunction:
    """u_h in the broken space."""
    disc, displacement = solution.disc, GridFunction(space)
    # Not by NGSolve's Set, whose heap large hexahedra overflow.
    values = displacement.vec.FV().NumPy()
    for element in map(partial(ElementId, VOL), range(disc.mesh.ne)):
        values[list(space.GetDofNrs(element))] = solution.vector[list(disc.space.GetDofNrs(element))]
    return displacement


def _Elastic(solution: Any, space: Any) -> Array:
    """int C eps(u_h):eps(v), (ndof,), by the quadrature of the matrix: that of a linear form is another on curved elements."""
    disc, (u, v), displacement = solution.disc, space.TnT(), _Broken(solution, space)
    form = BilinearForm(disc.form.Elastic(u, v))
    product = displacement.vec.CreateVector()
    with Threads(disc.mesh):
        form.Apply(displacement.vec, product)
    return product.FV().NumPy().copy()


def _Shares(solution: Any, cut: CutSpace) -> Array:
    """Forces of added forms on the cut functions: where a dof is cut its parts share them by their elements."""
    elements = np.asarray(cut.parts.sum(axis=0)).ravel()
    return AddedForce(solution)[cut.dofs] * elements / np.bincount(cut.dofs, elements)[cut.dofs]


def AddedForce(solution: Any) -> Array:
    """Coefficients (ndof,) of the forces that added forms exert on the body."""
    disc = solution.disc
    force = disc.loads.get(("added", None), np.zeros(disc.space.ndof))
    return force if disc.added.matrix is None else force - disc.added.matrix @ solution.vector


def ContactTractions(solution: Any) -> Iterator[tuple[BoundaryQuadrature, Array]]:
    """(quadrature, what the body exerts at its points (n, d)) of every foundation, t, and of joints' sides, t and -t."""
    disc, start = solution.disc, 0
    for foundation in disc.problem.foundation:
        sides = Faces(disc.facets, foundation, ContactRules(disc.method, disc.mesh.dim, disc.order))
        end = start + len(sides[0].weights)
        for sign, quadrature in zip((1, -1), sides):
            yield quadrature, sign * solution.traction[disc.contact.members[start:end]]
        start = end


def _AddContact(solution: Any, functions: FacetFunctions, values: Array, forces: Array) -> None:
    """Subtract the integrals of t from the forces, and from the values the function that is t at the contact points."""
    numbers = solution.disc.facets.boundary[0]
    for quadrature, traction in ContactTractions(solution):
        np.subtract.at(forces, numbers[quadrature.boundaryelements], quadrature.weights[:, None] * traction)
        shapes, root = functions.Values(quadrature), np.sqrt(quadrature.weights)[:, None]
        starts = np.flatnonzero(np.diff(quadrature.boundaryelements, prepend=-1))
        counts = np.diff(np.append(starts, len(root)))
        for count in np.unique(counts):
            chosen = starts[counts == count]
            rows, dofs = chosen[:, None] + np.arange(count), functions.dofs[quadrature.boundaryelements[chosen]]
            found = np.linalg.pinv((root * shapes)[rows]) @ (root * traction)[rows]
            values[dofs[dofs >= 0]] -= found[dofs >= 0]
