"""The operators of the discontinuous Galerkin methods, as blocks on elements and facets.

For a symmetric q, [v]:q = w.(q n) with the vector jump w = v+ - v-: the tensor jump is a vector jump against a traction.  So
everything is built from integrals over elements and their sides (`integrals` module), in which neighbours do not couple:

    V_h  displacement, order k                    Q_h  symmetric matrices, piecewise of order l
    F_h  vectors on the facets, order k           E0   interior facets, Gamma_D and rollers
    K : V_h x V_h  int C eps(u):eps(v)            J : V_h x F_h  int_E0 (u+ - u-).mu
    S : V_h x F_h  int_E0 {C eps(u)} n.mu         N : Q_h x F_h  int_E0 {q} n.mu
    R : V_h x Q_h  int C eps(u):q                 M_F, M_Q, M_C  masses of F_h and Q_h, and the C-weighted one of Q_h

    r_0([u]) = -M_Q^-1 N' M_F^-1 J u              G = N M_Q^-1 M_C M_Q^-1 N'

Averages count the two sides of an interior facet by 1/2 and a boundary facet fully; the side with the smaller element number
fixes the orientation.  On a roller w = v_n n and the traction is its normal part.

Shapes of blocks (docs/conventions.md): n patches or stars, v = (k e a) dofs of V_h on them, r = (i b) dofs of F_h on a facet.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np
from ngsolve import CoefficientFunction, FESpace, FacetFESpace, L2, MatrixValued, specialcf

from ..contracts import Array
from .batches import FacetPatch, Patches, Side, Star
from .integrals import ElementGroup
from .matrix import BlockMatrix, Numbers

FEW = 8     # elements


class FacetOperators(Patches):
    """The blocks of the operators on batches of facets and elements, computed anew in each batch: none of them are kept."""

    @property
    def normal(self) -> CoefficientFunction:
        return specialcf.normal(self.dim)

    @cached_property
    def facetspace(self) -> FESpace:
        """F_h, NGSolve's space."""
        return FacetFESpace(self.mesh, order=self.order) ** self.dim

    @cached_property
    def liftspace(self) -> FESpace:
        """Q_h, NGSolve's space."""
        return MatrixValued(L2(self.mesh, order=self.liftorder), symmetric=True)

    @cached_property
    def starts(self) -> np.ndarray:
        """Scalar dofs of V_h: those of element e are starts[e] ... starts[e+1]-1."""
        return self._Starts(lambda group: group.na)

    @cached_property
    def liftstarts(self) -> np.ndarray:
        """Scalar dofs of Q_h."""
        return self._Starts(lambda group: group.nl)

    def _Starts(self, count: Callable[[ElementGroup], int]) -> np.ndarray:
        sizes = np.zeros(self.mesh.ne, dtype=np.int64)
        for group in self.groups:
            sizes[group.elements] = count(group)
        return np.concatenate([[0], np.cumsum(sizes)])

    @cached_property
    def facetstarts(self) -> np.ndarray:
        """Scalar dofs of F_h."""
        return np.concatenate([[0], np.cumsum(self.facetsizes)])

    def Dofs(self, elements: np.ndarray) -> np.ndarray:
        """Dofs (n, v) of V_h on patches of elements (n, patch), ordered component, element, function."""
        return Numbers(self.starts, elements, self.dim)

    def FacetDofs(self, facets: np.ndarray) -> np.ndarray:
        """Dofs (n, r) of F_h on facets (n,)."""
        return Numbers(self.facetstarts, facets[:, None], self.dim)

    @staticmethod
    def elasticjumps(side: Side) -> Array:
        """int_e {C sym(mu (x) n)} n.nu from one side, (n, r, r)."""
        return side.Blocks(lambda group, s: group.ElasticJump(s))

    @staticmethod
    def plainjumps(side: Side) -> Array:
        """int_e {sym(mu (x) n)} n.nu from one side, (n, r, r)."""
        return side.Blocks(lambda group, s: group.PlainJump(s))

    @staticmethod
    def inversemass(side: Side) -> Array:
        """M_F^-1 of single facets, scalar, (n, b, b)."""
        return side.Blocks(lambda group, s: group.InverseFacetMass(s))

    @staticmethod
    def tracevalues(side: Side) -> Array:
        """M_F^-1 times the traces: u on one side of the facets as coefficients in F_h, (n, r, v)."""
        return side.Blocks(lambda group, s: group.TraceValue(s))

    def _Joined(self, parts: Sequence[Array]) -> Array:
        """Blocks (n, r, v) of V_h x F_h on a patch from those of its sides, components first."""
        n, r = parts[0].shape[:2]
        return np.concatenate([part.reshape(n, r, self.dim, -1) for part in parts], axis=3).reshape(n, r, -1)

    def Apply(self, inverse: Array, blocks: Array) -> Array:
        """M^-1 blocks for a scalar inverse (n, b, b) and blocks (n, (i b), ...)."""
        n, r = blocks.shape[:2]
        return (inverse[:, None] @ blocks.reshape(n, self.dim, r // self.dim, -1)).reshape(blocks.shape)

    def SideJump(self, side: Side) -> Array:
        """The part of M_F^-1 J on one side, (n, r, v)."""
        return self.tracevalues(side) * side.sign[:, None, None]

    def SideTraction(self, side: Side, facets: np.ndarray, lifted: bool) -> Array:
        """The part of S, or of N M_Q^-1 R if `lifted`, on one side of the facets, (n, r, v)."""
        def Traction(group: ElementGroup, s: int) -> Array:
            return group.LiftedTraction(s) @ (group.inverseliftmass @ group.stress) if lifted else group.Traction(s)

        return side.Blocks(Traction) * (self.share[facets] * side.sign)[:, None, None]

    def JumpBlocks(self, patch: FacetPatch) -> Array:
        """J, (n, r, v)."""
        return self._Joined([side.Blocks(lambda group, s: group.Trace(s)) * side.sign[:, None, None] for side in patch.sides])

    def Jumps(self, patch: FacetPatch) -> Array:
        """M_F^-1 J: the jump as coefficients in F_h, (n, r, v)."""
        return self._Joined([self.SideJump(side) for side in patch.sides])

    def Tractions(self, patch: FacetPatch, lifted: bool) -> Array:
        """S, or N M_Q^-1 R if `lifted`, (n, r, v)."""
        return self._Joined([self.SideTraction(side, patch.facets, lifted) for side in patch.sides])

    def LocalEnergy(self, patch: FacetPatch) -> Array:
        """(C r_e(mu), r_e(nu)), (n, r, r)."""
        def Energy(group: ElementGroup, s: int) -> Array:
            lifting = group.LiftedTraction(s) @ group.inverseliftmass
            return lifting @ group.weightedliftmass @ np.swapaxes(lifting, 1, 2)

        return self._OfSides(patch, Energy)

    def LocalSquare(self, patch: FacetPatch) -> Array:
        """(r_e(mu), r_e(nu)), (n, r, r)."""
        def Square(group: ElementGroup, s: int) -> Array:
            traction = group.LiftedTraction(s)
            return traction @ group.inverseliftmass @ np.swapaxes(traction, 1, 2)

        return self._OfSides(patch, Square)

    def _OfSides(self, patch: FacetPatch, product: Callable[[ElementGroup, int], Array]) -> Array:
        share = self.share[patch.facets]
        return sum(share[:, None, None] ** 2 * side.Blocks(product) for side in patch.sides)

    def Liftings(self, star: Star) -> list[Array]:
        """-M_Q^-1 N' : the liftings of traces on the star's facets as coefficients in Q_h, [(n, (c p), r)] over its arms."""
        return [-star.group.inverseliftmass @ np.swapaxes(side.Blocks(lambda group, s: group.LiftedTraction(s)), 1, 2)
                * (self.share[facets] * side.sign)[:, None, None] for side, facets, _ in star.arms]

    def GlobalLifting(self, star: Star) -> Array:
        """r_0([u]) on the star's elements from the displacements on the star, (n, (c p), v)."""
        here, beyond = np.zeros(()), []
        for lift, (own, _, other) in zip(self.Liftings(star), star.arms):
            here = here + lift @ self.SideJump(own)
            if other is not None:
                beyond.append(lift @ self.SideJump(other))
        return self._Joined([here, *beyond])

    @cached_property
    def contains(self) -> bool:
        """True if C eps(V_h) lies in Q_h, as far as the facets see: then edge form and lifting form are the same."""
        groups = [group.samples for group in self.groups]
        # A few elements tell most often if it does not.
        return _Contains([group.Part(np.arange(min(FEW, len(group.elements)))) for group in groups]) and _Contains(groups)

    def EdgeCoupling(self, group: ElementGroup) -> Array | None:
        """sum_e m_e S_e' G_e^-1 S_e on elements, (n, v, v), m_e = 2 between elements and 1 on the boundary, or None.

        S_e are the element's own tractions in the averages, G_e the local lifting energy of a facet: by Young's inequality
        the edge form with eta sum_e (C r_e, r_e) is coercive if eta exceeds this against the energy of every element.  None if
        some traction meets a jump whose lifting vanishes: then no eta will do.
        """
        size = self.dim * int(self.facetsizes.max())
        energies = np.zeros((len(self.share), size, size))
        for patch in self.FacetPatches():
            energy = self.LocalEnergy(patch)
            energies[patch.facets, :energy.shape[1], :energy.shape[1]] = energy
        total = np.zeros_like(group.energy)
        for s in group.sides:
            share = self.share[group.facets[:, s]]
            weak = np.flatnonzero(share > 0)
            if not len(weak):
                continue
            tractions = share[weak, None, None] * group.Traction(s)[weak]
            lifted = energies[group.facets[weak, s]][:, :tractions.shape[1], :tractions.shape[1]]
            inverse = np.linalg.pinv(lifted, rcond=1e-10, hermitian=True)
            if np.abs(tractions - lifted @ (inverse @ tractions)).max() > 1e-8 * np.abs(tractions).max():
                return None
            total[weak] += np.swapaxes(tractions, 1, 2) @ inverse @ tractions / share[weak, None, None]
        return total

    def Matrix(self, space: FESpace, reach: int) -> BlockMatrix:
        """An empty BlockMatrix on V_h = space."""
        return BlockMatrix(space, self.starts, self.facets.adjacency, reach)


def _Contains(groups: Sequence[ElementGroup]) -> bool:
    difference = largest = 0.0
    for group in groups:
        projection = group.inverseliftmass @ group.stress
        for s in group.sides:
            traction = group.Traction(s)
            difference = max(difference, np.abs(traction - group.LiftedTraction(s) @ projection).max())
            largest = max(largest, np.abs(traction).max())
    # Round-off of products of matrices with entries of different size.
    return difference <= 1e-10 * largest
