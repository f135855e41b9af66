"""Numbers are numbers whatever their type, regions are what NGSolve reads, and the orders that are tested are accepted."""

import re
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from ngsolve import CF, Parameter
from problems import Example, Pressed

from ngdgc import (LDG, AnisotropicMaterial, BassiEtAl, BrezziEtAl, Conforming, ContactProblem, CoulombFriction, Discretization,
                   EstimateContraction, Foundation, HookeMaterial, InteriorPenalty, MultiStart, NormalCompliance, PowerFriction,
                   ProblemError, SemismoothNewtonSolver, SlipWeakeningFriction, Solve, TrescaFriction, UzawaSolver)
from ngdgc.errors import L2Error
from ngdgc.exact import AffinePatch
from ngdgc.meshes import BoxMesh, RectangleMesh, UnitMesh
from ngdgc.tools.values import HIGHEST, Integer, IsNumber, Number, PositiveNumber, Reals, Vectors

NUMBERS = [Fraction, Decimal, np.float64, np.float32, np.int64, np.array]


def Block(kind=float, **data):
    """A problem whose numbers are all of one kind."""
    law = Foundation("bottom", NormalCompliance(kind(300), exponent=kind(1)), friction=CoulombFriction(kind(1)), gap=kind(0))
    return ContactProblem(HookeMaterial(E=kind(2000), nu=kind(0)), law, **(data or {"dirichlet": {"top": (kind(1), kind(-1))}}))


@pytest.mark.slow
@pytest.mark.parametrize("kind", NUMBERS)
def test_numbers_of_every_kind_are_numbers(kind):
    mesh = RectangleMesh(np.int64(2), upper=(kind(20), kind(10)))
    expected = Solve(Discretization(Block(), LDG(penalty=30), RectangleMesh(2, upper=(20, 10))))
    found = SemismoothNewtonSolver(tol=np.float32(1e-10)).Solve(Discretization(Block(kind), LDG(penalty=kind(30)), mesh))
    assert found.normalforce == pytest.approx(expected.normalforce, rel=1e-9) and found.normalforce > 100
    assert found.At(kind(10), kind(5)) == pytest.approx(expected.At(10, 5), abs=1e-9)
    loads = Block(kind, roller={"left": kind(0), "right": kind(0)}, traction={"top": np.array([0.0, -3.0])},
                  bodyforce=(kind(0), kind(-1)))
    assert Solve(Discretization(loads, LDG(), mesh)).normalforce == pytest.approx(20 * 3 + 200, rel=1e-9)     # the loads
    for law in (TrescaFriction(kind(2)), PowerFriction(kind(2), kind(1)), SlipWeakeningFriction(kind(2), kind(1), kind(3))):
        assert law.Bound(np.ones(1), np.ones(1))[0] > 0
    AnisotropicMaterial([[kind(3), kind(1), 0], [kind(1), kind(3), 0], [0, 0, kind(1)]])
    UzawaSolver(rho=kind(2), tol=Decimal("1e-8"))


@pytest.mark.parametrize("value", [True, np.True_, "1", 1j, None, [1], np.ones(1), np.ones(2), float("nan"), float("inf"),
                                   10 ** 400, Decimal("sNaN"), CF], ids=lambda value: repr(value)[:9])
def test_what_is_no_number_is_refused_by_name(value):
    calls = [(lambda: NormalCompliance(value), "stiffness"), (lambda: NormalCompliance(1, value), "exponent"),
             (lambda: HookeMaterial(E=value, nu=0.3), "E|HookeMaterial"), (lambda: LDG(penalty=value), "penalty"),
             (lambda: Foundation("bottom", NormalCompliance(1), gap=value), "gap"), (lambda: UzawaSolver(tol=value), "tol"),
             (lambda: UzawaSolver(rho=value), "rho"),
             (lambda: UzawaSolver(maxiter=0 if isinstance(value, int) else value), "maxiter"),
             (lambda: Example(dirichlet={"right": (value, 0)}), "component 1 of .*"), (lambda: RectangleMesh(value), "n"),
             (lambda: Discretization(Example(), LDG(), RectangleMesh(1), order=value), "order"),
             (lambda: LDG(liftorder=-1 if value is None else value), "liftorder")]
    for Call, name in calls:
        with pytest.raises(ProblemError, match=f"^({name}) (is|has|got)"):
            Call()


