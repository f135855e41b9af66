"""What the quadrature of the loads does to a solution: a force that jumps inside of an element is not what its points see.

The solution obeys A u = f_q with loads by quadrature, and so does the stress in equilibrium: neither knows of it.  With f by a
finer quadrature, d = f - f_q, the difference has the energy

    d . (A + T' W D T)^-1 d,    D the stiffness of the law at the solution,

and each element its summand of that.  Equations are solved only where this may matter: by the inequalities of Poincare and Korn
the energy is about L^2/(pi^2 2 mu) |d|^2 at most, L the extent of the body and |d| the L2 norm of the density of d in V_h.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import CF, VOL, BitArray, GridFunction, ds, dx

from ..contracts import Array
from ..data.coefficients import LOADBONUS, ForFacets, Unfolded
from ..discrete.response import ContactResponse
from ..mesh.facets import VolumePoints
from ..methods.symbolform import Coefficients
from ..solvers.newton.setting import Setting

HIGHER = 4                  # quadrature degrees beyond those of the loads, which tell where these are too low
FINE = {2: 40, 3: 16}       # that are used there, by dimension: a jump is met to a part of an element like their inverse
FEW = 0.05                  # of the estimate, that loads may add unseen
JUMP = 0.01                 # of the largest |d|^2 of an element, that asks for the fine quadrature


def LoadQuadrature(solution: Any, value: float) -> Array:
    """Squares of the elements' shares (elements,) [stress length^d]; zeros where they cannot matter beside value^2."""
    disc = solution.disc
    owners, everywhere = Owners(disc.space), np.ones(disc.mesh.ne, dtype=bool)
    squares = _Squares(disc, _Difference(disc, HIGHER, everywhere), owners)
    if _Factor(disc) * squares.sum() <= (FEW * value) ** 2:
        return np.zeros(disc.mesh.ne)
    difference = _Difference(disc, FINE[disc.mesh.dim], squares > JUMP * squares.max())
    setting = Setting.Of(disc)
    point = setting.graph.At(setting.graph.Coordinates(solution.displacement, solution.traction))
    work = difference * ContactResponse(disc, setting.Stiffness(point)).Solve(difference)
    shares = np.abs(np.bincount(owners, work, minlength=disc.mesh.ne))
    return np.asarray(shares * (work.sum() / (shares.sum() or 1)))


def _Difference(disc: Any, bonus: int, where: np.ndarray) -> Array:
    """d (ndof,) of body force, on some elements (elements,), and of tractions, with a quadrature of that much higher degree."""
    v, problem, load = disc.space.TestFunction(), disc.problem, np.zeros(disc.space.ndof)
    if problem.bodyforce is not None:
        elements = BitArray(where.tolist())
        force = Unfolded(problem.bodyforce) * v
        for sign, degree in ((1, bonus), (-1, 0)):
            measure = dx(bonus_intorder=LOADBONUS + degree, definedonelements=elements)
            load += sign * Coefficients(problem.frame.Integral(force, measure))
    for (kind, region), value in disc.tractions.items():
        measure = ds(skeleton=True, definedon=disc.mesh.Boundaries(region), bonus_intorder=LOADBONUS + bonus)
        fine = Coefficients(problem.frame.Integral(ForFacets(value, kind, region, disc.mesh) * v, measure))
        load += fine - disc.loads[kind, region]
    return load


def _Squares(disc: Any, difference: Array, owners: np.ndarray) -> Array:
    """|d|^2 of the elements (elements,)."""
    density = GridFunction(disc.space)
    density.vec.FV().NumPy()[:] = difference
    disc.space.SolveM(density.vec, rho=disc.problem.frame.Weighted(CF(1)) if disc.problem.axisymmetric else None)
    return np.asarray(np.bincount(owners, difference * density.vec.FV().NumPy(), minlength=disc.mesh.ne), dtype=float)


def _Factor(disc: Any) -> float:
    """L^2/(pi^2 2 mu), about the largest energy over |d|^2."""
    shear = disc.problem.material.ShearAt(VolumePoints(disc.mesh, 2)).min()
    return float((np.ptp(disc.mesh.ngmesh.Coordinates(), axis=0).max() / np.pi) ** 2 / (2 * shear))


def Owners(space: Any) -> Array:
    """Numbers of the elements that functions of a discontinuous space are on, (ndof,)."""
    owners = np.empty(space.ndof, dtype=int)
    for element in space.Elements(VOL):
        owners[list(element.dofs)] = element.nr
    return owners
