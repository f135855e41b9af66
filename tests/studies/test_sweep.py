"""Random problems and the grid of parameters: the default solver solves them, by a law checked with other formulas."""

import json
from dataclasses import replace
from io import StringIO
from itertools import islice

import numpy as np
import pytest
from checks import ExitCode
from dense import DenseNewton

from ngdgc import ContactSolution, ProblemError, SemismoothNewtonSolver
from ngdgc.cli import Main
from ngdgc.contact.boundary import Scale
from ngdgc.contact.graph import Distance
from ngdgc.studies.grid import Grid
from ngdgc.plots import SweepFigure
from ngdgc.studies.samples import BodyMesh, Draw
from ngdgc.contact.stiffness import BodyStiffness
from ngdgc.studies.sweep import ALLOWED, SHARP, Line, Run, Samples, Sweep, Tally, Violation

# The seed was chosen: among so few problems not every one makes a third with three zones.
SEED, COUNT, DOFS = 2, 40, 4000


@pytest.fixture(scope="module")
def swept():
    file = StringIO()
    records = Sweep(Samples(SEED, COUNT, dofs=DOFS), file)
    print(f"seed {SEED}\n{Tally(records)}")
    return records, file.getvalue()


@pytest.mark.slow
def test_default_solver_solves_random_problems(swept):
    records, _ = swept
    assert len(records) == COUNT
    assert [Line(record) for record in records if record.error] == []
    assert sum(bool(record.error) for record in records) <= ALLOWED * COUNT
    assert max(record.violation for record in records) <= SHARP
    assert sum(record.threezones for record in records) >= COUNT / 3
    # What nested iteration promises on the finest mesh; the tally lists those that take more.
    assert sum(record.steps[-1] > 5 or record.solves[-1] > 60 for record in records) <= 0.05 * COUNT
    # All methods, dimensions, laws and loads are among them, and foundations on both sides of the body's stiffness.
    for words in ("2D", "3D", "InteriorPenalty", "BassiEtAl", "BrezziEtAl", "LDG", "Conforming", "form='lifting'", "coulomb",
                  "tresca", "power", "weakening", " top ", " side ", " pressure ", "k=1", "k=2", "k=3", "k=4", "m=2", "cad",
                  "unstructured", "delaunay", "quad"):
        assert any(words in record.words for record in records), words
    stiffness, coefficient = (np.array([getattr(r, name) for r in records]) for name in ("stiffness", "coefficient"))
    assert stiffness.min() < 1e-2 and stiffness.max() > 1e7 and coefficient.min() < 0.1 and coefficient.max() > 0.5


@pytest.mark.slow
def test_records_are_written_and_tallied(swept):
    records, text = swept
    assert [json.loads(line)["number"] for line in text.splitlines()] == list(range(COUNT))
    assert [json.loads(line)["violation"] for line in text.splitlines()] == [record.violation for record in records]
    tally = Tally(records)
    assert "40 problems, 0 failed (0.0 %)" in tally and f"{max(record.violation for record in records):.1e}" in tally
    broken = replace(records[0], error="NotConvergedError: cycles", zones=(), steps=(), solves=())
    tally = Tally([broken, *records[1:]])
    assert "1 failed (2.5 %)" in tally and f"FAILED 0: {broken.words}\n  NotConvergedError: cycles" in tally
    assert Tally([broken]).startswith("1 problems, none solved\nFAILED 0") and "FAILED" in Line(broken)
    axes = SweepFigure([broken, *records[1:]]).axes
    assert sum(len(line.get_xdata()) for line in axes[0].lines) == COUNT


def Solved(number, dofs=DOFS):
    sample = Draw(SEED, number, dofs=dofs)
    return sample, sample.Disc().Solve()


def Numbers(count, Good):
    """The first `count` numbers of the sequence whose sample is good."""
    return list(islice((number for number in range(200) if Good(Draw(SEED, number, dofs=DOFS))), count))


@pytest.mark.slow
def test_a_number_is_always_the_same_problem(swept):
    records, _ = swept
    again = Run(7, Draw(SEED, 7, dofs=DOFS))
    assert again.words == records[7].words and again.dofs == records[7].dofs
    assert again.zones == pytest.approx(records[7].zones, abs=1e-12)
    assert Draw(SEED + 1, 7, dofs=DOFS).words != records[7].words


