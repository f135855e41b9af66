"""The bilinear forms of Table 2 from facet operators: one formula, one facet matrix Sigma for each method.

    B_h = K - J' M_F^-1 S - S' M_F^-1 J + J' M_F^-1 Sigma M_F^-1 J,     flux = M_F^-1 (S u - Sigma M_F^-1 (J u - g_D))

in the edge form; the lifting form has N M_Q^-1 R in place of S.  The flux is the traction {C eps(u)} n - ... of Table 1 on each
facet, for the orientation of the facet, as a function in F_h.
"""

import numpy as np
from ngsolve import GridFunction, LinearForm, ds
from ngsolve.la import SparseMatrixd

from .coefficients import Unfolded


class FacetForm:
    """B_h of a method on the facet operators.

    operators : FacetOperators;  sigma : the facet matrix, F_h x F_h;  lifted : True for the lifting form
    bound : the form is coercive if it is below 1; infinite where no element-wise bound is known
    """

    def __init__(self, problem, space, operators, sigma, *, lifted, bound):
        self.problem, self.space, self.operators = problem, space, operators
        self.sigma, self.bound = sigma, bound
        self.tractions = operators.projectedS if lifted else operators.S
        self.jumps = operators.inverseMF @ operators.J

    def Matrix(self):
        """The matrix of B_h."""
        consistency = self.jumps.T @ self.tractions
        return self._Native(self.operators.K - consistency - consistency.T + self._Stabilisation())

    def Norm(self):
        """The matrix of g_h + Sigma(J u, J v), against which coercivity is measured."""
        return self._Native(self.operators.K + self._Stabilisation())

    def _Stabilisation(self):
        return self.jumps.T @ self.sigma @ self.jumps

    @staticmethod
    def _Native(matrix):
        entries = matrix.tocoo()
        return SparseMatrixd.CreateFromCOO(entries.row, entries.col, entries.data, *matrix.shape)

    def _Data(self):
        """{region: values prescribed on it, coefficients in F_h}."""
        problem, mu = self.problem, self.operators.traces.TestFunction()
        n, mesh = self.operators.n, self.operators.facets.mesh
        values = {region: Unfolded(value) for region, value in problem.dirichlet.items()}
        values |= {region: Unfolded(value) * n for region, value in problem.roller.items()}
        data = {}
        for region, value in values.items():
            form = LinearForm(value * mu * ds(skeleton=True, definedon=mesh.Boundaries(region), bonus_intorder=2))
            data[region] = self.operators.inverseMF @ form.Assemble().vec.FV().NumPy()
        return data

    def Prescribed(self):
        """The load of weakly prescribed displacements, {region: (ndof,)}."""
        return {region: self.jumps.T @ (self.sigma @ values) - self.tractions.T @ values
                for region, values in self._Data().items()}

    def Flux(self, gfu):
        """Coefficients in F_h of the numerical flux sigma_hat n_e, n_e the normal that fixes the orientation of the facet."""
        vector = gfu.vec.FV().NumPy()
        jump = self.jumps @ vector - sum(self._Data().values(), np.zeros(self.operators.traces.ndof))
        return self.operators.inverseMF @ (self.tractions @ vector - self.sigma @ jump)

    def FluxFunction(self, gfu):
        """The numerical flux as a GridFunction on the facets."""
        function = GridFunction(self.operators.traces)
        function.vec.FV().NumPy()[:] = self.Flux(gfu)
        return function

    def Fluxes(self, gfu):
        """The numerical flux tested on each set of facets, {region, or None between elements: (ndof,)}."""
        flux, operators = self.Flux(gfu), self.operators
        on = {region: operators.facets.On(region) for region in (*self.problem.dirichlet, *self.problem.roller)}
        on[None] = ~np.any(list(on.values()), axis=0) if on else np.ones(len(operators.share), dtype=bool)
        return {region: operators.J.T @ np.where(facets[operators.facetof], flux, 0) for region, facets in on.items()}
