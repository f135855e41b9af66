"""Rigid punches: foundations that a force and a moment press, or that are moved."""

import json

import numpy as np
import pytest
from checks import Interpolate
from ngsolve import CF, x, y, z
from problems import TEN, Solved

from ngdgc import (LDG, Conforming, ContactProblem, ContactSolution, CoulombFriction, Discretization, Foundation, HookeMaterial,
                   NormalCompliance, ProblemError, RigidPunch, Solve, UzawaSolver)
from ngdgc.cases import tilted_punch
from ngdgc.linear import choice
from ngdgc.mesh.facets import RigidMotionsAt
from ngdgc.meshes import BoxMesh, RectangleMesh

MATERIAL = HookeMaterial(E=1000, nu=0.3)
STIFFNESS, GAP = 500.0, 0.02


def Driven(names, values, moves):
    """{name: entries} of forces and moments where `moves`, of displacements and rotations elsewhere; a number in 2D."""
    given = {}
    for name, part, wanted in names:
        entries = [float(values[wanted][i]) if moves[i] == wanted else None for i in part]
        if entries.count(None) < len(entries):
            given[name] = entries[0] if len(entries) == 1 else entries
    return given


def Patch(dim, moves):
    """(problem, u, motion): a block with one stress, whose top, turned with all of it, moves like a rigid body and sticks.

    u = S x + w x x, S with one column, along the height.  The punch lies p/k + g deeper than the top, turned as that is.
    moves : (modes,), True where a force or moment is given, False where the motion is
    """
    n, about = np.eye(dim)[-1], np.array([0.3, 0.4, 0.9])[[0, *range(1, dim)][-dim:]]
    slope = np.outer([0.002, -0.001, -0.01][3 - dim:], n)
    turn = np.array([[0, -3, 2], [3, 0, -1], [-2, 1, 0]])[:dim, :dim] * 1e-3
    strain = (slope + slope.T) / 2
    t = -(MATERIAL.lam * np.trace(strain) * np.eye(dim) + 2 * MATERIAL.mu * strain) @ n
    rotation = [turn[1, 0]] if dim == 2 else [turn[2, 1], turn[0, 2], turn[1, 0]]
    motion = np.array([*(slope @ n - (t @ n / STIFFNESS + GAP) * n + turn @ about), *rotation])
    middle = np.array([0.5] * (dim - 1) + [1.0]) - about
    forces = np.array([-mode[0] @ t for mode in RigidMotionsAt(middle[None])])
    modes = range(dim), range(dim, len(motion))
    punch = RigidPunch(**Driven([("force", modes[0], True), ("moment", modes[1], True), ("displacement", modes[0], False),
                                 ("rotation", modes[1], False)], {True: forces, False: motion}, moves), about=tuple(about))
    u = CF(tuple(sum(float(a) * c for a, c in zip(row, (x, y, z))) for row in slope + turn))
    top = Foundation("top", NormalCompliance(STIFFNESS), friction=CoulombFriction(1.0), gap=GAP, punch=punch)
    return ContactProblem(MATERIAL, top, dirichlet={"bottom|left|right" + "|front|back" * (dim - 2): u}), u, motion


ALL2, ALL3 = [True] * 3, [True] * 6
PATCHES = [*((2, method, ALL2) for method in (*TEN[:8], Conforming())), (2, LDG(), [False, True, False]),
           (2, LDG(), [True, False, True]), (3, LDG(), ALL3), (3, Conforming(), ALL3), (3, LDG(), [False] * 5 + [True])]


@pytest.mark.parametrize("dim, method, moves", PATCHES, ids=lambda value: str(value).replace("True", "1"))
def test_affine_patch(dim, method, moves):
    """Round-off only: the stress is constant.  The motion is far from 0 in every component, the wrong sign of one is seen."""
    problem, u, motion = Patch(dim, np.array(moves))
    solution = Solved(problem, method, (RectangleMesh(2, cells="quad") if dim == 2 else BoxMesh(1)), order=1)
    assert np.abs(solution.vector - Interpolate(solution.disc, u)).max() < 1e-11
    assert np.abs(solution.punches["top"] - motion).max() < 1e-11 < 1e-4 < np.abs(motion).min()
    assert set(solution.zones) == {1} and solution.GlobalImbalance() < 1e-11 and solution.EquilibriumResidual() < 1e-11
    assert np.abs(solution.slip).max() < 1e-11


