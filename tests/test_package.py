"""The package: installed, layered, quick to import, quiet about NGSolve's names, its README and doctests true."""

import ast
import doctest
import importlib
import pkgutil
import re
import subprocess
import sys
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest
from house import STOREYS

import ngdgc

ROOT = Path(__file__).parents[1]
SOURCES = {path.relative_to(ROOT / "ngdgc").with_suffix("").as_posix().replace("/", "."): path
           for path in (ROOT / "ngdgc").rglob("*.py")}


def test_tests_run_against_the_installed_package():
    """Which may be in an environment inside the checkout, where README.md advises one."""
    def FromSource(file):
        return Path(file).resolve().parent == ROOT / "ngdgc"

    assert not FromSource(ngdgc.__file__)
    assert FromSource(ROOT / "ngdgc" / "cli.py")
    assert not FromSource(ROOT / ".venv" / "lib" / "python3" / "site-packages" / "ngdgc" / "cli.py")
    for name, path in SOURCES.items():
        installed = Path(ngdgc.__file__).parent / path.relative_to(ROOT / "ngdgc")
        assert installed.read_text() == path.read_text(), f"{name} differs from the installed one: pip install again"


@cache
def Imports(name, source):
    """[(line, module)] of what a module of this name imports of the package, anywhere in it, also for type checkers alone."""
    package, found = ["ngdgc", *name.split(".")[:-1]], []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom):
            base = package[:len(package) + 1 - node.level] if node.level else []
            path = ".".join([*base, *(node.module or "").split(".")]).strip(".")
            for alias in node.names:
                inner = f"{path}.{alias.name}".removeprefix("ngdgc.")
                outer = path.removeprefix("ngdgc.") if path != "ngdgc" else "__init__"
                found.append((node.lineno, inner if Module(inner) else outer))
        elif isinstance(node, ast.Import):
            found += ((node.lineno, alias.name.removeprefix("ngdgc.")) for alias in node.names)
    return found


def Module(name):
    """The name of a module of the package, as in SOURCES, or None."""
    return next((found for found in (name, f"{name}.__init__") if found in SOURCES), None)


def Arrows(sources):
    """[(module, line, imported module)] inside the package, {name: text}; a case is "cases"."""
    found = []
    for name, text in sources.items():
        for line, imported in Imports(name, text):
            target = "cases" if imported.split(".")[0] == "cases" else Module(imported)
            if target:
                found.append((name, line, target))
    return found


def Upwards(arrows):
    """Imports of what does not stand in a lower storey, or in the same one."""
    rank = {storey: number for number, storey in enumerate(STOREYS)}
    return [f"{name}, line {line}, imports {target}" for name, line, target in arrows
            if rank[target.split(".")[0]] > rank[name.split(".")[0]]]


def Circles(arrows):
    """Packages or modules that import each other in a circle: in each package, what its parts import of each other."""
    circles = []
    for package in {name.rpartition(".")[0] for name, *_ in arrows}:
        depth = len(package.split(".")) if package else 0
        graph = {}
        for name, _, target in arrows:
            parts = [path.split(".") for path in (name, target)]
            if all(path[:depth] == (package.split(".") if package else []) and len(path) > depth for path in parts):
                first, second = (path[depth] for path in parts)
                if first != second:
                    graph.setdefault(first, set()).add(second)
        try:
            list(TopologicalSorter(graph).static_order())
        except CycleError as error:
            circles.append((package, error.args[1]))
    return circles


TEXTS = {name: path.read_text() for name, path in SOURCES.items()}


def test_imports_run_downwards_and_in_no_circle():
    arrows = Arrows(TEXTS)
    assert len(arrows) > 500
    assert {name.split(".")[0] for name in SOURCES} | {"cases"} == set(STOREYS)
    assert Upwards(arrows) == []
    assert Circles(arrows) == []


@pytest.mark.slow
def test_an_import_upwards_and_a_circle_are_seen():
    """Also in a function, and for type checkers alone."""
    lines = ["from ..solvers import UzawaSolver", "def F():\n    from ..solvers.driver import Drive",
             "if TYPE_CHECKING:\n    from ngdgc.solvers import driver"]
    for line in lines:
        assert Upwards(Arrows({**TEXTS, "contact.graph": line})) != []
    assert Upwards(Arrows({**TEXTS, "contact.graph": "from ..problem.laws import NormalCompliance"})) == []
    assert Circles(Arrows({**TEXTS, "solvers.driver": "from .nested import NestedNewtonSolver"})) != []
    assert Circles(Arrows({**TEXTS, "mesh.facets": "from .checks import Sides"})) != []


