"""docs/contributing.md is true: its picture is that of the imports, its walk that of a run, its files and tests are there."""

import ast
import importlib
import re
import sys
from collections import Counter
from itertools import groupby
from pathlib import Path

import pytest
from house import STOREYS

import ngdgc
from ngdgc.cli import Main
from ngdgc.commands import output

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
sys.path.insert(0, str(DOCS))
storeys = importlib.import_module("storeys")
sys.path.remove(str(DOCS))
PAGES = {path.stem: path.read_text(encoding="utf-8") for path in DOCS.glob("*.md")}
PAGE = PAGES["contributing"]


def Section(heading):
    return PAGE.split(f"## {heading}\n")[1].split("\n## ")[0]


@pytest.mark.slow
def test_pictures_of_storeys_and_contracts_are_those_of_the_source():
    assert storeys.Written(PAGE) == PAGE, "run python docs/storeys.py"
    assert storeys.Written(PAGE.replace("`Solver`", "`Solvers`")) == PAGE       # control
    graph = storeys.Graph()
    rank = {name: number for number, name in enumerate(STOREYS)}
    floors = storeys.Floors(graph)
    assert set(graph) == set(STOREYS) - {"__init__", "cases"}
    assert all(floors[lower] < floors[one] and rank[lower] < rank[one] for one in graph for lower in graph[one])
    assert storeys.Floors({**graph, "exceptions": {"meshes"}, "meshes": set(), "tools": set()}) != floors     # control


def Named(text):
    """Files in code marks, as paths from the checkout, and tests as (path, name)."""
    for code in re.findall(r"`([\w./]+(?:::\w+)?)`", text):
        path, _, name = code.partition("::")
        if "/" in path or path.endswith((".py", ".md")):
            yield next((ROOT / base / path for base in ("", "ngdgc") if (ROOT / base / path).exists()), ROOT / path), name


def Lost(text):
    for path, name in Named(text):
        if not path.exists():
            yield path.relative_to(ROOT).as_posix()
        elif name and name not in {node.name for node in ast.parse(path.read_text(encoding="utf-8")).body
                                   if isinstance(node, ast.FunctionDef)}:
            yield name


def test_files_and_tests_of_the_page_exist():
    assert len(list(Named(PAGE))) > 80
    assert set(Lost(PAGE)) <= {"results/docs"}      # made by the build
    assert list(Lost("`methods/row.py`, `tests/methods/test_methods.py::test_patch`")) == ["methods/row.py", "test_patch"]


def test_larger_changes_touch_at_most_five_files():
    table = Section("How to add").split("### On paper\n")[1].splitlines()
    rows = [line.split("|") for line in table if line.startswith("| ")][1:]
    files = {what.strip(): re.findall(r"`(ngdgc/[\w/.]+)`", touched) for _, what, touched, *_ in rows}
    assert {"HDG", "friction with memory", "a new element shape", "assembly on several processes"} <= set(files)
    assert max(map(len, files.values())) <= 5 and sum(map(len, files.values())) > 15


def test_every_formula_is_in_a_module_that_says_so():
    rows = [line for line in Section("Where a formula of the paper is").splitlines() if line.startswith("| ")][1:]
    assert len(rows) > 15 and all(list(Named(row)) for row in rows)


def Stack(last, *command):
    """(module, qualified name) of the package's functions that are at work when one of this qualified name is first called."""
    package, found = Path(ngdgc.__file__).parent, []
    places = {package: "", package.resolve(): "", Path(ngdgc.cases.__path__[0]): "cases.", ROOT / "cases": "cases."}

    def Name(file):
        for folder, prefix in places.items():
            if file.is_relative_to(folder):
                return prefix + ".".join(file.relative_to(folder).with_suffix("").parts)
        return None

    def Profile(frame, event, _):
        if event == "call" and not found and frame.f_code.co_name == last:
            while frame is not None:
                module = Name(Path(frame.f_code.co_filename))
                if module:
                    found.append((module, frame.f_code))
                frame = frame.f_back

    sys.setprofile(Profile)
    try:
        assert Main(list(command)) == 0
    finally:
        sys.setprofile(None)
    return found[::-1]


