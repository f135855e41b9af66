"""The bilinear form: exact on polynomials, agreeing with H1, coercive; interfaces, rollers, curved sides."""

import numpy as np
import pytest
from bodies import Distorted, Ring, Tilted
from checks import Interpolate, Spectrum
from netgen.geom2d import SplineGeometry
from ngsolve import (CF, ConvertOperator, Grad, GridFunction, IfPos, InnerProduct, Integrate, LinearForm, Mesh, ds, sin,
                     specialcf, x, y)
from problems import GRADED, METHODS, OPEN, ORTHOTROPIC, Example

from ngdgc import (LDG, BassiEtAl, BrezziEtAl, Conforming, ContactProblem, Discretization, Foundation,
                   HookeMaterial, InteriorPenalty, Lifting, NormalCompliance, SemismoothNewtonSolver)
from ngdgc.problem.materials import Strain
from ngdgc.exact import BodyForce, Traction
from ngdgc.mesh.facets import Csr
from ngdgc.mesh.quadrature import BoundaryQuadrature
from ngdgc.meshes import RectangleMesh
from ngdgc.methods.penalty import MARGIN
from ngdgc.solution.resultants import RigidBasis
from ngdgc.methods.coercivity import SmallestEigenvalue


@pytest.mark.slow
@pytest.mark.parametrize("material", [HookeMaterial(mu=50, lam=80), ORTHOTROPIC, GRADED],
                         ids=["hooke", "anisotropic", "graded"])
@pytest.mark.parametrize("cells", ["triangle", "quad", "mixed"])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_polynomials_of_the_degree_are_returned(order, cells, material, method):
    """Non-homogeneous Dirichlet data and tractions, unstructured meshes, varying C: u of degree k is the solution."""
    u = {1: CF((0.2 + x - 3 * y, y + 0.5 * x)), 2: CF((x * y - y ** 2, x ** 2 + y)), 3: CF((x * y ** 2, x ** 3 - x * y))}[order]
    stress = Traction(material, u)
    problem = ContactProblem(material, OPEN, dirichlet={"right|top": u}, traction={"left": stress},
                             bodyforce=BodyForce(material, u))
    # The bottom is free here (the foundation is out of reach), so its traction comes as a load of its own.
    disc = Discretization(problem, method, Distorted(cells), order=order)
    measure = ds(skeleton=True, definedon=disc.mesh.Boundaries("bottom"), bonus_intorder=2)
    bottom = LinearForm(stress * disc.space.TestFunction() * measure).Assemble().vec.FV().NumPy()
    vector, free = Interpolate(disc, u), np.array(list(disc.space.FreeDofs()))

    def Rest(vector):
        return np.abs((disc.Multiply(vector) - disc.load - bottom)[free]).max() / np.abs(disc.load).max()

    assert Rest(vector) < 1e-11
    if order > 1:
        assert Rest(1.01 * vector) > 1e-4


@pytest.mark.parametrize("penalty", ["auto", 30])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_form_restricted_to_continuous_functions_is_the_conforming_one(order, penalty):
    mesh, problem = Distorted("triangle"), Example()
    dg = Discretization(problem, InteriorPenalty(penalty=penalty), mesh, order=order)
    h1 = Discretization(problem, Conforming(), mesh, order=order)
    embedding = Csr(ConvertOperator(h1.space, dg.space))
    free = np.flatnonzero(list(h1.space.FreeDofs()))
    restricted = (embedding.T @ Csr(dg.matrix) @ embedding)[free][:, free]
    conforming = Csr(h1.matrix)[free][:, free]
    assert abs(restricted - conforming).max() < 1e-11 * abs(conforming).max()
    # Functions that do not vanish on Gamma_D see the penalty.
    assert abs(embedding.T @ Csr(dg.matrix) @ embedding - Csr(h1.matrix)).max() > 0.1 * abs(conforming).max()


def test_form_is_symmetric_and_rigid_motions_have_no_strain(method):
    disc = Discretization(Example(), method, Distorted("triangle"), order=2)
    matrix = Csr(disc.matrix)
    assert abs(matrix - matrix.T).max() < 1e-12 * abs(matrix).max()
    for motion in RigidBasis(disc.space):
        function = GridFunction(disc.space)
        function.vec.FV().NumPy()[:] = motion
        assert Integrate(InnerProduct(Strain(function), Strain(function)), disc.mesh) < 1e-24
        assert Integrate(InnerProduct(Grad(function), Grad(function)), disc.mesh) + abs(motion).max() > 0.1


