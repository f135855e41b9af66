"""The bilinear forms of the interior penalty methods in NGSolve's symbols, the readable definition.

On every set of facets in E0 the form consists of the same three terms,

    - <w(v), {C eps(u)} n> - theta <w(u), {C eps(v)} n> + <w(u), P(w(v)) n>,    flux = {C eps(u)} n - P(w(u) - w_D) n,

where w is u+ - u- between two elements, u on a clamped boundary and u_n n on a roller, and w_D the prescribed value.  Edge form
of the paper since [v]:q = w(v).(q n) for symmetric q.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol, cast

import numpy as np
from ngsolve import (BaseMatrix, BilinearForm, CoefficientFunction, FacetFESpace, FESpace, Grad, GridFunction, InnerProduct,
                     LinearForm, Mesh, Sym, ds, dx, specialcf)

from ..contracts import Array
from ..data.coefficients import OnFacets
from ..mesh.checks import CheckSkeleton
from ..mesh.facets import Curved, Facets, Threads
from ..problem.materials import AnisotropicMaterial, HookeMaterial, Strain
from ..problem.problem import ContactProblem
from .guarantee import Guarantee


class TensorPenalty(Protocol):
    """P(w) of the penalty of the jumps (`penalty` module), a symmetric tensor, between elements and on the boundary."""

    def Interior(self, w: CoefficientFunction, n: CoefficientFunction) -> CoefficientFunction: ...

    def Boundary(self, w: CoefficientFunction, n: CoefficientFunction) -> CoefficientFunction: ...


def OtherStrain(u: CoefficientFunction) -> CoefficientFunction:
    """eps(u) of the neighbour, of a trial or test function or a GridFunction."""
    return Sym(Grad(u).Other()) if isinstance(u, GridFunction) else Strain(u.Other())


class Interior:
    """Facets between two elements."""

    region, value = None, None

    def __init__(self, material: HookeMaterial | AnisotropicMaterial, mesh: Mesh, penalty: TensorPenalty | None) -> None:
        self.material, self.penalty, self.n = material, penalty, specialcf.normal(mesh.dim)
        self.measure = dx(skeleton=True, bonus_intorder=material.bonus)

    def Jump(self, u: CoefficientFunction) -> CoefficientFunction:
        return u - u.Other()

    def Mean(self, u: CoefficientFunction) -> CoefficientFunction:
        return 0.5 * (self.material.Stress(Strain(u)) + self.material.OtherStress(OtherStrain(u))) * self.n

    def MeanOf(self, q: CoefficientFunction) -> CoefficientFunction:
        """{q} n for a symmetric matrix q."""
        return 0.5 * (q + q.Other()) * self.n

    def Penalty(self, w: CoefficientFunction) -> CoefficientFunction:
        return cast(TensorPenalty, self.penalty).Interior(w, self.n) * self.n

    def Flux(self, u: CoefficientFunction) -> CoefficientFunction:
        """{C eps(u)} n - P(w(u)) n, the traction that acts on the element whose outward normal is n [stress]."""
        return self.Mean(u) - self.Penalty(self.Jump(u))


class Clamped:
    """Boundary facets with all components prescribed."""

    kind = "dirichlet"

    def __init__(self, problem: ContactProblem, facets: Facets, penalty: TensorPenalty | None, region: str) -> None:
        CheckSkeleton(facets)
        mesh, self.material, self.penalty, self.region = facets.mesh, problem.material, penalty, region
        self.n = specialcf.normal(mesh.dim)
        self.measure = ds(skeleton=True, definedon=mesh.Boundaries(region), bonus_intorder=self.material.bonus)
        self.value = self._Prescribed(OnFacets(problem, self.kind, region, mesh))

    def _Prescribed(self, value: Any) -> CoefficientFunction:
        return value

    def Jump(self, u: CoefficientFunction) -> CoefficientFunction:
        return u

    def Mean(self, u: CoefficientFunction) -> CoefficientFunction:
        return self.material.Stress(Strain(u)) * self.n

    def MeanOf(self, q: CoefficientFunction) -> CoefficientFunction:
        return q * self.n

    def Penalty(self, w: CoefficientFunction) -> CoefficientFunction:
        return cast(TensorPenalty, self.penalty).Boundary(w, self.n) * self.n

    def Flux(self, u: CoefficientFunction) -> CoefficientFunction:
        """C eps(u) n - P(w(u) - w_D) n, the traction of the support on the body [stress]."""
        return self.Mean(u) - self.Penalty(self.Jump(u) - self.value)


class Roller(Clamped):
    """Boundary facets with the normal component prescribed; the traction is normal."""

    kind = "roller"

    def _Prescribed(self, value: Any) -> CoefficientFunction:
        return value * self.n

    def _Normal(self, vector: CoefficientFunction) -> CoefficientFunction:
        return (vector * self.n) * self.n

    def Jump(self, u: CoefficientFunction) -> CoefficientFunction:
        return self._Normal(u)

    def Mean(self, u: CoefficientFunction) -> CoefficientFunction:
        return self._Normal(super().Mean(u))

    def MeanOf(self, q: CoefficientFunction) -> CoefficientFunction:
        return self._Normal(super().MeanOf(q))

    def Penalty(self, w: CoefficientFunction) -> CoefficientFunction:
        return self._Normal(super().Penalty(w))


Part = Interior | Clamped


class SkeletonForm:
    """B_h = int C eps_h(u):eps_h(v) + the terms above, assembled by NGSolve's dx(skeleton=True) integrals.

    parts : the sets of facets of E0, empty for H1 without rollers
    theta : factor of the second term, 1 for a symmetric form
    guarantee : what is known of its coercivity
    """

    consistent, lifted = True, False

    def __init__(self, problem: ContactProblem, space: FESpace, parts: Sequence[Part], *, guarantee: Guarantee,
                 theta: int = 1) -> None:
        self.material, self.space, self.parts, self.theta = problem.material, space, parts, theta
        # NGSolve lowers the degree where derivatives of polynomials are integrated, which they are not on curved elements.
        self.volume = dx(bonus_intorder=problem.material.bonus + (2 if Curved(space.mesh) else 0))
        self.guarantee = guarantee

    def Matrix(self) -> BaseMatrix:
        """The matrix of B_h."""
        form = self._Energy()
        self._AddConsistency(form)
        self._AddPenalty(form)
        return form.Assemble().mat

    def Norm(self) -> BaseMatrix:
        """The matrix of the energy norm g_h + penalty."""
        form = self._Energy()
        self._AddPenalty(form)
        return form.Assemble().mat

    def _Energy(self) -> BilinearForm:
        u, v = self.space.TnT()
        form = BilinearForm(self.space)
        form += InnerProduct(self.material.Stress(Strain(u)), Strain(v)) * self.volume
        return form

    def _AddConsistency(self, form: BilinearForm) -> None:
        u, v = self.space.TnT()
        # One integral a term: NGSolve takes four times as long for their sum in one integral.
        for part in self.parts:
            form += -part.Jump(v) * part.Mean(u) * part.measure
            if self.theta:
                form += -self.theta * part.Jump(u) * part.Mean(v) * part.measure

    def _AddPenalty(self, form: BilinearForm) -> None:
        u, v = self.space.TnT()
        for part in self.parts:
            if part.penalty:
                form += part.Penalty(part.Jump(u)) * part.Jump(v) * part.measure

    def Prescribed(self) -> dict[str, Array]:
        """The load of weakly prescribed displacements, {region: (ndof,)}.

        With the quadrature of the form itself, so that polynomial solutions are returned on any mesh.
        """
        v = self.space.TestFunction()
        return {part.region: Coefficients(part.Penalty(part.value) * part.Jump(v) * part.measure
                                          - self.theta * part.value * part.Mean(v) * part.measure)
                for part in self.parts if part.region is not None}

    def PrescribedEnergy(self) -> float:
        """<P(w_D), w_D>, what the penalty of prescribed displacements is to the body at rest [stress length^d]."""
        constant = FacetFESpace(self.space.mesh, order=0).TestFunction()
        return sum(float(np.sum(Coefficients(part.Penalty(part.value) * part.value * constant * part.measure)))
                   for part in self.parts if part.region is not None)

    def Fluxes(self, gfu: GridFunction) -> dict[str | None, Array]:
        """The numerical flux tested on each set of facets, {region, or None between elements: (ndof,)}."""
        v = self.space.TestFunction()
        return {part.region: Coefficients(part.Flux(gfu) * (part.Jump(v) if part.region is None else v) * part.measure)
                for part in self.parts}


def Coefficients(integral: Any) -> Array:
    """Coefficients (ndof,) of a linear form, for example of a numerical flux against the jump."""
    form = LinearForm(integral)
    with Threads(form.space.mesh):
        return form.Assemble().vec.FV().NumPy().copy()
