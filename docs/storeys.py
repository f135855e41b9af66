"""The picture of the storeys in contributing.md, from the imports of the package: `python docs/storeys.py` writes it anew."""

import ast
from pathlib import Path

DOCS = Path(__file__).parent
PACKAGE = DOCS.parent / "ngdgc"
BEGIN, END = "<!-- storeys: written by `python docs/storeys.py` -->\n", "<!-- end of storeys -->\n"


def Storey(path):
    """The part of the package a file belongs to: a folder, or a module beside the folders."""
    return path.relative_to(PACKAGE).with_suffix("").parts[0]


def Imported(path):
    """Storeys that a file imports, anywhere in it; of `from .. import meshes` the module, not the package."""
    own = ["ngdgc", *path.relative_to(PACKAGE).parts[:-1]]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level:
            parts = [*own[1:len(own) + 1 - node.level], *(node.module or "").split(".")]
            parts = [part for part in parts if part]
            yield from parts[:1] or (alias.name for alias in node.names)


def Sources():
    return {path for path in PACKAGE.rglob("*.py") if Storey(path) not in ("__init__", "cases")}


def Graph():
    """{storey: storeys that it imports}, without what users' doors and cases import."""
    storeys, graph = {Storey(path) for path in Sources()}, {}
    for path in Sources():
        graph.setdefault(Storey(path), set()).update(set(Imported(path)) & storeys - {Storey(path)})
    return graph


def Below(graph, storey):
    """All that a storey stands on, also by others."""
    return graph[storey] | {lower for one in graph[storey] for lower in Below(graph, one)}


def Floors(graph):
    """{storey: its floor}: 0 on the ground, else one above the highest it stands on."""
    floors = {}

    def Floor(storey):
        if storey not in floors:
            floors[storey] = 1 + max(map(Floor, graph[storey]), default=-1)
        return floors[storey]

    for storey in graph:
        Floor(storey)
    return floors


def Says(storey):
    """The first sentence of what is said there."""
    path = PACKAGE / storey / "__init__.py"
    text = ast.get_docstring(ast.parse((path if path.exists() else path.parent.with_suffix(".py")).read_text(encoding="utf-8")))
    return text.split("\n\n")[0].replace("\n", " ").split(". ")[0].rstrip(".")


def Picture():
    """The table, the top floor first; of what a storey stands on, only what nothing else of it stands on.

    >>> "| `solvers/` |" in Picture()
    True
    """
    graph = Graph()
    floors = Floors(graph)
    lines = ["| floor | storey | what is there | stands on |", "|---|---|---|---|"]
    for storey in sorted(graph, key=lambda one: (-floors[one], one)):
        implied = {lower for one in graph[storey] for lower in Below(graph, one)}
        folder = f"`{storey}/`" if (PACKAGE / storey).is_dir() else f"`{storey}.py`"
        direct = ", ".join(sorted(graph[storey] - implied, key=lambda one: (-floors[one], one)))
        lines.append(f"| {floors[storey]} | {folder} | {Says(storey)} | {direct or 'the ground'} |")
    return "\n".join(lines) + "\n"


def Written(page):
    """A page with the picture as it is now."""
    before, rest = page.split(BEGIN)
    return before + BEGIN + "\n" + Picture() + "\n" + END + rest.split(END)[1]


if __name__ == "__main__":
    page = DOCS / "contributing.md"
    page.write_text(Written(page.read_text(encoding="utf-8")), encoding="utf-8")
