"""The atlas of solvers: what it claims of them, with controls; table, page, figures and file hold what was computed."""

import csv
import math
from dataclasses import replace

import pytest

from ngdgc import ProblemError
from ngdgc.studies.atlas import solvers as atlas, page as atlaspage
from ngdgc.studies.atlas.solvers import Point, Row, Run, Solvers, Study, Sweep
from ngdgc.cli import Main
from ngdgc.plots import AtlasFigure

EXPLICIT = ("Uzawa", "Uzawa, Anderson")
NEWTON = ("Newton", "nested Newton")
TOL, LIMIT = 1e-10, 2000


def Rows(point, *, labels=None, limit=LIMIT):
    """{label: Row} of all solvers, or those named, in the order of `Study`."""
    references = []
    return {label: Run(point, label, solver, references) for label, solver in reversed(Solvers(tol=TOL, limit=limit).items())
            if labels is None or label in labels}


STIFF = Point(problem="4.1", stiffness=10.0, n=8)


@pytest.fixture(scope="module")
def stiff():
    return Rows(STIFF)


@pytest.fixture(scope="module")
def soft():
    return Rows(replace(STIFF, stiffness=0.1))


@pytest.mark.slow
def test_beyond_its_limit_uzawa_fails_and_the_others_do_not(stiff, soft):
    for label, row in stiff.items():
        assert row.converged == (label not in EXPLICIT), label
        if label in EXPLICIT:
            assert row.reason == "Uzawa cannot converge for any rho" and row.reason in row.message
    assert all(row.converged for row in soft.values())          # the control: below the limit nobody fails


@pytest.mark.slow
@pytest.mark.parametrize("point", [STIFF, replace(STIFF, stiffness=0.1), Point(n=4, coefficient=0.1),
                                   Point(problem="box", n=1), Point(problem="4.2", stiffness=None, n=4, method="LDG lifting")],
                         ids=["stiff", "soft", "block", "box", "own"])
def test_solvers_that_converge_agree(point, stiff, soft):
    """To 1e-7 in displacement and projected traction, at a tolerance of 1e-10: slow iterations stop earlier than they look."""
    rows = {STIFF: stiff, replace(STIFF, stiffness=0.1): soft}.get(point) or Rows(point)
    compared = [row.difference for row in rows.values() if row.difference is not None]
    assert len(compared) == sum(row.converged for row in rows.values()) - 1 >= 4 and max(compared) < 1e-7


def test_agreement_control_another_coefficient_is_another_solution():
    references, solver = [], Solvers(tol=TOL)["Newton"]
    Run(Point(n=4), "Newton", solver, references)
    assert Run(Point(n=4, coefficient=0.31), "Newton", solver, references).difference > 1e-3


@pytest.mark.slow
def test_steps_of_newton_do_not_grow_with_the_stiffness():
    """k_n/E from 1 to 1e9: at most three times as many, where the plain implicit iteration needs more than ten times."""
    soft, rigid = (replace(STIFF, stiffness=value) for value in (1.0, 1e9))
    before = Rows(soft, labels=(*NEWTON, "implicit"))
    assert all(row.converged for row in before.values())
    after = Rows(rigid, labels=(*NEWTON, "implicit"), limit=10 * before["implicit"].iterations)
    for label in NEWTON:
        assert after[label].converged and after[label].iterations <= 3 * before[label].iterations
    assert not after["implicit"].converged and "too slowly" in after["implicit"].reason


@pytest.mark.slow
def test_every_run_pays_for_itself():
    """Applications and factorisations of a run do not depend on the runs before; those of coarser meshes are listed apart."""
    point = Point(n=32, stiffness=100.0)
    once, again = (Run(point, "nested Newton", Solvers()["nested Newton"], []) for _ in range(2))
    assert (once.iterations, once.solves, once.coarser) == (again.iterations, again.solves, again.coarser)
    assert once.coarser > 0 and 0 < once.factorisation < once.seconds
    alone = Run(point, "Newton", Solvers()["Newton"], [])
    assert alone.coarser == 0 and alone.iterations > once.iterations and alone.difference is None


def test_study_skips_a_finer_mesh_after_the_limit_of_iterations_and_knows_its_points():
    sweep = Sweep("Block", "n", (Point(n=2, stiffness=1e3), Point(n=4, stiffness=1e3)))
    lines = []
    rows = list(Study({"size": sweep, "again": replace(sweep, points=sweep.points[:1])}, limit=20, callback=lines.append))
    assert lines[:2] == ["Block: cells per side n = 1/h: 2", "Block: cells per side n = 1/h: 4"]
    own = [row for row in rows if row.solver == "implicit"]
    assert [row.iterations for row in own] == [20, 0, 20] and own[1].reason == atlas.TOOSLOW and "too slowly" in own[0].reason
    # Cycling is recognised at once and tried again; and what is known is not computed again.
    assert [row.reason for row in rows if row.solver == "Uzawa"] != [atlas.TOOSLOW] * 3
    assert replace(own[2], sweep="size") == own[0]


def test_sweeps_vary_one_thing():
    for name, sweep in {**atlas.Sweeps(), **atlas.QuickSweeps()}.items():
        assert len({replace(point, **{sweep.variable: getattr(sweep.points[0], sweep.variable)})
                    for point in sweep.points}) == 1, name
        assert len(set(sweep.points)) == len(sweep.points)
    sizes = {len(sweep.points) for name, sweep in atlas.Sweeps().items() if name.startswith("method")}
    assert sizes == {9}


