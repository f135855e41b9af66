"""What a class gets: a package without formulas of right answers, assignments of nbgrader, printed notebooks."""

import base64
import csv
import hashlib
import importlib
import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import ngdgc
from ngdgc.exercises import EXERCISES, Check
from ngdgc.exercises.checker import Choice, Function
from ngdgc.exercises.sealed import Seal

DOCS = Path(__file__).parents[2] / "docs"
sys.path.insert(0, str(DOCS))
classroom, grading = (importlib.import_module(name) for name in ("classroom", "grading"))
sys.path.remove(str(DOCS))
NAMES = sorted(path.stem for path in grading.NOTEBOOKS.glob("*.ipynb"))
SMALL = {"01.4": Choice(right=("b", 2), choices={"a": "no"}, reasons={1: "no"}, insight="yes"),
         "01.2": Function(Right=lambda r: 3 * r, Data=lambda rng: (rng.uniform(0, 1, 5),), hint="own hint", insight="yes")}


def Assignment(name):
    notebook = json.loads((grading.NOTEBOOKS / f"{name}.ipynb").read_text(encoding="utf-8"))
    return grading.Assignment(notebook, grading.Solutions(grading.NOTEBOOKS / "solutions" / f"{name}.py"))


def Source(cell):
    return "".join(cell["source"])


def Wrong(notebook):
    """What nbgrader would not take of the metadata of a notebook, as sentences."""
    names = []
    for cell in notebook["cells"]:
        marked = cell["metadata"].get("nbgrader")
        if marked is None:
            continue
        names.append(marked["grade_id"])
        flags = [marked.get(key) for key in ("grade", "solution", "locked", "task")]
        if not all(isinstance(flag, bool) for flag in flags) or marked.get("schema_version") != 3:
            yield f"{marked} has not the keys of schema 3"
        if not re.fullmatch(r"[a-zA-Z0-9_\-]+", marked["grade_id"]) or cell["id"] != marked["grade_id"]:
            yield f"{marked['grade_id']} is no name"
        if marked.get("grade") != ("points" in marked) or marked.get("points", 1) <= 0:
            yield f"{marked['grade_id']} has points and no grade, or a grade without points"
        if marked.get("grade") and not marked.get("locked"):
            yield f"{marked['grade_id']} may be changed by a student"
    if len(set(names)) < len(names):
        yield "names occur twice"


@pytest.mark.parametrize("name", NAMES)
def test_assignments_are_what_nbgrader_takes(name):
    nbformat = pytest.importorskip("nbformat")
    notebook = Assignment(name)
    nbformat.validate(notebook)
    assert list(Wrong(notebook)) == []
    own = [exercise for exercise in EXERCISES if exercise.startswith(name[:2])]
    marked = [cell["metadata"]["nbgrader"] for cell in notebook["cells"] if "nbgrader" in cell["metadata"]]
    for kind, key in (("answer", "solution"), ("check", "grade")):
        assert [one["grade_id"] for one in marked if one[key]] == [f"{kind}-{exercise}".replace(".", "-") for exercise in own]
    assert all(1 <= one["points"] <= 3 for one in marked if one["grade"])
    marked[1]["points"], marked[0]["grade_id"], marked[3]["locked"] = 0, "a.b", False
    assert len(list(Wrong(notebook))) == 3


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_model_solutions_of_assignments_pass_and_no_answer_does_not(name):
    """The cells of answers and grades one after the other, as nbgrader runs them, and without the solutions."""
    cells = [cell for cell in Assignment(name)["cells"] if "nbgrader" in cell["metadata"]]
    names = {"Check": Check}
    for cell in cells:
        exec(Source(cell), names)
    for answer, check in zip(cells[::2], cells[1::2]):
        with pytest.raises(AssertionError, match="not answered yet"):
            exec(Released(answer) + "\n" + Source(check), {"Check": Check})


def Released(cell):
    """A cell without what nbgrader takes out for students."""
    return re.sub(r"### BEGIN (SOLUTION|HIDDEN TESTS)\n.*?### END \1", "", Source(cell), flags=re.S)


@pytest.mark.parametrize("name", NAMES)
def test_what_students_get_of_an_assignment_is_their_notebook(name):
    given = json.loads((grading.NOTEBOOKS / f"{name}.ipynb").read_text(encoding="utf-8"))
    released = [" ".join(Released(cell).split()) for cell in Assignment(name)["cells"]]
    assert " ".join(released) == " ".join(" ".join(Source(cell).split()) for cell in given["cells"])
    assert "BEGIN" in "".join(map(Source, Assignment(name)["cells"])) and "BEGIN" not in "".join(released)


def test_all_assignments_are_written(tmp_path):
    written = grading.WriteAssignments(tmp_path)
    assert [path.relative_to(tmp_path) for path in written] == [Path("source", name, f"{name}.ipynb") for name in NAMES]
    assert json.loads(written[0].read_text(encoding="utf-8")) == Assignment(NAMES[0])
    assert "ngdgc" in (tmp_path / "nbgrader_config.py").read_text()


def Package(folder):
    """The installed package with the exercises of a package of students; its folder."""
    package = Path(ngdgc.__file__).parent
    for path in package.iterdir():
        if path.name not in ("exercises", "__pycache__"):
            (folder / path.name).symlink_to(path)
    (folder / "exercises").mkdir()
    for name in classroom.KEPT:
        shutil.copy(package / "exercises" / name, folder / "exercises")
    return folder / "exercises"


