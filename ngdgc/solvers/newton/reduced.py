"""What remembered products tell about the compliance operator, and Newton's method on that at no cost.

S_D is known on the span of the vectors s whose products have been paid for.  On what is orthogonal to them, in L2(Gamma_C), its
blocks B at the points stand in:

    S_V = B + (S_D - B) V V',    V an orthonormal basis of the span, V' its adjoint in L2(Gamma_C).

Equations with S_V instead of S_D are small.  So the contact problem with S_V can be solved with all its changes of zones, and
one application of the inverse tells how much of that holds with S_D; the product is remembered, and the next S_V better.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...contact.graph import ContactGraph, GraphPoint
from ...contracts import Array
from ...discrete.response import Apply
from ...tools.parallel import Batched
from .pointwise import PointwiseEquation
from .recycling import Recycled
from .stiffened import NewtonState

NEW = 1e-10         # part of a vector that must be left after orthogonalisation
STEPS = 10          # of Newton's method with S_V
HALVINGS = 5        # of one of them
ENOUGH = 1e-12      # decrease of the merit function with S_V that ends them
DECREASE = 1e-4     # relative decrease that a full step must bring


class ReducedResponse:
    """S_V of the pairs that a `recycling.Recycled` remembers; blocks B (n, d, d) [length/stress]."""

    @Batched
    def __init__(self, recycled: Recycled, blocks: Array) -> None:
        self.blocks, self.restoring = blocks, recycled.response.Restoring
        n, dim = blocks.shape[:2]
        root = np.repeat(recycled.root.ravel(), dim)
        self.left = self.right = np.empty((n * dim, 0))         # S_V = B + left right'
        if recycled.tractions:
            s, images = recycled.Pairs()
            rest = images - np.einsum("nij,knj->kni", blocks, s)
            vectors, sizes, combination = np.linalg.svd(root[:, None] * s.reshape(len(s), -1).T, full_matrices=False)
            kept = sizes > NEW * sizes[0]
            self.right = root[:, None] * vectors[:, kept]
            self.left = rest.reshape(len(s), -1).T @ (combination[kept].T / sizes[kept])

    def Product(self, s: Array) -> Array:
        """S_V s, (n, d) -> (n, d)."""
        return Apply(self.blocks, s) + (self.left @ (self.right.T @ s.ravel())).reshape(s.shape)

    @Batched
    def Solve(self, P: Array, b: Array) -> Array:
        """(S_V - B) s with s + P (S_V - B) s = b, for blocks P (n, d, d) and b (n, d)."""
        weighted = np.einsum("nij,njk->nik", P, self.left.reshape(*b.shape, -1)).reshape(self.left.shape)
        small = np.eye(self.left.shape[1]) + self.right.T @ weighted
        return (self.left @ np.linalg.lstsq(small, self.right.T @ b.ravel(), rcond=None)[0]).reshape(b.shape)

    def Minimise(self, graph: ContactGraph, Equation: Callable[[GraphPoint], PointwiseEquation],
                 Merit: Callable[[Array], float], state: NewtonState, q: Array) -> Array:
        """q (n, d) of a point of the graph where the merit of F with S_V instead of S_D is least or small, from q on.

        Equation : GraphPoint -> `PointwiseEquation`;  Merit : F (n, d) -> number;  state : a `stiffened.NewtonState`, the
        changes from which are subject to S_V; its merit is the scale of the others
        """
        u, t = state.equilibrium.displacement, state.equilibrium.traction

        def Evaluate(q: Array) -> tuple[GraphPoint, Array, float]:
            point = graph.At(q)
            change = point.displacement - u
            F = change + self.Product(point.traction - t - self.restoring(change))
            return point, F, Merit(F)

        point, F, merit = Evaluate(q)
        for _ in range(STEPS):
            if merit <= ENOUGH * state.merit:
                break
            equation = Equation(point)
            step = equation.Step(F, self.Solve(equation.P, -Apply(equation.P, F)))
            trials = (Evaluate(point.q + step / 2 ** halvings) for halvings in range(HALVINGS + 1))
            better = next((trial for trial in trials if trial[2] <= (1 - DECREASE) * merit), None)
            if better is None:
                break
            point, F, merit = better
        return point.q
