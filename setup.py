import shutil
from pathlib import Path

from setuptools import setup

# setuptools installs whatever an earlier build left here, also modules that have moved since.
shutil.rmtree(Path(__file__).with_name("build"), ignore_errors=True)

# Runs the notebooks of docs/notebooks without a browser.
NOTEBOOK = ["ipykernel", "ipywidgets", "nbclient"]

setup(
    name="ngdgc",
    version="0.1.0",
    description="Discontinuous Galerkin methods for frictional contact with normal compliance, on NGSolve",
    long_description=Path(__file__).with_name("README.md").read_text(encoding="utf-8"),
    long_description_content_type="text/markdown",
    license="LGPL-2.1-or-later",
    python_requires=">=3.10",
    # The cases are files to read and run in the repository, and a package so that the installed command finds them anywhere.
    packages=["ngdgc", "ngdgc.solvers", "ngdgc.plots", "ngdgc.exercises", "ngdgc.cases"],
    package_dir={"ngdgc.cases": "cases"},
    package_data={"ngdgc": ["py.typed"], "ngdgc.cases": ["*.step"]},
    # webgui_jupyter_widgets carries the viewer's JavaScript, which a page that opens without a network must embed;
    # threadpoolctl keeps BLAS threads out of batches of small matrices.
    # pyamg solves the coarse problem of the iterative inverse; psutil knows how much memory is free.
    install_requires=["ngsolve>=6.2.2600", "numpy", "scipy", "matplotlib", "threadpoolctl>=3", "webgui_jupyter_widgets",
                      "pyamg>=5", "psutil"],
    extras_require={"test": ["pytest", "ruff", *NOTEBOOK], "mkl": ["mkl"], "notebook": ["jupyterlab", *NOTEBOOK],
                    "docs": ["sphinx>=8", "myst-nb>=1.4", "furo", "sphinx-design", "sphinx-copybutton",
                             "sphinx-mathjax-offline", *NOTEBOOK]},
    entry_points={"console_scripts": ["ngdgc = ngdgc.cli:Main"]},
)
