"""How sure the lengths of the zones are: two tractions, between contact points, tell where zones may end."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..contact.boundary import ContactBoundary
from ..contact.graph import ZONES, ContactGraph
from ..contracts import Array
from ..solution.solution import CheckSolution
from ..tools.calls import ByKeyword
from .contactresidual import FINE, Softest
from .estimate import RefuseHistories, RefuseJoints, RefusePunches


@ByKeyword
def EstimateZones(solution: Any) -> dict[str, float]:
    """Estimated errors of `solution.ZoneLengths()`, {"separation": ..., "stick": ..., "slip": ...} [length^(d-1)].

    A point belongs to the zone of q = t + gamma u_h, gamma = c k/h (`contactresidual`), on the graph of the law.  The traction
    t is known twice: as the law has it at the contact points, continued between these by the traces of V_h, and as
    -C eps(u_h) n.  The error of a zone sums over the facets e of Gamma_C the larger one of

        the measure of its points to which the two give different zones;
        |e|/(2 m), half the distance of its contact points, m^(d-1) of them on e, where a zone ends on e.

    An error of the whole, as of a coarse mesh far from Gamma_C, is not seen, and where tractions leave the law or come to it
    slowly, like the third power of the distance, ends may be off by five times that.

    solution : ContactSolution of any method;  ProblemError for anything else, and with joints

    >>> from ngdgc.cases import example_4_2
    >>> solution = example_4_2.Main(order=2, n=8)
    >>> print(f"{solution.ZoneLengths()['slip']:.2f} +- {EstimateZones(solution)['slip']:.2f}, 0.53 on fine meshes")
    0.53 +- 0.02, 0.53 on fine meshes
    """
    CheckSolution(solution)
    RefuseJoints(solution.disc.problem)
    RefusePunches(solution.disc.problem)
    solution.disc.problem.frame.Refuse("EstimateZones")
    RefuseHistories(solution.disc)
    with solution.state.Restored():
        fine, first, second = _Labels(solution)
    points = np.bincount(solution.disc.contact.boundaryelements)
    numbers, facets = np.unique(fine.boundaryelements, return_inverse=True)
    spacing = np.bincount(facets, fine.weights) / points[numbers] ** (1 / (fine.dim - 1))
    found = {}
    for zone, name in enumerate(ZONES):
        doubt = np.bincount(facets, fine.weights * ((first == zone) != (second == zone)))
        share = np.bincount(facets, first == zone) / np.bincount(facets)
        found[name] = float(np.maximum(doubt, spacing / 2 * ((share > 0) & (share < 1))).sum())
    return found


def _Labels(solution: Any) -> tuple[ContactBoundary, Array, Array]:
    """(fine, first, second): points between the contact points, and their zones by either traction."""
    disc = solution.disc
    dim, order = disc.mesh.dim, disc.order
    fine = ContactBoundary(disc.problem, disc.facets, disc.space, disc.method.ScalarSpace(disc.mesh, order), 2 * order + FINE)
    gamma = order * Softest(disc)[fine.inside["nr"]] / fine.measures ** (1 / (dim - 1))
    graph, u = ContactGraph(fine, gamma), fine.Displacement(solution.vector)
    stress = np.asarray(solution.stress(fine.inside)).reshape(-1, dim, dim)
    tractions = disc.contact.TraceProjection(solution.traction, there=fine), -np.einsum("nij,nj->ni", stress, fine.outward)
    first, second = (graph.At(graph.Coordinates(u, traction)).zones for traction in tractions)
    return fine, first, second
