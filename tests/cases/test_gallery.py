"""The cases: all of them run small with the methods, and answer their questions; each with a datum changed that must fail."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from checks import ExitCode
from ngsolve import Integrate

from ngdgc import (LDG, BassiEtAl, BrezziEtAl, Conforming, ContactSolution, Discretization, InteriorPenalty,
                   NestedNewtonSolver, SemismoothNewtonSolver)
from ngdgc.cases import (curved_body, greco_plate, hertz_line, hertz_sphere, load_steps, machine_part, pressed_block,
                         rubber_pad, rubber_pad_3d, slip_weakening, step_part, two_materials, wavy_foundation)
from ngdgc.commands.casefiles import CaseFiles, LoadCase
from ngdgc.solvers import nested

SOLID = {"hertz_sphere", "machine_part", "rubber_pad_3d", "step_part"}
TWO = [InteriorPenalty(), Conforming()]
ALL = [*TWO, BassiEtAl(), BrezziEtAl(), LDG()]
SMALL = {"breaking_beam": 8}      # with n = 4 it takes many steps along a path, as those of test_pathfollowing do
PAIRS = [(name, method) for name in CaseFiles() for method in (TWO if name in SOLID else ALL)]


@cache
def Case(name):
    """A case as the command loads it, whose meshes are made once: no test changes a mesh."""
    case = LoadCase(name)
    case.Mesh = cache(case.Mesh)
    return case


def Once(Coarser):
    """The function that makes a coarser mesh, which for the same one gives the same one."""
    made = {}

    def Make(mesh, factor):
        if (id(mesh), factor) not in made:
            made[id(mesh), factor] = Coarser(mesh, factor), mesh        # kept, so that no other gets its number
        return made[id(mesh), factor][0]
    return Make


@pytest.fixture(scope="module", autouse=True)
def meshes():
    """Those of solids are made once, for all tests, and the coarser ones that predict: Netgen takes longer than the solvers."""
    with pytest.MonkeyPatch.context() as patch:
        for case in (hertz_sphere, machine_part, rubber_pad_3d, step_part):
            patch.setattr(case, "Mesh", cache(case.Mesh))
        patch.setattr(nested, "CoarserMesh", Once(nested.CoarserMesh))
        yield


def Errors(case, solution):
    """Relative differences of computed and expected values, in the order of Compare."""
    return np.array([computed / expected - 1 for _, computed, expected in case.Compare(solution)])


def Solve(problem, mesh, method, order=2):
    return NestedNewtonSolver().Solve(Discretization(problem, method, mesh, order=order))


@pytest.fixture(params=TWO, ids=["ip", "h1"])
def two(request):
    return request.param


@pytest.mark.slow
@pytest.mark.parametrize("name, method", PAIRS, ids=[f"{name}-{method.name}" for name, method in PAIRS])
def test_every_case_runs_small(name, method):
    """The contract Main(method=, order=, n=, callback=) -> ContactSolution, in equilibrium; Compare gives pairs of numbers."""
    case, steps = Case(name), []
    solution = case.Main(method=method, order=1, n=SMALL.get(name, 4), callback=steps.append)
    assert isinstance(solution, ContactSolution) and solution.converged and steps == solution.history
    assert solution.energy > 0 and solution.GlobalImbalance() < 1e-7      # friction of stiff laws is found to 1e-10 of its size
    for quantity, computed, expected in getattr(case, "Compare", lambda solution: [])(solution):
        assert isinstance(quantity, str) and np.isfinite(float(computed)) and np.isfinite(float(expected))


@pytest.mark.parametrize("name", CaseFiles())
def test_every_case_asks_a_question(name):
    text = Case(name).__doc__
    positions = [text.find(f"\n{part}") for part in ("Question:", "Domain:", "Problem:", "What to look at:", "Source:", "Ask:")]
    assert positions == sorted(positions) and positions[0] > 0
    assert text[positions[0]:positions[1]].rstrip().endswith("?") and text.splitlines()[0].endswith(".")


def test_there_are_twelve_cases_and_more():
    assert len(CaseFiles()) >= 17


@pytest.mark.slow
def test_block_keeps_its_forces_and_nearly_the_contact_of_a_rigid_one(two):
    errors = Errors(pressed_block, solution := pressed_block.Main(method=two))
    assert np.abs(errors[:2]).max() < 1e-8          # balance, to the tolerance of the solver
    assert np.abs(errors[2:]).max() < 0.015         # an elastic block; the length in steps of a third of an element, 2 mm
    assert min(solution.ZoneLengths().values()) > 5     # all three zones
    less = Solve(pressed_block.Problem(shear=0.3), pressed_block.Mesh(16), two)
    assert np.abs(Errors(pressed_block, less)[1:]).min() > 0.04


@pytest.mark.slow
@pytest.mark.parametrize("case, n, tolerances, soft", [(hertz_line, 16, (1e-4, 5e-3, 5e-3), 2e3),
                                                       (hertz_sphere, 12, (1e-3, 0.03, 0.03), 2e3)], ids=["line", "sphere"])
def test_contact_of_hertz(case, n, tolerances, soft, two):
    """Force, size and largest pressure; not those of a radius larger by a fifth, nor on a foundation that yields."""
    solution = case.Main(method=two, n=n)
    assert np.all(np.abs(Errors(case, solution)) < tolerances)
    assert case.Softness() < 3e-3
    computed = [value for _, value, _ in case.Compare(solution)][1:]
    assert np.all(np.abs(np.divide(computed, case.Hertz(1.2 * case.RADIUS)) - 1) > tolerances[1:])
    assert case.Softness(soft) > 0.2
    yielding = Errors(case, Solve(case.Problem(soft), case.Mesh(n), two))
    assert yielding[1] > 1.5 * tolerances[1] and yielding[2] < -1.5 * tolerances[2]


@pytest.mark.slow
def test_waves_touch_as_westergaard_says(two):
    solution = wavy_foundation.Main(method=two)
    assert np.all(np.abs(Errors(wavy_foundation, solution)) < (1e-8, 0.03, 0.01))     # the length in steps of 0.2 of 7.2 mm
    higher = Solve(wavy_foundation.Problem(amplitude=0.015), wavy_foundation.Mesh(32), two)
    errors = Errors(wavy_foundation, higher)
    assert errors[1] < -0.1 and errors[2] > 0.1


def test_tunnel_needs_a_curved_boundary(two):
    """Lame's pressure: digits with curve = order; the error of a polygon for curve = 1; other pressures for another gap."""
    curved, straight = (np.abs(Errors(curved_body, curved_body.Main(method=two, order=3, n=8, curve=curve)))
                        for curve in (3, 1))
    assert curved.max() < 2e-4 and 5e-3 < straight.min()
    closed = Errors(curved_body, Solve(curved_body.Problem(gap=0), curved_body.Mesh(8, 3), two, order=3))
    assert closed[0] > 0.1


