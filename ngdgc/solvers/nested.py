"""Nested iteration with Newton's method: the solver that needs no choices."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain
from typing import Any, cast

import numpy as np
from ngsolve import Mesh

from ..contact.boundary import ContactBoundary
from ..contracts import Array
from ..discrete.problem import DiscreteProblem
from ..exceptions import NotConvergedError, ProblemError, SolveInterrupted
from ..mesh.coarsening import CoarserMesh
from ..solution.history import Level, Prediction, Step
from ..solution.solution import ContactSolution
from ..tools.calls import ByKeyword
from .driver import CheckCallback, Current, SolutionOf
from .multistart import Starts
from .newton.paused import PausedNewton
from .newton.solver import SemismoothNewtonSolver

NEIGHBOURS = {2: 4, 3: 9}       # points from which values are carried over, by dimension
COARSEST = 20                   # contact points that need no prediction
STARTS, UNKNOWNS = 5, 300_000   # other starts than rest, and unknowns that are solved for with all of them together
PAIRS = 2_000_000               # distances along a curve that take less time than it takes to import a tree to search
MANY = 256                      # contact points on a curve that four times fewer predict well


@ByKeyword
@dataclass(frozen=True, kw_only=True)
class NestedNewtonSolver:
    """`SemismoothNewtonSolver` on a sequence of meshes, from coarse to fine: the default that needs no choices.

    All that a mesh hands on is displacement and traction along Gamma_C; they are the start on the next one and tell which
    stiffness of the foundation goes into its matrix.  `solution.levels` lists what every mesh has cost.

    tol : of the law residual (`graph.Distance`), no unit
    coarser : meshes of the same body with the same region names, coarse ones first; None: made by `coarsening.CoarserMesh`
        until it has no way or at most 20 contact points are left; (): no coarser mesh

    >>> NestedNewtonSolver(tol=1e-8)
    NestedNewtonSolver(tol=1e-08, coarser=None)
    """

    tol: float = 1e-10
    coarser: Sequence[Mesh] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "tol", SemismoothNewtonSolver(tol=self.tol).tol)
        if self.coarser is not None:
            if not isinstance(self.coarser, Sequence) or not all(isinstance(mesh, Mesh) for mesh in self.coarser):
                raise ProblemError(f"coarser is {self.coarser!r}; give a sequence of ngsolve.Mesh, coarse ones first, or None")
            object.__setattr__(self, "coarser", tuple(self.coarser))

    def Solve(self, disc: DiscreteProblem, *, callback: Callable[[Step], object] | None = None) -> ContactSolution:
        """Return the ContactSolution of a Discretization; `callback(step)` is called with every `Step` on its own mesh, and
        before, if there is such a method, as `output.Progress` has it, `callback.Predict(step)` with every `Prediction`.

        Raises NotConvergedError, with history and likely cause, if Newton's method fails from the prediction, from rest, under
        load continuation and from random starts (`multistart.Starts`); SolveInterrupted, with the last iterate, on Ctrl-C on
        the last mesh.
        """
        solver = SemismoothNewtonSolver(tol=self.tol)
        CheckCallback(callback)
        with Current(disc) as disc:
            levels, start = self._Predict(solver, disc, callback)
            found, seconds = FromPrediction(solver, disc, start, callback)
            return SolutionOf(found.disc, found.vector, found.traction, history=found.history, solver=repr(self),
                              levels=[*levels, LevelOf(disc, found.history, seconds, True)])

    def _Predict(self, solver: SemismoothNewtonSolver, disc: DiscreteProblem,
                 callback: Callable[[Step], object] | None) -> tuple[list[Level], tuple[Array, Array] | None]:
        """(levels, start): what the coarser meshes took, and what they predict for the Discretization, or None."""
        levels, start, meshes = [], None, [*self._Coarse(disc), disc]
        coarse: Any
        solution: Any
        while len(meshes) > 1:
            coarse, begin = meshes.pop(0), time.perf_counter()
            try:
                tell = getattr(callback, "Predict", None)
                show = tell and partial(_Show, tell, coarse.space.ndof)
                solution = solver.Solve(coarse, start=start, callback=show)
                history, start = solution.history, Transfer(solution, meshes[0].contact)
            except (NotConvergedError, ProblemError) as error:
                # It was to predict, no more: the next mesh starts from rest.
                start, history = None, getattr(error, "history", ())
            except SolveInterrupted as stop:
                raise KeyboardInterrupt from stop       # what a coarser mesh has says nothing of the last one
            levels.append(LevelOf(coarse, history, time.perf_counter() - begin, start is not None))
            coarse = solution = None    # with the factors: the next ones need the memory
        return levels, start

    def _Coarse(self, disc: DiscreteProblem) -> list[DiscreteProblem]:
        try:
            return _Coarse(disc, self.coarser)
        except ProblemError as error:
            raise error if self.coarser is None else ProblemError(f"coarser: {error}") from error


def FromPrediction(solver: SemismoothNewtonSolver | PausedNewton, disc: DiscreteProblem, prediction: tuple[Array, Array] | None,
                   callback: Callable[[Step], object] | None) -> tuple[ContactSolution, float]:
    """(solution, seconds) from the prediction, else from rest, else from other starts."""
    begin = time.perf_counter()
    failure: Any = None
    # What is tried depends on the problem, not on the time it takes: a busy machine gives the same answer.
    others = min(STARTS, UNKNOWNS // disc.unknowns)
    for start in chain([prediction, None] if prediction else [None], Starts(disc, others)):
        try:
            return solver.Solve(disc, start=start, callback=callback), time.perf_counter() - begin
        except NotConvergedError as error:
            # The one from rest tells most: others start where nobody would.
            failure = error if failure is None or start is None else failure
    raise failure


def _Show(Tell: Callable[[Prediction], object], unknowns: int, step: Step) -> None:
    Tell(Prediction(**vars(step), unknowns=unknowns))


def LevelOf(disc: DiscreteProblem, history: Sequence[Step], seconds: float, converged: bool) -> Level:
    """The Level of a Discretization."""
    return Level(disc.mesh.ne, disc.unknowns, len(disc.contact.weights), len(history), disc.solves, disc.cycles,
                 disc.factorisation, seconds, converged)


def _Coarse(disc: DiscreteProblem, meshes: Sequence[Mesh] | None) -> list[DiscreteProblem]:
    """Discretizations that predict, the coarsest first: on the meshes given, else on meshes made for the purpose.

    Where no mesh can be made, or the data cannot be evaluated on it, order 1 on the same mesh predicts for higher orders.
    """
    if disc.alone:
        return []
    if meshes is not None:
        return [Coarser(disc, mesh, disc.order) for mesh in meshes]
    mesh, points = disc.given, len(disc.contact.weights)
    found: list[DiscreteProblem] = []
    while points > COARSEST:
        # In 2D half as fine a mesh costs a fifth of the whole; in 3D one of a quarter would say little.
        mesh = CoarserMesh(mesh, 4 if mesh.dim == 2 and points >= MANY else 2)
        try:
            coarse = mesh and Coarser(disc, mesh, disc.order)
        except ProblemError:
            coarse = None
        if coarse is None or len(coarse.contact.weights) >= points:
            break
        found.insert(0, coarse)
        points = len(coarse.contact.weights)
    if not found and points > COARSEST and disc.order > 1:
        return [Coarser(disc, disc.given, 1)]
    return found


def Coarser(disc: DiscreteProblem, mesh: Mesh, order: int) -> DiscreteProblem:
    """The problem of a Discretization on another mesh or of another order, without the forms that were added: it predicts."""
    return DiscreteProblem(disc.problem, disc.method, mesh, order=order, assembly=disc.assembly)


def Transfer(coarse: ContactSolution, contact: ContactBoundary) -> tuple[Array, Array]:
    """Displacement and traction (n, d) at the points of a finer ContactBoundary, predicted from a coarse ContactSolution.

    Each foundation by itself: a linear function is fitted to the values at the nearest coarse points, near ones counting more.
    """
    old = coarse.disc.contact
    displacement, traction = np.empty_like(contact.normals), np.empty_like(contact.normals)
    values = np.concatenate([coarse.displacement - old.found, coarse.traction], axis=1)
    for source, target in ((before.points, after.points) for before, after in zip(old.parts, contact.parts)):
        fitted = LocalFit(old.coordinates[source], values[source], contact.coordinates[target], contact.outward[target])
        displacement[target], traction[target] = np.split(fitted, 2, axis=1)
    return displacement, traction


def Nearest(points: Array, targets: Array, count: int) -> tuple[Array, Array]:
    """Distances (m, count) of the points (n, d) that are nearest to targets (m, d), and their numbers, nearest ones first."""
    # Of neighbours at one distance, of which surfaces have many, the tree takes others.
    if points.shape[1] == 3 or len(points) * len(targets) > PAIRS:
        from scipy.spatial import cKDTree  # slow to import

        distances, nearest = cKDTree(points).query(targets, k=np.arange(1, count + 1))
        return distances, nearest
    squares = ((targets[:, None] - points) ** 2).sum(axis=2)
    nearest = np.argpartition(squares, count - 1, axis=1)[:, :count]
    row = np.arange(len(targets))[:, None]
    nearest = nearest[row, np.argsort(squares[row, nearest], axis=1, kind="stable")]
    return np.sqrt(squares[row, nearest]), cast(Array, nearest)


def LocalFit(points: Array, values: Array, targets: Array, normals: Array) -> Array:
    """Values (m, c) at targets (m, d) on a surface with these normals, from values (n, c) at points (n, d)."""
    dim = points.shape[1]
    distances, nearest = Nearest(points, targets, min(NEIGHBOURS[dim], len(points)))
    size = distances.max(axis=1)
    size[size == 0] = 1       # where joints cross several points lie in one place
    offsets = (points[nearest] - targets[:, None]) / size[:, None, None]
    offsets -= np.einsum("mkd,md->mk", offsets, normals)[..., None] * normals[:, None]
    weights = 1 / ((distances / size[:, None]) ** 2 + 1e-4)
    model = np.concatenate([np.ones((*nearest.shape, 1)), offsets], axis=2)
    gram = np.einsum("mki,mk,mkj->mij", model, weights, model)
    # The slope across the surface is not determined, nor are those along it by points that lie on a line.
    gram[:, range(1, dim + 1), range(1, dim + 1)] += 1e-3 * gram[:, :1, 0]
    moments = np.einsum("mki,mk,mkc->mic", model, weights, values[nearest])
    return np.linalg.solve(gram, moments)[:, 0]
