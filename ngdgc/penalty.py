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

import numpy as np
from ngsolve import (L2, VOL, BilinearForm, ElementId, GridFunction, InnerProduct, OuterProduct, Sym, VectorL2,
                     dx, specialcf)

from .elasticity import Strain
from .exceptions import ProblemError
from .facets import Csr, Threads, VolumePoints

MARGIN = 2      # kappa_K = 1/MARGIN for penalty="auto": B_h >= (1 - 1/sqrt 2) of the energy norm


def ElementPencil(material, facets, order, facetweight, quadratic):
    """Largest eigenvalue over V_h(K) of int_dK facetweight * quadratic(eps) against int_K C eps:eps, per element.

    `facetweight` is an array over facets; elements with weight zero on all facets get 0.  Rigid motions, on which both
    forms vanish, are left out.
    """
    mesh = facets.mesh
    space = VectorL2(mesh, order=order)
    u, v = space.TnT()
    energy = BilinearForm(InnerProduct(material.Stress(Strain(u)), Strain(v)) * dx(bonus_intorder=material.bonus))
    boundary = BilinearForm(facets.Function(facetweight) * quadratic(Strain(u), Strain(v))
                            * dx(element_boundary=True, bonus_intorder=material.bonus))
    with Threads(mesh):
        energy.Assemble()
        boundary.Assemble()
    touched = np.flatnonzero(np.abs(facets.incidence).T @ (np.abs(facetweight) > 0))
    largest = np.zeros(mesh.ne)
    for elements, dofs in _DofsBySize(space, touched):
        lower, upper = (_Blocks(Csr(form.mat), dofs) for form in (energy, boundary))
        if not (np.all(np.isfinite(lower)) and np.all(np.isfinite(upper))):
            raise ProblemError("the material is not finite at some quadrature point of the elements or facets; look for a "
                               "division by zero or a root of a negative number")
        values, vectors = np.linalg.eigh(lower)
        positive = values > 1e-11 * values[:, -1:]
        scaled = vectors * np.where(positive, 1 / np.sqrt(np.where(positive, values, 1)), 0)[:, None, :]
        largest[elements] = np.linalg.eigvalsh(np.swapaxes(scaled, 1, 2) @ upper @ scaled)[:, -1]
    return largest


def _DofsBySize(space, elements):
    """Groups (element numbers, sorted dof numbers) of elements with equally many dofs."""
    groups = {}
    for element in elements:
        dofs = space.GetDofNrs(ElementId(VOL, int(element)))
        groups.setdefault(len(dofs), []).append((element, sorted(dofs)))
    for group in groups.values():
        yield np.array([element for element, _ in group]), np.array([dofs for _, dofs in group])


def _Blocks(matrix, dofs):
    """Diagonal blocks of a block-diagonal matrix with full blocks, whose columns are sorted."""
    starts = matrix.indptr[dofs]
    return matrix.data[starts[:, :, None] + np.arange(dofs.shape[1])]


def Penalty(value, material, facets, order, share):
    """The penalty of a method: "auto" or a number."""
    if value == "auto":
        return ElasticPenalty(material, facets, order, share)
    return ScalarPenalty(value, material, facets, order, share)


class ScalarPenalty:
    """P(w) = (eta_e/h_e) sym(w (x) n) with eta_e = penalty * mu * order^2, the paper's [u]:[v] eta_e/h_e.

    mu is the larger one of the two sides and h_e the diameter of e.
    """

    def __init__(self, penalty, material, facets, order, share):
        mesh = facets.mesh
        points = VolumePoints(mesh, 2 * order)
        shear = np.zeros(mesh.ne)
        np.maximum.at(shear, points["nr"], material.ShearAt(points))
        weight = penalty * order ** 2 * facets.LargestNeighbour(shear) / facets.diameter
        n = specialcf.normal(mesh.dim)

        def Dual(strain, otherstrain):
            a, b = material.Stress(strain) * n, material.Stress(otherstrain) * n
            return 2 * InnerProduct(a, b) - (a * n) * (b * n)

        self.weight = facets.Function(weight)
        self.bound = ElementPencil(material, facets, order, share / weight, Dual).max(initial=0)

    def Interior(self, w, n):
        return self.weight * Sym(OuterProduct(w, n))

    Boundary = Interior


class ElasticPenalty:
    """P(w) = {gamma C} sym(w (x) n), gamma_{K,e} = c_K |e| with the smallest c_K for which kappa_K = 1/MARGIN.

    C-weighted, so that it does not lose coercivity near incompressibility, nor lock on simplices (Hansbo and Larson 2002).
    """

    def __init__(self, material, facets, order, share):
        mesh = facets.mesh
        self.material = material
        constant = MARGIN * ElementPencil(material, facets, order, share / facets.measure,
                                          lambda strain, other: InnerProduct(material.Stress(strain), other))
        self.gamma = GridFunction(L2(mesh, order=0, dgjumps=True))
        self.gamma.vec.FV().NumPy()[:] = constant
        self.measure = facets.Function(facets.measure)
        self.bound = 1 / MARGIN

    def Interior(self, w, n):
        jump = Sym(OuterProduct(w, n))
        return 0.5 * self.measure * (self.gamma * self.material.Stress(jump)
                                     + self.gamma.Other() * self.material.OtherStress(jump))

    def Boundary(self, w, n):
        return self.measure * self.gamma * self.material.Stress(Sym(OuterProduct(w, n)))
