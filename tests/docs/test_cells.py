"""The code on pages runs, and says what the page says of it."""

import re

import pytest
from pages import CELL, DOCS, PAGES

import ngdgc
from ngdgc import ContactProblem, Discretization, Foundation, InteriorPenalty, NormalCompliance, Solve


def test_answers_to_what_engineers_ask_run(tmp_path, monkeypatch, capsys):
    """The guide's first problem, then every question of the section with its line; an answer to each is printed."""
    monkeypatch.chdir(tmp_path)
    first, second = CELL.findall(PAGES["guide"])[:2]
    loads = [cell for cell in CELL.findall(PAGES["guide"]) if "normal=(0, -1)" in cell or "force={" in cell]
    (cell,) = CELL.findall(PAGES["guide"].split("## What engineers ask of a result")[1].split("\n## ")[0])
    script = "\n".join([first, second, cell, *loads]).replace("%matplotlib inline", "")
    exec(compile(script, "guide.md", "exec"), {})
    shown = capsys.readouterr().out
    assert len(loads) == 2 and shown.count("?") == cell.count("?") >= 12
    assert all(line.split("?")[1].strip() for line in shown.splitlines() if "?" in line)


def Run(page, folder, monkeypatch):
    """The cells of a page one after the other; the names that they leave."""
    monkeypatch.chdir(folder)
    monkeypatch.syspath_prepend(str(DOCS))
    names = {}
    for cell in CELL.findall(page):
        exec(compile(cell.replace("%matplotlib inline", ""), "page.md", "exec"), names)
    return names


@pytest.mark.slow
def test_every_answer_to_a_question_has_its_line_and_runs(tmp_path, monkeypatch):
    page = PAGES["faq"]
    questions = re.split(r"^### ", page, flags=re.M)[1:]
    assert len(questions) >= 15 and all(question.split("\n")[0].endswith("?") for question in questions)
    assert [question.split("\n")[0] for question in questions if not CELL.search(question)] == []
    names = Run(page, tmp_path, monkeypatch)
    # What the answers say of these numbers.
    history, once = names["history"].forces["bottom"][-1], Solve(names["Discretization"](
        names["once"], InteriorPenalty(), names["mesh"], order=2)).Force("bottom")
    assert abs(once[0]) < 0.05 < 1 < abs(history[0])        # not 0: the diagonals of the mesh are not symmetric
    assert names["found"].disc.problem.foundation[0].compliance.stiffness == 1e6 and names["lifted"].penetration.max() < 0


@pytest.mark.slow
def test_block_of_calculix_is_read_and_has_the_forces_of_the_table(tmp_path, monkeypatch):
    """On the same mesh and of the same order, 6e-5 from CalculiX's serendipity; a stiffness off by a thousandth shows."""
    names = Run(PAGES["calculix"], tmp_path, monkeypatch)
    rows = [re.split(r" *\| *", line.strip("| ")) for line in PAGES["calculix"].splitlines() if line.startswith("| 0")]
    (slipping,) = [row for row in rows if row[:2] == ["0.3", "0.05"]]
    theirs, ours = [[float(value) for value in cell.split(",")] for cell in slipping[3:5]]
    found = abs(names["solution"].Force("bottom"))
    assert found == pytest.approx(ours, rel=2e-5) and found == pytest.approx(theirs, rel=1e-4)
    softer = Foundation("bottom", NormalCompliance(300 * 0.999), friction=ngdgc.CoulombFriction(0.3), gap=0.02)
    wrong = Solve(Discretization(ContactProblem(names["material"], softer, dirichlet={"top": (0.05, -0.1)}), InteriorPenalty(),
                                 names["mesh"], order=2))
    assert abs(wrong.Force("bottom")) != pytest.approx(theirs, rel=2e-4)
    assert len(rows) == 6
    # The spring of sticking points: steeper is nearer.
    sticking = [[float(row[3].split(",")[0]), float(row[4].split(",")[0])] for row in rows if row[1] == "0.01"]
    distances = [h1 - calculix for calculix, h1 in sticking]
    assert distances == sorted(distances, reverse=True) and distances[-1] < 0.005 * sticking[-1][1]


@pytest.mark.slow
def test_examples_of_the_contracts_run():
    """One after the other, as they stand; with an inverse that solves twice of what it should they do not."""
    script = "\n".join(re.findall(r"```python\n(.*?)```", PAGES["contracts"], re.S))
    exec(compile(script, "contracts.md", "exec"), {})
    wrong = script.replace("= self.factors.solve(", "= 2 * self.factors.solve(")
    with pytest.raises(ngdgc.ProblemError, match=r"inverse=SuperLU: .*\|A x - b\|"):
        exec(compile(wrong, "contracts.md", "exec"), {})


@pytest.mark.slow
def test_the_cells_of_the_guide_run_one_after_the_other(tmp_path, monkeypatch):
    """As its page is built, in which a name means what the last cell made of it; commands have tests of their own."""
    monkeypatch.chdir(tmp_path)
    scope = {}
    for number, cell in enumerate(CELL.findall(PAGES["guide"])):
        lines = [line for line in cell.splitlines() if not line.startswith(("!", ":", "%"))]
        exec(compile("\n".join(lines), f"cell {number} of guide.md", "exec"), scope)
    assert len(scope["iterated"].displacement) == len(scope["solution"].displacement)
