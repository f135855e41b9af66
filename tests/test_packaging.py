"""Source archive and wheel: built, installed where no source is, run there by their installed names; what they state."""

import ast
import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import venv
from importlib import metadata
from pathlib import Path
from zipfile import ZipFile

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

import ngdgc

ROOT = Path(__file__).parents[1]
NAME = f"ngdgc-{ngdgc.__version__}"


def Files(*parts):
    """Files of these parts of the repository, without what running Python leaves there."""
    return {path.relative_to(ROOT).as_posix() for part in parts for path in [ROOT / part, *(ROOT / part).rglob("*")]
            if path.is_file() and "__pycache__" not in path.parts}


def ImportAll():
    """A program that imports every module of the repository and says where it is."""
    names = [name.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
             for name in [*Files("ngdgc"), *(f"ngdgc/{case}" for case in Files("cases"))] if name.endswith(".py")]
    assert len(names) > 80
    return f"import importlib\nfor name in {names}:\n    print(importlib.import_module(name).__file__)"


def Run(*command, cwd, **environment):
    return subprocess.run([*map(str, command)], capture_output=True, text=True, cwd=cwd, env={**os.environ, **environment})


def Build(source, out, *options):
    # Without isolation: the tests bring their setuptools, and need no network.
    done = Run(sys.executable, "-m", "build", "--no-isolation", *options, "--outdir", out, source, cwd=out.parent)
    assert done.returncode == 0, done.stdout + done.stderr
    return out


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """A copy of the repository, in which other work has left its traces."""
    copy = tmp_path_factory.mktemp("source") / "ngdgc"
    shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(".git", ".venv*", "build", "dist", "results", "*.egg-info"))
    for left in ("docs/_build/page.html", "tests/__pycache__/test_laws.pyc", "build/lib/ngdgc/moved.py"):
        (copy / left).parent.mkdir(parents=True, exist_ok=True)
        (copy / left).write_text("")
    return copy


@pytest.fixture(scope="module")
def archives(source):
    """Folder of the source archive, and of the wheel that is made from it alone."""
    return Build(source, source.parent / "dist")


@pytest.fixture(scope="module")
def wheel(archives):
    return archives / f"{NAME}-py3-none-any.whl"


@pytest.fixture(scope="module")
def scripts(wheel, tmp_path_factory):
    """Folder of the commands of a fresh environment with the wheel; what it builds on is that of the tests' environment."""
    folder = tmp_path_factory.mktemp("environment")
    venv.create(folder)
    purelib, commands = (Path(sysconfig.get_path(name, "posix_prefix", vars={"base": str(folder), "platbase": str(folder)}))
                         for name in ("purelib", "scripts"))
    done = Run(sys.executable, "-m", "pip", "--python", commands / "python", *"install --no-deps --no-index".split(), wheel,
               cwd=folder)
    assert done.returncode == 0, done.stderr
    (purelib / "outer.pth").write_text(sysconfig.get_path("purelib"))
    return commands


def Contents(wheel):
    """Files that a wheel must have, and those it has."""
    with ZipFile(wheel) as archive:
        found = {name for name in archive.namelist() if ".dist-info/" not in name}
    return Files("ngdgc") | {f"ngdgc/{name}" for name in Files("cases")}, found


@pytest.mark.slow
def test_wheel_has_the_files_of_the_packages_and_no_others(wheel):
    wanted, found = Contents(wheel)
    assert found == wanted
    assert {"ngdgc/py.typed", "ngdgc/cases/example_4_1.py", "ngdgc/exercises/__init__.py"} < found


@pytest.mark.slow
def test_a_package_that_setup_forgets_is_noticed(source, wheel, tmp_path):
    """Also by the imports: ngdgc in the environment of the tests does not help out the one before it on the path."""
    forgetful = shutil.copytree(source, tmp_path / "forgetful")
    text = (source / "setup.py").read_text()
    (forgetful / "setup.py").write_text(text.replace("find_packages(", 'find_packages(exclude=["ngdgc.solvers*"], '))
    (broken,) = Build(forgetful, tmp_path / "dist", "--wheel").glob("*.whl")
    wanted, found = Contents(broken)
    assert found < wanted and {name.split("/")[1] for name in wanted - found} == {"solvers"}
    runs = {}
    for path in (wheel, broken):
        folder = tmp_path / path.parent.parent.name
        ZipFile(path).extractall(folder)
        runs[path] = Run(sys.executable, "-c", ImportAll(), cwd=folder, PYTHONPATH=str(folder))
    assert runs[wheel].returncode == 0, runs[wheel].stderr
    assert runs[broken].returncode != 0 and "No module named 'ngdgc.solvers'" in runs[broken].stderr


