"""Gamma_C discretised: displacement at its quadrature points, laws there, tractions turned into loads.

The same for every method: with T the trace of V_h at the points, W the quadrature weights and t the traction that the
body exerts on the foundation, t = p_n n + p_t lambda, the discrete problem reads  A u = f - T' W t,  t = law(T u).
"""

from __future__ import annotations

from copy import copy
from typing import Any, cast

import numpy as np
from ngsolve import VOL, ElementId, FESpace

from ..contracts import Array
from ..data.coefficients import ValuesAt
from ..exceptions import ProblemError
from ..mesh.components import Connected
from ..mesh.facets import Facets
from ..mesh.pieces import Pieces
from ..problem.problem import ContactProblem
from ..tools import sparse as sp
from .directions import LawNormals, Unit
from .parts import CheckFinite, ContactPart, OverParts
from .punches import Punches
from .sides import Faces

SAME = 1e-12        # squared relative distance of two traces that is round-off
CORNER = 0.7        # cosine of the angle between normals from which on neighbours form a smooth boundary


def Scale(vectors: Array) -> float:
    """Largest length of vectors (n, d), or 1 if all vanish."""
    return np.linalg.norm(vectors, axis=1).max(initial=0) or 1.0


class ContactBoundary:
    """All foundations of a problem on one mesh, n contact points in d dimensions.

    These are the points of a quadrature rule.  Where conforming elements have one value for several facets its points are one
    contact point with the sum of the weights: tractions that only their traces could tell apart would not be determined.

    rules, pieces : of the quadrature, as for `BoundaryQuadrature.On`

    Attributes
    ----------
    coordinates : (n, d);  weights, gap : (n,) [length^(d-1)], [length]
    normals, outward : (n, d) unit vectors, along which the law acts, and the outward normals; of a foundation without a normal
        of its own they are the same
    boundaryelements, members : (pairs,), the pairs of a boundary element and a contact point on it; of discontinuous methods
        every point is in one pair
    measures : (n,) of the facet, or the mean of several [length^(d-1)]
    trace : sparse ((n i), ndof), row n d + i gives component i of u_h, on a joint of its jump [u_h], at point n
    joined : (n,) True on joints;  beyond : mesh points on their second side, elsewhere those of `inside`
    tension, depth : (n,) of the `bonds.Bond` of joints, else 0 [stress], [length]
    shear : shear modulus inside (n,) [stress]
    flexibility : extent of Gamma_C over the smallest shear modulus there [length/stress]
    parts : list of `ContactPart`, one for each foundation, in the order of the points
    origin : u_t from which slip counts (n, d) [length], that of the state before and of rigid punches; None: 0
    path, worn : (n,), path of the slip up to the state before, and depth worn off [length]
    punches : the `Punches`, or None;  moved : how far they have moved (n, d) [length], of which `found` is not prescribed;
        gap : `given` + worn + moved.N
    """

    origin: Array | None = None
    before: Array | None = None     # u_t of the state before, relative to the punches
    punches: Punches | None = None
    moved: Array | float = 0.0
    found: Array | float = 0.0

    def __init__(self, problem: ContactProblem, facets: Facets, space: FESpace, scalar: FESpace, rules: Any,
                 pieces: Pieces | None = None) -> None:
        # Over the quadrature points of all foundations, which are the pairs; then over the n contact points.
        sides = [Faces(facets, foundation, rules, pieces) for foundation in problem.foundation]
        parts, joints = [first for first, *_ in sides], [len(both) > 1 for both in sides]
        points, inside, coordinates, normals, weights, self.boundaryelements = (
            np.concatenate([getattr(part, name) for part in parts])
            for name in ("points", "inside", "coordinates", "normals", "weights", "boundaryelements"))
        owner = np.repeat(np.arange(len(parts)), [len(part.weights) for part in parts])
        dim, trace = normals.shape[1], TraceMatrix(space, scalar, inside)
        self.joined, self.beyond = np.array(joints)[owner], inside.copy()
        if any(joints):
            self.beyond = np.concatenate([both[-1].inside for both in sides])
            trace = trace - sp.diags(np.repeat(self.joined, dim).astype(float)) @ TraceMatrix(space, scalar, self.beyond)
        self.members = SharedPoints(trace[::dim], normals, owner, self.boundaryelements)     # pairs -> n
        _, first = np.unique(self.members, return_index=True)
        self.weights = cast(Array, np.bincount(self.members, weights))
        mean = sp.csr_matrix((weights / self.weights[self.members], (self.members, np.arange(len(weights)))))   # n, pairs
        _, number = np.unique(self.boundaryelements, return_inverse=True)
        plain = facets.measure[facets.boundary[0][self.boundaryelements]]
        self.measures = mean @ (plain if facets.frame.revolved else np.bincount(number, weights)[number])
        directions = [LawNormals(foundation, part, facets.mesh.Boundaries(foundation.boundary))
                      for foundation, part in zip(problem.foundation, parts)]
        self.outward, self.normals = Unit(mean @ normals), Unit(mean @ np.concatenate(directions))
        self.coordinates, self.inside, points, owner = coordinates[first], inside[first], points[first], owner[first]
        self.beyond, self.joined = self.beyond[first], self.joined[first]
        self.trace = trace[(first[:, None] * dim + np.arange(dim)).ravel()]
        self.shear = problem.material.ShearAt(self.inside)
        beyond = problem.material.ShearAt(self.beyond) if any(joints) else self.shear
        self.flexibility = np.ptp(self.coordinates, axis=0).max() / min(self.shear.min(), beyond.min())
        self.gap = np.empty(len(self.weights))
        self.given, self.parts = self.gap, []
        self.path = self.worn = np.zeros_like(self.gap)
        for place, foundation in enumerate(problem.foundation):
            here = slice(*np.searchsorted(owner, [place, place + 1]))
            region = facets.mesh.Boundaries(foundation.boundary)
            self.gap[here] = ValuesAt(foundation.gap, points[here], f"{foundation.kind} {foundation.boundary!r}: gap", region)
            self.parts.append(ContactPart.On(foundation, here, points[here], region))
        self.depth, self.tension = (np.concatenate([getattr(part.bond, name) if part.bond else np.zeros(np.sum(owner == place))
                                                    for place, part in enumerate(self.parts)]) for name in ("depth", "tension"))
        self.punches = Punches.Of(self.parts, self.coordinates, points, facets.mesh, facets.frame)

    @property
    def wears(self) -> bool:
        """True if one of the foundations has a wear law."""
        return any(part.wear is not None for part in self.parts)

    @property
    def dim(self) -> int:
        return self.normals.shape[1]

    def Within(self, prolongation: sp.csr_matrix) -> ContactBoundary:
        """The same points and laws for displacements P x, from their coefficients x; P scipy (ndof, unknowns)."""
        other = copy(self)
        other.trace = self.trace @ prolongation
        return other

    def After(self, displacement: Array | None, path: Array | None = None, worn: Array | None = None) -> ContactBoundary:
        """The same with slip that counts from a displacement of the points, (n, d), or None: the undeformed body.

        path, worn : (n,) as the attributes, None: 0.  Displacements are relative to rigid punches, which are where they were
        prescribed to be.
        """
        for array, shape in ((displacement, self.normals.shape), (path, self.gap.shape), (worn, self.gap.shape)):
            if array is not None and np.shape(array) != shape:
                raise ProblemError(f"a state to begin with has shape {np.shape(array)}, and this Gamma_C {shape}; give arrays "
                                   "of a state at these contact points, such as solution.displacement")
        other = copy(self)
        other.before = None if displacement is None else self.Tangential(displacement)
        other.path, other.worn = (np.zeros_like(self.given) if array is None else array for array in (path, worn))
        other.parts = [part.After(other.path[part.points]) for part in self.parts]
        return other.Moved(None)

    def Moved(self, motion: Array | None) -> ContactBoundary:
        """The same with rigid punches moved by `motion` (m,), in units of `punches`; None: where they were prescribed to be."""
        other = copy(self)
        other.found = 0.0
        other.gap, other.origin = self.given + self.worn, self.before
        if self.punches is not None:
            other.moved = moved = self.punches.placed
            if motion is not None:
                other.found = np.einsum("m,mnd->nd", motion, self.punches.traces)
                other.moved = moved = moved + other.found
            other.gap = other.gap + self.Normal(moved)
            other.origin = self.Tangential(moved) if self.before is None else self.before + self.Tangential(moved)
        return other

    def WithPunches(self) -> ContactBoundary:
        """The same points and laws for body and punches: displacements are those relative to what has yet to be found of M.

        Coefficients are (u, c), those of the body and m motions in units of `punches`.
        """
        other = self.Moved(None)
        if self.punches is not None:
            other.trace = sp.hstack([self.trace, -self.punches.traces.reshape(self.punches.count, -1).T], format="csr")
        return other

    def Displacement(self, vector: Array) -> Array:
        """u_h at the points, (n, d), from the coefficients in V_h."""
        return (self.trace @ vector).reshape(-1, self.dim)

    def Normal(self, vectors: Array) -> Array:
        """v_n = v.n, (n,)."""
        return np.einsum("ni,ni->n", vectors, self.normals)

    def Tangential(self, vectors: Array) -> Array:
        """v_t = v - v_n n, (n, d)."""
        return vectors - self.Normal(vectors)[:, None] * self.normals

    def Penetration(self, displacement: Array) -> Array:
        """r = u_n - g, (n,) [length]."""
        return self.Normal(displacement) - self.gap

    def Pressure(self, r: Array) -> Array:
        """p_n(r), (n,) [stress]."""
        return self._Finite("Pressure", OverParts(self.parts, ContactPart.Pressure, r), r)

    def PressureDerivative(self, r: Array) -> Array:
        """p_n'(r), (n,) [stress/length]."""
        return self._Finite("PressureDerivative", OverParts(self.parts, ContactPart.PressureDerivative, r), r)

    def Bound(self, r: Array, slip: Array) -> Array:
        """p_t from penetration and slip |u_t|, (n,) [stress]; zero where there is no friction law."""
        # One after the other, so that the one that is not finite is the one that is named.
        bound = self._Finite("Bound", OverParts(self.parts, ContactPart.Bound, r, self.Pressure(r)), r)
        factor, _ = OverParts(self.parts, ContactPart.SlipFactor, slip)
        return bound * self._Finite("Coefficient", factor, slip, "slip")

    def SinceOrigin(self, displacement: Array) -> Array:
        """u without the u_t from which slip counts, (n, d) [length]."""
        return displacement if self.origin is None else displacement - self.origin

    def Slip(self, displacement: Array) -> Array:
        """|u_t| since `origin`, (n,) [length]."""
        return np.linalg.norm(self.Tangential(self.SinceOrigin(displacement)), axis=1)

    def _Finite(self, method: str, values: Array, at: Array, word: str = "penetration") -> Array:
        CheckFinite(self.parts, method, values, at, word)
        return values

    def TraceProjection(self, traction: Array, *, there: ContactBoundary | None = None) -> Array:
        """The part of a traction (n, d) that the body feels: its projection on the traces of V_h in L2(Gamma_C), (n, d).

        there : the points at which it is returned, of another ContactBoundary of V_h; None: these
        Where the points outnumber the traces (triangles of Gamma_C at higher orders) the rest is not determined by equilibrium.
        """
        import scipy.sparse.linalg as spla  # slow to import

        root = np.repeat(np.sqrt(self.weights), self.dim)
        used = np.flatnonzero(np.diff(self.trace.tocsc().indptr))
        traces = sp.diags(root) @ self.trace[:, used]
        coefficients = spla.lsmr(traces, root * traction.ravel(), atol=1e-14, btol=1e-14, conlim=0, maxiter=10 * len(used))[0]
        return np.asarray((there or self).trace[:, used] @ coefficients).reshape(-1, self.dim)

    def Stiffness(self, stiffness: Array) -> sp.csr_matrix:
        """T' W D T of a stiffness D (n, d, d) [stress/length], scipy CSR (ndof, ndof)."""
        n, dim = self.normals.shape
        weighted = self.weights[:, None, None] * stiffness
        diagonal = sp.bsr_matrix((weighted, np.arange(n), np.arange(n + 1)), shape=(n * dim, n * dim)).tocsr()
        return (self.trace.T @ diagonal @ self.trace).tocsr()

    def Load(self, traction: Array) -> Array:
        """The coefficients of v -> int_GammaC t.v for t at the points, (n, d) -> (ndof,)."""
        if np.shape(traction) != self.normals.shape:
            raise ProblemError(f"traction has shape {np.shape(traction)}; give one at the contact points, {self.normals.shape}")
        return self.trace.T @ (self.weights[:, None] * traction).ravel()