@pytest.mark.parametrize("folder", sorted({path.parent for path in SOURCES.values()} - {ROOT / "ngdgc"}))
def test_every_folder_says_what_belongs_there(folder):
    first, _, *rest = ast.get_docstring(ast.parse((folder / "__init__.py").read_text())).splitlines()
    assert first and [line.split(":")[0] for line in rest[:2]] == ["Here", "Not here"]


def test_few_modules_stand_outside_of_the_storeys():
    assert len(list((ROOT / "ngdgc").glob("*.py"))) <= 14


def test_star_import_changes_no_name_of_ngsolve():
    before = {}
    exec("from ngsolve import *", before)
    after = dict(before)
    exec("from ngdgc import *", after)
    changed = [name for name in before if name != "__builtins__" and after[name] is not before[name]]
    assert not changed
    assert ngdgc.Solve is before["Solve"]
    assert set(after) - set(before) == set(ngdgc.__all__) - {"Solve"}
    imported = {name for name, value in vars(ngdgc).items() if isinstance(value, type) or callable(value)}
    assert imported == set(ngdgc.__all__)


def Imported(path, code):
    """Seconds of the processor that `code` takes after NGSolve was imported, and the modules that are there then."""
    script = (f"import time, ngsolve; start = time.process_time(); {code}; print(time.process_time() - start);"
              "import sys; print(*sys.modules)")
    seconds, modules = subprocess.run([sys.executable, "-c", script], cwd=path, capture_output=True, text=True,
                                      check=True).stdout.splitlines()
    return float(seconds), set(modules.split())


@pytest.mark.slow
def test_import_adds_less_than_half_a_second(tmp_path):
    # Time of the processor: other processes of the tests take what they like of the clock's, but also of the caches, so that
    # only the quickest of some runs tells what the import costs.
    assert any(Imported(tmp_path, "import ngdgc")[0] < 0.5 for _ in range(6))


@pytest.mark.slow
def test_import_brings_no_module_that_is_slow_and_rarely_needed(tmp_path):
    slow = {"matplotlib", "scipy.linalg", "scipy.sparse.linalg", "scipy.spatial", "scipy.optimize", "scipy.sparse"}
    assert not slow & Imported(tmp_path, "import ngdgc")[1]
    assert slow & Imported(tmp_path, "import ngdgc.plots")[1]       # control: what is slow is seen


MODULES = [module.name for module in pkgutil.walk_packages(ngdgc.__path__, "ngdgc.") if ".cases" not in module.name]


@pytest.mark.slow
def test_doctests():
    results = [doctest.testmod(importlib.import_module(name)) for name in MODULES]
    assert sum(result.failed for result in results) == 0
    assert sum(result.attempted for result in results) >= 100


def Examples(thing):
    """How many lines of examples the docstrings of a class and its methods, or of a function, have."""
    return sum(len(test.examples) for test in doctest.DocTestFinder().find(thing, "thing"))


def test_every_public_name_has_an_example():
    # What functions return, and NGSolve's own.
    others = {"ContactSolution", "Contraction", "SolveInterrupted", "Solve"}
    assert [name for name in ngdgc.__all__ if name not in others and Examples(getattr(ngdgc, name)) == 0] == []
    assert Examples(Examples) == 0      # control: this function has none


def Blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", (ROOT / "README.md").read_text(), re.S)


def test_script_of_the_readme_runs_and_has_ten_lines(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (script,) = Blocks("python")
    assert len([line for line in script.splitlines() if line.strip()]) == 10
    names = {}
    exec(script, names)
    report = capsys.readouterr().out
    assert "converged" in report and names["solution"].normalforce > 1 and (tmp_path / "deformed.png").stat().st_size > 5000


def test_commands_of_the_readme_are_those_of_the_project():
    run, test = (block.strip() for block in Blocks("sh"))
    assert run == "pip install . && ngdgc run cases/example_4_1.py --method ip --n 16 --order 1 --out results/"
    assert f"'{test}'".replace(".[test]", r".\[test\]") in (ROOT / ".ci" / "run").read_text()


def test_links_of_the_documentation_lead_somewhere():
    links = 0
    for page in [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]:
        for target in re.findall(r"\]\(([^)#]+)\)", page.read_text()):
            if not target.startswith("http"):
                assert (page.parent / target).exists(), f"{page.name} links to {target}"
                links += 1
    assert links >= 8


@pytest.mark.parametrize("name", SOURCES)
def test_modules_are_small(name):
    assert len(SOURCES[name].read_text().splitlines()) <= 300


def test_functions_are_short():
    functions = [(name, node) for name, text in TEXTS.items() for node in ast.walk(ast.parse(text))
                 if isinstance(node, ast.FunctionDef)]
    assert len(functions) > 1000
    assert [f"{name}.{node.name}" for name, node in functions if node.end_lineno - node.lineno >= 50] == []


def test_code_is_clean():
    done = subprocess.run([sys.executable, "-m", "ruff", "check", str(ROOT)], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
