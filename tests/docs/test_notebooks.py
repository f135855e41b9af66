"""The notebooks: stored without outputs, run without errors, with pictures and exercises that wait for an answer."""

import ast
import json
import re
import time
from pathlib import Path

import pytest

from ngdgc.exercises import EXERCISES

FOLDER = Path(__file__).parents[2] / "docs" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
SECONDS = 60        # of CPU time for one notebook
LIVE = 1.0          # second for an answer to a slider
ALLOWED = {"ngdgc", "ngsolve", "numpy", "scipy", "matplotlib", "ipywidgets", "IPython", "dataclasses", "functools"}


def Cells(path, kind="code", tag=None):
    return [cell for cell in json.loads(path.read_text())["cells"]
            if cell["cell_type"] == kind and (tag is None or tag in cell["metadata"].get("tags", ()))]


def Source(cell):
    """Python without the magic commands of notebooks."""
    return "".join(line for line in cell["source"] if not line.startswith("%"))


def Imported(path):
    """Top-level names of all modules that a notebook imports."""
    for node in ast.walk(ast.parse("\n".join(map(Source, Cells(path))))):
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module.split(".")[0]


def Stored(notebook):
    """What a stored notebook must not hold: problems as sentences."""
    for number, cell in enumerate(notebook["cells"]):
        if cell.get("outputs") or cell.get("execution_count") is not None:
            yield f"cell {number} has outputs"
        if not re.fullmatch(rf"\d\d-{number:02d}", cell["id"]):
            yield f"the id of cell {number} is {cell['id']}"


def test_there_are_twelve_notebooks_each_with_model_solutions():
    assert [path.stem[:2] for path in NOTEBOOKS] == [f"{number:02d}" for number in range(1, 13)]
    assert [path.stem for path in NOTEBOOKS] == [path.stem for path in sorted((FOLDER / "solutions").glob("*.py"))]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_are_stored_without_outputs(path):
    notebook = json.loads(path.read_text())
    assert list(Stored(notebook)) == []
    spoilt = json.loads(path.read_text())
    code = next(cell for cell in spoilt["cells"] if cell["cell_type"] == "code")
    code["execution_count"] = 1
    spoilt["cells"][0]["id"] = "a1b2"
    assert len(list(Stored(spoilt))) == 2


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_need_the_library_alone(path):
    assert set(Imported(path)) <= ALLOWED
    assert {"ngdgc", "matplotlib"} <= set(Imported(path))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_every_exercise_has_one_cell_for_its_answer_and_a_text(path):
    number = path.stem[:2]
    own = [name for name in EXERCISES if name.startswith(number)]
    assert len(own) >= 3
    asked = [re.search(r'^answer_(\d) = \.\.\.\nCheck\("(\d\d\.\d)", answer_\1\)$', Source(cell)).group(2)
             for cell in Cells(path, tag="answer")]
    assert asked == own
    text = "\n".join("".join(cell["source"]) for cell in Cells(path, "markdown"))
    assert all(f"**{int(number)}.{name[3:]}**" in text for name in own)
    assert "**Aim.**" in text and "## Questions" in text


