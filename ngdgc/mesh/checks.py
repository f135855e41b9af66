"""What integrals need of a mesh: maps of elements that do not fold, sides that fit together, boundary elements on sides."""

from __future__ import annotations

import numpy as np
from ngsolve import BND, ET, VERTEX, Mesh, specialcf

from ..contracts import Array
from ..exceptions import ProblemError
from .facets import REFERENCE_VERTICES, SIDEVERTICES, TYPES, ByType, Curved, Facets, Vertices, VolumePoints

ROUNDOFF = 4e-15    # of coordinates, relative to the largest of them
VANISHES = 1e-10    # a determinant relative to the largest of its element
ANGLE = 1 / 8       # of the points looked at: the determinant may vanish at a straight angle, not all along a side
BATCH = 1 << 18     # points at which maps are looked at in one go
INNER = 0.95        # of curved elements: at a corner in the middle of a smooth boundary the determinant is about zero


def CheckElements(mesh: Mesh) -> None:
    """Raise ProblemError if the map of an element folds, its determinant having both signs or none, or sides are identified.

    All elements may have the negative sign.  The determinant is looked at once in affine elements, on a lattice with the
    corners in other straight ones, and on a finer one, a little inside, in curved ones.
    """
    _CheckIdentified(mesh)
    _CheckCurves(mesh)
    vertices, middles = Vertices(mesh, mesh.dim), Middles(mesh)
    # Netgen marks all that is no simplex as curved.
    curved = _Marked(mesh.ngmesh) & Curved(mesh) | (mesh.deformation is not None)
    for et, rows in ByType(vertices, mesh.dim):
        corners = vertices[rows[~curved[rows]], :len(REFERENCE_VERTICES[et])]
        affine = np.zeros(len(rows), dtype=bool)
        affine[~curved[rows]] = _Affine(mesh, et, corners)
        for some, Points in ((affine, lambda et: np.zeros((1, 3))), (~affine & ~curved[rows], lambda et: Lattice(et, 2)),
                             (curved[rows], lambda et: _Inner(et, 2 * mesh.GetCurveOrder() + 2))):
            if np.any(some):
                _CheckMaps(mesh, middles[rows[some]], Points(et))


def _Marked(mesh: Mesh) -> np.ndarray:
    """True for the elements that Netgen knows to be curved."""
    return (mesh.Elements2D() if mesh.dim == 2 else mesh.Elements3D()).NumPy()["curved"]


def _CheckCurves(mesh: Mesh) -> None:
    """Refinement leaves straight elements and the order of the curves that were; whether there is a curve a copy tells."""
    order = mesh.GetCurveOrder()
    if order == 1 or mesh.levels == 1 or mesh.ngmesh.GetGeometry() is None or _Marked(mesh.ngmesh).any():
        return
    copy = mesh.ngmesh.Copy()
    copy.Curve(order)
    if _Marked(copy).any():
        raise ProblemError(f"the mesh has order {order} but straight elements at a curved boundary, for it was refined after "
                           f"it was curved; call mesh.Curve({order}) after refinement, or mesh.Curve(1) for straight elements")


def Middles(mesh: Mesh) -> np.ndarray:
    """One mesh point in every element."""
    points = VolumePoints(mesh, 0)
    return points[np.flatnonzero(np.diff(points["nr"], prepend=-1))]


def _Affine(mesh: Mesh, et: ET, vertices: np.ndarray) -> np.ndarray:
    """True for the elements (n, vertices) that are affine images of the reference element, (n,)."""
    if et in (ET.TRIG, ET.TET):
        return np.ones(len(vertices), dtype=bool)
    corners = mesh.ngmesh.Coordinates()[vertices][..., :mesh.dim]
    reference = np.column_stack([np.ones(vertices.shape[1]), REFERENCE_VERTICES[et]])
    # What is left of the corners after the affine map that fits them best.
    rest = (np.eye(len(reference)) - reference @ np.linalg.pinv(reference)) @ corners
    return np.abs(rest).max(axis=(1, 2), initial=0) <= ROUNDOFF * np.abs(corners).max(initial=0)


def Lattice(et: ET, n: int) -> Array:
    """Points (q, 3) of the reference element with n intervals a side, first the origin.

    Of a pyramid those of its base: the derivatives of its map are constant along lines through the tip.
    """
    steps = np.arange(n + 1) / n
    r, s, t = (axis.ravel() for axis in np.meshgrid(steps, steps, steps, indexing="ij"))
    inside = {ET.TRIG: (r + s < 1 + 0.5 / n) & (t == 0), ET.QUAD: t == 0, ET.TET: r + s + t < 1 + 0.5 / n,
              ET.HEX: t >= 0, ET.PRISM: r + s < 1 + 0.5 / n, ET.PYRAMID: t == 0}[et]
    return np.stack([r, s, t], axis=1)[inside]


