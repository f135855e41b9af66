"""A folder that every process of a DistributedMesh has written a file into, read again as one solution on one mesh.

rank-0000.npz, ... : the own elements, points and sides of a process, with its coefficients, all in the numbers of all of them
fields.npz : arrays over the contact points, which every process has;  solution.json : as `storage` has it
"""

from __future__ import annotations

import json
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from ngsolve import Mesh

from ..contact.boundary import ContactBoundary
from ..exceptions import ProblemError
from ..mesh.simplices import SimplexMesh
from ..tools.memory import CheckCells
from .storage import FIELDS, NEAR, WORDS, ReadFiles

PART = ("cells", "corners", "vertices", "places", "material", "sides", "region", "vector", "loads")
KINDS = {"ranks": int, "elements": int, "materials": list, "boundaries": list}


def PartName(rank: int) -> str:
    """The file of a process."""
    return f"rank-{rank:04d}.npz"


def InParts(folder: str | PathLike[str]) -> bool:
    """Was a solution on a DistributedMesh saved in a folder?"""
    try:
        return "ranks" in json.loads((Path(folder) / WORDS).read_text(encoding="utf-8"))
    except (OSError, RecursionError, TypeError, ValueError):    # which reading it will tell
        return False


def ReadParts(folder: str | PathLike[str], kinds: dict[str, type], names: tuple[str, ...]) -> tuple[Mesh, dict[str, Any],
         dict[str, Any]]:
    """As `storage.Read`; contact points are still in the order of the processes."""
    ranks = json.loads((Path(folder) / WORDS).read_text(encoding="utf-8"))["ranks"]
    files = [PartName(rank) for rank in range(ranks if type(ranks) is int else 0)]
    shared = tuple(name for name in names if name not in ("vector", "loads", "dofs"))
    (arrays, *own), words = ReadFiles(folder, {**kinds, **KINDS}, [FIELDS, *files],
                                      [(FIELDS, shared), *((file, PART) for file in files)])
    CheckCells(words["elements"])
    whole = {name: np.concatenate([part[name] for part in own]) for name in PART}
    order = np.argsort(whole["cells"])
    points = np.zeros((int(whole["vertices"].max()) + 1, whole["places"].shape[1]))
    points[whole["vertices"]] = whole["places"]
    mesh = SimplexMesh(points, whole["corners"][order], whole["material"][order], words["materials"], whole["sides"],
                       whole["region"], words["boundaries"])
    for name in ("vector", "loads"):    # element after element, to component after component
        blocks = whole[name].reshape(mesh.ne, mesh.dim, -1)[order]
        arrays[name] = np.swapaxes(blocks, 0, 1).ravel()
    return mesh, {**arrays, "dofs": np.zeros(0, dtype=int)}, words


def Ordered(folder: str | PathLike[str], contact: ContactBoundary, arrays: dict[str, Any]) -> dict[str, Any]:
    """The arrays with the contact points in the order of a ContactBoundary; ProblemError where they lie elsewhere."""
    from scipy.spatial import cKDTree   # slow to import

    points, wanted = arrays["points"], contact.coordinates
    order, size = np.zeros(len(wanted), dtype=int), np.ptp(wanted, axis=0).max()
    fit = points.shape == wanted.shape
    for part in contact.parts if fit else ():
        here = part.points
        distance, nearest = cKDTree(points[here]).query(wanted[here])
        order[here] = here.start + nearest
        fit = fit and bool(distance.max(initial=0) <= NEAR * size)
    if not fit or len(np.unique(order)) != len(order):
        raise ProblemError(f"the solution in {folder} was computed with another problem: its points differ; give the one it "
                           "was saved with")
    found = {name: array[order] if len(array) == len(order) else array for name, array in arrays.items()
             if name not in ("vector", "loads", "laws", "history", "energies")}
    return arrays | found | {"laws": arrays["laws"][:, order]}
