"""Folders that were edited, damaged, or not written to their end, and solutions that solve nothing: each is one error."""

import json
import os
import shutil
import subprocess
import sys

import numpy as np
import pytest
from mistakes.saved import Edited
from ngsolve import Mesh
from problems import Adjustable, Example

from ngdgc import (LDG, Conforming, ContactSolution, Discretization, InteriorPenalty, NotConvergedError, ProblemError, Solve,
                   UzawaSolver)
from ngdgc.solution import archive, storage
from ngdgc.meshes import RectangleMesh

# Of programs that use what stands in the tests.
FINDING = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}


@pytest.fixture(scope="module", params=[InteriorPenalty(), Conforming()], ids=repr)
def kept(request, tmp_path_factory):
    """A folder with a solution of `Adjustable()`."""
    folder = tmp_path_factory.mktemp("kept")
    Solve(Discretization(Adjustable(), request.param, RectangleMesh(2), order=2)).Save(folder)
    return folder


def test_a_mesh_whose_digest_is_wrong_is_not_read(kept, tmp_path, monkeypatch):
    """Netgen may end the process over a damaged file, so it is given none; here the file is intact."""
    read = []
    monkeypatch.setattr(storage, "Mesh", lambda name: read.append(name) or Mesh(name))
    shutil.copytree(kept, tmp_path / "copy")
    assert ContactSolution.Load(tmp_path / "copy", Adjustable()).converged and len(read) == 1
    text = tmp_path / "copy" / "solution.json"
    words = json.loads(text.read_text())
    for name in ("mesh.vol.bin", "mesh.vol.gz"):
        digest = words["digests"][name]
        text.write_text(json.dumps({**words, "digests": {**words["digests"], name: digest[::-1]}}))
        with pytest.raises(ProblemError, match=f"is damaged: {name} is not what was saved"):
            ContactSolution.Load(tmp_path / "copy", Adjustable())
    text.write_text(json.dumps(words))
    RectangleMesh(3).ngmesh.Save(str(tmp_path / "copy" / "mesh.vol.bin"))
    other = RectangleMesh(3, upper=(2, 1))
    other.ngmesh.Save(str(tmp_path / "copy" / "mesh.vol.bin"))
    with pytest.raises(ProblemError, match="is damaged: mesh.vol.bin is not what was saved"):
        ContactSolution.Load(tmp_path / "copy", Adjustable())
    assert len(read) == 1


def Cut(path, part):
    path.write_bytes(path.read_bytes()[:int(part * path.stat().st_size)])


def Half(folder):
    """The traction in single precision, which no solver has returned."""
    with np.load(folder / "fields.npz") as arrays:
        return {"traction": arrays["traction"].astype(np.float32)}


def Dofs(folder):
    """How many dofs the elements of the mesh have, one after the other."""
    space = ContactSolution.Load(folder, Adjustable()).disc.space
    return sum(len(element.dofs) for element in space.Elements())


