"""Sphinx: `sphinx-build -W -j 2 docs results/docs` runs every snippet, notebook and case, and needs no network."""

import importlib.util
import os
import sys
from pathlib import Path

DOCS = Path(__file__).parent
sys.path.insert(0, str(DOCS))
# The kernels that run pages find the modules of this folder too; they work in temporary folders.
os.environ["PYTHONPATH"] = os.pathsep.join([str(DOCS), *filter(None, [os.environ.get("PYTHONPATH")])])

import ngdgc  # noqa: E402
from apidoc import ExpandMarkers, QuickReference, ToRst  # noqa: E402
from downloads import Offered  # noqa: E402
from galleries import WriteGallery  # noqa: E402
from offline import CopyMathJax, Finish  # noqa: E402

project = "ngdgc"
author = "the ngdgc developers"
version = release = ngdgc.__version__
copyright = f"{author}, LGPL-2.1-or-later"

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.mathjax", "sphinx_copybutton", "sphinx_design"]
exclude_patterns = ["notebooks/solutions/*", "**/.ipynb_checkpoints"]

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

nb_execution_mode = "force"
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_execution_excludepatterns = ["notebooks/solutions/*"]
nb_merge_streams = True
nb_render_markdown_format = "myst"        # CommonMark has no tables
# No require.js and no widgets from a content delivery network: without them a page would ask for one.
nb_ipywidgets_js = {}

autodoc_member_order = "bysource"
autodoc_typehints = "none"

MATHJAX = Path(importlib.util.find_spec("sphinx-mathjax-offline").origin).parent / "static" / "mathjax"
mathjax_path = "mathjax/tex-chtml.js"
mathjax3_config = {"options": {"enableMenu": False}}

# Quotation marks of formulas and code in docstrings stay as typed.
smartquotes = False

html_theme = "furo"
html_title = f"ngdgc {release}"
html_static_path = ["_static"]
html_css_files = ["ngdgc.css"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"sidebar_hide_name": False}


def Docstring(app, what, name, object, options, lines):
    """Docstrings are plain text with formulas as typed; autodoc wants reStructuredText."""
    lines[:] = ToRst(lines)


def Source(app, name, source):
    """Markers of the reference become its entries, and notebooks offer their files."""
    if name == "api":
        source[0] = ExpandMarkers(source[0])
    elif name == "quick":
        source[0] += QuickReference((DOCS / "api.md").read_text(encoding="utf-8"))
    file = Path(app.env.doc2path(name))
    if file.suffix == ".ipynb":
        source[0] = Offered(source[0], file.name)


def setup(app):
    app.connect("builder-inited", lambda app: WriteGallery(DOCS / "gallery"))
    app.connect("builder-inited", lambda app: CopyMathJax(MATHJAX, Path(app.outdir) / "_static" / "mathjax"))
    app.connect("source-read", Source)
    app.connect("autodoc-process-docstring", Docstring)
    app.connect("build-finished", lambda app, error: error or Finish(Path(app.outdir), DOCS / "gallery"))
