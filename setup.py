import re
from fnmatch import fnmatch
from pathlib import Path
from tempfile import TemporaryDirectory

from setuptools import find_packages, setup
from setuptools.command.sdist import sdist

ROOT = Path(__file__).parent
# setuptools installs whatever an earlier build left in its folder, also modules that have moved since: each build has its own.
BUILD = TemporaryDirectory()

# Runs the notebooks of docs/notebooks without a browser.
NOTEBOOK = ["ipykernel", "ipywidgets", "nbclient"]


class SourceArchive(sdist):
    """The packages and all that tests and documentation need, of which setuptools knows nothing; not what git ignores."""

    def make_distribution(self):
        ignored = (ROOT / ".gitignore").read_text().replace("/", "").split()
        for part in ("tests", "docs", ".ci", ".gitignore", ".mypy.ini", ".pytest.ini", ".ruff.toml"):
            for path in [ROOT / part, *(ROOT / part).rglob("*")]:
                name = path.relative_to(ROOT)
                if path.is_file() and not any(fnmatch(piece, pattern) for piece in name.parts for pattern in ignored):
                    self.filelist.append(str(name))
        self.filelist.remove_duplicates()
        super().make_distribution()


setup(
    name="ngdgc",
    version=re.search(r'__version__ = "(.+)"', (ROOT / "ngdgc" / "__init__.py").read_text(encoding="utf-8"))[1],
    description="Discontinuous Galerkin methods for frictional contact with normal compliance, on NGSolve",
    long_description=(ROOT / "README.md").read_text(encoding="utf-8"),
    long_description_content_type="text/markdown",
    license="LGPL-2.1-or-later",
    classifiers=["Development Status :: 4 - Beta", "Environment :: Console", "Framework :: Jupyter",
                 "Intended Audience :: Education", "Intended Audience :: Science/Research",
                 "Operating System :: POSIX :: Linux", "Programming Language :: Python :: 3",
                 "Topic :: Scientific/Engineering :: Mathematics", "Topic :: Scientific/Engineering :: Physics",
                 "Typing :: Typed"],
    python_requires=">=3.10",
    cmdclass={"sdist": SourceArchive},
    options={"build": {"build_base": BUILD.name}},
    # The cases are files to read and run in the repository, and a package so that the installed command finds them anywhere.
    packages=[*find_packages(include=["ngdgc", "ngdgc.*"]), "ngdgc.cases"],
    package_dir={"ngdgc.cases": "cases"},
    package_data={"ngdgc": ["py.typed"], "ngdgc.cases": ["*.step"]},
    # NGSolve 6.2.2604 is the first that brings its own linear algebra: earlier ones take whichever MKL is newest, and fail.
    # webgui_jupyter_widgets carries the viewer's JavaScript, which a page that opens without a network must embed;
    # threadpoolctl keeps BLAS threads out of batches of small matrices.
    # pyamg solves the coarse problem of the iterative inverse; psutil knows how much memory is free.
    install_requires=["ngsolve>=6.2.2604", "numpy", "scipy", "matplotlib", "threadpoolctl>=3", "webgui_jupyter_widgets",
                      "pyamg>=5", "psutil"],
    extras_require={"test": ["pytest", "pytest-xdist>=3.7", "ruff", "mypy", "build", "setuptools>=77", "pyyaml", *NOTEBOOK],
                    "mkl": ["mkl"], "mpi": ["mpi4py", "petsc4py"], "notebook": ["jupyterlab", *NOTEBOOK],
                    "docs": ["sphinx>=8", "myst-nb>=1.4", "furo", "sphinx-design", "sphinx-copybutton",
                             "sphinx-mathjax-offline", *NOTEBOOK]},
    entry_points={"console_scripts": ["ngdgc = ngdgc.cli:Main"]},
)
