"""The overview of exercises: what the checker said in saved notebooks, of one student or of a class."""

import json

import pytest

from ngdgc import ProblemError, cli
from ngdgc.exercises import Check, Overview
from ngdgc.exercises.checker import Grade


def Notebook(path, verdicts):
    """A notebook with a cell for each exercise {name: Verdict, or None for a cell that was not run}."""
    cells = [{"cell_type": "markdown", "source": ['Check("99.9", no cell of code)']}]
    for name, verdict in verdicts.items():
        shown = [{"output_type": "execute_result", "data": {"text/plain": repr(verdict).splitlines(keepends=True)}}]
        cells.append({"cell_type": "code", "source": [f"answer = 3\n{'Check'}(", f'"{name}", answer)'],
                      "outputs": shown if verdict is not None else []})
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"cells": cells}), encoding="utf-8")


@pytest.fixture
def folder(tmp_path):
    right, wrong = Check("01.4", ("b", 2)), Check("01.4", ("a", 1))
    assert right and not wrong
    Notebook(tmp_path / "anna" / "01_column.ipynb", {"01.3": None, "01.4": right})
    Notebook(tmp_path / "anna" / "05_uzawa.ipynb", {"05.4": Check("05.4", ...)})
    Notebook(tmp_path / "ben" / "01_column.ipynb", {"01.3": Grade("01.3", None, 3), "01.4": wrong})
    Notebook(tmp_path / ".ipynb_checkpoints" / "01_column.ipynb", {"01.4": right})
    (tmp_path / "plain.ipynb").write_text(json.dumps({"cells": []}))
    return tmp_path


def test_every_state_is_read_from_what_the_checker_showed(folder):
    passed = Overview(folder)
    assert [(row.file, list(row.states.values())) for row in passed.rows] == [
        ("anna/01_column.ipynb", ["not run", "correct"]), ("anna/05_uzawa.ipynb", ["not answered yet"]),
        ("ben/01_column.ipynb", ["noted", "not yet"])]
    assert (passed.correct, passed.total) == (1, 5) and Overview(str(folder / "ben")).correct == 0
    assert str(passed).splitlines()[0] == "anna/01_column.ipynb    +  1 of 2"
    assert "1 of 5 exercises correct" in repr(passed) and passed._repr_html_().startswith("<pre>anna/01_column.ipynb")


def test_a_verdict_of_another_exercise_does_not_count(folder):
    """Control: the words of one exercise in the cell of another, and words that only look like a verdict."""
    Notebook(folder / "eve" / "01_column.ipynb", {"01.3": Check("01.4", ("b", 2)), "01.4": "01.4: correctly."})
    assert Overview(folder / "eve").correct == 0


def test_mistakes_are_named(folder):
    with pytest.raises(ProblemError, match="there is no folder 'nowhere'; give the one"):
        Overview("nowhere")
    (folder / "empty").mkdir()
    with pytest.raises(ProblemError, match="has exercises; give the folder"):
        Overview(folder / "empty")
    for broken in ("{", "[]", '{"nodes": 1}'):
        (folder / "empty" / "a.ipynb").write_text(broken)
        with pytest.raises(ProblemError, match=r"a.ipynb is no notebook; save it again"):
            Overview(folder / "empty")


def test_the_command_prints_it(folder, capsys):
    assert cli.Main(["progress", str(folder)]) == 0
    assert capsys.readouterr().out.strip() == str(Overview(folder))
    assert cli.Main(["progress", str(folder / "nobody")]) == 2
