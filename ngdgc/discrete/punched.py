"""Rigid punches that forces press: their motions as unknowns besides the displacement of the body.

With c the motions (m,) of the punches that are to be found, R c what they move the contact points by and P what presses them,
the law is one of u - R c, and the resultants of its tractions hold the punches:

    A u + T' W t = f,       - R' W t = P,       t = law(T u - R c).

This is A u = f - T' W t once more, for x = (u, c), the matrix diag(A, 0), the load (f, P) and the trace (T, -R): what solves
one solves the other, with all motions of the punches resisted by contact alone.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..contact.punches import Punches
from ..contracts import Array, InexactInverse, Inverse, LinearProblem
from ..exceptions import ProblemError
from ..tools import sparse as sp
from .problem import DiscreteProblem


def Enlarged(disc: DiscreteProblem) -> LinearProblem:
    """A Discretization for Newton's method, with the motions of its punches that are to be found."""
    punches = disc.contact.punches
    return disc if punches is None or not punches.count else PunchedProblem(disc, punches)


class PunchedProblem:
    """A DiscreteProblem with motions of rigid punches as unknowns; it takes its place for `NewtonRun`, as a Subspace does.

    What inverses cost is counted by the DiscreteProblem.
    """

    shift = 0.0

    def __init__(self, disc: DiscreteProblem, punches: Punches) -> None:
        if disc.iterates:
            raise ProblemError(f"inverse={disc.inversekind!r} is not for punches that a force presses; take inverse='auto' or "
                               "'sparsecholesky', or prescribe their displacement")
        self.disc, self.mesh, self.problem, self.order = disc, disc.mesh, disc.problem, disc.order
        self.contact = disc.contact.WithPunches()
        self.size, self.count = disc.space.ndof, punches.count
        self.load, self.prescribed = np.append(disc.load, punches.loads), self.Padded(disc.prescribed)
        self.unresisted = disc.unresisted
        self.resultant = np.append(disc.resultant, punches.loads)

    def Padded(self, vector: Array) -> Array:
        """(u, 0) of coefficients u, (..., ndof) -> (..., ndof + m)."""
        return np.concatenate([vector, np.zeros((*vector.shape[:-1], self.count))], axis=-1)

    @property
    def matrix(self) -> Any:
        """A of the body."""
        return self.disc.matrix

    @property
    def motions(self) -> Array:
        """Coefficients of the rigid motions of body and punches that A does not resist, (modes, ndof + m)."""
        alone = np.eye(self.count, self.size + self.count, self.size)
        return np.vstack([self.Padded(self.disc.motions), alone]) if self.disc.restraints.floating else alone

    @property
    def inverse(self) -> Any:
        return self.disc.inverse        # which says that A is singular

    @property
    def solves(self) -> int:
        return self.disc.solves

    @property
    def cycles(self) -> int:
        return self.disc.cycles

    @property
    def factorisation(self) -> float:
        return self.disc.factorisation

    @property
    def unknowns(self) -> int:
        return self.size + self.count

    def Norm(self, vector: Array) -> float:
        return self.disc.Norm(vector)

    def Multiply(self, vector: Array) -> Array:
        return self.Padded(self.disc.Multiply(vector[:self.size]))

    def FactoriseSum(self, added: sp.csr_matrix) -> Inverse:
        """The inverse of diag(A, 0) and a matrix of the stiffness of Gamma_C."""
        return Bordered(self.disc, added.tocsr(), self.size)

    def ApplyInverse(self, inverse: Inverse, load: Array) -> Array:
        return inverse.Solve(load)

    def Iterate(self, inverse: InexactInverse, load: Array, *, tol: float, start: Array) -> Array:
        return inverse.Solve(load)      # which is no iteration


class Bordered:
    """The inverse of [A + D, B; B', C] by one of A + D, the application of which it takes m times more when it is made.

    added : scipy CSR [D, B; B', C];  size : of A
    """

    def __init__(self, disc: DiscreteProblem, added: sp.csr_matrix, size: int) -> None:
        self.disc, self.size = disc, size
        self.body: Inverse = disc.FactoriseSum(added[:size, :size])
        self.border, corner = added[:size, size:].toarray(), added[size:, size:].toarray()
        self.columns = np.array([disc.ApplyInverse(self.body, column) for column in self.border.T]).T
        self.corner = corner - self.border.T @ self.columns

    def Solve(self, load: Array) -> Array:
        """(u, c) of a load, (ndof + m,)."""
        u = self.disc.ApplyInverse(self.body, load[:self.size])
        c = np.linalg.solve(self.corner, load[self.size:] - self.border.T @ u)
        return np.append(u - self.columns @ c, c)
