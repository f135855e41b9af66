"""Lemmas 3.2 to 3.4 of Xiao, Wang, Han 2018 as tools: liftings, boundedness, coercivity, critical penalties.

The norm is the paper's, with the jumps weighted so that its two parts have one unit:

    |||v|||^2 = sum_K int_K C eps(v):eps(v) + sum_e (mu_e/h_e) int_e [v]:[v]        over e in E0 [stress length^d],

h_e the diameter of e and mu_e the larger shear modulus of the two sides.  Joints are not in E0.  On V_h the term
h_K^2 |v|_{2,K}^2 of Lemma 3.3 is bounded by the first one and is left out.  For the conforming method E0 are the rollers.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from ngsolve import BilinearForm, InnerProduct, Mesh, ds, dx, specialcf

from ..contracts import Array
from ..discretization import Discretization
from ..exceptions import ProblemError
from ..mesh.checks import CheckSkeleton
from ..mesh.facets import Threads, VolumePoints
from ..methods.coercivity import ExtremeEigenvalue, FreePart, SparseInverse, SmallestEigenvalue, Symmetric
from ..methods.lifting import Lifting
from ..problem.materials import Strain
from ..problem.problem import ContactProblem
from ..tools.calls import ByKeyword
from ..tools.values import Vectors

ENOUGH = 0.1        # smallest eigenvalue in its own norm from which a form is taken for safely coercive


def _TensorJumps(w: Any, s: Any, n: Any) -> Any:
    """[v]:[z] for the vector jumps w and s of v and z: sym(w (x) n) : sym(s (x) n)."""
    return 0.5 * (w * s + (w * n) * (s * n))


@ByKeyword
def NormMatrix(disc: Discretization) -> Any:
    """NGSolve's matrix of |||.||| on V_h, from its definition above.

    >>> from ngdgc import *
    >>> from ngdgc.exact import AffinePatch
    >>> from ngdgc.meshes import RectangleMesh
    >>> disc = Discretization(AffinePatch("slip").problem, LDG(), RectangleMesh(2))
    >>> NormMatrix(disc).height == disc.space.ndof
    True
    """
    CheckSkeleton(disc.facets)
    disc.problem.frame.Refuse("NormMatrix")
    problem, mesh, facets, n = disc.problem, disc.mesh, disc.facets, specialcf.normal(disc.mesh.dim)
    points = VolumePoints(mesh, 2 * disc.order)
    shear = np.zeros(mesh.ne)
    np.maximum.at(shear, points["nr"], problem.material.ShearAt(points))
    weight = facets.Function(np.where(facets.cut, 0, facets.LargestNeighbour(shear) / facets.diameter))
    u, v = disc.space.TnT()
    form = BilinearForm(disc.space)
    form += InnerProduct(problem.material.Stress(Strain(u)), Strain(v)) * dx(bonus_intorder=problem.material.bonus)
    if disc.method.discontinuous:
        form += weight * _TensorJumps(u - u.Other(), v - v.Other(), n) * dx(skeleton=True)
        for region in problem.dirichlet:
            form += weight * _TensorJumps(u, v, n) * ds(skeleton=True, definedon=mesh.Boundaries(region))
    for region in problem.roller:
        form += weight * (u * n) * (v * n) * ds(skeleton=True, definedon=mesh.Boundaries(region))
    with Threads(mesh):
        return form.Assemble().mat


def _CheckHeld(disc: Discretization) -> None:
    if disc.loose:
        raise ProblemError(f"only contact resists {disc.loose}, so |||.||| is no norm; add dirichlet or roller")


def _Pencil(disc: Discretization) -> tuple[Any, Any, SparseInverse]:
    """(B_h, N, N^-1) on the free dofs, N the matrix of |||.|||."""
    _CheckHeld(disc)
    free = disc.space.FreeDofs()
    with Threads(disc.mesh):
        norm = FreePart(NormMatrix(disc), free)
        return FreePart(disc.form.Matrix(), free), norm, SparseInverse(norm)


@ByKeyword
def Coercivity(disc: Discretization) -> float:
    """Largest c with B_h(v, v) >= c |||v|||^2 on V_h (Lemma 3.4), negative if B_h is not coercive; no unit.

    disc : Discretization of any method; of an unsymmetric form the symmetric part counts.

    Raises ProblemError for a body that only its foundation holds.

    >>> from ngdgc import *
    >>> from ngdgc.exact import AffinePatch
    >>> from ngdgc.meshes import RectangleMesh
    >>> exact = AffinePatch("slip")
    >>> disc = Discretization(exact.problem, LDG(), RectangleMesh(2))
    >>> 0 < Coercivity(disc) < Boundedness(disc)
    True
    """
    matrix, norm, inverse = _Pencil(disc)
    matrix = Symmetric(matrix)
    if disc.form.guarantee.holds or SmallestEigenvalue(disc.form.Matrix(), disc.form.Norm(), disc.space.FreeDofs()) > 0:
        # The smallest eigenvalue is one end of a long spectrum: of the inverse it is the largest, found in fewer steps.
        with Threads(disc.mesh):
            inverse = SparseInverse(matrix)
        return 1 / ExtremeEigenvalue(norm, matrix, inverse, "LA")
    return ExtremeEigenvalue(matrix, norm, inverse, "SA")


@ByKeyword
def Boundedness(disc: Discretization) -> float:
    """Smallest C with |B_h(u, v)| <= C |||u||| |||v||| on V_h (Lemma 3.3); no unit.

    The largest singular value of B_h in the inner product of |||.|||, for symmetric and unsymmetric forms:
    B' N^-1 B x = C^2 N x.

    Raises ProblemError for a body that only its foundation holds.

    >>> from ngdgc import *
    >>> from ngdgc.exact import AffinePatch
    >>> from ngdgc.meshes import RectangleMesh
    >>> disc = Discretization(AffinePatch("slip").problem, LDG(), RectangleMesh(2))
    >>> Boundedness(disc) > 1
    True
    """
    matrix, norm, inverse = _Pencil(disc)
    transposed = matrix.T.tocsr()
    return float(np.sqrt(ExtremeEigenvalue(lambda v: transposed @ inverse(matrix @ np.ravel(v)), norm, inverse, "LA")))


@ByKeyword
def DualNorm(disc: Discretization, functional: Array) -> float:
    """sup F(v)/|||v||| over V_h of F given by its coefficients (ndof,), that is sqrt(F' N^-1 F) [sqrt(stress length^d)].

    F [stress length^d per length of v].  Raises ProblemError for a body that only its foundation holds.

    >>> from ngdgc import *
    >>> from ngdgc.exact import AffinePatch
    >>> from ngdgc.meshes import RectangleMesh
    >>> disc = Discretization(AffinePatch("slip").problem, LDG(), RectangleMesh(2))
    >>> DualNorm(disc, np.zeros(disc.space.ndof))
    0.0
    """
    _CheckHeld(disc)
    functional = Vectors(functional, (disc.space.ndof,), "functional", f"give its {disc.space.ndof} coefficients")
    free = disc.space.FreeDofs()
    with Threads(disc.mesh):
        inverse = SparseInverse(FreePart(NormMatrix(disc), free))
    values = functional[np.flatnonzero(list(free))]
    return float(np.sqrt(max(float(values @ inverse(values)), 0)))


@ByKeyword
@dataclass(frozen=True)
class LiftingBounds:
    """Constants of Lemma 3.2 over the facets of E0, each an array (facets of E0,); no unit.

    `lower` and `upper`: the extreme values of |r_e([v])|_0/|h_e^-1/2 [v]|_{0,e} on each facet;  `c`, `C`: over all of them.

    >>> LiftingBounds(lower=np.array([0.5]), upper=np.array([2.0])).upper
    array([2.])
    """

    lower: np.ndarray
    upper: np.ndarray

    @property
    def c(self) -> float:
        return float(self.lower.min())

    @property
    def C(self) -> float:
        return float(self.upper.max())


@ByKeyword
def LiftingConstants(disc: Discretization, *, order: int | None = None) -> LiftingBounds:
    """c and C in  c |h_e^-1/2 [v]|_{0,e} <= |r_e([v])|_0 <= C |h_e^-1/2 [v]|_{0,e}  for v in V_h and e in E0 (Lemma 3.2).

    disc : Discretization of a discontinuous method;  order : l >= 0, the degree of Q_h, by default k

    One small eigenvalue problem a facet, on the space of its jumps.  c = 0 where the lifting does not see every jump, as
    for l = 0 with k >= 1: the reason why l = 0 makes the methods of Bassi et al. and Brezzi et al. singular.  The jumps
    are those of F_h.  Raises ProblemError for the conforming method and for l < 0.

    >>> from ngdgc import *
    >>> from ngdgc.exact import AffinePatch
    >>> from ngdgc.meshes import RectangleMesh
    >>> disc = Discretization(AffinePatch("slip").problem, LDG(), RectangleMesh(2))
    >>> bounds = LiftingConstants(disc)
    >>> bool(np.all(bounds.lower <= bounds.upper))
    True
    """
    blocks = Lifting(disc, order=order).operators.blocks
    lower, upper = [], []
    for patch in blocks.FacetPatches():
        weight = (blocks.share / disc.facets.diameter)[patch.facets]
        jumps = sum(weight[:, None, None] * blocks.plainjumps(side) for side in patch.sides)
        values, vectors = np.linalg.eigh(jumps)
        # On a roller the jumps are normal: the other directions span the null space of both forms.
        real = values > 1e-10 * values[:, -1:]
        scaled = vectors * np.where(real, 1 / np.sqrt(np.where(real, values, 1)), 0)[:, None, :]
        squares = np.linalg.eigvalsh(np.swapaxes(scaled, 1, 2) @ blocks.LocalSquare(patch) @ scaled)
        squares = np.sqrt(np.maximum(squares, 0))
        lower.append(squares[np.arange(len(values)), np.sum(~real, axis=1)])
        upper.append(squares[:, -1])
    return LiftingBounds(np.concatenate(lower), np.concatenate(upper))


@ByKeyword
def CriticalPenalty(problem: ContactProblem, method: Any, mesh: Mesh, *, order: int = 1, **options: Any) -> float:
    """The penalty number above which B_h is coercive on this mesh; zero or negative if it is for any penalty.

    problem, mesh, order : as for Discretization;  method : a class such as BassiEtAl, with `options` for it, or an object,
        whose own penalty does not count

    The number is that of the keyword `penalty`: for jump penalties the paper's eta is it times mu k^2.

    With B(eta) = B_0 + eta P and a penalty eta* for which A = B(eta*) is positive definite, B(eta) = A - (eta* - eta) P is
    so exactly if (eta* - eta) nu < 1, nu the largest eigenvalue of P x = nu A x: the critical penalty is eta* - 1/nu.
    eta* is twice what the element bound asks for; where none is known, the first power of 4 that eigenvalues show to do.

    Raises ProblemError for the conforming method and for a body that only its foundation holds.

    >>> from ngsolve import CF
    >>> from ngdgc import *
    >>> from ngdgc.meshes import RectangleMesh
    >>> problem = ContactProblem(HookeMaterial(mu=1, lam=0), Foundation("bottom", NormalCompliance(1)),
    ...                          dirichlet={"right": CF((0, 0))})
    >>> round(CriticalPenalty(problem, InteriorPenalty, RectangleMesh(4)), 1)
    7.1
    """
    if isinstance(method, type):
        method = method(**options)
    elif options:
        raise ProblemError(f"{', '.join(options)} given beside the object {method!r}; give a class with options, or an object")
    if not hasattr(method, "penalty"):
        raise ProblemError(f"method {method!r} has no penalty; give a discontinuous method with one")
    one, two = (Discretization(problem, replace(method, penalty=penalty), mesh, order=order) for penalty in (1.0, 2.0))
    _CheckHeld(one)
    with Threads(mesh):
        matrix, doubled = (Symmetric(FreePart(disc.form.Matrix(), disc.space.FreeDofs())) for disc in (one, two))
    slope = doubled - matrix
    safe = _SafePenalty(one, matrix, slope)
    form = matrix + (safe - 1) * slope
    return float(safe - 1 / ExtremeEigenvalue(slope, form, SparseInverse(form), "LA"))


def _SafePenalty(disc: Discretization, matrix: Any, slope: Any) -> float:
    """A penalty with which B_h is coercive, from B_h for penalty 1 and its derivative."""
    guarantee = disc.form.guarantee
    if guarantee.kind == "always":
        return 1.0
    if guarantee.kappa is not None:     # inversely proportional to the penalty; zero without facets in E0
        return 2 * guarantee.kappa or 1.0
    norm = FreePart(disc.form.Norm(), disc.space.FreeDofs())
    for penalty in 4.0 ** np.arange(20):
        energy = norm + (penalty - 1) * slope
        if ExtremeEigenvalue(matrix + (penalty - 1) * slope, energy, SparseInverse(energy), "SA") > ENOUGH:
            return penalty
    raise ProblemError(f"{disc.method!r} is not coercive for any penalty up to 4^19; take the other form or a larger liftorder")