@pytest.mark.slow
def test_control_a_perturbed_traction_violates_the_law():
    """By 1e-6: friction along itself where a point slips, pressure where the foundation is soft."""
    for number in Numbers(2, lambda sample: sample.kind == "coulomb" and "2D" in sample.words and 0.1 < sample.stiffness < 100):
        sample, solution = Solved(number)
        contact, t = solution.disc.contact, solution.traction
        assert Violation(solution).max() <= SHARP
        for change in (contact.Normal(t)[:, None] * contact.normals, contact.Tangential(t)):
            for sign in (1, -1):
                moved = ContactSolution(solution.disc, solution.vector, t + sign * 1e-6 * change)
                assert Violation(moved).max() > SHARP, sample.words
                # The two ways to measure differ by the factor 2 of a minimum of both ways, and by that of two parts.
                assert Violation(moved).max() > 0.2 * Distance(contact, moved.displacement, moved.traction).distance.max()


def test_control_a_stiff_law_is_checked_by_its_penetration():
    """k_n/E > 1e5: into a softer foundation the same pressure would press further, which is seen although all r are tiny."""
    (number,) = Numbers(1, lambda sample: sample.kind == "coulomb" and 1e5 < sample.stiffness < 1e7 and " m=1 " in sample.words)
    sample, solution = Solved(number)
    foundation = sample.problem.foundation[0]
    softer = replace(foundation, compliance=replace(foundation.compliance, stiffness=sample.stiffness / 1e3))
    other = replace(sample, problem=replace(sample.problem, foundation=softer)).Disc()
    assert Violation(ContactSolution(other, solution.vector, solution.traction)).max() > 10 * SHARP


@pytest.mark.slow
def test_control_half_the_friction_is_another_solution():
    """Where stick and slip meet the coefficient matters: displacements on Gamma_C move by more than a thousandth."""
    for number in Numbers(3, lambda sample: sample.kind == "coulomb" and sample.coefficient > 0.3 and sample.n < 12):
        sample, solution = Solved(number)
        foundation = sample.problem.foundation[0]
        weaker = replace(foundation, friction=replace(foundation.friction, coefficient=sample.coefficient / 2))
        other = replace(sample, problem=replace(sample.problem, foundation=weaker)).Disc().Solve()
        assert Scale(other.displacement - solution.displacement) > 1e-3 * Scale(solution.displacement), sample.words
        assert Scale(other.friction - solution.friction) > 1e-2 * Scale(solution.friction), sample.words


DENSE = Numbers(6, lambda sample: sample.kind != "weakening" and sample.n <= 10)


@pytest.mark.slow
@pytest.mark.parametrize("number", DENSE)
def test_a_dense_newton_method_finds_the_same(number):
    """Displacement and the part of the traction that the body feels, to 1e-7; the law holds to 1e-10 in both."""
    sample, solution = Solved(number)
    disc = solution.disc
    reference = DenseNewton(disc, float(np.median(BodyStiffness(disc))))
    assert Scale(solution.displacement - reference.displacement) <= 1e-7 * Scale(reference.displacement), sample.words
    ours, theirs = (disc.contact.TraceProjection(one.traction) for one in (solution, reference))
    assert Scale(ours - theirs) <= 1e-7 * Scale(theirs), sample.words


@pytest.mark.slow
def test_grid_holds_every_combination_once():
    words = [sample.words for _, sample in Grid()]
    assert len(set(words)) == len(words) == 240 and [number for number, _ in Grid()] == list(range(240))
    complete = [sample for _, sample in Grid(["block"], everything=True)]
    for name, low, high in (("coefficient", 0.05, 1), ("stiffness", 1e-3, 1e9), ("n", 8, 256), ("order", 1, 4)):
        values = [getattr(sample, name) for sample in complete]
        assert min(values) == low and max(values) == high
    with pytest.raises(ProblemError, match="no geometry 'sphere'; choose one of 4.1, 4.2, block"):
        Grid(["sphere"])


