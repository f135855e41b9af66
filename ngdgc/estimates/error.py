"""The error in the energy norm, from a stress in equilibrium and a continuous displacement."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from ngsolve import ET

from ..contracts import Array
from ..exceptions import ProblemError
from ..methods.blockform import FacetForm
from ..solution.solution import CheckSolution
from ..tools.calls import ByKeyword
from .bound import Bound
from .equilibrated import Complementary, EquilibratedStress, Stress, StressBatch
from .estimate import ErrorEstimate, RefuseHistories, RefuseJoints, RefusePunches, RefuseSprings, Relative
from .lawpart import LawPart
from .loadquadrature import LoadQuadrature
from .oscillation import BodyOscillation, TractionOscillation
from .piola import FACTORS
from .potential import Potential, Sweeps
from .revolvedstress import RevolvedStress
from .stressfunction import Relaxed

PARTS = ("stress", "skew", "jumps", "law", "feasibility", "data")
SIMPLICES = ET.TRIG, ET.TET
FASTER = 4          # sweeps of the stress for each of the potential, of which they cost a small part
REVOLVED = "of a body of revolution s is in equilibrium along the axis up to what 'data' counts, with no constant that is known"
POLYNOMIAL = 1e-4   # share of the data in value^2 up to which quadrature has seen all of them


@ByKeyword
def EstimateError(solution: Any) -> ErrorEstimate:
    """The error of a solution of a discontinuous method in the energy norm, as an `ErrorEstimate`.

    With s_h = C eps(u_h), s in equilibrium with the loads (`equilibrated`), v continuous (`potential`), |.| the C^-1 norm:

        value^2 = |sym s - s_h|^2 + |skew s|^2 + |C eps(v) - s_h|^2 + 2 Phi + I^2 + osc^2

    parts : "stress", "skew", "jumps", these three; "law" 2 Phi and "feasibility" I^2, what v and s n lack of the law
        (`lawpart`); "data" osc^2, of body force and tractions on Gamma_F, 0 where they are in V_h (`oscillation`), and what
        their quadrature does to u_h where that matters (`loadquadrature`)
    |skew s|^2 : C^-1 of skew matrices is 1/(2 mu); on quadrilaterals, hexahedra and prisms, where one of s_ij and s_ji sees
        less of a shear than the other, the larger one counts for both

    Of a body of revolution s has a hoop stress (`revolvedstress`), and there is no bound.
    Of a nearly incompressible body, or one of very different materials, s is brought nearer to s_h (`stressfunction`).  For
    linear problems with s symmetric value is a bound (Prager and Synge).  No constant is chosen.  The cost is a small part of
    that of the solution: no equation is solved unless a load jumps inside of elements.  `ErrorEstimate.bound` makes s symmetric
    on triangles, parallelograms and tetrahedra, elsewhere it takes Korn's constants; with friction that depends on the
    solution it takes some applications of A^-1.

    Raises ProblemError if the solution has not converged; for H1, which has no numerical flux; for methods of your own that are
    no rows of facet operators; with forms that were added or springs; for pyramids.

    >>> from ngdgc import *
    >>> from ngdgc.errors import EnergyError
    >>> from ngdgc.exact import SmoothSlip
    >>> from ngdgc.meshes import RectangleMesh
    >>> exact = SmoothSlip()
    >>> solution = Solve(Discretization(exact.problem, LDG(), RectangleMesh(4), order=2))
    >>> 1 < EstimateError(solution).value / EnergyError(solution, exact.displacement) < 1.6
    True
    """
    _Check(solution)
    with solution.state.Restored():
        squares = _Squares(solution)
    indicators: Array = np.sum(list(squares.values()), axis=0)
    value = float(np.sqrt(indicators.sum()))
    return ErrorEstimate(value=value, relative=Relative(solution, value), indicators=indicators,
                         parts={name: float(np.sqrt(square.sum())) for name, square in squares.items()},
                         Theory=(lambda: (None, REVOLVED)) if solution.disc.problem.axisymmetric else partial(Bound, solution))


def _Check(solution: Any) -> None:
    CheckSolution(solution)
    disc = solution.disc
    if not solution.converged:
        raise ProblemError("the solution has not converged and is not in equilibrium with its traction; give one that has")
    if not disc.method.conservative:
        raise ProblemError(f"method {disc.method.name} has no numerical flux that balances every element, from which the error "
                           "is estimated; take a discontinuous one")
    if not isinstance(disc.facetform, FacetForm):
        raise ProblemError(f"method {disc.method.name} has a form of its own; errors are estimated for those whose Form is a "
                           "FacetForm, as all methods of ngdgc have it")
    RefuseSprings(disc.problem)
    RefuseJoints(disc.problem)
    RefusePunches(disc.problem)
    RefuseHistories(disc)
    if disc.added:
        raise ProblemError("forms were added, whose forces the numerical flux does not know; errors are estimated of problems "
                           "without them")
    kinds = {group.et for group in disc.facetform.operators.groups} - FACTORS.keys()
    if kinds:
        raise ProblemError("the mesh has pyramids, for which no equilibrated stress is known here; take another mesh")


def _Squares(solution: Any) -> dict[str, Array]:
    """{name of a part: (elements,)}."""
    disc = solution.disc
    revolved, potential = disc.problem.axisymmetric, Potential(solution)
    stress = RevolvedStress(solution) if revolved else EquilibratedStress(solution)
    sweeps = Sweeps(disc.problem.material, disc.mesh)
    if sweeps and not revolved:
        stress = Relaxed(stress, FASTER * sweeps)
    squares = {name: np.zeros(disc.mesh.ne) for name in PARTS}
    for batch in stress.Batches():
        C, elements = batch.C, batch.group.elements
        shear = disc.problem.material.ShearAt(batch.points.ravel()).reshape(batch.points.shape)
        difference = batch.equilibrated - batch.computed
        squares["stress"][elements] = batch.Integral(Complementary(C, (difference + np.swapaxes(difference, 2, 3)) / 2))
        squares["skew"][elements] = _Skew(batch, difference, shear)
        jumps = Stress(C, potential.Gradient(batch.group)) - batch.computed
        squares["jumps"][elements] = batch.Integral(Complementary(C, jumps))
        squares["data"][elements] = BodyOscillation(disc, batch, shear)
    for elements, shares in TractionOscillation(disc, stress):
        np.add.at(squares["data"], elements, shares)
    for gaps in LawPart(solution, potential, stress):
        np.add.at(squares["law"], gaps.elements, 2 * gaps.weights * gaps.envelope)
        np.add.at(squares["feasibility"], gaps.elements, gaps.weights * gaps.infeasible)
    total = sum(square.sum() for square in squares.values())
    if squares["data"].sum() > POLYNOMIAL * total:
        squares["data"] += LoadQuadrature(solution, np.sqrt(total))
    return squares


def _Skew(batch: StressBatch, difference: Array, shear: Array) -> Array:
    """|skew s|^2/(2 mu) over the elements, (n,); on products of cells max(s_ij^2, s_ji^2) for the mean of both."""
    total = np.zeros(len(difference))
    for i in range(difference.shape[2]):
        for j in range(i):
            one, other = difference[..., i, j], difference[..., j, i]
            total += batch.Integral((one - other) ** 2 / (4 * shear))
            if batch.group.et not in SIMPLICES:
                total += np.abs(batch.Integral((one ** 2 - other ** 2) / (2 * shear)))
    return total
