"""LDG without a penalty: liftings of a higher degree are enough to make it stable.

B_h(u, u) = int C (eps_h(u) + r_0[u]):(eps_h(u) + r_0[u]) vanishes where a lifting cancels a strain.  On an element K both are
symmetric matrices: the strains of V_h(K), and the liftings of the jumps on its facets.  With kappa_K < 1 the largest square of
the cosine of an angle between the two, in the inner product of C,

    B_h(u, u) >= (1 - sqrt(max kappa_K)) (g_h(u, u) + (C r_0[u], r_0[u])).

With liftings of degree l = k, as LDG has them, kappa_K = 1.  With l = k + 1 it is smaller, whatever the size of the element:
John, Neilan and Smears prove that this is enough for the Laplacian on simplices.  Of a nearly incompressible material liftings
of that degree nearly cancel strains (1 - kappa_K = O(mu/lam), but for k = 1 on simplices), and some jumps cost little; with
l = k + 2 nothing depends on lam.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from ngsolve import Mesh

from ..blocks.operators import FacetOperators
from ..linear.solenoidal import SWOLLEN, Swelling
from ..tools.calls import ByKeyword
from .discontinuous import DiscontinuousGalerkin
from .guarantee import UNKNOWN, Bounded, Guarantee
from .penalty import LargestEigenvalues


@ByKeyword
@dataclass(frozen=True, kw_only=True, repr=False)
class PenaltyFreeLDG(DiscontinuousGalerkin):
    """LDG without a penalty: flux {C eps(u)} + {C r_0[u]}, with liftings of degree k + 1, or k + 2 if lam is large.

    B_h(u,v) = int C eps_h(u):eps_h(v) - <[u],{C eps(v)}> - <[v],{C eps(u)}> + (C r_0[u], r_0[v]),    without a parameter.

    form : "edge" or "lifting", as for the rows with a penalty; where the material varies much within elements the edge form is
        not coercive, which is a ProblemError when its matrix is needed, and the lifting form is

    The degree is k + 2 where the volumetric stiffness is more than ten times the shear stiffness, nu = 0.45 in plane strain.
    Source: John, Neilan, Smears, Stable discontinuous Galerkin FEM without penalty parameters, in Numerical Mathematics and
    Advanced Applications ENUMATH 2015, Springer 2016.

    >>> PenaltyFreeLDG(form="lifting").name
    'LDG0'
    """

    form: str = "edge"
    name: ClassVar[str] = "LDG0"
    globallift: ClassVar[bool] = True

    if TYPE_CHECKING:
        def __init__(self, *, form: Literal["edge", "lifting"] = "edge") -> None: ...

    def __post_init__(self) -> None:
        self._CheckForm()

    def _Stabilised(self, lifting: Callable[[int], FacetOperators], material: Any, mesh: Mesh,
                   order: int) -> tuple[FacetOperators, Any, float | None, Guarantee]:
        operators = lifting(order + (2 if Swelling(material, mesh) > SWOLLEN else 1))
        return operators, None, None, Correlation(operators, self.form == "lifting")


def Correlation(operators: FacetOperators, lifted: bool) -> Guarantee:
    """Bounded by the largest kappa_K of all elements: b_K(v, w)^2 <= kappa_K int_K C eps(v):eps(v) int_K C L w:L w.

    v in V_h(K);  w : jumps on the facets of K, L w their lifting
    lifted : True for b_K(v, w) = int_K C eps(v):L w, the coupling of the lifting form; False for
        that of the edge form, - int_dK {C eps(v)} n.w, which is the same where C eps(V_h) lies in Q_h.  Where it does not there
        may be jumps that are not lifted and work all the same: no kappa_K bounds that
    """
    words: dict[str, Any] = {} if lifted else {
        "culprit": "form='edge' without a penalty, for a material that varies within elements,",
        "remedy": "take form='lifting', which is coercive for every material, or LDG()"}
    largest = 0.0
    for star in operators.Stars():
        lift = np.concatenate(operators.Liftings(star), axis=2)
        if lifted:
            coupling = np.swapaxes(star.group.stress, 1, 2) @ lift
        else:
            tractions = [operators.SideTraction(own, facets, False) for own, facets, _ in star.arms]
            coupling = -np.swapaxes(np.concatenate(tractions, axis=1), 1, 2)
        energy = np.swapaxes(lift, 1, 2) @ star.group.weightedliftmass @ lift
        # On a roller only normal jumps are lifted, and on a rectangle there are tangential ones whose liftings cancel.
        inverse = np.linalg.pinv(energy, rcond=1e-10, hermitian=True)
        if np.abs(coupling - coupling @ inverse @ energy).max() > 1e-8 * np.abs(coupling).max():
            return replace(UNKNOWN, **words)
        largest = max(largest, LargestEigenvalues(coupling @ inverse @ np.swapaxes(coupling, 1, 2), star.group).max())
    return replace(Bounded(largest), **words)
