"""Numbers of a solution: moments in balance, values along lines, where a stress is largest, the table of contact points."""

import csv

import numpy as np
import pytest
from bodies import Layers, Perforated, Tilted
from ngsolve import CF, Norm, x, y
from problems import Loaded, Solved

from ngdgc import (LDG, Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial,
                   NormalCompliance, Solve)
from ngdgc.exact import AffinePatch
from ngdgc.export import WriteCSV
from ngdgc.meshes import BoxMesh, RectangleMesh, UnitMesh
from ngdgc.solution.fields import SpatialStress, VonMises

METHODS = [LDG(), Conforming()]


@pytest.mark.parametrize("mesh", [RectangleMesh(3), BoxMesh(2)], ids=["2D", "3D"])
@pytest.mark.parametrize("method", METHODS, ids=str)
def test_moments_are_those_of_the_resultants_and_balance(method, mesh):
    solution = Solved(Loaded(mesh), method, mesh)
    size = max(np.abs(part.moment).max() for part in solution.Resultants())
    for part in solution.Resultants():
        if part.region is not None:
            assert np.abs(solution.Moment(part.region) - part.moment).max() < 1e-10 * size
    body = next(part for part in solution.Resultants() if part.kind == "bodyforce")
    assert np.abs(solution.Moment(".*") + body.moment).max() < 1e-10 * size
    # About another point it is less by p x F.
    point, force = np.array([0.3, -0.2, 0.7][:mesh.dim]), solution.Force("bottom")
    less = np.cross(*(np.pad(vector, (0, 3 - mesh.dim)) for vector in (point, force)))[-len(body.moment):]
    assert np.abs(solution.Moment("bottom", point=point) - solution.Moment("bottom") + less).max() < 1e-12 * size


@pytest.mark.parametrize("method", METHODS, ids=str)
def test_moments_through_an_interface(method):
    mesh = Layers(2)
    solution = Solved(Loaded(mesh), method, mesh)
    one, other = (solution.Moment("mid", material=name, point=(0.5, 0.4)) for name in ("soft", "hard"))
    assert np.abs(one + other).max() < 1e-10 * np.abs(one).max() and np.abs(one).max() > 1e-3
    # The sign is that of the force on this material: of its own outer side the same as without its name.
    bottom = solution.Moment("bottom")
    assert np.array_equal(solution.Moment("bottom", material="soft"), bottom) and np.abs(bottom).max() > 1e-3
    assert np.abs(solution.Moment(".*", material="hard") - solution.Moment("left|right|top", material="hard")
                  - solution.Moment("mid", material="hard")).max() < 1e-10 * np.abs(bottom).max()


def test_stress_across_the_plane():
    """nu (sxx + syy) in plane strain, 0 in plane stress."""
    nu, foundation = 0.3, Foundation("bottom", NormalCompliance(10))
    for plane, part in (("strain", nu), ("stress", 0.0)):
        problem = ContactProblem(HookeMaterial(E=100, nu=nu, plane=plane), foundation, dirichlet={"top": (0.02, -0.1)})
        line = Solve(Discretization(problem, LDG(), RectangleMesh(2), order=2)).Along((0.1, 0.9), (0.8, 0.2), 5)["stress"]
        assert line[:, 2, 2] == pytest.approx(part * (line[:, 0, 0] + line[:, 1, 1]), rel=1e-10, abs=1e-10)
        assert np.abs(line[:, 0, 0] + line[:, 1, 1]).min() > 1e-3


@pytest.mark.parametrize("cells", ["triangle", "quad", "tet", "hex", "prism"])
def test_a_line_through_an_affine_field(cells):
    mesh = UnitMesh(2, cells)
    exact = AffinePatch("slip", dim=mesh.dim)
    solution = Solved(exact.problem, LDG(), mesh, order=1)
    a, b = (0.1, 0.9, 0.3)[:mesh.dim], (0.8, 0.2, 0.6)[:mesh.dim]
    line = solution.Along(a, b, 7)
    assert np.allclose(line["point"], np.linspace(a, b, 7)) and np.allclose(np.diff(line["distance"]), line["distance"][1])
    for place, displacement in zip(line["point"], line["displacement"]):
        assert np.abs(displacement - exact.displacement(mesh(*place))).max() < 1e-9
    stress = np.array(SpatialStress(solution)(mesh(*a))).reshape(3, 3)
    assert np.abs(line["stress"] - stress).max() < 1e-8 * np.abs(stress).max()
    deviator = stress - np.trace(stress) / 3 * np.eye(3)
    assert np.abs(line["vonmises"] - np.sqrt(1.5 * np.sum(deviator ** 2))).max() < 1e-8 * np.abs(stress).max()


