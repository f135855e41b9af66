"""Meshes of triangles or tetrahedra from arrays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import Mesh

from ..contracts import Array


def SimplexMesh(points: Array, elements: np.ndarray, material: np.ndarray, materials: Sequence[str], sides: np.ndarray,
                region: np.ndarray, boundaries: Sequence[str]) -> Mesh:
    """NGSolve's mesh of points (m, d), corners of elements (n, d + 1) and of their sides on boundaries (s, d).

    material, region : numbers of the elements and sides among the names, from 1 on.  Elements are turned as Netgen has them.
    """
    dim, elements = points.shape[1], elements.copy()
    corners = points[elements]
    volume = np.linalg.det(corners[:, 1:] - corners[:, :1])
    turned = volume > 0 if dim == 3 else volume < 0        # Netgen's tetrahedra are mirrored
    elements[turned, :2] = elements[turned, 1::-1]
    mesh = NetgenMesh(dim=dim)
    mesh.AddPoints(np.pad(points, ((0, 0), (0, 3 - dim))))
    for size, names, parts, number in ((dim - 1, boundaries, sides, region), (dim, materials, elements, material)):
        for index in [mesh.AddRegion(name, dim=size) for name in names]:
            rows = parts[number == index]
            if len(rows):
                mesh.AddElements(dim=size, index=index, data=np.ascontiguousarray(rows, dtype=np.int32), base=0)
    return Mesh(mesh)
