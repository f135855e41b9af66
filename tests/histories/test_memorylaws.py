"""Laws that remember: friction that weakens along the path of the slip, and wear, against formulas."""

from dataclasses import replace

import jointed
import numpy as np
import pytest
from ngsolve import CF, Parameter, y, z
from problems import Along

from ngdgc import (LDG, ArchardWear, BassiEtAl, BrezziEtAl, Conforming, ContactProblem, Discretization, Foundation,
                   HookeMaterial, InteriorPenalty, Joint, LoadHistory, NormalCompliance, ProblemError, SlipWeakeningFriction,
                   SolveHistory)
from ngdgc.contact.graph import SEPARATION, SLIP, STICK
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.plots import ContactFigure, LoadHistoryFigure

EIGHT = [row(form=form) for row in (InteriorPenalty, BassiEtAl, BrezziEtAl, LDG) for form in ("edge", "lifting")]
STIFFNESS, DEPTH = 3000.0, 0.02
WEAK, WEAR = SlipWeakeningFriction(static=0.5, dynamic=0.2, distance=0.15), ArchardWear(1e-3)
SLIPS = np.array([0.02, 0.05, -0.04])       # of the bottom, in the increments to the times 1, 2, 3
PATH = np.cumsum(np.abs(SLIPS))
FRICTION = (0.2 + 0.3 * np.exp(-PATH / 0.15)) * np.sign(SLIPS)      # over the pressure


def Block(t, dim, wear=WEAR):
    """A block DEPTH in its foundation, in homogeneous states of stress, dragged to and fro; (problem, pressures, worn).

    Pressed by k (DEPTH - w), it loses C p |s| in an increment, of which the next one knows: w = DEPTH (1 - prod (1 - C k |s|)).
    """
    left = np.cumprod(1 - wear.coefficient * STIFFNESS * np.abs(SLIPS))
    pressures = STIFFNESS * DEPTH * np.array([1.0, *left[:-1]])
    height, walls = (y, "top|left|right") if dim == 2 else (z, "top|left|right|front|back")
    s, shear, pressed = (Along(t, [0.0, *values])
                         for values in (np.cumsum(SLIPS), FRICTION * pressures / 400.0, pressures / 1400.0))
    u = CF((s + shear * height, *(0.0,) * (dim - 2), -DEPTH - pressed * height))
    foundation = Foundation("bottom", NormalCompliance(STIFFNESS), friction=WEAK, wear=wear)
    return ContactProblem(HookeMaterial(mu=400.0, lam=600.0), foundation, dirichlet={walls: u}), pressures, DEPTH * (1 - left)


def Led(problem, t, method=None, mesh=None, times=(1, 2, 3)):
    return SolveHistory(Discretization(problem, method or LDG(), mesh or RectangleMesh(1)), parameter=t, times=times)


@pytest.fixture(scope="module")
def rubbed():
    """(parameter, problem, depth worn off in the end, history) of a block."""
    t = Parameter(0)
    problem, _, worn = Block(t, 2)
    return t, problem, worn[-1], Led(problem, t)


BLOCKS = [*((method, RectangleMesh(1)) for method in EIGHT), (Conforming(), RectangleMesh(2)),
          (InteriorPenalty(), BoxMesh(1, cells="tet")), (Conforming(), BoxMesh(2, cells="hex"))]


@pytest.mark.parametrize("method, mesh", BLOCKS, ids=lambda value: str(value)[:20])
def test_a_block_that_is_dragged_to_and_fro_weakens_and_wears_as_two_formulas_say(method, mesh):
    """mu along the whole path of the slip, and the gap that has been worn; exact, 1e-9 is the tolerance of the increments."""
    t = Parameter(0)
    problem, pressures, worn = Block(t, mesh.dim)
    history = Led(problem, t, method, mesh)
    # At corners whose displacement H1 prescribes friction is not determined, nor is what it wears.
    inside = np.ones(len(history[0].points), dtype=bool) if method.discontinuous else np.all(
        np.abs(history[0].points[:, :-1] - 0.5) < 0.49, axis=1)
    t_n, t_t = -history.traction[:, inside, -1], history.traction[:, inside, 0]
    assert np.abs(t_n - pressures[:, None]).max() < 1e-9 * pressures[0]
    assert np.abs(t_t - (FRICTION * pressures)[:, None]).max() < 1e-9 * pressures[0]
    assert np.abs(history.path - PATH[:, None])[:, inside].max() < 1e-9
    assert np.abs(history.worn - worn[:, None])[:, inside].max() < 1e-9 * DEPTH
    # The state as such has the gap of the state before, and what its own increment has worn beside.
    last = history[-1]
    assert last.worn[inside] == pytest.approx(worn[-1], rel=1e-9) and last.path[inside] == pytest.approx(PATH[-1], rel=1e-9)
    assert last.penetration[inside] == pytest.approx(DEPTH - worn[-2], rel=1e-9)
    # Control: of the slip in the last increment alone friction would be another one.
    assert abs(0.2 + 0.3 * np.exp(-0.04 / 0.15) - abs(FRICTION[-1])) > 0.05


