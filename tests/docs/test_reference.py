"""The reference: every public name, with its line and an example that runs."""

import importlib
import re

import pytest
from pages import PAGES, TOOLS

import ngdgc

PUBLIC = ("ngdgc", "ngdgc.exact", "ngdgc.traces", "ngdgc.meshes", "ngdgc.errors", "ngdgc.plots", "ngdgc.export")
# Of NGSolve, and figures of studies that take a while.
WITHOUT = {"Solve", "AccuracyFigure", "AtlasFigure", "GrowthFigure", "SweepFigure"}
PYTHON = re.compile(r"```python\n(.*?)```", re.S)


def Unlisted(page):
    """Public names that the reference leaves out."""
    listed = {name for _, name in TOOLS["apidoc"].Names(page)}
    return {name for module in PUBLIC for name in TOOLS["apidoc"].PublicNames(module)} - listed


def test_reference_has_every_public_name():
    assert not Unlisted(PAGES["api"])
    assert "UzawaSolver" in Unlisted(PAGES["api"].replace(" UzawaSolver", ""))
    assert "RectangleMesh" in Unlisted(PAGES["api"].replace("% public: ngdgc.meshes", ""))
    assert set(ngdgc.__all__) <= set(TOOLS["apidoc"].PublicNames("ngdgc"))


def test_reference_expands_to_directives_without_repeats():
    page = TOOLS["apidoc"].ExpandMarkers(PAGES["api"])
    entries = re.findall(r"^\.\. auto(?:class|function):: (.*)$", page, re.M)
    assert len(entries) == len(set(entries)) == len(TOOLS["apidoc"].Names(PAGES["api"])) and "% public" not in page


def test_quick_reference_has_every_public_name_with_its_line():
    page = TOOLS["apidoc"].QuickReference(PAGES["api"])
    rows = re.findall(r"^\| \{py:obj\}`(\w+) <([\w.]+)\.\1>` \| (.*) \|$", page, re.M)
    assert [(module, name) for name, module, _ in rows] == TOOLS["apidoc"].Names(PAGES["api"])
    assert all(len(line) > 10 and not line.endswith((" et al", " J")) for *_, line in rows)
    assert all(len(re.split(r"(?<!\\)\|", row)) == 4 for row in page.splitlines() if row.startswith("| {py"))
    assert re.findall(r"^## .*", page, re.M) == re.findall(r"^## .*", PAGES["api"], re.M)
    assert TOOLS["apidoc"].QuickReference("## A\n").strip() == ""
    First = TOOLS["apidoc"].FirstSentence
    assert First(ngdgc.BassiEtAl).startswith("Bassi et al. ")
    assert First(Unlisted) == "Public names that the reference leaves out"


def test_every_name_of_the_reference_has_an_example():
    """In its docstring or above it on the page; those of the studies have their commands."""
    def Without(page):
        shown = "\n".join(PYTHON.findall(page))
        return {name for module, name in TOOLS["apidoc"].Names(page)
                if ">>>" not in (getattr(importlib.import_module(module), name).__doc__ or "") and f"{name}(" not in shown}

    page, studies = PAGES["api"].split("## Studies")
    assert Without(page) == WITHOUT
    assert "Row" in Without(studies) and "WriteVTK" in Without(page.replace("WriteVTK(", "("))         # controls


@pytest.mark.slow
def test_examples_of_the_reference_run(tmp_path, monkeypatch):
    """As those of docstrings do; what they write is there."""
    monkeypatch.chdir(tmp_path)
    for block in PYTHON.findall(PAGES["api"]):
        exec(compile(block, "api.md", "exec"), {})
    assert {"body.html", "body.vtu", "contact.vtu", "meshes.pvd", "contact.csv"} <= {path.name for path in tmp_path.iterdir()}


def test_docstrings_become_restructuredtext():
    ToRst = TOOLS["apidoc"].ToRst
    text = ToRst(["|u|* of `gfu`s.", "", "    a*b = |c|", "", "scale : factor, _x", "    longer", "", ">>> 1 + 1", "2"])
    assert text[0] == r"\|u\|\* of ``gfu``\ s."
    assert ["::", "", "    a*b = |c|"] == text[2:5]
    assert r"* ``scale``: factor, \_x" in text and "  longer" in text
    assert text[text.index(".. code-block:: pycon") + 2] == "    >>> 1 + 1"
    assert ToRst(["Parameters", "----------", "mesh : of NGSolve"])[:3] == ["**Parameters**", "", "* ``mesh``: of NGSolve"]
