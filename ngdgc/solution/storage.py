"""A folder on disk with a mesh, arrays and a description; no pickle.

mesh.vol.bin : Netgen's binary format, exact, for the NGSolve that wrote it;  mesh.vol.gz : text, for others, where curved
    elements have eight decimals and boundary edges of second order no middle points
fields.npz : arrays;  solution.json : the description, with SHA-256 digests of the other files and of what else it says, so
    that a file that was edited or damaged is told from one that was saved; Netgen reads no other
"""

from __future__ import annotations

import hashlib
import json
import os
import reprlib
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib.metadata import version
from numbers import Integral
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from ngsolve import IntegrationRule, Mesh

from ..contracts import Array
from ..exceptions import ProblemError
from ..mesh.facets import TYPES, Coordinates, SecondOrder, VolumePoints

FORMAT = 1
FILES = EXACT, MESH, FIELDS, WORDS = "mesh.vol.bin", "mesh.vol.gz", "fields.npz", "solution.json"
NEAR = 1e-9     # distance, relative to the body, of points that are the same in a mesh and in its file


def Write(folder: str | PathLike[str], mesh: Mesh, arrays: dict[str, Any], description: dict[str, Any]) -> None:
    """Write mesh, {name: array} and a JSON-serialisable dictionary into `folder`, which is created.

    The files take their names when all are complete and the mesh was read back: what was in the folder stays if that fails.
    Raises ProblemError if the folder cannot be written, or the mesh cannot be kept in a file.
    """
    if mesh.deformation is not None:
        raise ProblemError("the mesh has a deformation (SetDeformation), which its file does not keep; save solutions of "
                           "meshes whose points are where they should be")
    with Replacing(Path(folder)) as place:
        _WriteMesh(mesh, place)
        np.savez_compressed(place / FIELDS, **arrays)
        WriteWords(place, {**description, "secondorder": SecondOrder(mesh)}, FILES)


def WriteWords(place: Path, description: dict[str, Any], files: Sequence[str]) -> None:
    """Write the description beside the files, with their digests."""
    words = {"format": FORMAT, **description, "ngsolve": version("ngsolve")}
    # default: numpy numbers and fractions among the arguments of a method
    words = json.loads(json.dumps(words, default=lambda value: int(value) if isinstance(value, Integral) else float(value)))
    words["digests"] = _Digests(place, words, files)
    (place / WORDS).write_text(json.dumps(words, indent=2) + "\n", encoding="utf-8")


def Read(folder: str | PathLike[str], kinds: dict[str, type], names: tuple[str, ...]) -> tuple[Mesh, dict[str, Any],
         dict[str, Any]]:
    """(mesh, {name: array}, dictionary) from a folder; ProblemError if it does not hold them as they were written.

    kinds : {name: type} of what the dictionary must have;  names : of the arrays that there must be
    """
    (arrays,), words = ReadFiles(folder, {"secondorder": bool, **kinds}, FILES, [(FIELDS, names)])
    folder = Path(folder)
    if words["ngsolve"] == version("ngsolve"):
        return Mesh(str(folder / EXACT)), arrays, words
    if words["secondorder"]:
        raise ProblemError(f"{folder} has a mesh of second order, whose text file is incomplete: it is read by NGSolve "
                           f"{words['ngsolve']} alone, which saved it; take that, or curve a mesh instead")
    return Mesh(str(folder / MESH)), arrays, words


def ReadFiles(folder: str | PathLike[str], kinds: dict[str, type], files: Sequence[str],
              wanted: Sequence[tuple[str, tuple[str, ...]]]) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """([{name: array}], dictionary) of a folder whose files have the digests that it states.

    kinds : {name: type} of what the dictionary must have;  wanted : files of arrays, with the names that there must be
    """
    kinds = {"ngsolve": str, "digests": dict, **kinds}
    tables = list[dict[str, Any]]()
    try:
        folder = Path(folder)
        words = json.loads((folder / WORDS).read_text(encoding="utf-8"))
        for file, _ in wanted:
            with np.load(folder / file, allow_pickle=False) as fields:
                tables.append(dict(fields))
        if MESH in files and not (folder / MESH).is_file():
            raise FileNotFoundError(f"{MESH} is missing")
    except Exception as error:      # whatever a damaged file leads to
        raise ProblemError(f"{folder} holds no saved solution: {' '.join(str(error).split()) or type(error).__name__}; give a "
                           "folder that ContactSolution.Save has written") from error
    number = words.get("format") if isinstance(words, dict) else None
    if type(number) is not int or number != FORMAT:
        raise ProblemError(f"{folder} has format {number}, this version reads {FORMAT}; save it anew")
    for name, kind in kinds.items():
        if type(words.get(name)) is not kind:
            there = reprlib.repr(words[name]) if name in words else "missing"
            raise ProblemError(f"{folder} holds no complete solution: {name!r} in {WORDS} is {there}, expected is "
                               f"{kind.__name__}; save it anew, with this version of ngdgc")
    if missing := [(file, name) for (file, names), arrays in zip(wanted, tables) for name in names if name not in arrays]:
        file, name = missing[0]
        raise ProblemError(f"{folder} holds no complete solution: {file} has no {name!r}; save it anew, with this version of "
                           "ngdgc")
    found = _Digests(folder, words, files)
    if changed := [name for name in files if found[name] != words["digests"].get(name)]:
        raise ProblemError(f"{folder} is damaged: {changed[0]} is not what was saved, or not there; give a folder as "
                           "ContactSolution.Save has left it")
    return tables, words