def Missing(notebook):
    """What a reader is told before and after a notebook, of which it says nothing."""
    first, last = ("".join(notebook["cells"][number]["source"]) for number in (0, -1))
    parts = {"goals": re.search(r"\*\*After this notebook\*\* you can\n\n(\* .+;\n){2,}\* .+\.\n", first),
             "what comes before": re.search(r"\*\*Before\.\*\* .+", first),
             "minutes": re.search(r"\*\*Time\.\*\* (\d+) minutes, (\d+) of them for the exercises\.", first),
             "try next": re.match(r"## Try this next\n\n(\* .+\n){2,}\* .+$", last)}
    return [name for name, found in parts.items() if not found]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_say_what_they_are_for_how_long_they_take_and_what_comes_next(path):
    notebook = json.loads(path.read_text())
    assert Missing(notebook) == []
    total, exercises = map(int, re.search(r"(\d+) minutes, (\d+) of", "".join(notebook["cells"][0]["source"])).groups())
    assert 10 <= exercises < total <= 90
    links = re.findall(r"\]\((\w+\.ipynb)\)", "".join("".join(notebook["cells"][number]["source"]) for number in (0, -1)))
    assert all((FOLDER / link).exists() for link in links)
    notebook["cells"].pop()
    notebook["cells"][0]["source"] = "".join(notebook["cells"][0]["source"]).replace("**Time.**", "").replace("**Before.**", "")
    assert Missing(notebook) == ["what comes before", "minutes", "try next"]


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Runs a notebook, begun without a name; all of them in one kernel, for it takes seconds to import what they need."""
    nbformat = pytest.importorskip("nbformat")
    from nbclient import NotebookClient

    client = NotebookClient(nbformat.v4.new_notebook(), timeout=600)
    with client.setup_kernel(cwd=str(tmp_path_factory.mktemp("notebooks"))):
        def Run(notebook):
            """Seconds of CPU time that its cells take."""
            first, last = (nbformat.v4.new_code_cell(f"{before}import time\nprint(time.process_time())")
                           for before in ("%reset -f\n", ""))
            client.nb = nbformat.v4.new_notebook(cells=[first, *notebook.cells, last])
            client.execute(cleanup_kc=False)
            # What is printed may come in several pieces.
            started, ended = (float("".join(piece.text for piece in cell.outputs if "text" in piece)) for cell in (first, last))
            return ended - started
        yield Run


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_run_without_errors_and_show_pictures(path, run):
    import nbformat

    notebook = nbformat.read(path, as_version=4)
    assert run(notebook) < SECONDS
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    kinds = [kind for output in outputs for kind in output.get("data", {})]
    verdicts = [output["data"]["text/plain"] for cell in notebook.cells if "answer" in cell.metadata.get("tags", ())
                for output in cell.outputs]
    assert kinds.count("image/png") >= 1
    assert any("<iframe" in output.get("data", {}).get("text/html", "") for output in outputs)
    assert len(verdicts) == len(Cells(path, tag="answer"))
    assert all("not answered yet" in verdict for verdict in verdicts)
    assert not any(output.get("name") == "stderr" and "Warning" in output.text for output in outputs)


@pytest.mark.slow
@pytest.mark.parametrize("code, words", [("from ngdgc import NoSuchLaw", "NoSuchLaw"), ("left", "name 'left' is not defined")])
def test_a_notebook_with_an_error_does_not_pass(code, words, run):
    """Nor one that needs a name of another."""
    import nbformat
    from nbclient.exceptions import CellExecutionError

    run(nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell("left = 1\nleft")]))
    with pytest.raises(CellExecutionError, match=words):
        run(nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(code)]))


@pytest.mark.slow
def test_sliders_answer_in_less_than_a_second():
    (path,) = (path for path in NOTEBOOKS if Cells(path, tag="live"))
    imports, (live,) = Cells(path)[0], Cells(path, tag="live")
    assert any("interact(" in Source(cell) for cell in Cells(path))
    names = {}
    exec(Source(imports), names)
    exec(Source(live), names)
    for position in ((0.02, 1e4, 0.8), (0.005, 1e1, 0.0), (0.1, 1e8, 1.5), (0.05, 1e3, 0.3)):
        seconds = []
        for _ in range(2):      # the first call also loads what is loaded once
            start = time.process_time()
            names["ZonesFigure"](names["Press"](*position)).canvas.draw()
            seconds.append(time.process_time() - start)
        assert min(seconds) < LIVE, position
    start = time.process_time()
    names["Press"](0.02, 1e4, 0.8, n=48)
    assert time.process_time() - start > min(seconds), "the clock does not see a problem that is larger by far"
