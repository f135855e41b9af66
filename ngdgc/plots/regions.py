"""Where boundary regions are: faces of a solid, places for their names, rims of plane cuts, and functions on them."""

from __future__ import annotations

import numpy as np
from ngsolve import BND, VOL, ElementId, GridFunction

from ..contracts import Array
from ..discrete.problem import DiscreteProblem
from ..mesh.checks import Sides
from ..mesh.facets import REFERENCE_VERTICES, Facets

SEEN = 0.1      # cosine to the eye from which a face is seen
ON = 1e-9       # distance of corners from a plane that they lie on, relative to the body


class SurfaceFaces:
    """The straight faces of the boundary of a solid.

    numbers : of the boundary elements (n,);  regions : their names (n,);  corners : n arrays (vertices, 3)
    middles : (n, 3);  normals : outward (n, 3);  areas : of the triangles of three corners, doubled (n,)
    """

    def __init__(self, disc: DiscreteProblem) -> None:
        facets, points = disc.facets, disc.mesh.ngmesh.Coordinates()
        self.numbers = np.flatnonzero(Sides(facets, ".*"))
        outer = (facets.neighbours == 1) & ~facets.cut
        self.numbers = self.numbers[outer[facets.boundary[0][self.numbers]]]
        sides, regions, vertices = (array[self.numbers] for array in facets.boundary)
        self.regions = np.array(disc.mesh.GetBoundaries())[regions]
        self.corners = [points[row[row >= 0]] for row in vertices]
        self.middles = np.array([face.mean(axis=0) for face in self.corners])
        inside = facets.vertices[facets.incidence.indices[facets.incidence.indptr[sides]]]
        centres = np.array([points[row[row >= 0]].mean(axis=0) for row in inside])
        normals = np.array([np.cross(face[1] - face[0], face[2] - face[0]) for face in self.corners])
        normals *= np.sign(np.sum(normals * (self.middles - centres), axis=1))[:, None]
        self.areas = np.linalg.norm(normals, axis=1)
        self.normals = normals / self.areas[:, None]
        self.size = float(np.ptp(points, axis=0).max())

    def Places(self, towards: Array) -> dict[str, tuple[Array, Array]]:
        """{region: (place on it, outward normal there)} of what is seen by an eye in a direction (3,).

        The place is the middle of a face, of that nearest to the centre of all its faces that are turned to the eye.
        """
        places, turned = {}, self.normals @ towards > SEEN
        for name in dict.fromkeys(self.regions[turned].tolist()):
            mine = np.flatnonzero(turned & (self.regions == name))
            centre = np.average(self.middles[mine], axis=0, weights=self.areas[mine])
            nearest = mine[np.linalg.norm(self.middles[mine] - centre, axis=1).argmin()]
            places[name] = self.middles[nearest], self.normals[nearest]
        return places

    def Rims(self, origin: Array, normal: Array) -> dict[str, tuple[Array, Array]]:
        """{region: (pieces (n, 2, 3), outward normals of their faces (n, 3))} where a plane cuts the faces."""
        rims: dict[str, tuple[list[Array], list[Array]]] = {}
        for name, face, outward in zip(self.regions.tolist(), self.corners, self.normals):
            height = (face - origin) @ normal
            height[np.abs(height) < ON * self.size] = ON * self.size
            after, top = np.roll(face, -1, axis=0), np.roll(height, -1)
            across = height * top < 0
            if np.sum(across) == 2:
                share = (height[across] / (height[across] - top[across]))[:, None]
                pieces, normals = rims.setdefault(name, ([], []))
                pieces.append(face[across] + share * (after - face)[across])
                normals.append(outward)
        return {name: (np.array(pieces), np.array(normals)) for name, (pieces, normals) in rims.items()}


def BoundaryFunction(facets: Facets, gfu: GridFunction) -> tuple[list[Array], list[Array]]:
    """(vertices (n, d), one-sided values of gfu there (n, d)) of every boundary element, two lists; NaN beside the body."""
    mesh, corners, values = facets.mesh, [], []
    points = mesh.ngmesh.Coordinates()
    for element in mesh.Elements(BND):
        corners.append(np.array([points[vertex.nr] for vertex in element.vertices]))
        facet = facets.boundary[0][element.nr]
        volumes = facets.incidence.indices[facets.incidence.indptr[facet]:facets.incidence.indptr[facet + 1]]
        volume = mesh[ElementId(VOL, int(volumes[0]))] if len(volumes) else None
        if volume is None or not set(element.vertices) <= set(volume.vertices):
            values.append(np.full(corners[-1].shape, np.nan))
            continue
        trafo = mesh.GetTrafo(ElementId(VOL, volume.nr))
        inside = [REFERENCE_VERTICES[volume.type][list(volume.vertices).index(vertex)] for vertex in element.vertices]
        values.append(np.array([gfu(trafo(*corner)) for corner in inside]))
    return corners, values
