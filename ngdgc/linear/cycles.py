"""Symmetric cycles of smoothers and corrections, of which the preconditioners consist."""

from __future__ import annotations

from itertools import chain, pairwise
from typing import Any

import numpy as np
from ngsolve import VOL, BaseMatrix, BaseVector, CreateVVector, FESpace

from ..contracts import Preconditioner
from ..mesh.facets import Csr
from ..tools import sparse as sp


def Corners(space: FESpace) -> tuple[np.ndarray, np.ndarray]:
    """(element, dof) of all dofs of all elements of a space, sorted, two arrays."""
    dofs = [element.dofs for element in space.Elements(VOL)]
    elements = np.repeat(np.arange(len(dofs)), [len(row) for row in dofs])
    keys = np.sort(elements * space.ndof + np.fromiter(chain.from_iterable(dofs), dtype=np.int64, count=len(elements)))
    return keys // space.ndof, keys % space.ndof


def Groups(keys: np.ndarray, values: np.ndarray) -> list[list[int]]:
    """Lists of the values with the same key, by increasing key: the blocks of a block smoother."""
    order = np.argsort(keys, kind="stable")
    bounds = np.flatnonzero(np.diff(keys[order], prepend=-1, append=-1)).tolist()
    ordered = values[order].tolist()
    return [ordered[a:b] for a, b in pairwise(bounds)]


def Entries(operator: BaseMatrix) -> sp.csr_matrix:
    """A scipy copy of an NGSolve matrix between spaces without what is round-off, CSR."""
    matrix = Csr(operator)
    matrix.data[np.abs(matrix.data) <= 1e-12 * np.abs(matrix.data).max()] = 0
    matrix.eliminate_zeros()
    return matrix


def Galerkin(matrix: sp.csr_matrix, embedding: sp.csr_matrix) -> sp.csr_matrix:
    """E' A E without the unsymmetry of round-off, scipy CSR."""
    product = (embedding.T @ (matrix @ embedding)).tocsr()
    return (product + product.T) / 2


class Correction:
    """x += E C E' (b - A x), a step of a cycle for NGSolve's A.

    embedding : E, scipy;  coarse : symmetric C, with Mult(b, x)
    """

    def __init__(self, matrix: BaseMatrix, embedding: sp.csr_matrix, coarse: Preconditioner) -> None:
        self.matrix, self.coarse = matrix, coarse
        # As they are: to make NGSolve's matrices of them takes as long as some cycles.
        self.embedding, self.restriction = embedding, embedding.T.tocsr()
        self.rest = matrix.CreateColVector()
        self.source, self.target = (CreateVVector(embedding.shape[1]) for _ in range(2))

    def Smooth(self, x: BaseVector, b: BaseVector) -> None:
        self.rest.data = b - self.matrix * x
        self.source.FV().NumPy()[:] = self.restriction @ self.rest.FV().NumPy()
        self.coarse.Mult(self.source, self.target)
        x.FV().NumPy()[:] += self.embedding @ self.target.FV().NumPy()

    SmoothBack = Smooth


class Cycle:
    """x = P b: all steps from zero, then all but the last backwards; P is symmetric.

    steps : block smoothers of NGSolve and `Correction`s, with Smooth(x, b) and its adjoint SmoothBack(x, b)
    """

    def __init__(self, *steps: Any) -> None:
        self.steps = steps

    def Mult(self, b: BaseVector, x: BaseVector) -> None:
        x[:] = 0
        for step in self.steps:
            step.Smooth(x, b)
        for step in self.steps[-2::-1]:
            step.SmoothBack(x, b)
