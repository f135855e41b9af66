"""Newton's method with dense matrices, a reference for problems that an explicit iteration cannot solve.

With q = t + D u at the contact points and the pair u = U(q), t = t(q) of the law's graph, A u = f - T' W t is, with D moved to
the left side,

    R(q) = U(q) - u_D + S_D (t(q) - D U(q)) = 0,    S_D = T (A + T' W D T)^-1 T' W,  u_D the solution for t = D u,

and R is piecewise smooth.  Its derivative is inverted as it stands, steps are halved until |R| falls.
"""

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from ngdgc import ContactSolution
from ngdgc.mesh.facets import Csr
from ngdgc.contact.graph import ContactGraph

MAXITER = 80


def DenseNewton(disc, scale):
    """The ContactSolution of a Discretization; D = scale [stress/length].  Raises RuntimeError without convergence."""
    contact, lift = disc.contact, disc.prescribed
    points, dim = contact.normals.shape
    free = np.flatnonzero(np.array(list(disc.space.FreeDofs())))
    trace, load = contact.trace.tocsr(), (contact.trace.T @ sp.diags(np.repeat(contact.weights, dim))).tocsr()
    matrix = (Csr(disc.matrix) + scale * load @ trace).tocsr()
    inverse = splu(matrix[free][:, free].tocsc())

    def Response(vector):
        """u with (A + T' W D T) u = vector, the prescribed values included."""
        u = lift.copy()
        u[free] += inverse.solve((vector - matrix @ lift)[free])
        return u

    compliance = trace[:, free] @ inverse.solve(load[free].toarray())
    start, graph, unit = trace @ Response(disc.load), ContactGraph(contact, scale), np.eye(points * dim)

    def Residual(q):
        at = graph.At(q.reshape(points, dim))
        return (at.displacement - start.reshape(points, dim)).ravel() + compliance @ (2 * at.traction.ravel() - q), at

    q = scale * start
    residual, at = Residual(q)
    for _ in range(MAXITER):
        if np.abs(residual).max() <= 1e-13 * np.abs(at.displacement).max():
            vector = Response(disc.load - load @ (2 * at.traction.ravel() - q))
            return ContactSolution(disc, vector, at.traction)
        derivative = sp.block_diag(list(at.derivative)).toarray()
        # Where points outnumber traces t has a part that nothing determines: the step without it.
        step = np.linalg.lstsq((unit - derivative) / scale + compliance @ (2 * derivative - unit), -residual, rcond=1e-12)[0]
        for damping in 0.5 ** np.arange(11):
            tried = Residual(q + damping * step)
            if np.linalg.norm(tried[0]) < np.linalg.norm(residual):
                break
        q, (residual, at) = q + damping * step, tried
    raise RuntimeError(f"no convergence: {np.abs(residual).max():g}")


N, DIM = 12, 2


class Dense:
    """S_D as a matrix (n d, n d), a diagonal D, and a count of its products."""

    def __init__(self, matrix):
        self.matrix, self.count, self.stiffness = matrix, 0, np.zeros(len(matrix))

    def Product(self, s):
        self.count += 1
        return (self.matrix @ s.ravel()).reshape(s.shape)

    def Restoring(self, u):
        return self.stiffness.reshape(u.shape) * u


def Compliance(seed=0, rank=None):
    """A random symmetric S >= 0 that decays like the one of a body."""
    vectors = np.linalg.qr(np.random.default_rng(seed).standard_normal((N * DIM, N * DIM)))[0]
    values = 1 / np.arange(1, N * DIM + 1)
    values[rank or N * DIM:] = 0
    return vectors * values @ vectors.T
