"""A path that leads to a solution, for bodies that are held and few contact points, where nothing else does.

With S the compliance operator as a dense matrix, b = 1/gamma the compliance of every point taken alone, and the graph of the
law with that gamma,

    H(q, s) = U(q) - u_f + ((1 - s) b + s S) t(q) = 0,    0 <= s <= 1.

At s = 0 the points do not feel each other: q = gamma u_f, nothing else.  For continuous laws all solutions are bounded, since
(t, b t) and (t, S t) are positive and U.t is bounded below, and H is piecewise smooth: so the solutions that hang together with
that of s = 0 are a path, which has no other end than a solution at s = 1 (the degree of Brouwer; exceptions have measure zero).
It may turn back in s.  What keeps its direction there, and where it passes from one smooth piece of H to the next, is the sign
of the determinant of the derivative with the tangent as its last row (Allgower, Georg 1990, chapters 2 and 12).
"""

from __future__ import annotations


import numpy as np

from ...contact.graph import ContactGraph, GraphPoint
from ...contracts import Array
from ...discrete.response import ContactResponse
from ...tools.parallel import Batched

FEW = 128           # components of the traction up to which a path is followed
LENGTH = 1e-2       # first step, in units of the size of q and of s
SHORTEST = 1e-10    # that tells a kink of the path
LONGEST = 0.2       # step, relative to how far the path has come
CORRECTIONS = 6     # Newton steps back to the path
ACCURATE = 1e-11    # H there, relative to displacements
STRAIGHT = 0.5      # cosine of the angle between tangents of one step
STEPS = 1000        # of one path


class Path:
    """The path of a body that is held, from s = 0 on; S takes as many applications of the inverse as t has components.

    response : `ContactResponse` with D = 0;  scale : gamma (n,) [stress/length]

    Attributes
    ----------
    s : how far it has come, 1 at a solution
    """

    def __init__(self, response: ContactResponse, scale: Array) -> None:
        contact = self.contact = response.contact
        shape = contact.normals.shape
        units = np.eye(contact.normals.size).reshape(-1, *shape)
        self.S = np.array([response.Product(unit).ravel() for unit in units]).T
        self.scale = np.repeat(scale, shape[1])
        self.graph = ContactGraph(contact, scale)
        rest = np.zeros(shape)
        free = response.Meet(rest, rest)[0].displacement
        self.free, self.start = free.ravel(), contact.SinceOrigin(free).ravel()
        self.size = max(np.abs(self.free).max(), np.abs(contact.gap).max()) or 1.0

    @Batched
    def Follow(self, steps: int = STEPS) -> GraphPoint | None:
        """The `graph.GraphPoint` at s = 1, or None if it is not reached in these steps."""
        z: Array = np.append(self.start / self.size, 0.0)
        length = LENGTH
        tangent = _Tangent(self._H(z)[1])
        for _ in range(steps):
            self.s = z[-1]
            last = z[-1] + length * tangent[-1] >= 1
            ahead = z + ((1 - z[-1]) / tangent[-1] if last else length) * tangent
            found = self._Correct(ahead, _Level(len(z)) if last else tangent)
            turned = None if found is None else _Tangent(self._H(found)[1])
            if (found is not None and turned is not None and np.linalg.norm(found - ahead) <= length
                    and turned @ tangent > STRAIGHT):
                if last:
                    return self._Point(found)
                if found[-1] < 1:
                    z, tangent, length = found, turned, min(2 * length, LONGEST * float(np.linalg.norm(found)))
                else:
                    length /= 4
            elif length > SHORTEST:
                length /= 4
            else:
                # A kink: the direction on the piece beyond is that of the same orientation.
                z = z + length * tangent
                tangent, length = _Tangent(self._H(z + length * tangent)[1]), 1e3 * SHORTEST
        return None

    def _Point(self, z: Array) -> GraphPoint:
        return self.graph.At((self.scale * self.size * z[:-1]).reshape(self.contact.normals.shape))

    def _H(self, z: Array) -> tuple[Array, Array]:
        """(H, [dH/dv, dH/ds]) in units of `size` at z = (v, s), q = gamma size v."""
        s, point = z[-1], self._Point(z)
        from scipy.linalg import block_diag     # slow to import

        slope, t = block_diag(*point.derivative), point.traction.ravel()
        own, other = t / self.scale, self.S @ t
        H = point.displacement.ravel() - self.free + (1 - s) * own + s * other
        operator = np.diag((1 - s) / self.scale) + s * self.S
        dq = (np.eye(len(t)) - slope) / self.scale[:, None] + operator @ slope
        return H / self.size, np.column_stack([dq * self.scale, (other - own) / self.size])

    def _Correct(self, z: Array, normal: Array) -> Array | None:
        """The point of the path in the plane through z, by Newton's method, or None."""
        for _ in range(CORRECTIONS):
            H, J = self._H(z)
            if np.abs(H).max() <= ACCURATE:
                return z
            try:
                z = z - np.linalg.solve(np.vstack([J, normal]), np.append(H, 0))
            except np.linalg.LinAlgError:
                break
            if not np.all(np.isfinite(z)):
                break
        return None


def _Level(size: int) -> Array:
    """The normal of planes on which s is constant."""
    return np.append(np.zeros(size - 1), 1.0)


def _Tangent(J: Array) -> Array:
    """The unit vector v with J v = 0 for which the determinant of J with v as its last row is positive."""
    v = np.linalg.svd(J)[2][-1]
    return v if np.linalg.slogdet(np.vstack([J, v]))[0] > 0 else -v
