"""The liftings r_0 and r_e of (3.2)-(3.4) as sparse operators on auxiliary spaces.

For a symmetric q, [v]:q = w.(q n) with the vector jump w = v+ - v-: the tensor jump is a vector jump against a traction.  So
everything is built from element-boundary integrals, without coupling of neighbours in the integrals:

    V_h  displacement, order k                    Q_h  symmetric matrices, piecewise of order l
    F_h  vectors on the facets, order k           E0   interior facets, Gamma_D and rollers
    K : V_h x V_h  int C eps(u):eps(v)            J : V_h x F_h  int_E0 (u+ - u-).mu
    S : V_h x F_h  int_E0 {C eps(u)} n.mu         N : Q_h x F_h  int_E0 {q} n.mu
    R : V_h x Q_h  int C eps(u):q                 M_F, M_Q, M_C  masses of F_h and Q_h, and the C-weighted one of Q_h

    r_0([u]) = -M_Q^-1 N' M_F^-1 J u              G = N M_Q^-1 M_C M_Q^-1 N'

Averages count the two sides of an interior facet by 1/2 and a boundary facet fully; the side with the smaller element number
fixes the orientation.  On a roller w = v_n n and the traction is its normal part.
"""

from functools import cached_property

import numpy as np
import scipy.sparse as sp
from ngsolve import (EDGE, FACE, L2, VOL, BilinearForm, ElementId, FacetFESpace, GridFunction, IfPos, InnerProduct,
                     MatrixValued, NodeId, VectorL2, dx, specialcf)

from .elasticity import Strain
from .exceptions import ProblemError
from .facets import Csr, Threads


class FacetOperators:
    """The matrices above as scipy CSR, each assembled when it is first used; the mass matrices as their inverses.

    Parameters
    ----------
    material, facets : of the Discretization;  order : k;  liftorder : l
    share : weight of a side in the averages, over facets: 1/2 inside, 1 on Gamma_D and rollers, 0 off E0
    rollers : True for roller facets, over facets
    """

    def __init__(self, material, facets, order, liftorder, share, rollers):
        mesh, dim = facets.mesh, facets.mesh.dim
        self.material, self.facets, self.share = material, facets, share
        self.displacements = VectorL2(mesh, order=order)
        self.liftings = MatrixValued(L2(mesh, order=liftorder), symmetric=True)
        scalar = FacetFESpace(mesh, order=order)
        self.traces = scalar ** dim
        kind, ndof = EDGE if dim == 2 else FACE, scalar.ndof
        numbers = [np.array(scalar.GetDofNrs(NodeId(kind, facet))) for facet in range(len(share))]
        self.tracedofs = [np.concatenate([dofs + i * ndof for i in range(dim)]) for dofs in numbers]
        self.facetof = np.empty(self.traces.ndof, dtype=int)
        for facet, dofs in enumerate(self.tracedofs):
            self.facetof[dofs] = facet
        self.n = specialcf.normal(dim)
        self._share, self._roller = facets.Function(share), facets.Function(rollers.astype(float))
        self._measure = dx(element_boundary=True, bonus_intorder=material.bonus)
        first = facets.Function(facets.incidence.indices[facets.incidence.indptr[:-1]].astype(float))
        number = GridFunction(L2(mesh, order=0))
        number.vec.FV().NumPy()[:] = np.arange(mesh.ne)
        # 1 in the element that fixes the orientation of the facet, -1 in the other one.
        self._sign = IfPos(0.25 - (first - number) ** 2, 1, -1)
        self._active = facets.Function((share > 0).astype(float))

    def Coupled(self, vector):
        """The part of a vector that a facet couples: its normal part on rollers, all of it elsewhere."""
        return (1 - self._roller) * vector + self._roller * (vector * self.n) * self.n

    def _Mixed(self, trial, test, integrand, measure):
        form = BilinearForm(trialspace=trial, testspace=test)
        form += integrand * measure
        with Threads(self.facets.mesh):
            return Csr(form.Assemble().mat)

    @cached_property
    def K(self):
        u, v = self.displacements.TnT()
        integrand = InnerProduct(self.material.Stress(Strain(u)), Strain(v))
        return self._Mixed(self.displacements, self.displacements, integrand, dx(bonus_intorder=self.material.bonus))

    @cached_property
    def J(self):
        u, mu = self.displacements.TrialFunction(), self.traces.TestFunction()
        return self._Mixed(self.displacements, self.traces, self._active * self._sign * self.Coupled(u) * mu, self._measure)

    @cached_property
    def S(self):
        u, mu = self.displacements.TrialFunction(), self.traces.TestFunction()
        traction = self.Coupled(self.material.Stress(Strain(u)) * self.n)
        return self._Mixed(self.displacements, self.traces, self._share * self._sign * traction * mu, self._measure)

    @cached_property
    def N(self):
        q, mu = self.liftings.TrialFunction(), self.traces.TestFunction()
        return self._Mixed(self.liftings, self.traces, self._share * self._sign * self.Coupled(q * self.n) * mu, self._measure)

    @cached_property
    def R(self):
        u, q = self.displacements.TrialFunction(), self.liftings.TestFunction()
        integrand = InnerProduct(self.material.Stress(Strain(u)), q)
        return self._Mixed(self.displacements, self.liftings, integrand, dx(bonus_intorder=self.material.bonus))

    @cached_property
    def inverseMF(self):
        """M_F^-1, block-diagonal per facet."""
        average = self.facets.Function(1 / np.maximum(self.facets.neighbours, 1))
        mu, nu = self.traces.TnT()
        mass = self._Mixed(self.traces, self.traces, average * mu * nu, dx(element_boundary=True))
        return BlockInverse(mass, self.tracedofs)

    @cached_property
    def inverseMQ(self):
        """M_Q^-1, block-diagonal per element."""
        q, p = self.liftings.TnT()
        mass = self._Mixed(self.liftings, self.liftings, InnerProduct(q, p), dx)
        return BlockInverse(mass, [np.array(self.liftings.GetDofNrs(ElementId(VOL, element)))
                                   for element in range(self.facets.mesh.ne)])

    @cached_property
    def G(self):
        """(C r_0(mu), r_0(nu)), F_h x F_h; couples the facets of one element."""
        q, p = self.liftings.TnT()
        weighted = self._Mixed(self.liftings, self.liftings, InnerProduct(self.material.Stress(q), p),
                               dx(bonus_intorder=self.material.bonus))
        lift = self.inverseMQ @ self.N.T
        return (lift.T @ weighted @ lift).tocsr()

    @cached_property
    def localG(self):
        """sum_e (C r_e(mu), r_e(nu)): the blocks of G that belong to single facets."""
        entries = self.G.tocoo()
        same = self.facetof[entries.row] == self.facetof[entries.col]
        return sp.csr_matrix((entries.data[same], (entries.row[same], entries.col[same])), shape=entries.shape)

    @cached_property
    def projectedS(self):
        """N M_Q^-1 R, the tractions of the projection of the stress on Q_h: S of the lifting forms."""
        return self.N @ (self.inverseMQ @ self.R)

    @cached_property
    def contains(self):
        """True if C eps(V_h) lies in Q_h, as far as the facets see: then edge form and lifting form are the same."""
        # Round-off of products of matrices with entries of different size.
        return abs(self.S - self.projectedS).max() <= 1e-10 * abs(self.S).max()

    def PenaltyMass(self, penalty):
        """<P(mu):[nu]> for a penalty (`penalty` module) on E0, F_h x F_h."""
        mu, nu = self.traces.TnT()
        mu, nu = self.Coupled(mu), self.Coupled(nu)
        return self._Mixed(self.traces, self.traces, self._share * (penalty.Boundary(mu, self.n) * self.n) * nu, self._measure)


