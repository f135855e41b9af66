"""Materials and laws: formulas, derivatives, and what is refused when they are built."""

from dataclasses import dataclass

import numpy as np
import pytest
from ngsolve import CF, Integrate, Norm, x, y

from ngdgc import (AnisotropicMaterial, ComplianceLaw, Conforming, ContactProblem, CoulombFriction, Discretization, Foundation,
                   FrictionLaw, HookeMaterial, NormalCompliance, PowerFriction, ProblemError, TrescaFriction, UzawaSolver)
from ngdgc.mesh.facets import VolumePoints
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.problem.materials import StiffnessAt


def test_lame_constants_of_plane_strain_and_stress():
    strain, stress = (HookeMaterial(E=2000, nu=0.4, plane=plane) for plane in ("strain", "stress"))
    assert strain.mu == stress.mu == pytest.approx(2000 / 2.8)
    assert strain.lam == pytest.approx(2000 * 0.4 / (1.4 * 0.2))
    # Plane stress: E/(1 - nu^2) is the stiffness lam* + 2 mu of a uniaxial strain.
    assert stress.lam + 2 * stress.mu == pytest.approx(2000 / (1 - 0.16))
    same = HookeMaterial(mu=strain.mu, lam=strain.lam, plane="stress")
    assert same.lam == pytest.approx(stress.lam)


def test_voigt_matrix_of_hooke_gives_hooke():
    mu, lam = 3.0, 5.0
    hooke = HookeMaterial(mu=mu, lam=lam)
    voigt = AnisotropicMaterial([[lam + 2 * mu, lam, 0], [lam, lam + 2 * mu, 0], [0, 0, mu]])
    strain = CF((x, 2 * y + x, 2 * y + x, x * y), dims=(2, 2))
    mesh = RectangleMesh(2)
    assert Integrate(Norm(voigt.Stress(strain) - hooke.Stress(strain)), mesh) < 1e-14
    shear = AnisotropicMaterial([[lam + 2 * mu, lam, 0], [lam, lam + 2 * mu, 0], [0, 0, 2 * mu]])
    assert Integrate(Norm(shear.Stress(strain) - hooke.Stress(strain)), mesh) > 1


@pytest.mark.parametrize("mesh", [RectangleMesh(1), BoxMesh(1)], ids=["2D", "3D"])
@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_stiffness_of_numbers_is_that_of_coefficients(plane, mesh):
    """To the last digit, which NGSolve computes from the stress of unit strains."""
    points, mu, lam = VolumePoints(mesh, 1), 1 / 3, 0.7
    found = StiffnessAt(HookeMaterial(mu=mu, lam=lam, plane=plane), points, mesh.dim)
    assert np.array_equal(found, StiffnessAt(HookeMaterial(mu=CF(mu), lam=lam, plane=plane), points, mesh.dim))
    other = StiffnessAt(HookeMaterial(mu=CF(mu), lam=lam * (1 + 1e-15), plane=plane), points, mesh.dim)
    assert not np.array_equal(found, other)


@pytest.mark.parametrize("exponent", [0.5, 1, 1.5, 3])
def test_pressure_derivative_against_finite_differences(exponent):
    law = NormalCompliance(stiffness=7.0, exponent=exponent)
    r = np.array([0.01, 0.3, 2.0])
    difference = (law.Pressure(r * (1 + 1e-6)) - law.Pressure(r * (1 - 1e-6))) / (2e-6 * r)
    assert law.PressureDerivative(r) == pytest.approx(difference, rel=1e-8)
    assert np.all(law.Pressure(-r) == 0) and np.all(law.PressureDerivative(-r) == 0)


def test_friction_bounds():
    r, p = np.array([-1.0, 0.5, 2.0]), np.array([0.0, 5.0, 20.0])
    assert CoulombFriction(0.3).Bound(r, p) == pytest.approx([0, 1.5, 6])
    assert PowerFriction(stiffness=4, exponent=2).Bound(r, p) == pytest.approx([0, 1, 16])
    assert TrescaFriction(2).Bound(r, p) == pytest.approx([2, 2, 2])


@dataclass(frozen=True)
class Exponential(ComplianceLaw):
    """A user's law with a coefficient that varies in space."""

    scale: object
    wrong: float = 0.0

    def Pressure(self, r):
        return self.scale * np.expm1(np.maximum(r, 0))

    def PressureDerivative(self, r):
        return self.scale * np.where(r > 0, np.exp(r) + self.wrong, 0)


@dataclass(frozen=True)
class Adhesive(ComplianceLaw):
    def Pressure(self, r):
        return r + 0.1

    def PressureDerivative(self, r):
        return np.ones_like(r)


