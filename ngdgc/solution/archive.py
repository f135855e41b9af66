"""A solution in a folder: what is kept of it, and what is compared and verified when it is read again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, astuple, fields
from os import PathLike
from typing import Any

import numpy as np
from ngsolve import BilinearForm, LinearForm

from ..contact.graph import Distance
from ..contracts import Array, Inverter
from ..discrete.divided import OnPieces
from ..discrete.problem import DiscreteProblem
from ..exceptions import ProblemError
from ..linear.choice import INVERTERS
from ..mesh.pieces import PiecesArray, PiecesOf
from ..methods.registry import METHODS
from . import parts, storage
from .fingerprint import NAMES, SAME, SHORT, Differs, Fingerprint
from .history import Level, Step
from .resultants import BALANCE

KINDS = {"method": str, "arguments": dict, "order": int, "assembly": str, "inverse": str, "added": bool, "converged": bool,
         "solver": str, "summary": dict}
MEMORY = "origin", "path", "worn", "pieces"
LAW = 1e-6          # difference of a law residual and the one that was recorded, besides a thousandth of it


def Keep(solution: Any, folder: str | PathLike[str], *, more: dict[str, Any] | None = None) -> None:
    """Write a ContactSolution, and more arrays, into a folder; ProblemError if it could not be read again."""
    disc = solution.disc
    penetration, slip = solution.penetration, disc.contact.Slip(solution.displacement)
    arrays = {"vector": solution.vector, "traction": solution.traction, "penetration": penetration, "slip": slip,
              "history": StepsArray(solution.history),
              "dofs": _Dofs(disc.space) if disc.given.levels > 1 and not disc.method.discontinuous else np.zeros(0, dtype=int),
              "origin": np.zeros((0, disc.mesh.dim)) if disc.origin is None else disc.origin,
              "path": disc.contact.path, "worn": disc.contact.worn, "pieces": PiecesArray(disc.pieces, disc.mesh.dim),
              **({} if disc.motion is None else {"motion": disc.motion}), **(more or {}),
              **dict(Fingerprint(solution, penetration, slip, np.arange(disc.space.ndof)))}
    _CheckArrays(arrays, "solution")
    storage.Write(folder, disc.given, arrays, Description(solution))


def StepsArray(history: Sequence[Step]) -> Array:
    """What a file has of the iteration, (steps, 5)."""
    return np.array([astuple(step) for step in history], dtype=float).reshape(-1, 5)


def Description(solution: Any) -> dict[str, Any]:
    """What `KINDS` says of a solution; ProblemError for a method that could not be made again."""
    disc, method = solution.disc, solution.disc.method
    if type(method) not in METHODS.values():
        raise ProblemError(f"method is {method!r}, a {type(method).__name__} of your own, which a file cannot name; keep "
                           "solution.vector and solution.traction, and make ContactSolution(disc, vector, traction) of them")
    return {"method": type(method).__name__, "arguments": asdict(method), "order": disc.order, "assembly": disc.assembly,
            "inverse": disc.wanted if isinstance(disc.wanted, str) else disc.inversekind, "added": bool(disc.added),
            "converged": bool(solution.converged), "solver": str(solution.solver), "summary": solution.ToJSON()}


def Open(folder: str | PathLike[str], problem: Any, added: Sequence[Any],
         inverse: str | Inverter | None) -> tuple[DiscreteProblem, dict[str, Any], dict[str, Any]]:
    """(DiscreteProblem, {name: array}, dictionary) of a folder, for a problem and forms that are compared later."""
    inparts = parts.InParts(folder)
    Read, names = (parts.ReadParts, SHORT) if inparts else (storage.Read, NAMES)
    mesh, arrays, words = Read(folder, KINDS, ("vector", "traction", "penetration", "slip", "history", "dofs", *names))
    _CheckArrays(arrays, f"the solution in {folder}")
    kind = {method.__name__: method for method in METHODS.values()}.get(words["method"])
    if kind is None or not set(words["arguments"]) <= {field.name for field in fields(kind)}:
        raise ProblemError(f"{folder} was saved with method {words['method']} and arguments {words['arguments']}, which this "
                           f"version has not; it knows {', '.join(method.__name__ for method in METHODS.values())}")
    if not isinstance(added, Sequence) or isinstance(added, str):
        raise ProblemError(f"added is {added!r}; give a list of the forms that disc.Add was given")
    if words["added"] != bool(added):
        raise ProblemError(f"the solution in {folder} was computed {'with' if words['added'] else 'without'} added forms; "
                           f"{'give them again' if words['added'] else 'leave them out'}: "
                           f"Load(folder, problem{', added=[...]' if words['added'] else ''})")
    disc = DiscreteProblem(problem, kind(**words["arguments"]), mesh, order=words["order"], assembly=words["assembly"],
                           inverse=_Inverse(words["inverse"]) if inverse is None else inverse)
    if disc.space.ndof != len(arrays["vector"]):
        raise ProblemError(f"{folder} has {len(arrays['vector'])} coefficients, and {disc!r} has {disc.space.ndof}; give a "
                           "folder as ContactSolution.Save has left it")
    for number, form in enumerate(added):
        disc.Add(_On(disc.space, form, f"added[{number}]"))
    # What folders of version 0.2 have not.
    *memory, pieces = (arrays.get(name, np.zeros(0)) for name in MEMORY)
    if pieces.size:
        if pieces.dtype != float or pieces.shape[1:] != (1 + (mesh.dim - 1) * mesh.dim,) or not np.all(np.isfinite(pieces)):
            raise ProblemError(f"the pieces in {folder} are no parts of boundary elements; give a folder as "
                               "ContactSolution.Save has left it")
        disc = OnPieces(disc, PiecesOf(pieces, mesh.dim))
    if inparts:
        arrays = parts.Ordered(folder, disc.contact, arrays)
        *memory, _ = (arrays.get(name, np.zeros(0)) for name in MEMORY)
    disc = disc.After(*(array if array.size else None for array in memory))
    return disc.Moved(arrays.get("motion")), arrays, words


def _Inverse(name: str) -> str:
    """The name that a file has of what solved the linear equations, or "auto" for what it can name, but not make."""
    return name if name in INVERTERS else "auto"


def Iteration(folder: str | PathLike[str], arrays: dict[str, Any], words: dict[str, Any]) -> tuple[list[Step], list[Level],
              float | None]:
    """([Step], [Level], predicted factor) of what a folder says of the iteration; ProblemError if it says something else."""
    try:
        history = [Step(int(row[0]), row[1], row[2], int(row[3]), row[4]) for row in arrays["history"].tolist()]
        levels = [Level(**level) for level in words["summary"].get("levels", [])]
        return history, levels, words["summary"].get("contraction", {}).get("predicted")
    except (AttributeError, OverflowError, TypeError, ValueError) as error:
        raise ProblemError(f"the history or the summary in {folder} is none of an iteration: {error}; give a folder as "
                           "ContactSolution.Save has left it") from error


def Numbering(folder: str | PathLike[str], disc: DiscreteProblem, arrays: dict[str, Any]) -> Any:
    """Which number in the arrays the dofs have, (ndof,): another one where a conforming method's mesh was refined in parts.

    Edges are numbered after those of their parents, which have gone from the mesh that was read.
    """
    numbering, kept = np.arange(disc.space.ndof), arrays["dofs"]
    if not kept.size:
        return numbering
    dofs = _Dofs(disc.space)
    fit = kept.dtype.kind == "i" and kept.shape == dofs.shape
    if fit:
        numbering[dofs] = kept
    if not fit or not np.array_equal(np.sort(numbering), np.arange(disc.space.ndof)):
        raise ProblemError(f"the dofs in {folder} are none of {disc!r}; give a folder as ContactSolution.Save has left it")
    return numbering


def _Dofs(space: Any) -> Any:
    """The dofs of all elements, one after the other."""
    return np.concatenate([element.dofs for element in space.Elements()])


def Compare(folder: str | PathLike[str], solution: Any, arrays: dict[str, Any], numbering: Any) -> None:
    """Raise ProblemError unless a solution is of the problem whose arrays were kept, and solves it as far as it claims to."""
    for name, values in Fingerprint(solution, arrays["penetration"], arrays["slip"], numbering):
        if name in arrays and Differs(arrays[name], values):
            raise ProblemError(f"the solution in {folder} was computed with another problem: its {name} differ; "
                               "give the one it was saved with")
    disc = solution.disc
    at = solution.penetration, disc.contact.Slip(solution.displacement)
    size = max(np.abs(solution.displacement).max(initial=0), np.abs(disc.contact.gap).max(initial=0))
    for name, values in zip(("penetration", "slip"), at):
        if not np.abs(arrays[name] - values).max(initial=0) <= SAME * size:
            raise ProblemError(f"the {name} in {folder} is not that of its coefficients; give a folder as ContactSolution.Save "
                               "has left it")
    law = Distance(disc.contact, solution.displacement, solution.traction).distance.max(initial=0)
    recorded = solution.history[-1].residual if solution.history else 0.0
    if not abs(law - recorded) <= 1e-3 * recorded + LAW:
        raise ProblemError(f"the solution in {folder} does not obey the contact law: its distance is {law:.1e}, recorded is "
                           f"{recorded:.1e}; solve again, and save what Solve returns")
    balance = solution.EquilibriumResidual()
    if solution.converged and not balance <= BALANCE:
        raise ProblemError(f"the solution in {folder} is not in balance: A u - f + T' W t is {balance:.1e} of its terms; solve "
                           "again, and save what Solve returns")


def _CheckArrays(arrays: dict[str, Any], name: str) -> None:
    """Raise ProblemError unless vector and contact quantities are finite and of shapes that belong together."""
    shapes = {"vector": arrays["loads"].shape, "traction": arrays["points"].shape, "penetration": arrays["points"].shape[:1],
              "slip": arrays["points"].shape[:1], "history": (*arrays["history"].shape[:1], 5)}
    for key, shape in shapes.items():
        array = arrays[key]
        wrong = array.dtype != float or array.shape != shape or array.ndim == 0
        if wrong or key != "history" and not np.all(np.isfinite(array)):
            raise ProblemError(f"{name} has a {key} of shape {array.shape} that is not finite, or not of shape {shape}; solve "
                               "again, and save what Solve returns")


def _On(space: Any, form: Any, name: str) -> Any:
    """An added form on a space: what a function of the space makes, or the integrals of a form on one like it."""
    if isinstance(form, (BilinearForm, LinearForm)):
        other = form.space
        if type(other) is not type(space) or other.ndof != space.ndof or other.globalorder != space.globalorder:
            raise ProblemError(f"{name} lives on another space; make it on one of the same mesh, method and order")
        copy = type(form)(space)
        for integrator in form.integrators:
            copy += integrator
        return copy
    if not callable(form):
        raise ProblemError(f"{name} is {form!r}; give a form, or a function of the space that makes it")
    try:
        return form(space)
    except Exception as error:      # of a function of the user's own
        raise ProblemError(f"{name} fails: {type(error).__name__}: {error}; give a function of the space alone that makes a "
                           "BilinearForm or a LinearForm on it") from error