def BlockInverse(matrix, blocks):
    """Inverse of a matrix that is block-diagonal over the given lists of dof numbers; other entries must be zero."""
    groups, rows, columns, entries = {}, [], [], []
    for dofs in blocks:
        groups.setdefault(len(dofs), []).append(dofs)
    for dofs in map(np.array, groups.values()):
        size = dofs.shape[1]
        row, column = np.repeat(dofs, size, axis=1).ravel(), np.tile(dofs, (1, size)).ravel()
        inverse = np.linalg.inv(np.asarray(matrix[row, column]).reshape(-1, size, size))
        rows.append(row)
        columns.append(column)
        entries.append(inverse.ravel())
    return sp.csr_matrix((np.concatenate(entries), (np.concatenate(rows), np.concatenate(columns))), shape=matrix.shape)


class Lifting:
    """r_0 and r_e of a DG discretisation, as functions in Q_h (3.2)-(3.3).

    disc : Discretization with a discontinuous method;  order : l >= 0, the degree of Q_h, by default k
    `space` is Q_h.  Jumps on Gamma_D are those of homogeneous data.

    Raises ProblemError for the conforming method, whose functions do not jump, and for l < 0.
    """

    def __init__(self, disc, *, order=None):
        if not disc.method.discontinuous:
            raise ProblemError(f"method {disc.method.name} has no jumps to lift; take a discontinuous one")
        order = disc.order if order is None else order
        if not isinstance(order, int) or order < 0:
            raise ProblemError(f"order is {order!r}; the degree of the lifting space is an integer >= 0")
        share, rollers = WeakFacets(disc.problem, disc.facets)
        self.operators = FacetOperators(disc.problem.material, disc.facets, disc.order, order, share, rollers)
        self.space = self.operators.liftings

    def Global(self, gfu):
        """r_0([u]), a GridFunction in Q_h [as grad u]."""
        return self._Lift(gfu, slice(None))

    def Local(self, gfu, facet):
        """r_e([u]) of the facet with this number; it lives on the elements at the facet."""
        return self._Lift(gfu, self.operators.facetof != facet)

    def _Lift(self, gfu, dropped):
        operators = self.operators
        jump = operators.inverseMF @ (operators.J @ gfu.vec.FV().NumPy())
        if not isinstance(dropped, slice):
            jump[dropped] = 0
        lifted = GridFunction(self.space)
        lifted.vec.FV().NumPy()[:] = -(operators.inverseMQ @ (operators.N.T @ jump))
        return lifted


def WeakFacets(problem, facets):
    """(share, rollers) of the facets of E0, for `FacetOperators`: interior facets, Gamma_D and rollers."""
    share = np.where(facets.neighbours > 1, 0.5, 0.0)
    rollers = np.zeros(len(share), dtype=bool)
    for region in problem.roller:
        rollers |= facets.On(region)
    for region in problem.dirichlet:
        share[facets.On(region)] = 1
    share[rollers] = 1
    return share, rollers