@pytest.mark.parametrize("dim", [2, 3])
def test_an_eccentric_load_on_a_soft_foundation_tilts_a_punch_by_a_formula(dim):
    """A flat punch on Winkler's springs k, side 1: down by P/k, tilted by 12 P e/k about the middle, while e < 1/6.

    The body gives way by k L/E = 1e-9 of that; a solver's tolerance is 1e-11.  Beyond 1/6 the edge lifts, and the formula, here
    as control, is wrong: the part 3 (1/2 - e) is in contact.
    """
    k, P = 1e-6, 1e-9
    mesh, middle = (RectangleMesh(8), (0.5, 1.0)) if dim == 2 else (BoxMesh(2), (0.5, 0.5, 1.0))

    def Pressed(e):
        force = (*(None,) * (dim - 1), -P)
        moment = -P * e if dim == 2 else (-P * 0.05, P * e, None)
        punch = RigidPunch(force=force, moment=moment, about=middle)
        held = {"bottom": (0,) * dim}
        return Solved(ContactProblem(MATERIAL, Foundation("top", NormalCompliance(k), punch=punch), dirichlet=held), LDG(),
                      mesh, order=1)

    found = Pressed(0.1).punches["top"]
    expected = [0, -P / k, -1.2 * P / k] if dim == 2 else [0, 0, -P / k, -0.6 * P / k, 1.2 * P / k, 0]
    assert np.abs(found - expected).max() < 1e-8 * P / k
    lifted = Pressed(0.35)
    assert 0.3 < lifted.ZoneLengths()["separation"] < 0.7
    assert abs(lifted.punches["top"][-1 if dim == 2 else -2]) > 1.2 * 12 * 0.35 * P / k


LOADS = {"pressed": ((None, -5.0), None), "sheared": ((0.8, -5.0), None), "turned": ((0.8, -5.0), 0.3)}


def Rubbed(punch, mesh):
    """The arguments of `Solved` for a block under a slightly rounded punch."""
    foundation = Foundation("top", NormalCompliance(2e4), friction=CoulombFriction(0.4), gap=0.01 * (x - 0.5) ** 2, punch=punch)
    return ContactProblem(MATERIAL, foundation, dirichlet={"bottom": (0, 0)}), LDG(), mesh, 1


@pytest.mark.parametrize("name", LOADS)
def test_what_a_force_does_a_displacement_undoes(name):
    """The motion that forces have led to, prescribed, gives these forces, with partial slip; two runs of tolerance 1e-11."""
    force, moment = LOADS[name]
    mesh, about = RectangleMesh(4), (0.6, 1.1)
    by = Solved(*Rubbed(RigidPunch(force=force, moment=moment, about=about), mesh))
    a, b, w = (float(entry) for entry in by.punches["top"])
    to = Solved(*Rubbed(RigidPunch(displacement=(a, b), rotation=w, about=about), mesh))
    assert {1, 2} <= set(by.zones)
    force = -np.einsum("mnd,nd,n->m", RigidMotionsAt(to.points - np.array(about)), to.traction, to.weights)
    for found, given in zip(force, by.disc.problem.foundation[0].punch.Loads()):
        assert given is None or abs(found - given) < 1e-9 * 5
    assert np.abs(by.traction - to.traction).max() < 1e-9 * np.abs(by.traction).max()
    assert by.punches["top"].tolist() == pytest.approx(to.punches["top"].tolist(), abs=1e-15)
    # Control: a hundredth less far is another force.
    less = Solved(*Rubbed(RigidPunch(displacement=(a, 0.99 * b), rotation=w, about=about), mesh))
    assert abs(less.normalforce - 5) > 1e-3


def test_a_moved_punch_is_a_body_that_is_moved_the_other_way():
    """Galilei: punch moved by (a, b), or the bottom by (-a, -b); what is left are the tolerances of two runs."""
    moved = Solved(*Rubbed(RigidPunch(displacement=(0.004, -0.006)), RectangleMesh(4)))
    problem, *rest = Rubbed(None, RectangleMesh(4))
    problem = ContactProblem(problem.material, problem.foundation, dirichlet={"bottom": (-0.004, 0.006)})
    other = Solved(problem, *rest)
    assert np.abs(moved.traction - other.traction).max() < 1e-9 * np.abs(other.traction).max()
    assert np.abs(moved.slip - other.slip).max() < 1e-12 < 1e-4 < np.abs(moved.displacement - other.displacement).max()


def test_two_punches_and_nothing_else_but_springs_of_contact():
    """A block between a foundation and a punch: what presses the punch presses the foundation, and the block's own weight."""
    lower = Foundation("bottom", NormalCompliance(1e4), friction=CoulombFriction(0.3))
    upper = Foundation("top", NormalCompliance(1e4), friction=CoulombFriction(0.3), punch=RigidPunch(force=(0.2, -5)))
    solution = Solved(ContactProblem(MATERIAL, [lower, upper], bodyforce=(0, -1)), LDG(), RectangleMesh(4), order=1)
    assert np.abs(solution.Force("bottom") - [-0.2, 6]).max() < 1e-9
    assert solution.GlobalImbalance() < 1e-11


