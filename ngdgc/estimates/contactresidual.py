"""How far a solution is from the law of contact between the contact points."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..blocks.integrals import SymmetricBasis
from ..contact.boundary import ContactBoundary
from ..contact.graph import ContactGraph
from ..contracts import Array
from ..discrete.problem import DiscreteProblem
from ..mesh.checks import Middles
from ..problem.materials import StiffnessAt
from ..solution.solution import ContactSolution

FINE = 10       # quadrature degrees on Gamma_C beyond 2 k: zones end inside of facets


def ContactResidual(solution: ContactSolution) -> Array:
    """1/gamma |t - t(t + gamma u_h)|^2 over Gamma_C, t = -C eps(u_h) n, of the elements there, (elements,) [stress length^d].

    t(q) is the traction of the point q of the graph of the law (`contact.graph`), with gamma = c k/h, c as in `Softest`.  On
    the graph nothing is left, however stiff the foundation; in separation what is left is |t|^2/gamma, and in stick it is what
    the displacement would take, gamma |u_h|^2.
    """
    disc = solution.disc
    dim, order = disc.mesh.dim, disc.order
    scalar = disc.method.ScalarSpace(disc.mesh, order)
    contact = ContactBoundary(disc.problem, disc.facets, disc.space, scalar, 2 * order + FINE)
    elements = contact.inside["nr"]
    gamma = order * Softest(disc)[elements] / contact.measures ** (1 / (dim - 1))
    stress = np.asarray(disc.problem.frame.Plane(solution.stress)(contact.inside)).reshape(-1, dim, dim)
    traction = -np.einsum("nij,nj->ni", stress, contact.outward)
    graph = ContactGraph(contact, gamma)
    point = graph.At(graph.Coordinates(contact.Displacement(solution.vector), traction))
    square = np.sum((traction - point.traction) ** 2, axis=1) / gamma
    shares: Any = np.bincount(elements, contact.weights * square, minlength=disc.mesh.ne)
    return shares


def Softest(disc: DiscreteProblem) -> Any:
    """c, the smallest eigenvalue of C in the middle of the elements, (elements,) [stress]; 2 mu of Hooke's if lam >= 0."""
    mesh, material, dim = disc.mesh, disc.problem.material, disc.problem.frame.Directions(disc.mesh.dim)
    basis = SymmetricBasis(dim)
    basis /= np.sqrt(np.einsum("cij,cij->c", basis, basis))[:, None, None]
    points = Middles(mesh)
    C = StiffnessAt(material, points[:1] if material.bonus == 0 else points, dim)
    smallest = np.linalg.eigvalsh(np.einsum("cij,nijkl,dkl->ncd", basis, C, basis))[:, 0]
    return np.broadcast_to(smallest, mesh.ne)