def test_conversions_keep_what_they_are_given():
    assert Number(30) == 30 and type(Number(30)) is int and type(Number(Fraction(1, 2))) is float
    assert IsNumber(np.array(3)) and not IsNumber(np.ones(1)) and not IsNumber(np.array(True))
    assert repr(LDG(penalty=30)) == "LDG(penalty=30)" and repr(LDG(penalty=np.float64(30))) == "LDG(penalty=30.0)"
    assert type(Integer(np.int8(3), "n", "")) is int and PositiveNumber(0, "x", "", least=0) == 0
    assert Vectors([[Fraction(1, 2), 1]], (1, 2), "x", "").tolist() == [[0.5, 1.0]]
    for wrong in (["1", 0], [[1, 2], [3]], [1j, 0], [True, False], [None, 0], [np.nan, 0], 3, {}):
        with pytest.raises(ProblemError, match="x is"):
            Vectors(wrong, (2,), "x", "")
    parameter = Parameter(3)
    assert NormalCompliance(parameter).stiffness is parameter       # stays one, to be changed


def Named(name):
    mesh = RectangleMesh(2)
    mesh.ngmesh.SetBCName(mesh.GetBoundaries().index("bottom"), name)
    return mesh


@pytest.mark.parametrize("name", ["left(1)", "a+b", "a{1}", "[x]", "a|b", "a.b", "a b-c", "a\\b"])
def test_names_that_are_expressions_need_re_escape(name):
    """Every name can be given as re.escape writes it, and one that does not match itself says so."""
    def Made(region):
        return Discretization(ContactProblem(HookeMaterial(E=1, nu=0), Foundation(region, NormalCompliance(1)),
                                             dirichlet={"top": (0, -1)}), LDG(), Named(name))

    assert len(Made(re.escape(name)).contact.weights) == 4
    if re.fullmatch(name, name):
        assert len(Made(name).contact.weights) == 4
    else:
        with pytest.raises(ProblemError, match=re.escape(repr(re.escape(name)))):
            Made(name)


@pytest.mark.parametrize("region", ["(?i)bottom", "(?<=x)bottom", "(?P<a>bottom)", "(", "*", b"bottom", None, 3,
                                    re.compile("bottom"), "(" * 5000 + ")" * 5000])
def test_regions_that_are_no_expressions_of_ngsolve_are_refused(region):
    for problem in ({"foundation": lambda: Foundation(region, NormalCompliance(1))}, {"traction": lambda: {region: (0, 1)}}):
        with pytest.raises(ProblemError, match="(foundation|traction) region is .*give a name"):
            Discretization(Example(**{kind: Make() for kind, Make in problem.items()}), LDG(), RectangleMesh(2))
    solution = Pressed(Foundation("bottom", NormalCompliance(10)), RectangleMesh(1))
    with pytest.raises(ProblemError, match="boundary region is .*give a name"):
        solution.Force(region)
    assert solution.Force("bott.*|top").shape == (2,)       # control: one that it takes


@pytest.mark.parametrize("cells", ["triangle", "quad", "tet", "hex"])
def test_points_outside_of_the_body_are_refused(cells):
    solution = Pressed(Foundation("bottom", NormalCompliance(10)), UnitMesh(1, cells),
                       (0.03, -0.05) if cells in ("triangle", "quad") else (0.03, 0, -0.05))
    dim = solution.disc.mesh.dim
    for point in ([99] * dim, [1e300] * dim, [-1e-3] + [0.5] * (dim - 1)):
        with pytest.raises(ProblemError, match=r"^point .* lies in no element of the mesh, which extends from \(0.0,"):
            solution.At(*point)
    for point in ([0.5], [0.5] * 4, [], ["a"] * dim, [np.nan] * dim, [None] * dim, [[0.5] * dim]):
        with pytest.raises(ProblemError, match=f"^point is .*give its {dim} coordinates"):
            solution.At(*point)
    assert solution.At(*[0.5] * dim).shape == solution.At(*[1] * dim).shape == (dim,)       # control: points of the body


