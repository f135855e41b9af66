"""Joints: the jump obeys the law, parts and elements balance, free motions are named, and what is saved knows them."""

from unittest.mock import patch

import numpy as np
import pytest
from bodies import LINE, RING, Crossed, Layers, Stacked
from jointed import BODIES, MID, MODULI, NU, Balanced, Confined, K, Material, P, Patch, Shear, Sheet, Walls
from ngsolve import CF, GridFunction, Parameter, specialcf, x, y, z
from problems import TEN

from ngdgc import (LDG, BassiEtAl, Conforming, ContactProblem, ContactSolution, CoulombFriction, Discretization, Foundation,
                   HookeMaterial, IncompleteInteriorPenalty, InteriorPenalty, Joint, NonsymmetricInteriorPenalty,
                   NormalCompliance, ProblemError, SemismoothNewtonSolver, Solve, TrescaFriction, UzawaSolver)
from ngdgc.contact.graph import ZONES
from ngdgc.linear.multigrid import StrongNeighbours
from ngdgc.mesh.facets import Csr, Facets, Free
from ngdgc.theory.lemmas import NormMatrix

ALL = [*TEN, NonsymmetricInteriorPenalty(), IncompleteInteriorPenalty(), Conforming()]
FAST = [InteriorPenalty(), LDG(form="lifting"), Conforming()]
# In space the order is tried with three methods: what depends on it is the same in the plane.
EVERY = pytest.mark.parametrize("method, dim, order", [
    pytest.param(method, dim, order, marks=() if method in FAST else pytest.mark.slow, id=f"{method}-{dim}-{order}")
    for method in ALL for dim, order in ((2, 1), (2, 2), (2, 3), (3, 1), (3, 2), (3, 3))
    if dim == 2 or order == 1 or method in FAST])
METHODS = pytest.mark.parametrize("method", [method if method in FAST else pytest.param(method, marks=pytest.mark.slow)
                                             for method in ALL], ids=repr)


@EVERY
def test_jump_is_pressure_over_stiffness(method, dim, order):
    """A column under the pressure P between smooth walls: [u].n = P/k, to some hundred units of round-off of |u|/|[u]| = 10."""
    mesh = BODIES[dim]
    problem = ContactProblem(Material(mesh), Joint("mid", NormalCompliance(K), friction=CoulombFriction(0.3)),
                             dirichlet={"bottom": (0,) * dim}, roller={Walls(dim): 0},
                             traction={"top": (*(0,) * (dim - 1), -P)})
    solution = SemismoothNewtonSolver(tol=1e-14).Solve(Discretization(problem, method, mesh, order=order))
    assert np.abs(solution.penetration * K / P - 1).max() < 1e-11
    assert np.abs(solution.slip).max() < 1e-11 * P / K
    assert np.abs(solution.pressure / P - 1).max() < 1e-11
    assert Balanced(solution)
    depth = P / K + P * MID / Confined(MODULI["soft"]) + P * (1 - MID) / Confined(MODULI["hard"])
    assert solution.Mean("top")[-1] == pytest.approx(-depth, rel=1e-11)


@EVERY
def test_shear_patch(method, dim, order):
    """Affine in each part: friction is tau below the bound, with no slip, and .3 P at it, with the slip that is left."""
    tau, slip, mesh = Parameter(0), Parameter(0), BODIES[dim]
    problem, u = Patch(dim, tau, slip)
    disc = Discretization(problem, method, mesh, order=order)
    states = (8.0, 0.0), (12.0, 0.01), (-12.0, -0.01)
    for friction, way in states if method in FAST else states[:2]:
        tau.Set(friction)
        slip.Set(way)
        # Friction of points that stick is their slip times some 1000 P: to 1e-11 it needs 14 digits of the slip.
        solution = SemismoothNewtonSolver(tol=1e-13 if way else 1e-14).Solve(disc)
        assert np.abs(solution.penetration * K / P - 1).max() < 1e-11
        # The first side is below: [u]_t = -slip, and the upper part drags it along.
        assert np.abs(solution.slip - [-way, *(0,) * (dim - 1)]).max() < 1e-13
        assert np.abs(solution.friction - [friction, *(0,) * (dim - 1)]).max() < 1e-11 * P
        assert {ZONES[zone] for zone in solution.zones} == {"slip" if way else "stick"}
        assert Balanced(solution)
        assert solution.At(*(0.7,) * dim) == pytest.approx(u(mesh(*(0.7,) * dim)), abs=1e-12)


