"""How much memory may be taken, and what is refused before it takes more."""

import resource
import subprocess
import sys
from types import SimpleNamespace
from unittest.mock import Mock

import psutil
import pytest
from netgen.occ import Box, Circle, Pnt

from ngdgc import ProblemError
from ngdgc.commands import studies
from ngdgc.tools import memory
from ngdgc.cli import Main
from ngdgc.meshes import BoxMesh, RectangleMesh, ShapeMesh, _Elements

PROGRAM = "import sys; from ngdgc.cli import Main; sys.exit(Main(sys.argv[1:]))"


def Limited(limit, size, *arguments):
    """A command in a process with a limit [bytes], away from the sources, whose package has no cases."""
    return subprocess.run([sys.executable, "-c", PROGRAM, *arguments], capture_output=True, text=True, timeout=120, cwd="/",
                          preexec_fn=lambda: resource.setrlimit(limit, (size, size)))


@pytest.mark.slow
@pytest.mark.parametrize("limit", [resource.RLIMIT_AS, resource.RLIMIT_DATA])
def test_a_limit_of_the_process_counts(limit, tmp_path):
    """A mesh that would fit into the machine but not into the limit; one that fits is solved under the same limit."""
    done = Limited(limit, 3 << 30, *"run example_4_1 --n 3000 --out".split(), str(tmp_path / "new"))
    assert done.returncode == 2 and done.stderr.count("\n") == 1 and not (tmp_path / "new").exists()
    assert "a mesh of 1.8e+07 elements would take about 6.3 GB" in done.stderr and "take a coarser mesh" in done.stderr
    free = float(done.stderr.split("and ")[1].split(" GB are free")[0])
    assert 1 < free < 3.3
    done = Limited(limit, 3 << 30, *"compare example_4_1 --method h1 --n 2 --out".split(), str(tmp_path / "new"))
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("error", [MemoryError(), RuntimeError("std::bad_alloc"), RuntimeError("Could not allocate localheap")])
def test_what_is_not_foreseen_is_one_line_too(error, tmp_path, capsys, monkeypatch):
    """As Python and NGSolve say it; other errors are errors."""
    monkeypatch.setattr(studies, "Show", Mock(side_effect=error))
    arguments = ["locking", "--out", str(tmp_path / "new")]
    assert Main(arguments) == 2 and not (tmp_path / "new").exists()
    assert capsys.readouterr().err == "ngdgc: there is not enough memory; take a coarser mesh or a lower order\n"
    monkeypatch.setattr(studies, "Show", Mock(side_effect=RuntimeError("something else")))
    with pytest.raises(RuntimeError, match="something else"):
        Main(arguments)


@pytest.mark.slow
@pytest.mark.parametrize("words, culprit", [
    ("run example_4_1 --n 1000000", "a mesh of 2e+12 elements"), ("run rubber_pad_3d --n 100000", "a mesh of"),
    ("run hertz_line --n 1000000000", "a mesh of"), ("convergence --n 4 1000000 --cells quad", "a mesh of 1e+12 elements"),
    ("stability example_4_1 --n 10000000", "a mesh of 2e+14"), ("convergence --n 4 100000 --cells tet", "of 6e+15")])
def test_absurd_sizes_are_refused_at_once(words, culprit, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert Main(words.split()) == 2
    message = capsys.readouterr().err.splitlines()[-1]
    assert culprit in message and "coarser mesh" in message and "GB are free" in message


@pytest.mark.slow
def test_estimates_are_below_the_truth_and_near_it(monkeypatch):
    """Elements of shapes, to a factor; what is refused must not be what fits."""
    for shape, maxh in ((Box(Pnt(0, 0, 0), Pnt(1, 1, 1)), 0.15), (Circle((0, 0), 1).Face(), 0.1)):
        assert 0.2 < _Elements(shape, maxh) / ShapeMesh(shape, maxh).ne < 1.2
    monkeypatch.setattr(psutil, "virtual_memory", lambda: SimpleNamespace(available=2e8))
    for mesh in (lambda: RectangleMesh(600), lambda: BoxMesh(50), lambda: ShapeMesh(Circle((0, 0), 1).Face(), 1e-3)):
        with pytest.raises(ProblemError, match="a mesh of .* elements would take about .* GB, and 0.2 GB are free"):
            mesh()
    with pytest.raises(ProblemError, match="the matrix of 100000 elements of order 2 would take about .* GB"):
        memory.CheckAssembly(100_000, 2, 2, discontinuous=True)
    memory.CheckAssembly(100_000, 2, 1, discontinuous=False)        # control
    assert RectangleMesh(20).ne == 800


def test_control_groups_count(tmp_path):
    """Of both versions, of the process and above; what files hold in memory can be had back, and no limit is none."""
    def Group(name, limit, used, reclaimable, names=("memory.max", "memory.current")):
        folder = tmp_path / name
        folder.mkdir(parents=True, exist_ok=True)
        (folder / names[0]).write_text(f"{limit}\n")
        (folder / names[1]).write_text(f"{used}\n")
        (folder / "memory.stat").write_text(f"anon 7\ninactive_file {reclaimable}\n")

    listing = tmp_path / "cgroup"
    listing.write_text("0::/batch/job\n")
    Group("batch/job", "max", 5, 1)
    assert list(memory._OfGroups(tmp_path, listing)) == [float("inf")]
    Group("batch", 100, 30, 20)
    assert min(memory._OfGroups(tmp_path, listing)) == 90
    Group("batch/job", 50, 30, 0)
    assert min(memory._OfGroups(tmp_path, listing)) == 20
    listing.write_text("3:memory:/inside/a/container\n1:cpu:/\n")
    Group("memory", 70, 10, 0, memory.GROUPS[0])
    assert min(memory._OfGroups(tmp_path, listing)) == 60
    Group("memory", 1 << 62, 10, 0, memory.GROUPS[0])
    assert min(memory._OfGroups(tmp_path, listing)) == float("inf")
    assert list(memory._OfGroups(tmp_path, tmp_path / "none")) == [] and memory.FreeMemory() > 0