def test_a_line_has_no_values_in_a_hole():
    mesh = Perforated()
    foundation = Foundation("bottom", NormalCompliance(10))
    problem = ContactProblem(HookeMaterial(E=100, nu=0.3), foundation, dirichlet={"top": (0, -0.1)})
    line = Solve(Discretization(problem, LDG(), mesh)).Along((0, 0.5), (1, 0.5), 11)
    hole = np.abs(line["point"][:, 0] - 0.5) < 0.15
    assert np.all(np.isnan(line["vonmises"]) == hole) and np.all(np.isnan(line["displacement"][:, 0]) == hole)


def test_largest_value_and_its_place():
    # Of a quadratic function it lies where it should, at a corner or inside, and a corner's value is that of its element.
    mesh = RectangleMesh(4)
    solution = Solved(Loaded(mesh), LDG(), mesh)
    value, place = solution.Largest(2 - (x - 0.5) ** 2 - (y - 0.25) ** 2)
    assert value == 2 and place.tolist() == [0.5, 0.25]
    value, place = solution.Largest(x + 2 * y)
    assert value == 3 and place.tolist() == [1, 1]
    value, place = solution.Largest()
    assert value >= max(np.asarray(VonMises(SpatialStress(solution))(mesh(*point))) for point in solution.points)
    assert solution.Largest("displacement")[0] == solution.Largest(Norm(solution.gfu))[0]


@pytest.mark.parametrize("cells", ["quad", "tet", "hex", "prism"])
def test_largest_value_on_every_kind_of_element(cells):
    mesh = UnitMesh(2, cells)
    solution = Solved(AffinePatch("stick", dim=mesh.dim).problem, LDG(), mesh, order=1)
    value, place = solution.Largest(sum((number + 1) * axis for number, axis in enumerate((x, y))))
    assert value == pytest.approx(3, abs=1e-14) and np.abs(place[:2] - 1).max() < 1e-14


@pytest.mark.parametrize("method", METHODS, ids=str)
def test_table(method, tmp_path):
    """Every column against the solution; what is written is read back to the last digit."""
    two = [Foundation("bottom", NormalCompliance(100), friction=CoulombFriction(0.3), gap=0.01 * x),
           Foundation("right", NormalCompliance(9))]
    problem = ContactProblem(HookeMaterial(E=200, nu=0.3), two, dirichlet={"top": CF((0.05, -0.1))})
    solution = Solve(Discretization(problem, method, RectangleMesh(3)))
    table = solution.Table()
    assert set(table["region"]) == {"bottom", "right"} and set(table["zone"]) <= {"separation", "stick", "slip"}
    for name in ("gap", "penetration", "pressure"):
        assert np.array_equal(table[name], solution.disc.contact.gap if name == "gap" else getattr(solution, name))
    for axis, letter in enumerate("xy"):
        assert np.array_equal(table[letter], solution.points[:, axis])
        assert np.array_equal(table[f"friction_{letter}"], solution.friction[:, axis])
        assert np.array_equal(table[f"slip_{letter}"], solution.slip[:, axis])
    there = table["region"] == "bottom"
    assert table["weight"][there] @ table["pressure"][there] == pytest.approx(solution.Force("bottom")[1], rel=1e-10)
    path = WriteCSV(solution, tmp_path / "contact")
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    assert path.name == "contact.csv" and list(rows[0]) == list(table.dtype.names)
    assert [float(row["pressure"]) for row in rows] == table["pressure"].tolist()
    assert [row["zone"] for row in rows] == table["zone"].tolist()


def test_moment_on_an_inclined_side():
    # The reaction of a plate that is turned: about a corner of the side, from traction times arm by hand.
    mesh = Tilted(0.3)
    foundation = Foundation("bottom", NormalCompliance(50))
    problem = ContactProblem(HookeMaterial(E=100, nu=0.3), foundation, dirichlet={"top": (0, -0.05)})
    solution = Solved(problem, LDG(), mesh)
    arm, t = solution.points - solution.points[0], solution.traction
    by = -solution.weights @ (arm[:, 0] * t[:, 1] - arm[:, 1] * t[:, 0])
    assert solution.Moment("bottom", point=solution.points[0])[0] == pytest.approx(by, rel=1e-10)
