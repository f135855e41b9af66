"""Beyond one machine: the mesh, V_h and its equations spread over the processes of MPI, by PETSc.

Here: all that knows of ranks; nothing else imports petsc4py or mpi4py.
Not here: laws, Newton's method, corrections (`contact`, `solvers`), which run unchanged on every rank with all of Gamma_C.
"""

from .mesh import DistributedMesh

__all__ = ["DistributedMesh"]
