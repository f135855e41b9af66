"""Laws and expressions that were changed after they were read."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from ngsolve import CF, L2, GridFunction, IfPos, Parameter, VectorH1, x, y

from ngdgc import (LDG, AnisotropicMaterial, ComplianceLaw, ContactProblem, Discretization, Foundation, HookeMaterial,
                   NormalCompliance, ProblemError, Solve)
from ngdgc.meshes import RectangleMesh
from ngdgc.discrete.state import Leaves


@dataclass
class Soft(ComplianceLaw):
    """A law that is not frozen."""

    k: float

    def Pressure(self, r):
        return self.k * np.maximum(r, 0)

    def PressureDerivative(self, r):
        return self.k * (r > 0)


def test_a_law_whose_number_was_changed_is_refused():
    law = Soft(300.0)
    problem = ContactProblem(HookeMaterial(E=2000, nu=0.3), Foundation("bottom", law), dirichlet={"top": (0, -0.1)})
    disc = Discretization(problem, LDG(), RectangleMesh(3))
    assert Solve(disc).converged
    law.k = 100.0
    with pytest.raises(ProblemError, match="k of compliance.*number of a law was changed"):
        Solve(disc)


@dataclass(frozen=True)
class Frozen(ComplianceLaw):
    """A law whose stiffness stands in something that can be changed in place."""

    holder: Any

    @property
    def stiffness(self):
        return (self.holder["k"] if isinstance(self.holder, dict) else self.holder)[0]

    def Pressure(self, r):
        return self.stiffness * np.maximum(r, 0)

    def PressureDerivative(self, r):
        return self.stiffness * (r > 0)


@pytest.mark.parametrize("Make", [lambda: [300.0], lambda: np.array([300.0]), lambda: {"k": [300.0]}],
                         ids=["list", "array", "dictionary"])
def test_what_a_law_holds_may_not_be_changed_in_place_either(Make):
    law = Frozen(Make())
    problem = ContactProblem(HookeMaterial(E=2000, nu=0.3), Foundation("bottom", law), dirichlet={"top": (0, -0.1)})
    disc = Discretization(problem, LDG(), RectangleMesh(3))
    assert Solve(disc).converged
    (law.holder["k"] if isinstance(law.holder, dict) else law.holder)[0] = 100.0
    with pytest.raises(ProblemError, match="holder of compliance.*number of a law was changed"):
        Solve(disc)


def test_leaves_of_expressions():
    """Below conditions, materials, boundaries, compiled functions, derivatives and components; none in constants."""
    mesh = RectangleMesh(2)
    a, field, vector = Parameter(3.0), GridFunction(L2(mesh)), GridFunction(VectorH1(mesh))
    for function in (IfPos(x - a, field, 1), mesh.MaterialCF({mesh.GetMaterials()[0]: a * field}), (a * field).Compile(),
                     mesh.BoundaryCF({"left": a}, default=field), a * vector.components[0], (a * x * field).Diff(x),
                     CF((a, field))):
        assert {type(leaf).__name__ for leaf in Leaves(function)} in ({"Parameter", "GridFunctionD"},
                                                                      {"Parameter", "ComponentGridFunction"})
    assert Leaves(CF((x, y * 2))) == [] and Leaves(3.0) == []


def test_parameters_of_anisotropic_materials():
    stiff = Parameter(1000)
    material = AnisotropicMaterial([[3 * stiff, stiff, 0], [stiff, 3 * stiff, 0], [0, 0, stiff]])
    problem = ContactProblem(material, Foundation("bottom", NormalCompliance(300)), dirichlet={"top": (0, -0.1)})
    disc = Discretization(problem, LDG(), RectangleMesh(3))
    soft = Solve(disc).normalforce
    stiff.Set(4000)
    assert Solve(disc).normalforce > 1.05 * soft