def test_jump_needs_facets_that_are_left_out():
    """Negative control: with the joint in E0 the penalty holds both sides together, and they jump by less."""
    problem, _ = Patch(2, 8.0, 0.0)
    with patch.object(Facets, "cut", property(lambda self: np.zeros(len(self.neighbours), dtype=bool))):
        solution = SemismoothNewtonSolver().Solve(Discretization(problem, LDG(), BODIES[2]))
    assert np.abs(solution.penetration * K / P - 1).max() > 0.1


def test_forces_act_on_the_first_side_and_balance():
    """The lower part comes first: what lies on it presses it down and drags it along, and is pressed up and held back."""
    problem, _ = Patch(2, 8.0, 0.0)
    solution = Solve(Discretization(problem, BassiEtAl(), BODIES[2], order=2))
    joint = next(resultant for resultant in solution.Resultants() if resultant.kind == "joint")
    below, above = (solution.Force("mid", material=name) for name in MODULI)
    assert (joint.region, joint.force.tolist()) == ("mid", pytest.approx([8, -P]))
    assert below == pytest.approx(joint.force) and above == pytest.approx(-joint.force)
    assert solution.Force("mid") == pytest.approx(below)
    # About the origin: int x (-P) - y 8.
    assert joint.moment == pytest.approx([-P / 2 - MID * 8])
    assert solution.disc.contact.normals == pytest.approx(np.tile([0, 1], (len(solution.weights), 1)))
    assert "joint mid" in solution.Report().split("sum ")[1]
    table = solution.Table()
    assert set(table["region"]) == {"mid"} and table["pressure"] == pytest.approx(P)


@METHODS
@pytest.mark.parametrize("mesh, order", [(Sheet(path=LINE[1:5]), 1), (Sheet(31, LINE[2:]), 3), (Sheet(17), 2),
                                          (Stacked(lambda middle: middle[0] > 0.5), 2)],
                         ids=["inside", "half", "whole", "solid"])
def test_joint_that_starts_pressed_leaves_an_affine_body_as_it_is(method, mesh, order):
    """With the gap -P/k the joint has the pressure P at no jump, and sticks: wherever it ends, u is affine and t = -sigma n."""
    dim, tau = mesh.dim, 8.0
    material = HookeMaterial(E=1000, nu=NU)
    stress = np.diag([-10.0] * (dim - 1) + [-P])
    stress[0, -1] = stress[-1, 0] = tau
    strain = ((1 + NU) * stress - NU * np.trace(stress) * np.eye(dim)) / 1000
    if dim == 2:        # plane strain
        strain = (1 + NU) / 1000 * (stress - NU * np.trace(stress) * np.eye(2))
    u = CF(tuple(sum(float(e) * c for e, c in zip(row, (x, y, z))) for row in strain))
    joint = Joint("mid", NormalCompliance(K), friction=CoulombFriction(0.3), gap=-P / K)
    rest = "right" if dim == 2 else "right|front|back"
    traction = CF(tuple(stress.ravel()), dims=(dim, dim)) * specialcf.normal(dim)
    problem = ContactProblem(material, joint, dirichlet={"top": u, "bottom": u, "left": u}, traction={rest: traction})
    solution = SemismoothNewtonSolver(tol=1e-14).Solve(Discretization(problem, method, mesh, order=order))
    assert np.abs(solution.displacement).max() < 1e-13
    assert np.abs(solution.pressure / P - 1).max() < 1e-11
    # Where it meets Gamma_D both sides of continuous functions are held, and feel no friction.
    disc = solution.disc
    felt = np.diff(disc.contact.trace[:, Free(disc.space)].tocsr().indptr)[::dim] > 0
    wanted = solution.normals[:, -1:] * np.eye(dim)[0] * tau
    assert np.abs(solution.friction - wanted)[felt].max() < 1e-11 * P
    assert Balanced(solution, parts=())
    assert solution.At(*(0.7,) * dim) == pytest.approx(u(mesh(*(0.7,) * dim)), abs=1e-13)


