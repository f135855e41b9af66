"""What one rank sees: its own elements and some neighbours, as a mesh of NGSolve's."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..contracts import Array
from ..mesh.facets import Facets
from ..mesh.simplices import SimplexMesh
from .petsc import Largest
from .plex import SideCorners

CUT = "between ranks"           # where the layers of neighbours end: facets inside the body
FOREIGN = "of another rank"     # Gamma_C on elements of other ranks


class LocalMesh:
    """Own elements and neighbours of a DMPlex, sorted by their numbers among all ranks, so that bases agree on every rank.

    materials, boundaries : names of regions by number;  contact : numbers of those of Gamma_C

    Attributes
    ----------
    mesh : ngsolve.Mesh;  points : (vertices, d)
    cells, vertices : their numbers among all ranks, ascending;  own, ownvertices : True for those of this rank
    elements : corners (n, d + 1), ascending;  material : their numbers, from 1 on
    sides : corners (s, d) of those of the own elements on the outside;  region : their numbers, from 1 on
    """

    def __init__(self, plex: Any, materials: Sequence[str], boundaries: Sequence[str], contact: Sequence[int]) -> None:
        self.comm, self.dim = plex.comm.tompi4py(), plex.getDimension()
        (c0, c1), (f0, f1), v0 = plex.getHeightStratum(0), plex.getHeightStratum(1), plex.getDepthStratum(0)[0]
        cells, owncells = _Numbers(plex.getCellNumbering())
        vertices, ownvertices = _Numbers(plex.getVertexNumbering())
        sides = np.array([plex.getCone(cell) for cell in range(c0, c1)]).reshape(-1, self.dim + 1) - f0
        corners = SideCorners(plex, self.dim) - v0
        # Every corner of a simplex is on d of its facets.
        elements = np.sort(corners[sides].reshape(len(sides), -1), axis=1)[:, ::self.dim]
        byvertex, bycell = np.argsort(vertices), np.argsort(cells)
        rank = np.argsort(byvertex)
        self.points = plex.getCoordinatesLocal().getArray().reshape(-1, self.dim)[byvertex]
        self.cells, self.own = cells[bycell], owncells[bycell]
        self.vertices, self.ownvertices = vertices[byvertex], ownvertices[byvertex]
        outer = np.bincount(sides.ravel(), minlength=f1 - f0) == 1
        inside = np.zeros(f1 - f0, dtype=np.int64)
        inside[sides.ravel()] = np.repeat(np.arange(len(sides)), self.dim + 1)
        region = np.where(outer, _Labels(plex, "Face Sets", f0, f1), 0)
        region[outer & (region == 0)] = len(boundaries) + 1
        region[np.isin(region, np.asarray(contact) + 1) & ~owncells[inside]] = len(boundaries) + 2
        self.elements, self.material = rank[elements][bycell], _Labels(plex, "Cell Sets", c0, c1)[bycell]
        mine = outer & owncells[inside] & (region <= len(boundaries))
        self.sides, self.region = rank[corners[mine]], region[mine]
        self.mesh = SimplexMesh(self.points, self.elements, self.material, materials, rank[corners], region,
                                [*boundaries, CUT, FOREIGN])


class LocalFacets(Facets):
    """Those of a local mesh: where its layers of neighbours end they are facets inside the body."""

    def __init__(self, local: LocalMesh, frame: Any) -> None:
        super().__init__(local.mesh, frame=frame)
        self.local = local

    @property
    def interior(self) -> np.ndarray:
        return (self.neighbours > 1) | self.On(CUT)

    def Largest(self, values: Array) -> float:
        return Largest(self.local.comm, super().Largest(values))


def _Numbers(numbering: Any) -> tuple[np.ndarray, np.ndarray]:
    """(numbers among all ranks, True for those of this rank); PETSc writes -1 - number for others."""
    numbers = np.array(numbering.getIndices(), dtype=np.int64)
    return np.where(numbers < 0, -1 - numbers, numbers), numbers >= 0


def _Labels(plex: Any, label: str, start: int, end: int) -> np.ndarray:
    """The values of a label, 0 where there is none, for the points from start to end."""
    values = np.zeros(end - start, dtype=np.int64)
    for value in plex.getLabelIdIS(label).getIndices():
        points = plex.getStratumIS(label, int(value)).getIndices()
        points = points[(points >= start) & (points < end)]
        values[points - start] = value
    return values
