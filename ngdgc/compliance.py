"""The linear problem seen from Gamma_C, with a stiffness D of Gamma_C in the factorised matrix.

With A u = f - T' W t, every D >= 0 and every reference c (d components at each contact point) give the same problem

    (A + T' W D T) u = f + T' W D c - T' W s,      t = s + D (u - c) on Gamma_C,

so u = u_0 - S_D s there, with S_D = T (A + T' W D T)^-1 T' W and one application of the inverse for each product.  D = 0 is the
elastic body alone; D near the slope of the law makes the solution depend little on s, and holds a body that nothing else holds.
"""

from functools import cached_property

import numpy as np
import scipy.sparse as sp

from .exceptions import ProblemError
from .facets import Csr, Native, Threads


class Compliance:
    """S_D of a Discretization for a stiffness D (n, d, d), symmetric and nonnegative, or None for D = 0.

    reference : c, (n, d) [length]

    Attributes
    ----------
    vector : coefficients of the last displacement that was computed, (ndof,)
    """

    def __init__(self, disc, stiffness=None, reference=None):
        self.disc, self.contact, self.stiffness = disc, disc.contact, stiffness
        self.reference = np.zeros_like(disc.contact.normals) if reference is None else reference
        self._inverse = disc.inverse if stiffness is None else self._Factorise()
        self._load = 1.0
        self._loaded = self._Displacement(1.0)
        self._free = self._loaded
        self.vector = self._free

    def _Displacement(self, load):
        """Coefficients of the displacement for s = 0 under a multiple of the loads and prescribed displacements, (ndof,)."""
        disc = self.disc
        lift = load * disc.prescribed
        force = load * disc.load - disc.Multiply(lift) if np.any(lift) else load * disc.load
        if self.stiffness is not None:
            force = force + self.contact.Load(Apply(self.stiffness, self.reference - self.contact.Displacement(lift)))
        free = lift + self._Solve(force)
        if not np.all(np.isfinite(free)):
            raise ProblemError("the elastic matrix cannot be factorised: the response to the loads is not finite; look for "
                               "coefficients of extreme size and for degenerate elements")
        return free

    @cached_property
    def _unloaded(self):
        return self._Displacement(0.0) if self.stiffness is not None else np.zeros_like(self._loaded)

    def Free(self, load=1.0):
        """u_0 at the contact points under a multiple of the loads and prescribed displacements, (n, d)."""
        if load != self._load:
            self._free = self._loaded if load == 1 else load * self._loaded + (1 - load) * self._unloaded
            self._load = load
        return self.contact.Displacement(self._free)

    def Response(self, s):
        """S_D s at the contact points, (n, d) -> (n, d), by one application of the inverse; sets `vector`."""
        response = self._Solve(self.contact.Load(s))
        self.vector = self._free - response
        return self.contact.Displacement(response)

    def Shifted(self, displacement, traction):
        """s = t - D (u - c), (n, d)."""
        if self.stiffness is None:
            return traction
        return traction - Apply(self.stiffness, displacement - self.reference)

    def Traction(self, displacement, s):
        """t = s + D (u - c), the traction in equilibrium with the displacement that s causes, (n, d)."""
        return s if self.stiffness is None else s + Apply(self.stiffness, displacement - self.reference)

    def _Solve(self, load):
        return self.disc.ApplyInverse(self._inverse, load)

    def _Factorise(self):
        """The inverse of A + T' W D T; its entries are added to those of A for the time of the factorisation."""
        disc, contact = self.disc, self.contact
        n, dim = contact.normals.shape
        weighted = contact.weights[:, None, None] * self.stiffness
        diagonal = sp.bsr_matrix((weighted, np.arange(n), np.arange(n + 1)), shape=(n * dim, n * dim)).tocsr()
        added = (contact.trace.T @ diagonal @ contact.trace).tocsr()
        with Threads(disc.mesh):
            values, positions = _Positions(disc.matrix, added)
            if positions is None:
                return disc.Factorise(Native(Csr(disc.matrix) + added))
            before = values[positions].copy()
            values[positions] += added.data
            try:
                return disc.Factorise(disc.matrix)
            finally:
                values[positions] = before


def Apply(matrices, vectors):
    """Products of matrices (n, d, d) and vectors (n, d)."""
    return np.einsum("nij,nj->ni", matrices, vectors)


def _Positions(matrix, added):
    """(values, positions): the entries of an NGSolve matrix, and where among them those of a CSR matrix are, or None."""
    values, columns, starts = (np.asarray(part) for part in matrix.CSR())
    positions = np.empty(added.nnz, dtype=np.int64)
    for row in np.flatnonzero(np.diff(added.indptr)):
        here, first = slice(*added.indptr[row:row + 2]), starts[row]
        own = columns[first:starts[row + 1]]
        found = np.searchsorted(own, added.indices[here])
        if not np.array_equal(own[np.minimum(found, len(own) - 1)], added.indices[here]):
            return values, None
        positions[here] = first + found
    return values, positions