@pytest.mark.slow
def test_everything_installed_can_be_imported_where_no_source_is(scripts, tmp_path):
    done = Run(scripts / "python", "-c", ImportAll(), cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert all(Path(place).is_relative_to(scripts.parent) for place in done.stdout.splitlines())


@pytest.mark.slow
def test_installed_command_runs_an_installed_case(scripts, tmp_path):
    done = Run(scripts / "ngdgc", "cases", cwd=tmp_path)
    assert {line.split()[0] for line in done.stdout.splitlines()} == {path.stem for path in (ROOT / "cases").glob("*.py")}
    done = Run(scripts / "ngdgc", *"run example_4_1 --method ldg --n 2 --out results".split(), cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads((tmp_path / "results" / "report.json").read_text())["converged"] is True
    assert "<script" in (tmp_path / "results" / "solution.html").read_text()
    assert Run(scripts / "ngdgc", "run", "example_4_9", cwd=tmp_path).returncode == 2


@pytest.mark.slow
def test_source_archive_has_what_its_tests_and_documentation_need(archives, tmp_path):
    with tarfile.open(archives / f"{NAME}.tar.gz") as archive:
        names = {name.removeprefix(f"{NAME}/") for name in archive.getnames()}
        archive.extractall(tmp_path)
    settings = ".ruff.toml", ".pytest.ini", ".mypy.ini"
    assert Files("ngdgc", "cases", "tests", ".ci", "setup.py", "README.md", "LICENSE", *settings) <= names
    assert {name for name in Files("docs") if "_build" not in name} <= names
    assert not [name for name in names if "_build" in name or name.endswith(".pyc") or "moved" in name]
    # Its tests run, those too that read pages and commands, as README.md says: against the installed package.
    script = Path(sys.executable).with_name("pytest")
    tests = ["tests/problem/test_laws.py", "tests/test_package.py", "-k",
             "laws or links or commands or (small and not test_code)"]
    done = Run(script, "-q", "-n", "0", *tests, cwd=tmp_path / NAME)
    assert done.returncode == 0 and int(re.search(r"(\d+) passed", done.stdout)[1]) > 50, done.stdout
    (tmp_path / NAME / "docs" / "theory.md").unlink()
    assert "1 failed" in Run(script, "-q", "-n", "0", *tests, cwd=tmp_path / NAME).stdout


@pytest.mark.slow
def test_version_is_the_same_wherever_it_is_asked(scripts, wheel, tmp_path):
    asked = "from importlib.metadata import version; import ngdgc; print(version('ngdgc'), ngdgc.__version__)"
    assert Run(scripts / "python", "-c", asked, cwd=tmp_path).stdout.split() == [ngdgc.__version__] * 2
    assert Run(scripts / "ngdgc", "--version", cwd=tmp_path).stdout.split() == ["ngdgc", ngdgc.__version__]
    # One place states it.
    assert [path for path in [ROOT / "setup.py", *(ROOT / "ngdgc").rglob("*.py")]
            if f'"{ngdgc.__version__}"' in path.read_text()] == [ROOT / "ngdgc" / "__init__.py"]


@pytest.mark.slow
def test_metadata_says_what_a_user_must_know(wheel):
    with ZipFile(wheel) as archive:
        names = archive.namelist()
        (path,) = (name for name in names if name.endswith("/METADATA"))
        text = archive.read(path).decode()
    fields, _, description = text.partition("\n\n")
    assert any("LICENSE" in name for name in names) and "LGPL-2.1-or-later" in fields
    assert description.strip() == (ROOT / "README.md").read_text().strip()
    assert "http" not in fields
    supported = re.search(r"verified on \| (.*)", description)[1]
    oldest = re.search(r"Requires-Python: >=(\S+)", fields)[1], re.search(r"ngsolve>=(\S+)", fields)[1]
    assert re.search(rf"Python {oldest[0]} .*NGSolve {oldest[1]} ", supported), f"setup.py has {oldest}, the README {supported}"


def Brought(requirements, seen):
    """Names of all distributions that these requirements bring, one by the other."""
    for requirement in map(Requirement, requirements):
        name = canonicalize_name(requirement.name)
        if name not in seen and (requirement.marker is None or requirement.marker.evaluate({"extra": ""})):
            seen.add(name)
            Brought(metadata.requires(name) or [], seen)
    return seen


def Foreign(ranks=False):
    """Top-level names that the storey of ranks, or all others, import; without the peers, which any interpreter runs."""
    paths = [*(ROOT / "ngdgc").rglob("*.py"), *(ROOT / "cases").glob("*.py")]
    for path in [path for path in paths if (ROOT / "ngdgc" / "distributed" in path.parents) == ranks]:
        for node in ast.walk(ast.parse(path.read_text())) if path.name != "peers.py" else ():
            if isinstance(node, ast.Import):
                yield from (alias.name.split(".")[0] for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and not node.level:
                yield node.module.split(".")[0]


def test_requirements_bring_all_that_is_imported():
    providers = metadata.packages_distributions()
    foreign = set(Foreign()) - set(sys.stdlib_module_names) - {"ngdgc"}
    # What the storey of ranks imports beside is an extra, which is not installed here.
    extra = {Requirement(line).name for line in metadata.requires("ngdgc") if re.search("extra == .mpi.", line)}
    assert set(Foreign(ranks=True)) - set(sys.stdlib_module_names) - foreign == extra == {"mpi4py", "petsc4py"}
    required = [line for line in metadata.requires("ngdgc") if "extra ==" not in line]

    def Unmet(requirements):
        brought = Brought(requirements, set())
        return {name for name in foreign if not brought & {canonicalize_name(one) for one in providers.get(name, [])}}

    assert len(foreign) >= 6 and Unmet(required) == set()
    assert Unmet([line for line in required if "pyamg" not in line]) == {"pyamg"}
