"""Continuous functions cut open along facets: copies of their dofs, one for each side."""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import BND, VOL, Discontinuous, ElementId

from ..mesh.components import Connected
from ..mesh.facets import Facets
from ..tools import sparse as sp


class CutSpace:
    """The functions of a continuous space that may jump across given facets, restricted to those that do not vanish on them.

    space : NGSolve's continuous space;  facets : of the mesh
    held : True for the given facets, inside the body and on its boundary, over facets

    Attributes
    ----------
    broken : the space with copies of all dofs in every element
    dofs : (m,) dof of `space` of which each of the m cut functions is a part
    parts : sparse (broken.ndof, m), the cut functions as sums of element functions

    Elements around a dof lie on one side if facets between them lead from one to the other that are not cut.  At the end of a
    slit nothing is cut.
    """

    def __init__(self, space: Any, facets: Facets, held: Any) -> None:
        self.broken = Discontinuous(space)
        elements, dofs, copies = self._Copies(space, facets, held)
        number = sp.csr_matrix((np.arange(1, len(copies) + 1), (elements, dofs)), shape=(facets.mesh.ne, space.ndof))
        starts = facets.incidence.indptr[:-1][(facets.neighbours > 1) & ~held]
        one, two = (number[facets.incidence.indices[starts + side]] for side in (0, 1))
        common = one.astype(bool).multiply(two.astype(bool))
        pairs = [side.multiply(common).tocsr() for side in (one, two)]
        for side in pairs:
            side.sort_indices()
        part = Connected(len(copies), *(side.data - 1 for side in pairs))
        count = part.max() + 1
        self.parts = sp.csr_matrix((np.ones(len(copies)), (copies, part)), shape=(self.broken.ndof, count))
        self.dofs = np.empty(count, dtype=int)
        self.dofs[part] = dofs

    def Independent(self, clamped: Any) -> Any:
        """True for functions whose jumps are independent, (m,): the parts of a dof that is not clamped add up to no jump.

        clamped : True for the dofs on Gamma_D, over those of the space
        """
        first = np.zeros(len(self.dofs), dtype=bool)
        first[np.unique(self.dofs, return_index=True)[1]] = True
        return clamped[self.dofs] | ~first

    def _Copies(self, space: Any, facets: Facets, held: Any) -> Any:
        """(element, dof, dof in the broken space) of every copy of the dofs that live on the held facets."""
        facet, _, vertices = facets.boundary
        boundary = np.flatnonzero(held[facet])
        live = np.zeros(space.ndof, dtype=bool)
        for number in boundary:
            live[list(space.GetDofNrs(ElementId(BND, int(number))))] = True
        near = np.isin(facets.vertices, np.unique(vertices[boundary][vertices[boundary] >= 0])).any(axis=1)
        columns = []
        for number in np.flatnonzero(near):
            element = ElementId(VOL, int(number))
            here = np.array([list(space.GetDofNrs(element)), list(self.broken.GetDofNrs(element))])
            here = here[:, live[here[0]]]
            columns.append(np.vstack([np.full(here.shape[1], number), here]))
        return np.concatenate(columns, axis=1) if columns else np.zeros((3, 0), dtype=int)
