"""A problem held against a mesh: every mistake in regions and data is named before anything is solved."""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import FESpace, Mesh

from ..contracts import Array, Method, Missing
from ..data.coefficients import CheckRange, EntriesAt, ValuesAt, VectorsAt
from ..data.inside import CheckMaterials
from ..data.regions import Matching
from ..exceptions import ProblemError
from ..mesh.checks import CheckBoundary, CheckElements, CheckSides
from ..mesh.facets import Facets, SecondOrder, VolumePoints
from ..mesh.quadrature import BoundaryQuadrature
from ..methods.coercivity import CheckCoercivity, CheckSum
from ..problem.problem import ContactProblem
from ..tools.values import Among
from .section import CheckSection, CheckSpatial, OnAxis

CHECK_ORDER = 4     # of the quadrature at whose points data are looked at
# A roller prescribes the normal component only, so a tangential traction may act there; springs take up what they are given.
SHARED = ({"roller", "traction"}, {"spring", "traction"}, {"spring", "force"})


def CheckKinds(problem: Any, method: Any, assembly: Any) -> None:
    """Raise ProblemError unless these are a ContactProblem, a method and a way of assembly."""
    if not isinstance(problem, ContactProblem):
        raise ProblemError(f"problem is {problem!r}; give a ContactProblem")
    if isinstance(method, type) or (missing := Missing(method, Method)):
        lack = "" if isinstance(method, type) else f", which has no {', '.join(missing)}"
        raise ProblemError(f"method is {method!r}{lack}; give an object such as InteriorPenalty() or Conforming()")
    if not Among(assembly, ("facet", "skeleton")):
        raise ProblemError(f"assembly is {assembly!r}; choose 'facet' or 'skeleton'")


def CheckMesh(problem: ContactProblem, mesh: Any) -> None:
    """Raise ProblemError unless the mesh is one, of the dimension of the problem."""
    if not isinstance(mesh, Mesh):
        raise ProblemError(f"mesh is {mesh!r}; give an ngsolve.Mesh, for example Mesh(geometry.GenerateMesh(maxh=0.1))")
    if mesh.dim not in (2, 3) or mesh.ne == 0:
        raise ProblemError(f"the mesh has dimension {mesh.dim} and {mesh.ne} volume elements; "
                           "a contact problem needs a mesh of an area in 2D or a volume in 3D")
    if problem.axisymmetric:
        CheckSection(mesh)
    if problem.dim not in (None, mesh.dim):
        raise ProblemError(f"the mesh has dimension {mesh.dim}, the data of the problem have {problem.dim} "
                           "components; give both the same dimension")
    CheckElements(mesh)


def CheckRegions(problem: ContactProblem, mesh: Mesh, facets: Facets) -> None:
    """Every region exists, lies on the outer boundary and overlaps no other, and sides of elements are what they seem."""
    CheckSides(facets)
    names = np.array(mesh.GetBoundaries())
    found: list[tuple[str, str, np.ndarray]] = []
    for kind, region in problem.Regions():
        Matching(mesh, region, kind, there=facets.boundary[1], note="; Gamma_C would be empty" if kind == "foundation" else "")
        on = facets.On(region)
        for firstkind, firstregion, first in found:
            if np.any(on & first) and {firstkind, kind} not in SHARED:
                number, regions, _ = facets.boundary
                shared = " and ".join(repr(str(name)) for name in np.unique(names[regions[(on & first)[number]]]))
                raise ProblemError(f"boundary {shared} is claimed twice, by {firstkind} {firstregion!r} and by {kind} "
                                   f"{region!r}; the parts of the boundary must not overlap: give it to one of them")
        found.append((kind, region, on))
        CheckBoundary(facets, region)
        if problem.axisymmetric and np.any(on & OnAxis(facets)):
            raise ProblemError(f"{kind} region {region!r} lies on the axis of the body, which is no part of its surface: "
                               "nothing is given there, u_r = 0 by nature; leave it out, or name the rest alone")
        if kind == "joint":
            if np.any(facets.neighbours[on] < 2):
                raise ProblemError(f"joint region {region!r} contains facets of the outer boundary; a joint lies between two "
                                   "elements: give a Foundation there, or name the interface alone")
        elif np.any(facets.neighbours[on] > 1):
            raise ProblemError(f"{kind} region {region!r} contains facets inside the body, between two elements; "
                               "conditions are for the outer boundary only: give a Joint there, or rename the interface")


def CheckJoints(problem: ContactProblem, method: Method, mesh: Mesh, assembly: str) -> None:
    """Joints need a form that leaves their facets out, and continuous functions a mesh whose nodes can be doubled there."""
    if problem.joints and not method.discontinuous and (SecondOrder(mesh) or mesh.deformation is not None):
        raise ProblemError(f"the mesh has elements of second order or a deformation, and method {method.name} needs its nodes "
                           f"doubled on joint {problem.joints[0]!r}; take a discontinuous method such as LDG()")
    if problem.joints and method.discontinuous and assembly == "skeleton":
        raise ProblemError(f"assembly is 'skeleton', which couples elements across joint {problem.joints[0]!r}; take 'facet'")


