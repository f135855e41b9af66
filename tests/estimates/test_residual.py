"""The residual estimator: bounds of the error from both sides, its order, nothing where the solution is exact."""

import numpy as np
import pytest
from bodies import Distorted, Ring
from ngsolve import CF, ElementId, IfPos, exp, sin, specialcf, x, y
from problems import GRADED, ORTHOTROPIC

from ngdgc import (LDG, Conforming, ContactProblem, ContactSolution, Discretization, Foundation, HookeMaterial,
                   InteriorPenalty, NonsymmetricInteriorPenalty, NormalCompliance, Solve)
from ngdgc.errors import EnergyError
from ngdgc.estimates.contactresidual import ContactResidual
from ngdgc.estimates.residual import ResidualEstimate
from ngdgc.exact import AffinePatch, BodyForce, Exact, SmoothSlip, Traction
from ngdgc.mesh.facets import Projected
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.traces import ThreeZones

# Without constants of interpolation: measured from 2.2 (tetrahedra, H1) to 7.0 (orthotropic), and no order or shape beside it.
BAND = 2, 7.5


def Effectivity(exact, method, mesh, order):
    """(value/error, error, solution)."""
    solution = Solve(Discretization(exact.problem, method, mesh, order=order), tol=1e-9)
    error = EnergyError(solution, exact.displacement)
    return ResidualEstimate(solution).value / error, error, solution


def Bent(material, region, dirichlet, roller=None):
    """u and its strain vanish on y = 0, where the body lies free above a foundation far below; any material, a roller."""
    u = CF((y * y * sin(x + y), y * y * exp(x - y) / 2))
    data = {"dirichlet": {dirichlet: u}, "bodyforce": BodyForce(material, u)}
    if roller:
        n, stress = specialcf.normal(2), Traction(material, u)
        data |= {"roller": {roller: u * n}, "traction": {roller: stress - (stress * n) * n}}
    return Exact(ContactProblem(material, Foundation(region, NormalCompliance(1.0), gap=100.0), **data), u, None)


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("method", [InteriorPenalty(), LDG(form="lifting"), NonsymmetricInteriorPenalty(), Conforming()],
                         ids=lambda method: method.name)
def test_value_has_the_order_of_the_error_and_stays_in_a_band(method, order):
    """Effectivities on two meshes differ by less than 5 %: the rate of the value is that of the error, within 0.07."""
    (coarse, before, _), (fine, after, _) = (Effectivity(SmoothSlip(), method, RectangleMesh(n), order) for n in (4, 8))
    assert BAND[0] < fine < BAND[1] and fine == pytest.approx(coarse, rel=0.05)
    assert np.log2(before / after) == pytest.approx(order, abs=0.15)


@pytest.mark.slow
@pytest.mark.parametrize("method", [InteriorPenalty(), Conforming()], ids=lambda method: method.name)
@pytest.mark.parametrize("cells", ["tet", "hex", "prism"])
def test_band_in_space(cells, method):
    assert BAND[0] < Effectivity(SmoothSlip(dim=3), method, BoxMesh(2, cells=cells), 1)[0] < BAND[1]


STEEL = HookeMaterial(E=100, nu=0.3)
BODIES = {"graded": (GRADED, "bottom", "top|left", "right", lambda: RectangleMesh(4)),
          "orthotropic": (ORTHOTROPIC, "bottom", "top|left", "right", lambda: RectangleMesh(4)),
          "quad": (STEEL, "bottom", "top|left|right", None, lambda: Distorted("quad")),
          "mixed": (STEEL, "bottom", "top|left|right", None, lambda: Distorted("mixed")),
          "curved": (STEEL, "horizontal", "outer|vertical", "inner", lambda: Ring(2, 0.5))}


@pytest.mark.slow
@pytest.mark.parametrize("method", [InteriorPenalty(), Conforming()], ids=lambda method: method.name)
@pytest.mark.parametrize("name", BODIES)
def test_band_for_varying_and_anisotropic_materials_rollers_and_curves(name, method):
    *data, mesh = BODIES[name]
    assert BAND[0] < Effectivity(Bent(*data), method, mesh(), 2)[0] < BAND[1]


@pytest.mark.parametrize("stiffness", [2.5, 2.5e5, 2.5e9])
def test_stiff_foundations_change_nothing(stiffness):
    """Three zones on a mesh that does not meet their ends; the law enters by its graph, not by p_n(u_h)."""
    exact = ThreeZones(stiffness=stiffness, un=5 / stiffness)
    assert BAND[0] < Effectivity(exact, InteriorPenalty(), RectangleMesh(5), 2)[0] < BAND[1]