@dataclass(frozen=True)
class Negative(FrictionLaw):
    def Bound(self, r, p):
        return -np.ones_like(r)


class Incomplete(ComplianceLaw):
    """Forgets its derivative."""

    def Pressure(self, r):
        return np.maximum(r, 0)


class Barrier:
    """No dataclass and no base class, only the two methods; undefined from a penetration of 0.01 on."""

    def __init__(self, stiffness):
        self.stiffness = stiffness

    def Pressure(self, r):
        return self.stiffness * np.where(r > 0, -np.log(1 - 100 * np.maximum(r, 0)), 0)

    def PressureDerivative(self, r):
        return self.stiffness * np.where(r > 0, 100 / (1 - 100 * np.maximum(r, 0)), 0)


def test_any_object_with_the_methods_is_a_law():
    """Also one with a CoefficientFunction among its attributes."""
    for stiffness, value in ((3.0, 3.0), (3.0 + 0 * x, 3.0)):
        foundation = Foundation("bottom", Barrier(stiffness))
        problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, dirichlet={"top": CF((0, -0.002))})
        solution = UzawaSolver().Solve(Discretization(problem, Conforming(), RectangleMesh(4), order=1))
        expected = -value * np.log(1 - 100 * solution.penetration)
        assert solution.pressure == pytest.approx(expected, rel=1e-6) and solution.normalforce > 0.1


def test_users_law_is_accepted_and_a_wrong_derivative_is_not():
    Foundation("bottom", Exponential(3.0))
    with pytest.raises(ProblemError, match="PressureDerivative differs"):
        Foundation("bottom", Exponential(3.0, wrong=0.1))


@pytest.mark.parametrize("arguments, culprit", [
    ({"stiffness": -1}, "stiffness is -1"), ({"stiffness": float("nan")}, "stiffness is nan"),
    ({"stiffness": "hard"}, "stiffness is 'hard'"), ({"stiffness": CF((1, 2))}, "stiffness has 2 components"),
    ({"stiffness": 1, "exponent": 0}, "exponent is 0"), ({"stiffness": 1, "exponent": -2}, "exponent is -2")])
def test_bad_compliance_is_refused(arguments, culprit):
    with pytest.raises(ProblemError, match=culprit):
        NormalCompliance(**arguments)


@pytest.mark.parametrize("build, culprit", [
    (lambda: CoulombFriction(-0.1), "coefficient is -0.1"), (lambda: TrescaFriction(float("inf")), "bound is inf"),
    (lambda: PowerFriction(stiffness=-2), "stiffness is -2"),
    (lambda: Foundation(3, NormalCompliance(1)), "foundation region is 3"),
    (lambda: Foundation("top(", NormalCompliance(1)), r"foundation region is 'top\('"),
    (lambda: Foundation("b", 450), "compliance is 450"), (lambda: Foundation("b", Incomplete()), "PressureDerivative"),
    (lambda: Foundation("b", NormalCompliance(1), friction=0.3), "friction is 0.3"),
    (lambda: NormalCompliance(CF(1j)), "stiffness is complex"),
    (lambda: Foundation("b", NormalCompliance(1), gap=CF(1j)), "gap is complex"),
    (lambda: Foundation("b", NormalCompliance(1), gap=CF((0, 1))), "gap has 2 components"),
    (lambda: Foundation("b", Adhesive()), r"zero at penetration -1"),
    (lambda: Foundation("b", NormalCompliance(1), friction=Negative()), "friction bound is negative"),
    (lambda: HookeMaterial(E=-1, nu=0.3), "E is -1"), (lambda: HookeMaterial(E=1, nu=0.5), "nu is 0.5"),
    (lambda: HookeMaterial(E=1, nu=-1), "nu is -1"), (lambda: HookeMaterial(E=1), "give E and nu"),
    (lambda: HookeMaterial(E=1, nu=0.3, mu=1), "give E and nu"), (lambda: HookeMaterial(mu=0, lam=1), "mu is 0"),
    (lambda: HookeMaterial(mu=1, lam=-1), r"3\*lam \+ 2\*mu"),
    (lambda: HookeMaterial(E=1, nu=0.3, plane="both"), "plane='both'"),
    (lambda: AnisotropicMaterial([[1, 0], [0, 1]]), "3 x 3"), (lambda: AnisotropicMaterial(5), "3 x 3"),
    (lambda: AnisotropicMaterial([[1, 2, 0], [0, 1, 0], [0, 0, 1]]), "not symmetric"),
    (lambda: AnisotropicMaterial([[1, 2, 0], [2, 1, 0], [0, 0, 1]]), "not positive definite")])
def test_bad_data_are_refused_by_name(build, culprit):
    with pytest.raises(ProblemError, match=culprit):
        build()