def test_arguments_of_the_solvers_are_looked_at():
    disc = Discretization(Example(), LDG(), RectangleMesh(1))
    shape = disc.contact.normals.shape
    for start in (3, "ab", (None, None), (np.ones(shape), np.full(shape, np.nan)), np.ones((3, *shape)), [np.ones(shape)]):
        with pytest.raises(ProblemError, match="start is"):
            SemismoothNewtonSolver().Solve(disc, start=start)
    for wrong, name in (({"count": 0}, "count"), ({"count": 2.0}, "count"), ({"seed": -1}, "seed"), ({"tol": 2}, "tol")):
        with pytest.raises(ProblemError, match=f"{name} is"):
            MultiStart(disc, **wrong)
    n = len(disc.contact.weights)
    for wrong, name in (({"penetration": np.ones(n + 1)}, "penetration"), ({"penetration": 3}, "penetration"),
                        ({"step": -1}, "step"), ({"step": "a"}, "step"), ({"maxiter": 0}, "maxiter"), ({"tol": 0}, "tol")):
        with pytest.raises(ProblemError, match=f"{name} is"):
            EstimateContraction(disc, **{"penetration": np.ones(n), **wrong})
    assert EstimateContraction(disc, np.ones(n), step=Fraction(1, 2)).normal > 0       # control: right ones
    assert len(MultiStart(disc, count=np.int64(1))) == 1


@pytest.mark.slow
@pytest.mark.parametrize("method", [InteriorPenalty(), LDG(form="lifting"), BassiEtAl(), BrezziEtAl(form="lifting"),
                                    Conforming()], ids=["ip", "ldg", "bassi", "brezzi", "h1"])
@pytest.mark.parametrize("cells", ["triangle", "quad"])
def test_the_highest_order_is_exact(method, cells):
    """A patch to round-off, which grows with the condition of the basis; and the next order is refused."""
    exact, most = AffinePatch("slip"), HIGHEST[2]
    solution = Solve(Discretization(exact.problem, method, UnitMesh(1, cells), order=most))
    assert L2Error(solution, exact.displacement) < 1e-11
    assert L2Error(solution, 1.001 * exact.displacement) > 1e-5     # control: another displacement
    with pytest.raises(ProblemError, match=f"order is {most + 1}; .* in 2D at most {most}"):
        Discretization(exact.problem, method, UnitMesh(1, cells), order=most + 1)


@pytest.mark.slow
@pytest.mark.parametrize("method, cells", [(InteriorPenalty(), "tet"), (Conforming(), "hex")], ids=["ip", "h1"])
def test_the_highest_order_in_space_is_exact(method, cells):
    exact, most = AffinePatch("slip", dim=3), HIGHEST[3]
    solution = Solve(Discretization(exact.problem, method, BoxMesh(1, cells=cells), order=most))
    assert L2Error(solution, exact.displacement) < 1e-11
    assert L2Error(solution, 1.001 * exact.displacement) > 1e-5
    with pytest.raises(ProblemError, match=f"order is {most + 1}; .* in 3D at most {most}"):
        Discretization(exact.problem, method, BoxMesh(1, cells=cells), order=most + 1)


@pytest.mark.parametrize("kind", NUMBERS)
def test_what_is_kept_of_a_number_is_a_number(kind):
    """Shown as it is, and of its own: an array that is changed later changes no material."""
    given = kind(2)
    material = HookeMaterial(E=given, nu=kind(0))
    assert repr(material) == "HookeMaterial(E=2.0, nu=0.0, plane='strain')" and type(material.E) is type(material.nu) is float
    if kind is np.array:
        given[()] = 5
        assert material.E == 2 and material.mu == 1
    assert repr(HookeMaterial(E=2, nu=0)) == "HookeMaterial(E=2, nu=0, plane='strain')"      # control: Python's stay


def test_truth_values_are_no_coordinates():
    """Among numbers numpy takes them for 1 and 0."""
    for corner in ((True, 2), [1.5, np.True_], (1, "2")):
        with pytest.raises(ProblemError, match="upper is .*give two corners"):
            RectangleMesh(1, upper=corner)
        assert Reals(corner, (2,)) is None
    assert np.array_equal(Reals((np.array(1), Fraction(1, 2)), (2,)), [1, 0.5])      # control
    assert np.array_equal(Reals([[1, 2], np.arange(2)], (2, 2)), [[1, 2], [0, 1]]) and Reals([[1, 2], [3]], (2, 2)) is None
