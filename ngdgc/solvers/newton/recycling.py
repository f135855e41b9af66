"""Generalised conjugate residuals that remember every product with the compliance operator.

The equations M s = b of successive Newton steps share S_D: M s = s + P (S_D - B) s with blocks P and B at the points.  A
product y = S_D s, once paid for by an application of an inverse, gives M s for every M; so each new equation is first solved
in the least squares sense on all vectors s of the past, at no cost, and only what is left asks for more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy

import numpy as np

from ...contracts import Array
from ...discrete.response import ContactResponse
from ...tools.parallel import Batched

MEMORY = 400    # pairs kept: the singular value decomposition of more costs as much as the products that it saves


class Recycled:
    """Pairs (s, S_D s) of a compliance operator, the last MEMORY of them, and the equations solved with them.

    response : a `ContactResponse`, S_D;  weights (n,) of the contact points

    Attributes
    ----------
    tractions, images : lists of the pairs for D = 0, arrays (n, d)
    """

    def __init__(self, response: ContactResponse, weights: Array) -> None:
        self.response = response
        self.root = np.sqrt(weights)[:, None]
        self.tractions: list[Array] = []
        self.images: list[Array] = []

    def With(self, response: ContactResponse) -> Recycled:
        """The same pairs for another D, or another right-hand side."""
        other = copy(self)
        other.response = response
        return other

    def Remember(self, s: Array, image: Array) -> None:
        """Use the pair (s, S_D s) in later equations."""
        length = np.linalg.norm(self.root * s)
        if length > 0:
            # What does not depend on D: S_D s is also the response without it to s - D S_D s.
            self.tractions = self.tractions[1 - MEMORY:] + [(s - self.response.Restoring(image)) / length]
            self.images = self.images[1 - MEMORY:] + [image / length]

    def Pairs(self) -> tuple[Array, Array]:
        """All (s, S_D s) for the present D, as arrays (m, n, d)."""
        return np.array([t + self.response.Restoring(y) for t, y in zip(self.tractions, self.images)]), np.array(self.images)

    @Batched
    def Solve(self, Local: Callable[[Array, Array], Array], b: Array, *, tol: float, maxiter: int) -> tuple[Array, Array]:
        """(s, S_D s) with |b - M s| <= tol |b| in L2(Gamma_C), M s = s + Local(S_D s, s); at most maxiter new applications.

        Stops early, with the best s, when a new vector brings nothing new: then M is singular on what is left.
        """
        basis = _Basis(b.size)
        goal = tol * np.linalg.norm(self.root * b)
        if self.tractions:
            s, y = self.Pairs()
            basis.AddMany([(self.root * (si + Local(yi, si))).ravel() for si, yi in zip(s, y)],
                          s.reshape(len(s), -1), y.reshape(len(y), -1))
        residual = (self.root * b).ravel()
        coefficients = basis.directions.T @ residual
        residual = residual - basis.directions @ coefficients
        s, y = basis.arguments @ coefficients, basis.images @ coefficients
        for _ in range(maxiter):
            size = np.linalg.norm(residual)
            if size <= goal:
                break
            direction = (residual / size).reshape(b.shape) / self.root
            image = self.response.Product(direction)
            self.Remember(direction, image)
            if not basis.Add((self.root * (direction + Local(image, direction))).ravel(), direction.ravel(), image.ravel()):
                break
            coefficient = basis.directions[:, -1] @ residual
            residual = residual - coefficient * basis.directions[:, -1]
            s, y = s + coefficient * basis.arguments[:, -1], y + coefficient * basis.images[:, -1]
        return s.reshape(b.shape), y.reshape(b.shape)


class _Basis:
    """Orthonormal directions M s with the arguments s and images S_D s they come from, as columns."""

    NEW = 1e-10     # part of a vector that must be left after orthogonalisation

    def __init__(self, size: int) -> None:
        self.directions, self.arguments, self.images = (np.empty((size, 0)) for _ in range(3))

    def AddMany(self, directions: Sequence[Array], arguments: Array, images: Array) -> None:
        columns = np.array(directions).T
        sizes = np.linalg.norm(columns, axis=0)
        useful = sizes > 0
        left, singular, right = np.linalg.svd(columns[:, useful] / sizes[useful], full_matrices=False)
        kept = singular > self.NEW * singular[0] if len(singular) else singular > 0
        combination = right[kept].T / singular[kept] / sizes[useful][:, None]
        self.directions = left[:, kept]
        self.arguments, self.images = arguments[useful].T @ combination, images[useful].T @ combination

    def Add(self, direction: Array, argument: Array, image: Array) -> bool:
        before = np.linalg.norm(direction)
        for _ in range(2):
            part = self.directions.T @ direction
            direction = direction - self.directions @ part
            argument, image = argument - self.arguments @ part, image - self.images @ part
        size = np.linalg.norm(direction)
        if not size > self.NEW * before:
            return False
        self.directions = np.column_stack([self.directions, direction / size])
        self.arguments = np.column_stack([self.arguments, argument / size])
        self.images = np.column_stack([self.images, image / size])
        return True
