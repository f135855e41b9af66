"""What is not for a DistributedMesh is refused, with the reason, before anything is spread."""

from __future__ import annotations

import re
from typing import Any

from ..discrete.loads import AreaOf
from ..discrete.problem import DiscreteProblem
from ..exceptions import ProblemError
from ..linear.solenoidal import Swelling
from ..tools.memory import AssemblyBytes, CheckMemory
from .local import CUT, FOREIGN

COPIES = 3          # of what assembly takes: PETSc's matrix and its blocks beside it, levels, neighbours
STIFFEST = 499.5    # largest lam/mu, that of nu = .499: steps of the cycle, whose continuous functions lock, grow with its root


def CheckRoom(mesh: Any, order: int) -> None:
    """Raise ProblemError if the part of a rank would not fit beside those of the others on its machine."""
    from mpi4py import MPI

    needed = COPIES * AssemblyBytes(mesh.ne / mesh.comm.size, mesh.dim, order, discontinuous=True)
    neighbours = mesh.comm.Split_type(MPI.COMM_TYPE_SHARED)
    here = neighbours.size
    neighbours.Free()
    CheckMemory(needed, f"the part of a rank, {mesh.ne / mesh.comm.size:.3g} elements of order {order},",
                "more ranks on more machines, ", here)


def CheckCovered(problem: Any, method: Any, mesh: Any, order: int, assembly: str, inverse: Any) -> dict[str, float]:
    """Areas of the regions with forces; ProblemError for mistakes in the problem, seen on the coarse mesh, and for the rest."""
    coarse = DiscreteProblem(problem, method, mesh.coarse, order=order, assembly=assembly)
    remedy = "take an ngsolve.Mesh on one machine"
    iterative = method.discontinuous and method.conservative and method.symmetric and method.iterative
    several = f"method {method.name}, whose unknowns belong to several elements; take a discontinuous one"
    wrong = {several: not method.discontinuous,
             f"method {method.name}, which PETSc's cycle is not made for; take a symmetric one of Table 2": not iterative,
             "assembly='skeleton'; take 'facet'": assembly != "facet",
             "another inverse than 'auto'; leave it out": inverse != "auto",
             f"joints; {remedy}": bool(problem.joints), f"rigid punches; {remedy}": coarse.contact.punches is not None,
             f"bodies of revolution; {remedy}": problem.axisymmetric,
             f"friction bonds with a tension; {remedy}": any(part.bond for part in coarse.contact.parts)}
    for words, asked in wrong.items():
        if asked:
            raise ProblemError(f"a DistributedMesh is not for {words}")
    coarse.restraints.Check()
    if coarse.unresisted:
        raise ProblemError(f"a DistributedMesh is not for a body that only its foundation holds: only contact resists "
                           f"{coarse.unresisted}; add dirichlet, roller or spring")
    if Swelling(problem.material, mesh.coarse) > 1 + mesh.dim * STIFFEST / 2:
        raise ProblemError("the material is nearer to incompressible than nu = .499, for which PETSc's cycle would take many "
                           f"hundred steps; {remedy}, which has levels for it")
    for kind, region in problem.Regions():
        if any(re.fullmatch(region, name) for name in (CUT, FOREIGN)):
            raise ProblemError(f"{kind} region {region!r} also matches {CUT!r}, which the sides between ranks are called; name "
                               "the boundaries")
    return {region: AreaOf(problem, region, coarse.space) for region in problem.force}