def SharedPoints(traces: sp.csr_matrix, normals: Array, owner: np.ndarray, facets: np.ndarray) -> np.ndarray:
    """The number of its contact point for every quadrature point, (n,), ascending with the first quadrature point of each.

    Points are one if all displacements agree there, on different facets (n,) of the same foundation (`owner`, (n,)) that form
    no corner.
    traces : sparse (n, nscalar), values of the shape functions of one component at the n quadrature points;  normals : (n, d)
    """
    gram = (traces @ traces.T).tocoo()
    size, i, j = gram.diagonal(), gram.row, gram.col
    same = size[i] + size[j] - 2 * gram.data < SAME * size[i]
    same &= (owner[i] == owner[j]) & (facets[i] != facets[j]) & (np.einsum("ni,ni->n", normals[i], normals[j]) > CORNER)
    return Connected(len(size), i[same], j[same])


def TraceMatrix(space: FESpace, scalar: FESpace, points: np.ndarray) -> sp.csr_matrix:
    """The sparse matrix that maps coefficients in `space` to values at volume mesh points, row n d + i for component i.

    `scalar` is the space of one component; NGSolve numbers the dofs of an element component after component.
    """
    dim = space.mesh.dim
    rows, columns, entries = [], [], []
    last = None
    for number, (x, y, z, element) in enumerate(zip(points["x"], points["y"], points["z"], points["nr"])):
        if element != last:
            here, last = ElementId(VOL, int(element)), element
            function, dofs = scalar.GetFE(here), np.array(space.GetDofNrs(here)).reshape(dim, -1)
        shape = np.array(function.CalcShape(x, y, z))
        for component in range(dim):
            rows.append(np.full(len(shape), number * dim + component))
            columns.append(dofs[component])
            entries.append(shape)
    return sp.csr_matrix((np.concatenate(entries), (np.concatenate(rows), np.concatenate(columns))),
                         shape=(len(points) * dim, space.ndof))
