"""What may be added to a stress in equilibrium: rows that are curls, such that it comes near C eps(u_h).

    s + curl w,    row by row w in H1 (in the plane), H(curl) (in space) of order k + 1, w = 0, w x n = 0 off Gamma_D,

has the divergence of s and its traction off Gamma_D.  The least |s + curl w - C eps(u_h)| in the norm of C^-1, in which
SKEW/(2 mu) counts for skew parts, is approached by sweeps of Gauss and Seidel, forth and back, over the stars of vertices, in
space of edges.  Of a nearly incompressible body that is needed: pressures lam div u_h that oscillate cost next to nothing in
C^-1, but moments of u_h carry them into the other components of s, where they cost sqrt(lam/mu) times as much.

Source: stresses in equilibrium made better by functions without divergence on stars of vertices: Ainsworth and Oden, A
Posteriori Error Estimation in Finite Element Analysis, Wiley 2000, chapter 6.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import (BND, CF, H1, L2, VOL, BilinearForm, BitArray, Cross, ElementId, FacetFESpace, FESpace, GridFunction, HCurl,
                     InnerProduct, LinearForm, Mesh, Region, dx, specialcf)
from ngsolve.la import BaseMatrix
from ngsolve import curl as Curl
from ngsolve import grad as Gradient

from ..blocks.integrals import SymmetricBasis
from ..blocks.reference import Values
from ..contracts import Array
from ..linear.cycles import Entries
from ..mesh.facets import Free, Native, Threads, VolumePoints
from ..problem.materials import StiffnessAt
from ..tools import sparse as sp
from .equilibrated import EquilibratedStress

ROUNDOFF = 1e-13    # of functions in terms of others, relative to the largest
KERNEL = 1e-8       # in space, where gradients have no curl: times |w|^2 over the square of the size of the body
SKEW = 30           # so much more the skew part counts here than in the estimate, which sees too little of it
STARS = {2: "vertexpatch", 3: "edgepatch"}


def Relaxed(stress: EquilibratedStress, sweeps: int) -> EquilibratedStress:
    """s + curl w after as many sweeps."""
    disc = stress.disc
    mesh, dim, order = disc.mesh, disc.mesh.dim, disc.order + 1
    fixed = _Fixed(disc)
    space = _Space(mesh, order, fixed)
    w, z = space.TnT()
    compliance = _Compliance(disc.problem.material, mesh)
    with Threads(mesh):
        energy = InnerProduct(compliance * _Rows(w), _Rows(z))
        if dim == 3:
            energy += _Kernel(disc) * sum(InnerProduct(one, other) for one, other in zip(w, z))
        form = BilinearForm(energy * dx, condense=True).Assemble()
        load = LinearForm(-InnerProduct(compliance * _Difference(stress), _Rows(z)) * dx).Assemble().vec
        load.data += form.harmonic_extension_trans * load
        basis, blocks = _WithoutRotation(space, disc.facets, fixed)
        transposed = basis.CreateTranspose()
        matrix = transposed @ form.mat @ basis
        smoother, vector, right = matrix.CreateBlockSmoother(blocks), matrix.CreateColVector(), matrix.CreateColVector()
        right.data, vector[:] = transposed * load, 0
        for _ in range(sweeps):
            smoother.Smooth(vector, right)
            smoother.SmoothBack(vector, right)
        function = GridFunction(space)
        function.vec.data = basis * vector
        function.vec.data += form.harmonic_extension * function.vec
        function.vec.data += form.inner_solve * load
    return stress.With(_Rows(function.components))


def _Space(mesh: Mesh, order: int, fixed: Region) -> FESpace:
    """Rows of w."""
    rows = H1(mesh, order=order, dirichlet=fixed) if mesh.dim == 2 else HCurl(mesh, order=order, nograds=True, dirichlet=fixed)
    return FESpace([rows] * mesh.dim)


def _Kernel(disc: Any) -> float:
    size = np.ptp(disc.mesh.ngmesh.Coordinates(), axis=0).max()
    return float(KERNEL / (2 * size ** 2 * disc.problem.material.ShearAt(VolumePoints(disc.mesh, 0)).min()))


def _WithoutRotation(space: FESpace, facets: Any, fixed: Region) -> tuple[BaseMatrix, list[list[int]]]:
    """Functions w, in columns, of which the skew part of curl w has mean 0 on all elements; and those of each star.

    That mean is a sum over the sides of int w.n, in space of int n x w_i: functions that belong to a side are combined such
    that there these are 0, and all others get of them what makes theirs 0; their columns replace those of the space, some are
    empty.  Beyond the space come functions with as much in as out of every element, around the vertices, in space the edges.
    """
    moments, free, mesh = _Moments(space, facets), Free(space, inner=False), space.mesh
    many = facets.space.ndof
    count = moments.shape[0] // many
    bysize: dict[int, list[tuple[int, list[int]]]] = {}
    for facet in mesh.facets:
        inside = [dof for dof in space.GetDofNrs(facet) if free[dof]]
        # A mesh that was refined keeps facets that were halved, to which no space gives functions.
        for number in facets.space.GetDofNrs(facet) if inside else ():
            bysize.setdefault(len(inside), []).append((number, inside))
    kernel, lift = sp.coo_matrix((moments.shape[1], moments.shape[1])), sp.coo_matrix(moments.T.shape)
    for size, found in bysize.items():
        dofs = np.array([inside for _, inside in found])
        tested = np.array([[number] for number, _ in found]) + many * np.arange(count)
        free[dofs] = False
        local = moments[np.repeat(tested, size, axis=1).ravel(), np.tile(dofs, count).ravel()]
        left, values, right = np.linalg.svd(np.asarray(local).reshape(-1, count, size))
        right = np.swapaxes(right, 1, 2)        # facet, functions, combinations
        kernel = kernel + _Scattered(dofs, dofs[:, count:], right[..., count:], kernel.shape)
        lift = lift + _Scattered(dofs, tested, right[..., :count] / values[:, None] @ np.swapaxes(left, 1, 2), lift.shape)
    others = sp.diags(free.astype(float))
    loops, nodes = _Loops(mesh, facets, fixed)
    around = lift @ sp.kron(sp.identity(count), loops)
    basis = sp.hstack([kernel + others - lift @ moments @ others, around]).tocsc()
    basis.data[np.abs(basis.data) <= ROUNDOFF * np.abs(basis.data).max()] = 0
    basis.eliminate_zeros()
    there = np.diff(basis.indptr) > 0
    blocks = [[dof for dof in block if there[dof]] for block in space.CreateSmoothingBlocks(blocktype=STARS[mesh.dim])]
    # The first function of a star belongs to its vertex or edge, and has its number.
    for dof, node in enumerate(np.tile(nodes, count).tolist(), start=space.ndof):
        blocks[node].append(dof)
    return Native(basis), [block for block in blocks if block]


def _Loops(mesh: Mesh, facets: Any, fixed: Region) -> tuple[sp.csr_matrix, np.ndarray]:
    """(facets, loops): moments on facets of curls, of sum 0 over the sides of every element; and the nodes of the curls."""
    space = H1(mesh, order=1, dirichlet=fixed) if mesh.dim == 2 else HCurl(mesh, order=0, dirichlet=fixed)
    tested = FacetFESpace(mesh, order=0)
    flux = InnerProduct(_Curl(space.TrialFunction()), specialcf.normal(mesh.dim))
    form = BilinearForm(trialspace=space, testspace=tested)
    form += facets.orientation * flux * tested.TestFunction() * dx(element_boundary=True)
    nodes = np.flatnonzero(Free(space))
    return Entries(form.Assemble().mat)[:, nodes], nodes


def _Moments(space: FESpace, facets: Any) -> sp.csr_matrix:
    """int_e of w.n, or of the components of sum_i e_i x (n x w_i), on the facets, (components facets, functions)."""
    mesh, n = space.mesh, specialcf.normal(space.mesh.dim)
    w = space.TrialFunction()
    if mesh.dim == 2:
        rotation = [w[0] * n[0] + w[1] * n[1]]
    else:
        turned = [Cross(n, row) for row in w]
        rotation = [turned[i][j] - turned[j][i] for i, j in ((1, 2), (2, 0), (0, 1))]
    tested = FESpace([FacetFESpace(mesh, order=0)] * len(rotation))
    form = BilinearForm(trialspace=space, testspace=tested)
    form += sum(facets.orientation * one * mu for one, mu in zip(rotation, tested.TestFunction())) * dx(element_boundary=True)
    return Entries(form.Assemble().mat)


def _Scattered(rows: Array, columns: Array, values: Array, shape: tuple[int, int]) -> sp.coo_matrix:
    """The matrix of blocks (n, a, b) in rows (n, a) and columns (n, b)."""
    rows, columns = np.broadcast_to(rows[:, :, None], values.shape), np.broadcast_to(columns[:, None], values.shape)
    return sp.coo_matrix((values.ravel(), (rows.ravel(), columns.ravel())), shape=shape)


def _Rows(functions: Any) -> Any:
    """curl w, row by row, (d d,)."""
    return CF(tuple(_Curl(row)[i] for row in functions for i in range(len(functions))))


def _Curl(row: Any) -> Any:
    """curl of a function in H1 of the plane or in H(curl), (d,)."""
    return CF((Gradient(row)[1], -Gradient(row)[0])) if row.space.mesh.dim == 2 else Curl(row)


def _Fixed(disc: Any) -> Region:
    """The outer boundary without Gamma_D."""
    facets, regions, _ = disc.facets.boundary
    fixed = np.zeros(len(disc.mesh.GetBoundaries()), dtype=bool)
    fixed[regions[disc.facets.neighbours[facets] == 1]] = True
    for region in disc.problem.dirichlet:
        fixed &= ~np.array(list(disc.mesh.Boundaries(region).Mask()))
    mask = BitArray(len(fixed))
    for number, one in enumerate(fixed):
        mask[number] = bool(one)
    return Region(disc.mesh, BND, mask)


def _Difference(stress: EquilibratedStress) -> GridFunction:
    """s - s_h in polynomials of degree k + 1 on the elements, (d d,)."""
    mesh, order = stress.disc.mesh, stress.disc.order + 1
    space = L2(mesh, order=order, dim=mesh.dim ** 2)
    scalar, function = L2(mesh, order=order), GridFunction(space)
    vector = function.vec.FV().NumPy().reshape(scalar.ndof, -1)
    for batch in stress.Batches():
        difference = (batch.equilibrated - batch.computed).reshape(*batch.weights.shape, -1)
        dofs = np.array([scalar.GetDofNrs(ElementId(VOL, int(element))) for element in batch.group.elements])
        for rows, shape in batch.group.rows:
            values = Values(L2(shape.mesh, order=order).GetFE(ElementId(VOL, 0)), shape.points)
            weighted = values.T * shape.weights
            vector[dofs[rows]] = np.linalg.solve(weighted @ values, weighted) @ difference[rows]
    return function


def _Compliance(material: Any, mesh: Mesh) -> Any:
    """C^-1 in the middle of elements on matrices (d d,), on skew ones 1/(2 mu); (d d, d d)."""
    points, dim = VolumePoints(mesh, 0), mesh.dim
    C, shear = StiffnessAt(material, points, dim), material.ShearAt(points)
    basis = SymmetricBasis(dim).reshape(-1, dim * dim)
    basis = basis / np.linalg.norm(basis, axis=1)[:, None]
    inverse = np.linalg.inv(np.einsum("cx,nxy,dy->ncd", basis, C.reshape(-1, dim * dim, dim * dim), basis))
    skew = SKEW * (np.eye(dim * dim) - basis.T @ basis) / (2 * shear[:, None, None])
    values = np.einsum("cx,ncd,dy->nxy", basis, inverse, basis) + skew
    if np.ptp(values, axis=0).max() <= 1e-12 * np.abs(values).max():
        return CF(tuple(values[0].ravel()), dims=(dim * dim, dim * dim))
    function = GridFunction(L2(mesh, order=0, dim=dim ** 4))
    function.vec.FV().NumPy()[:] = values.ravel()
    return CF(tuple(function), dims=(dim * dim, dim * dim))
