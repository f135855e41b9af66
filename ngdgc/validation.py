"""A problem held against a mesh: every mistake in regions and data is named before anything is solved."""

import numpy as np
from ngsolve import CF, L2, GridFunction, Mesh

from .coefficients import ValuesAt, VectorsAt
from .exceptions import ProblemError
from .facets import Projected, RigidMotions, RigidMotionsAt, VolumePoints
from .meshchecks import CheckBoundary, CheckElements, CheckSides
from .quadrature import BoundaryQuadrature

CHECK_ORDER = 4     # of the quadrature at whose points data are looked at
DEPTHS = 10.0 ** np.arange(-6, 1)   # penetrations at which a foundation may resist, in units of the extent of the body


def CheckMesh(problem, mesh):
    """Raise ProblemError unless the mesh is one, of the dimension of the problem."""
    if not isinstance(mesh, Mesh):
        raise ProblemError(f"mesh is {mesh!r}; give an ngsolve.Mesh, for example Mesh(geometry.GenerateMesh(maxh=0.1))")
    if mesh.dim not in (2, 3) or mesh.ne == 0:
        raise ProblemError(f"the mesh has dimension {mesh.dim} and {mesh.ne} volume elements; "
                           "a contact problem needs a mesh of an area in 2D or a volume in 3D")
    if problem.dim not in (None, mesh.dim):
        raise ProblemError(f"the mesh has dimension {mesh.dim}, the data of the problem have {problem.dim} "
                           "components; give both the same dimension")
    CheckElements(mesh)


def CheckProblem(problem, mesh, facets):
    """Raise ProblemError unless the problem makes sense on the mesh."""
    CheckSides(facets)
    CheckRegions(problem, mesh, facets)
    CheckData(problem, mesh, facets)


def CheckRegions(problem, mesh, facets):
    """Every region exists, lies on the outer boundary and overlaps no other."""
    names, found = np.array(mesh.GetBoundaries()), []
    for kind, region in problem.Regions():
        on = facets.On(region)
        if not on.any():
            available = ", ".join(sorted(set(names[facets.boundary[1]])))
            empty = "; Gamma_C would be empty" if kind == "foundation" else ""
            raise ProblemError(f"{kind} region {region!r} matches no boundary of the mesh{empty}; "
                               f"choose among {available}")
        for firstkind, firstregion, first in found:
            # A roller prescribes the normal component only, so a tangential traction may act there.
            if np.any(on & first) and {firstkind, kind} != {"roller", "traction"}:
                number, regions, _ = facets.boundary
                shared = " and ".join(repr(str(name)) for name in np.unique(names[regions[(on & first)[number]]]))
                raise ProblemError(f"boundary {shared} is claimed twice, by {firstkind} {firstregion!r} and by {kind} "
                                   f"{region!r}; the parts of the boundary must not overlap: give it to one of them")
        found.append((kind, region, on))
        CheckBoundary(facets, region)
        if np.any(facets.neighbours[on] > 1):
            raise ProblemError(f"{kind} region {region!r} contains facets inside the body, between two elements; "
                               "conditions are for the outer boundary only: rename the interface or the region")


def CheckData(problem, mesh, facets):
    """All coefficients are finite, of the right shape and in range at quadrature points."""
    volume = VolumePoints(mesh, CHECK_ORDER)
    problem.material.Check(mesh, volume)
    if problem.bodyforce is not None:
        VectorsAt(problem.bodyforce, volume, "bodyforce")
    for kind, at in (("dirichlet", VectorsAt), ("roller", ValuesAt), ("traction", VectorsAt)):
        for region, value in getattr(problem, kind).items():
            points = BoundaryQuadrature.On(facets, region, CHECK_ORDER).points
            at(value, points, f"{kind}[{region!r}]", mesh.Boundaries(region))
    CheckRollerTractions(problem, facets)


def CheckRollerTractions(problem, facets):
    """A traction on a roller is tangential: the normal one is the reaction to the prescribed displacement."""
    rollers = np.any([facets.On(region) for region in problem.roller], axis=0)
    for region, value in problem.traction.items():
        if not np.any(facets.On(region) & rollers):
            continue
        quadrature = BoundaryQuadrature.On(facets, region, CHECK_ORDER)
        traction = VectorsAt(value, quadrature.points, f"traction[{region!r}]", facets.mesh.Boundaries(region))
        normal = np.einsum("nd,nd->n", traction, quadrature.normals)
        # Tractions computed from a stress state carry its round-off, whose size is that of the modulus.
        roundoff = 1e-12 * problem.material.ShearAt(quadrature.inside).max()
        if np.abs(normal).max() > 1e-10 * np.abs(traction).max() + roundoff:
            raise ProblemError(f"traction[{region!r}] has a normal component on a roller, where the normal displacement is "
                               "prescribed; give the tangential part alone")


