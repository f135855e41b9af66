"""A preconditioner for the symmetric discontinuous methods in which no matrix on V_h is factorised.

One V-cycle through nested spaces, with Galerkin matrices A_i = E' A E of the matrix it is made for:

    V_h            order k, Gauss-Seidel over elements
    W_k, k >= 2    partly continuous functions of order k, Gauss-Seidel over the stars of vertices (Pavarino 1994)
    W_1            partly continuous functions of order 1, one cycle of smoothed aggregation (Vanek, Mandel, Brezina 1996)

Every step backwards is the adjoint of one forwards, so that the cycle is symmetric positive definite.  H1 as the auxiliary
space, all its functions continuous, is that of Antonietti, Ayuso de Dios, Brenner, Sung 2012.  But a jump across e costs
|e|^2/|K| per size: across the small facets of stretched elements so little that continuous functions miss it, and the number of
steps grows with the aspect ratio.  W_k is therefore continuous across the strong facets only,

    |e|^2 >= STRONG max_e' |e'|^2    over the facets e' of one of the two elements,

which on elements of moderate shape are all of them, W_k = H1.

For nearly incompressible materials all levels under V_h are those of the module `solenoidal`.
"""

from __future__ import annotations

from itertools import chain
from typing import Any

import numpy as np
from ngsolve import CELL, VOL, BaseMatrix, BaseVector, ConvertOperator, CreateVVector, ElementId, H1, L2, NodeId

from ..contracts import Array, Preconditioner
from ..mesh.components import Connected
from ..mesh.facets import Facets, Native, RigidMotionsAt
from ..tools import sparse as sp
from ..tools.parallel import Batched, OneThread
from .cycles import Correction, Corners, Cycle, Entries, Galerkin, Groups
from .elementblocks import ElementBlocks, ElementOrder
from .solenoidal import NeedsSolenoidal, SolenoidalLevels

STRONG = 0.1
AGGREGATED = 0.05       # |A_ij|^2 >= AGGREGATED^2 |A_ii| |A_jj|: coupling along which vertices are aggregated
COARSEST = 50           # aggregates, of six unknowns each, that are left to a dense pseudo-inverse: pyamg counts blocks


class PartlyContinuous:
    """W_k, the functions of order k on a mesh that are continuous across strong facets.

    Its dofs are those of H1, one copy for every part into which weak facets cut the elements around; those of vertices come
    first.  Component i of the vector-valued space has the numbers d j + i.

    Attributes
    ----------
    vertex : number of the vertex of each dof of W_1, (vertices with copies,);  size : scalar dofs
    """

    def __init__(self, facets: Facets, order: int) -> None:
        self.mesh, self.order, self.scalar = facets.mesh, order, H1(facets.mesh, order=order)
        self.elements, self.dofs = Corners(self.scalar)
        corners, ndof = len(self.dofs), self.scalar.ndof
        table = sp.csr_matrix((np.arange(1.0, corners + 1), (self.elements, self.dofs)), shape=(self.mesh.ne, ndof))
        first, second = (table[elements] for elements in StrongNeighbours(facets))
        shared = (first > 0).multiply(second > 0)
        ends = [sp.csr_matrix(table.multiply(shared)).data.astype(np.int64) - 1 for table in (first, second)]
        parts = Connected(corners, *ends)
        # Numbered by H1's dofs, of which those of vertices are the first.
        keys, self.copies = np.unique(self.dofs * corners + parts, return_inverse=True)
        self.size, self.vertex = len(keys), keys[keys < self.mesh.nv * corners] // corners

    def Copy(self, elements: np.ndarray, dofs: np.ndarray) -> np.ndarray:
        """Number in W_k of a dof of H1 in an element, for arrays."""
        ndof = self.scalar.ndof
        return self.copies[np.searchsorted(self.elements * ndof + self.dofs, elements * ndof + dofs)]

    def Embedding(self) -> sp.csr_matrix:
        """E from the vector-valued W_k to V_h, scipy CSR."""
        dim, target = self.mesh.dim, L2(self.mesh, order=self.order)
        values = Entries(ConvertOperator(self.scalar, target)).tocoo()
        rows, columns, entries = values.row.astype(np.int64), values.col.astype(np.int64), values.data
        elements, dofs = Corners(target)
        copies = self.Copy(elements[np.argsort(dofs)][rows], columns)
        return sp.csr_matrix((np.tile(entries, dim), (np.concatenate([rows + i * target.ndof for i in range(dim)]),
                                                      np.concatenate([dim * copies + i for i in range(dim)]))),
                             shape=(dim * target.ndof, dim * self.size))

    def RigidMotions(self) -> Array:
        """The rigid motions in W_1, (dofs, motions)."""
        points = np.array(self.mesh.ngmesh.Coordinates())[self.vertex, :self.mesh.dim]
        return RigidMotionsAt(points - points.mean(axis=0)).reshape(-1, points.size).T.copy()

    def Stars(self) -> list[list[int]]:
        """Blocks: for each vertex, with its copies, the dofs of the vertices, edges, faces and cells that contain it."""
        mesh = self.mesh
        pairs = [np.tile(np.arange(mesh.nv), (2, 1))]
        nodes = [(node, node.vertices) for node in chain(mesh.edges, mesh.faces)]
        if mesh.dim == 3:
            nodes += [(NodeId(CELL, number), mesh[ElementId(VOL, number)].vertices) for number in range(mesh.ne)]
        for node, vertices in nodes:
            inside = self.scalar.GetDofNrs(node)
            vertices = [vertex.nr for vertex in vertices]
            pairs.append(np.array([np.repeat(inside, len(vertices)), np.tile(vertices, len(inside))], dtype=np.int64))
        dofs, vertices = np.concatenate(pairs, axis=1)
        around = sp.csr_matrix((np.ones(len(dofs)), (dofs, vertices)), shape=(self.scalar.ndof, mesh.nv))[self.dofs].tocoo()
        centres = self.Copy(self.elements[around.row], around.col.astype(np.int64))
        centres, members = np.unique(np.stack([centres, self.copies[around.row]]), axis=1)
        return Groups(np.repeat(centres, mesh.dim), (mesh.dim * members[:, None] + np.arange(mesh.dim)).ravel())


