"""What contributing.md tells of the source: the storeys, from the imports, and the contracts: `python docs/storeys.py`."""

import ast
from pathlib import Path

DOCS = Path(__file__).parent
PACKAGE = DOCS.parent / "ngdgc"
BEGIN, END = "<!-- {}: written by `python docs/storeys.py` -->\n", "<!-- end of {} -->\n"


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


def Contracts():
    """The table of the Protocols."""
    lines = ["| contract | is |", "|---|---|"]
    for node in ast.parse((PACKAGE / "contracts.py").read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ClassDef):
            lines.append(f"| `{node.name}` | {' '.join(ast.get_docstring(node).split(chr(10) * 2)[0].split()).rstrip('.')} |")
    return "\n".join(lines) + "\n"


def Written(page):
    """A page with both as they are now."""
    for name, made in (("storeys", Picture()), ("contracts", Contracts())):
        begin, end = BEGIN.format(name), END.format(name)
        before, rest = page.split(begin)
        page = before + begin + "\n" + made + "\n" + end + rest.split(end)[1]
    return page


if __name__ == "__main__":
    page = DOCS / "contributing.md"
    page.write_text(Written(page.read_text(encoding="utf-8")), encoding="utf-8")
