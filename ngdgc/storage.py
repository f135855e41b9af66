"""A solution on disk: mesh.vol.gz, fields.npz and solution.json in one folder; no pickle."""

import json
from pathlib import Path

import numpy as np
from ngsolve import Mesh

from . import methods
from .discretization import Discretization
from .exceptions import ProblemError
from .solution import ContactSolution
from .solvers.driver import Step

FORMAT = 1
FIELDS = ("number", "change", "residual", "solves", "seconds")


def Save(solution, folder):
    """Write a ContactSolution into `folder`, which is created."""
    folder, disc = Path(folder), solution.disc
    folder.mkdir(parents=True, exist_ok=True)
    disc.mesh.ngmesh.Save(str(folder / "mesh.vol.gz"))
    history = np.array([[getattr(step, field) for field in FIELDS] for step in solution.history]).reshape(-1, len(FIELDS))
    np.savez_compressed(folder / "fields.npz", vector=solution.vector, traction=solution.traction, history=history,
                        points=solution.points)
    description = {"format": FORMAT, "method": type(disc.method).__name__,
                   "arguments": {"penalty": disc.method.penalty} if disc.method.discontinuous else {},
                   "order": disc.order, "curveorder": disc.mesh.GetCurveOrder(), "converged": solution.converged,
                   "solver": solution.solver, "summary": solution.ToJSON()}
    (folder / "solution.json").write_text(json.dumps(description, indent=2) + "\n", encoding="utf-8")


def Load(folder, problem):
    """The ContactSolution in `folder`, for the ContactProblem it was computed with.

    Raises ProblemError if the folder holds no solution, or one that does not fit the problem.
    """
    folder = Path(folder)
    try:
        description = json.loads((folder / "solution.json").read_text(encoding="utf-8"))
        with np.load(folder / "fields.npz", allow_pickle=False) as fields:
            vector, traction, history, points = (fields[name] for name in ("vector", "traction", "history", "points"))
        mesh = Mesh(str(folder / "mesh.vol.gz"))
    except (OSError, ValueError, KeyError) as error:
        raise ProblemError(f"{folder} holds no saved solution: {error}") from error
    if description["format"] != FORMAT:
        raise ProblemError(f"{folder} has format {description['format']}, this version reads {FORMAT}")
    method = getattr(methods, description["method"])(**description["arguments"])
    disc = Discretization(problem, method, mesh, order=description["order"])
    if len(vector) != disc.space.ndof or points.shape != disc.contact.coordinates.shape \
            or not np.allclose(points, disc.contact.coordinates):
        raise ProblemError(f"the solution in {folder} was computed with another problem: its contact points are not those of "
                           "this one")
    steps = [Step(int(row[0]), row[1], row[2], int(row[3]), row[4]) for row in history.tolist()]
    return ContactSolution(disc, vector, traction, history=steps, converged=description["converged"],
                           solver=description["solver"])
