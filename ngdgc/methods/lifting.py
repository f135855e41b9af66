"""The liftings r_0 and r_e of (3.2)-(3.4), as sparse operators and as functions in Q_h.

    int_Omega r_0(phi):q = - int_E0 phi:{q},     int_Omega r_e(phi):q = - int_e phi:{q},     r_0 = sum_e r_e
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import cached_property
from typing import Any, cast

import numpy as np
from ngsolve import GridFunction

from ..blocks.batches import FacetPatch
from ..blocks.integrals import ElementGroup
from ..blocks.matrix import Numbers
from ..blocks.operators import FacetOperators
from ..contracts import Array
from ..exceptions import ProblemError
from ..linear.equations import CheckDiscretization
from ..mesh.facets import Facets
from ..problem.problem import ContactProblem
from ..tools import sparse as sp
from ..tools.calls import ByKeyword
from ..tools.values import HIGHEST, Integer

SparseBatch = tuple[np.ndarray, np.ndarray, Array]      # row dofs (n, r), column dofs (n, c), blocks (n, r, c)


class SparseOperators:
    """The operators of the `operators` module on the whole mesh, as scipy CSR in NGSolve's numbering of V_h, Q_h and F_h.

    K, J, S, N, R : as there;  inverseMF, inverseMQ : inverses of the masses, block-diagonal;  G, and its part localG of single
    facets;  projectedS : N M_Q^-1 R;  facetof : facet of each dof of F_h
    """

    def __init__(self, blocks: FacetOperators) -> None:
        self.blocks, self.share = blocks, blocks.share
        self._shape = {"V": blocks.dim * int(blocks.starts[-1]), "F": blocks.dim * int(blocks.facetstarts[-1]),
                       "Q": len(blocks.groups[0].basis) * int(blocks.liftstarts[-1])}

    def _Sparse(self, spaces: str, batches: Iterable[SparseBatch]) -> sp.csr_matrix:
        """CSR from batches (row dofs (n, r), column dofs (n, c), blocks (n, r, c)); entries add up."""
        rows, columns, values = [], [], []
        for row, column, block in batches:
            rows.append(np.broadcast_to(row[:, :, None], block.shape).ravel())
            columns.append(np.broadcast_to(column[:, None, :], block.shape).ravel())
            values.append(block.ravel())
        shape = tuple(self._shape[space] for space in spaces)
        if not rows:
            return sp.csr_matrix(shape)
        return sp.csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=shape)

    def _Lift(self, elements: np.ndarray) -> np.ndarray:
        return Numbers(self.blocks.liftstarts, elements[:, None], len(self.blocks.groups[0].basis))

    def _OnElements(self, spaces: str, rows: Callable[[np.ndarray], np.ndarray], columns: Callable[[np.ndarray], np.ndarray],
                    blocks: Callable[[ElementGroup], Array]) -> sp.csr_matrix:
        return self._Sparse(spaces, [(rows(group.elements), columns(group.elements), blocks(group))
                                     for group in self.blocks.groups])

    def _OnFacets(self, blocks: Callable[[FacetPatch], Array]) -> sp.csr_matrix:
        """V_h x F_h, from blocks(patch)."""
        return self._Sparse("FV", ((self.blocks.FacetDofs(patch.facets), self.blocks.Dofs(patch.elements), blocks(patch))
                                   for patch in self.blocks.FacetPatches()))

    def _Displacement(self, elements: np.ndarray) -> np.ndarray:
        return self.blocks.Dofs(elements[:, None])

    @cached_property
    def K(self) -> sp.csr_matrix:
        return self._OnElements("VV", self._Displacement, self._Displacement, lambda group: group.energy)

    @cached_property
    def R(self) -> sp.csr_matrix:
        return self._OnElements("QV", self._Lift, self._Displacement, lambda group: group.stress)

    @cached_property
    def inverseMQ(self) -> sp.csr_matrix:
        return self._OnElements("QQ", self._Lift, self._Lift, lambda group: group.inverseliftmass)

    @cached_property
    def J(self) -> sp.csr_matrix:
        return self._OnFacets(self.blocks.JumpBlocks)

    @cached_property
    def S(self) -> sp.csr_matrix:
        return self._OnFacets(lambda patch: self.blocks.Tractions(patch, False))

    @cached_property
    def projectedS(self) -> sp.csr_matrix:
        return self._OnFacets(lambda patch: self.blocks.Tractions(patch, True))

    @cached_property
    def inverseMF(self) -> sp.csr_matrix:
        def Blocks(patch: FacetPatch) -> Array:
            return cast(Array, np.kron(np.eye(self.blocks.dim), self.blocks.inversemass(patch.sides[0])))

        return self._Sparse("FF", ((dofs, dofs, Blocks(patch)) for patch in self.blocks.FacetPatches()
                                   for dofs in [self.blocks.FacetDofs(patch.facets)]))

    @cached_property
    def N(self) -> sp.csr_matrix:
        """From -M_Q^-1 N', the liftings of the elements' facets."""
        def Batches() -> Iterator[SparseBatch]:
            for star in self.blocks.Stars():
                mass = np.linalg.inv(self.blocks.groups[star.number].inverseliftmass[star.rows])
                for (_, facets, _), lift in zip(star.arms, self.blocks.Liftings(star)):
                    yield self.blocks.FacetDofs(facets), self._Lift(star.elements[:, 0]), -np.swapaxes(mass @ lift, 1, 2)

        return self._Sparse("FQ", Batches())

    @cached_property
    def G(self) -> sp.csr_matrix:
        def Batches() -> Iterator[SparseBatch]:
            for star in self.blocks.Stars():
                dofs = np.concatenate([self.blocks.FacetDofs(facets) for _, facets, _ in star.arms], axis=1)
                lift = np.concatenate(self.blocks.Liftings(star), axis=2)
                mass = self.blocks.groups[star.number].weightedliftmass[star.rows]
                yield dofs, dofs, np.swapaxes(lift, 1, 2) @ mass @ lift

        return self._Sparse("FF", Batches())

    @cached_property
    def localG(self) -> sp.csr_matrix:
        return self._Sparse("FF", ((dofs, dofs, self.blocks.LocalEnergy(patch)) for patch in self.blocks.FacetPatches()
                                   for dofs in [self.blocks.FacetDofs(patch.facets)]))

    @cached_property
    def facetof(self) -> np.ndarray:
        return np.tile(np.repeat(np.arange(len(self.share)), self.blocks.facetsizes), self.blocks.dim)


@ByKeyword
class Lifting:
    """r_0 and r_e of a DG discretisation, as functions in Q_h (3.2)-(3.3).

    disc : Discretization with a discontinuous method;  order : l >= 0, the degree of Q_h, by default k
    `space` is Q_h.  Jumps on Gamma_D are those of homogeneous data.

    Raises ProblemError for the conforming method, whose functions do not jump, and for l < 0.

    >>> from ngdgc import *
    >>> from ngdgc.exact import AffinePatch
    >>> from ngdgc.meshes import RectangleMesh
    >>> exact = AffinePatch("slip")
    >>> disc = Discretization(exact.problem, LDG(), RectangleMesh(2))
    >>> Lifting(disc).Matrix().shape[1] == disc.space.ndof
    True
    """

    def __init__(self, disc: Any, *, order: int | None = None) -> None:
        CheckDiscretization(disc)
        if not disc.method.discontinuous:
            raise ProblemError(f"method {disc.method.name} has no jumps to lift; take a discontinuous one")
        most = HIGHEST[disc.mesh.dim]
        order = disc.order if order is None else Integer(
            order, "order", f"the degree of the lifting space must be an integer >= 0, at most {most}", least=0, most=most)
        share, rollers = WeakFacets(disc.problem, disc.facets)
        blocks = FacetOperators(disc.problem.material, disc.facets, disc.order, order, share, rollers)
        self.operators, self.space = SparseOperators(blocks), blocks.liftspace

    def _CheckFacet(self, facet: int) -> None:
        last = len(self.operators.share) - 1
        Integer(facet, "facet", f"give the number of one, the mesh has the facets 0 ... {last}", least=0, most=last)

    def Matrix(self, facet: int | None = None) -> Any:
        """r_0, or r_e of the facet with this number, as a sparse matrix from V_h to Q_h."""
        if facet is not None:
            self._CheckFacet(facet)
        operators = self.operators
        traces = operators.N.T
        if facet is not None:
            traces = traces @ sp.diags((operators.facetof == facet).astype(float))
        return -(operators.inverseMQ @ (traces @ (operators.inverseMF @ operators.J)))

    def Global(self, gfu: Any) -> Any:
        """r_0([u]), a GridFunction in Q_h [as grad u]."""
        return self._Function(gfu, None)

    def Local(self, gfu: Any, facet: int) -> Any:
        """r_e([u]) of the facet with this number; it lives on the elements at the facet."""
        self._CheckFacet(facet)
        return self._Function(gfu, facet)

    def _Function(self, gfu: Any, facet: int | None) -> GridFunction:
        operators = self.operators
        if not isinstance(gfu, GridFunction) or gfu.space.ndof != operators.J.shape[1]:
            raise ProblemError(f"gfu is {gfu!r}; give a GridFunction on the space of the discretisation")
        jump = operators.inverseMF @ (operators.J @ gfu.vec.FV().NumPy())
        if facet is not None:
            jump[operators.facetof != facet] = 0
        lifted = GridFunction(self.space)
        lifted.vec.FV().NumPy()[:] = -(operators.inverseMQ @ (operators.N.T @ jump))
        return lifted


def WeakFacets(problem: ContactProblem, facets: Facets) -> tuple[Array, np.ndarray]:
    """(share, rollers) of the facets of E0, for `FacetOperators`: interior facets, Gamma_D and rollers."""
    share = np.where(facets.interior, 0.5, 0.0)
    share[facets.cut] = 0      # the sides of a joint feel each other by its law alone
    rollers = np.zeros(len(share), dtype=bool)
    for region in problem.roller:
        rollers |= facets.On(region)
    for region in problem.dirichlet:
        share[facets.On(region)] = 1
    share[rollers] = 1
    return share, rollers
