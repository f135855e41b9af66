"""Rigid motions that nothing but contact resists, treated exactly: on a soft foundation they are large, and all else is small.

With R the coefficients of such motions A R = 0, so that K = A + T' W D T has the energy R' K R = (T R)' W D (T R) for them,
which may be less than the round-off of A.  K x = b is solved as x = R c + y,

    (R' K R) c = R' b,    K y = b - T' W D T R c,    R' K y = 0,

where no rigid motion is left in y: forces and moments of contact balance the loads to round-off however soft D is.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

import numpy as np
from ngsolve import CF, FESpace, GridFunction

from ..contracts import Array
from ..mesh.facets import Coordinates, Csr, Free, RigidMotionsAt

NEARLY = 1e-10      # forces out of balance, relative, in the norm of the energy of rigid motions
NULL = 1e-11        # A R in units of what its terms are, that is round-off


def ProjectedMotions(space: FESpace, centre: Array) -> Array:
    """Coefficients (modes, ndof) of the rigid motions of `RigidMotions`, rotations about a centre (d,), in a vector space.

    Their components are combinations of 1 and of x - centre, which are all that is projected: components have equal spaces.
    """
    scalar, dim = GridFunction(space).components[0], space.mesh.dim
    functions = []
    for function in (CF(1), *(Coordinates(dim)[axis] - centre[axis] for axis in range(dim))):
        scalar.Set(function)
        functions.append(scalar.vec.FV().NumPy().copy())
    # The motions are affine: at the centre they are the translations, one step further along an axis what that adds.
    corners = RigidMotionsAt(np.vstack([np.zeros(dim), np.eye(dim)]))
    parts = np.concatenate([corners[:, :1], corners[:, 1:] - corners[:, :1]], axis=1)
    return np.einsum("cmd,mn->cdn", parts, functions).reshape(len(parts), -1)


def FreeMotions(disc: Any) -> Array:
    """Coefficients (m, ndof) of a basis of the rigid motions that A does not resist, of a body of one part.

    With several parts, springs or forms that were added there is none: (0, ndof).
    """
    if disc.addedmatrix is not None or disc.facets.component.max() > 0:
        return np.empty((0, disc.space.ndof))
    centre = disc.mesh.ngmesh.Coordinates()[:, :disc.mesh.dim].mean(axis=0)
    motions = ProjectedMotions(disc.space, centre)
    matrix, fixed = Csr(disc.matrix), ~Free(disc.space)
    terms = matrix.diagonal()[:, None] * motions.T
    terms[fixed] = 0
    motions = motions.T / (np.linalg.norm(terms, axis=0))
    resisted = matrix @ motions
    resisted[fixed] = motions[fixed] * np.abs(matrix.diagonal()).max()
    _, sizes, combinations = np.linalg.svd(resisted, full_matrices=False)
    return (motions @ combinations[sizes <= NULL].T).T


class Deflation:
    """The solution of K x = b with rigid motions (m, ndof) of a Discretization treated exactly; D (n, d, d)."""

    def __init__(self, motions: Array, contact: Any, stiffness: Array) -> None:
        self.motions, self.contact = motions, contact
        self.traces = np.array([contact.Displacement(motion) for motion in motions])
        values, vectors = np.linalg.eigh(stiffness)
        root = np.sqrt(np.maximum(values, 0) * contact.weights[:, None])[:, :, None] * np.swapaxes(vectors, 1, 2)
        self.pulls = np.einsum("nij,mnj->mni", stiffness, self.traces)
        # R' K R = B' B: what is stiff in one direction hides nothing that is soft in another.
        triangle = np.linalg.qr(np.einsum("nij,mnj->nim", root, self.traces).reshape(-1, len(motions)), mode="r")
        self.flexible = np.linalg.inv(triangle)

    def _Amplitudes(self, forces: Array) -> Array:
        return self.flexible @ (self.flexible.T @ forces)

    def _Forces(self, vector: Array) -> Array:
        """R' K x (m,), without the round-off of A R."""
        return np.einsum("mnd,nd,n->m", self.pulls, self.contact.Displacement(vector), self.contact.weights)

    def Solve(self, Inverse: Callable[[Array], Array], load: Array) -> Array:
        """x (ndof,) of a load b (ndof,)."""
        c = self._Amplitudes(self.motions @ load)
        rest = Inverse(load - self.contact.Load(np.einsum("m,mnd->nd", c, self.pulls)))
        return rest + (c - self._Amplitudes(self._Forces(rest))) @ self.motions

    def Balance(self, vector: Array, load: Array) -> Array:
        """x (ndof,) of an iteration for a load b (ndof,), with R' K x = R' b; as it is if that holds nearly.

        To add a motion that is not needed would only add its round-off.
        """
        forces, wanted = self._Forces(vector), self.motions @ load
        missing, whole = (self.flexible.T @ part for part in (wanted - forces, wanted))
        if np.linalg.norm(missing) <= NEARLY * np.linalg.norm(whole):
            return vector
        return vector + (self.flexible @ missing) @ self.motions


def WithResultants(motions: Array, residual: Array, load: Array) -> Array:
    """A residual b - A u (ndof,) with the rigid motions' forces of b: those of A u are zero, and computed its round-off."""
    triangle = cast(Array, np.linalg.qr(motions.T, mode="r"))
    excess = motions @ (load - residual)
    return residual + np.linalg.solve(triangle, np.linalg.solve(triangle.T, excess)) @ motions