def _Digests(folder: Path, words: dict[str, Any], files: Sequence[str]) -> dict[str, str]:
    """{name: digest} of the files of a folder, "missing" where there is none; of the dictionary, however laid out."""
    stated = {name: value for name, value in words.items() if name != "digests"}
    contents = {name: (folder / name).read_bytes() if (folder / name).is_file() else None for name in files}
    contents[WORDS] = json.dumps(stated, sort_keys=True).encode()
    return {name: "missing" if content is None else hashlib.sha256(content).hexdigest() for name, content in contents.items()}


@contextmanager
def Writing(folder: Path) -> Iterator[None]:
    """A time in which files are written; ProblemError where one cannot be."""
    try:
        yield
    except ProblemError:
        raise
    except (OSError, EOFError, TypeError, ValueError) as error:
        raise ProblemError(f"cannot save into {folder}: {getattr(error, 'strerror', None) or error}; give the name of a folder "
                           "that can be written, on a disk with room") from error


@contextmanager
def Replacing(folder: Path, files: Sequence[str] = FILES) -> Iterator[Path]:
    """A new folder inside `folder`, whose files move up at the end, all or none; what fails before leaves no trace."""
    made = []
    try:
        with Writing(folder):
            made = [path for path in (folder, *folder.parents) if not path.exists()]
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=folder, prefix=".saving-") as name:
                yield Path(name)
                _MoveUp(Path(name), folder, files)
                made = []
    finally:
        with suppress(OSError):
            for path in made:
                path.rmdir()


def _MoveUp(place: Path, folder: Path, files: Sequence[str]) -> None:
    """Move the files from `place`, a folder inside `folder`, into it; if that is interrupted, those before come back."""
    before = [name for name in files if (folder / name).exists()]
    try:
        for name in before:
            os.replace(folder / name, place / f"before-{name}")
        for name in files:
            os.replace(place / name, folder / name)
    except BaseException:
        for name in files:
            if (place / f"before-{name}").exists():
                os.replace(place / f"before-{name}", folder / name)
            elif name not in before:
                (folder / name).unlink(missing_ok=True)
        raise


def _WriteMesh(mesh: Mesh, folder: Path) -> None:
    """Both files of a mesh; ProblemError if one that was read back would be another."""
    path = folder / EXACT
    mesh.ngmesh.Save(str(path))
    _CheckRoom(path)
    found = Mesh(str(path))
    if mesh.GetCurveOrder() > 1 and not _Same(mesh, found):
        # A refined mesh numbers its edges with those of its parents before them, the file does not, but keeps curves by number.
        found.ngmesh.SetGeometry(mesh.ngmesh.GetGeometry())
        found.Curve(mesh.GetCurveOrder())
        found.ngmesh.Save(str(path))
        _CheckRoom(path)
        found = Mesh(str(path))
    if not _Same(mesh, found):
        raise ProblemError("the mesh cannot be kept in a file: read back, its elements lie elsewhere; curve it after it was "
                           "refined, not before")
    found.ngmesh.Save(str(folder / MESH))
    _CheckRoom(folder / MESH)


def _CheckRoom(path: Path) -> None:
    """Raise OSError if no more can be written to a file: Netgen says nothing of a full disk and stops there."""
    with open(path, "ab") as file:
        size = file.tell()
        file.write(bytes(1 << 16))
        file.flush()
        file.truncate(size)


def _Same(mesh: Mesh, found: Mesh) -> bool:
    """Has the mesh that was read the elements, vertices, names and points of the one that was written?"""
    if any(getattr(mesh, count) != getattr(found, count) for count in ("ne", "nv")):
        return False
    if (mesh.GetMaterials(), mesh.GetBoundaries()) != (found.GetMaterials(), found.GetBoundaries()):
        return False
    points = _Points(mesh)
    return np.abs(points - _Points(found)).max() <= NEAR * np.ptp(points, axis=0).max()


def _Points(mesh: Mesh) -> Array:
    """Points in all elements and on all boundaries that tell curved elements of its order apart, (n, d)."""
    order = 2 * mesh.GetCurveOrder()
    rules = {et: IntegrationRule(et, order) for et in TYPES[mesh.dim - 1].values()}
    sides = mesh.MapToAllElements(rules, mesh.Boundaries(".*"))
    return np.concatenate([np.asarray(Coordinates(mesh.dim)(points)) for points in (VolumePoints(mesh, order), sides)])
