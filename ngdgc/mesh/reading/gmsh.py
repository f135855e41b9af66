"""Files of Gmsh (.msh), formats 2.2 and 4.1 in ASCII: physical groups are regions, whatever their names."""

from __future__ import annotations

import re
from collections import defaultdict

import numpy as np

from ...contracts import Array
from ...exceptions import ProblemError
from .shapes import ROUND, Cell, Content

TET = (0, 1), (1, 2), (2, 0), (3, 0), (2, 3), (1, 3)
HEX = (0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)
PRISM = (0, 1), (0, 2), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5)
PYRAMID = (0, 1), (0, 3), (0, 4), (1, 2), (1, 4), (2, 3), (2, 4), (3, 4)
# With a node on every quadrilateral, and one in the middle of a hexahedron.
HEXFACES = (0, 3, 2, 1), (0, 1, 5, 4), (0, 4, 7, 3), (1, 2, 6, 5), (2, 3, 7, 6), (4, 5, 6, 7), tuple(range(8))
PRISMFACES = (0, 1, 4, 3), (0, 3, 5, 2), (1, 2, 5, 4)
# By Gmsh's numbers.
CELLS = {1: Cell("line"), 2: Cell("triangle"), 3: Cell("quad"), 4: Cell("tet"), 5: Cell("hex"), 6: Cell("prism"),
         7: Cell("pyramid"), 8: Cell("line", ROUND["line"]), 9: Cell("triangle", ROUND["triangle"]),
         16: Cell("quad", ROUND["quad"]), 10: Cell("quad", ROUND["quad"], ((0, 1, 2, 3),)), 11: Cell("tet", TET),
         12: Cell("hex", HEX, HEXFACES), 13: Cell("prism", PRISM, PRISMFACES), 14: Cell("pyramid", PYRAMID, ((0, 1, 2, 3),)),
         17: Cell("hex", HEX), 18: Cell("prism", PRISM), 19: Cell("pyramid", PYRAMID)}
POINT = 15

Rows = dict[tuple[int, tuple[str, ...]], list[list[int]]]


def ReadGmsh(text: str, file: str) -> Content:
    """What a file of Gmsh holds; ProblemError if it is binary, of another format, or ends early."""
    sections = dict(re.findall(r"^\$(\w+)\s*\n(.*?)^\$End\1", text, flags=re.DOTALL | re.MULTILINE))
    version, binary = (sections.get("MeshFormat", "").split() + ["", ""])[:2]
    if version not in ("2.2", "4.1") or binary != "0" or not {"Nodes", "Elements"} <= set(sections):
        raise ProblemError(f"{file} is no mesh of Gmsh in ASCII, format 2.2 or 4.1, with nodes and elements; write it anew, "
                           "with Mesh.MshFileVersion = 4.1 and Mesh.Binary = 0")
    names = {(int(dim), int(tag)): name for dim, tag, name
             in re.findall(r'^\s*(\d)\s+(\d+)\s+"(.*)"', sections.get("PhysicalNames", ""), flags=re.MULTILINE)}
    try:
        numbers, points, rows = (_Old if version == "2.2" else _New)(sections, names)
        place = {number: row for row, number in enumerate(numbers.tolist())}
        blocks = list[tuple[Cell, Array, tuple[str, ...]]]()
        for (kind, group), found in rows.items():
            if kind != POINT:
                cell = _Cell(kind, file)
                nodes = [[place[number] for number in row] for row in found]
                blocks.append((cell, np.reshape(nodes, (len(nodes), cell.nodes)), group))
    except ProblemError:        # a ValueError, too
        raise
    except (ValueError, IndexError, KeyError) as error:
        raise ProblemError(f"{file} is cut off or has wrong numbers ({error}); write it anew") from error
    return Content(points, blocks, groups=[(name, dim) for (dim, _), name in names.items()])


def _Cell(kind: int, file: str) -> Cell:
    if kind not in CELLS:
        raise ProblemError(f"{file} has elements of Gmsh's type {kind}; first and second order are read: set "
                           "Mesh.ElementOrder to 1 or 2")
    return CELLS[kind]


def _Name(names: dict[tuple[int, int], str], dim: int, tag: int) -> tuple[str, ...]:
    return (names.get((dim, abs(tag)), f"group{abs(tag)}"),) if tag else ()


def _Sorted(nodes: list[list[float]]) -> tuple[np.ndarray, np.ndarray]:
    table = np.array(nodes, dtype=float)
    table = table[np.argsort(table[:, 0], kind="stable")]
    return table[:, 0].astype(np.int64), table[:, 1:4]


def _Dim(kind: int) -> int:
    return 0 if kind == POINT else {"line": 1, "triangle": 2, "quad": 2}.get(CELLS[kind].shape, 3) if kind in CELLS else 3


def _Old(sections: dict[str, str], names: dict[tuple[int, int], str]) -> tuple[np.ndarray, np.ndarray, Rows]:
    """(numbers of nodes, points, rows of nodes by kind and group) of format 2.2, with a cell once in every group."""
    numbers, points = _Sorted([[float(word) for word in line.split()] for line in sections["Nodes"].splitlines()[1:]])
    cells: dict[tuple[int, ...], list[str]] = defaultdict(list)
    for line in sections["Elements"].splitlines()[1:]:
        _, kind, tags, *rest = (int(word) for word in line.split())
        cells[(kind, *rest[tags:])] += _Name(names, _Dim(kind), rest[0] if tags else 0)
    rows: Rows = defaultdict(list)
    for (kind, *nodes), group in cells.items():
        rows[kind, tuple(dict.fromkeys(group))].append(nodes)
    return numbers, points, rows


def _New(sections: dict[str, str], names: dict[tuple[int, int], str]) -> tuple[np.ndarray, np.ndarray, Rows]:
    """The same of format 4.1, where entities of the geometry are in groups."""
    groups: dict[tuple[int, int], tuple[str, ...]] = {}
    if "Entities" in sections:
        head, *lines = sections["Entities"].splitlines()
        dims = [dim for dim, count in enumerate(head.split()) for _ in range(int(count))]
        for dim, line in zip(dims, lines):
            words = line.split()
            first = 4 if dim == 0 else 7
            tags = [int(tag) for tag in words[first + 1:first + 1 + int(words[first])]]
            groups[dim, int(words[0])] = sum((_Name(names, dim, tag) for tag in tags), ())
    nodes, rest = list[list[float]](), iter(sections["Nodes"].splitlines()[1:])
    for line in rest:
        numbered = [float(next(rest, "")) for _ in range(int(line.split()[3]))]
        nodes += [[number, *(float(word) for word in next(rest, "").split()[:3])] for number in numbered]
    rows: Rows = defaultdict(list)
    rest = iter(sections["Elements"].splitlines()[1:])
    for line in rest:
        dim, entity, kind, count = (int(word) for word in line.split())
        rows[kind, groups.get((dim, entity), ())] += [[int(word) for word in next(rest, "").split()[1:]] for _ in range(count)]
    numbers, points = _Sorted(nodes)
    return numbers, points, rows