def CheckSpace(method: Method, space: Any, scalar: Any, mesh: Mesh, clamped: str) -> None:
    """The space of a method has d components of its scalar space, and leaves dofs on Gamma_D free as the method says.

    clamped : "a|b", the regions of Gamma_D, or ""
    """
    if not isinstance(space, FESpace) or not isinstance(scalar, FESpace) or space.ndof != mesh.dim * scalar.ndof:
        found, own = (f"{type(one).__name__} of {getattr(one, 'ndof', 'no')} dofs" for one in (space, scalar))
        raise ProblemError(f"method {method.name} has a Space {found} and a ScalarSpace {own}; give NGSolve's VectorL2 or "
                           f"VectorH1 and the space of its {mesh.dim} components")
    if not clamped:
        return
    there = space.GetDofs(mesh.Boundaries(clamped))
    held = (there & ~space.FreeDofs()).NumSet()
    if method.weak and held:
        raise ProblemError(f"method {method.name} says that displacements on Gamma_D are weak, and its space holds {held} dofs "
                           "there; leave them free, or say weak = False")
    if not method.weak and (held < there.NumSet() or not held):
        raise ProblemError(f"method {method.name} says that displacements on Gamma_D are not weak, and its space holds {held} "
                           f"of {there.NumSet()} dofs there; hold those of `clamped`, or say weak = True")


def CheckPart(disc: Any, part: Any, name: str, axes: int) -> None:
    """What the form of a DiscreteProblem gives is as large as the space."""
    found, wanted = getattr(part, "shape", None), (disc.space.ndof,) * axes
    if found != wanted:
        raise ProblemError(f"the form of method {disc.method.name} gives {name} of shape {found}; its space has {wanted}")


def CheckData(problem: ContactProblem, mesh: Mesh, facets: Facets) -> None:
    """All coefficients are finite, of the right shape and in range at quadrature points."""
    volume = VolumePoints(mesh, CHECK_ORDER)
    problem.material.Check(mesh, volume)
    if problem.axisymmetric:
        CheckSpatial(problem.material, mesh, volume)
    for name, value in vars(problem.material).items():
        for entry in np.ravel(np.array(value, dtype=object)):   # of a matrix, too
            CheckMaterials(entry, mesh, name)
    if problem.bodyforce is not None:
        VectorsAt(problem.bodyforce, volume, "bodyforce")
    for kind, at in (("dirichlet", VectorsAt), ("roller", ValuesAt), ("traction", VectorsAt), ("force", VectorsAt),
                     ("spring", StiffnessesAt)):
        for region, value in getattr(problem, kind).items():
            points = BoundaryQuadrature.On(facets, region, CHECK_ORDER).points
            found = at(value, points, f"{kind}[{region!r}]", mesh.Boundaries(region))
            if kind == "force":
                CheckForce(found, f"force[{region!r}]")
    CheckRollerTractions(problem, facets)


def StiffnessesAt(value: Any, points: np.ndarray, name: str, region: Any) -> Array:
    """Stiffnesses of springs at points, (n,) or (n, d), none of them negative."""
    found = EntriesAt(value, points, name, region)
    CheckRange(found, name, least=0)
    return found


def CheckForce(values: Array, name: str) -> None:
    """Raise ProblemError for a force whose values (n, d) at points of its region differ: it is a total."""
    if np.ptp(values, axis=0).max() > 1e-12 * np.abs(values).max():
        raise ProblemError(f"{name} varies over its region; it is the total, a vector that may depend on Parameters, and is "
                           "spread evenly: give traction for what varies")


def CheckRollerTractions(problem: ContactProblem, facets: Facets) -> None:
    """A traction on a roller is tangential: the normal one is the reaction to the prescribed displacement."""
    rollers = np.any([facets.On(region) for region in problem.roller], axis=0)
    for region, value in problem.traction.items():
        if not np.any(facets.On(region) & rollers):
            continue
        quadrature = BoundaryQuadrature.On(facets, region, CHECK_ORDER)
        traction = VectorsAt(value, quadrature.points, f"traction[{region!r}]", facets.mesh.Boundaries(region))
        normal = np.einsum("ni,ni->n", traction, quadrature.normals)
        # Tractions computed from a stress state carry its round-off, whose size is that of the modulus.
        roundoff = 1e-12 * problem.material.ShearAt(quadrature.inside).max()
        if np.abs(normal).max() > 1e-10 * np.abs(traction).max() + roundoff:
            raise ProblemError(f"traction[{region!r}] has a normal component on a roller, where the normal displacement is "
                               "prescribed; give the tangential part alone")


def CheckMatrix(disc: Any, matrix: Any, elastic: Any) -> None:
    """Raise ProblemError unless A, and B_h without what was added to it, are finite and coercive."""
    if not np.all(np.isfinite(matrix.AsVector().FV().NumPy())):
        raise ProblemError("the material is not finite at some quadrature point of the elements or facets; look for a "
                           "division by zero or a root of a negative number")
    if disc.added.matrix is not None:
        CheckSum(disc.form, matrix, disc.space.FreeDofs(), disc.restraints.soft)
    else:
        CheckCoercivity(disc.form, elastic, disc.space.FreeDofs(), disc.restraints.soft)
