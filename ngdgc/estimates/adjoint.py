"""What residuals do to a quantity: the dual weighted residual method (Becker, Rannacher 2001), for contact.

With K the derivative at u_h of the equations of the interior penalty method of order k + 1 on the same mesh, Gamma_C in
Nitsche's form (`nitsche`), and J(u) = int_GammaC t.j + c(u) a quantity,

    K' z = J'(u_h),    J(u) - J_h = J(u_h) - J_h + R(u_h; z) + higher order,

R(u_h; v) what u_h leaves over in these equations, tested with v.  J(u_h) - J_h is the quadrature error on Gamma_C.  K is not
symmetric where friction follows the pressure.  Whichever method u_h is of, the equations are consistent, also those of the
adjoint problem, which those of an unsymmetric method are not.

A continuous z_k of order k that vanishes on Gamma_D leaves nothing over in the equations that u_h solves, and B(u_h, z_k) is
the same for all methods but unsymmetric ones; so the shares of the elements are those of

    (f - A u_h)(z - z_k) + [Gamma_C, with z] + int_GammaC t.j - sum_q w_q t_q.(j - z_k)(x_q),

t_q the computed tractions at the contact points x_q.  What this lacks of the error is added to them in proportion.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from ngsolve import GridFunction

from ..contact.boundary import ContactBoundary
from ..contracts import Array, Inverse
from ..discrete.problem import DiscreteProblem
from ..linear.choice import INVERTERS, Direct
from ..linear.outside import Made
from ..linear.sums import Sum
from ..mesh.facets import Free, Projected, Threads
from ..methods.conforming import Conforming
from ..methods.rows import InteriorPenalty
from .goals import Goal
from .loadquadrature import Owners
from .nitsche import LinearisedContact

SYMMETRIC = 1e-12   # difference of dt/dq and its transpose that is round-off


@dataclass(frozen=True, eq=False)
class DualError:
    """J(u) - J_h of the m components of a goal, error (m,), and its summands, the shares of the elements (elements, m)."""

    error: Array
    shares: Array


class Adjoint:
    """The adjoint problem of a ContactSolution, factorised once.

    Attributes
    ----------
    fine : DiscreteProblem of order k + 1;  contact : LinearisedContact
    """

    def __init__(self, solution: Any) -> None:
        disc = solution.disc
        self.solution = solution
        self.fine = fine = DiscreteProblem(disc.problem, InteriorPenalty(), disc.mesh, order=disc.order + 1,
                                           inverse=disc.wanted if isinstance(disc.wanted, str) else "auto")
        vector = Projected(fine.space, solution.gfu)
        self.contact = LinearisedContact(fine, vector)
        self.rest: Array = fine.load - fine.Multiply(vector)
        self._inverse = self._Factorise()
        self._owners = Owners(fine.space)
        self._beside, self._weights = _Beside(self.contact.contact, disc.contact)
        self._smooth = Conforming().Space(disc.mesh, disc.order, "|".join(disc.problem.dirichlet))

    def _Factorise(self) -> Inverse:
        """K'^-1 (A is symmetric), by what is wanted for A unless that is for symmetric matrices alone.

        For several right-hand sides a factorisation takes less time than conjugate gradients, where it fits into the memory.
        """
        fine, slope = self.fine, self.contact.slope
        symmetric = np.abs(slope - np.swapaxes(slope, 1, 2)).max(initial=0) <= SYMMETRIC
        wanted = Direct(fine.mesh.dim) if fine.wanted == "auto" else str(fine.wanted)
        inverter = INVERTERS[wanted if symmetric else "umfpack"]
        with Threads(fine.mesh):
            return Made(inverter, Sum(fine.matrix, self.contact.Matrix().T.tocsr()), fine)

    def Solve(self, load: Array) -> Array:
        """z (ndof,) with K' z = load (ndof,)."""
        return self._inverse.Solve(load)

    def Errors(self, goal: Goal) -> DualError:
        """The `DualError` of a goal."""
        contact, fine = self.contact.contact, self.fine
        weights, coarse = goal.Weights(contact), goal.Weights(self.solution.disc.contact)
        loads = goal.Functionals(fine) + np.array([self.contact.Derivative(one) for one in weights])
        parts = [self._Shares(self.Solve(load), *pair) for load, pair in zip(loads, zip(weights, coarse))]
        return DualError(np.array([error for error, _ in parts]), np.array([shares for _, shares in parts]).T)

    def _Shares(self, z: Array, weights: Array, coarse: Array) -> tuple[float, Array]:
        """(error, shares (elements,)) of one component with the solution z (ndof,) of its adjoint problem."""
        contact, disc = self.contact.contact, self.solution.disc
        smooth = self._Smooth(z)
        shares: Any = np.bincount(self._owners, self.rest * (z - smooth), minlength=disc.mesh.ne)
        fine = self.contact.Parts(z) + contact.weights * np.sum(self.contact.traction * weights, axis=1)
        test = coarse - np.asarray(self._Function(smooth)(disc.contact.inside)).reshape(coarse.shape)
        shares += np.bincount(contact.inside["nr"], fine, minlength=len(shares))
        pulled = np.sum(self.solution.traction * test, axis=1)[disc.contact.members]
        shares -= np.bincount(self._beside, self._weights * pulled, minlength=len(shares))
        error = self.rest @ z + fine.sum() - disc.contact.weights @ np.sum(self.solution.traction * coarse, axis=1)
        size = np.abs(shares).sum()
        return float(error), shares + (error - shares.sum()) * np.abs(shares) / (size or 1)

    def _Smooth(self, z: Array) -> Array:
        """Coefficients (ndof,) of z_k."""
        smooth = GridFunction(self._smooth)
        smooth.vec.FV().NumPy()[:] = np.where(Free(self._smooth), Projected(self._smooth, self._Function(z)), 0)
        return Projected(self.fine.space, smooth)

    def _Function(self, vector: Array) -> GridFunction:
        function = GridFunction(self.fine.space)
        function.vec.FV().NumPy()[:] = vector
        return function


def _Beside(fine: ContactBoundary, contact: ContactBoundary) -> tuple[Any, Array]:
    """(elements, weights) of the pairs of boundary elements and contact points, (pairs,): a node has the weight of several."""
    element = np.zeros(fine.boundaryelements.max() + 1, dtype=int)
    element[fine.boundaryelements] = fine.inside["nr"]
    measures = np.bincount(fine.boundaryelements, fine.weights)[contact.boundaryelements]
    part = measures / np.bincount(contact.members, measures)[contact.members]
    return element[contact.boundaryelements], part * contact.weights[contact.members]
