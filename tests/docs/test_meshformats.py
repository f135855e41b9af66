"""The page that says what of a mesh is kept by each format."""

import importlib
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "docs"))
formats = importlib.import_module("meshformats")


@pytest.mark.slow
def test_table_of_formats_is_what_is_found():
    """As its command writes it; rows of meshio stay, where that is not installed."""
    assert formats.Page() == formats.PAGE.read_text(encoding="utf-8")
    # Controls: nodes in the order of another format, and sides without names.
    mixed = formats.Row("mixed", formats.Text(formats.Sample.Gmsh, "2.2"), ".msh", formats.ABAQUS)
    assert "hex" not in mixed[4] and "tet" not in mixed[5].split(";")[0]
    bare = formats.Row("bare", lambda sample, path: path.write_text(sample.Gmsh("2.2").replace('"bottom"', '"base"')), ".msh")
    assert bare[1] == "no" and bare[2:5] == ("yes", "all", "all")
