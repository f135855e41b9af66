"""The documentation: its sources hold together, and what is done to built pages does what it says.  A build runs the rest."""

import ast
import doctest
import html
import json
import re
from dataclasses import fields, is_dataclass

import pytest
from ngsolve import CF
from pages import CELL, DOCS, PAGES, ROOT, TOOLS

import ngdgc
from ngdgc import ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NormalCompliance, Solve
from ngdgc.meshes import RectangleMesh

BUILT = {"gallery/index"}       # pages that the build makes


def Toctrees(text):
    """Entries of all toctrees of a page."""
    for block in re.findall(r"```\{toctree\}\n(.*?)```", text, re.S):
        yield from (line for line in block.splitlines() if line and not line.startswith(":"))


def test_tools_do_as_their_examples_say():
    results = [doctest.testmod(tool) for tool in TOOLS.values()]
    assert sum(result.failed for result in results) == 0 and sum(result.attempted for result in results) >= 4


def test_script_of_the_landing_page_is_that_of_the_readme():
    (script,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.S)
    cells = CELL.findall(PAGES["index"])
    assert script in cells
    assert script.replace("300", "301") not in cells


def Missing(entries):
    return {entry for entry in entries if entry not in BUILT and not (DOCS / f"{entry}.md").exists()}


def test_every_page_is_in_the_contents():
    entries = set(Toctrees(PAGES["index"]))
    assert not Missing(entries) and Missing({"nowhere"}) == {"nowhere"}
    assert set(PAGES) - {"index"} == {entry for entry in entries if "/" not in entry}


def test_snippets_are_python():
    """All cells parse, without the magic commands of IPython; a build runs them."""
    def Parse(cell):
        ast.parse("\n".join(line for line in cell.splitlines() if not line.startswith(("%", "!"))))

    cells = [cell for text in PAGES.values() for cell in CELL.findall(text)]
    for cell in cells:
        Parse(cell)
    assert len(cells) > 40
    with pytest.raises(SyntaxError):
        Parse(cells[1] + "\n)")


def Imported(source):
    """The statements of a Python source that import something of ngdgc."""
    plain = "\n".join(line for line in source.splitlines() if not line.lstrip().startswith(("%", "!")))
    return [ast.unparse(node) for node in ast.walk(ast.parse(plain))
            if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "ngdgc"]


def test_what_pages_and_notebooks_import_is_there():
    """Also what only a build of the pages would run."""
    sources = [cell for text in PAGES.values() for cell in CELL.findall(text)]
    for path in (DOCS / "notebooks").glob("*.ipynb"):
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        sources += ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    statements = {line for source in sources for line in Imported(source)}
    assert len(statements) > 30
    for line in statements:
        exec(line, {})
    with pytest.raises(ImportError):
        exec("".join(Imported("from ngdgc import locking")), {})


@pytest.fixture(scope="module")
def names():
    """What the notation table may speak of."""
    material, foundation = HookeMaterial(E=100, nu=0.3), Foundation("bottom", NormalCompliance(10))
    problem = ContactProblem(material, foundation, dirichlet={"top": CF((0, -0.1))})
    disc = Discretization(problem, InteriorPenalty(), RectangleMesh(2))
    return {"material": material, "foundation": foundation, "problem": problem, "disc": disc, "solution": Solve(disc),
            **{name: getattr(ngdgc, name) for name in ngdgc.__all__}}


def Unknown(table, names):
    """Code names of the rows of a table that do not exist."""
    def Exists(code):
        first, *rest = code.split(".")
        value = names.get(first)
        for name in rest:
            given = {field.name for field in fields(value)} if is_dataclass(value) else set()
            if not (hasattr(value, name) or name in given):
                return False
            value = getattr(value, name, None)
        return first in names
    return {code for code in re.findall(r"`([^`]+)`", table) if not Exists(code)}


def test_notation_table_speaks_of_what_exists(names):
    table = PAGES["theory"].split("(notation)=")[1].split("\n## ")[1]
    rows = [line for line in table.splitlines() if line.startswith("| $")]
    assert len(rows) > 25 and not Unknown("\n".join(rows), names)
    assert all(len(re.split(r"(?<!\\)\|", row)) == 7 for row in rows)
    assert Unknown("`solution.presure`, `Foundatoin`, `InteriorPenalty.eta`", names) == {
        "solution.presure", "Foundatoin", "InteriorPenalty.eta"}


def test_tables_of_methods_have_them_all():
    from ngdgc.methods.registry import METHODS

    rows = {name: len(re.findall(rf"^\| `{method.__name__}` \|", PAGES["theory"], re.M)) for name, method in METHODS.items()}
    assert all(count >= 1 for count in rows.values())
    assert all(rows[name] == 3 for name in ("ip", "bassi", "brezzi", "ldg"))      # flux, forms, facet matrix


def test_every_case_has_a_gallery_page(tmp_path):
    from ngdgc.commands.casefiles import CaseFiles

    galleries = TOOLS["galleries"]
    files = galleries.CaseFiles()
    assert {path.stem for path in files} == set(CaseFiles())
    index = galleries.Index(files)
    assert {entry.split("<")[1].rstrip(">") for entry in Toctrees(index)} == set(CaseFiles())
    for path in files:
        parts = galleries.Parts(ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))))
        assert {"title", "Domain", "Problem", "What to look at", "Source"} <= set(parts), path.stem
        assert len(galleries.Questions(parts)) == parts["Ask"].count("?") >= 3, path.stem
    assert not galleries.Questions(galleries.Parts("Title.\n\nSource: why?"))
    assert "Domain" not in galleries.Parts("Title.\n\nDomian: a square.")


