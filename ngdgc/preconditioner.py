"""A preconditioner for the symmetric discontinuous methods in which nothing global is factorised.

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
"""

from itertools import chain, pairwise

import numpy as np
import scipy.sparse as sp
from ngsolve import CELL, H1, L2, VOL, ConvertOperator, ElementId, NodeId

from .facets import Csr, Native, RigidMotionsAt

STRONG = 0.1
AGGREGATED = 0.05       # |A_ij|^2 >= AGGREGATED^2 |A_ii| |A_jj|: coupling along which vertices are aggregated
COARSEST = 300          # unknowns that are left to a dense pseudo-inverse


def Corners(space):
    """(element, dof) of all dofs of all elements of a scalar space, sorted, two arrays."""
    dofs = [element.dofs for element in space.Elements(VOL)]
    elements = np.repeat(np.arange(len(dofs)), [len(row) for row in dofs])
    keys = np.sort(elements * space.ndof + np.fromiter(chain.from_iterable(dofs), dtype=np.int64, count=len(elements)))
    return keys // space.ndof, keys % space.ndof


def Groups(keys, values):
    """Lists of the values with the same key, by increasing key: the blocks of a block smoother."""
    order = np.argsort(keys, kind="stable")
    bounds = np.flatnonzero(np.diff(keys[order], prepend=-1, append=-1)).tolist()
    values = values[order].tolist()
    return [values[a:b] for a, b in pairwise(bounds)]


class PartlyContinuous:
    """W_k, the functions of order k on a mesh that are continuous across strong facets.

    Its dofs are those of H1, one copy for every part into which weak facets cut the elements around; those of vertices come
    first.  Component i of the vector-valued space has the numbers d j + i.

    Attributes
    ----------
    vertex : number of the vertex of each dof of W_1, (vertices with copies,);  size : scalar dofs
    """

    def __init__(self, facets, order):
        self.mesh, self.order, self.scalar = facets.mesh, order, H1(facets.mesh, order=order)
        self.elements, self.dofs = Corners(self.scalar)
        corners, ndof = len(self.dofs), self.scalar.ndof
        table = sp.csr_matrix((np.arange(1.0, corners + 1), (self.elements, self.dofs)), shape=(self.mesh.ne, ndof))
        first, second = (table[elements] for elements in StrongNeighbours(facets))
        shared = (first > 0).multiply(second > 0)
        ends = [sp.csr_matrix(table.multiply(shared)).data.astype(np.int64) - 1 for table in (first, second)]
        joined = sp.coo_matrix((np.ones(len(ends[0])), ends), shape=(corners, corners))
        parts = sp.csgraph.connected_components(joined, directed=False)[1]
        # Numbered by H1's dofs, of which those of vertices are the first.
        keys, self.copies = np.unique(self.dofs * corners + parts, return_inverse=True)
        self.size, self.vertex = len(keys), keys[keys < self.mesh.nv * corners] // corners

    def Copy(self, elements, dofs):
        """Number in W_k of a dof of H1 in an element, for arrays."""
        ndof = self.scalar.ndof
        return self.copies[np.searchsorted(self.elements * ndof + self.dofs, elements * ndof + dofs)]

    def Embedding(self):
        """E from the vector-valued W_k to V_h, scipy CSR."""
        dim, target = self.mesh.dim, L2(self.mesh, order=self.order)
        values = Csr(ConvertOperator(self.scalar, target)).tocoo()
        keep = np.abs(values.data) > 1e-12 * np.abs(values.data).max()
        rows, columns, entries = values.row[keep].astype(np.int64), values.col[keep].astype(np.int64), values.data[keep]
        elements, dofs = Corners(target)
        copies = self.Copy(elements[np.argsort(dofs)][rows], columns)
        return sp.csr_matrix((np.tile(entries, dim), (np.concatenate([rows + i * target.ndof for i in range(dim)]),
                                                      np.concatenate([dim * copies + i for i in range(dim)]))),
                             shape=(dim * target.ndof, dim * self.size))

    def RigidMotions(self):
        """The rigid motions in W_1, (dofs, motions)."""
        points = np.array(self.mesh.ngmesh.Coordinates())[self.vertex, :self.mesh.dim]
        return RigidMotionsAt(points - points.mean(axis=0)).reshape(-1, points.size).T.copy()

    def Stars(self):
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


