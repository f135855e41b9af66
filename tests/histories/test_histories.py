"""Load histories against states that are known exactly, against increments solved one by one, and against one step."""


import numpy as np
import pytest
from ngsolve import CF, Parameter, x, y, z
from problems import TEN, Along

from ngdgc import (LDG, Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   LoadHistory, NormalCompliance, NotConvergedError, SemismoothNewtonSolver, Solve, SolveHistory,
                   SolveInterrupted, TrescaFriction)
from ngdgc.contact.graph import SEPARATION, SLIP, STICK
from ngdgc.discrete.problem import DiscreteProblem
from ngdgc.histories import solve
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.plots import LoadHistoryFigure

MATERIAL = HookeMaterial(mu=400.0, lam=600.0)
STIFFNESS, COEFFICIENT = 3000.0, 0.3
# Of the states at t = 1, 2, ...: zone, displacement s along the foundation, depth w, and friction as a part of its bound.
PATH = [(STICK, 0.0, 0.03, 0.5), (SLIP, 0.02, 0.03, 1.0), (STICK, 0.02, 0.03, -0.4), (SLIP, -0.01, 0.025, -1.0),
        (SEPARATION, 0.05, -0.01, 0.0), (SLIP, 0.07, 0.02, 1.0)]
ZONES = [zone for zone, *_ in PATH]


def Patch(t, dim, direction):
    """A block in homogeneous states of stress, led along PATH: its displacement is prescribed but on the bottom.

    u = (s + c h) e - (w - a h) n, h the height: friction is mu c, pressure -(lam + 2 mu) a = k w.
    """
    height = y if dim == 2 else z
    pressures = [STIFFNESS * max(depth, 0) for _, _, depth, _ in PATH]
    s, w = (Along(t, [0.0, *(state[place] for state in PATH)]) for place in (1, 2))
    c = Along(t, [0.0, *(part * COEFFICIENT * p / 400.0 for p, (*_, part) in zip(pressures, PATH))])
    a = Along(t, [0.0, *(-p / 1400.0 for p in pressures)])
    along = [component * (s + c * height) for component in direction]
    walls = "top|left|right" if dim == 2 else "top|left|right|front|back"
    foundation = Foundation("bottom", NormalCompliance(STIFFNESS), friction=CoulombFriction(COEFFICIENT))
    return ContactProblem(MATERIAL, foundation, dirichlet={walls: CF((*along, -w + a * height))})


def Expected(direction):
    """u and t on the bottom at t = 1, 2, ..., (m, d) each."""
    u = [(*(slip * np.array(direction)), -depth) for _, slip, depth, _ in PATH]
    t = [STIFFNESS * max(depth, 0) * np.array((*(part * COEFFICIENT * np.array(direction)), -1)) for _, _, depth, part in PATH]
    return np.array(u), np.array(t)


def Led(method, mesh, dim=2, direction=(1.0,), order=1):
    t = Parameter(0)
    disc = Discretization(Patch(t, dim, direction), method, mesh, order=order)
    return SolveHistory(disc, parameter=t, times=range(1, len(PATH) + 1), solver=SemismoothNewtonSolver(tol=1e-12))


CASES = [(method, RectangleMesh(1), 2, (1.0,)) for method in TEN]
CASES += [(Conforming(), RectangleMesh(2), 2, (1.0,)), (LDG(), RectangleMesh(2, cells="quad"), 2, (-1.0,)),
          (InteriorPenalty(), BoxMesh(1, cells="tet"), 3, (0.6, 0.8)), (Conforming(), BoxMesh(2, cells="hex"), 3, (0.6, -0.8))]


