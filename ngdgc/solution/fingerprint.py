"""Arrays that tell discrete problems apart: everything that decides the equations, as values at points and on elements."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from ngsolve import CF, Integrate, Mesh

from ..contact.boundary import ContactBoundary
from ..contact.parts import ContactPart, OverParts
from ..contracts import Array
from ..data.coefficients import ValuesAt, VectorsAt
from ..discrete.problem import DiscreteProblem
from ..mesh.facets import Threads
from ..mesh.quadrature import BoundaryQuadrature

SAME = 1e-6         # relative difference of values that are the same
LEAST = 1e-10       # the same, relative to the largest value of their table: round-off of what nearly cancels
ORDER = 4           # of the quadrature at whose points boundary data are compared
DEPTHS = np.logspace(-6, 0, 13)                 # penetrations and slips at which laws are compared, relative to Gamma_C,
PARTS = np.array([0.25, 0.5, 0.75, 1, 2, 4])    # and to the largest ones of the solution
NAMES = ("points", "gaps", "loads", "energies", "pressures", "bounds", "laws", "regions", "dirichlet values", "roller values",
         "traction values", "body forces", "moduli", "added forms", "equations")
SHORT = NAMES[:7]   # what does not depend on the numbers of elements and facets, but for the loads


def Fingerprint(solution: Any, penetration: Array, slip: Array, numbering: Any) -> Iterator[tuple[str, Any]]:
    """(name, array) for all `NAMES`, each computed when it is asked for.

    numbering : (ndof,), which number the dofs have in the arrays
    penetration, slip : (n,), those that the solution had when it was saved; p_n of computed ones would, where it is stiff,
        tell no more than round-off
    """
    disc = solution.disc
    problem, contact = disc.problem, disc.contact
    yield "points", contact.coordinates
    own = any(part.foundation.normal is not None for part in contact.parts) or bool(np.any(contact.joined))
    yield "gaps", np.column_stack([contact.gap, contact.normals]) if own else contact.gap
    yield "loads", _Renumbered(disc.load, numbering)
    yield "energies", np.array([solution.energy])
    yield "pressures", contact.Pressure(penetration)
    yield "bounds", contact.Bound(penetration, slip)
    yield "laws", _Laws(contact, penetration, slip)
    yield "regions", _Regions(disc)
    for kind, at in (("dirichlet", VectorsAt), ("roller", ValuesAt), ("traction", VectorsAt)):
        yield f"{kind} values", _Prescribed(disc, kind, at)
    yield "body forces", _ByElement(disc.mesh, [] if problem.bodyforce is None else list(problem.bodyforce))
    yield "moduli", _Material(disc)
    yield "added forms", _Added(disc, numbering)
    yield "equations", _Products(disc, numbering)


def Differs(stored: Any, found: Any) -> bool:
    """True unless two arrays are the same up to round-off, entry by entry.

    An array is a column (n,), a table (n, m), or several tables (k, n, m), whose sizes may be far apart.
    """
    if stored.shape != found.shape or stored.dtype.kind != found.dtype.kind:
        return True
    if found.dtype.kind != "f":
        return not np.array_equal(stored, found)
    finite = np.isfinite(found)
    if not np.array_equal(np.where(finite, 0, found), np.where(np.isfinite(stored), 0, stored), equal_nan=True):
        return True
    stored, found = np.where(finite, stored, 0), np.where(finite, found, 0)
    size = np.abs(found)
    largest = size.max(axis=tuple(range(max(size.ndim - 2, 0), size.ndim)), keepdims=True, initial=0)
    return bool(np.any(np.abs(stored - found) > SAME * size + LEAST * largest))


def _Laws(contact: ContactBoundary, penetration: Array, slip: Array) -> Array:
    """p_n at some depths, p_t there at rest and at some slips, what wears off, one table (n, 1) for each: (k, n, 1)."""
    extent = np.ptp(contact.coordinates, axis=0).max()
    depths, slips = (np.concatenate([extent * DEPTHS, PARTS * np.abs(values).max(initial=0)]) for values in (penetration, slip))
    tables = np.zeros((len(depths), 4 if contact.wears else 3, len(contact.weights)))
    for table, depth, length in zip(tables, depths, slips):
        r, s = (np.full(len(contact.weights), value) for value in (depth, length))
        with np.errstate(all="ignore"):     # a law may end at some penetration
            table[0] = OverParts(contact.parts, ContactPart.Pressure, r)
            bound = OverParts(contact.parts, ContactPart.Bound, r, table[0])
            table[1], table[2] = (bound * OverParts(contact.parts, ContactPart.SlipFactor, at)[0] for at in (0 * s, s))
            if contact.wears:
                table[3] = OverParts(contact.parts, ContactPart.Depth, table[0], s)
    return tables.reshape(-1, len(contact.weights), 1)


def _Regions(disc: DiscreteProblem) -> Any:
    """What every boundary of the mesh is, (boundaries,) of text: kinds, and the number of the foundation."""
    kinds: list[list[str]] = [[] for _ in disc.mesh.GetBoundaries()]
    foundations = iter(range(len(disc.problem.foundation)))
    for kind, region in disc.problem.Regions():
        word = f"{kind} {next(foundations)}" if kind in ("foundation", "joint") else kind
        for number, found in enumerate(disc.mesh.Boundaries(region).Mask()):
            if found and word not in kinds[number]:
                kinds[number].append(word)
    return np.array([" ".join(sorted(words)) for words in kinds])


def _Prescribed(disc: DiscreteProblem, kind: str, at: Callable[..., Array]) -> Array:
    """Values of dirichlet, roller or traction on all its regions, in the order of the facets, (n, components)."""
    found = [(BoundaryQuadrature.On(disc.facets, region, ORDER), value, f"{kind}[{region!r}]", disc.mesh.Boundaries(region))
             for region, value in getattr(disc.problem, kind).items()]
    if not found:
        return np.zeros((0, 1))
    values = np.concatenate([at(value, quadrature.points, name, region).reshape(len(quadrature.points), -1)
                             for quadrature, value, name, region in found])
    return values[np.argsort(np.concatenate([quadrature.boundaryelements for quadrature, *_ in found]), kind="stable")]


def _ByElement(mesh: Mesh, functions: list[Any]) -> Array:
    """Integrals of scalar CoefficientFunctions over the elements, (ne, functions)."""
    with Threads(mesh):
        return np.array([np.array(Integrate(CF(function), mesh, element_wise=True)) for function in functions]).T


def _Material(disc: DiscreteProblem) -> Array:
    """C applied to one strain without symmetries, integrated over the elements, (ne, d (d + 1)/2)."""
    dim = disc.problem.frame.Directions(disc.mesh.dim)
    upper = np.triu_indices(dim)
    strain = np.zeros((dim, dim))
    strain[upper] = np.sqrt([2, 3, 5, 7, 11, 13][:len(upper[0])])
    stress = disc.problem.material.Stress(CF(tuple(np.maximum(strain, strain.T).ravel()), dims=(dim, dim)))
    return _ByElement(disc.mesh, [stress[int(i), int(j)] for i, j in zip(*upper)])


def _Renumbered(vector: Array, numbering: Any) -> Array:
    """The coefficients of a vector (ndof,) in the order of the arrays."""
    renumbered = np.empty_like(vector)
    renumbered[numbering] = vector
    return renumbered


def _Products(disc: DiscreteProblem, numbering: Any) -> Array:
    """x'A y for four pairs of vectors, (4,)."""
    vectors = np.random.default_rng(1).standard_normal((4, 2, disc.space.ndof))[..., numbering]
    return np.array([left @ disc.Multiply(right) for left, right in vectors])


def _Added(disc: DiscreteProblem, numbering: Any) -> Array:
    """A of the added bilinear forms applied to a vector, and f of the linear ones, two tables (2, ndof, 1), or none."""
    if not disc.added:
        return np.zeros((0, 1, 1))
    ndof = disc.space.ndof
    vector = np.random.default_rng(2).standard_normal(ndof)[numbering]
    applied = np.zeros(ndof) if disc.added.matrix is None else disc.added.matrix @ vector
    load = np.zeros(ndof) if disc.added.load is None else disc.added.load
    return np.array([_Renumbered(part, numbering) for part in (applied, load)])[..., None]
