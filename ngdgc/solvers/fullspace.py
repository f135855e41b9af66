"""Newton's linear equations on the whole body at once, for an inverse that is itself an iteration.

With the displacement w and the shifted traction s unknown together,

    (A + T' W D T) w - T' W s = 0,        s + P (T w - B s) = b,

one generalised minimal residual iteration (Saad, Schultz 1986) takes the place of an inner iteration for every product with
S_D.  It is preconditioned by the V-cycle V of A + T' W D T: its residuals are V (T' W s - (A + T' W D T) w), and that of the
second equation with w corrected by it.
"""

import numpy as np

from ..facets import Threads
from ..parallel import Batched

WEIGHT = 20         # of the first residual, a norm over the whole body, of which only the part near Gamma_C matters
RESTART = 50        # vectors kept


class FullSpace:
    """The pair of equations for a `Compliance` whose inverse is an iteration; weights (n,) of the contact points.

    Attributes
    ----------
    iterations : V-cycles that the last solution took;  displacement : its w, (ndof,)
    """

    def __init__(self, compliance, weights):
        self.compliance, self.contact = compliance, compliance.contact
        self.root = np.sqrt(weights)[:, None]
        self.iterations, self.displacement = 0, None

    @Batched
    def Solve(self, Local, b, *, tol, maxiter):
        """(s, T w) with Local(T w, s) = P (T w - B s), to a preconditioned residual of tol, relative; at most maxiter steps."""
        ndof, contact = self.compliance.disc.space.ndof, self.contact
        if not np.any(b):
            self.iterations, self.displacement = 0, np.zeros(ndof)
            return np.zeros_like(b), np.zeros_like(b)
        reaction = self.compliance.Smooth(contact.Load(b))
        scale = WEIGHT * np.linalg.norm(self.root * b) / np.linalg.norm(reaction)

        def Operator(x):
            w, s = x[:ndof] / scale, x[ndof:].reshape(b.shape) / self.root
            change = self.compliance.Smooth(contact.Load(s), w)
            return np.concatenate([-scale * change, (self.root * (s + Local(contact.Displacement(w + change), s))).ravel()])

        right = np.concatenate([np.zeros(ndof), (self.root * b).ravel()])
        x, goal, self.iterations = np.zeros(len(right)), tol * np.linalg.norm(right), 1
        with Threads(self.compliance.disc.mesh):
            while self.iterations < maxiter:
                residual = right - Operator(x) if np.any(x) else right
                if np.linalg.norm(residual) <= goal:
                    break
                change, steps = Gmres(Operator, residual, goal, min(RESTART, maxiter))
                x, self.iterations = x + change, self.iterations + steps
        self.displacement = x[:ndof] / scale
        return x[ndof:].reshape(b.shape) / self.root, contact.Displacement(self.displacement)


def Gmres(operator, right, goal, steps):
    """(x, steps taken) with |right - operator(x)| <= goal, or the best after so many steps; right is not zero."""
    size = np.linalg.norm(right)
    basis, columns = np.empty((steps + 1, len(right))), np.zeros((steps + 1, steps))
    basis[0], first = right / size, np.append(size, np.zeros(steps))
    for k in range(steps):
        vector = operator(basis[k])
        for _ in range(2):
            part = basis[:k + 1] @ vector
            columns[:k + 1, k] += part
            vector = vector - part @ basis[:k + 1]
        columns[k + 1, k] = np.linalg.norm(vector)
        system = columns[:k + 2, :k + 1]
        coefficients = np.linalg.lstsq(system, first[:k + 2], rcond=None)[0]
        if np.linalg.norm(first[:k + 2] - system @ coefficients) <= goal or columns[k + 1, k] <= 1e-14 * size:
            break
        basis[k + 1] = vector / columns[k + 1, k]
    return coefficients @ basis[:k + 1], k + 1