def StrongNeighbours(facets: Facets) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the two elements at each strong facet, two arrays; facets of joints are none."""
    incidence, byelement = facets.incidence, facets.incidence.tocsc()
    largest = np.maximum.reduceat(byelement.data, byelement.indptr[:-1]) ** 2
    inner = incidence.indptr[:-1][(facets.neighbours == 2) & ~facets.cut]
    pair = incidence.indices[inner], incidence.indices[inner + 1]
    strong = incidence.data[inner] ** 2 >= STRONG * np.minimum(largest[pair[0]], largest[pair[1]])
    return pair[0][strong], pair[1][strong]


class Aggregation:
    """One V-cycle of smoothed aggregation for a scipy matrix with `dim` unknowns at each vertex, rigid motions preserved."""

    def __init__(self, matrix: sp.csr_matrix, motions: Array, dim: int) -> None:
        import pyamg        # slow to import; it brings scipy's BLAS

        smoother = ("block_gauss_seidel", {"sweep": "symmetric"})
        # By default the prolongation is damped by an eigenvalue estimated from a random start: other steps in every run.
        damped = ("jacobi", {"omega": 1.0, "weighting": "local"})
        with OneThread():
            self.levels = pyamg.smoothed_aggregation_solver(
                matrix.tobsr((dim, dim)), B=motions, symmetry="symmetric", strength=("symmetric", {"theta": AGGREGATED}),
                smooth=damped, presmoother=smoother, postsmoother=smoother, improve_candidates=None, max_coarse=COARSEST)
            self._cycle = self.levels.aspreconditioner(cycle="V")
            # The first time makes the pseudo-inverse on the last level, for which threads of BLAS would fight.
            self._cycle @ np.zeros(len(motions))

    def Mult(self, b: BaseVector, x: BaseVector) -> None:
        """x = P b, NGSolve vectors."""
        x.FV().NumPy()[:] = self._cycle @ b.FV().NumPy()


def ContinuousLevels(disc: Any, matrix: sp.csr_matrix) -> tuple[sp.csr_matrix, Preconditioner]:
    """(E, C): the embedding of W_k in V_h, and the cycle on it, for a scipy matrix on V_h."""
    dim, auxiliary = disc.mesh.dim, PartlyContinuous(disc.facets, disc.order)
    embedding = auxiliary.Embedding()
    inner = Galerkin(matrix, embedding)
    vertices = dim * len(auxiliary.vertex)
    coarse: Preconditioner = Aggregation(inner[:vertices, :vertices], auxiliary.RigidMotions(), dim)
    if disc.order > 1:
        native, injection = Native(inner), sp.eye(inner.shape[0], vertices, format="csr")
        coarse = Cycle(native.CreateBlockSmoother(auxiliary.Stars()), Correction(native, injection, coarse))
    return embedding, coarse


class VCycle:
    """The V-cycle for an NGSolve matrix, symmetric positive definite, on the space of a discontinuous Discretization.

    It keeps `contracts.PreconditionerMaker`, and `Equations` of the module `conjugategradients`, for vectors in the order of
    `elementblocks`; `free` are all dofs.
    """

    @Batched
    def __init__(self, matrix: BaseMatrix, free: Any, disc: Any) -> None:
        mesh = disc.mesh
        self.order = ElementOrder(L2(mesh, order=disc.order), mesh.dim)
        levels = SolenoidalLevels if NeedsSolenoidal(disc) else ContinuousLevels
        embedding, self._coarse = levels(disc, sp.csr_matrix(matrix.CSR(), shape=matrix.shape))
        self._embedding = self.order.Rows(embedding)
        self._restriction = self._embedding.T.tocsr()
        self._source, self._target = (CreateVVector(embedding.shape[1]) for _ in range(2))
        self.blocks = ElementBlocks(matrix, self.order)
        self.To, self.From, self.Product = self.order.To, self.order.From, self.blocks.Product
        self.diagonal = self.blocks.diagonal.diagonal()

    def Precondition(self, b: Array) -> tuple[Array, Array]:
        """(z, A z) with z = P b."""
        blocks = self.blocks
        x = blocks.Forwards(b)
        self._source.FV().NumPy()[:] = self._restriction @ (blocks.upper @ -x)
        self._coarse.Mult(self._source, self._target)
        x += self._embedding @ self._target.FV().NumPy()
        rest = b - blocks.lower @ x
        z = blocks.Backwards(rest)
        return z, rest + blocks.lower @ z

    def Mult(self, b: BaseVector, x: BaseVector) -> None:
        """x = P b, NGSolve vectors."""
        x.FV().NumPy()[:] = self.From(self.Precondition(self.To(b.FV().NumPy()))[0])