@pytest.mark.parametrize("method", [InteriorPenalty(), Conforming()], ids=str)
def test_sides_of_a_joint_weaken_and_wear(method):
    """Under the same pressure all along, as the upper part follows what was worn off: w = C P path."""
    t, rate = Parameter(0), 2e-4
    worn = rate * jointed.P * PATH
    problem, _ = jointed.Patch(2, Along(t, [0.0, *FRICTION * jointed.P]), Along(t, [0.0, *np.cumsum(SLIPS)]))
    joint = Joint("mid", NormalCompliance(jointed.K), friction=WEAK, wear=ArchardWear(rate))
    top = problem.dirichlet["top"] - CF((0, Along(t, [0.0, 0.0, *worn[:-1]])))
    history = Led(replace(problem, foundation=joint, dirichlet={"bottom": (0, 0), "top": top}), t, method, jointed.BODIES[2])
    joined = history.traction * np.sign(history[0].normals[:, 1])[None, :, None]
    # The upper part moves by the slips, so that [u]_t is against them.
    assert np.abs(joined - jointed.P * np.column_stack([-FRICTION, np.ones(3)])[:, None]).max() < 1e-8 * jointed.P
    assert np.abs(history.worn - worn[:, None]).max() < 1e-9 * worn[-1]
    assert jointed.Balanced(history[-1])


def test_what_is_apart_or_sticks_neither_wears_nor_weakens():
    """Lifted and moved, put down there, and moved by less than slides: no path; then dragged."""
    t = Parameter(0)
    u = Along(t, [0, 0, 0.5, 0.5, 0.502, 0.6]), Along(t, [-DEPTH, -DEPTH, DEPTH, -DEPTH])
    foundation = Foundation("bottom", NormalCompliance(STIFFNESS), friction=WEAK, wear=WEAR)
    problem = ContactProblem(HookeMaterial(mu=400.0, lam=0.0), foundation, dirichlet={"top": CF(u)})
    history = Led(problem, t, times=(1, 2, 3, 4, 5))
    zones = [set(solution.zones) for solution in history]
    assert zones == [{STICK}, {SEPARATION}, {STICK}, {STICK}, {SLIP}]
    assert np.all(history.path[:4] == 0) and np.all(history.worn[:4] == 0)
    slid = np.abs(history.displacement[4] - history.displacement[3])[:, 0]
    assert history.path[4] == pytest.approx(slid) and history.worn[4].min() > 0


def test_work_is_energy_dissipation_and_what_wears_off():
    """Pressed and rubbed without friction all is linear, and the trapezoidal rule exact; 1e-8 the tolerance."""
    t = Parameter(0)
    foundation = Foundation("bottom", NormalCompliance(STIFFNESS), wear=ArchardWear(2e-4))
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, traction={"left": (3 * t, 0)},
                             dirichlet={"top": CF((Along(t, [0, 0.1, 0, 0.2]), Along(t, [-DEPTH, -DEPTH, -0.03])))})
    history = Led(problem, t, InteriorPenalty(), RectangleMesh(3), [0, 1, 2, 3])
    assert history.traction[..., 1].max() < 0
    lost = history.abrasion
    assert np.all(history.dissipation == 0) and np.all(np.diff(lost) >= 0)
    assert np.abs(history.work - history.energy - lost).max() < 1e-8 * history.energy.max()
    # Control: the balance does not hold without it.
    assert lost[-1] > 1e-2 * history.energy.max()


def test_wear_and_path_are_kept_and_gone_on_with(tmp_path, rubbed):
    t, problem, _, whole = rubbed
    begun = whole[:2]
    begun.Save(tmp_path)
    loaded = LoadHistory.Load(tmp_path, problem, parameter=t)
    assert np.array_equal(loaded.worn, begun.worn) and np.array_equal(loaded.path, begun.path)
    assert np.array_equal(loaded.abrasion, begun.abrasion) and loaded[0].worn == pytest.approx(begun[0].worn)
    for start in (begun, loaded):
        rest = SolveHistory(start.disc, parameter=t, times=(3,), start=start)
        for name in ("traction", "worn", "path", "abrasion"):
            expected = getattr(whole, name)[2:]
            assert np.abs(getattr(rest, name) - expected).max() < 1e-9 * np.abs(expected).max(), name
    t.Set(0)
    other = replace(problem, foundation=replace(problem.foundation[0], wear=ArchardWear(2e-3)))
    with pytest.raises(ProblemError, match="its laws differ"):
        LoadHistory.Load(tmp_path, other, parameter=t)


def test_worn_depth_is_in_tables_and_figures(rubbed):
    t, problem, worn, history = rubbed
    assert history[-1].Table()["worn"] == pytest.approx(worn)
    panels = [axes.get_ylabel() for axes in ContactFigure(history[-1]).axes]
    assert [label for label in panels if "worn" in label]
    _, right = LoadHistoryFigure(history).axes
    assert [line.get_label() for line in right.lines][-2:] == ["abrasion", "energy + dissipation + abrasion"]
    # Without wear there is nothing to show.
    unworn = replace(problem, foundation=replace(problem.foundation[0], wear=None))
    assert "worn" not in Led(unworn, t, times=(1,))[-1].Table().dtype.names