@pytest.mark.parametrize("cells", ["triangle", "quad"])
@pytest.mark.parametrize("order", [1, 2])
def test_lanczos_finds_the_dense_smallest_eigenvalue(order, cells):
    disc = Discretization(Example(), InteriorPenalty(penalty=60), Distorted(cells), order=order)
    smallest = SmallestEigenvalue(disc.form.Matrix(), disc.form.Norm(), disc.space.FreeDofs())
    assert smallest == pytest.approx(Spectrum(disc), rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("stretch", [1, 100])
@pytest.mark.parametrize("order", [1, 2, 4])
@pytest.mark.parametrize("nu", [0.0, 0.4, 0.4999])
def test_automatic_penalty_keeps_its_promise(nu, order, stretch):
    """Coercive with 1 - 1/sqrt(MARGIN) whatever order, nu and aspect ratio; and not wastefully: the constant is below 0.9."""
    mesh = RectangleMesh(2, upper=(1, 1 / stretch))
    disc = Discretization(Example(material=HookeMaterial(E=1000, nu=nu)), InteriorPenalty(), mesh, order=order)
    assert 1 - MARGIN ** -0.5 - 1e-6 < Spectrum(disc) < 0.9


def test_element_bound_is_safe_and_sharp():
    """Where the bound says coercive it is; and it is not far from the true threshold, 21.5 mu for P1 and lam/mu = 4."""
    problem, mesh = Example(), RectangleMesh(4)
    bound = Discretization(problem, InteriorPenalty(penalty=30), mesh, order=1).form.guarantee.kappa
    threshold = 30 * bound      # the bound is proportional to 1/penalty
    assert Spectrum(Discretization(problem, InteriorPenalty(penalty=1.001 * threshold), mesh, order=1)) > 0
    assert 21.5 < threshold < 1.5 * 21.5


def TwoMaterials(interface):
    geometry = SplineGeometry()
    points = [geometry.AppendPoint(*p) for p in [(0, 0), (1, 0), (1, 0.5), (1, 1), (0, 1), (0, 0.5)]]
    for a, b, name, left in [(0, 1, "bottom", 1), (1, 2, "right", 1), (2, 3, "right", 2), (3, 4, "top", 2), (4, 5, "left", 2),
                             (5, 0, "left", 1)]:
        geometry.Append(["line", points[a], points[b]], leftdomain=left, rightdomain=0, bc=name)
    geometry.Append(["line", points[5], points[2]], leftdomain=2, rightdomain=1, bc=interface)
    geometry.SetMaterial(1, "soft")
    geometry.SetMaterial(2, "hard")
    return Mesh(geometry.GenerateMesh(maxh=0.3))


@pytest.mark.slow
@pytest.mark.parametrize("assembly", ["facet", "skeleton"])
@pytest.mark.parametrize("row", [InteriorPenalty, BassiEtAl, BrezziEtAl, LDG])
@pytest.mark.parametrize("form", ["edge", "lifting"])
def test_named_interface_between_materials_changes_nothing(form, row, assembly):
    """NGSolve treats named interior facets differently in some skeleton integrals (NGSolve/ngsolve issue 63)."""
    matrices = []
    for interface in ("interface", "default"):
        mesh = TwoMaterials(interface)
        material = HookeMaterial(mu=mesh.MaterialCF({"soft": 10, "hard": 1000}), lam=20)
        disc = Discretization(Example(material=material), row(form=form), mesh, order=1, assembly=assembly)
        matrices.append(Csr(disc.matrix))
        continuous = CF((2 - 2 * x, x - 1))     # zero on Gamma_D
        jumps = Csr(disc.form.Norm()) - Lifting(disc).operators.K
        broken = np.abs(jumps @ Interpolate(disc, IfPos(y - 0.5, continuous, 0 * continuous))).max()     # at the interface
        assert np.abs(jumps @ Interpolate(disc, continuous)).max() < 1e-12 * broken
    assert abs(matrices[0] - matrices[1]).max() < 1e-12 * abs(matrices[0]).max()


def test_stiffer_side_rules_the_penalty_of_an_interface():
    mesh = TwoMaterials("interface")
    material = HookeMaterial(mu=mesh.MaterialCF({"soft": 10, "hard": 1000}), lam=20)
    disc = Discretization(Example(material=material), InteriorPenalty(penalty=30), mesh, order=1)
    on = disc.facets.On("interface")
    weights = []
    for patch in disc.form.operators.FacetPatches(on):
        for matrix, facet in zip(disc.form.rule.FacetMatrix(patch), patch.facets):
            mass = np.linalg.inv(disc.form.operators.inversemass(patch.sides[0]))[0]     # facets of equal length
            weights.append(matrix[2, 2] / mass[0, 0] * disc.facets.diameter[facet])       # mu = (0, phi_0) = phi_0 n
    assert weights == pytest.approx([30 * 1000] * on.sum(), rel=1e-12)


@pytest.mark.parametrize("angle", [0.0, 0.5, 2.0])
def test_winkler_column_on_an_incline(angle, method):
    """B1 between inclined rollers, its top pressed down by a roller too: a linear solution in rotated axes."""
    mu, lam, k, gap, pressure = 1000.0, 1500.0, 100.0, 0.1, 20.0
    depth, e = gap + pressure / k, pressure / (lam + 2 * mu)
    axis = CF((-np.sin(angle), np.cos(angle)))
    height = axis[0] * x + axis[1] * y
    u = -(depth + e * height) * axis
    problem = ContactProblem(HookeMaterial(mu=mu, lam=lam), Foundation("bottom", NormalCompliance(k), gap=gap),
                             roller={"left|right": 0, "top": -(depth + e)})
    solution = SemismoothNewtonSolver(tol=1e-11).Solve(Discretization(problem, method, Tilted(angle), order=1))
    difference = solution.gfu - u
    assert np.sqrt(Integrate(InnerProduct(difference, difference), solution.disc.mesh)) < 1e-10
    assert solution.pressure == pytest.approx(pressure, rel=1e-9)
    lift = {resultant.region: resultant.force for resultant in solution.Resultants()}
    assert lift["bottom"] @ [-np.sin(angle), np.cos(angle)] == pytest.approx(pressure, rel=1e-9)
    assert lift["top"] == pytest.approx(-lift["bottom"], abs=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("method", [*METHODS, BassiEtAl(form="lifting"), BrezziEtAl(), LDG(), LDG(form="lifting")], ids=repr)
@pytest.mark.parametrize("contact", ["inner", "outer"])
def test_lame_ring_with_curved_rollers_and_curved_contact(contact, method):
    """u_r = A r + B/r between a curved roller and a foundation around (or inside) the ring, full rate on curved elements."""
    mu, lam, k, gap, push = 1000.0, 1500.0, 200.0, 0.05, 0.1
    a, b = (1.0, 2.0) if contact == "inner" else (2.0, 1.0)     # radii of contact and of the roller
    sign = -1 if contact == "inner" else 1                      # outward normal at the contact is sign e_r

    def Radial(r):
        return np.array([r, 1 / r])

    def Stress(r):
        return np.array([2 * mu + 2 * lam, -2 * mu / r ** 2])

    # -sigma_rr = k (sign u_r - g) at a;  u_r = sign push at b, which presses the ring against its foundation.
    A, B = np.linalg.solve([Stress(a) + k * sign * Radial(a), Radial(b)], [k * gap, sign * push])
    r2 = x * x + y * y
    u = CF((A * x + B * x / r2, A * y + B * y / r2))
    roller = "outer" if contact == "inner" else "inner"
    problem = ContactProblem(HookeMaterial(mu=mu, lam=lam), Foundation(contact, NormalCompliance(k), gap=gap),
                             roller={"horizontal|vertical": 0, roller: u * specialcf.normal(2)})
    errors = []
    for maxh in (0.5, 0.25):
        disc = Discretization(problem, method, Ring(3, maxh), order=3)
        solution = SemismoothNewtonSolver(tol=1e-10).Solve(disc)
        difference = solution.gfu - u
        errors.append(np.sqrt(Integrate(InnerProduct(difference, difference), disc.mesh, order=8)))
        exact = k * (sign * (A * a + B / a) - gap)
    assert errors[1] < 1e-5 and errors[1] < errors[0] / 8
    assert solution.pressure == pytest.approx(exact, rel=1e-3)
    shifted = exact + k * 0.01
    assert not np.allclose(solution.pressure, shifted, rtol=1e-3)


def test_smooth_modulus_keeps_the_rate():
    """C varying smoothly, a solution that is no polynomial: order k + 1 in L2."""
    u = CF((sin(x + 2 * y), sin(3 * x - y))) / 10
    errors = []
    for n in (4, 8):
        problem = ContactProblem(GRADED, OPEN, dirichlet={"right|top|left": u}, bodyforce=BodyForce(GRADED, u))
        disc = Discretization(problem, InteriorPenalty(), RectangleMesh(n), order=2)
        bottom = Traction(GRADED, u)(BoundaryQuadrature.On(disc.facets, "bottom", 5).points)
        function = GridFunction(disc.space)
        function.vec.FV().NumPy()[:] = disc.SolveLinear(disc.load + disc.contact.Load(bottom))
        difference = function - u
        errors.append(np.sqrt(Integrate(InnerProduct(difference, difference), disc.mesh, order=8)))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(3, abs=0.3)