@pytest.mark.slow
@pytest.mark.parametrize("method, mesh, dim, direction", CASES, ids=lambda value: str(value)[:20])
def test_a_patch_is_exact_through_stick_slip_reversal_slip_back_separation_and_return(method, mesh, dim, direction):
    """The states are in the space, so all digits are: 1e-10 of the largest displacement and traction."""
    history = Led(method, mesh, dim, direction)
    u, t = Expected(direction)
    # At corners whose displacement H1 prescribes the friction of stick is not determined.
    inside = np.ones(len(history[0].points), dtype=bool) if method.discontinuous else np.all(
        np.abs(history[0].points[:, :dim - 1] - 0.5) < 0.49, axis=1)
    assert np.abs(history.displacement - u[:, None]).max() < 1e-10 * np.abs(u).max()
    assert np.abs(history.traction - t[:, None])[:, inside].max() < 1e-10 * np.abs(t).max()
    assert [set(solution.zones[inside]) for solution in history] == [{zone} for zone in ZONES]
    if method.discontinuous:
        assert np.abs(history.forces["bottom"] + t).max() < 1e-10 * np.abs(t).max()         # area 1


def test_control_the_law_without_memory_has_other_states():
    t = Parameter(0)
    disc = Discretization(Patch(t, 2, (1.0,)), LDG(), RectangleMesh(2))
    history = SolveHistory(disc, parameter=t, times=range(1, len(PATH) + 1))
    t.Set(3)
    static = Solve(disc)
    assert np.abs(static.traction - history[2].traction).max() > 0.3 * np.abs(history[2].traction).max()


def Block(t, n=8, order=1, *, method=None, gap=0.0, exponent=1, friction=None, stiffness=1e5, u=None):
    """A block pressed by t = 1, dragged until t = 3 and brought back until t = 5."""
    u = u or (Along(t, [0, 0, 0.015, 0.03, 0.015, 0]), Along(t, [0, -0.02]))
    foundation = Foundation("bottom", NormalCompliance(stiffness, exponent=exponent), friction=friction or CoulombFriction(0.3),
                            gap=gap)
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, dirichlet={"top": CF(u)})
    return Discretization(problem, method or InteriorPenalty(), RectangleMesh(n), order=order)


@pytest.mark.slow
def test_every_increment_is_one_of_its_own():
    """Each from rest with a matrix of its own, slip from the last state: the tolerances allow 1e-9 of the largest values."""
    t = Parameter(0)
    history = SolveHistory(Block(t, order=2), parameter=t, times=np.linspace(0, 5, 21)[1:])
    alone = SemismoothNewtonSolver(tol=1e-12)
    for before, after, time in zip(history.states[:-1], history.states[1:], history.times[1:]):
        t.Set(time)
        separate = alone.Solve(Block(t, order=2).After(before.displacement))
        for name in ("displacement", "traction"):
            expected = getattr(separate, name)
            assert np.abs(getattr(after, name) - expected).max() < 1e-9 * np.abs(expected).max(), (name, time)
    assert max(solution.EquilibriumResidual() for solution in history[::5]) < 1e-12


def Proportional(steps, **changes):
    """The force after the load of a block, pressed and sheared at once, has been raised in steps."""
    t = Parameter(0)
    disc = Block(t, u=(0.006 * t, -0.02 * t), **changes)
    return SolveHistory(disc, parameter=t, times=np.linspace(0, 1, steps + 1)[1:], solver=SemismoothNewtonSolver(tol=1e-12))


@pytest.mark.slow
def test_a_proportional_load_without_gap_is_as_good_as_one_step_and_others_are_not():
    """p_n linear and p_t proportional to it: all states are multiples of one, 1e-9 are the tolerances of 20 increments."""
    def Difference(**changes):
        many, one = Proportional(20, **changes), Proportional(1, **changes)
        return np.abs(many.traction[-1] - one.traction[0]).max() / np.abs(one.traction).max()

    assert Difference() < 1e-9
    assert Difference(gap=0.004 * x) > 1e-4
    assert Difference(friction=TrescaFriction(2)) > 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("method", [InteriorPenalty(), Conforming()], ids=str)
def test_work_is_energy_and_dissipation_up_to_the_increments(method):
    """Backward Euler: the defect is of first order, so it halves, and friction takes too little, never too much."""
    defects = []
    for steps in (80, 160):
        t = Parameter(0)
        history = SolveHistory(Block(t, n=16, method=method), parameter=t, times=np.linspace(0, 5, steps + 1)[1:])
        defect = history.work - history.energy - history.dissipation
        assert defect.max() < 1e-6 * history.work[-1]
        assert np.diff(history.dissipation).min() > -1e-12
        defects.append(defect[-1])
    assert 1.8 < defects[0] / defects[1] < 2.3 and -defects[0] < 1e-3 * history.work[-1]


