"""Shapes of cells: their sides and edges, and what a file's cells have in common whatever its format.

Corners are numbered as in VTK, Gmsh and Abaqus alike; nodes on edges are not, so each format gives its own edges.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from ...contracts import Array

DIM = {"line": 1, "triangle": 2, "quad": 2, "tet": 3, "hex": 3, "prism": 3, "pyramid": 3}
CORNERS = {"line": 2, "triangle": 3, "quad": 4, "tet": 4, "hex": 8, "prism": 6, "pyramid": 5}

# In the order of Abaqus, which numbers them; corners of a face go round it.
SIDES = {"triangle": ((0, 1), (1, 2), (2, 0)),
         "quad": ((0, 1), (1, 2), (2, 3), (3, 0)),
         "tet": ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)),
         "hex": ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)),
         "prism": ((0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)),
         "pyramid": ((0, 1, 2, 3), (0, 4, 1), (1, 4, 2), (2, 4, 3), (3, 4, 0))}

# Edges of what has the same second order in all formats.
ROUND: dict[str, tuple[tuple[int, int], ...]] = {
    "line": ((0, 1),), "triangle": ((0, 1), (1, 2), (2, 0)), "quad": ((0, 1), (1, 2), (2, 3), (3, 0))}


@dataclass(frozen=True)
class Cell:
    """What a file calls an element: shape, edges that have a node after the corners, and faces that have one after these."""

    shape: str
    edges: tuple[tuple[int, int], ...] = ()
    faces: tuple[tuple[int, ...], ...] = ()

    @property
    def nodes(self) -> int:
        return CORNERS[self.shape] + len(self.edges) + len(self.faces)


@dataclass
class Content:
    """What a file holds.

    points : (n, 3);  blocks : cells of one kind and group, (cell, rows of points (c, nodes), names of the group, maybe none)
    sides : {name: rows of corners}, boundary regions that are not given as cells;
    groups : names that must not be empty, (name, dim)
    """

    points: Array
    blocks: list[tuple[Cell, Array, tuple[str, ...]]]
    sides: dict[str, list[tuple[int, ...]]] = field(default_factory=dict)
    groups: list[tuple[str, int]] = field(default_factory=list)
