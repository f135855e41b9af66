"""Spread over two and three ranks: the same rows, the same solutions, and an end that all ranks have in common.

Every run has a time limit: ranks that wait for each other for ever fail.
"""

import json
import os
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from ngdgc import ContactSolution
from ngdgc.cases import example_4_2
from ngdgc.studies.bench.ranks import Measure, Task

FOLDER = Path(__file__).parent
pytestmark = pytest.mark.slow
LIMIT = 300         # seconds; a run takes some 5 alone
GRACE = 20          # of ending them
ROUNDOFF = 1e-13    # of a row: the order of sums
SOLVED = 1e-8       # of solutions, both to a law residual of 1e-10 on a soft foundation
# For machines with fewer processors than ranks, and for containers.
SETTING = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
           "OMPI_MCA_mpi_yield_when_idle": "1", "OMPI_MCA_hwloc_base_binding_policy": "none", "NGS_NUM_THREADS": "1",
           "OMP_NUM_THREADS": "1"}


def Started(ranks, *words):
    """(exit code, output, errors) of a script on several ranks; all of them are ended if they take too long."""
    # In another folder than that of the sources, which Python would take for the package.
    run = subprocess.Popen(["mpirun", "-n", str(ranks), sys.executable, "-m", "mpi4py", *map(str, words)], cwd=FOLDER,
                           text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                           env={**os.environ, **SETTING})
    try:
        output, errors = run.communicate(timeout=LIMIT)
    except subprocess.TimeoutExpired:
        run.terminate()     # which it hands on to the ranks; they are in groups of their own
        try:
            run.wait(GRACE)
        except subprocess.TimeoutExpired:
            run.kill()
        raise
    return run.returncode, output, errors


@cache
def Run(ranks, *words):
    return Started(ranks, FOLDER / "spread.py", *words)


def Numbers(ranks, *words):
    code, output, errors = Run(ranks, *words)
    assert code == 0, errors[-3000:]
    return json.loads(output.splitlines()[-1])


@pytest.mark.parametrize("ranks, dim", [(2, "2"), (3, "3")])
def test_rows_are_those_of_one_process(ranks, dim):
    """All eight forms at order 1, the edge forms at order 2; facets where a rank's mesh is cut count half, else it is seen."""
    found = Numbers(ranks, "rows", dim)[dim]
    control = found.pop("cut facets as boundary")
    assert len(found) == 12 and max(found.values()) < ROUNDOFF, found
    assert control > 1e-3


@pytest.mark.parametrize("ranks, dim", [(3, "2"), (2, "3")])
def test_solutions_are_those_of_one_process(ranks, dim):
    """Displacement, forces, means, energy and zones; arrays on Gamma_C are the same bits on all ranks."""
    for name, found in Numbers(ranks, "solution", dim)[dim].items():
        off = {key: found[key] for key in ("vector", "factors or steps", "forces", "mean", "energy", "zones", "resultants",
                                               "balance")}
        assert max(off.values()) < SOLVED, (name, off)
        assert found["same"] and found["kinds"] and found["report"] and found["zones met"] >= 2, (name, found)


def test_a_rank_without_contact_takes_part():
    assert max(found["without contact"] for found in Numbers(3, "solution", "2")["2"].values()) >= 1


def test_ranks_fail_together(tmp_path):
    """A mistake, too little memory and a full disk are told by all ranks in the same words, and what was saved stays.

    Where one rank fails by itself none waits for it.
    """
    code, output, errors = Run(2, "together", str(tmp_path / "saved"))
    words = [line.split(maxsplit=2)[1:] for line in output.splitlines() if line.startswith("words")]
    assert code != 0 and "rank 1 has failed" in errors and "AssertionError" not in errors
    assert sorted(number for number, _ in words) == ["0", "0", "1", "1", "2", "2"]
    told = {number: {text for other, text in words if other == number} for number, _ in words}
    for number, culprit in (("0", "take 'facet'"), ("1", "more ranks on more machines"), ("2", "No space left on device")):
        assert len(told[number]) == 1 and culprit in next(iter(told[number])), told


