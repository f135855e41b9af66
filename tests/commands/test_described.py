"""A solution as JSON, and all objects in words: what is printed says what it is."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from ngsolve import CF, IfPos, Parameter, exp, sin, specialcf, sqrt, x, y

from ngdgc import (LDG, AnisotropicMaterial, Conforming, ContactProblem, ContactSolution, CoulombFriction, Foundation,
                   HookeMaterial, InteriorPenalty, NestedNewtonSolver, NormalCompliance, PowerFriction, SemismoothNewtonSolver,
                   SlipWeakeningFriction, TrescaFriction, UzawaSolver)
from ngdgc.cases import example_4_2
from ngdgc.export import Scene
from ngdgc.tools.formula import Formula
from ngdgc.meshes import RectangleMesh
from ngdgc.solution.report import SCHEMA, JsonValue


@pytest.fixture(scope="module")
def solution():
    return example_4_2.Main(n=2)


def test_json_returns_as_it_went(solution):
    """Types, nesting and every digit; `JsonValue` is needed, numpy's numbers would be refused or written as NaN."""
    numbers = solution.ToJSON()
    assert json.loads(json.dumps(numbers, allow_nan=False)) == numbers
    assert numbers["elastic_energy"] == solution.energy and numbers["iterations"] == len(solution.history)
    assert numbers["levels"][-1]["dofs"] == solution.disc.space.ndof
    bare = {"a": np.int64(3), "b": (np.bool_(True), np.float64("nan")), "c": [float("inf"), 0.5]}
    with pytest.raises(TypeError):
        json.dumps(bare)
    assert json.loads(json.dumps(JsonValue(bare), allow_nan=False)) == {"a": 3, "b": [True, None], "c": [None, 0.5]}


def test_a_solution_that_blew_up_is_still_json(solution):
    """As a diverged iteration leaves it: every number that depends on u is None, the rest stays."""
    lost = ContactSolution(solution.disc, np.full_like(solution.vector, np.nan), solution.traction, converged=False)
    with np.errstate(all="ignore"):
        numbers = lost.ToJSON()
    assert json.loads(json.dumps(numbers, allow_nan=False)) == numbers
    assert numbers["elastic_energy"] is None and numbers["slip"] == {"smallest": None, "largest": None}
    assert numbers["normal_force"] == solution.normalforce and not np.isfinite(lost.energy)


def test_the_schema_says_what_json_holds(solution):
    """Every key and no other; only H1 has no balance of elements."""
    assert list(sorted(solution.ToJSON())) == sorted(SCHEMA)
    conforming = example_4_2.Main(n=2, method=Conforming()).ToJSON()
    assert set(SCHEMA) - set(conforming) == {"element_imbalance"}
    never = ContactSolution(solution.disc, solution.vector, solution.traction).ToJSON()
    assert set(never) == set(SCHEMA)
    for key, meaning in SCHEMA.items():
        assert meaning and (never[key] is not None or "null" in meaning), key


@pytest.mark.parametrize("function, text", [
    (100 * (1 + x), "100*(x + 1)"), (CF((200 * (5 - y), -190)), "(200*(5 - y), -190)"), (CF((0, -1)), "(0, -1)"),
    (sin(x) * 2 - y / 4, "2*sin(x) - 0.25*y"), (x - (y - 1), "x - (y - 1)"), (x - y - 1, "x - y - 1"), (x / (y * x), "x/(y*x)"),
    (-x, "-x"), (-(x + y), "-(x + y)"), (IfPos(x - 1, 1, 2), "IfPos(x - 1, 1, 2)"), (CF(3), "3"),
    (Parameter(2), "Parameter(2)"), (sqrt(x * x + y * y), "sqrt(x*x + y*y)"),
    (x * (y * 2), "x*2*y"), (CF((x, y)) * 2, "2*(x, y)"),
    (specialcf.normal(2), "CF(dim=2)"), (specialcf.mesh_size, "CF(...)"), (x**40, "CF(...)"),
    (CF((0, 0)), "(0, 0)"), (CF(0), "0")])
def test_coefficients_read_as_they_are_written(function, text):
    """What is no short formula is not made to look like one."""
    assert Formula(function) == text


def test_formulas_mean_what_they_say():
    """The text, read by Python, has the values of the function: also parentheses of - and /."""
    mesh = RectangleMesh(1)
    names = {"x": 0.3, "y": 0.6, "sin": np.sin, "exp": np.exp}
    for function in (x - (y - x), x / (y / x), (x - y) * (x + y), 2 - 3 * (x - 1), exp(-x) / (1 + y), -(x - y) * sin(y - x)):
        assert eval(Formula(function), names) == pytest.approx(function(mesh(0.3, 0.6)), rel=1e-12)
    assert eval("x - y - x", names) != pytest.approx((x - (y - x))(mesh(0.3, 0.6)))


def test_every_object_says_what_it_is(solution):
    """One line each, without addresses of objects; what is given in numbers can be written back."""
    foundation = Foundation("bottom", NormalCompliance(100 * (1 + x)), friction=CoulombFriction(0.4), gap=0.1 * x)
    assert repr(foundation) == ("Foundation(boundary='bottom', compliance=NormalCompliance(stiffness=100*(x + 1), exponent=1), "
                                "friction=CoulombFriction(coefficient=0.4), gap=0.1*x)")
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, dirichlet={"top": (0, -0.1)}, bodyforce=(0, -1))
    assert repr(problem) == (f"ContactProblem(material=HookeMaterial(E=1000, nu=0.3, plane='strain'), "
                             f"foundation=({foundation!r},), " "dirichlet={'top': (0, -0.1)}, bodyforce=(0, -1))")
    assert repr(replace(problem, axisymmetric=True)) == f"{repr(problem)[:-1]}, axisymmetric=True)"
    written = [HookeMaterial(mu=1, lam=2), HookeMaterial(E=5, nu=0.25, plane="stress"), PowerFriction(2, 0.5),
               TrescaFriction(1),
               AnisotropicMaterial([[3, 1, 0], [1, 3, 0], [0, 0, 1]]), NormalCompliance(3, 0.5), CoulombFriction(0.3),
               SlipWeakeningFriction(static=0.5, dynamic=0.3, distance=0.01), InteriorPenalty(penalty=30), LDG(form="lifting"),
               Conforming(), UzawaSolver(tol=1e-6), NestedNewtonSolver(), SemismoothNewtonSolver(maxiter=9)]
    for value in written:
        assert eval(repr(value)) == value
    for value in (*written, problem, solution, solution.disc, solution.history[0], solution.levels[0], solution.rates,
                  solution.disc.contact.parts[0].compliance, Scene(solution)):
        assert not re.search(r"object at|np\.|mappingproxy|\n", repr(value)), repr(value)
    assert re.search("object at", repr(x))
