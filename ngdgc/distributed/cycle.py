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
ENTRIES = 29            # where MUMPS tells how many its factors have
PREFIX = "ngdgc_"       # of the options of PETSc with which users choose another coarse solver
SWEEPS = {"down": "forward", "up": "backward"}      # before and after continuous functions: one the adjoint of the other
GAMG = {"pc_gamg_agg_nsmooths": 1, "mg_levels_ksp_type": "chebyshev", "mg_levels_pc_type": "jacobi", "mg_levels_ksp_max_it": 2}
# Unknowns of a vertex together, Gauss-Seidel that is symmetric.
HYPRE = {"pc_hypre_type": "boomeramg", "pc_hypre_boomeramg_strong_threshold": 0.5, "pc_hypre_boomeramg_nodal_coarsen": 6,
         "pc_hypre_boomeramg_vec_interp_variant": 3, "pc_hypre_boomeramg_coarsen_type": "HMIS",
         "pc_hypre_boomeramg_interp_type": "ext+i", "pc_hypre_boomeramg_relax_type_all": "symmetric-SOR/Jacobi"}


class CycleInverse:
    """A^-1 of PETSc's matrix, which keeps `contracts.InexactInverse` for vectors of the own elements.

    coarse : E' A E, PETSc's;  embedding : E, PETSc's
    """

    def __init__(self, matrix: Any, coarse: Any, embedding: Any) -> None:
        PETSc = Petsc()
        self.iterations, self._ksp = 0, PETSc.KSP().create(matrix.getComm())
        self._ksp.setType("cg")
        self._ksp.setOperators(matrix)
        self._ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
        pc, options = self._ksp.getPC(), PETSc.Options()
        pc.setType("mg")
        pc.setMGLevels(2)
        pc.setMGInterpolation(1, embedding)
        for smoother, (side, sweep) in zip((pc.getMGSmootherDown(1), pc.getMGSmootherUp(1)), SWEEPS.items()):
            smoother.setOperators(matrix)
            smoother.setType("richardson")
            smoother.setTolerances(max_it=1)
            smoother.setNormType(PETSc.KSP.NormType.NONE)
            smoother.setInitialGuessNonzero(side == "up")
            smoother.getPC().setType("sor")
            options[f"{PREFIX}{side}_pc_sor_local_{sweep}"] = True
            smoother.setOptionsPrefix(f"{PREFIX}{side}_")
            smoother.setFromOptions()
        inner = pc.getMGCoarseSolve()
        inner.setOperators(coarse)
        inner.setType("preonly")
        kind = options.getString(PREFIX + "pc_type", "gamg")
        inner.getPC().setType(kind)
        for name, value in {"gamg": GAMG, "hypre": HYPRE}.get(kind, {}).items():
            if not options.hasName(PREFIX + name):
                options[PREFIX + name] = value
        inner.setOptionsPrefix(PREFIX)
        inner.setFromOptions()
        self._ksp.setUp()
        self._load, self._solution = matrix.createVecs("left"), matrix.createVecs("right")

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

    @property
    def entries(self) -> int:
        """Of the factors, those of all ranks."""
        count = self._ksp.getPC().getFactorMatrix().getMumpsInfog(ENTRIES)
        return int(count if count >= 0 else -count * 1_000_000)     # in millions where they are many

    def Solve(self, load: Array) -> Array:
        self._load.setArray(load)
        self._ksp.solve(self._load, self._solution)
        return self._solution.getArray().copy()


def NearNullSpace(local: LocalMesh) -> Any:
    """PETSc's null space of the rigid motions of continuous functions of order 1."""
    PETSc = Petsc()
    points = PETSc.Vec().createWithArray(local.points[local.ownvertices].ravel().copy(), bsize=local.dim, comm=local.comm)
    return PETSc.NullSpace().createRigidBody(points)