def test_energy_of_a_patch_is_that_of_its_stress():
    """By hand: half of stress times strain over the unit square, and k w^2/2 of the foundation."""
    history = Led(LDG(), RectangleMesh(2))
    for (_, _, depth, part), energy in zip(PATH, history.energy):
        pressure = STIFFNESS * max(depth, 0)
        shear = part * COEFFICIENT * pressure
        assert abs(energy - (pressure ** 2 / 1400 + shear ** 2 / 400) / 2 - STIFFNESS * max(depth, 0) ** 2 / 2) < 1e-10
    # Between the states friction is that of the end of each step: w .(slip) of steps 2, 4 and 6.
    slips = [0.02 * 27, 0.03 * 22.5, 0.02 * 18]
    assert abs(history.dissipation[-1] - sum(slips)) < 1e-10


def test_a_history_goes_on_from_another_one_and_from_a_folder(tmp_path):
    """All states, work and dissipation are those of a history in one piece, to the tolerance 1e-10 of its increments."""
    t = Parameter(0)
    disc, times = Block(t, n=4), np.linspace(0, 5, 21)[1:]
    whole = SolveHistory(disc, parameter=t, times=times)
    begun = SolveHistory(disc, parameter=t, times=times[:9])
    begun.Save(tmp_path)
    loaded = LoadHistory.Load(tmp_path, disc.problem, parameter=t)
    assert t.Get() == 0 and np.array_equal(loaded.traction, begun.traction) and np.array_equal(loaded.work, begun.work)
    assert np.array_equal(loaded[3].zones, begun[3].zones)
    for start, going in ((begun, disc), (loaded, loaded.disc)):
        rest = SolveHistory(going, parameter=t, times=times[9:], start=start)
        assert np.abs(rest.traction - whole.traction[9:]).max() < 1e-8 * np.abs(whole.traction).max()
        assert rest.work == pytest.approx(whole.work[9:], rel=1e-8)
        assert rest.dissipation == pytest.approx(whole.dissipation[9:], rel=1e-8)
    # Control: what is no start goes another way.
    fresh = SolveHistory(disc, parameter=t, times=times[9:])
    assert np.abs(fresh.traction - whole.traction[9:]).max() > 1e-3 * np.abs(whole.traction).max()


def test_a_failure_names_the_time_and_keeps_the_states_and_the_parameter(monkeypatch):
    """A force that in the end is more than friction holds; and a callback that fails."""
    monkeypatch.setattr(solve, "HALVINGS", 0)       # to fail sooner
    t = Parameter(0.25)
    foundation = Foundation("bottom", NormalCompliance(1e4), friction=CoulombFriction(0.3))
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, traction={"top": CF((t, -10))})
    disc = Discretization(problem, InteriorPenalty(), RectangleMesh(2))
    with pytest.raises(NotConvergedError, match="at time 8: ") as failed:
        SolveHistory(disc, parameter=t, times=[1, 2, 8])
    assert failed.value.states.times.tolist() == [1, 2] and t.Get() == 0.25
    seen = []

    def Stop(increment):
        seen.append(increment.time)
        if increment.time == 2:
            raise KeyboardInterrupt

    with pytest.raises(SolveInterrupted) as stopped:
        SolveHistory(disc, parameter=t, times=[1, 2, 2.5], callback=Stop)
    assert seen == [1, 2] and len(stopped.value.states) == 2 and t.Get() == 0.25
    assert stopped.value.solution.traction == pytest.approx(stopped.value.states[-1].traction)


def test_an_interrupted_first_state_leaves_an_iterate_and_no_states(monkeypatch):
    """Where the solver has an iterate; else it is a Ctrl-C as any other."""
    t = Parameter(0)
    disc = Block(t, n=4)
    found = SemismoothNewtonSolver().Solve(disc)
    for raised in (SolveInterrupted(found), KeyboardInterrupt()):
        def Stop(solver, disc, raised=raised, **options):
            raise raised

        monkeypatch.setattr(SemismoothNewtonSolver, "Solve", Stop)
        with pytest.raises(KeyboardInterrupt) as stopped:
            SolveHistory(disc, parameter=t, times=[1, 2], solver=SemismoothNewtonSolver())
        assert t.Get() == 0 and getattr(stopped.value, "solution", None) is getattr(raised, "solution", None)
        if isinstance(raised, SolveInterrupted):
            assert len(stopped.value.states) == 0 and "iterations" in str(stopped.value)


