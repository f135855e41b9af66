"""A coarse mesh as PETSc's DMPlex."""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import VOL, Mesh

from ..mesh.facets import Facets
from .petsc import Petsc


def CoarsePlex(mesh: Mesh, comm: Any) -> Any:
    """A DMPlex of a mesh, all of it on rank 0, with the numbers of regions, from 1 on, as labels."""
    facets, dim = Facets(mesh), mesh.dim
    used, cells = np.unique(facets.vertices, return_inverse=True)
    cells, points = cells.reshape(facets.vertices.shape), mesh.ngmesh.Coordinates()[used, :dim]
    if comm.rank:
        cells, points = cells[:0], points[:0]
    PETSc = Petsc()
    plex = PETSc.DMPlex().createFromCellList(dim, cells.astype(PETSc.IntType), np.ascontiguousarray(points), comm=comm)
    for label in ("Cell Sets", "Face Sets"):
        plex.createLabel(label)
    if comm.rank:
        return plex
    for cell, element in enumerate(mesh.Elements(VOL)):
        plex.setLabelValue("Cell Sets", cell, element.index + 1)
    first, start = plex.getDepthStratum(0)[0], plex.getHeightStratum(1)[0]
    place = {tuple(corners): start + number for number, corners in enumerate(SideCorners(plex, dim) - first)}
    numbers, regions, corners = facets.boundary
    for region, corner in zip(regions[facets.proper], np.sort(np.searchsorted(used, corners[facets.proper, :dim]))):
        plex.setLabelValue("Face Sets", place[tuple(corner)], int(region) + 1)
    return plex


def SideCorners(plex: Any, dim: int) -> np.ndarray:
    """Sorted points of the vertices of all facets of a DMPlex, (facets, d)."""
    cones = np.array([plex.getCone(side) for side in range(*plex.getHeightStratum(1))]).reshape(-1, dim)
    if dim == 2:
        return np.sort(cones, axis=1)
    first, last = plex.getDepthStratum(1)
    ends = np.array([plex.getCone(edge) for edge in range(first, last)]).reshape(-1, 2)
    # Every corner of a triangle is on two of its edges.
    return np.sort(ends[cones - first].reshape(len(cones), 6), axis=1)[:, ::2]