@pytest.mark.parametrize("turn", [0, 17, 31, 58])
def test_one_side_is_the_first_all_along(turn):
    """Between parts of one material the normal does not turn, whatever the numbers of the elements, and forces add up."""
    mesh = Sheet(turn)
    problem = ContactProblem(HookeMaterial(E=1000, nu=NU), Joint("mid", NormalCompliance(K), friction=CoulombFriction(0.4)),
                             dirichlet={"bottom": (0, 0)}, traction={"top": (5 * x, -P)})
    solution = SemismoothNewtonSolver(tol=1e-13).Solve(Discretization(problem, InteriorPenalty(), mesh, order=2))
    side = solution.normals[0, 1]
    assert np.abs(solution.normals - [0, side]).max() < 1e-12
    joint = next(resultant for resultant in solution.Resultants() if resultant.kind == "joint")
    assert joint.force == pytest.approx([side * 2.5, -side * P], abs=1e-10 * P)
    assert Balanced(solution, parts=())


@pytest.mark.parametrize("friction", [None, TrescaFriction(0)], ids=["none", "vanishing"])
def test_part_that_nothing_holds_is_named(friction):
    joint = Joint("mid", NormalCompliance(K), friction=friction)
    data = {"dirichlet": {"bottom": (0, 0)}, "traction": {"top": (0, -P)}}
    disc = Discretization(ContactProblem(Material(BODIES[2]), joint, **data), LDG(), BODIES[2])
    with pytest.raises(ProblemError, match="nothing resists translation along x in part 2 of the mesh"):
        Solve(disc)
    # A roller beside it, or friction, holds it.
    assert Solve(Discretization(ContactProblem(Material(BODIES[2]), joint, roller={"left": 0}, **data), LDG(), BODIES[2]))
    rough = Joint("mid", NormalCompliance(K), friction=CoulombFriction(0.1))
    assert Solve(Discretization(ContactProblem(Material(BODIES[2]), rough, **data), LDG(), BODIES[2])).converged


def test_two_parts_that_move_together_are_free():
    """A joint holds its parts against each other, not against the world."""
    joint = Joint("mid", NormalCompliance(K), friction=CoulombFriction(0.1))
    disc = Discretization(ContactProblem(Material(BODIES[2]), joint, traction={"top": (0, -P), "bottom": (0, P)}), LDG(),
                          BODIES[2])
    with pytest.raises(ProblemError, match="the body floats: nothing resists .*translation along x"):
        Solve(disc)


def test_joint_and_foundation_in_one_body():
    """A column on a foundation of the same stiffness: both have the penetration P/k, and both methods of solution agree."""
    mesh = BODIES[2]
    laws = {"compliance": NormalCompliance(K), "friction": CoulombFriction(0.3)}
    problem = ContactProblem(Material(mesh), [Joint("mid", **laws), Foundation("bottom", **laws)], roller={"left|right": 0},
                             dirichlet={"top": (0, -0.05)})
    disc = Discretization(problem, LDG(), mesh, order=2)
    solution = SemismoothNewtonSolver(tol=1e-13).Solve(disc)
    assert np.ptp(solution.penetration) < 1e-11 * solution.penetration[0]
    assert [resultant.kind for resultant in solution.Resultants()][-2:] == ["joint", "foundation"]
    springs = ContactProblem(Material(mesh), Joint("mid", NormalCompliance(40), friction=CoulombFriction(0.3)),
                             dirichlet={"top": (0, -0.05), "bottom": (0, 0)})
    disc = Discretization(springs, LDG(), mesh, order=2)
    first, second = UzawaSolver(tol=1e-12).Solve(disc), SemismoothNewtonSolver(tol=1e-12).Solve(disc)
    assert first.traction == pytest.approx(second.traction, abs=1e-8)


def test_iterative_inverse_lets_parts_come_apart():
    """The levels of multigrid are continuous across strong facets, not across joints: and the solution is the same."""
    problem, _ = Patch(3, 8.0, 0.0)
    direct, iterative = (Solve(Discretization(problem, LDG(), BODIES[3], inverse=name))
                         for name in ("sparsecholesky", "iterative"))
    assert iterative.vector == pytest.approx(direct.vector, abs=1e-8 * np.abs(direct.vector).max())
    joined, cut = Facets(BODIES[3]), Facets(BODIES[3], ["mid"])
    assert len(StrongNeighbours(joined)[0]) - len(StrongNeighbours(cut)[0]) == cut.cut.sum() == 2