@pytest.mark.parametrize("count, words", [(0, "it is the first state"), (1, "the state before is kept in `states`"),
                                          (2, "the 2 states before are kept in `states`")])
def test_a_failure_says_how_many_states_are_kept(count, words, monkeypatch):
    monkeypatch.setattr(solve, "HALVINGS", 0)       # to fail sooner
    t = Parameter(0)
    foundation = Foundation("bottom", NormalCompliance(1e4), friction=CoulombFriction(0.3))
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, traction={"top": CF((t, -10))})
    disc = Discretization(problem, InteriorPenalty(), RectangleMesh(1))
    with pytest.raises(NotConvergedError) as failed:
        SolveHistory(disc, parameter=t, times=[0.5, 1, 8][2 - count:])
    assert len(failed.value.states) == count and words in str(failed.value)


def test_no_factorisation_after_the_first_increment(monkeypatch):
    """Those of the first state and its coarser meshes, one with the stiffness of contact, and no more."""
    made = []
    factorise = DiscreteProblem.Factorise
    monkeypatch.setattr(DiscreteProblem, "Factorise", lambda disc, matrix: made.append(1) or factorise(disc, matrix))
    counts = []
    t = Parameter(0)
    history = SolveHistory(Block(t), parameter=t, times=np.linspace(0, 5, 21)[1:], callback=lambda _: counts.append(len(made)))
    assert counts[1] == counts[0] + 1 == counts[-1] and sum(increment.parts for increment in history.increments) == 20
    assert sum(increment.solves for increment in history.increments[1:]) < 8 * 19
    assert min(increment.solves for increment in history.increments) == 0


def test_figure_has_the_forces_and_the_energies_of_the_history():
    history = Led(LDG(), RectangleMesh(1))
    left, right = LoadHistoryFigure(history).axes
    assert np.array_equal(left.lines[0].get_ydata(), history.forces["bottom"][:, 0])
    assert [line.get_label() for line in right.lines] == ["work", "energy", "dissipation", "energy + dissipation"]
    left, _ = LoadHistoryFigure(history, against=history.displacement[:, 0, 0]).axes
    assert np.array_equal(left.lines[1].get_xdata(), history.displacement[:, 0, 0])


def test_slip_counts_from_the_last_state_whatever_the_data_are_then():
    """|u_t - v_t| after a state v, also of the copy with the data of another time; pressure depends on u alone."""
    t = Parameter(1)
    disc = Discretization(Patch(t, 2, (1.0,)), LDG(), RectangleMesh(2))
    rng = np.random.default_rng(1)
    u, v = rng.uniform(-1, 1, (2, *disc.contact.normals.shape))
    after = disc.After(v)
    t.Set(2)
    for contact in (after.contact, after.Current().contact):
        assert contact.Slip(u) == pytest.approx(np.abs(u - v)[:, 0]) and contact.Penetration(u) == pytest.approx(-u[:, 1])
    assert after.Current() is not after and disc.contact.Slip(u) == pytest.approx(np.abs(u[:, 0]))


def test_forces_of_two_foundations_are_their_own():
    t = Parameter(0)
    law = NormalCompliance(1e3)
    problem = ContactProblem(MATERIAL, [Foundation("bottom", law), Foundation("left", NormalCompliance(2e3))],
                             dirichlet={"top": CF((-0.01 * t, -0.02 * t))})
    history = SolveHistory(Discretization(problem, LDG(), RectangleMesh(3)), parameter=t, times=[1, 2])
    for name in ("bottom", "left"):
        found = [solution.Force(name) for solution in history]
        assert history.forces[name] == pytest.approx(np.array(found), rel=1e-9)
    assert np.abs(history.forces["bottom"] - history.forces["left"]).min() > 1e-3