def test_command_runs_a_case_and_says_everything_once(tmp_path):
    """Rank 0 prints and writes; the solution can be read; what is wrong is one line, with the exit code of the command."""
    words = ["-m", "ngdgc.cli", "run", "example_4_2", "--n", "2", "--refine", "1", "--out"]
    code, output, errors = Started(2, *words, tmp_path / "results")
    assert code == 0 and output.count("Forces on the body") == output.count("written to") == 1, errors[-3000:]
    solution, alone = ContactSolution.Load(tmp_path / "results" / "solution", example_4_2.Problem()), example_4_2.Main(n=4)
    assert solution.normalforce == pytest.approx(alone.normalforce, rel=SOLVED)
    assert {"solution.html", "deformed.png", "body.pvtu", "contact.pvtu", "report.json"} <= {
        path.name for path in (tmp_path / "results").iterdir()}
    code, _, errors = Started(2, *words, tmp_path / "others", "--cells", "quad")
    assert code == 2 and errors.count("coarse has elements that are neither triangles nor tetrahedra") == 1
    assert not (tmp_path / "others").exists()


@pytest.fixture(scope="module")
def carried(tmp_path_factory):
    """(what carried.py prints, the folder into which it has written)"""
    folder = tmp_path_factory.mktemp("carried")
    code, output, errors = Started(3, FOLDER / "carried.py", folder)
    assert code == 0, errors[-3000:]
    return json.loads(output.splitlines()[-1]), folder


def test_a_part_from_cad_is_led_along_loads_saved_and_drawn(carried):
    """Two foundations, three zones, wear; what is read on one machine, and the picture, are the solution of one process."""
    found, folder = carried
    off = {name: value for name, value in found.items() if isinstance(value, float) and name != "sunk"}
    assert len(off) == 14 and max(off.values()) < SOLVED, off
    assert found["same"] and min(found["zones"].values()) > 0 and found["without contact"] == []
    assert sorted(path.name for path in folder.iterdir()) == [
        "body", "body.pvtu", "contact", "contact.pvtu", "figure-0.png", "figure-1.png", "last", "page.html", "saved"]
    assert sorted(path.name for path in (folder / "saved").iterdir()) == [
        "fields.npz", "rank-0000.npz", "rank-0001.npz", "rank-0002.npz", "solution.json"]


def test_files_of_all_ranks_hold_the_whole(carried):
    """Areas and lengths of the pieces that the lists name add up, and each cell is in one of them."""
    found, folder = carried
    for name, whole, cells in (("body", 1.5, found["elements"][1] * 4), ("contact", 3.0, None)):
        text = (folder / f"{name}.pvtu").read_text()
        pieces = [folder / source for source in re.findall(r'<Piece Source="(.*?)"/>', text)]
        weights = [Field(piece, "weights") for piece in pieces]
        assert sum(map(np.sum, weights)) == pytest.approx(whole, rel=1e-12)
        assert cells is None or sum(map(len, weights)) == cells
        assert 'Name="displacement" NumberOfComponents="3"' in text
    sunk = [Field(piece, "penetration") for piece in pieces]        # from where the last state but one has worn the body off
    assert sum(map(np.dot, sunk, weights)) == pytest.approx(found["sunk"], rel=SOLVED)


def Field(path, name):
    """A field of one component of a VTK file."""
    head, data = path.read_bytes().split(b'<AppendedData encoding="raw">\n_')
    start = int(re.search(rf'Name="{name}" NumberOfComponents="1" format="appended" offset="(\d+)"', head.decode()).group(1))
    size = int(np.frombuffer(data[start:start + 4], "<u4")[0])
    return np.frombuffer(data[start + 4:start + 4 + size], "<f8")


def test_study_measures_what_a_step_sends(monkeypatch):
    """Neighbours are some of the elements, each step has three sums at least, the products of Gauss-Seidel are messages."""
    for name, value in SETTING.items():
        monkeypatch.setenv(name, value)
    monkeypatch.chdir(FOLDER)       # see `Started`
    row = Measure(Task(ranks=2, n=2), limit=LIMIT)
    assert row.unknowns == 72 * 4 ** 3 and row.points == 6 * 4 ** 2
    assert 0 < row.steps["GAMG"] <= 30 and all(steps <= 30 for steps in row.steps.values())
    # Coefficients of the neighbours, once for the product with A, the rest, and the sweep back; the levels below come to it.
    assert 3 * 8 * row.ghosts * row.unknowns / 2 < row.bytes < 1e5 and row.messages >= 3 and row.sums >= 3
    assert 0.1 < row.ghosts < 0.5 and len(row.peak) == 2 and min(np.subtract(row.peak, row.fixed)) > 0