def test_rubber_pad_locks_at_order_one(two):
    """Gent and Lindley's force to 5 per cent at order 2; conforming elements of order 1 find more than twice of it."""
    assert np.abs(Errors(rubber_pad, rubber_pad.Main(method=two, n=8))) < 0.05
    first = Errors(rubber_pad, rubber_pad.Main(method=two, order=1, n=4))
    assert first > 1 if two == Conforming() else first < 0.15
    soft = Errors(rubber_pad, rubber_pad.Main(method=two, n=8, nu=0.4))      # a pad that can be compressed
    assert soft < -0.1


@pytest.mark.slow
def test_round_rubber_bearing():
    """The estimate is met by order 2, and by far not by conforming elements of order 1."""
    assert np.abs(Errors(rubber_pad_3d, rubber_pad_3d.Main())) < 0.05
    assert Errors(rubber_pad_3d, rubber_pad_3d.Main(method=Conforming(), order=1)) > 3
    assert Errors(rubber_pad_3d, rubber_pad_3d.Main(n=4, nu=0.4)) < -0.1


@pytest.mark.slow
def test_block_of_two_materials_settles_like_a_rigid_one(two):
    errors = Errors(two_materials, two_materials.Main(method=two))
    assert abs(errors[0]) < 1e-8 and abs(errors[2]) < 0.02 and np.abs(errors[[1, 3]]).max() < 0.06     # it bends
    level = Solve(two_materials.Problem(gap=lambda x: 0 * x), two_materials.Mesh(16), two)
    assert np.abs(Errors(two_materials, level)[2:]).min() > 0.1


@pytest.mark.slow
def test_slab_has_two_states_for_one_pull(two):
    """On the way up it sticks where on the way down it slips; it breaks loose and rests between the pulls of the formula."""
    pulls = [0.008, 0.01, 0.011, 0.012, 0.013, 0.014, 0.015, 0.0162, 0.017]
    path = slip_weakening.Path(pulls + pulls[-2::-1], method=two, order=1, n=8)
    slides = np.array([solution.ZoneLengths()["stick"] == 0 for solution in path])
    up, down = slides[:len(pulls)], slides[len(pulls) - 1:][::-1]
    loose, rest = slip_weakening.Jumps(path[0].normalforce / slip_weakening.LENGTH)
    assert rest < pulls[down.argmax()] < pulls[up.argmax()] < 1.05 * loose and np.all(up <= down) and up[-1] and not down[0]
    errors = np.array([Errors(slip_weakening, solution)[0] for solution in path])
    assert np.abs(errors[slides]).max() < 0.05 and np.abs(errors[~slides]).max() < 0.2     # stress gathers where edges stick
    # Control: friction that does not weaken has one state for that pull, from wherever it comes.
    law, slid = replace(slip_weakening.FRICTION, static=0.3), path[len(pulls) - 1]
    disc = Discretization(slip_weakening.Problem(0.012, law), two, slip_weakening.Mesh(8), order=1)
    starts = [None, (slid.displacement, slid.traction), (path[0].displacement, path[0].traction)]
    one, *others = (SemismoothNewtonSolver().Solve(disc, start=start).displacement for start in starts)
    assert all(other == pytest.approx(one, abs=1e-9) for other in others)


