"""Conjugate gradients with two levels of PETSc's: Gauss-Seidel over elements, and continuous functions of order 1 by GAMG."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..contracts import Array
from ..exceptions import ProblemError
from .local import LocalMesh
from .petsc import Petsc

LIKEFACTORS = 1e-11     # relative residual of solutions that take the place of a factorisation's
MAXITER = 500
# Smoothed aggregation; every level is smoothed by Chebyshev's polynomials of degree 2.
COARSE = {"pc_gamg_agg_nsmooths": 1, "mg_levels_ksp_type": "chebyshev", "mg_levels_pc_type": "jacobi",
          "mg_levels_ksp_max_it": 2}


class CycleInverse:
    """A^-1 of PETSc's matrix, which keeps `contracts.InexactInverse` for vectors of the own elements.

    embedding : E, PETSc's matrix;  motions : rigid motions of continuous functions, PETSc's null space
    """

    def __init__(self, matrix: Any, embedding: Any, motions: Any) -> None:
        PETSc = Petsc()
        coarse = matrix.PtAP(embedding)
        coarse.setNearNullSpace(motions)
        blocks = matrix.convert("baij", PETSc.Mat())
        self.iterations, self._ksp = 0, PETSc.KSP().create(matrix.getComm())
        self._ksp.setType("cg")
        self._ksp.setOperators(blocks)
        pc = self._ksp.getPC()
        pc.setType("mg")
        pc.setMGLevels(2)
        pc.setMGInterpolation(1, embedding)
        smoother, inner = pc.getMGSmoother(1), pc.getMGCoarseSolve()
        smoother.setOperators(blocks)
        smoother.setType("richardson")
        smoother.setTolerances(max_it=1)
        smoother.setNormType(PETSc.KSP.NormType.NONE)
        smoother.getPC().setType("sor")
        inner.setOperators(coarse)
        inner.setType("preonly")
        inner.getPC().setType("gamg")
        options, prefix = PETSc.Options(), "ngdgc_"
        for name, value in COARSE.items():
            options[prefix + name] = value
        inner.setOptionsPrefix(prefix)
        inner.setFromOptions()
        self._ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
        self._ksp.setUp()
        self._load, self._solution = blocks.createVecs("left"), blocks.createVecs("right")

    def Solve(self, load: Array, *, tol: float = LIKEFACTORS, start: Array | None = None) -> Array:
        """A^-1 load to a relative residual, from a start; ProblemError on all ranks where that is not reached."""
        self._load.setArray(load)
        self._solution.setArray(np.zeros_like(load) if start is None else start)
        self._ksp.setInitialGuessNonzero(start is not None)
        self._ksp.setTolerances(rtol=tol, atol=0, max_it=MAXITER)
        self._ksp.solve(self._load, self._solution)
        self.iterations += self._ksp.getIterationNumber()
        if self._ksp.getConvergedReason() < 0:
            raise ProblemError(f"conjugate gradients on {self._ksp.getComm().size} ranks did not come to a relative "
                               f"residual of {tol:.1e} in {MAXITER} steps; likely causes are a nearly incompressible material "
                               "or distorted elements; take another mesh, or one machine")
        return self._solution.getArray().copy()


class FactorsInverse:
    """A^-1 of PETSc's symmetric matrix by the factors of MUMPS, for vectors of the own entries."""

    def __init__(self, matrix: Any) -> None:
        PETSc = Petsc()
        matrix.setOption(PETSc.Mat.Option.SPD, True)
        self._ksp = PETSc.KSP().create(matrix.getComm())
        self._ksp.setOperators(matrix)
        self._ksp.setType("preonly")
        self._ksp.getPC().setType("cholesky")
        self._ksp.getPC().setFactorSolverType("mumps")
        self._ksp.setUp()
        self._load, self._solution = matrix.createVecs("left"), matrix.createVecs("right")

    def Solve(self, load: Array) -> Array:
        self._load.setArray(load)
        self._ksp.solve(self._load, self._solution)
        return self._solution.getArray().copy()


def NearNullSpace(local: LocalMesh) -> Any:
    """PETSc's null space of the rigid motions of continuous functions of order 1."""
    PETSc = Petsc()
    points = PETSc.Vec().createWithArray(local.points[local.ownvertices].ravel().copy(), bsize=local.dim, comm=local.comm)
    return PETSc.NullSpace().createRigidBody(points)