def test_saved_solution_knows_its_joints(tmp_path):
    problem, _ = Patch(2, 8.0, 0.0)
    solution = Solve(Discretization(problem, LDG(), BODIES[2]))
    solution.Save(tmp_path / "saved")
    loaded = ContactSolution.Load(tmp_path / "saved", problem)
    assert loaded.traction.tolist() == solution.traction.tolist() and loaded.disc.problem.joints == ["mid"]
    other, _ = Patch(2, 8.0, 0.0, coefficient=0.2)
    elsewhere = ContactProblem(problem.material, Foundation("left", NormalCompliance(K)), dirichlet=dict(problem.dirichlet))
    for wrong in (other, elsewhere):
        with pytest.raises(ProblemError):
            ContactSolution.Load(tmp_path / "saved", wrong)


@pytest.mark.parametrize("method", [LDG(), Conforming()], ids=repr)
@pytest.mark.parametrize("paths", [{"mid": [LINE, [(3, i) for i in range(7)]]}, {"mid": [RING]},
                                   {"mid": [LINE], "up": [[(3, i) for i in range(4)]]}], ids=["cross", "ring", "tee"])
def test_joints_that_cross_branch_or_close(method, paths):
    """Also by way of order 1, whose points all lie in one place at a crossing; every part is in balance."""
    mesh = Crossed(paths)
    joints = [Joint(name, NormalCompliance(K), friction=CoulombFriction(0.3)) for name in paths]
    problem = ContactProblem(HookeMaterial(E=1000, nu=NU), joints, dirichlet={"bottom": (0, 0), "top": (0.01, -0.03)})
    solution = Solve(Discretization(problem, method, mesh, order=2), tol=1e-12)
    assert Balanced(solution, parts=())
    assert solution.Force("top") == pytest.approx(-solution.Force("bottom"), abs=1e-10)
    parts = {(2, 1): 4, (1, 2): 3, (1, 1): 2}[len(paths["mid"]), len(paths)]
    assert solution.disc.facets.component.max() + 1 == parts


def test_softer_side_counts():
    """Lengths by which solvers measure the joint are those of the softer material, on whichever side."""
    joint, mesh = Joint("mid", NormalCompliance(K)), Layers(2)
    for moduli in ({"soft": 10, "hard": 1000}, {"soft": 1000, "hard": 10}):
        material = HookeMaterial(E=mesh.MaterialCF(moduli), nu=NU)
        disc = Discretization(ContactProblem(material, joint, roller={"left": 0}), LDG(), mesh)
        assert disc.contact.flexibility == pytest.approx(1 / Shear(10), rel=0.2)


def test_norm_of_the_theory_has_no_jumps_of_joints():
    """What moves a part along the joint costs nothing in |||.|||, which it does without the joint."""
    data = {"dirichlet": {"bottom": (0, 0)}, "roller": {"right": 0}}
    joint = Joint("mid", NormalCompliance(K), friction=CoulombFriction(0.3))
    for foundation, free in ((joint, True), (Foundation("top", NormalCompliance(1)), False)):
        disc = Discretization(ContactProblem(Material(BODIES[2]), foundation, **data), LDG(), BODIES[2])
        up = GridFunction(disc.space)
        up.Set(BODIES[2].MaterialCF({"hard": (0, 1), "soft": (0, 0)}))
        vector = up.vec.FV().NumPy()
        assert (vector @ (Csr(NormMatrix(disc)) @ vector) < 1e-12) == free


def test_order_of_joints_is_told_apart_in_what_is_saved(tmp_path):
    """Two joints with their laws exchanged are another problem, also where nothing touches."""
    mesh = Crossed({"mid": [LINE], "low": [[(i, 1) for i in range(7)]]})
    laws = {"friction": CoulombFriction(0.3), "gap": 1.0}
    names = ["mid", "low"]

    def Problem(order):
        return ContactProblem(HookeMaterial(E=1000, nu=NU), [Joint(name, NormalCompliance(K), **laws) for name in order],
                              dirichlet={"top": (0, 0), "bottom": (0, 0), "left": (0, 0)})

    Solve(Discretization(Problem(names), LDG(), mesh)).Save(tmp_path / "saved")
    assert ContactSolution.Load(tmp_path / "saved", Problem(names)).disc.problem.joints == names
    with pytest.raises(ProblemError):
        ContactSolution.Load(tmp_path / "saved", Problem(names[::-1]))
