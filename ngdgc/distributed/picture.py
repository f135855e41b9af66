"""The picture of a solution that is spread over the ranks: its displacement on a mesh that every rank can hold."""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import VOL, GridFunction, LinearForm, Mesh, dx
from ngsolve.comp import IntegrationRuleSpace

from ..contracts import Array
from ..discrete.problem import DiscreteProblem
from ..mesh.facets import Coordinates, Facets
from ..mesh.simplices import SimplexMesh
from ..solution.solution import ContactSolution
from .petsc import Summed

MOST = 20_000       # elements of a picture


class Picture:
    """What is known of u for a picture: its values at points of a mesh, the coarse one as often refined as a picture may be.

    Making one takes all ranks; `Solution` does not.
    """

    def __init__(self, solution: Any) -> None:
        disc, local = solution.disc, solution.disc.local
        self.mesh = PictureMesh(disc.mesh)
        space = IntegrationRuleSpace(self.mesh, order=2 * disc.order)
        self.rules = space.GetIntegrationRules()
        at = np.asarray(Coordinates(self.mesh.dim)(self.mesh.MapToAllElements(self.rules, VOL)))
        points = local.mesh(*at.T)
        here = points["nr"] >= 0
        found = np.zeros((len(at), self.mesh.dim + 1))
        # Where elements of two ranks meet both may find it, in the one or the other.
        found[here] = np.column_stack([np.asarray(solution.gfu(points[here])), np.ones(here.sum())])
        total = Summed(disc.mesh.comm, found)
        self.values = total[:, :-1] / total[:, -1:]

    def Solution(self, whole: Any) -> ContactSolution:
        """The projection of u on the space of the picture's mesh, with u and t of the nearest contact points."""
        from scipy.spatial import cKDTree   # slow to import

        with whole.state.Restored():
            disc = DiscreteProblem(whole.disc.problem, whole.disc.method, self.mesh, order=whole.disc.order)
            nearest = np.concatenate([
                one.points.start + cKDTree(whole.points[one.points]).query(disc.contact.coordinates[other.points])[1]
                for one, other in zip(whole.disc.contact.parts, disc.contact.parts)])
            solution = ContactSolution(disc, self._Projected(disc.space), whole.traction[nearest], history=whole.history,
                                       converged=whole.converged, solver=whole.solver)
        solution.__dict__["displacement"] = whole.displacement[nearest]
        solution.case = whole.case
        return solution

    def _Projected(self, space: Any) -> Array:
        """Coefficients (ndof,) of the function of V_h with these values, as the points of the rules see it."""
        v, moments = space.TestFunction(), LinearForm(space)
        at = [GridFunction(IntegrationRuleSpace(self.mesh, order=2 * space.globalorder)) for _ in range(self.mesh.dim)]
        for i, component in enumerate(at):
            component.vec.FV().NumPy()[:] = self.values[:, i]
            moments += component * v[i] * dx(intrules=self.rules)
        moments.Assemble()
        function = GridFunction(space)
        function.vec.data = space.Mass(1).Inverse() * moments.vec
        return function.vec.FV().NumPy().copy()


def PictureMesh(mesh: Any) -> Mesh:
    """The coarse mesh of a DistributedMesh, refined as that is, but to `MOST` elements at most if it has not more itself."""
    facets, coarse = Facets(mesh.coarse), mesh.coarse
    _, regions, corners = facets.boundary
    proper = facets.proper
    found = SimplexMesh(coarse.ngmesh.Coordinates()[:, :mesh.dim], facets.vertices,
                        np.array([element.index + 1 for element in coarse.Elements(VOL)]), coarse.GetMaterials(),
                        corners[proper, :mesh.dim], regions[proper] + 1, coarse.GetBoundaries())
    for _ in range(mesh.refine):
        if found.ne * 2 ** mesh.dim > MOST:
            break
        # Without the geometry, so that elements stay where those of the ranks are.
        found.ngmesh.Refine()
        found = Mesh(found.ngmesh)
    return found