@pytest.mark.parametrize("sides", ["dirichlet", "traction", "roller"])
@pytest.mark.parametrize("method", [LDG(), Conforming()], ids=lambda method: method.name)
def test_an_exact_solution_leaves_nothing_and_a_spoilt_one_does(method, sides):
    """Affine u: round-off is some 1e-13 of the solution; in the control one coefficient has moved by a thousandth."""
    exact = AffinePatch("slip", sides=sides)
    solution = Solve(Discretization(exact.problem, method, RectangleMesh(3)))
    assert ResidualEstimate(solution).relative < 1e-9
    vector = solution.vector.copy()
    vector[5] += 1e-3 * np.abs(vector).max()
    assert ResidualEstimate(type(solution)(solution.disc, vector, solution.traction)).relative > 1e-5


def Guessed(method, u, material, **data):
    """A function in the place of a solution, of order 2 on four squares; without traction."""
    problem = ContactProblem(material, Foundation("bottom", NormalCompliance(STIFF)), **data)
    disc = Discretization(problem, method, RectangleMesh(2, cells="quad"), order=2)
    return ContactSolution(disc, Projected(disc.space, u), np.zeros_like(disc.contact.normals))


A, B, G, STIFF, STEP = 0.03, -0.02, 0.01, 7.0, IfPos(x - 0.5, 1.0, 0.0)


def test_parts_of_a_step_are_the_formulas():
    """u_h = (A, B) in the right half and 0 in the left: no stress, h = 1/2 everywhere, c = 2 mu, k = 2."""
    mu, lam, k, h, f = 2.0, 3.0, 2, 0.5, 0.4
    solution = Guessed(InteriorPenalty(), CF((A * STEP, B * STEP)), HookeMaterial(mu=mu, lam=lam), bodyforce=(0, f),
                       dirichlet={"top": (0, 0)}, roller={"right": G})
    parts = {name: part ** 2 for name, part in ResidualEstimate(solution).parts.items()}
    inside = 2 * (mu * (A ** 2 + B ** 2 + A ** 2) + lam * A ** 2) / 4        # both sides see half of the jump
    above = (mu * (A ** 2 + B ** 2 + B ** 2) + lam * B ** 2) / 2            # on half of the side
    beside = (2 * mu + lam) * (A - G) ** 2
    assert parts["jumps"] == pytest.approx(k ** 2 / h * (inside + above + beside), rel=1e-10)
    assert parts["equilibrium"] == pytest.approx(h ** 2 / (2 * mu * k ** 2) * f ** 2, rel=1e-10)
    # The graph of the law has the pressure p = stiffness r where p + gamma r = gamma (-B), on half of the side.
    gamma = 2 * mu * k / h
    pressure = STIFF * gamma / (STIFF + gamma) * -B
    assert parts["law"] == pytest.approx(pressure ** 2 / gamma / 2, rel=1e-10)


@pytest.mark.parametrize("method", [InteriorPenalty(), Conforming()], ids=lambda method: method.name)
def test_parts_of_a_kink_are_the_formulas(method):
    """u_h = A (x - 1/2)_+ e_x, E = 1 + 4 x, k = 2: sigma_h n is s E to the right of the kink and 0 to its left."""
    nu, k, h, t = 0.25, 2, 0.5, 0.3
    u = CF((A * (x - 0.5) * STEP, 0))
    solution = Guessed(method, u, HookeMaterial(E=1 + 4 * x, nu=nu), dirichlet={"top": u}, traction={"left": (t, 0)})
    left, right = 2 / (1 + nu), 4 / (1 + nu)        # c = 2 mu in the middle of the elements
    s = A * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    # Half of the difference on both sides of the kink; what is given where nothing is; all of it where the body is free.
    wanted = (3 * s / 2) ** 2 * (1 / left + 1 / right) + t ** 2 / left + (5 * s) ** 2 / right
    parts = ResidualEstimate(solution).parts
    assert parts["tractions"] ** 2 == pytest.approx(h / k * wanted, rel=1e-8) and parts["jumps"] < 1e-10


def test_indicators_sum_up_and_say_where():
    """To the square of the value; the law's part is largest where the stick zone ends inside of a facet, at x = 1/4."""
    exact = ThreeZones()
    effectivity, error, solution = Effectivity(exact, Conforming(), RectangleMesh(13), 3)
    estimate, law = ResidualEstimate(solution), ContactResidual(solution)
    assert estimate.indicators.shape == (338,) and np.all(estimate.indicators >= 0)
    assert estimate.value ** 2 == pytest.approx(estimate.indicators.sum(), rel=1e-12)
    assert estimate.value ** 2 == pytest.approx(sum(share ** 2 for share in estimate.parts.values()), rel=1e-12)
    assert estimate.relative == pytest.approx(estimate.value / np.sqrt(2 * solution.energy), rel=1e-12)
    assert estimate.bound is None and "constants" in estimate.reason
    vertices = [solution.disc.mesh[vertex].point[0] for vertex in solution.disc.mesh[ElementId(int(law.argmax()))].vertices]
    assert min(vertices) < 0.25 < max(vertices)
    # Control: without the residuals inside of the elements the value would leave the band.
    rest = estimate.value ** 2 - estimate.parts["equilibrium"] ** 2
    assert np.sqrt(rest) < BAND[0] * error < BAND[0] * effectivity * error
