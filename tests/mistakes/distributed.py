"""Mistakes with meshes that are spread over processes; none of them needs PETSc."""

import sys
from types import SimpleNamespace
from unittest.mock import MagicMock, patch

import numpy as np
from ngsolve import CF

from ngdgc import (Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial,
                   NonsymmetricInteriorPenalty, LDG, NormalCompliance, ProblemError)
from ngdgc.distributed import DistributedMesh
from ngdgc.distributed.cycle import CycleInverse
from ngdgc.distributed.petsc import OnAll
from ngdgc.distributed.problem import DistributedProblem
from ngdgc.distributed.solution import DistributedSolution
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.methods.guarantee import Guarantee
from ngdgc.solution.parts import Ordered


class Lone:
    """A communicator of one rank."""

    rank, size = 0, 1

    def bcast(self, value):
        return value

    def allgather(self, value):
        return [value]


def Spread(*, method=None, mesh=None, nu=0.3, dirichlet=None, foundation=None, **options):
    """A Discretization on a DistributedMesh, as far as it comes without PETSc."""
    foundation = foundation or Foundation("bottom", NormalCompliance(1), friction=CoulombFriction(0.3))
    problem = ContactProblem(HookeMaterial(E=1, nu=nu), foundation,
                             dirichlet={"top": CF((0, 0))} if dirichlet is None else dirichlet)
    return Discretization(problem, method or LDG(), DistributedMesh(mesh or RectangleMesh(2), comm=Lone()), **options)


def Curved():
    mesh = RectangleMesh(1)
    mesh.Curve(2)
    return mesh


def Without():
    with patch.dict(sys.modules, {"petsc4py": None}):
        DistributedMesh(RectangleMesh(1))


def Made(kind, **attributes):
    made = object.__new__(kind)
    made.__dict__.update(attributes)
    return made


def Failing():
    raise ProblemError("the matrix of this rank would take 9 GB, and 1 GB is free; take more ranks")


def Moved():
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("bottom", NormalCompliance(1)), dirichlet={"top": (0, 0)})
    contact = Discretization(problem, LDG(), RectangleMesh(2)).contact
    Ordered("here", contact, {"points": contact.coordinates + 1e-3})


def NotSolved():
    inverse = Made(CycleInverse, iterations=0, _ksp=MagicMock(), _load=MagicMock(), _solution=MagicMock())
    inverse._ksp.getIterationNumber.return_value, inverse._ksp.getConvergedReason.return_value = 500, -3
    inverse.Solve(np.zeros(2))


ELSEWHERE = Made(DistributedSolution, disc=SimpleNamespace(mesh=SimpleNamespace(coarse=RectangleMesh(1))),
                 _onregions=np.zeros((3, 4, 2)))
DISTRIBUTED = [
    (lambda _: Without(), "DistributedMesh needs petsc4py and mpi4py | not installed | take an ngsolve.Mesh"),
    (lambda _: DistributedMesh("part.msh", comm=Lone()), "coarse is 'part.msh' | the same on every rank | give"),
    (lambda _: DistributedMesh(BoxMesh(1, cells="hex"), comm=Lone()),
     "coarse has elements | neither triangles nor tetrahedra | make a mesh of simplices"),
    (lambda _: DistributedMesh(Curved(), comm=Lone()), "coarse is curved | its refinement would not be | give a mesh"),
    (lambda _: DistributedMesh(RectangleMesh(1), comm=SimpleNamespace(rank=0, size=3)),
     "refine is 0 | 2 elements for 3 ranks | refine more"),
    (lambda _: Spread(method=NonsymmetricInteriorPenalty()), "method NIPG | cycle is not made for | take a symmetric one"),
    (lambda _: Spread(assembly="skeleton"), "DistributedMesh is not for | assembly='skeleton' | take 'facet'"),
    (lambda _: Spread(dirichlet={}), "a body that only its foundation holds | only contact resists | add dirichlet"),
    (lambda _: Spread(nu=0.4995), "nearer to incompressible | nu = .499 | take an ngsolve.Mesh"),
    (lambda _: Spread(method=Conforming()), "DistributedMesh is not for method H1 | belong to several elements | take a"),
    (lambda _: Spread(dirichlet={"[b-z].*": CF((0, 0))}, foundation=Foundation("a.*", NormalCompliance(1)),
                      mesh=Named()), "also matches | 'between ranks' | name the boundaries"),
    (lambda _: Made(DistributedProblem).facets, "facets is not known | DistributedMesh | take an ngsolve.Mesh"),
    (lambda _: Made(DistributedProblem, local=SimpleNamespace(form=SimpleNamespace(guarantee=Guarantee("unknown")))).matrix,
     "not certain to be coercive | no eigenvalue | take penalty='auto'"),
    (lambda _: Made(DistributedProblem).Add("form"), "'form' cannot be added | several ranks | take an ngsolve.Mesh"),
    (lambda _: Made(DistributedProblem).Solve(coarser=()), "coarser is () | no coarser mesh predicts | leave it out"),
    (lambda _: OnAll(Lone(), Failing), "the matrix of this rank | 1 GB is free | take more ranks"),
    (lambda _: NotSolved(), "conjugate gradients | 1.0e-11 in 500 steps | take another mesh"),
    (lambda _: ELSEWHERE.Force("top", material="a"), "material is 'a' | parts of the body are not known | leave it out"),
    (lambda _: ELSEWHERE.Mean("top"), "boundary 'top' is not | where alone forces are known | give one that is"),
    (lambda _: ELSEWHERE.At(0.5, 0.5), "At of a solution on a DistributedMesh | elements of other ranks | take gfu"),
    (lambda _: Moved(), "the solution in here was computed with another problem | its points differ | give the one"),
]


def Named():
    """A square with boundaries "a" and "b" of which expressions can be wide."""
    mesh = RectangleMesh(1)
    for number, name in enumerate(mesh.GetBoundaries()):
        mesh.ngmesh.SetBCName(number, "a" if name == "bottom" else "b")
    return type(mesh)(mesh.ngmesh)
