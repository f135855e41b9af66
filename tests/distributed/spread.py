"""Run by test_ranks.py on several ranks: what is spread over them against the same on one, as numbers that rank 0 prints.

mpirun -n 2 python -m mpi4py spread.py rows|solution|together
"""

import json
import sys
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import patch
from zlib import crc32

import numpy as np
import psutil
import scipy.sparse as sp
from mpi4py import MPI
from ngsolve import CF, x
from whole import Order, Whole

from ngdgc import (LDG, BassiEtAl, BrezziEtAl, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial,
                   InteriorPenalty, NormalCompliance, ProblemError, SemismoothNewtonSolver)
from ngdgc.distributed import DistributedMesh, subspace
from ngdgc.distributed.local import LocalFacets
from ngdgc.mesh.facets import Csr, Facets
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.plots import ContactFigure

COMM = MPI.COMM_WORLD
METHODS = {f"{method.__name__} {form} {order}": (method(form=form), order)
           for method in (InteriorPenalty, BassiEtAl, BrezziEtAl, LDG) for form in ("edge", "lifting")
           for order in ((1, 2) if form == "edge" else (1,))}


def Problem(dim, friction=0.3, nu=0.3):
    """A block that is pressed on a curved foundation and pushed along it, softer on one side: all its data vary."""
    down, push = (0.0,) * (dim - 1) + (-0.03,), (3.0,) + (0.0,) * (dim - 1)
    foundation = Foundation("bottom", NormalCompliance(1000 * (1 + x)), friction=CoulombFriction(friction * (1 + x)),
                            gap=0.2 * (x - 0.5) ** 2)
    return ContactProblem(HookeMaterial(E=1000 * (1 + x), nu=nu), foundation, dirichlet={"top": CF((0.01, *down[1:]))},
                          traction={"left": CF(push)}, force={"right": push}, bodyforce=CF(down))


def Coarse(dim):
    return BoxMesh(2) if dim == 3 else RectangleMesh(3)


def Rows(dim):
    """{method: largest difference to one process of matrix, load, energy of prescribed displacements}, without halves too."""
    found, problem = {}, Problem(dim)
    for name, (method, order) in [*METHODS.items(), ("cut facets as boundary", (InteriorPenalty(), 1))]:
        inner = LocalFacets.interior
        if name.startswith("cut"):
            LocalFacets.interior = Facets.interior
        disc = Discretization(problem, method, DistributedMesh(Coarse(dim), refine=1), order=order)
        starts, columns, values = disc.matrix.getValuesCSR()
        energy = disc.facetform.PrescribedEnergy()
        LocalFacets.interior = inner
        parts, loads = COMM.gather((starts, columns, values)), COMM.gather(disc.load)
        whole = Whole(disc.numbering.local, COMM)
        if COMM.rank == 0:
            serial = Discretization(problem, method, whole, order=order)
            place = Order(dim, whole.ne, disc.numbering.functions)
            matrix, load = Csr(serial.matrix)[place][:, place], serial.load[place]
            rows = sp.vstack([sp.csr_matrix((part[2], part[1], part[0]), shape=(len(part[0]) - 1, len(load)))
                              for part in parts])
            found[name] = max(abs(rows - matrix).max() / abs(matrix).max(),
                              np.abs(np.concatenate(loads) - load).max() / np.abs(load).max(),
                              abs(energy / serial.form.PrescribedEnergy() - 1))
    return found