@pytest.mark.parametrize("arguments, culprit", [({"problem": "4.3"}, "problem is '4.3'"),
                                                ({"stiffness": None}, "no foundation of its own")])
def test_a_point_that_is_none_is_refused(arguments, culprit):
    with pytest.raises(ProblemError, match=culprit):
        Point(**arguments)


def Invented(solver, stiffness, iterations, reason="", sweep="stiffness"):
    return Row(point=Point(stiffness=stiffness), solver=solver, sweep=sweep, iterations=iterations, solves=10 * iterations,
               coarser=5, seconds=0.1, reason=reason)


def test_figure_interrupts_lines_where_a_solver_gave_up():
    rows = [Invented("Newton", 0.1, 3), Invented("Newton", 1.0, 4, "stagnates"), Invented("Newton", 10.0, 5),
            Invented("implicit", 0.1, 30)]
    figure = AtlasFigure({"Block": rows}, "stiffness", ("iterations", "solves"))
    strip, iterations, work = figure.axes
    newton = {line.get_label(): line for line in iterations.lines}["Newton"]
    assert newton.get_xdata().tolist() == [0.1, 1, 10]
    assert [value for value in newton.get_ydata() if not math.isnan(value)] == [3, 5] and math.isnan(newton.get_ydata()[1])
    assert {line.get_label(): line for line in work.lines}["implicit"].get_ydata().tolist() == [300]
    assert [line.get_label() for line in strip.lines if len(line.get_xdata())] == ["Newton"]
    assert {text.get_text() for text in figure.legends[0].get_texts()} == set(Solvers())
    looks = {(line.get_color(), line.get_marker()) for line in iterations.lines}
    assert len(looks) == len(Solvers())


def test_table_shows_reasons_and_agreement():
    sweeps = {"stiffness": Sweep("Block", "stiffness", (Point(stiffness=0.1), Point(stiffness=1.0)))}
    rows = [replace(Invented("Newton", 0.1, 3), difference=2e-9), Invented("Newton", 1.0, 4, "it stagnates"),
            Invented("Uzawa", 1.0, 20, "it cycles")]
    text = atlaspage.Text(rows, sweeps)
    assert "3 / 30+5 / 0.1" in text and "it stagnates; seen after 4 iterations" in text and "farthest are 2.0e-09" in text
    numbers = [line.split() for line in text.splitlines() if line.startswith("1 ")]
    assert numbers == [["1", "-", "(1)", "-", "(2)"]] and "(1) it cycles" in text
    assert atlaspage.Agreement(rows[1:]) == "No point was solved by two solvers."


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    folder = tmp_path_factory.mktemp("atlas")
    assert Main(["atlas", "--quick", "--out", str(folder), "--page", str(folder / "docs" / "page.md")]) == 0
    return folder


def Read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


@pytest.mark.slow
def test_quick_atlas_writes_table_page_figures_and_file(quick):
    rows, page = Read(quick / "atlas.csv"), (quick / "docs" / "page.md").read_text()
    text = (quick / "atlas.txt").read_text()
    points = sum(len(sweep.points) for sweep in atlas.QuickSweeps().values())
    assert len(rows) == points * len(Solvers()) == len(Read(quick / "docs" / "atlas.csv"))
    solved = [row for row in rows if not row["reason"]]
    assert len(solved) > 0.8 * len(rows)
    for row in solved:
        cell = f"{row['iterations']} / {row['solves']}{'+' + row['coarser'] if int(row['coarser']) else ''} / "
        assert cell in text and f"| {cell}" in page
    for name in ("stiffness", "coefficient", "size"):
        assert f"(images/atlas_{name}.png)" in page
        assert all((folder / f"atlas_{name}.png").stat().st_size > 5000 for folder in (quick, quick / "docs" / "images"))
    assert "](atlas.csv)" in page
    # At the paper's tolerance; an iteration that shrinks its error by 1 % a step stops a hundred times farther off.
    assert max(float(row["difference"]) for row in solved if row["difference"]) < 1e-5
    assert {row["reason"] for row in rows if row["stiffness"] == "1000" and row["solver"] in EXPLICIT} == {
        "Uzawa cannot converge for any rho"}


def test_an_interrupted_atlas_keeps_what_was_computed(tmp_path, capsys, monkeypatch):
    run, calls = atlas.Run, []

    def Interrupted(point, label, *arguments):
        calls.append(label)
        if len(calls) == 4:
            raise KeyboardInterrupt
        return run(point, label, *arguments)

    monkeypatch.setattr(atlas, "Run", Interrupted)
    assert Main(["atlas", "--quick", "--out", str(tmp_path)]) == 130
    assert [row["solver"] for row in Read(tmp_path / "atlas.csv")] == calls[:3]
    assert "interrupted" in capsys.readouterr().err
    assert "nested Newton" in (tmp_path / "atlas.txt").read_text() and not (tmp_path / "docs").exists()


def test_a_folder_that_cannot_be_written_is_one_line(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert Main(["atlas", "--quick", "--out", str(tmp_path / "file")]) == 2
    assert "cannot write into" in capsys.readouterr().err
