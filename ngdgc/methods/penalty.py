"""Penalties of the interior-penalty terms, and how large they must be.

For w = u+ - u- and the tensor jump [u] = sym(w (x) n), a penalty is a symmetric tensor P(w); its traction P(w) n enters the
numerical flux {C eps(u)} n - P(w) n, and P(w):[v] the bilinear form.

Write omega_e = 1/2 on interior facets and 1 on boundary facets.  By Young's inequality on every facet, with
theta < 1 the square root of the largest element bound kappa_K, the form is coercive,
B(u,u) >= (1 - theta) (g_h(u,u) + penalty), as soon as on every element, for all v in V_h(K),

    sum_e omega_e int_e |C eps(v)|_e^2  <=  kappa_K int_K C eps(v):eps(v),      kappa_K < 1,

where |.|_e is dual to the penalty: (h_e/eta_e) (2 |sigma n|^2 - sigma_n^2) for P = (eta_e/h_e) sym(w (x) n), and
sigma : C^-1 sigma / gamma_{K,e} for P = {gamma C} sym(w (x) n).  The smallest kappa_K is the largest eigenvalue of a pencil
of element matrices: sharp in order, shape and material of the element, and without unknown constants.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import cast

import numpy as np
from ngsolve import CoefficientFunction, GridFunction, L2, OuterProduct, Sym

from ..blocks.batches import FacetPatch
from ..blocks.integrals import ElementGroup
from ..blocks.operators import FacetOperators
from ..contracts import Array
from ..exceptions import ProblemError
from ..mesh.facets import VolumePoints
from ..tools.parallel import Map

MARGIN = 2      # kappa_K = 1/MARGIN for penalty="auto": B_h >= (1 - 1/sqrt 2) of the energy norm


def ElementBounds(operators: FacetOperators, facetweight: Array, bound: Callable[[ElementGroup, Array], Array]) -> Array:
    """Largest eigenvalue over V_h(K) of sum_e facetweight_e pencil_e against int_K C eps:eps, over elements.

    bound(group, weights) : `ElasticBound` or `PlainBound`, that is the pencil, with weights (n, sides)
    """
    def Largest(batch: tuple[np.ndarray, ElementGroup]) -> tuple[np.ndarray, Array | float]:
        _, group = batch
        weights = facetweight[group.facets]
        return group.elements, bound(group, weights) if weights.any() else 0

    largest = np.zeros(operators.mesh.ne)
    for group in operators.groups:
        for elements, values in Map(Largest, group.Parts((operators.dim * group.na) ** 2), threads=operators.many):
            largest[elements] = values
    return largest


def ElasticBound(group: ElementGroup, weights: Array) -> Array:
    """Largest eigenvalues for int_e C eps:eps, (n,)."""
    # Where the strains are constant the two forms are proportional.
    return group.SurfaceRatios(weights) if group.constant else LargestEigenvalues(group.ElasticPencil(weights), group)


def PlainBound(group: ElementGroup, weights: Array) -> Array:
    """Largest eigenvalues for int_e 2 |C eps n|^2 - (n.C eps n)^2, (n,)."""
    return LargestEigenvalues(group.PlainPencil(weights), group)


def LargestEigenvalues(upper: Array, group: ElementGroup) -> Array:
    """Largest eigenvalues of upper x = kappa K x, (n,), on the elements of a group, where both vanish on rigid motions.

    Adding the squares of functionals that no rotation but 0 annihilates to K changes no eigenvalue, since a rotation can be
    added to x until they vanish; functions without gradient are left out.
    """
    lower, rotations = group.energy, group.rotations
    moving = np.any(np.diagonal(lower, axis1=1, axis2=2) > 0, axis=0)
    select = np.ix_(np.arange(len(lower)), np.flatnonzero(moving), np.flatnonzero(moving))
    upper, lower, rotations = upper[select], lower[select], rotations[:, moving]
    if rotations.shape[2]:
        scale = np.trace(lower, axis1=1, axis2=2) / np.square(rotations).sum(axis=(1, 2))
        lower = lower + scale[:, None, None] * rotations @ np.swapaxes(rotations, 1, 2)
    try:
        factor = np.linalg.inv(np.linalg.cholesky(lower))
    except np.linalg.LinAlgError as error:
        raise ProblemError("the material is not positive definite at some quadrature point of the elements; look at its sign "
                           "and size everywhere, where it is a function") from error
    return cast(Array, np.linalg.eigvalsh(factor @ upper @ np.swapaxes(factor, 1, 2))[:, -1])


def Penalty(value: float | str, weighting: str | None, operators: FacetOperators) -> ScalarPenalty | ElasticPenalty:
    """The penalty of a method: "auto" or a number, weighted by "mu" or by "C"; None is "C" for "auto" and "mu" for a number."""
    if weighting is None:
        weighting = "C" if value == "auto" else "mu"
    if weighting == "C":
        return ElasticPenalty(value, operators)
    return ScalarPenalty(value, operators)


def _Scale(operators: FacetOperators) -> Array:
    """order^2/h_e over facets, h_e the diameter of e [1/length]."""
    return operators.order ** 2 / operators.facets.diameter


class ScalarPenalty:
    """P(w) = (eta_e/h_e) sym(w (x) n) with eta_e = penalty * mu * order^2, the paper's [u]:[v] eta_e/h_e.

    mu is the larger one of the two sides and h_e the diameter of e; for "auto" the number is the smallest one for which
    kappa_K = 1/MARGIN on the worst element.
    """

    def __init__(self, value: float | str, operators: FacetOperators) -> None:
        mesh, facets = operators.mesh, operators.facets
        points = VolumePoints(mesh, 2 * operators.order)
        shear = np.zeros(mesh.ne)
        np.maximum.at(shear, points["nr"], operators.material.ShearAt(points))
        unit = facets.LargestNeighbour(shear) * _Scale(operators)
        needed = facets.Largest(ElementBounds(operators, operators.share / unit, PlainBound))
        self.value = MARGIN * needed if value == "auto" else cast(float, value)
        self.kappa = needed / self.value
        self._facets, self._operators, self._weights = facets, operators, self.value * unit

    def FacetMatrix(self, patch: FacetPatch) -> Array:
        """<P(mu):[nu]>, (n, r, r)."""
        weight = self._operators.share[patch.facets] * self._weights[patch.facets]
        return cast(Array, sum(weight[:, None, None] * self._operators.plainjumps(side) for side in patch.sides))

    @cached_property
    def _weight(self) -> GridFunction:
        return self._facets.Function(self._weights)

    def Interior(self, w: CoefficientFunction, n: CoefficientFunction) -> CoefficientFunction:
        return self._weight * Sym(OuterProduct(w, n))

    Boundary = Interior


class ElasticPenalty:
    """P(w) = {gamma C} sym(w (x) n), C-weighted: it neither loses coercivity near incompressibility nor locks on simplices.

    For a number gamma_e = penalty order^2/h_e; "auto" takes gamma_{K,e} = c_K |e| with the smallest c_K for which
    kappa_K = 1/MARGIN.  Source: Hansbo and Larson, Comput. Methods Appl. Mech. Engrg. 191 (2002).
    """

    def __init__(self, value: float | str, operators: FacetOperators) -> None:
        facets, share = operators.facets, operators.share
        self._facets, self._operators, self._material = facets, operators, facets.frame.InPlane(operators.material)
        self._onfacets = facets.measure if value == "auto" else cast(float, value) * _Scale(operators)
        needed = ElementBounds(operators, share / self._onfacets, ElasticBound)
        self._inelements = MARGIN * needed if value == "auto" else np.ones(operators.mesh.ne)
        self.kappa = 1 / MARGIN if value == "auto" else facets.Largest(needed)

    def FacetMatrix(self, patch: FacetPatch) -> Array:
        """<P(mu):[nu]>, (n, r, r)."""
        weights = (self._operators.share * self._onfacets)[patch.facets, None] * self._inelements[patch.elements]
        sides = patch.sides
        if self._operators.material.bonus == 0:     # C is the same on both sides
            weights, sides = weights.sum(axis=1, keepdims=True), sides[:1]
        return cast(Array, sum(weight[:, None, None] * self._operators.elasticjumps(side)
                               for weight, side in zip(weights.T, sides)))

    @cached_property
    def _functions(self) -> tuple[GridFunction, GridFunction]:
        gamma = GridFunction(L2(self._operators.mesh, order=0, dgjumps=True))
        gamma.vec.FV().NumPy()[:] = self._inelements
        return gamma, self._facets.Function(self._onfacets)

    def Interior(self, w: CoefficientFunction, n: CoefficientFunction) -> CoefficientFunction:
        (gamma, weight), jump, material = self._functions, Sym(OuterProduct(w, n)), self._material
        return 0.5 * weight * (gamma * material.Stress(jump) + gamma.Other() * material.OtherStress(jump))

    def Boundary(self, w: CoefficientFunction, n: CoefficientFunction) -> CoefficientFunction:
        gamma, weight = self._functions
        return weight * gamma * self._material.Stress(Sym(OuterProduct(w, n)))