def Solution(dim):
    """Differences of displacement, forces, means, energy, zones to those of one process; are arrays the same on all ranks?"""
    found = {}
    for name in ("InteriorPenalty edge 1", "LDG lifting 1", "BrezziEtAl edge 2", *["InteriorPenalty nu=.499 1"] * (dim == 2)):
        method, order = METHODS.get(name, (InteriorPenalty(), 1))
        problem = Problem(dim, nu=0.499 if "nu" in name else 0.3)
        disc = Discretization(problem, method, DistributedMesh(Coarse(dim), refine=1), order=order)
        solution = disc.Solve()
        same = len({crc32(part) for part in COMM.allgather(solution.traction.tobytes() + solution.zones.tobytes())}) == 1
        without = COMM.allgather(len(disc.contact.mine)).count(0)
        vectors, whole = COMM.gather(solution.vector), Whole(disc.numbering.local, COMM)
        with patch.object(subspace, "FACTORISED", 0):
            iterated = disc.Solve().vector if dim == 2 and name.startswith("LDG") else solution.vector
        iterated = max(COMM.allgather(np.abs(iterated - solution.vector).max()))
        if COMM.rank == 0:
            serial = SemismoothNewtonSolver().Solve(Discretization(problem, method, whole, order=order))
            u = serial.vector[Order(dim, whole.ne, disc.numbering.functions)]
            numbers, other = solution.ToJSON(), serial.ToJSON()
            forces = [solution.Force(region) - serial.Force(region) for region in ("top", "bottom", "left", "right")]
            found[name] = {
                "vector": np.abs(np.concatenate(vectors) - u).max() / np.abs(u).max(),
                "forces": np.abs(forces).max() / np.abs(serial.Force("top")).max(),
                "factors or steps": iterated / np.abs(u).max(),
                "mean": np.abs(solution.Mean("left") - serial.Mean("left")).max() / np.abs(u).max(),
                "energy": abs(solution.energy / serial.energy - 1),
                "zones": max(abs(numbers["zones"][zone] - other["zones"][zone]) for zone in numbers["zones"]),
                "resultants": max(np.abs(np.subtract(a["force"] + a["moment"], b["force"] + b["moment"])).max()
                                  for a, b in zip(numbers["resultants"], other["resultants"])),
                "balance": max(numbers["global_imbalance"], numbers["element_imbalance"], numbers["equilibrium_residual"]),
                "kinds": [a["kind"] for a in numbers["resultants"]] == [a["kind"] for a in other["resultants"]],
                "zones met": sum(size > 0 for size in other["zones"].values()), "same": same, "without contact": without,
                "report": "worst element" in solution.Report()}
    return found


def Together():
    """Words of what rank 0 finds wrong, and of what rank 1 alone does; then that one fails by itself, and all of them end."""
    mesh = DistributedMesh(RectangleMesh(2), refine=1)

    def Tell(number, Try):
        try:
            Try()
            words = "nothing"
        except ProblemError as error:
            words = str(error)
        print(f"words {number} {words}\n", end="", flush=True)
        COMM.Barrier()

    def Make(**options):
        return Discretization(Problem(2), InteriorPenalty(), mesh, order=1, **options)

    Tell(0, lambda: Make(assembly="skeleton"))
    free, spread = psutil.virtual_memory, []
    with patch.object(DistributedMesh, "Spread", lambda *_: spread.append(True)):
        with patch.object(psutil, "virtual_memory", (lambda: SimpleNamespace(available=1e3)) if COMM.rank == 1 else free):
            Tell(1, Make)
    assert not spread       # nothing is begun
    folder = Path(sys.argv[2])
    solution = Make().Solve()
    if COMM.rank == 0:      # which none of the others is asked for
        told = solution.Report(), solution.ToJSON(), solution.ZoneLengths(), solution.Table(), ContactFigure(solution)
        assert all(map(bool, told[:3]))
    COMM.Barrier()
    solution.Save(folder)
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    COMM.Barrier()

    def Full(*_, **__):
        raise OSError(28, "No space left on device")

    with patch.object(np, "savez_compressed", Full if COMM.rank == 1 else np.savez_compressed):
        Tell(2, lambda: solution.Save(folder))
    assert before == {path.name: path.read_bytes() for path in folder.iterdir()}
    COMM.Barrier()
    if COMM.rank == 1:
        raise ValueError("rank 1 has failed")
    COMM.Barrier()


if __name__ == "__main__":
    what, *dims = sys.argv[1:]
    if what == "together":      # then what follows is a folder
        Together()
    else:
        result = {dim: {"rows": Rows, "solution": Solution}[what](int(dim)) for dim in dims}
        if COMM.rank == 0:
            print(json.dumps(result, default=lambda value: value.item()))
