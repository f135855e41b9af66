"""A path that leads to a solution, for bodies that are held and few contact points, where nothing else does.

With S the compliance operator as a dense matrix, b = 1/gamma the compliance of every point taken alone, and the graph of the law
with that gamma,

    H(q, s) = U(q) - u_f + ((1 - s) b + s S) t(q) = 0,    0 <= s <= 1.

At s = 0 the points do not feel each other: q = gamma u_f, nothing else.  For continuous laws solutions are bounded for all s, since
(t, b t) and (t, S t) are positive and U.t is bounded below, and H is piecewise smooth: so the solutions that hang together with
that of s = 0 are a path, which has no other end than a solution at s = 1 (the degree of Brouwer; exceptions have measure zero).
It may turn back in s.  What keeps its direction there, and where it passes from one smooth piece of H to the next, is the sign of
the determinant of the derivative with the tangent as its last row (Allgower, Georg 1990, chapters 2 and 12).
"""

import time

import numpy as np

from ..graph import ContactGraph

FEW = 128           # components of the traction up to which a path is followed
LENGTH = 1e-2       # first step, in units of the size of q and of s
SHORTEST = 1e-10    # that tells a kink of the path
LONGEST = 0.1
CORRECTIONS = 6     # Newton steps back to the path
ACCURATE = 1e-11    # H there, relative to displacements
STRAIGHT = 0.5      # cosine of the angle between tangents of one step
SECONDS = 20.0      # for one path


class Path:
    """The path of a Discretization whose body is held, from s = 0 on; S by as many applications of the inverse as t has components.

    Attributes
    ----------
    s : how far it has come, 1 at a solution
    """

    def __init__(self, compliance, scale):
        contact = self.contact = compliance.contact
        shape = contact.normals.shape
        units = np.eye(contact.normals.size).reshape(-1, *shape)
        self.S = np.array([compliance.Response(unit).ravel() for unit in units]).T
        # The largest block of the diagonal: with a smaller one the law may be steeper than the graph allows.
        self.scale = scale
        self.compliance = np.repeat(1 / scale, shape[1])
        self.graph = ContactGraph(contact, scale)
        rest = np.zeros(shape)
        self.free = compliance.Meet(rest, rest)[0].displacement.ravel()
        self.size = max(np.abs(self.free).max(), np.abs(contact.gap).max()) or 1.0

    def _H(self, z):
        """(H, [dH/dq, dH/ds]) at z = (q/gamma/size, s), in units of size."""
        v, s = z[:-1], z[-1]
        n, dim = self.contact.normals.shape
        gamma = np.repeat(self.scale, dim)
        point = self.graph.At((v * self.size * gamma).reshape(n, dim))
        slope = np.zeros((n * dim, n * dim))
        for i in range(n):
            here = slice(i * dim, (i + 1) * dim)
            slope[here, here] = point.derivative[i]
        t = point.traction.ravel()
        own, other = self.compliance * t, self.S @ t
        H = point.displacement.ravel() - self.free + (1 - s) * own + s * other
        operator = (1 - s) * np.diag(self.compliance) + s * self.S
        dq = (np.eye(n * dim) - slope) / gamma[:, None] + operator @ slope
        return H / self.size, np.column_stack([dq * gamma, (other - own) / self.size])

    def Follow(self):
        """q (n, d) at s = 1, or None if the path could not be followed in SECONDS."""
        end = time.perf_counter() + SECONDS
        z = np.append(self.free / self.size, 0.0)
        tangent, length, self.s = _Tangent(self._H(z)[1]), LENGTH, 0.0
        while time.perf_counter() < end:
            ahead = z + length * tangent
            if ahead[-1] >= 1:
                ahead = z + (1 - z[-1]) / tangent[-1] * tangent
                found = self._Correct(ahead, np.append(np.zeros(len(z) - 1), 1.0))
            else:
                found = self._Correct(ahead, tangent)
            turned = None if found is None else _Tangent(self._H(found)[1])
            if turned is not None and np.linalg.norm(found - ahead) <= length and turned @ tangent > STRAIGHT:
                z, tangent, self.s = found, turned, found[-1]
                if self.s >= 1 - 1e-14:
                    n, dim = self.contact.normals.shape
                    return (z[:-1] * self.size).reshape(n, dim) * self.scale[:, None]
                length = min(1.5 * length, LONGEST)
            elif length > SHORTEST:
                length /= 4
            else:
                # A kink: the tangent of the piece beyond, which the orientation tells.
                z = z + length * tangent
                tangent, length = _Tangent(self._H(z + length * tangent)[1]), 1e3 * SHORTEST
        return None

    def _Correct(self, z, normal):
        """The point of the path in the plane through z, by Newton's method, or None."""
        for _ in range(CORRECTIONS):
            H, J = self._H(z)
            if np.abs(H).max() <= ACCURATE:
                return z
            try:
                z = z - np.linalg.solve(np.vstack([J, normal]), np.append(H, 0))
            except np.linalg.LinAlgError:
                return None
            if not np.all(np.isfinite(z)):
                return None
        return None


def _Tangent(J):
    """The unit vector v with J v = 0 for which the determinant of J with v as its last row is positive."""
    _, _, vectors = np.linalg.svd(J)
    v = vectors[-1]
    sign, _ = np.linalg.slogdet(np.vstack([J, v]))
    return v if sign >= 0 else -v
