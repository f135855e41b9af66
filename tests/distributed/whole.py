"""The mesh of all ranks, put together by the tests themselves, and the numbers that its dofs have there."""

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import BND, Mesh

from ngdgc.mesh.facets import Facets


def Whole(local, comm):
    """On rank 0 the mesh of all ranks, its elements and vertices with the numbers that they have there; else None."""
    mesh, elements = local.mesh, Facets(local.mesh).vertices
    names, bodies = list(mesh.GetBoundaries()), list(mesh.GetMaterials())
    sides = [(side.index, tuple(sorted(int(local.vertices[v.nr]) for v in side.vertices)))
             for side in mesh.Elements(BND) if side.mat not in ("between ranks", "of another rank")]
    material = np.array([element.index for element in mesh.Elements()])
    parts = comm.gather((local.cells[local.own], local.vertices[elements[local.own]], local.vertices, local.points, sides,
                         names, material[local.own]))
    if comm.rank:
        return None
    order = np.argsort(np.concatenate([part[0] for part in parts]))
    cells = np.sort(np.concatenate([part[1] for part in parts])[order], axis=1)
    material = np.concatenate([part[6] for part in parts])[order]
    points = np.zeros((max(part[2].max() for part in parts) + 1, 3))
    for part in parts:
        points[part[2], :local.dim] = part[3]
    corners = points[cells, :local.dim]
    volume = np.linalg.det(corners[:, 1:] - corners[:, :1])
    turned = volume > 0 if local.dim == 3 else volume < 0
    cells[turned, :2] = cells[turned, 1::-1]
    whole = NetgenMesh(dim=local.dim)
    whole.AddPoints(points)
    longest = max((part[5] for part in parts), key=len)
    regions = [whole.AddRegion(name, dim=local.dim - 1) for name in longest]
    for number, region in enumerate(regions):
        rows = sorted({corner for part in parts for index, corner in part[4] if index == number})
        if rows:
            whole.AddElements(dim=local.dim - 1, index=region, data=np.array(rows, dtype=np.int32), base=0)
    for number, name in enumerate(bodies):
        body = whole.AddRegion(name, dim=local.dim)
        if np.any(material == number):
            whole.AddElements(dim=local.dim, index=body, data=cells[material == number].astype(np.int32), base=0)
    return Mesh(whole)


def Order(dim, elements, functions):
    """For each entry in the numbering of all ranks its dof in NGSolve's, with these numbers of elements and of functions."""
    element, component, function = np.indices((elements, dim, functions))
    return ((component * elements + element) * functions + function).ravel()
