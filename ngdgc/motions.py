"""Rigid motions that nothing but contact resists, treated exactly: on a soft foundation they are large, and all else is small.

With R the coefficients of such motions A R = 0, so that K = A + T' W D T has the energy R' K R = (T R)' W D (T R) for them,
which may be less than the round-off of A.  K x = b is solved as x = R c + y,

    (R' K R) c = R' b,    K y = b - T' W D T R c,    R' K y = 0,

where no rigid motion is left in y: forces and moments of contact balance the loads to round-off however soft D is.
"""

import numpy as np
from ngsolve import CF

from .facets import Csr, Projected, RigidMotions, RigidMotionsAt

NULL = 1e-11        # A R in units of what its terms are, that is round-off


def FreeMotions(disc):
    """Coefficients (m, ndof) of a basis of the rigid motions that A does not resist, of a body of one part.

    With several parts or forms that were added there is none: (0, ndof).
    """
    if disc.added.matrix is not None or disc.facets.component.max() > 0:
        return np.empty((0, disc.space.ndof))
    centre = disc.mesh.ngmesh.Coordinates()[:, :disc.mesh.dim].mean(axis=0)
    shifts = RigidMotionsAt(centre[None])[:, 0]
    motions = np.array([Projected(disc.space, motion - CF(tuple(shift)) if number >= disc.mesh.dim else motion)
                        for number, (motion, shift) in enumerate(zip(RigidMotions(disc.mesh.dim), shifts))])
    matrix, fixed = Csr(disc.matrix), ~np.array(disc.space.FreeDofs(), dtype=bool)
    terms = matrix.diagonal()[:, None] * motions.T
    terms[fixed] = 0
    motions = motions.T / (np.linalg.norm(terms, axis=0))
    resisted = matrix @ motions
    resisted[fixed] = motions[fixed] * np.abs(matrix.diagonal()).max()
    _, sizes, combinations = np.linalg.svd(resisted, full_matrices=False)
    return (motions @ combinations[sizes <= NULL].T).T


class Deflation:
    """The solution of K x = b with rigid motions (m, ndof) of a Discretization treated exactly; D (n, d, d)."""

    def __init__(self, motions, contact, stiffness):
        self.motions, self.contact = motions, contact
        self.traces = np.array([contact.Displacement(motion) for motion in motions])
        values, vectors = np.linalg.eigh(stiffness)
        root = np.sqrt(np.maximum(values, 0) * contact.weights[:, None])[:, :, None] * np.swapaxes(vectors, 1, 2)
        self.pulls = np.einsum("nij,mnj->mni", stiffness, self.traces)
        # R' K R = B' B: what is stiff in one direction hides nothing that is soft in another.
        self.triangle = np.linalg.qr(np.einsum("nij,mnj->nim", root, self.traces).reshape(-1, len(motions)), mode="r")

    def _Amplitudes(self, forces):
        return np.linalg.solve(self.triangle, np.linalg.solve(self.triangle.T, forces))

    def Solve(self, Inverse, load):
        """x (ndof,) of a load b (ndof,)."""
        c = self._Amplitudes(self.motions @ load)
        rest = Inverse(load - self.contact.Load(np.einsum("m,mnd->nd", c, self.pulls)))
        forces = np.einsum("mnd,nd,n->m", self.pulls, self.contact.Displacement(rest), self.contact.weights)
        return rest + (c - self._Amplitudes(forces)) @ self.motions
