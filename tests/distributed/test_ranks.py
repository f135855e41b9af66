"""Spread over two and three ranks: the same rows, the same solutions, and an end that all ranks have in common.

Every run has a time limit: ranks that wait for each other for ever fail.
"""

import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

SCRIPT = Path(__file__).with_name("spread.py")
LIMIT = 300         # seconds; a run takes some 5 alone
ROUNDOFF = 1e-13    # of a row: the order of sums
SOLVED = 1e-8       # of solutions, both to a law residual of 1e-10 on a soft foundation
# For machines with fewer processors than ranks, and for containers.
SETTING = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
           "OMPI_MCA_mpi_yield_when_idle": "1", "OMPI_MCA_hwloc_base_binding_policy": "none", "NGS_NUM_THREADS": "1",
           "OMP_NUM_THREADS": "1"}


@cache
def Run(ranks, *words):
    return subprocess.run(["mpirun", "-n", str(ranks), sys.executable, "-m", "mpi4py", SCRIPT, *words], capture_output=True,
                          text=True, timeout=LIMIT, env={**os.environ, **SETTING})


def Numbers(ranks, *words):
    done = Run(ranks, *words)
    assert done.returncode == 0, done.stderr[-3000:]
    return json.loads(done.stdout.splitlines()[-1])


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
        off = {key: found[key] for key in ("vector", "forces", "mean", "energy", "zones", "resultants", "balance")}
        assert max(off.values()) < SOLVED, (name, off)
        assert found["same"] and found["kinds"] and found["report"] and found["zones met"] >= 2, (name, found)


def test_a_rank_without_contact_takes_part():
    assert max(found["without contact"] for found in Numbers(3, "solution", "2")["2"].values()) >= 1


def test_ranks_fail_together():
    """A mistake is told by all ranks in the same words; where one rank fails by itself none waits for it."""
    done = Run(2, "together")
    words = [line for line in done.stdout.splitlines() if line.startswith("words")]
    assert done.returncode != 0 and "rank 1 has failed" in done.stderr
    assert len(words) == 2 and len(set(words)) == 1 and "take 'facet'" in words[0]