def Supports(problem, facets, contact):
    """How much dirichlet and roller resist rigid motions, matrices (parts, modes, modes); ProblemError for a body that floats.

    A motion is resisted where the displacement it causes is prescribed, on all components or on the normal one; a
    foundation resists normal motion where its pressure at some depth is positive, and tangential motion where friction is.
    """
    parts, modes = facets.component.max() + 1, len(RigidMotionsAt(np.zeros((1, facets.mesh.dim))))
    held, touched = np.zeros((2, parts, modes, modes))
    for kind, region in problem.Regions():
        if kind in ("dirichlet", "roller"):
            quadrature = BoundaryQuadrature.On(facets, region, CHECK_ORDER)
            motions = _CentredMotions(facets, quadrature.coordinates, quadrature.elements)
            if kind == "roller":
                motions = np.einsum("cmnd,nd->cmn", motions, quadrature.normals)[..., None]
            held += np.einsum("camd,cbmd,m->cab", motions, motions, quadrature.weights)
    motions = _CentredMotions(facets, contact.coordinates, contact.inside["nr"])
    across = np.einsum("cmnd,nd->cmn", motions, contact.normals)[..., None]
    along = motions - across * contact.normals
    for resisted, resists in zip((across, along), _Resistance(facets, contact)):
        touched += np.einsum("camd,cbmd,m->cab", resisted, resisted, contact.weights * resists)
    for part, gram in enumerate(held + touched):
        # The modes are scaled to the body, so zero means zero to round-off.
        free = _Null(gram)
        if len(free):
            raise ProblemError(f"the body floats: nothing resists {_Words(free, facets, part)}, neither dirichlet nor roller "
                               "nor a foundation with a stiffness; hold it with dirichlet or roller")
    return held


def _Resistance(facets, contact):
    """(pressure, friction): True where the law gives one at some depth up to the size of the body, over contact points."""
    pressed, rubbed = np.zeros((2, len(contact.weights)), dtype=bool)
    for _, here, compliance, friction in contact.parts:
        for depth in _Centres(facets)[1] * DEPTHS:
            r = np.full(here.stop - here.start, depth)
            with np.errstate(all="ignore"):     # a law may end at some penetration
                pressure = compliance.Pressure(r)
                pressed[here] |= pressure > 0
                if friction is not None:
                    rubbed[here] |= friction.Bound(r, pressure) > 0
    return pressed, rubbed


def FreeMotion(facets, supports):
    """Words for the rigid motions that supports (parts, modes, modes) leave free, or None."""
    for part, gram in enumerate(supports):
        free = _Null(gram)
        if len(free):
            return _Words(free, facets, part)
    return None


def Springs(facets, space, matrix):
    """How much a matrix (scipy) on a space resists rigid motions, matrices (parts, modes, modes) of no unit."""
    dim, (centres, size) = facets.mesh.dim, _Centres(facets)
    here, grams = GridFunction(L2(facets.mesh, order=0)), []
    for part, centre in enumerate(centres):
        here.vec.FV().NumPy()[:] = facets.component == part
        modes = []
        for mode, shift in zip(RigidMotions(dim), RigidMotionsAt(centre[None])):
            turning = len(modes) >= dim
            modes.append(Projected(space, here * ((mode - CF(tuple(shift[0]))) / size if turning else mode)))
        gram = np.array(modes) @ (matrix @ np.array(modes).T)
        grams.append((gram + gram.T) / (2 * np.abs(np.trace(gram)) or 1))
    return np.array(grams)


def _Null(gram):
    values, vectors = np.linalg.eigh(gram)
    return vectors[:, values <= 1e-10 * np.trace(gram)].T


def _CentredMotions(facets, coordinates, elements):
    """Rigid motions of every connected part at points in elements, (parts, modes, n, d), scaled to the size of the body."""
    centres, size = _Centres(facets)
    parts = facets.component[elements]
    motions = RigidMotionsAt((coordinates - centres[parts]) / size)
    return np.array([motions * (parts == part)[None, :, None] for part in range(len(centres))])


def _Centres(facets):
    """(centres (parts, d) of the connected parts, size of the body), from the vertices of elements: there may be others."""
    points, parts = facets.mesh.ngmesh.Coordinates()[:, :facets.mesh.dim], facets.component
    members = []
    for part in range(parts.max() + 1):
        inside = np.zeros(len(points) + 1, dtype=bool)      # the last one for the -1 that fill up
        inside[facets.vertices[parts == part]] = True
        members.append(points[inside[:-1]])
    return np.array([member.mean(axis=0) for member in members]), np.ptp(np.concatenate(members), axis=0).max()


def _Words(null, facets, part):
    """Words for a basis of free motions, over translations and rotations."""
    dim = facets.mesh.dim
    centre = _Centres(facets)[0][part]
    words = [f"translation along {axis}" for axis in "xyz"[:dim]]
    if dim == 2:
        words.append(f"rotation about ({centre[0]:.3g}, {centre[1]:.3g})")
    else:
        words += [f"rotation about an axis along {axis} through ({', '.join(f'{c:.3g}' for c in centre)})" for axis in "xyz"]
    basis = []
    for vector in null:
        leading = np.argsort(-np.abs(vector))
        basis.append(" with ".join(words[i] for i in leading if abs(vector[i]) > 0.1))
    where = f" in part {part + 1} of the mesh" if facets.component.max() else ""
    return " and ".join(basis) + where
