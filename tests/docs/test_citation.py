"""docs/CITATION.cff is valid and speaks of this version and of the paper."""

from pathlib import Path

import yaml

import ngdgc

DOCS = Path(__file__).parents[2] / "docs"


def test_citation_is_that_of_the_version_and_of_the_paper():
    text = (DOCS / "CITATION.cff").read_text(encoding="utf-8")
    citation = yaml.safe_load(text)
    assert citation["cff-version"] == "1.2.0" and citation["version"] == ngdgc.__version__
    # CFF 1.2.0 requires these four; an author is a person, or an entity with a name.
    assert {"cff-version", "message", "title", "authors"} <= set(citation)
    assert citation["authors"] == [{"name": "ngdgc developers"}]
    page, paper = (DOCS / "citing.md").read_text(encoding="utf-8").replace("\n> ", " "), citation["preferred-citation"]
    assert paper["doi"] in page and paper["title"] in page and "CITATION.cff" in page
    # A version without three parts would be read as a number.
    assert yaml.safe_load(text.replace(ngdgc.__version__, "0.2"))["version"] == 0.2