DAMAGE = {
    "no folder": lambda folder: shutil.rmtree(folder),
    "a file": lambda folder: (shutil.rmtree(folder), folder.write_text("")),
    "empty json": lambda folder: Cut(folder / "solution.json", 0),
    "cut json": lambda folder: Cut(folder / "solution.json", 0.9),
    "a list": lambda folder: (folder / "solution.json").write_text("[1]"),
    "a number": lambda folder: (folder / "solution.json").write_text("1"),
    "nested": lambda folder: (folder / "solution.json").write_text("[" * 100000),
    "no text": lambda folder: (folder / "solution.json").write_bytes(b"\xff\xfe\x00"),
    "empty arrays": lambda folder: Cut(folder / "fields.npz", 0), "cut arrays": lambda folder: Cut(folder / "fields.npz", 0.5),
    "one array": lambda folder: np.save((folder / "fields.npz").open("wb"), np.zeros(3)),
    "no arrays": lambda folder: (folder / "fields.npz").unlink(),
    "text arrays": lambda folder: (folder / "fields.npz").write_text("words"),
    "a folder of arrays": lambda folder: ((folder / "fields.npz").unlink(), (folder / "fields.npz").mkdir()),
    "no exact mesh": lambda folder: (folder / "mesh.vol.bin").unlink(),
    "cut mesh": lambda folder: Cut(folder / "mesh.vol.bin", 0.5),
    "longer mesh": lambda folder: (folder / "mesh.vol.gz").open("ab").write(b"0"),
    "version": lambda folder: Edited(folder, words={"ngsolve": 6}),
    "digests": lambda folder: Edited(folder, without=["digests"], digests=False),
    "digest": lambda folder: Edited(folder, words={"digests": {}}, digests=False),
    "huge": lambda folder: Edited(folder, arrays={"vector": np.zeros(10 ** 6)}),
    "complex": lambda folder: Edited(folder, arrays={"vector": np.zeros(300, dtype=complex)}),
    "strings": lambda folder: Edited(folder, arrays={"traction": np.array(["a", "b"])}),
    "turned": lambda folder: Edited(folder, arrays={"traction": np.zeros((2, 9))}),
    "history": lambda folder: Edited(folder, arrays={"history": np.zeros((4, 2))}),
    "flat history": lambda folder: Edited(folder, arrays={"history": np.array(1.0)}),
    "no number": lambda folder: Edited(folder, arrays={"history": np.full((1, 5), np.nan)}),
    "infinite": lambda folder: Edited(folder, arrays={"history": np.full((1, 5), np.inf)}),
    "no entries": lambda folder: Edited(folder, arrays={"traction": np.zeros((0, 2))}),
    "one number": lambda folder: Edited(folder, arrays={"vector": np.array(1.0)}),
    "half the digits": lambda folder: Edited(folder, arrays=Half(folder)),
    "other slips": lambda folder: Edited(folder, arrays={"slip": np.load(folder / "fields.npz")["slip"][::-1] + 0.01}),
    "dofs": lambda folder: Edited(folder, arrays={"dofs": np.zeros(3, dtype=int)}),
    "dofs twice": lambda folder: Edited(folder, arrays={"dofs": np.zeros(Dofs(folder), dtype=int)}),
    "higher order": lambda folder: Edited(folder, words={"order": 3}),
    "format": lambda folder: Edited(folder, words={"format": True}),
    "levels": lambda folder: Edited(folder, words={"summary": {"levels": [{"a": 1}]}}),
    "contraction": lambda folder: Edited(folder, words={"summary": {"contraction": 3}}),
    "true": lambda folder: Edited(folder, words={"order": True}), "text": lambda folder: Edited(folder, words={"order": "2"}),
    "no": lambda folder: Edited(folder, words={"converged": "no"}),
    "none": lambda folder: Edited(folder, words={"solver": None}),
    "no method": lambda folder: Edited(folder, words={"method": "DiscontinuousGalerkin"}),
    "dunder": lambda folder: Edited(folder, words={"method": "__import__"}),
    "arguments": lambda folder: Edited(folder, words={"arguments": {"eta": 3}}),
    "penalty": lambda folder: Edited(folder, words={"arguments": {"penalty": "many"}, "method": "LDG"}),
    "assembly": lambda folder: Edited(folder, words={"assembly": "by hand"}),
    "edited": lambda folder: Edited(folder, words={"converged": False}, digests=False),
    "summary": lambda folder: Edited(folder, words={"summary": []})}


@pytest.mark.slow
@pytest.mark.parametrize("name", DAMAGE)
def test_damaged_folders_are_refused(kept, name, tmp_path):
    """Whatever was edited, also with digests that were made to fit; control: an untouched copy, and one laid out anew, load."""
    folder = tmp_path / "copy"
    shutil.copytree(kept, folder)
    assert ContactSolution.Load(Edited(folder), Adjustable()).converged
    DAMAGE[name](folder)
    with pytest.raises(ProblemError):
        ContactSolution.Load(folder, Adjustable())