@pytest.mark.slow
def test_default_solver_solves_the_grid():
    """Every sixth problem at h = 1/8: all are solved, at most 15 steps from rest, and the block has three zones."""
    for number, sample in Grid():
        if sample.n == 8 and number % 6 == 0:
            record = Run(number, sample, fromzero=SemismoothNewtonSolver())
            assert not record.error and record.violation <= SHARP, sample.words
            assert 0 < record.fromzero <= 15 and record.solves[-1] <= 60, sample.words
            assert record.threezones or sample.coefficient < 0.3 or not sample.words.startswith("block"), sample.words


def test_any_solver_is_recorded():
    """One of a user's own as well, that has no coarser meshes: its steps are those of its history."""
    class Own:
        def Solve(self, disc, *, callback=None):
            return SemismoothNewtonSolver().Solve(disc, callback=callback)

    ((_, sample),) = Samples(SEED, 1, dofs=DOFS)
    own, nested = Run(0, sample, solver=Own()), Run(0, sample)
    assert len(own.steps) == len(own.solves) == 1 and own.steps[0] > 0 and own.solves[0] > 0
    assert nested.steps and own.dofs == nested.dofs and Tally([own]).count("finest") == Tally([nested]).count("finest")


@pytest.mark.slow
def test_sweep_command_prints_seed_and_tally(tmp_path, capsys):
    assert Main([*"sweep --count 3 --seed 5 --dofs 2000 --out".split(), str(tmp_path)]) == 0
    output = capsys.readouterr().out
    assert output.startswith("sweep, seed 5, 3 problems\n") and "3 problems, 0 failed (0.0 %)" in output
    lines = (tmp_path / "sweep.jsonl").read_text().splitlines()
    assert [json.loads(line)["words"] for line in lines] == [Draw(5, number, dofs=2000).words for number in range(3)]
    assert {path.name for path in tmp_path.iterdir()} == {"sweep.jsonl", "sweep.txt", "sweep.png"}


@pytest.mark.slow
def test_interrupted_sweep_leaves_what_was_computed(tmp_path, capsys, monkeypatch):
    def Interrupted(seed, number, *, dofs):
        if number == 2:
            raise KeyboardInterrupt
        return Draw(seed, number, dofs=dofs)

    monkeypatch.setattr("ngdgc.studies.sweep.Draw", Interrupted)
    assert Main([*"sweep --count 4 --dofs 2000 --out".split(), str(tmp_path)]) == 130
    assert len((tmp_path / "sweep.jsonl").read_text().splitlines()) == 2
    assert "2 problems, 0 failed" in capsys.readouterr().out


def test_a_failure_is_a_record_and_exit_code_1(tmp_path, capsys, monkeypatch):
    """One Newton step is too few: the error is kept, and the next problem is tried."""
    monkeypatch.setattr("ngdgc.studies.sweep.NestedNewtonSolver", lambda: SemismoothNewtonSolver(maxiter=1))
    assert Main([*"sweep --count 2 --dofs 2000 --out".split(), str(tmp_path)]) == 1
    assert "2 problems, none solved" in capsys.readouterr().out
    errors = [json.loads(line)["error"] for line in (tmp_path / "sweep.jsonl").read_text().splitlines()]
    assert len(errors) == 2 and all("NotConvergedError: Newton reached its limit" in error for error in errors)


@pytest.mark.parametrize("arguments, culprit", [("sweep --seed -1", "'-1' is not a positive integer"),
                                                ("sweep --dofs 10", "dofs is 10; that is too few"),
                                                ("grid --geometry sphere", "no geometry 'sphere'")])
def test_a_mistake_is_one_line_and_exit_code_2(arguments, culprit, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert ExitCode(arguments) == 2 and culprit in capsys.readouterr().err.splitlines()[-1]


@pytest.mark.slow
def test_bodies_have_the_sides_of_the_unit_meshes():
    assert set(BodyMesh(3, "delaunay").GetBoundaries()) == {"back", "front", "left", "right", "bottom", "top"}
    for cells in ("unstructured", "cad"):
        assert {"bottom", "right", "top", "left"} <= set(BodyMesh(3, cells).GetBoundaries())
    assert BodyMesh(3, "cad", 2).GetCurveOrder() == 2
