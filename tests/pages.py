"""The pages of the documentation, and the scripts that make them."""

import importlib
import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
sys.path.insert(0, str(DOCS))
TOOLS = {name: importlib.import_module(name) for name in ("apidoc", "calculix", "check", "downloads", "galleries", "offline",
                                                             "tables")}
sys.path.remove(str(DOCS))
PAGES = {path.stem: path.read_text(encoding="utf-8") for path in DOCS.glob("*.md")}
CELL = re.compile(r"```\{code-cell\} ipython3\n(?::tags: [^\n]*\n)?(.*?)```", re.S)