def Functions(module):
    """{(first line of a function, its name): its qualified name} of a module; of decorated ones the line of the decorator."""
    def Walk(node, prefix):
        for child in ast.iter_child_nodes(node):
            if isinstance(child, (ast.FunctionDef, ast.ClassDef)):
                line = min([child.lineno, *(one.lineno for one in child.decorator_list)])
                yield (line, child.name), prefix + child.name
                yield from Walk(child, f"{prefix}{child.name}.")

    base = ROOT if module.startswith("cases.") else ROOT / "ngdgc"
    return dict(Walk(ast.parse((base / f"{module.replace('.', '/')}.py").read_text(encoding="utf-8")), ""))


def Order(wanted, found):
    """Is one list part of another, in its order?"""
    rest = iter(found)
    return all(one in rest for one in wanted)


def test_walk_of_a_problem_passes_each_storey_once_downwards(tmp_path, monkeypatch, capsys):
    for name in ("SaveResults", "DrawResults"):     # which take longer than all the rest
        monkeypatch.setattr(output, name, lambda *_, **__: None)
    walk = re.findall(r"^\d+\. `([\w.]+)`", Section("The walk of a problem"), re.M)
    assert 5 < len(walk) <= 12
    stack = Stack("Put", "run", "example_4_1", "--n", "2", "--out", str(tmp_path))
    found = [f"{module}.{Functions(module)[code.co_firstlineno, code.co_name]}" for module, code in stack
             if module.split(".")[0] != "tools"]
    assert Order(walk, found), found
    assert not Order(walk[::-1], found)
    passed = [storey for storey, _ in groupby(name.split(".")[0] for name in found)]
    assert Counter(passed).most_common(1)[0][1] == 1, passed
    ranks = [STOREYS.index(storey) for storey in passed]
    assert ranks == sorted(ranks, reverse=True), passed


def PublicNames(text):
    return {node.name for node in ast.parse(text).body
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.name.startswith("_")}


def Recurring(sources):
    """Public names at the top of more than one module, {name: modules}, but for folders that are read module by module."""
    places = {}
    for path, text in sources.items():
        if path.parts[0] not in ("studies", "commands", "exercises", "cases", "cli.py"):
            for name in PublicNames(text):
                places.setdefault(name, []).append(path.as_posix())
    return {name: modules for name, modules in places.items() if len(modules) > 1}


def test_a_public_name_stands_in_one_module():
    package = ROOT / "ngdgc"
    sources = {path.relative_to(package): path.read_text(encoding="utf-8") for path in package.rglob("*.py")}
    assert Recurring(sources) == {}
    assert "Facets" in Recurring({**sources, Path("methods/rows.py"): "class Facets:\n    pass"})


def test_a_study_module_computes_and_says():
    """Whoever has a `Study` has a `Text`, and the other way round, in one module or the modules of one folder."""
    folders = {}
    for path in (ROOT / "ngdgc" / "studies").rglob("*.py"):
        key = path if path.parent.name == "studies" else path.parent
        folders.setdefault(key, set()).update(PublicNames(path.read_text(encoding="utf-8")))
    studies = [names for names in folders.values() if "Study" in names]
    assert len(studies) >= 6 and all("Text" in names for names in studies)


CHANGES = PAGES["changelog"]


def test_changelog_begins_with_what_is_unreleased_and_this_version():
    assert re.findall(r"^## (\S+)", CHANGES, re.M)[:3] == ["Unreleased", ngdgc.__version__, "0.1.0"]


def test_what_moved_is_where_the_changelog_says():
    def There(module):
        path = ROOT / "ngdgc" / module.replace(".", "/")
        return path.with_suffix(".py").exists()

    moves = re.findall(r"^\| `([\w.]+)` \| `([\w.]+)` \|$", CHANGES, re.M)
    assert len(moves) > 100
    assert [new for _, new in moves if not There(new)] == [] and [old for old, _ in moves if There(old)] == []