@pytest.mark.slow
def test_gallery_page_has_pictures_scene_and_numbers(tmp_path, monkeypatch):
    case = tmp_path / "winkler.py"
    case.write_text('"""A column.\n\nQuestion: How deep?\nDomain: (0,1)^2.\nProblem: p_n = 100 r.\n'
                    'Ask: How deep with m = 2?  Why?\n"""\n'
                    "from ngdgc import *\nfrom ngdgc.exact import WinklerColumn\nfrom ngdgc.meshes import RectangleMesh\n\n\n"
                    "def Main(*, method=LDG(), order=1, n=2, callback=None):\n"
                    "    return Solve(Discretization(WinklerColumn().problem, method, RectangleMesh(n), order=order))\n\n\n"
                    'def Compare(solution):\n    return [("u_n [m]", -solution.At(0.5, 0)[1], 0.3)]\n')
    TOOLS["galleries"].WriteCase(case, tmp_path)
    page = (tmp_path / "winkler.md").read_text(encoding="utf-8")
    pictures = re.findall(r"```\{figure\} (\S+)", page)
    assert len(pictures) >= 3 and all((tmp_path / picture).stat().st_size > 5000 for picture in pictures)
    assert page.startswith("# A column\n") and "**Question.** How deep?" in page
    assert "\nngdgc run cases/winkler.py --out results/\n" in page
    assert page.endswith("\n## Questions\n\n1. How deep with m = 2?\n1. Why?\n")
    assert re.search(r"\| u_n \[m\] \| 0\.3 \| 0\.3 \| [+-]\S+ % \|", page)
    assert "webgui" in (tmp_path / "winkler.scene.html").read_text(encoding="utf-8")


def test_notebooks_offer_their_files():
    """Below the title, and nothing else of them is changed."""
    for path in sorted((DOCS / "notebooks").glob("*.ipynb")):
        source = path.read_text(encoding="utf-8")
        given, shown = json.loads(source), json.loads(TOOLS["downloads"].Offered(source, path.name))
        before, after = ("".join(notebook["cells"].pop(0)["source"]) for notebook in (given, shown))
        assert shown == given
        title, link, rest = after.split("\n\n", 2)
        assert link == f"{{download}}`Download this notebook <{path.name}>`" and link not in before
        assert title.startswith("# ") and f"{title}\n\n{rest}" == before


def test_scenes_share_one_viewer(tmp_path):
    offline = TOOLS["offline"]
    scenes = [f"<head></head><script>{'v' * offline.VIEWER}v</script><script>data = {number} < 2</script>" for number in (1, 2)]
    page = tmp_path / "a" / "page.html"
    page.parent.mkdir()
    page.write_text("".join(f'<iframe srcdoc="{html.escape(scene)}" title="s"></iframe>' for scene in scenes))
    (tmp_path / "gallery").mkdir()
    offline.Finish(tmp_path, tmp_path / "gallery")
    text = page.read_text()
    sources = re.findall(r'src="\.\./(scenes/\w+\.html)"', text)
    assert len(set(sources)) == 2 and "srcdoc" not in text and len(text) < 500
    (viewer,) = (tmp_path / "_static").glob("viewer-*.js")
    for number, source in enumerate(sources, 1):
        scene = (tmp_path / source).read_text()
        assert f'<script src="../_static/{viewer.name}"></script>' in scene and f"data = {number} < 2" in scene
    assert not list(TOOLS["check"].Problems(tmp_path))
    viewer.unlink()
    assert len(list(TOOLS["check"].Problems(tmp_path))) == 2


def test_sliders_become_the_picture_they_start_with():
    state = ('{"state": {"box": {"state": {"children": ["IPY_MODEL_out"]}}, "out": {"state": {"outputs": '
             '[{"data": {"image/png": "abcd\\n", "text/plain": "figure"}}]}}}}')
    page = (f'<script type="application/vnd.jupyter.widget-state+json">{state}</script>'
            '<script type="application/vnd.jupyter.widget-view+json">{"model_id": "box"}</script>')
    text = TOOLS["offline"].StaticWidgets(page)
    assert 'src="data:image/png;base64,abcd"' in text and "vnd.jupyter" not in text
    assert "<img" not in TOOLS["offline"].StaticWidgets(page.replace("IPY_MODEL_out", "IPY_MODEL_other"))


def test_check_finds_what_is_wrong(tmp_path):
    Problems = TOOLS["check"].Problems
    page = tmp_path / "page.html"
    page.write_text('<p id="here"></p><a href="#here">a</a><a href="https://ngsolve.org">b</a><img src="data:image/png,">')
    assert not list(Problems(tmp_path))
    for wrong, words in (('<a href="#there">a</a>', "no place"), ('<a href="other.html">a</a>', "leads nowhere"),
                         ('<script src="https://cdn.example/x.js"></script>', "from a network"),
                         ('<link rel="stylesheet" href="//fonts.example/x.css">', "from a network"),
                         ('<img src="missing.png">', "leads nowhere")):
        page.write_text(wrong)
        (problem,) = Problems(tmp_path)
        assert words in problem
    page.write_text("")
    (tmp_path / "style.css").write_text("@font-face { src: url(https://fonts.example/x.woff2) }")
    assert len(list(Problems(tmp_path))) == 1


def test_check_reads_the_console():
    Errors = TOOLS["check"].Errors
    line = '[1:1:1122/1.5:{}:CONSOLE:34] "{}", source: file:///a.js (2)'
    assert not Errors(line.format("INFO", "webgl2 is supported!"))
    assert Errors(line.format("INFO", "Uncaught TypeError: x is undefined")) and Errors(line.format("ERROR", "gone"))
