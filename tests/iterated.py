"""Bodies whose equations are iterated, and the steps that this takes."""

import numpy as np
import pytest
import scipy.sparse as sp
from ngsolve import CF

from ngdgc import ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty, NormalCompliance
from ngdgc.mesh.facets import Csr, Native
from ngdgc.linear.conjugategradients import IterativeInverse


def Block(mesh, method=None, *, order=1, held=True, E=1, nu=0.3):
    """A body under its weight, clamped at its top or held by friction at its bottom alone, where contact is."""
    weight = (0.3,) * (mesh.dim - 1) + (-1,)
    foundation = Foundation("bottom", NormalCompliance(1), friction=CoulombFriction(0.3))
    problem = ContactProblem(HookeMaterial(E=E, nu=nu), foundation,
                             dirichlet={"top": CF((0,) * mesh.dim)} if held else None, bodyforce=weight)
    return Discretization(problem, method or InteriorPenalty(), mesh, order=order)


def WithContact(disc, normal, tangential=0.0):
    """A + T' W D T with D = normal n n' + tangential (I - n n')."""
    contact = disc.contact
    n = contact.normals
    D = (normal - tangential) * np.einsum("pi,pj->pij", n, n) + tangential * np.eye(contact.dim)
    entries = contact.weights[:, None, None] * D
    weights = sp.bsr_matrix((entries, np.arange(len(n)), np.arange(len(n) + 1))).tocsr()
    return Native(Csr(disc.matrix) + (contact.trace.T @ weights @ contact.trace).tocsr())


def Steps(disc, matrix, **options):
    """Number of steps to a true residual of 1e-8, or of its rounding; computed here, not by the solver."""
    inverse = IterativeInverse(disc, matrix, **options)
    u = inverse.Solve(disc.load)
    entries, size = Csr(matrix), np.linalg.norm(disc.load)
    residual = np.linalg.norm(entries @ u - disc.load) / size
    # Of the products, which are summed in another order here; ten of it are accepted, as `IterativeInverse` says.
    rounding = np.finfo(float).eps * np.linalg.norm(entries.diagonal() * u) / size
    assert residual <= max(1e-8, 11 * rounding) and residual == pytest.approx(inverse.residual, rel=1e-3, abs=rounding)
    return inverse.iterations


NEARLY = 0.499
