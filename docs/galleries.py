"""The gallery: a page for every file of cases/, made by running it.  Sphinx calls `WriteGallery` before it reads the pages."""

import ast
import json
import multiprocessing
import re
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from tables import Escape, Relative, Table

CASES = Path(__file__).parents[1] / "cases"
SECTIONS = ("Question", "Domain", "Problem", "What to look at", "Source")
ASKED = "Ask"           # the last section of a docstring: questions, with which the page ends
FIGURES = {"SettingFigure": "The problem: the body, its supports and loads, and the foundation at its gap.",
           "DeformedFigure": "The deformed body, drawn at {scale:g} times the displacement.",
           "ContactFigure": "Pressure, friction and penetration on the contact boundary.",
           "LawFigure": "Every quadrature point of the contact boundary over the graph of its law: a solution is right where "
                        "the points lie on the curves.",
           "ZonesFigure": "Where the body is free, sticks and slips."}
VISIBLE = 0.05          # of the size of the body: displacements smaller than this are drawn larger
PROCESSES = 2


def CaseFiles():
    """The files of cases/ that have a Main, in the order of their names."""
    return sorted(path for path in CASES.glob("*.py") if not path.stem.startswith("_"))


def WriteGallery(folder):
    """Write index and pages into a folder, those that are older than their case or than ngdgc."""
    import ngdgc

    folder.mkdir(exist_ok=True)
    newest = max(path.stat().st_mtime for path in [*Path(ngdgc.__file__).parent.rglob("*.py"), Path(__file__)])
    files = CaseFiles()
    for page in folder.glob("*.*"):
        if page.name.split(".")[0].partition("-")[0] not in {path.stem for path in files}:
            page.unlink()
    old = [path for path in files if not Fresh(folder / f"{path.stem}.md", max(newest, path.stat().st_mtime))]
    # Processes of their own, as a thread of NGSolve's must not be forked.
    with ProcessPoolExecutor(PROCESSES, mp_context=multiprocessing.get_context("spawn")) as pool:
        list(pool.map(WriteCase, old, [folder] * len(old)))
    (folder / "index.md").write_text(Index(files), encoding="utf-8")


def Fresh(page, newest):
    return page.exists() and page.stat().st_mtime > newest


def Parts(text):
    """The docstring of a case as {"title": first line, section: text}."""
    title, _, rest = text.strip().partition("\n")
    pieces = re.split(rf"^({'|'.join([*SECTIONS, ASKED])}): ", rest, flags=re.M)
    return {"title": title.rstrip("."), **{name: " ".join(piece.split()) for name, piece in zip(pieces[1::2], pieces[2::2])}}


def Questions(parts):
    """What the page of a case asks its reader.

    >>> Questions(Parts("Title.\\n\\nAsk: How deep?  And\\n    how far?"))
    ['How deep?', 'And how far?']
    """
    return re.findall(r"[^?\s][^?]*\?", parts.get(ASKED, ""))


def Index(files):
    lines = ["# Gallery", "", "Every case is one file, which `ngdgc run cases/NAME.py` solves; "
             "these pages are made by running them.", "", "::::{grid} 1 2 3 3", ":gutter: 3", ""]
    for path in files:
        parts = Parts(ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))))
        lines += [f":::{{grid-item-card}} {Escape(parts['title'])}", f":img-top: {path.stem}-DeformedFigure.png",
                  f":link: {path.stem}", ":link-type: doc", "", Escape(parts.get("Question", "")), ":::", ""]
    contents = [f"{path.stem.replace('_', ' ')} <{path.stem}>" for path in files]
    return "\n".join([*lines, "::::", "", "```{toctree}", ":hidden:", "", *contents, "```", ""])


def WriteCase(path, folder):
    """Solve a case with its own defaults; write its pictures, its scene and its page."""
    from ngdgc import plots
    from ngdgc.commands.casefiles import LoadCase
    from ngdgc.export import WriteHTML

    case = LoadCase(path)
    solution = case.Main()
    scale = Scale(solution)
    lines, parts = [], Parts(case.__doc__)
    for name, caption in FIGURES.items():
        if hasattr(plots, name):
            figure = getattr(plots, name)(*([solution.disc] if name == "SettingFigure" else [solution]),
                                          **({"scale": scale} if name == "DeformedFigure" else {}))
            picture = f"{path.stem}-{name}.png"
            figure.savefig(folder / picture, dpi=120)
            lines += [f"```{{figure}} {picture}", f":alt: {name} of {path.stem}", "", caption.format(scale=scale), "```", ""]
    scene = WriteHTML(solution, folder / f"{path.stem}.scene.html", scale=scale)
    lines += ["## In the browser", "", "Drag to turn, roll to zoom; "
              "the menu has the colour range and the scale of the deformation.", "",
              f'<iframe src="{scene.name}" title="displacement of {path.stem}" loading="lazy"></iframe>', ""]
    if hasattr(case, "Compare"):
        compared = [(quantity, float(computed), float(expected)) for quantity, computed, expected in case.Compare(solution)]
        (folder / f"{path.stem}.json").write_text(json.dumps(compared), encoding="utf-8")
        rows = [(quantity, f"{computed:.6g}", f"{expected:.6g}", Relative(computed, expected))
                for quantity, computed, expected in compared]
        lines += ["## Against formula or publication", "",
                  Table(("quantity", "computed", "expected", "difference"), rows).text, ""]
    page = [f"# {Escape(parts['title'])}", ""]
    for name in SECTIONS:
        if name in parts:
            page += [f"**{name}.** {Escape(parts[name])}", ""]
    page += [*lines, "## Run it", "", "```sh",
             f"ngdgc run cases/{path.name} --out results/", "```", "",
             ":::{dropdown} Report", "```text", *solution.Report().splitlines(), "```", ":::", "",
             "```{literalinclude} ../../cases/" + path.name, ":language: python", ":caption: cases/" + path.name, "```", "",
             "## Questions", "", *(f"1. {Escape(question)}" for question in Questions(parts)), ""]
    (folder / f"{path.stem}.md").write_text("\n".join(page), encoding="utf-8")


def Scale(solution):
    """1, or where displacements are too small to be seen the number 1, 2 or 5 times a power of ten that shows them."""
    from ngdgc.mesh.facets import Coordinates, VolumePoints

    mesh = solution.disc.mesh
    points = VolumePoints(mesh, 2)
    size = np.linalg.norm(np.ptp(np.asarray(Coordinates(mesh.dim)(points)), axis=0))
    ratio = VISIBLE * size / np.linalg.norm(np.asarray(solution.gfu(points)), axis=1).max()
    if ratio <= 1:
        return 1
    power = 10.0 ** np.floor(np.log10(ratio))
    return float(power * max(digit for digit in (1, 2, 5) if digit * power <= ratio))