@pytest.mark.slow
def test_package_of_students_grades_without_the_modules_of_exercises(tmp_path):
    """In a process that finds it first; without the sealed file, which is the control, there is nothing to grade with."""
    (tmp_path / "ngdgc").mkdir()
    exercises = Package(tmp_path / "ngdgc")
    script = ("from ngdgc.exercises import Check\n"
              "answers = ('1.4', ('b', 2)), ('1.4', ('a', 2)), ('1.2', lambda r: 3 * r)\n"
              "print(*(Check(*one).state for one in answers), sep=', ')")

    def Run():
        return subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True,
                              env={**os.environ, "PYTHONPATH": str(tmp_path)})
    for answers, states in ((True, "correct, not yet, correct"), (False, "noted, noted, noted")):
        (exercises / "sealed.bin").write_bytes(Seal(SMALL, answers=answers))
        assert Run().stdout.strip() == states
    (exercises / "sealed.bin").unlink()
    assert "No module named 'ngdgc.exercises.written'" in Run().stderr


def test_wheel_of_students_has_no_exercises_and_a_true_record(tmp_path):
    wheel, made = tmp_path / "a.whl", tmp_path / "b.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        for name in ("ngdgc/__init__.py", "ngdgc/exercises/__init__.py", "ngdgc/exercises/checker.py", "ngdgc/exercises/law.py",
                     "ngdgc/exercises/written.py", "ngdgc-1.dist-info/METADATA", "ngdgc-1.dist-info/RECORD"):
            archive.writestr(name, f"of {name}")
    classroom.WithoutAnswers(wheel, made, b"sealed")
    with zipfile.ZipFile(made) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    assert set(files) == {"ngdgc/__init__.py", "ngdgc/exercises/__init__.py", "ngdgc/exercises/checker.py",
                          "ngdgc/exercises/sealed.bin", "ngdgc-1.dist-info/METADATA", "ngdgc-1.dist-info/RECORD"}
    assert files["ngdgc/exercises/sealed.bin"] == b"sealed" and files["ngdgc/__init__.py"] == b"of ngdgc/__init__.py"
    rows = {name: (digest, size) for name, digest, size in csv.reader(files["ngdgc-1.dist-info/RECORD"].decode().splitlines())}
    assert set(rows) == set(files)
    for name, (digest, size) in rows.items():
        if digest:
            assert digest == "sha256=" + base64.urlsafe_b64encode(hashlib.sha256(files[name]).digest()).rstrip(b"=").decode()
            assert int(size) == len(files[name])


def test_students_get_notebooks_package_and_a_script_but_no_solutions(tmp_path, monkeypatch):
    def Built(folder):
        shutil.copy(tmp_path / "given.whl", Path(folder) / "ngdgc-1-py3-none-any.whl")
        return Path(folder) / "ngdgc-1-py3-none-any.whl"

    with zipfile.ZipFile(tmp_path / "given.whl", "w") as archive:
        archive.writestr("ngdgc/exercises/written.py", "answers")
        archive.writestr("ngdgc-1.dist-info/RECORD", "")
    monkeypatch.setattr(classroom, "Wheel", Built)
    classroom.Main(["students", str(tmp_path / "class"), "--blind"])
    files = sorted(str(path.relative_to(tmp_path / "class")) for path in (tmp_path / "class").rglob("*") if path.is_file())
    assert files == sorted(["ngdgc-1-py3-none-any.whl", "start.sh", *(f"notebooks/{name}.ipynb" for name in NAMES)])
    assert subprocess.run(["sh", "-n", tmp_path / "class" / "start.sh"]).returncode == 0
    assert os.access(tmp_path / "class" / "start.sh", os.X_OK)
    with zipfile.ZipFile(tmp_path / "class" / "ngdgc-1-py3-none-any.whl") as archive:
        assert archive.read("ngdgc/exercises/sealed.bin") == Seal(EXERCISES, answers=False)


def test_notebooks_of_a_site_are_printed(tmp_path, monkeypatch):
    printer = tmp_path / "printer"
    printer.write_text('#!/bin/sh\nfor one in "$@"; do\n'
                       'case $one in --print-to-pdf=*) echo "$@" > "${one#--print-to-pdf=}";; esac; done\n')
    printer.chmod(0o755)
    monkeypatch.setattr(classroom, "CHROMIUM", (str(printer),))
    (tmp_path / "site" / "notebooks").mkdir(parents=True)
    with pytest.raises(SystemExit, match="has no notebooks; build the site first"):
        classroom.Main(["handout", str(tmp_path / "site"), str(tmp_path / "pdf")])
    for name in ("01_column", "02_spaces", "index"):
        (tmp_path / "site" / "notebooks" / f"{name}.html").write_text("<p>")
    classroom.Main(["handout", str(tmp_path / "site"), str(tmp_path / "pdf")])
    assert sorted(path.name for path in (tmp_path / "pdf").iterdir()) == ["01_column.pdf", "02_spaces.pdf"]
    assert "notebooks/02_spaces.html" in (tmp_path / "pdf" / "02_spaces.pdf").read_text()
    monkeypatch.setattr(classroom, "CHROMIUM", ("no-such-browser",))
    with pytest.raises(SystemExit, match="no Chromium"):
        classroom.Main(["handout", str(tmp_path / "site"), str(tmp_path / "pdf")])