def test_what_does_not_solve_the_problem_is_refused(kept):
    """Law and balance are verified: a solution whose traction is a tenth too large, or that is not at rest inside, is none."""
    solution = ContactSolution.Load(kept, Adjustable())
    disc, inside = solution.disc, np.diff(solution.disc.contact.trace.tocsc().indptr) == 0
    inside &= np.array(disc.space.FreeDofs())
    arrays = dict(np.load(kept / "fields.npz"))
    for vector, traction, words in ((solution.vector, 1.1 * solution.traction, "does not obey the contact law"),
                                    (solution.vector * np.where(inside, 1.001, 1), solution.traction, "is not in balance"),
                                    (solution.vector, solution.traction, None)):
        made = ContactSolution(disc, vector, traction, history=solution.history)
        if words is None:
            archive.Compare(kept, made, arrays, np.arange(disc.space.ndof))
            continue
        arrays["energies"] = np.array([made.energy])
        with pytest.raises(ProblemError, match=words):
            archive.Compare(kept, made, arrays, np.arange(disc.space.ndof))
        arrays["energies"] = np.array([solution.energy])


def test_an_iterate_is_kept_as_one(tmp_path):
    """What has not converged is loaded as that; its distance to the law is the recorded one."""
    with pytest.raises(NotConvergedError) as caught:
        UzawaSolver(maxiter=3).Solve(Discretization(Example(), LDG(), RectangleMesh(2)))
    caught.value.solution.Save(tmp_path)
    loaded = ContactSolution.Load(tmp_path, Example())
    assert not loaded.converged and loaded.history == caught.value.history
    # Control: an edit does not make a solution of it.
    with pytest.raises(ProblemError, match="is damaged"):
        ContactSolution.Load(Edited(tmp_path, words={"converged": True}, digests=False), Example())


def test_a_save_that_fails_leaves_what_was_there(kept, tmp_path, monkeypatch):
    """The old files, and no others; a folder that was made for it goes."""
    solution = ContactSolution.Load(kept, Adjustable())
    folder = tmp_path / "copy"
    shutil.copytree(kept, folder)
    before = {path.name: path.read_bytes() for path in folder.iterdir()}

    def Fails(*_, **__):
        raise KeyboardInterrupt
    replaced, Move = [], storage.os.replace

    def MovesFive(*names):
        replaced.append(names)
        return Fails() if len(replaced) == 6 else Move(*names)
    for owner, name, Replacement in ((storage.np, "savez_compressed", Fails), (storage.Path, "write_text", Fails),
                                     (storage, "_CheckRoom", Fails), (storage.os, "replace", MovesFive)):
        with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
            patch.setattr(owner, name, Replacement)
            solution.Save(folder)
        assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
        with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
            replaced[:] = [None] * 3
            patch.setattr(owner, name, Replacement)
            solution.Save(tmp_path / "new" / "below")
        assert not (tmp_path / "new").exists()
        replaced.clear()
    solution.Save(tmp_path / "new" / "below")
    assert sorted(path.name for path in (tmp_path / "new" / "below").iterdir()) == sorted(storage.FILES)


FULL = """
import resource, sys
from ngdgc import *
from problems import Adjustable
from ngdgc.meshes import RectangleMesh
solution = Solve(Discretization(Adjustable(), LDG(), RectangleMesh(16), order=1))
for room in map(int, sys.argv[2:]):
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, resource.RLIM_INFINITY))
    try:
        print(solution.Save(sys.argv[1]))
    except ProblemError as error:
        print(error)
"""


@pytest.mark.slow
def test_a_full_disk_is_one_error(tmp_path):
    """Netgen writes the mesh without looking: a limit of the process stands for the disk, below, in and above its size."""
    mesh = RectangleMesh(16)
    mesh.ngmesh.Save(str(tmp_path / "mesh.vol.bin"))
    size = (tmp_path / "mesh.vol.bin").stat().st_size
    rooms = [5000, size - 1, size, size + 5000, 10 ** 7]
    result = subprocess.run([sys.executable, "-c", FULL, str(tmp_path / "kept"), *map(str, rooms)], capture_output=True,
                            text=True, check=False, cwd=tmp_path, env=FINDING)
    *failed, last = result.stdout.splitlines()
    assert len(failed) == 4 and all("cannot save into" in line and "with room" in line for line in failed), result.stderr
    # Control: with room for all of it there is no error.
    assert last == "None" and sorted(path.name for path in (tmp_path / "kept").iterdir()) == sorted(storage.FILES)