def StrongNeighbours(facets):
    """Numbers of the two elements at each strong facet, two arrays."""
    incidence, byelement = facets.incidence, facets.incidence.tocsc()
    largest = np.maximum.reduceat(byelement.data, byelement.indptr[:-1]) ** 2
    inner = incidence.indptr[:-1][facets.neighbours == 2]
    pair = incidence.indices[inner], incidence.indices[inner + 1]
    strong = incidence.data[inner] ** 2 >= STRONG * np.minimum(largest[pair[0]], largest[pair[1]])
    return pair[0][strong], pair[1][strong]


class Aggregation:
    """One V-cycle of smoothed aggregation for a scipy matrix with `dim` unknowns at each vertex, rigid motions preserved."""

    def __init__(self, matrix, motions, dim):
        import pyamg        # slow to import

        smoother = ("block_gauss_seidel", {"sweep": "symmetric"})
        # By default the prolongation is damped by an eigenvalue estimated from a random start: other steps in every run.
        damped = ("jacobi", {"omega": 1.0, "weighting": "local"})
        self.levels = pyamg.smoothed_aggregation_solver(
            matrix.tobsr((dim, dim)), B=motions, symmetry="symmetric", strength=("symmetric", {"theta": AGGREGATED}),
            smooth=damped, presmoother=smoother, postsmoother=smoother, improve_candidates=None, max_coarse=COARSEST)
        self._cycle = self.levels.aspreconditioner(cycle="V")

    def Mult(self, b, x):
        """x = P b, NGSolve vectors."""
        x.FV().NumPy()[:] = self._cycle @ b.FV().NumPy()


class Cycle:
    """x = P b: block Gauss-Seidel from zero, the correction E C E' of the rest, block Gauss-Seidel backwards.

    matrix : NGSolve's A;  blocks : lists of dofs, they may overlap;  embedding : E, scipy;  coarse : C, with Mult(b, x)
    """

    def __init__(self, matrix, blocks, embedding, coarse):
        self.matrix, self.coarse = matrix, coarse
        self.smoother = matrix.CreateBlockSmoother(blocks)
        self.embedding = Native(embedding)
        self.restriction = self.embedding.CreateTranspose()
        self.rest = matrix.CreateColVector()
        self.source, self.target = self.restriction.CreateColVector(), self.embedding.CreateRowVector()

    def Mult(self, b, x):
        x[:] = 0
        self.smoother.Smooth(x, b)
        self.rest.data = b - self.matrix * x
        self.source.data = self.restriction * self.rest
        self.coarse.Mult(self.source, self.target)
        x.data += self.embedding * self.target
        self.smoother.SmoothBack(x, b)


def Galerkin(matrix, embedding):
    """E' A E without the unsymmetry of round-off, scipy CSR."""
    product = (embedding.T @ (matrix @ embedding)).tocsr()
    return (product + product.T) / 2


def Preconditioner(disc, matrix):
    """The V-cycle for an NGSolve matrix, symmetric positive definite, on the space of a discontinuous Discretization."""
    dim, auxiliary = disc.mesh.dim, PartlyContinuous(disc.facets, disc.order)
    embedding = auxiliary.Embedding()
    inner = Galerkin(sp.csr_matrix(matrix.CSR(), shape=(matrix.height, matrix.width)), embedding)
    vertices = dim * len(auxiliary.vertex)
    coarse = Aggregation(inner[:vertices, :vertices], auxiliary.RigidMotions(), dim)
    if disc.order > 1:
        injection = sp.eye(inner.shape[0], vertices, format="csr")
        coarse = Cycle(Native(inner), auxiliary.Stars(), injection, coarse)
    elements, dofs = Corners(L2(disc.mesh, order=disc.order))
    offsets = np.arange(dim) * (disc.space.ndof // dim)
    blocks = Groups(np.repeat(elements, dim), (dofs[:, None] + offsets).ravel())
    return Cycle(matrix, blocks, embedding, coarse)
