"""Tractions on boundaries and interfaces as functions on the facets, and their integrals, for every method."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from ngsolve import BND, FacetFESpace, ElementId, GridFunction

from ..contracts import Array
from ..discrete.problem import DiscreteProblem
from ..mesh.facets import Facets
from ..mesh.quadrature import BoundaryQuadrature
from ..tools import sparse as sp


@dataclass(frozen=True)
class FacetTractions:
    """Tractions on all boundaries and interfaces, normals as `fluxes.Flux` has them.

    function : sigma_hat n in F_h [stress];  forces : its integrals over the facets, (facets, d) [stress length^(d-1)]
    held : of the conforming method a quadrature on the boundary and its weights times the tractions of strongly imposed
        displacements and interfaces, (n, d)
    """

    function: GridFunction
    forces: np.ndarray
    held: tuple[BoundaryQuadrature, Array] | None = None


def NumericalTractions(solution: Any) -> FacetTractions:
    """The numerical flux of a discontinuous method, integrated as its equations do."""
    disc, operators = solution.disc, solution.disc.facetform.operators
    values = solution.flux.vec.FV().NumPy()
    forces, named = np.zeros((len(disc.facets.neighbours), disc.mesh.dim)), disc.facets.On(".*")
    for patch in operators.FacetPatches(named, weak=False):
        inverse = operators.inversemass(patch.sides[0])
        # The first facet function is 1: its products with all of them are a column of the mass.
        integrals = np.linalg.solve(inverse, np.eye(inverse.shape[1])[None, :, :1])
        local = values[operators.FacetDofs(patch.facets)].reshape(len(patch.facets), disc.mesh.dim, -1)
        forces[patch.facets] = (local @ integrals)[..., 0]
    return FacetTractions(solution.flux, forces)


class FacetFunctions:
    """F_h on the boundary elements: its space, dofs and values at the points of a quadrature.

    dofs : (boundary elements, most) scalar dofs, filled up with -1; the first function of every facet is 1
    """

    def __init__(self, facets: Facets, order: int) -> None:
        self.scalar = FacetFESpace(facets.mesh, order=order)
        self.space = self.scalar ** facets.mesh.dim
        found = [self.scalar.GetDofNrs(ElementId(BND, number)) for number in range(len(facets.boundary[0]))]
        self.dofs = np.full((len(found), max(map(len, found))), -1)
        for row, dofs in zip(self.dofs, found):
            row[:len(dofs)] = dofs

    def Values(self, quadrature: BoundaryQuadrature) -> Array:
        """(n, most) values at the n points, 0 for the missing functions."""
        function = GridFunction(self.scalar)
        vector, columns = function.vec.FV().NumPy(), []
        for dofs in self.dofs.T:
            vector[:] = 0
            vector[dofs[dofs >= 0]] = 1
            # Points in one array whose boundary elements lack the function have dofs of no element: zeros.
            columns.append(np.where(dofs[quadrature.boundaryelements] >= 0, np.asarray(function(quadrature.points)).ravel(), 0))
        return np.stack(columns, axis=1)

    def Matrix(self, quadrature: BoundaryQuadrature) -> Any:
        """The values as a sparse matrix (n, scalar dofs)."""
        values, dofs = self.Values(quadrature), self.dofs[quadrature.boundaryelements]
        row = np.broadcast_to(np.arange(len(dofs))[:, None], dofs.shape)
        there = dofs >= 0
        return sp.csr_matrix((values[there], (row[there], dofs[there])), shape=(len(dofs), self.scalar.ndof))


def MeanDisplacement(disc: DiscreteProblem, gfu: Any, region: str) -> Array:
    """The mean of u_h over a region, (d,), of both sides where it lies inside the body."""
    sides = [BoundaryQuadrature.On(disc.facets, region, 2 * disc.order + 2, side=side) for side in (0, 1)]
    return sum(side.weights @ np.asarray(gfu(side.inside)) / (2 * side.weights.sum()) for side in sides)
