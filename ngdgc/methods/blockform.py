"""The bilinear forms of Table 2 on facet operators: one formula, one facet matrix Sigma for each method.

    B_h = K - J' M_F^-1 S - theta S' M_F^-1 J + J' M_F^-1 Sigma M_F^-1 J + (C r_0[u], r_0[v])

in the edge form; the lifting form has N M_Q^-1 R in place of S.  theta = 1 makes the form symmetric; the last term belongs to
the methods with a global lifting only.  The numerical flux of Table 1, for the orientation of the facet, is the function

    sigma_hat n = M_F^-1 (S u - Sigma M_F^-1 (J u - g_D) - G M_F^-1 (J u - g_D))        in F_h.

Every matrix is built, and every vector computed, from batches of blocks on facets and elements (`operators` module).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol, cast

import numpy as np
from ngsolve import BaseMatrix, FESpace, GridFunction, LinearForm, ds

from ..blocks.batches import FacetPatch, Side, Star
from ..blocks.integrals import ElementGroup
from ..blocks.operators import FacetOperators
from ..contracts import Array
from ..data.coefficients import LOADBONUS, OnFacets
from ..problem.problem import ContactProblem
from ..tools.parallel import Batched, Map
from .guarantee import Guarantee


class JumpPenalty(Protocol):
    """The penalty of the jumps (`penalty` module) as its part of Sigma."""

    def FacetMatrix(self, patch: FacetPatch) -> Array: ...


class FacetForm:
    """B_h of a method.

    operators : FacetOperators;  lifted : True for the lifting form;  globallift : True with (C r_0[u], r_0[v])
    rule : the penalty of the jumps (`penalty` module) or None;  eta : of eta sum_e (C r_e[u], r_e[v]), or None
    theta : 1 if symmetric
    guarantee : what is known of its coercivity
    consistent : True with the terms -<[v],{C eps(u)}> and -theta <[u],{C eps(v)}>, and with {C eps(u)} in the flux
    """

    consistent = True

    def __init__(self, problem: ContactProblem, space: FESpace, operators: FacetOperators, *, rule: JumpPenalty | None,
                 eta: float | None, lifted: bool, globallift: bool, theta: int, guarantee: Guarantee) -> None:
        self.problem, self.space, self.operators, self.rule, self.eta = problem, space, operators, rule, eta
        self.lifted, self.globallift, self.theta, self.guarantee = lifted, globallift, theta, guarantee

    def FacetMatrix(self, patch: FacetPatch) -> Array:
        """Sigma of a batch of facets, (n, r, r)."""
        if self.rule:
            return self.rule.FacetMatrix(patch)
        if self.eta is not None:
            return self.eta * self.operators.LocalEnergy(patch)
        size = self.operators.dim * self.operators.facetsizes[patch.facets[0]]
        return np.zeros((len(patch.facets), size, size))

    def Matrix(self) -> BaseMatrix:
        """The matrix of B_h."""
        return self._Assemble(consistency=self.consistent)

    def Norm(self) -> BaseMatrix:
        """The matrix of g_h + Sigma(J u, J v) + (C r_0, r_0), against which coercivity is measured."""
        return self._Assemble(consistency=False)

    @Batched
    def _Assemble(self, consistency: bool) -> BaseMatrix:
        operators = self.operators
        matrix = operators.Matrix(self.space, reach=2 if self.globallift else 1)
        distinct = operators.facets.distinct
        own = [np.empty((len(group.elements),) + 2 * (operators.dim * group.na,)) for group in operators.groups]
        for group, blocks in zip(operators.groups, own):
            def Energy(batch: tuple[np.ndarray, ElementGroup], blocks: Array = blocks) -> None:
                rows, part = batch
                blocks[rows] = part.energy

            for _ in Map(Energy, group.Parts(blocks[0].size), threads=operators.many):
                pass

        def Couple(patch: FacetPatch) -> list[tuple[Side, Array]]:
            """Put the blocks of neighbours, which no other facet has, into the matrix; return those of single elements."""
            blocks = self._FacetBlocks(patch, consistency)
            for a, b in [pair for pair in blocks if pair[0] != pair[1]]:
                matrix.Put(patch.elements[:, a], patch.elements[:, b], blocks.pop((a, b)), add=not distinct)
            return [(side, blocks[a, a]) for a, side in enumerate(patch.sides)]

        for diagonal in Map(Couple, operators.FacetPatches(), threads=operators.many and distinct):
            for side, block in diagonal:
                own[side.number][side.rows] += block
        for group, blocks in zip(operators.groups, own):
            matrix.Put(group.elements, group.elements, blocks)
        if self.globallift:
            for elements, block in Map(self._StarBlock, operators.Stars(), threads=operators.many):
                matrix.Add(elements, block)
        return matrix.native

    def _FacetBlocks(self, patch: FacetPatch, consistency: bool) -> dict[tuple[int, int], Array]:
        """{(a, b): block (n, m_a, m_b)} of the terms on a batch of facets, for rows of side a and columns of side b."""
        operators, theta = self.operators, self.theta
        sigma = self.FacetMatrix(patch)
        jumps = [operators.SideJump(side) for side in patch.sides]
        fluxes = [sigma @ jump for jump in jumps]
        if consistency:
            tractions = [operators.SideTraction(side, patch.facets, self.lifted) for side in patch.sides]
            fluxes = [flux - traction for flux, traction in zip(fluxes, tractions)]
        symmetric = theta == 1 or not consistency
        blocks: dict[tuple[int, int], Array] = {}
        for a, jump in enumerate(jumps):
            for b, flux in enumerate(fluxes):
                if symmetric and b < a:
                    blocks[a, b] = np.swapaxes(blocks[b, a], 1, 2)
                    continue
                blocks[a, b] = np.swapaxes(jump, 1, 2) @ flux
                if consistency and theta:
                    blocks[a, b] -= theta * (np.swapaxes(tractions[a], 1, 2) @ jumps[b])
        return blocks

    def _StarBlock(self, star: Star) -> tuple[np.ndarray, Array]:
        """(elements, block) of (C r_0[u], r_0[v]) on a batch of elements."""
        lifting = self.operators.GlobalLifting(star)
        weighted = star.group.weightedliftmass @ lifting
        return star.elements, np.swapaxes(lifting, 1, 2) @ weighted

    def _Data(self) -> dict[str, Array]:
        """{region: values prescribed on it, coefficients in F_h}."""
        problem, operators = self.problem, self.operators
        mu, n = operators.facetspace.TestFunction(), operators.normal
        values = {region: OnFacets(problem, "dirichlet", region, operators.mesh) for region in problem.dirichlet}
        values |= {region: OnFacets(problem, "roller", region, operators.mesh) * n for region in problem.roller}
        data = {}
        for region, value in values.items():
            measure = ds(skeleton=True, definedon=operators.mesh.Boundaries(region), bonus_intorder=LOADBONUS)
            moments = LinearForm(problem.frame.Integral(value * mu, measure)).Assemble().vec.FV().NumPy()
            data[region] = np.zeros(len(moments))
            for patch in operators.FacetPatches(operators.facets.On(region)):
                dofs = operators.FacetDofs(patch.facets)
                data[region][dofs] = operators.Apply(operators.inversemass(patch.sides[0]), moments[dofs][..., None])[..., 0]
        return data

    @Batched
    def Prescribed(self) -> dict[str, Array]:
        """The load of weakly prescribed displacements, {region: (ndof,)}."""
        operators, loads = self.operators, {}
        for region, values in self._Data().items():
            facets = operators.facets.On(region)
            # A global lifting carries the data of a facet to all facets of its element.
            reached = operators.facets.Around(facets) if self.globallift else facets
            penalised = self._Tested(self._Penalised(values, facets), reached, operators.Jumps)
            tractions = self._Tested(values, facets, lambda patch: operators.Tractions(patch, self.lifted))
            loads[region] = penalised - self.theta * tractions
        return loads

    @Batched
    def PrescribedEnergy(self, counted: np.ndarray | None = None) -> float:
        """g_D'(Sigma + G) g_D, what the penalty of prescribed displacements is to the body at rest [stress length^d].

        counted : True for the facets (facets,) whose share it is; None: all
        """
        near = self.operators.facets.On("|".join((*self.problem.dirichlet, *self.problem.roller)))
        data = self._Data()
        values = sum(data.values(), np.zeros(self.operators.facetspace.ndof))
        penalised = self._Penalised(values, near)
        if counted is not None:
            dofs = [self.operators.FacetDofs(patch.facets).ravel() for patch in self.operators.FacetPatches(near & ~counted)]
            penalised[np.concatenate([*dofs, np.zeros(0, dtype=int)])] = 0
        return float(values @ penalised) if data else 0.0

    def _Penalised(self, jump: Array, near: np.ndarray) -> Array:
        """M_F^-1 (Sigma + G) jump, for a jump given by coefficients in F_h that vanishes off the facets `near`."""
        operators = self.operators
        result = np.zeros(len(jump))
        for patch in operators.FacetPatches(near):
            dofs = operators.FacetDofs(patch.facets)
            result[dofs] += (self.FacetMatrix(patch) @ jump[dofs][..., None])[..., 0]
        if self.globallift:
            for star in operators.Stars(operators.facets.Touching(near)):
                arms = [operators.FacetDofs(facets) for _, facets, _ in star.arms]
                liftings = operators.Liftings(star)
                lifted = cast(Array, sum(lifting @ jump[own][..., None] for lifting, own in zip(liftings, arms)))
                stress = star.group.weightedliftmass @ lifted
                for lifting, own in zip(liftings, arms):
                    np.add.at(result, own, (np.swapaxes(lifting, 1, 2) @ stress)[..., 0])
        return result

    def _Tested(self, values: Array, near: np.ndarray, blocks: Callable[[FacetPatch], Array]) -> Array:
        """(ndof,) from values in F_h on the facets `near`, times blocks(patch) transposed."""
        operators = self.operators
        result = np.zeros(self.space.ndof)
        for patch in operators.FacetPatches(near):
            moments = values[operators.FacetDofs(patch.facets)][..., None]
            np.add.at(result, operators.Dofs(patch.elements), (np.swapaxes(blocks(patch), 1, 2) @ moments)[..., 0])
        return result

    def Jump(self, gfu: GridFunction) -> Array:
        """Coefficients in F_h of the jump u+ - u-, on Gamma_D and rollers u - g_D."""
        operators, vector = self.operators, gfu.vec.FV().NumPy()
        jump = -sum(self._Data().values(), np.zeros(operators.facetspace.ndof))
        for patch in operators.FacetPatches():
            local = vector[operators.Dofs(patch.elements)][..., None]
            jump[operators.FacetDofs(patch.facets)] += (operators.Jumps(patch) @ local)[..., 0]
        return jump

    @Batched
    def Flux(self, gfu: GridFunction) -> Array:
        """Coefficients in F_h of the numerical flux sigma_hat n, n the normal that fixes the orientation of the facet."""
        operators, vector = self.operators, gfu.vec.FV().NumPy()
        everywhere = np.ones(len(operators.share), dtype=bool)
        jump = self.Jump(gfu)
        flux = -self._Penalised(jump, everywhere)
        for patch in operators.FacetPatches():
            dofs, local = operators.FacetDofs(patch.facets), vector[operators.Dofs(patch.elements)][..., None]
            moments = flux[dofs][..., None]
            if self.consistent:
                moments = (operators.Tractions(patch, self.lifted) @ local) + moments
            flux[dofs] = operators.Apply(operators.inversemass(patch.sides[0]), moments)[..., 0]
        return flux

    def FluxFunction(self, gfu: GridFunction) -> GridFunction:
        """The numerical flux as a GridFunction on the facets [stress]."""
        function = GridFunction(self.operators.facetspace)
        function.vec.FV().NumPy()[:] = self.Flux(gfu)
        return function

    def Fluxes(self, gfu: GridFunction) -> dict[str | None, Array]:
        """The numerical flux tested on each set of facets, {region, or None between elements: (ndof,)}."""
        flux, operators = self.Flux(gfu), self.operators
        on = {region: operators.facets.On(region) for region in (*self.problem.dirichlet, *self.problem.roller)}
        on[None] = ~np.any(list(on.values()), axis=0) if on else np.ones(len(operators.share), dtype=bool)
        return {region: self._Tested(flux, facets, operators.JumpBlocks) for region, facets in on.items()}
