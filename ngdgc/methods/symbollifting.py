"""The methods with liftings in NGSolve's symbols, the readable definition beside the block assembly of `facetform`.

With B v the moments -<[v], {q}> over q in Q_h, M_Q and M_C the masses of Q_h and R u the moments (C eps(u), q),

    r_0([v]) = M_Q^-1 B v,    (C r_0[u], r_0[v]) = B' W B,    sum_e (C r_e[u], r_e[v]) = sum_c B_c' W B_c

with W = M_Q^-1 M_C M_Q^-1, where the facets are coloured so that no element has two of the same colour c: then r_0 restricted
to a colour is the sum of its r_e, whose supports do not meet.  The lifting form has R' M_Q^-1 B in place of -<[v], {C eps(u)}>.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from ngsolve import (VOL, BaseMatrix, BilinearForm, CoefficientFunction, ElementId, FESpace, GridFunction, InnerProduct, L2,
                     MatrixValued, dx)

from ..contracts import Array
from ..mesh.facets import Csr, Facets, Native
from ..problem.problem import ContactProblem
from ..tools import sparse as sp
from .guarantee import Guarantee
from .symbolform import Coefficients, Part, SkeletonForm

Moments = Callable[[int], Any]      # of the facets of a colour: scipy CSR from V_h to Q_h, or a vector in Q_h


class LiftedSkeletonForm(SkeletonForm):
    """B_h with liftings, on the parts of a SkeletonForm.

    lifted : True for the lifting form;  globallift : True with (C r_0[u], r_0[v])
    eta : factor of sum_e (C r_e[u], r_e[v]), or None;  the parts have the penalty of the jumps, or None
    """

    def __init__(self, problem: ContactProblem, space: FESpace, parts: Sequence[Part], facets: Facets, *, liftorder: int,
                 lifted: bool, globallift: bool, eta: float | None, theta: int, guarantee: Guarantee) -> None:
        super().__init__(problem, space, parts, theta=theta, guarantee=guarantee)
        self.facets, self.lifted, self.globallift, self.eta = facets, lifted, globallift, eta
        self.liftings = MatrixValued(L2(space.mesh, order=liftorder, dgjumps=True), symmetric=True)

    def Matrix(self) -> BaseMatrix:
        """The matrix of B_h."""
        form = self._Energy()
        if not self.lifted:
            self._AddConsistency(form)
        self._AddPenalty(form)
        matrix = Csr(form.Assemble().mat) + self._Stabilisation(self._B(), self._B())
        if self.lifted:
            coupling = self._R.T @ self._inverse @ self._Sum(self._B())
            matrix = matrix + coupling.T + self.theta * coupling
        return Native(matrix)

    def Norm(self) -> BaseMatrix:
        """The matrix of g_h + stabilisation + (C r_0, r_0)."""
        form = self._Energy()
        self._AddPenalty(form)
        return Native(Csr(form.Assemble().mat) + self._Stabilisation(self._B(), self._B()))

    def Prescribed(self) -> dict[str, Array]:
        """The load of weakly prescribed displacements, {region: (ndof,)}."""
        v, loads, given = self.space.TestFunction(), {}, self._Given()
        for part in self.parts:
            if part.region is not None:
                data = given[part.region].__getitem__
                load = self._Stabilisation(self._B(), data)
                if self.lifted:
                    load = load + self.theta * (self._R.T @ (self._inverse @ self._Sum(data)))
                else:
                    load = load - self.theta * Coefficients(part.Integral(part.value * part.Mean(v)))
                if part.penalty:
                    load = load + Coefficients(part.Integral(part.Penalty(part.value) * part.Jump(v)))
                loads[part.region] = load
        return loads

    def Fluxes(self, gfu: GridFunction) -> dict[str | None, Array]:
        """The numerical flux tested on each set of facets, {region, or None between elements: (ndof,)}."""
        v, vector, tested, given = self.space.TestFunction(), gfu.vec.FV().NumPy(), {}, self._Given()

        def Mismatch(colour: int) -> Array:
            return self._B()(colour) @ vector - sum(data[colour] for data in given.values())

        for part in self.parts:
            own = self._B(part.region)
            flux = -self._Stabilisation(own, Mismatch)
            if self.lifted:
                flux = flux - self._Sum(own).T @ (self._inverse @ (self._R @ vector))
            else:
                flux = flux + Coefficients(part.Integral(part.Mean(gfu) * part.Jump(v)))
            if part.penalty:
                jump = part.Jump(gfu) if part.region is None else part.Jump(gfu) - part.value
                flux = flux - Coefficients(part.Integral(part.Penalty(jump) * part.Jump(v)))
            tested[part.region] = flux
        return tested

    @cached_property
    def _moments(self) -> dict[tuple[str | None, int], sp.csr_matrix]:
        """{(region, or None between elements, colour): -<[v], {q}>} as CSR from V_h to Q_h."""
        v, q = self.space.TrialFunction(), self.liftings.TestFunction()
        found = {}
        for part in self.parts:
            for colour, indicator in enumerate(self._indicators):
                form = BilinearForm(trialspace=self.space, testspace=self.liftings)
                form += part.Integral(-indicator * (part.Jump(v) * part.MeanOf(q)))
                found[part.region, colour] = Csr(form.Assemble().mat)
        return found

    def _Given(self) -> dict[str, list[Array]]:
        """{region: [-<w_D, {q}> for every colour]}, the moments of the prescribed values, whose Parameters may be set anew."""
        # NGSolve has no linear forms of symmetric matrix functions on facets: tested with 1 in a bilinear form instead.
        constants = L2(self.space.mesh, order=0, dgjumps=True)
        one, q = constants.TrialFunction(), self.liftings.TestFunction()
        found: dict[str, list[Array]] = {part.region: [] for part in self.parts if part.region is not None}
        for part in self.parts:
            if part.region is None:
                continue
            for indicator in self._indicators:
                form = BilinearForm(trialspace=constants, testspace=self.liftings)
                form += part.Integral(-indicator * one * (part.value * part.MeanOf(q)))
                found[part.region].append(Csr(form.Assemble().mat) @ np.ones(constants.ndof))
        return found

    @cached_property
    def _indicators(self) -> list[GridFunction]:
        """Facet functions that are 1 on the facets of one colour, where r_e is needed, else the constant 1."""
        if self.eta is None:
            return [self.facets.Function(np.ones(len(self.facets.neighbours)))]
        colours = self._Colours()
        return [self.facets.Function(colours == colour) for colour in range(colours.max() + 1)]

    def _Colours(self) -> np.ndarray:
        """Colours of the facets such that no element has two facets of one colour: greedy, over facets."""
        elements = self.facets.incidence
        colours = np.zeros(elements.shape[0], dtype=int)
        used: list[set[int]] = [set() for _ in range(elements.shape[1])]
        for facet in range(len(colours)):
            around = elements.indices[elements.indptr[facet]:elements.indptr[facet + 1]]
            taken = set().union(*(used[element] for element in around))
            colours[facet] = next(colour for colour in range(len(taken) + 1) if colour not in taken)
            for element in around:
                used[element].add(colours[facet])
        return colours

    def _B(self, region: Any = ...) -> Moments:
        """The moments of all parts, or of one region, as a function of the colour."""
        return lambda colour: sum(moments for (own, number), moments in self._moments.items()
                                  if number == colour and region in (..., own))

    def _Sum(self, moments: Moments) -> Any:
        return sum(moments(colour) for colour in range(len(self._indicators)))

    def _Stabilisation(self, left: Moments, right: Moments) -> Any:
        """left' W right for r_0, plus eta left_c' W right_c over the colours c for r_e, as far as the method has them."""
        total = 0 * (self._Sum(left).T @ self._Sum(right))
        if self.globallift:
            total = total + self._Sum(left).T @ (self._W @ self._Sum(right))
        if self.eta is not None:
            total = total + self.eta * sum(left(colour).T @ (self._W @ right(colour))
                                           for colour in range(len(self._indicators)))
        return total

    @cached_property
    def _R(self) -> sp.csr_matrix:
        u, q = self.space.TrialFunction(), self.liftings.TestFunction()
        form = BilinearForm(trialspace=self.space, testspace=self.liftings)
        stress = self.frame.Plane(self.material.Stress(self.frame.Strain(u)))
        form += self.frame.Integral(InnerProduct(stress, q), self.volume)
        return Csr(form.Assemble().mat)

    def _Mass(self, stress: Callable[[CoefficientFunction], CoefficientFunction]) -> sp.csr_matrix:
        p, q = self.liftings.TnT()
        form = BilinearForm(self.liftings)
        form += self.frame.Integral(InnerProduct(stress(p), q), dx(bonus_intorder=self.material.bonus + self.frame.bonus))
        return Csr(form.Assemble().mat)

    @cached_property
    def _inverse(self) -> sp.csr_matrix:
        """M_Q^-1, block-diagonal over elements."""
        mass = self._Mass(lambda p: p)
        blocks = [np.array(self.liftings.GetDofNrs(ElementId(VOL, element))) for element in range(self.space.mesh.ne)]
        inverse = sp.block_diag([np.linalg.inv(mass[dofs][:, dofs].toarray()) for dofs in blocks], format="csr")
        order = np.argsort(np.concatenate(blocks))
        return inverse[order][:, order]

    @cached_property
    def _W(self) -> sp.csr_matrix:
        return self._inverse @ self._Mass(self.frame.InPlane(self.material).Stress) @ self._inverse