def _Inner(et: ET, n: int) -> Array:
    """The same points a little inside."""
    points = Lattice(et, n)
    return points.mean(axis=0) + INNER * (points - points.mean(axis=0))


def _CheckMaps(mesh: Mesh, middles: np.ndarray, reference: Array) -> None:
    """Raise ProblemError unless the determinant has one sign at reference points (q, 3) in the elements of mesh points (n,)."""
    size = max(1, BATCH // len(reference))
    for begin in range(0, len(middles), size):
        points = np.repeat(middles[begin:begin + size, None], len(reference), axis=1)
        for axis, values in zip("xyz", reference.T):
            points[axis] = values
        determinants, roundoff = _Determinants(mesh, points)
        low, high = determinants.min(axis=1), determinants.max(axis=1)
        largest = np.maximum(-low, high)
        zero = np.maximum(VANISHES * largest, roundoff)
        flat, folded = ~(largest > roundoff), (low < -zero) & (high > zero)
        collapsed = (np.abs(determinants) <= zero[:, None]).mean(axis=1) > ANGLE
        for row in np.flatnonzero(flat | folded | collapsed)[:1]:
            number, what = points["nr"][row, 0], ("area" if mesh.dim == 2 else "volume") + " zero"
            if not flat[row]:
                what = (f"a map that {'folds' if folded[row] else 'collapses'}, with a determinant from {low[row]:.3g} to "
                        f"{high[row]:.3g}")
            raise ProblemError(f"element {number} of the mesh, {_Corners(mesh, number)}, has {what}; elements must be images "
                               "of the reference element: put its corners in order, or move them, or take smaller elements at "
                               "curved boundaries")


def _Determinants(mesh: Mesh, points: np.ndarray) -> tuple[Array, Array]:
    """det dF at mesh points (n, q), and what is round-off of it, (n,)."""
    F = np.asarray(specialcf.JacobianMatrix(mesh.dim, mesh.dim)(points.ravel())).reshape(*points.shape, mesh.dim, mesh.dim)
    columns = np.moveaxis(F, (2, 3), (0, 1))
    if mesh.dim == 2:
        (a, b), (c, d) = columns
        determinants = a * d - b * c
    else:
        (a, b, c), (d, e, f), (g, h, i) = columns
        determinants = a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g)
    length = np.sqrt(np.einsum("nqij,nqij->nq", F, F).max(axis=1))
    return determinants, ROUNDOFF * np.abs(mesh.ngmesh.Coordinates()).max() * length ** (mesh.dim - 1)


def _CheckIdentified(mesh: Mesh) -> None:
    """Identified sides: NGSolve's integrals over facets couple them, half of them, whatever the space."""
    if mesh.GetPeriodicNodePairs(VERTEX):
        pairs = np.array([pair for pair, _ in mesh.GetPeriodicNodePairs(VERTEX)])
        named, vertices = np.array(mesh.GetBoundaries()), Vertices(mesh, mesh.dim - 1)
        whole = np.all(np.isin(vertices, np.append(pairs, -1)), axis=1)
        numbers = np.array([element.index for element in mesh.Elements(BND)])
        names = sorted(set(named[numbers[whole]]))
        raise ProblemError(f"sides of the mesh are identified with each other, boundary {', '.join(names)}; a body has no "
                           "periodic sides, each is free or named in the problem: make the mesh without Identify")


def CheckSides(facets: Facets) -> None:
    """Raise ProblemError unless every side belongs to at most two elements, which lie on different sides of it."""
    mesh = facets.mesh
    crowded = np.flatnonzero(facets.neighbours > 2)
    if len(crowded):
        numbers = ", ".join(str(element) for element in _Around(facets, crowded[0]))
        raise ProblemError(f"elements {numbers} of the mesh have a side in common, {_Side(facets, crowded[0])}; a side is "
                           "common to two elements at most: remove elements that occur twice or overlap")
    determinants, _ = _Determinants(mesh, Middles(mesh)[:, None])
    turns = np.empty(len(facets.ofelements))
    for et, rows in ByType(facets.vertices, mesh.dim):
        for side, local in enumerate(SIDEVERTICES[et]):
            turns[facets.starts[rows] + side] = np.sign(determinants[rows, 0]) * _Turn(facets.vertices[rows[:, None], local])
    seen = np.bincount(facets.ofelements, turns, minlength=len(facets.neighbours))
    for facet in np.flatnonzero((facets.neighbours == 2) & (seen != 0))[:1]:
        first, second = _Around(facets, facet)
        raise ProblemError(f"elements {first} and {second} of the mesh lie on the same side of what they have in common, "
                           f"{_Side(facets, facet)}; neighbours must not overlap: remove one of them or move its corners")


