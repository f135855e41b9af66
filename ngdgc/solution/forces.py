"""Forces, mean displacements and tractions on regions of the boundary and on interfaces; displacements at points."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..contracts import Array
from ..data.regions import Matching
from ..discrete.problem import DiscreteProblem
from ..exceptions import ProblemError
from ..tools.values import Vectors
from .conformingtractions import ConformingTractions
from .tractions import FacetTractions, MeanDisplacement, NumericalTractions


def Tractions(solution: Any) -> FacetTractions:
    """`FacetTractions` of a solution of any method that has some."""
    method = solution.disc.method
    if method.conservative:
        return NumericalTractions(solution)
    if method.discontinuous:
        raise ProblemError(f"method {method.name} has no numerical flux that balances its elements, and its forces are not "
                           "known; take one that is conservative")
    return ConformingTractions(solution)


def Force(solution: Any, region: str, material: str | None = None) -> Array:
    """The force through a region, (d,); see `ContactSolution.Force`."""
    on = SidesOf(solution.disc, region)
    return Signs(solution.disc, region, on, material) @ solution.facettractions.forces[on]


def Signs(disc: DiscreteProblem, region: str, on: Any, material: str | None) -> Array:
    """Signs (n,) of the forces on facets, on the body or on the part of it that is of a material."""
    return _Outward(disc, region, on) if material is None else _Side(disc, region, on, material)


def TractionOn(solution: Any, region: str) -> Any:
    """The traction on a region as a CoefficientFunction; see `ContactSolution.Traction`."""
    SidesOf(solution.disc, region)
    return solution.facettractions.function


def Mean(solution: Any, region: str) -> Array:
    """The mean displacement of a region, (d,); see `ContactSolution.Mean`."""
    SidesOf(solution.disc, region)
    return MeanDisplacement(solution.disc, solution.gfu, region)


def DisplacementAt(solution: Any, point: tuple[float, ...]) -> Array:
    """The displacement at a point of the body, (d,); see `ContactSolution.At`."""
    mesh, dim = solution.disc.mesh, solution.disc.mesh.dim
    place = Vectors(point, (dim,), "point", f"give its {dim} coordinates, such as At({', '.join('0' * dim)})").tolist()
    displacement = solution.gfu
    try:
        return np.array(displacement(mesh(*place)))
    except Exception as error:
        points = mesh.ngmesh.Coordinates()[:, :dim]
        raise ProblemError(f"point {tuple(place)} lies in no element of the mesh, which extends from "
                           f"{tuple(points.min(axis=0).tolist())} to {tuple(points.max(axis=0).tolist())}; give a point of the "
                           "body") from error


def SidesOf(disc: DiscreteProblem, region: str) -> Any:
    """Numbers of the facets of a boundary region; ProblemError if there are none."""
    Matching(disc.mesh, region, "boundary")
    found = np.flatnonzero(disc.facets.On(region))
    if not len(found):
        raise ProblemError(f"boundary {region!r} contains no side of an element; give one that is part of the body's boundary "
                           "or of an interface")
    return found


def _Outward(disc: DiscreteProblem, region: str, on: Any) -> Array:
    """Signs (n,) of the forces on facets without a material: on the body, or on the side whose normal an interface has."""
    interfaces, within = disc.facets.interfaces, disc.facets.neighbours[on] > 1
    if within.any() and not within.all():
        raise ProblemError(f"region {region!r} has facets on the boundary of the body and facets inside it; give a region of "
                           "one kind, or with material= the part of the body on which the force acts")
    own, beyond = np.unique(interfaces.materials[on[within], 0]), interfaces.materials[on[within], 1]
    if len(np.unique(interfaces.piece[on[within]])) > 1 and (len(own) > 1 or np.any(beyond == own)):
        raise ProblemError(f"region {region!r} is an interface of several pieces, and on which side of each the force acts "
                           "cannot be told; give material=, or the pieces names of their own")
    return np.where(disc.facets.beyond[on], 0.0, 1.0)


def _Side(disc: DiscreteProblem, region: str, on: Any, material: str) -> Array:
    """Signs (n,) of the forces on the part of the body that is of a material."""
    chosen = Matching(disc.mesh, material, "material", kind="material")
    own, beyond = disc.facets.interfaces.materials[on].T
    here, there = chosen[own], chosen[beyond] & (beyond >= 0)
    if np.any(here & (own == beyond)) or _Doubled(disc, on[here]):
        raise ProblemError(f"region {region!r} has material {material!r} on both sides; give the region without material=, for "
                           "the force on the side whose outward normal is that of solution.flux")
    if not np.any(here | there):
        raise ProblemError(f"region {region!r} is no boundary of material {material!r}; give one that touches it")
    return here.astype(float) - there


def _Doubled(disc: DiscreteProblem, on: Any) -> bool:
    """True if both sides of a joint whose nodes are doubled are among facets."""
    facets = disc.facets
    return facets.doubled is not None and bool(np.isin(facets.boundary[0][facets.doubled], on).all(axis=0).any())
