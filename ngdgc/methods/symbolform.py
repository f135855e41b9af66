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
from ngsolve import (BaseMatrix, BilinearForm, CoefficientFunction, FacetFESpace, FESpace, GridFunction, IntegrationRule,
                     LinearForm, Mesh, ds, dx, specialcf)

from ..contracts import Array
from ..data.coefficients import OnFacets
from ..mesh.checks import CheckSkeleton
from ..mesh.facets import VOLUME_TYPES, Curved, Facets, Threads
from ..problem.frames import Cartesian
from ..problem.materials import AnisotropicMaterial, HookeMaterial
from ..problem.problem import ContactProblem
from .guarantee import Guarantee


class TensorPenalty(Protocol):
    """P(w) of the penalty of the jumps (`penalty` module), a symmetric tensor, between elements and on the boundary."""

    def Interior(self, w: CoefficientFunction, n: CoefficientFunction) -> CoefficientFunction: ...

    def Boundary(self, w: CoefficientFunction, n: CoefficientFunction) -> CoefficientFunction: ...


class FacetPart:
    """A set of facets of E0: its measure, the material around and the frame."""

    frame: Cartesian
    material: HookeMaterial | AnisotropicMaterial
    measure: Any
    n: CoefficientFunction

    def Integral(self, integrand: CoefficientFunction) -> Any:
        """The integral over these facets."""
        return self.frame.Integral(integrand, self.measure)

    def Stress(self, u: CoefficientFunction) -> CoefficientFunction:
        """The stress in the plane of the mesh, (d, d)."""
        return self.frame.Plane(self.material.Stress(self.frame.Strain(u)))


class Interior(FacetPart):
    """Facets between two elements."""

    region, value = None, None

    def __init__(self, problem: ContactProblem, mesh: Mesh, penalty: TensorPenalty | None) -> None:
        self.frame, self.material, self.penalty, self.n = problem.frame, problem.material, penalty, specialcf.normal(mesh.dim)
        self.measure = dx(skeleton=True, bonus_intorder=self.material.bonus + self.frame.bonus)

    def Jump(self, u: CoefficientFunction) -> CoefficientFunction:
        return u - u.Other()

    def Mean(self, u: CoefficientFunction) -> CoefficientFunction:
        other = self.frame.Plane(self.material.OtherStress(self.frame.OtherStrain(u)))
        return 0.5 * (self.Stress(u) + other) * self.n

    def MeanOf(self, q: CoefficientFunction) -> CoefficientFunction:
        """{q} n for a symmetric matrix q."""
        return 0.5 * (q + q.Other()) * self.n

    def Penalty(self, w: CoefficientFunction) -> CoefficientFunction:
        return cast(TensorPenalty, self.penalty).Interior(w, self.n) * self.n

    def Flux(self, u: CoefficientFunction) -> CoefficientFunction:
        """{C eps(u)} n - P(w(u)) n, the traction that acts on the element whose outward normal is n [stress]."""
        return self.Mean(u) - self.Penalty(self.Jump(u))


class Clamped(FacetPart):
    """Boundary facets with all components prescribed."""

    kind = "dirichlet"

    def __init__(self, problem: ContactProblem, facets: Facets, penalty: TensorPenalty | None, region: str) -> None:
        CheckSkeleton(facets)
        mesh, self.frame, self.material = facets.mesh, problem.frame, problem.material
        self.penalty, self.region = penalty, region
        self.n = specialcf.normal(mesh.dim)
        bonus = self.material.bonus + self.frame.bonus
        self.measure = ds(skeleton=True, definedon=mesh.Boundaries(region), bonus_intorder=bonus)
        self.value = self._Prescribed(OnFacets(problem, self.kind, region, mesh))

    def _Prescribed(self, value: Any) -> CoefficientFunction:
        return value

    def Jump(self, u: CoefficientFunction) -> CoefficientFunction:
        return u

    def Mean(self, u: CoefficientFunction) -> CoefficientFunction:
        return self.Stress(u) * self.n

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
        self.frame, self.volume = problem.frame, _Volume(problem, space)
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

    def Elastic(self, u: Any, v: Any) -> Any:
        """The integral of C eps(u):eps(v) over the elements, of functions of any space."""
        return self.frame.Elastic(self.material, u, v, self.volume)

    def _Energy(self) -> BilinearForm:
        u, v = self.space.TnT()
        form = BilinearForm(self.space)
        form += self.Elastic(u, v)
        return form

    def _AddConsistency(self, form: BilinearForm) -> None:
        u, v = self.space.TnT()
        # One integral a term: NGSolve takes four times as long for their sum in one integral.
        for part in self.parts:
            form += part.Integral(-part.Jump(v) * part.Mean(u))
            if self.theta:
                form += part.Integral(-self.theta * part.Jump(u) * part.Mean(v))

    def _AddPenalty(self, form: BilinearForm) -> None:
        u, v = self.space.TnT()
        for part in self.parts:
            if part.penalty:
                form += part.Integral(part.Penalty(part.Jump(u)) * part.Jump(v))

    def Prescribed(self) -> dict[str, Array]:
        """The load of weakly prescribed displacements, {region: (ndof,)}.

        With the quadrature of the form itself, so that polynomial solutions are returned on any mesh.
        """
        v = self.space.TestFunction()
        return {part.region: Coefficients(part.Integral(part.Penalty(part.value) * part.Jump(v))
                                          - part.Integral(self.theta * part.value * part.Mean(v)))
                for part in self.parts if part.region is not None}

    def PrescribedEnergy(self) -> float:
        """<P(w_D), w_D>, what the penalty of prescribed displacements is to the body at rest [stress length^d]."""
        constant = FacetFESpace(self.space.mesh, order=0).TestFunction()
        return sum(float(np.sum(Coefficients(part.Integral(part.Penalty(part.value) * part.value * constant))))
                   for part in self.parts if part.region is not None)

    def Fluxes(self, gfu: GridFunction) -> dict[str | None, Array]:
        """The numerical flux tested on each set of facets, {region, or None between elements: (ndof,)}."""
        v = self.space.TestFunction()
        return {part.region: Coefficients(part.Integral(part.Flux(gfu) * (part.Jump(v) if part.region is None else v)))
                for part in self.parts}


def _Volume(problem: ContactProblem, space: FESpace) -> Any:
    """dx, with a quadrature for C eps(u):eps(v)."""
    bonus = problem.material.bonus
    if not problem.frame.revolved:
        # NGSolve lowers the degree where derivatives of polynomials are integrated, which they are not on curved elements.
        return dx(bonus_intorder=bonus + (2 if Curved(space.mesh) else 0))
    # u_r v_r/r is no polynomial: the rules of the blocks, so that both assemblies have the same value for it.
    degree = 2 * space.globalorder + bonus + problem.frame.bonus
    return dx(intrules={et: IntegrationRule(et, degree) for et in VOLUME_TYPES[space.mesh.dim]})


def Coefficients(integral: Any) -> Array:
    """Coefficients (ndof,) of a linear form, for example of a numerical flux against the jump."""
    form = LinearForm(integral)
    with Threads(form.space.mesh):
        return form.Assemble().vec.FV().NumPy().copy()
