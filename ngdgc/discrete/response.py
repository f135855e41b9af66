"""The linear problem seen from Gamma_C, with a stiffness D of Gamma_C in the factorised matrix.

With A u = f - T' W t, every D >= 0 gives the same problem: if t = t_0 + D (u - u_0) for some u_0 and t_0 on Gamma_C, then

    (A + T' W D T) u = f + T' W (D u_0 - t_0).

What a change of t_0 - D u_0 by s does to u on Gamma_C is -S_D s, S_D = T (A + T' W D T)^-1 T' W, with one application of the
inverse for each product.  D = 0 is the elastic body alone; D near the slope of the law makes the solution depend little on s,
and holds a body that nothing else holds.
"""

from __future__ import annotations

from copy import copy
from typing import cast

import numpy as np

from ..contact.equilibrium import Equilibrium
from ..contracts import Array, InexactInverse, Inverse, LinearProblem
from ..exceptions import ProblemError
from ..linear.motions import Deflation


class ContactResponse:
    """S_D of a Discretization or `subspace.Subspace` for a stiffness D (n, d, d), symmetric and nonnegative; None: D = 0."""

    def __init__(self, disc: LinearProblem, stiffness: Array | None = None) -> None:
        self.disc, self.contact, self.stiffness = disc, disc.contact, stiffness
        self._inverse = disc.inverse if stiffness is None else self._Factorise()
        motions = disc.motions if stiffness is not None and disc.unresisted else ()
        self._deflation = Deflation(cast(Array, motions), disc.contact, cast(Array, stiffness)) if len(motions) else None

    def Meet(self, displacement: Array, traction: Array, *, load: float = 1.0,
             near: Equilibrium | None = None) -> tuple[Equilibrium, Array | None, Array | None]:
        """(Equilibrium, s, S_D s): the one that meets t = traction + D (u - displacement), by one application of the inverse.

        near : an Equilibrium of the same load; the difference to it is computed, s that of t - D u (n, d)
        Without near, s and S_D s are None.
        """
        if near is None or near.load != load:
            vector = self._Displacement(load, self.Restoring(displacement) - traction)
            return self._Equilibrium(vector, displacement, traction, load), None, None
        s = traction - near.traction - self.Restoring(displacement - near.displacement)
        vector = near.vector - self.Solve(self.contact.Load(s))
        equilibrium = self._Equilibrium(vector, displacement, traction, load)
        return equilibrium, s, near.displacement - equilibrium.displacement

    def Approach(self, vector: Array, displacement: Array, traction: Array, *, part: float = 1.0,
                 most: float | None = None) -> Equilibrium:
        """The Equilibrium of `Meet` nearly, from coefficients (ndof,) nearby, by an inverse that is an iteration.

        What is out of balance becomes at most `part` of what it is, and, if given, `most` of the loads or, of a body that only
        a foundation deforms, of what that presses with; all as Euclidean norms.
        """
        disc = self.disc
        load = disc.load + self.contact.Load(self.Restoring(displacement) - traction)
        excess = load - disc.Multiply(vector) - self.contact.Load(self.Restoring(self.contact.Displacement(vector)))
        goal = part * disc.Norm(excess)
        if most is not None:
            goal = min(goal, most * (disc.Norm(disc.load) or disc.Norm(self.contact.Load(traction))))
        vector = disc.Iterate(cast(InexactInverse, self._inverse), load, tol=goal / (disc.Norm(load) or 1),
                              start=vector)
        if self._deflation:
            vector = self._deflation.Balance(vector, load)
        return self._Equilibrium(vector, displacement, traction, 1.0)

    def _Equilibrium(self, vector: Array, displacement: Array, traction: Array, load: float) -> Equilibrium:
        u = self.contact.Displacement(vector) + load * self.disc.shift
        return Equilibrium(vector=vector, displacement=u, traction=traction + self.Restoring(u - displacement), load=load)

    def Moved(self, disc: LinearProblem) -> ContactResponse:
        """The same operator, with its inverse, for a problem with another right-hand side and the same matrix."""
        other = copy(self)
        other.disc, other.contact = disc, disc.contact
        return other

    def Product(self, s: Array) -> Array:
        """S_D s at the contact points, (n, d) -> (n, d), by one application of the inverse."""
        return self.contact.Displacement(self.Solve(self.contact.Load(s)))

    def Restoring(self, displacement: Array) -> Array:
        """D u, the traction of the stiffness in the matrix, (n, d)."""
        return np.zeros_like(displacement) if self.stiffness is None else Apply(self.stiffness, displacement)

    def _Displacement(self, load: float, pull: Array) -> Array:
        """Coefficients of u under a multiple of the loads and prescribed displacements and a traction on the body, (ndof,)."""
        disc = self.disc
        lift = load * disc.prescribed
        force, there = load * disc.load, load * disc.shift
        if np.any(lift):
            force, there = force - disc.Multiply(lift), there + self.contact.Displacement(lift)
        if np.any(there):
            pull = pull - self.Restoring(there)
        vector = lift + self.Solve(force + self.contact.Load(pull))
        if not np.all(np.isfinite(vector)):
            raise ProblemError("the elastic matrix cannot be factorised: the response to the loads is not finite; look for "
                               "coefficients of extreme size and for degenerate elements")
        return vector

    def Solve(self, load: Array) -> Array:
        """Coefficients of the response to a load, without prescribed displacements and tractions, (ndof,) -> (ndof,)."""
        if self._deflation:
            return self._deflation.Solve(self._Inverse, load)
        return self._Inverse(load)

    def _Inverse(self, load: Array) -> Array:
        return self.disc.ApplyInverse(self._inverse, load)

    def _Factorise(self) -> Inverse:
        """The inverse of A + T' W D T."""
        return self.disc.FactoriseSum(self.contact.Stiffness(cast(Array, self.stiffness)))


def Apply(matrices: Array, vectors: Array) -> Array:
    """Products of matrices (n, d, d) and vectors (n, d)."""
    return np.einsum("nij,nj->ni", matrices, vectors)
