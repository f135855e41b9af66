"""What is measured of ranks: constants that the formulas give back, rows that are read again, and the page."""

import json
from dataclasses import replace

import numpy as np
import pytest

from ngdgc import ProblemError
from ngdgc.cli import Main
from ngdgc.studies.bench import scaling
from ngdgc.studies.bench.ranks import ONEMACHINE, Spread, Task
from ngdgc.studies.bench.scaling import Law, Line, Row, Sides, Study, Tasks
from ngdgc.studies.bench.scalingpage import Contacts, Equations, Page, Times

LAW = Law(ghosts=1.5, bytes=20.0, fixed=180.0, each=2.0, subspace=3.0, factors=7.0, steps=(15.0, 1.5))


def Made(task, seconds=1.0):
    """A row that obeys LAW to round-off."""
    n = task.n * 2 ** task.refine
    unknowns, ranks = 72 * n ** 3, max(task.ranks, 1)
    found, spread, m = LAW.At(unknowns, ranks), task.ranks and task.contact, unknowns / ranks
    return Spread(task, unknowns, 6 * n ** 2, {} if task.contact else {"GAMG": found["steps"], "BoomerAMG": 3}, 40.0,
                  1e3 * found["kB a step"], 3.0, found["ghosts [%]"] / 100, seconds, 0.0, 0.0, 0.0, 0.0, 2 * seconds,
                  9 * task.contact, 33 * task.contact, found["X_h"] * spread,
                  LAW.factors * found["X_h"] ** (4 / 3) * spread, [LAW.fixed] * ranks,
                  [LAW.fixed + LAW.each * m / 1.048576e3] * ranks)


@pytest.fixture(scope="module")
def rows():
    return [Made(task, seconds) for task, seconds in zip(Tasks(), np.linspace(1, 2, 100))]


def test_constants_of_the_formulas_are_found_again(rows):
    """To round-off; from other rows they are others."""
    found, other = Law.Of(rows), Law.Of([replace(row, bytes=2 * row.bytes) for row in rows])
    for name, value in vars(LAW).items():
        assert getattr(found, name) == pytest.approx(value, rel=1e-9)
    assert other.bytes == pytest.approx(2 * LAW.bytes)
    assert found.At(72 * 240 ** 3, 1000)["points"] == pytest.approx(6 * 240 ** 2)
    assert (Sides(1), Sides(8)) == pytest.approx((0, 3))       # octants of a cube have three sides inside


def test_rows_are_read_again_and_not_run_again(rows):
    assert [Row(Line(row)) for row in rows] == rows
    assert list(Study(Tasks(), known=rows)) == rows
    assert len(set(Tasks())) < len(Tasks()) and Task(ranks=ONEMACHINE, n=scaling.TIMED, contact=True) in Tasks()


def test_page_has_a_row_for_each_run(rows):
    page, single = Page(rows, 2), [row for row in rows if not row.task.contact]
    assert len(Equations(rows)) == 1 + len(single) == 17
    assert len(Contacts(rows)) == 1 + len({row.task for row in rows} - {row.task for row in single})
    assert "ghosts = 1.50 s m^(-1/3)" in page and "steps = 15.0 + 1.50 log10 N" in page and "1e+09 |" in page
    head, *times = Times(rows)
    assert [cells[0] for cells in times] == ["one machine", "1", "2"] and times[0][2] == times[1][3] == "1.00"
    one, two = (np.median([row.seconds for row in rows if row.task == Task(ranks=p, n=scaling.TIMED, contact=True)])
                for p in (1, 2))
    assert times[2][3] == f"{two / one:.2f}"
    assert Times(single) == []


def test_command_takes_the_rows_of_earlier_runs(tmp_path, monkeypatch, capsys):
    known = tmp_path / "known.json"
    known.write_text("".join(Line(Made(task)) + "\n" for task in Tasks(quick=True)), encoding="utf-8")
    monkeypatch.setattr(scaling, "Measure", None)
    assert Main(["bench", "ranks", "--quick", "--rows", str(known), "--out", str(tmp_path), "--page",
                 str(tmp_path / "scaling.md")]) == 0
    assert "corrections" in capsys.readouterr().out and "What breaks first" in (tmp_path / "scaling.md").read_text()
    assert json.loads((tmp_path / "scaling.json").read_text().splitlines()[0])["unknowns"] == 576


def test_ranks_that_fail_say_why(monkeypatch):
    monkeypatch.setenv("PATH", "")
    with pytest.raises(ProblemError, match="3 ranks came to no result: .*mpirun"):
        list(Study([Task(ranks=3, n=1)]))
