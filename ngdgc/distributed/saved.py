"""A solution in a folder: a file of every rank, and one of what all have; `solution.parts` reads them on one machine."""

from __future__ import annotations

from contextlib import ExitStack
from itertools import islice
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ..contracts import Array
from ..solution.archive import Description, StepsArray
from ..solution.fingerprint import SHORT, Fingerprint
from ..solution.parts import PartName
from ..solution.storage import FIELDS, FILES, WORDS, Replacing, Writing, WriteWords
from .petsc import OnAll, OnFirst


def KeepParts(solution: Any, folder: str | PathLike[str]) -> None:
    """Write a DistributedSolution into a folder that all ranks see; what was saved there stays until all is written."""
    disc, comm = solution.disc, solution.disc.mesh.comm
    slip = disc.contact.Slip(solution.displacement)
    marks = dict(islice(Fingerprint(solution, solution.penetration, slip, np.arange(len(disc.load))), len(SHORT)))
    own = {**_Part(disc.numbering.local), "vector": solution.vector, "loads": marks.pop("loads")}
    shared = {"traction": solution.traction, "penetration": solution.penetration, "slip": slip, "path": disc.contact.path,
              "worn": disc.contact.worn, "history": StepsArray(solution.history), **marks}
    if disc.memory.displacement is not None:
        shared["origin"] = disc.memory.displacement
    files = [FIELDS, *(PartName(rank) for rank in range(comm.size)), WORDS]
    path = Path(folder)
    with ExitStack() as stack:
        place = OnFirst(comm, lambda: stack.enter_context(Replacing(path, files)))

        def Write() -> None:
            with Writing(path):
                np.savez_compressed(place / PartName(comm.rank), **own)

        def Describe() -> None:
            with Writing(path):
                np.savez_compressed(place / FIELDS, **shared)
                WriteWords(place, {**Description(solution), "ranks": comm.size, "elements": disc.mesh.ne,
                                   "materials": list(disc.mesh.coarse.GetMaterials()),
                                   "boundaries": list(disc.mesh.coarse.GetBoundaries())}, files[:-1])

        OnAll(comm, Write)
        OnFirst(comm, Describe)
        OnFirst(comm, stack.close)
        OnFirst(comm, lambda: _Clear(path, files))


def _Part(local: Any) -> dict[str, Array]:
    """The own elements of a rank in the numbers of all of them, with their points and sides."""
    corners = local.elements[local.own]
    used = np.unique(corners)
    return {"cells": local.cells[local.own], "corners": local.vertices[corners], "vertices": local.vertices[used],
            "places": local.points[used], "material": local.material[local.own], "sides": local.vertices[local.sides],
            "region": local.region}


def _Clear(path: Path, files: list[str]) -> None:
    """Remove files of what was saved there before, on another number of ranks or on one machine."""
    with Writing(path):
        for name in {*FILES, *(file.name for file in path.glob("rank-*.npz"))} - set(files):
            (path / name).unlink(missing_ok=True)