@pytest.mark.slow
def test_roller_creeps_in_from_both_ends(two):
    """The sticking part shrinks with the pull as Cattaneo says, to the resolution of the zones; not with half the friction."""
    parts = []
    for solution in load_steps.Steps(4, largest=0.0045, method=two):
        (_, computed, expected), = load_steps.Compare(solution)
        parts.append(computed)
        assert computed == pytest.approx(expected, abs=0.08)        # points 0.025 mm apart on a contact of 0.9 mm
    assert np.all(np.diff(parts) < 0) and parts[0] > 0.9                # all but the points at both ends
    (_, computed, expected), = load_steps.Compare(load_steps.Main(method=two, coefficient=0.25))
    assert abs(computed - expected) > 0.15


@pytest.mark.slow
@pytest.mark.parametrize("case, order", [(machine_part, 2), (step_part, 2)], ids=["machine", "step"])
def test_parts_from_cad_balance(case, order):
    """Forces to the error of the curved area on which they act; stronger bolts or a stiffer pad give another answer."""
    solution = case.Main(method=Conforming(), order=order, n=4)
    errors = np.abs(Errors(case, solution))
    assert errors[0] < 0.02 and errors.max() < 0.05
    if case is step_part:
        soft, stiff = (case.PadShare(case.Main(method=Conforming(), order=order, n=4, stiffness=k)) for k in (30, 3000))
        assert soft < 0.2 and 0.4 < case.PadShare(solution) < 0.6 and stiff > 0.8
    else:
        problem = case.Problem()
        assert errors[:2].max() < 1e-9      # totals are kept
        stronger = {**problem.force, "bolt": 1.1 * problem.force["bolt"]}
        assert Errors(case, Solve(replace(problem, force=stronger), case.Mesh(4, order), Conforming(), order))[0] > 0.2


@pytest.mark.slow
def test_step_file_is_what_its_function_writes(tmp_path, monkeypatch):
    """Volume and named areas of the shipped solid; a larger bore would be seen."""
    def Sizes(path):
        monkeypatch.setattr(step_part, "FILE", path)
        mesh = step_part.Mesh.__wrapped__(4, 1)     # anew
        return [Integrate(1, mesh), *(Integrate(1, mesh.Boundaries(name)) for name in ("pad", "screw", "bore", "free"))]

    shipped = Sizes(step_part.FILE)
    step_part.Write(tmp_path / "same.step")
    assert Sizes(tmp_path / "same.step") == pytest.approx(shipped, rel=1e-9)
    monkeypatch.setattr(step_part, "RADIUS", 15.0)
    step_part.Write(tmp_path / "other.step")
    assert Sizes(tmp_path / "other.step") != pytest.approx(shipped, rel=1e-3)


@pytest.mark.slow
def test_plate_is_compared_with_what_was_published(two):
    """Five displacements to the 5 per cent of the source; half the friction lets the plate slide farther."""
    assert np.abs(Errors(greco_plate, greco_plate.Main(method=two))).max() < 0.05
    smooth = Solve(greco_plate.Problem(coefficient=0.5), greco_plate.Mesh(16), two)
    assert Errors(greco_plate, smooth).min() > 0.1


@pytest.mark.slow
def test_command_draws_a_solid_part_from_anywhere(tmp_path, monkeypatch, capsys):
    """All files of a run, of an installed case that reads a STEP file, and every picture has something in it."""
    monkeypatch.chdir(tmp_path)
    assert ExitCode("run step_part --method h1 --n 4 --order 1 --out results") == 0
    assert "Contact boundary" in capsys.readouterr().out
    written = {path.name for path in (tmp_path / "results").iterdir()}
    assert written >= {"report.txt", "report.json", "solution.html", "solution.vtu", "setting.png", "deformed.png",
                       "contact.png", "history.png"}
    assert all((tmp_path / "results" / name).stat().st_size > 5000 for name in written if name.endswith((".png", ".html")))