def test_a_punch_that_nothing_presses_stays_where_it_is():
    """Also where the round-off of a gap is all that there is."""
    solution = Solved(*Rubbed(RigidPunch(force=(None, 0)), RectangleMesh(4)))
    assert np.abs(solution.punches["top"]).max() < 1e-15 and not solution.pressure.any()


def test_the_case_of_a_tilted_punch():
    """Within the part (a/L)^2 = .25 % of a half-plane that its body is not, and 5 elements; the edge lifts beyond e = a/2."""
    solution = tilted_punch.Main(n=8)
    for _, found, expected in tilted_punch.Compare(solution):
        assert found == pytest.approx(expected, rel=0.008)
    history = tilted_punch.History(n=4, order=1, count=2)
    tilt, apart = history.punches["punch"][:, 2], [state.ZoneLengths()["separation"] for state in history]
    assert tilt[2] < 2.2 * tilt[1] < 0 and apart[1] == 0 < apart[2]


def test_a_ring_under_a_punch():
    """A cylinder of nu = 0: the punch is pressed by F = p pi R^2 of the whole ring, and lies p/E + p/k deep."""
    punch = RigidPunch(force=(None, -20 * np.pi))
    top = Foundation("top", NormalCompliance(STIFFNESS), punch=punch)
    problem = ContactProblem(HookeMaterial(E=1000, nu=0), top, dirichlet={"bottom": (0, 0)}, axisymmetric=True)
    solution = Solved(problem, LDG(), RectangleMesh(2), order=1)
    assert solution.punches["top"] == pytest.approx([0, -20 / 1000 - 20 / STIFFNESS, 0], abs=1e-12)


def test_a_punch_takes_few_more_applications():
    """Of the inverse: less than three times those of the same problem with the displacement prescribed, one run for another."""
    def Applications(punch):
        solution = Solve(Discretization(*Rubbed(punch, RectangleMesh(16))[:3], order=1))
        return sum(level.solves for level in solution.levels), solution.punches["top"]

    pressed, found = Applications(RigidPunch(force=(None, -5)))
    moved, _ = Applications(RigidPunch(displacement=(0, float(found[1]))))
    assert pressed < 3 * moved


def test_kept_in_a_folder_and_told(tmp_path):
    """A solution that was saved has the motion of its punch; the report says it.  Control: another force is another problem."""
    def Problem(force):
        return Rubbed(RigidPunch(force=(0.5, force)), RectangleMesh(2))[0]

    solution = Solved(Problem(-5), LDG(), RectangleMesh(2), order=1)
    solution.Save(tmp_path)
    again = ContactSolution.Load(tmp_path, Problem(-5))
    assert again.punches["top"].tolist() == solution.punches["top"].tolist()
    assert np.abs(again.penetration - solution.penetration).max() < 1e-15
    number = f"{solution.punches['top'][1]:.6g}"
    assert f"Punch top: moved by ({solution.punches['top'][0]:.6g}, {number}), turned by 0" in solution.Report()
    told = json.loads(json.dumps(solution.ToJSON()))["punches"]["top"]
    assert told["displacement"] == solution.punches["top"][:2].tolist() and told["rotation"] == [0]
    with pytest.raises(ProblemError, match="not in balance"):
        ContactSolution.Load(tmp_path, Problem(-4))
    # A solution whose punch has moved is no start that is deeper.
    assert np.abs(Solve(solution.disc).vector - solution.vector).max() < 1e-9 * np.abs(solution.vector).max()


def test_iterations_that_know_no_punches_refuse_them():
    problem, method, mesh, order = Rubbed(RigidPunch(force=(None, -5)), RectangleMesh(2))
    with pytest.raises(ProblemError, match="only contact resists translation of the punch 'top' along y"):
        UzawaSolver().Solve(Discretization(problem, method, mesh, order=order))


@pytest.mark.parametrize(("punch", "kind"), [(RigidPunch(force=(None, None, -1)), "sparsecholesky"),
                                             (RigidPunch(displacement=(None, None, -0.01)), "iterative")])
def test_large_problems_factorise_where_a_force_presses(punch, kind, monkeypatch):
    """The choice "auto": conjugate gradients do not know the motions of punches; one that is moved has none to be found."""
    monkeypatch.setattr(choice, "LARGE", 1.0)
    monkeypatch.setattr(choice, "Direct", lambda dim: "sparsecholesky")
    foundation = Foundation("top", NormalCompliance(STIFFNESS), punch=punch)
    disc = Discretization(ContactProblem(MATERIAL, foundation, dirichlet={"bottom": (0, 0, 0)}), LDG(), BoxMesh(2))
    assert disc.inversekind == kind and Solve(disc).converged
