"""The package: installed, layered, quick to import, quiet about NGSolve's names, its README and doctests true."""

import ast
import doctest
import importlib
import pkgutil
import re
import subprocess
import sys
from pathlib import Path

import pytest

import ngdgc

ROOT = Path(__file__).parents[1]
SOURCES = {path.relative_to(ROOT / "ngdgc").with_suffix("").as_posix().replace("/", "."): path
           for path in (ROOT / "ngdgc").rglob("*.py")}
# Who may import whom: only from lines above.
LAYERS = [["arguments", "console", "exceptions", "formula", "history", "interfaces", "parallel", "peers", "protocols",
           "signals", "tables"],
          ["files", "memory", "names", "report", "values"], ["kinds"], ["calls", "regions", "userlaws"],
          ["inside"], ["casefiles", "coefficients", "derivatives"],
          ["hypotheses"], ["elasticity", "laws"], ["foundation"],
          ["problem", "facets"], ["meshchecks", "state"], ["meshes", "quadrature", "added", "equations"], ["storage"],
          ["shapes", "pattern", "skeleton", "contact", "motions", "validation", "restraints", "stability"],
          ["geometry", "skeletonlifting"], ["cells"], ["patches"], ["operators"], ["lifting", "penalty", "facetform"],
          ["cycles"], ["methods", "solenoidal"],
          ["preconditioner"], ["iterative"], ["inverses"], ["discretization"], ["graph"],
          ["fluxes", "tractions", "cuts", "vtkfiles"], ["conformingtractions"],
          ["forces", "resultants", "compliance", "coarsening", "subspace", "fingerprint"], ["archive"], ["solution"],
          ["solvers.driver", "solvers.equation", "solvers.holding", "solvers.recycling", "solvers.stiffness"],
          ["solvers.reduced"],
          ["solvers.contraction", "solvers.pathfollowing", "solvers.steps"],
          ["solvers.uzawa", "solvers.newtonrun"], ["solvers.correction"], ["solvers.newton"], ["solvers.multistart"],
          ["solvers.nested"],
          ["solvers.__init__"], ["uniqueness"], ["__init__"],
          ["exact", "export", "plots.curves", "randomproblems",
           "variants"], ["errors", "plots.canvas", "traces"], ["lemmas"], ["consistency"],
          ["plots.solid"], ["plots.contact", "plots.deformed", "plots.history", "plots.setting", "plots.studies",
           "plots.atlas", "plots.sweep", "plots.bench", "plots.law", "plots.zones"], ["plots.comparison"],
          ["plots.__init__"],
          ["hostile", "targets"], ["attack"],
          ["atlas"], ["bench"],
          ["accuracy", "atlaspage", "benchassembly", "benchpage", "convergence", "grid", "locking", "output",
           "stabilitystudy", "sweep", "table3"],
          ["studies"], ["attackcommand", "benchcommands", "comparecommand"], ["cli"], ["exercises.checker"],
          ["exercises.winkler", "exercises.spaces", "exercises.fluxes", "exercises.liftings", "exercises.iteration",
           "exercises.newton", "exercises.table", "exercises.rigid", "exercises.locking", "exercises.law"],
          ["exercises.__init__"]]


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


def Imports(name):
    """Modules of ngdgc that a module imports, anywhere in it."""
    package = name.split(".")[:-1]
    tree = ast.parse(SOURCES[name].read_text())
    # What only type checkers read imports nothing.
    tree.body = [node for node in tree.body if not (isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING")]
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = package[:len(package) - node.level + 1]
            if node.module:
                yield ".".join([*base, *node.module.split(".")])
            else:
                yield from (".".join([*base, alias.name]) for alias in node.names if alias.name != "__version__")


def test_imports_point_downwards():
    rank = {name: number for number, layer in enumerate(LAYERS) for name in layer}
    assert set(rank) == set(SOURCES)
    seen = 0
    for name in SOURCES:
        for imported in Imports(name):
            if imported.split(".")[0] == "cases":
                continue
            target = imported if imported in rank else f"{imported}.__init__"
            assert rank[target] < rank[name], f"{name} imports {target}"
            seen += 1
    assert seen > 50


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


def test_import_adds_less_than_half_a_second(tmp_path):
    # Time of the processor: other processes of the tests take what they like of the clock's.
    code = ("import time, ngsolve; start = time.process_time(); import ngdgc; print(time.process_time() - start);"
            "import sys; print('matplotlib' in sys.modules)")
    command = [sys.executable, "-c", code]
    runs = [subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True).stdout.split() for _ in range(3)]
    assert min(float(seconds) for seconds, _ in runs) < 0.5
    assert all(loaded == "False" for _, loaded in runs)


MODULES = [module.name for module in pkgutil.walk_packages(ngdgc.__path__, "ngdgc.") if ".cases" not in module.name]


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


def test_code_is_clean():
    done = subprocess.run([sys.executable, "-m", "ruff", "check", str(ROOT)], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
