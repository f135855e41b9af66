"""The contact problem once more, with a quadrature that is divided where contact ends."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..contact.graph import SEPARATION, ContactGraph
from ..contact.stiffness import BodyStiffness
from ..discrete.divided import OnPieces
from ..exceptions import ProblemError
from ..mesh.pieces import Pieces
from ..mesh.quadrature import ContactRules
from ..solution.solution import CheckSolution, ContactSolution
from ..solvers.nested import FromPrediction, LevelOf, Transfer
from ..solvers.newton.solver import SemismoothNewtonSolver
from ..tools.calls import ByKeyword
from .estimate import RefuseHistories
from .zoneends import Openings, ZonePieces


@ByKeyword
def SolveDivided(solution: Any, *, tol: float = 1e-10) -> ContactSolution:
    """The same problem solved once more with contact points on both sides of where contact ends, a ContactSolution.

    Where contact ends within a facet of Gamma_C the traction has a kink, and the force of a quadrature across it is off by
    h^2, up or down as the end lies between the points: for k >= 2 on soft foundations that is most of the error of
    `normalforce`.  Here these facets are divided at the ends of contact of `solution`, lines in 3D (`zoneends` module), each
    part has a quadrature of its own, and Newton's method begins from `solution`.  Matrix, mesh and unknowns stay what they are,
    the energy error too; `solution.disc.pieces` are the parts, and Save keeps them.

    Facets on which the foundation is stiffer than the body, p_n' > 2 mu k/h, stay whole: there the traction has a root at its
    end and not a kink, no part is a polynomial, and nothing would be gained.  Where stick ends nothing is divided: u_t = 0 at
    all points of a part would make u_t vanish on the whole facet.
    Quadrilaterals of Gamma_C, on hexahedra, are divided into sixteen equal parts.

    solution : ContactSolution of a discontinuous method, 2D or 3D, also one that is divided already: its ends are looked for
        again.  Where no facet is to be divided it is returned itself
    tol : of the law residual, no unit

    Raises ProblemError for continuous methods, whose contact points are nodes, for solutions that have not converged and for
    later states of histories; NotConvergedError, SolveInterrupted as `SemismoothNewtonSolver`.

    >>> from ngdgc import *
    >>> from ngdgc.cases import example_4_2
    >>> solution = example_4_2.Main(order=2, n=8)
    >>> divided = SolveDivided(solution)
    >>> print(f"{solution.normalforce:.3f} {divided.normalforce:.3f}, 25.143 on fine meshes")
    25.159 25.141, 25.143 on fine meshes
    """
    CheckSolution(solution)
    disc = solution.disc
    RefuseHistories(disc)
    if not disc.method.discontinuous:
        raise ProblemError(f"the solution is of {disc.method.name}, a continuous method, whose contact points are nodes, and "
                           "others would determine no more; take a discontinuous one such as InteriorPenalty()")
    if not solution.converged:
        raise ProblemError("the solution has not converged, and its zones end elsewhere; give one that has")
    solver = SemismoothNewtonSolver(tol=tol)
    with solution.state.Restored():
        pieces = _Parts(solution)
        if not pieces:
            return solution
        divided = OnPieces(disc, pieces)
        last, seconds = FromPrediction(solver, divided, Transfer(solution, divided.contact), None)
    levels = [*solution.levels, LevelOf(last.disc, last.history, seconds, True)]
    again = ContactSolution(last.disc, last.vector, last.traction, history=last.history, levels=levels,
                            solver=f"SolveDivided(tol={tol:g})")
    again.case = solution.case
    return again


def _Parts(solution: ContactSolution) -> Pieces:
    """The parts of the facets in which contact ends, where the foundation is softer than the body."""
    disc = solution.disc
    graph, rules = ContactGraph(disc.contact, BodyStiffness(disc)), ContactRules(disc.method, disc.mesh.dim, disc.order)
    openings = Openings(graph, graph.Coordinates(solution.displacement, solution.traction))
    # A facet may be in contact beyond its points alone.
    r = np.where(solution.zones == SEPARATION, solution.penetration.max(), solution.penetration)
    stiff = disc.contact.boundaryelements[disc.contact.PressureDerivative(r) > graph.scale]
    found = ZonePieces(disc.facets, disc.contact, openings, rules, disc.pieces)
    return {number: parts for number, parts in found.items() if number not in stiff}
