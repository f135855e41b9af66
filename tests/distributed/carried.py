"""Run by test_ranks.py on several ranks: a part from CAD on two foundations, led along loads, saved, written, drawn.

mpirun -n 3 python -m mpi4py carried.py FOLDER
"""

import json
import sys
from pathlib import Path
from zlib import crc32

import numpy as np
from mpi4py import MPI
from netgen.occ import OCCGeometry, WorkPlane
from ngsolve import CF, Mesh, Parameter, x
from whole import Order, Whole

from ngdgc import (LDG, ArchardWear, ContactProblem, ContactSolution, CoulombFriction, Discretization, Foundation,
                   HookeMaterial, NormalCompliance, SemismoothNewtonSolver, SolveHistory)
from ngdgc.distributed import DistributedMesh
from ngdgc.distributed.picture import PictureMesh
from ngdgc.export import WriteContactVTK, WriteHTML, WriteVTK
from ngdgc.plots import ContactFigure, DeformedFigure

COMM, FOLDER = MPI.COMM_WORLD, Path(sys.argv[1])
t = Parameter(1.0)


def Part():
    """An L from CAD, its lower sides named."""
    face = WorkPlane().MoveTo(0, 0).Line(2).Rotate(90).Line(0.5).Rotate(90).Line(1).Rotate(-90).Line(0.5).Rotate(90).Line(1) \
        .Rotate(90).Line(1).Face()
    for edge in face.edges:
        px, py = edge.center.x, edge.center.y
        edge.name = "base" if py < 1e-9 else "clamp" if px < 1e-9 else "ledge" if abs(py - 0.5) < 1e-9 else "free"
    return Mesh(OCCGeometry(face, dim=2).GenerateMesh(maxh=0.5))


def Problem():
    """Pressed on two foundations, one of which wears the body, and pushed along both."""
    below = Foundation("base", NormalCompliance(2e3 * (1 + x)), friction=CoulombFriction(0.2 * (1 + x)),
                       gap=0.02 * (x - 0.7)**2, wear=ArchardWear(1e-4))
    above = Foundation("ledge", NormalCompliance(500), friction=CoulombFriction(0.9), gap=-0.03)
    return ContactProblem(HookeMaterial(E=1000, nu=0.3), [below, above],
                          dirichlet={"clamp": CF((0.01 * t, -0.02 * t * (2 - t)))}, traction={"free": CF((4 * t, -3))})


def Off(one, other):
    """Largest difference, relative."""
    return float(np.abs(np.subtract(one, other)).max() / np.abs(other).max())


def Written(solution):
    """Write all that there is, on all ranks; the names of the files are the same ones as of a solution on one machine."""
    solution.Save(FOLDER / "saved")
    WriteVTK(solution, FOLDER / "body.vtu")
    figures = ContactFigure(solution), DeformedFigure(solution)
    if COMM.rank == 0:
        WriteHTML(solution, FOLDER / "page.html")
        for number, figure in enumerate(figures):
            figure.savefig(FOLDER / f"figure-{number}.png")


def Main():
    problem, mesh = Problem(), DistributedMesh(Part(), refine=1)
    disc = Discretization(problem, LDG(), mesh, order=2)
    solution = disc.Solve()
    Written(solution)
    history = SolveHistory(disc, parameter=t, times=np.linspace(0.3, 1.8, 3), solver=SemismoothNewtonSolver(tol=1e-11))
    last = history[-1]
    same = len({crc32(part) for part in COMM.allgather(b"".join(array.tobytes() for array in (
        solution.traction, solution.zones, history.traction, history.work, last.traction)))}) == 1
    last.Save(FOLDER / "last")
    WriteContactVTK(last, FOLDER / "contact")
    vectors, whole = COMM.gather(solution.vector), Whole(disc.numbering.local, COMM)
    if COMM.rank:
        return
    serial = Discretization(problem, LDG(), whole, order=2)
    alone = SemismoothNewtonSolver(tol=1e-11).Solve(serial)
    read, place = ContactSolution.Load(FOLDER / "saved", problem), Order(2, whole.ne, disc.numbering.functions)
    path = SolveHistory(serial, parameter=t, times=history.times, solver=SemismoothNewtonSolver(tol=1e-11))
    t.Set(history.times[-1])
    end = ContactSolution.Load(FOLDER / "last", problem)
    forces = {name: Off(history.forces[name], path.forces[name]) for name in path.forces}
    numbers = {name: Off(getattr(history, name), getattr(path, name)) for name in ("work", "energy", "dissipation", "abrasion")}
    picture = solution.picture
    print(json.dumps({
        "solution": Off(np.concatenate(vectors), alone.vector[place]), "read": Off(read.vector, alone.vector),
        "law read": Off(np.sort(read.pressure), np.sort(alone.pressure)), "elastic": Off(solution.energy, alone.energy),
        "last read": Off(end.vector, path[-1].vector),
        "pressure read": Off(np.sort(end.pressure), np.sort(path[-1].pressure)),
        "worn": Off(np.sort(last.worn), np.sort(path.worn[-1])), **forces, **numbers,
        "picture": max(Off(picture.Force("base"), solution.Force("base")), Off(picture.energy, solution.energy)),
        "same": same, "sunk": last.weights @ last.penetration,
        "zones": solution.ZoneLengths(), "elements": [PictureMesh(mesh).ne, mesh.ne],
        "without contact": [name for name in ("base", "ledge") if not np.any(solution.Force(name))]}))


if __name__ == "__main__":
    Main()
