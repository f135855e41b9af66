"""A folder on disk with a mesh, arrays and a description: mesh.vol.gz, fields.npz and solution.json; no pickle."""

import json
from pathlib import Path

import numpy as np
from ngsolve import Mesh

from .exceptions import ProblemError

FORMAT = 1


def Write(folder, mesh, arrays, description):
    """Write mesh, {name: array} and a JSON-serialisable dictionary into `folder`, which is created."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    mesh.ngmesh.Save(str(folder / "mesh.vol.gz"))
    np.savez_compressed(folder / "fields.npz", **arrays)
    # default: numpy numbers among the arguments of a method
    text = json.dumps({"format": FORMAT, **description}, indent=2, default=float)
    (folder / "solution.json").write_text(text + "\n", encoding="utf-8")


def Read(folder):
    """(mesh, {name: array}, dictionary) from a folder; ProblemError if it does not hold them."""
    folder = Path(folder)
    try:
        description = json.loads((folder / "solution.json").read_text(encoding="utf-8"))
        with np.load(folder / "fields.npz", allow_pickle=False) as fields:
            arrays = dict(fields)
        if not (folder / "mesh.vol.gz").is_file():
            raise FileNotFoundError("mesh.vol.gz is missing")
        mesh = Mesh(str(folder / "mesh.vol.gz"))
    except (OSError, ValueError) as error:
        raise ProblemError(f"{folder} holds no saved solution: {error}; give a folder that "
                           "ContactSolution.Save has written") from error
    if description.get("format") != FORMAT:
        raise ProblemError(f"{folder} has format {description.get('format')}, this version reads {FORMAT}; save it anew")
    return mesh, arrays, description
