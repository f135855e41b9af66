"""The mesh that users give: coarse, and refined on the ranks, so that no process has all of it."""

from __future__ import annotations

from typing import Any

from ngsolve import ET, VOL, Mesh

from ..exceptions import ProblemError
from ..mesh.facets import Curved
from ..tools.calls import ByKeyword
from ..tools.values import Integer
from .petsc import Petsc, World
from .plex import CoarsePlex
from .problem import DistributedProblem

FINEST = 10     # refinements


@ByKeyword
class DistributedMesh:
    """A mesh whose elements are spread over the ranks of MPI: a coarse mesh, distributed and then refined there.

    Parameters
    ----------
    coarse : ngsolve.Mesh of straight triangles or tetrahedra, the same on every rank
    refine : how often each triangle is divided into 4, each tetrahedron into 8
    comm : mpi4py's communicator; None: MPI.COMM_WORLD

    It takes the place of a mesh in Discretization, whatever the number of ranks; a script is run by
    `mpirun -n 4 python -m mpi4py script.py`.  Regions are those of the coarse mesh.

    >>> from ngdgc.distributed import DistributedMesh
    >>> from ngdgc.meshes import BoxMesh
    >>> DistributedMesh(BoxMesh(4), refine=2)      # doctest: +SKIP
    DistributedMesh(24576 elements on 4 ranks)

    Raises ProblemError where petsc4py is not installed, and for a mesh that PETSc cannot refine.

    Attributes
    ----------
    dim : dimension;  ne : elements of all ranks together
    """

    def __init__(self, coarse: Mesh, *, refine: int = 0, comm: Any = None) -> None:
        self.comm = World() if comm is None else comm
        if not isinstance(coarse, Mesh):
            raise ProblemError(f"coarse is {coarse!r}; give an ngsolve.Mesh, the same on every rank")
        if not all(element.type in (ET.TRIG, ET.TET) for element in coarse.Elements(VOL)):
            raise ProblemError("coarse has elements that are neither triangles nor tetrahedra, whose corners ranks do not "
                               "number alike here; make a mesh of simplices")
        if Curved(coarse):
            raise ProblemError("coarse is curved, and its refinement would not be; give a mesh with straight elements, fine "
                               "enough for the shape, or take an ngsolve.Mesh on one machine")
        self.refine = Integer(refine, "refine", "give how often the coarse mesh is refined", least=0, most=FINEST)
        self.coarse, self.dim = coarse, coarse.dim
        self.ne = coarse.ne * 2 ** (self.dim * self.refine)
        if self.ne < self.comm.size:
            raise ProblemError(f"refine is {self.refine}, which makes {self.ne} elements for {self.comm.size} ranks; "
                               "refine more")

    def __repr__(self) -> str:
        return f"DistributedMesh({self.ne} elements on {self.comm.size} ranks)"

    def Discretize(self, problem: Any, method: Any, *, order: int, assembly: str, inverse: Any) -> Any:
        """What Discretization makes on this mesh."""
        return DistributedProblem(problem, method, self, order=order, assembly=assembly, inverse=inverse)

    def Spread(self, layers: int) -> Any:
        """PETSc's DMPlex with the own elements of each rank and `layers` of neighbours across facets."""
        plex = CoarsePlex(self.coarse, self.comm)
        plex.getPartitioner().setType(Petsc().Partitioner.Type.PTSCOTCH)
        plex.distribute(overlap=0)
        plex.setRefinementUniform(True)
        for _ in range(self.refine):
            plex = plex.refine()
        if self.comm.size > 1:
            plex.setBasicAdjacency(True, False)     # across facets
            plex.distributeOverlap(layers)
        return plex
