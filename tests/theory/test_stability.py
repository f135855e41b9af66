"""Lemmas 3.1 to 3.4: consistency, liftings, boundedness, coercivity, against dense matrices and definitions."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.linalg
from bodies import Cube, Distorted
from checks import Interpolate, Random
from ngsolve import (CF, BilinearForm, ConvertOperator, GridFunction, InnerProduct, Integrate, OuterProduct, Sym, cos, ds, dx,
                     exp, sin, specialcf, x, y, z)
from problems import FOUNDATION, GRADED, Held

from ngdgc import (LDG, BassiEtAl, BrezziEtAl, Conforming, ContactProblem, Discretization, HookeMaterial,
                   InteriorPenalty, Lifting)
from ngdgc.theory.consistency import ConsistencyResidual, ConsistencyVector
from ngdgc.problem.materials import Strain
from ngdgc.errors import Rates
from ngdgc.exact import BodyForce, SmoothSlip, Traction
from ngdgc.mesh.facets import Csr, Native
from ngdgc.mesh.quadrature import BoundaryQuadrature
from ngdgc.theory.lemmas import Boundedness, Coercivity, DualNorm, LiftingConstants, NormMatrix
from ngdgc.meshes import RectangleMesh
from ngdgc.methods.guarantee import ALWAYS
from ngdgc.methods.symbolform import Coefficients
from ngdgc.studies.stability import ROWS

FORMS = ("edge", "lifting")


def SmoothWithRollers(material=GRADED):
    """A smooth u, no polynomial, under a body force, with Gamma_D, rollers, tractions and varying C: (problem, u)."""
    u = CF((sin(x + 2 * y), exp(x * y)))
    stress = Traction(material, u)
    # On a roller u_n is prescribed and the tangential traction given: here on x = 0, n = (-1, 0).
    problem = ContactProblem(material, FOUNDATION, dirichlet={"top": u}, roller={"left": -u[0]},
                             traction={"right": stress, "left": CF((0, stress[1]))}, bodyforce=BodyForce(material, u))
    return problem, u


def SmoothSolid():
    """The same in 3D with constant C, lam = 0, mu = 1/2, so that C eps = eps: (problem, u)."""
    u = CF((sin(y + z), cos(x) * z, exp(x + y)))
    # -div eps(u) = -(Laplace u + grad div u)/2, and div u = 0.
    force = 0.5 * CF((2 * sin(y + z), cos(x) * z, -2 * exp(x + y)))
    return ContactProblem(HookeMaterial(mu=0.5, lam=0.0), FOUNDATION, dirichlet={"left|right|top|front|back": u},
                          bodyforce=force), u


def Size(disc, u):
    """Square root of int C eps(u):eps(u), against which residuals are small or large."""
    function = GridFunction(disc.space)
    function.Set(u)
    return np.sqrt(Integrate(InnerProduct(disc.problem.material.Stress(Strain(function)), Strain(function)), disc.mesh))


@pytest.mark.slow
@pytest.mark.parametrize("method", [*(row() for row in ROWS), Conforming()], ids=lambda method: method.name)
@pytest.mark.parametrize("setting", ["slip", "rollers", "solid"])
def test_edge_forms_are_consistent(setting, method):
    """Lemma 3.1: round-off for a smooth solution; a body force that is wrong by a tenth is seen."""
    problem, u = {"slip": lambda: (SmoothSlip().problem, SmoothSlip().displacement), "rollers": SmoothWithRollers,
                  "solid": SmoothSolid}[setting]()
    mesh = Cube("tet", 2) if setting == "solid" else Distorted("triangle")
    disc = Discretization(problem, method, mesh, order=2)
    # 2 k + 6 points of degree leave 1e-9 of functions like exp(x y) on elements of size 0.4.
    assert ConsistencyResidual(disc, u) < 1e-8 * Size(disc, u)
    wrong = replace(problem, bodyforce=1.1 * problem.bodyforce)
    assert ConsistencyResidual(Discretization(wrong, method, mesh, order=2), u) > 1e-3 * Size(disc, u)


@pytest.mark.slow
@pytest.mark.parametrize("setting, order", [("slip", 1), ("slip", 2), ("slip", 3), ("rollers", 1), ("rollers", 2)])
def test_lifting_forms_are_consistent_to_order_l_plus_1(setting, order):
    problem, u = SmoothWithRollers() if setting == "rollers" else (SmoothSlip().problem, SmoothSlip().displacement)

    sizes = (8, 16) if order == 1 else (4, 8)       # at low order the rate comes later

    def Residuals(liftorder):
        method = LDG(form="lifting", liftorder=liftorder)
        discs = [Discretization(problem, method, RectangleMesh(n), order=order) for n in sizes]
        return np.array([ConsistencyResidual(disc, u) for disc in discs]) / Size(discs[-1], u)

    assert Rates(Residuals(order))[0] == pytest.approx(order + 1, abs=0.15)
    assert Residuals(order)[1] < sizes[1] ** -order
    # Liftings of one degree less: one order less.
    assert Rates(Residuals(order - 1))[0] == pytest.approx(order, abs=0.15)


@pytest.mark.parametrize("form", FORMS)
def test_consistency_residual_is_that_of_the_assembled_form(form):
    """u of degree 3 lies in the space of order 3 without jumps, so B_h of order 3 tested with order 1 is B_h(u, v)."""
    material, u = HookeMaterial(mu=50, lam=80), CF((x * y ** 2, x ** 3 - x * y))
    problem = ContactProblem(material, FOUNDATION, dirichlet={"left|right|top": u}, bodyforce=BodyForce(material, u))
    mesh, method = Distorted("triangle"), LDG(form=form, liftorder=1)
    coarse, fine = (Discretization(problem, method, mesh, order=order) for order in (1, 3))
    bottom = Traction(material, u)(BoundaryQuadrature.On(fine.facets, "bottom", 7).points)
    embedding = Csr(ConvertOperator(coarse.space, fine.space))
    expected = embedding.T @ (fine.Multiply(Interpolate(fine, u)) - fine.load - fine.contact.Load(bottom))
    residual, scale = ConsistencyVector(coarse, u), np.abs(fine.load).max()
    assert residual == pytest.approx(expected, abs=1e-11 * scale)
    # The lifting of order 1 sees the projection of a quadratic stress only.
    assert (np.abs(residual).max() > 1e-5 * scale) == (form == "lifting")


def test_without_the_consistency_term_the_residual_does_not_vanish():
    exact, norms = SmoothSlip(), []
    for n in (4, 8, 16):
        disc = Discretization(exact.problem, InteriorPenalty(), RectangleMesh(n), order=2)
        v, active = disc.space.TestFunction(), disc.facets.Function(Lifting(disc).operators.share > 0)
        term = Coefficients(active * (Traction(exact.problem.material, exact.displacement) * v)
                            * dx(element_boundary=True, bonus_intorder=6))
        norms.append(DualNorm(disc, ConsistencyVector(disc, exact.displacement) + term) / Size(disc, exact.displacement))
    assert norms[2] > 0.9 * norms[1] > 0.3


def test_dual_norm_is_a_supremum():
    disc = Discretization(Held(), BassiEtAl(), Distorted("triangle"), order=2)
    norm, random = Csr(NormMatrix(disc)), np.random.default_rng(0).standard_normal((5, disc.space.ndof))
    functional = norm @ random[0]
    largest = DualNorm(disc, functional)
    assert largest == pytest.approx(np.sqrt(random[0] @ functional), rel=1e-9)      # attained by the representer
    for v in random[1:]:
        assert abs(functional @ v) < largest * np.sqrt(v @ norm @ v)


@pytest.mark.parametrize("kind", ["squares", "rollers", "tetrahedra"])
def test_norm_against_its_definition(kind):
    """|||v|||^2 of a random function from its own tensor jumps, facet by facet."""
    mesh = {"squares": RectangleMesh(3, upper=(2, 1), cells="quad"), "rollers": RectangleMesh(3),
            "tetrahedra": Cube("tet", 2)}[kind]
    mu = 7.0
    problem = replace(Held(mesh.dim, mu=mu, lam=4.0), roller={"left": 0} if kind == "rollers" else None)
    disc = Discretization(problem, LDG(), mesh, order=1)
    operators, function = Lifting(disc).operators, Random(disc.space)
    vector, n = function.vec.FV().NumPy(), specialcf.normal(mesh.dim)
    jump = GridFunction(operators.blocks.facetspace)
    jump.vec.FV().NumPy()[:] = operators.inverseMF @ (operators.J @ vector)
    # Both sides of an interior facet are integrated.
    tensor = Sym(OuterProduct(jump, n))
    weight = disc.facets.Function(mu * operators.share / disc.facets.diameter)
    square = Integrate(weight * InnerProduct(tensor, tensor) * dx(element_boundary=True), mesh)
    strain = Strain(function)
    square += Integrate(InnerProduct(problem.material.Stress(strain), strain), mesh, order=4)
    assert vector @ Csr(NormMatrix(disc)) @ vector == pytest.approx(square, rel=1e-10)


@pytest.mark.parametrize("order, liftorder", [(1, 0), (1, 1), (2, 1), (2, 2)])
def test_lifting_constants_against_dense_liftings_of_all_functions(order, liftorder):
    """|r_e([v])|^2 from r_e of every basis function, the jumps from another degree of l that sees them all: sup and inf."""
    disc = Discretization(replace(Held(), roller={"left": 0}), LDG(), Distorted("triangle"), order=order)
    bounds, lifting = LiftingConstants(disc, order=liftorder), Lifting(disc, order=liftorder)
    operators, basis = lifting.operators, GridFunction(disc.space)
    weak = np.flatnonzero(operators.share)
    assert len(bounds.lower) == len(bounds.upper) == len(weak)
    q, p = lifting.space.TnT()
    mass = Csr(BilinearForm(InnerProduct(q, p) * dx).Assemble().mat).toarray()
    u, v = disc.space.TnT()
    kinds = [np.flatnonzero(disc.facets.On("right")), np.flatnonzero(disc.facets.On("left")),
             np.flatnonzero(disc.facets.neighbours == 2)]
    pairs = []
    for facet in (kind[0] for kind in kinds):
        columns = []
        for dof in range(disc.space.ndof):
            basis.vec[:] = 0
            basis.vec[dof] = 1
            columns.append(lifting.Local(basis, facet).vec.FV().NumPy().copy())
        lifts = np.array(columns) @ mass @ np.array(columns).T
        only, n = disc.facets.Function(np.arange(len(operators.share)) == facet), specialcf.normal(2)
        form = BilinearForm(disc.space)
        for w, s, measure in ((u - u.Other(), v - v.Other(), dx(skeleton=True)), (u, v, ds(skeleton=True))):
            w, s = (w, s) if facet != kinds[1][0] else ((w * n) * n, (s * n) * n)
            form += only * InnerProduct(Sym(OuterProduct(w, n)), Sym(OuterProduct(s, n))) * measure
        jumps = Csr(form.Assemble().mat).toarray() / disc.facets.diameter[facet]
        values, vectors = np.linalg.eigh(jumps)
        real = vectors[:, values > 1e-10 * values[-1]] / np.sqrt(values[values > 1e-10 * values[-1]])
        squares = np.linalg.eigvalsh(real.T @ lifts @ real)
        pairs.append((np.sqrt(max(squares[0], 0)), np.sqrt(squares[-1])))
    for lower, upper in pairs:
        here = np.abs(bounds.lower - lower) + np.abs(bounds.upper - upper)
        assert here.min() < 1e-6        # the root of the round-off of a square that is zero
        assert bounds.c - 1e-6 <= lower <= upper <= bounds.C + 1e-10
    assert (bounds.c < 1e-6) == (liftorder < order)


@pytest.mark.parametrize("cells, order", [("triangle", 1), ("triangle", 3), ("quad", 2), ("tet", 1), ("tet", 2), ("hex", 1)])
def test_lifting_constants_do_not_depend_on_the_mesh_size(order, cells):
    def Bounds(n, liftorder):
        mesh = RectangleMesh(n, cells=cells) if cells in ("triangle", "quad") else Cube(cells, n)
        return LiftingConstants(Discretization(Held(mesh.dim), LDG(), mesh, order=order), order=liftorder)

    coarse, fine = Bounds(2, None), Bounds(3, None)
    assert (coarse.c, coarse.C) == pytest.approx((fine.c, fine.C), rel=1e-9) and coarse.c > 0.5
    assert Bounds(2, 0).c < 1e-6        # constants see the mean of a jump only


def Dense(disc):
    """(smallest eigenvalue of the symmetric part, largest singular value) of B_h against |||.|||."""
    norm, matrix = Csr(NormMatrix(disc)).toarray(), Csr(disc.form.Matrix()).toarray()
    smallest = scipy.linalg.eigh((matrix + matrix.T) / 2, norm, eigvals_only=True)[0]
    root = np.linalg.cholesky(norm)
    scaled = scipy.linalg.solve_triangular(root, scipy.linalg.solve_triangular(root, matrix, lower=True).T, lower=True)
    return smallest, np.linalg.svd(scaled, compute_uv=False)[0]


@pytest.mark.slow
@pytest.mark.parametrize("cells", ["triangle", "quad"])
@pytest.mark.parametrize("method", [InteriorPenalty(), InteriorPenalty(penalty=10), BassiEtAl(form="lifting"), BrezziEtAl(),
                                    LDG()], ids=repr)
def test_coercivity_and_boundedness_are_the_dense_ones(method, cells):
    disc = Discretization(Held(), method, Distorted(cells), order=2)
    smallest, largest = Dense(disc)
    assert Coercivity(disc) == pytest.approx(smallest, rel=1e-3) and Boundedness(disc) == pytest.approx(largest, rel=1e-3)
    # 10 is too small here, the automatic penalty is not.
    assert (smallest > 0.1) == (method.penalty == "auto")


def test_unsymmetric_forms_are_judged_by_their_symmetric_part():
    """NIPG: the consistency terms cancel in B_h(v, v), for any penalty; in the symmetric form they do not."""
    disc = Discretization(Held(), InteriorPenalty(form="lifting", penalty=0.5), Distorted("triangle"), order=2)
    assert Coercivity(disc) < -0.1
    operators = Lifting(disc).operators
    consistency = operators.J.T @ operators.inverseMF @ operators.S
    matrix = Native((Csr(disc.form.Norm()) - consistency + consistency.T).tocsr())
    disc.form = SimpleNamespace(Matrix=lambda: matrix, Norm=disc.form.Norm, guarantee=ALWAYS)
    smallest, largest = Dense(disc)
    assert Coercivity(disc) == pytest.approx(smallest, rel=1e-3) and smallest > 0.1
    assert Boundedness(disc) == pytest.approx(largest, rel=1e-3)
    # The symmetric part alone does not tell.
    assert largest > 1.5 * scipy.linalg.eigvalsh(Csr(disc.form.Norm()).toarray(), Csr(NormMatrix(disc)).toarray())[-1]


def test_conforming_elements_are_coercive_and_bounded_with_constant_1():
    disc = Discretization(Held(), Conforming(), Distorted("triangle"), order=2)
    assert (Coercivity(disc), Boundedness(disc)) == pytest.approx((1, 1), rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("row", ROWS)
def test_constants_do_not_depend_on_the_mesh_size(row):
    """Lemmas 3.3 and 3.4."""
    coarse, fine = (Discretization(Held(), row(), RectangleMesh(n), order=1) for n in (4, 16))
    assert Coercivity(fine) == pytest.approx(Coercivity(coarse), rel=0.03)
    assert Boundedness(fine) == pytest.approx(Boundedness(coarse), rel=0.03)