def _Turn(vertices: np.ndarray) -> np.ndarray:
    """1 or -1 for vertex numbers (n, 2 to 4) around a side: the opposite for those of the same side in opposite order."""
    if vertices.shape[1] == 2:
        return np.where(vertices[:, 0] < vertices[:, 1], 1, -1)
    first, rows, count = vertices.argmin(axis=1), np.arange(len(vertices)), vertices.shape[1]
    return np.where(vertices[rows, (first + 1) % count] < vertices[rows, first - 1], 1, -1)


def Sides(facets: Facets, region: str) -> np.ndarray:
    """True for the boundary elements of a region that are sides of elements, of several on one side for the first only."""
    numbers, regions, _ = facets.boundary
    rows = np.flatnonzero(np.array(list(facets.mesh.Boundaries(region).Mask()))[regions] & facets.proper)
    found = np.zeros(len(numbers), dtype=bool)
    found[rows[np.unique(numbers[rows], return_index=True)[1]]] = True
    return found


def CheckBoundary(facets: Facets, region: str) -> None:
    """Raise ProblemError unless the boundary elements of a region are sides of elements, each once."""
    mesh, (numbers, regions, vertices) = facets.mesh, facets.boundary
    names, wanted = mesh.GetBoundaries(), np.array(list(mesh.Boundaries(region).Mask()))[regions]
    for row in np.flatnonzero(wanted & ~Sides(facets, region))[:1]:
        twins = np.flatnonzero(wanted & (numbers == numbers[row]))
        if not facets.proper[row]:
            raise ProblemError(f"boundary {names[regions[row]]!r} has an element {_Between(mesh, vertices[row])}, which is no "
                               "side of an element of the body; remove it from the mesh, or give it another name")
        both = " and ".join(dict.fromkeys(repr(names[regions[twin]]) for twin in twins))
        raise ProblemError(f"the element {_Between(mesh, vertices[row])} is twice in the mesh, in boundary {both}, and would "
                           f"count twice in {region!r}; keep it once, by one physical group of Gmsh for each part of the "
                           "boundary, or name only one of the groups")


def CheckSkeleton(facets: Facets) -> None:
    """Raise ProblemError where NGSolve's bilinear forms on ds(skeleton=True) would read an element that is not there."""
    numbers, regions, vertices = facets.boundary
    for row in np.flatnonzero(facets.neighbours[numbers] == 0)[:1]:
        raise ProblemError(f"boundary {facets.mesh.GetBoundaries()[regions[row]]!r} has an element "
                           f"{_Between(facets.mesh, vertices[row])}, which is no side of an element of the body; NGSolve's "
                           "integrals over sides need a mesh without it: remove it, or take assembly='facet', without rollers "
                           "in Conforming")


def _Around(facets: Facets, facet: int) -> np.ndarray:
    return facets.incidence.indices[facets.incidence.indptr[facet]:facets.incidence.indptr[facet + 1]]


def _Side(facets: Facets, facet: int) -> str:
    element = _Around(facets, facet)[0]
    vertices = facets.vertices[element]
    sides = SIDEVERTICES[TYPES[facets.mesh.dim][int((vertices >= 0).sum())]]
    local = sides[list(facets.ofelements[facets.starts[element]:facets.starts[element + 1]]).index(facet)]
    return _Between(facets.mesh, vertices[list(local)])


def _Between(mesh: Mesh, vertices: np.ndarray) -> str:
    return "between " + " and ".join(_Point(mesh, vertex) for vertex in vertices if vertex >= 0)


def _Corners(mesh: Mesh, element: int) -> str:
    return "with corners " + ", ".join(_Point(mesh, vertex) for vertex in Vertices(mesh, mesh.dim)[element] if vertex >= 0)


def _Point(mesh: Mesh, vertex: int) -> str:
    return f"({', '.join(f'{c:.4g}' for c in mesh.ngmesh.Coordinates()[vertex][:mesh.dim])})"
