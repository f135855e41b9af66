"""Forces and moments: resultants on each part of the boundary, and the balance of every element and of the body.

Everything is tested with the rigid motions as functions of V_h, so that a discrete solution balances to round-off: DG on each
element, from its numerical fluxes; H1 globally, from tractions that its residual corrects (`conformingtractions`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from ngsolve import VOL, ElementId, GridFunction, ds, specialcf

from ..contracts import Array
from ..discrete.problem import DiscreteProblem
from ..linear.motions import ProjectedMotions
from ..mesh.facets import RigidMotionsAt, VolumePoints
from ..methods.symbolform import Coefficients
from ..tools.calls import ByKeyword
from .conformingtractions import AddedForce


NEGLIGIBLE = 1e-7   # part of |diag(A) u| that is above its round-off
LOADS = ("traction", "force", "bodyforce")
BALANCE = 1e-6      # `EquilibriumResidual` of a converged solution at most; round-off is far below


@ByKeyword
@dataclass(frozen=True)
class Resultant:
    """Force on the body (d,) [stress length^(d-1)] and its moment about the origin (1,) in 2D or (3,) [stress length^d].

    Of a body of revolution the force (F_r, F_z) is that of the whole ring, F_r the integral of the radial traction, and the
    moment, which cancels all around, 0.

    kind : "dirichlet", "roller", "traction", "force", "spring", "foundation", "joint" (on its first side),
        "bodyforce", or "added" for the user's own forms
    integrated : (force, moment) of int C eps(u_h) n over the region where it differs from the reported value, the strongly
        imposed displacements of H1; None elsewhere

    >>> from ngdgc.cases import example_4_2
    >>> solution = example_4_2.Main(n=4)
    >>> [resultant.kind for resultant in solution.Resultants()]
    ['dirichlet', 'traction', 'foundation']
    """

    kind: str
    region: str | None
    force: np.ndarray
    moment: np.ndarray
    integrated: tuple[Array, Array] | None = None


@ByKeyword
def RigidBasis(space: Any) -> Array:
    """Coefficients in V_h of the rigid motions, (modes, ndof)."""
    return ProjectedMotions(space, np.zeros(space.mesh.dim))


@ByKeyword
def Resultants(solution: Any) -> list[Resultant]:
    """The list of `Resultant`s of a solution: supports, tractions, foundations and body force, in the order of the problem."""
    disc, dim = solution.disc, solution.disc.mesh.dim
    basis = disc.rigidbasis

    def Split(modes: Array) -> tuple[Array, Array]:
        # Moments of a ring's forces cancel all around.
        return modes[:dim], 0 * modes[dim:] if disc.problem.axisymmetric else modes[dim:]

    found = [Resultant("dirichlet", region, *Split(modes), Split(basis @ stress))
             for region, modes, stress in _StrongReactions(solution)]
    found += [Resultant("roller" if region in disc.problem.roller else "dirichlet", region, *Split(basis @ flux))
              for region, flux in solution.testedfluxes.items() if region is not None]
    found += [Resultant(kind, region, *Split(basis @ load)) for (kind, region), load in disc.loads.items()
              if kind in LOADS]
    found += [Resultant("spring", region, *Split(-(basis @ (matrix @ solution.vector))))
              for region, matrix in disc.springs.items()]
    if disc.added:
        found.append(Resultant("added", None, *Split(basis @ AddedForce(solution))))
    contact = disc.contact
    motions = RigidMotionsAt(contact.coordinates)
    for part in contact.parts:
        here = part.points
        modes = -np.einsum("cnd,nd,n->c", motions[:, here], solution.traction[here], contact.weights[here])
        found.append(Resultant(part.foundation.kind, part.foundation.boundary, *Split(modes)))
    return found


def _StrongReactions(solution: Any) -> Iterator[tuple[str, Array, Array]]:
    """(region, modes of the reaction, int C eps(u) n.v as coefficients), for regions with strongly imposed displacement."""
    disc = solution.disc
    if disc.method.weak or not disc.problem.dirichlet:
        return
    quadrature, tractions = solution.facettractions.held
    facet, motion = disc.facets.boundary[0][quadrature.boundaryelements], GridFunction(disc.space)
    traces = []
    for coefficients in RigidBasis(disc.space):
        motion.vec.FV().NumPy()[:] = coefficients
        traces.append(np.asarray(motion(quadrature.inside)))
    frame, n, v = disc.problem.frame, specialcf.normal(disc.mesh.dim), disc.space.TestFunction()
    stress = frame.Plane(solution.stress)
    for region in disc.problem.dirichlet:
        there = disc.facets.On(region)[facet]
        modes = np.einsum("cnd,nd->c", np.array(traces)[:, there], tractions[there])
        measure = ds(skeleton=True, definedon=disc.mesh.Boundaries(region))
        yield region, modes, Coefficients(frame.Integral((stress * n) * v, measure))


@ByKeyword
def GlobalImbalance(solution: Any) -> float:
    """Largest component of the sum of all forces and moments, relative to the largest single one or to `ElasticForce`."""
    modes = np.array([np.concatenate([resultant.force, resultant.moment]) for resultant in solution.Resultants()
                      if resultant.kind != "joint"])     # whose two sides balance
    modes = modes[:, solution.disc.problem.frame.rigid]
    return float(np.abs(modes.sum(axis=0)).max() / max(np.abs(modes).max(), ElasticForce(solution)))


@ByKeyword
def EquilibriumResidual(disc: DiscreteProblem, vector: Array, traction: Array) -> float:
    """|A u - f + T' W t| of coefficients u (ndof,) and tractions t (n, d), Euclidean norm on the free dofs, relative.

    With what the tractions on rigid punches lack of the loads on these, relative to them.

    To the largest of A u, f and T' W t, or to NEGLIGIBLE |diag(A) u| if that is more: of a nearly rigid motion of a stiff body
    A u is a small difference of large numbers, whose round-off, some 10 eps |diag(A) u|, tells nothing.
    """
    elastic, pull = disc.Multiply(vector), disc.contact.Load(traction)
    free = disc.free
    size = max(disc.Norm(part[free]) for part in (elastic, disc.load, pull, NEGLIGIBLE * disc.diagonal * vector))
    residual = disc.Norm((elastic - disc.load + pull)[free]) / size if size else 0.0
    punches = disc.contact.punches
    if punches is None or not np.any(punches.loads):
        return residual
    return max(residual, float(np.abs(punches.Excess(traction, disc.contact.weights)).max() / np.abs(punches.loads).max()))


@ByKeyword
def ElasticForce(solution: Any) -> float:
    """mu max|u| L^(d-2), L the size of the body: forces far below it are round-off of a body that nothing loads."""
    disc = solution.disc
    vertices = disc.facets.vertices
    points = disc.mesh.ngmesh.Coordinates()[vertices[vertices >= 0], :disc.mesh.dim]
    displacement = np.abs(np.asarray(solution.gfu(VolumePoints(disc.mesh, 2)))).max()
    shear = disc.problem.material.ShearAt(VolumePoints(disc.mesh, 2)).max()
    return shear * displacement * np.ptp(points, axis=0).max() ** (disc.mesh.dim - 2 + disc.problem.axisymmetric) or 1.0


@ByKeyword
def ElementImbalance(solution: Any) -> Array:
    """Force and moment that the numerical fluxes leave unbalanced on each element, (elements, modes), DG only.

    On element K: int_dK sigma_hat n_K.r + int_K f_1.r for the rigid motions r, with sigma_hat the numerical flux between
    elements and on Gamma_D, f_2 on Gamma_F, -k u_h on springs and -t on Gamma_C; relative to the largest contribution of any
    element or to `ElasticForce`.
    """
    parts = ElementForces(solution)
    return parts.sum(axis=0).T / max(np.abs(parts).max(), ElasticForce(solution))


def ElementForces(solution: Any) -> Array:
    """Forces and moments on each element, (contributions, modes, elements), of fluxes, loads, springs and contact."""
    disc = solution.disc
    contributions = [*solution.testedfluxes.values()]
    contributions += [load for (kind, _), load in disc.loads.items() if kind in LOADS]
    contributions += [-(matrix @ solution.vector) for matrix in disc.springs.values()]
    contributions += [-disc.contact.Load(solution.traction), AddedForce(solution)]
    basis = disc.rigidbasis[disc.problem.frame.rigid]
    owner = np.empty(disc.space.ndof, dtype=int)
    for element in range(disc.mesh.ne):
        owner[list(disc.space.GetDofNrs(ElementId(VOL, element)))] = element
    return np.array([[np.bincount(owner, mode * vector, minlength=disc.mesh.ne) for mode in basis]
                     for vector in contributions])
