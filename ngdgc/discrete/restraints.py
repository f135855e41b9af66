"""What holds a body: its rigid motions, and how much supports, foundations and added springs resist them."""

from __future__ import annotations

from functools import cached_property
from typing import cast

import numpy as np
from ngsolve import CF, FESpace, GridFunction, L2

from ..contact.boundary import ContactBoundary
from ..contact.parts import ContactPart, OverParts
from ..contact.punches import Punches
from ..contracts import Array
from ..exceptions import ProblemError
from ..mesh.facets import Facets, Projected, RigidMotions, RigidMotionsAt
from ..mesh.quadrature import BoundaryQuadrature
from ..problem.problem import ContactProblem
from ..tools import sparse as sp

SOFT = 1e-3         # stiffness of Gamma_C, relative to that of the body, that holds it while its coercivity is looked at
FREE = 1e-6         # of a motion, that is the part of a punch
NOTHING = 1e-12     # of the energy of a motion, relative to the sizes of its terms
ORDER = 4           # of the quadrature on supports
DEPTHS = 10.0 ** np.arange(-6, 1)   # penetrations at which a foundation may resist, in units of the extent of the body


class Restraints:
    """Rigid motions of the parts of a body and what resists them.

    added : scipy matrix of springs and added forms on `space`, or None

    Attributes
    ----------
    loose : words for the motions that neither dirichlet nor roller resist, or None
    floating : words for those that springs and added forms do not resist either, so that only contact does, or None
    unresisted : the same, and words for the motions of rigid punches that forces press
    """

    def __init__(self, problem: ContactProblem, facets: Facets, contact: ContactBoundary, space: FESpace,
                 added: sp.csr_matrix | None) -> None:
        self.facets, self.contact = facets, contact
        self._supports, self._foundations = Supports(problem, facets, contact)
        self._springs = np.zeros_like(self._supports)
        if added is not None:
            springs = Springs(facets, space, added)
            self._springs = Together(springs) if _Coupled(contact) else springs

    @cached_property
    def loose(self) -> str | None:
        return FreeMotion(self.facets, self._supports)

    @cached_property
    def floating(self) -> str | None:
        return self.loose and FreeMotion(self.facets, self._supports, self._springs)

    @property
    def unresisted(self) -> str | None:
        punches = self.contact.punches.Words() if self.contact.punches is not None else []
        return " and ".join(filter(None, [self.floating, *punches])) or None

    @property
    def soft(self) -> sp.csr_matrix | None:
        """A soft stiffness of Gamma_C, scipy CSR, that makes norms definite where dirichlet and roller do not, or None."""
        if not self.loose:
            return None
        contact = self.contact
        weights = np.repeat(SOFT / contact.flexibility * contact.weights, contact.dim)
        return (contact.trace.T @ sp.diags(weights) @ contact.trace).tocsr()

    def Check(self) -> None:
        """Raise ProblemError for a body with a rigid motion that nothing resists."""
        if not self.unresisted:
            return
        resistances = self._supports, self._springs, self._foundations
        if self.contact.punches is not None and (free := FreePunch(self.contact.punches, *resistances)):
            raise ProblemError(f"nothing resists the {free}: a punch without friction, or on a body that floats with it, goes "
                               "off under the smallest force; hold it, with None in that place of its force or moment, give "
                               "the foundation friction, or hold the body with dirichlet or roller")
        bodies = slice(self._supports.shape[1])
        if free := FreeMotion(self.facets, *(grams[:, bodies, bodies] for grams in resistances)):
            raise ProblemError(f"the body floats: nothing resists {free}, neither dirichlet nor roller nor a foundation with a "
                               "stiffness nor a spring nor an added form; hold it with dirichlet or roller")


def Supports(problem: ContactProblem, facets: Facets, contact: ContactBoundary) -> tuple[Array, Array]:
    """How much dirichlet and roller, and how much foundations resist rigid motions, two arrays (parts, modes, modes).

    A motion is resisted where the displacement it causes is prescribed, on all components or on the normal one; a
    foundation resists normal motion where its pressure at some depth is positive, and tangential motion where friction is.
    With joints or rigid punches these are one matrix of all parts, the second one with the punches' motions (m,) at its end.
    """
    parts, modes = facets.component.max() + 1, _Modes(facets)
    held, touched = np.zeros((2, parts, modes, modes))
    for kind, region in problem.Regions():
        if kind in ("dirichlet", "roller"):
            quadrature = BoundaryQuadrature.On(facets, region, ORDER)
            motions = _CentredMotions(facets, quadrature.coordinates, quadrature.elements)
            if kind == "roller":
                motions = np.einsum("cmnd,nd->cmn", motions, quadrature.normals)[..., None]
            held += np.einsum("camd,cbmd,m->cab", motions, motions, quadrature.weights)
    motions = _CentredMotions(facets, contact.coordinates, contact.inside["nr"])
    if _Coupled(contact):       # joints and punches resist what two sides do apart, over the motions of all parts at once
        if np.any(contact.joined):
            motions -= contact.joined[:, None] * _CentredMotions(facets, contact.coordinates, contact.beyond["nr"])
        motions = motions.reshape(1, parts * modes, *motions.shape[2:])
        if contact.punches is not None:
            motions = np.concatenate([motions, -contact.punches.traces[None]], axis=1)
        held, touched = Together(held), np.zeros((1, motions.shape[1], motions.shape[1]))
    across = np.einsum("cmnd,nd->cmn", motions, contact.normals)[..., None]
    along = motions - across * contact.normals
    for resisted, resists in zip((across, along), _Resistance(facets, contact)):
        touched += np.einsum("camd,cbmd,m->cab", resisted, resisted, contact.weights * resists)
    return held, touched


def _Coupled(contact: ContactBoundary) -> bool:
    """Do joints or punches let one part move with another, or with a foundation?"""
    return bool(np.any(contact.joined)) or contact.punches is not None


def FreePunch(punches: Punches, *resistances: Array) -> str | None:
    """Words for the motion of a punch that nothing of (1, modes, modes) resists, of bodies or of these and punches, or None."""
    size = resistances[-1].shape[1]
    total = np.zeros((size, size))
    for (gram,) in resistances:
        total[:len(gram), :len(gram)] += gram / (np.trace(gram) or 1)
    for vector in _Null(total):
        alone = np.abs(vector[size - punches.count:])
        if alone.max(initial=0) > FREE:
            return punches.Words()[int(np.argmax(alone))]
    return None


def Together(grams: Array) -> Array:
    """The matrices (parts, modes, modes) as one of the motions of all parts, (1, parts modes, parts modes)."""
    parts, modes, _ = grams.shape
    together = np.zeros((parts, modes, parts, modes))
    together[np.arange(parts), :, np.arange(parts), :] = grams
    return together.reshape(1, parts * modes, parts * modes)


def _Resistance(facets: Facets, contact: ContactBoundary) -> tuple[np.ndarray, np.ndarray]:
    """(pressure, friction): True where the law gives one at some depth up to the size of the body, over contact points."""
    pressed, rubbed = np.zeros((2, len(contact.weights)), dtype=bool)
    for depth in _Centres(facets)[1] * DEPTHS:
        r = np.full(len(contact.weights), depth)
        with np.errstate(all="ignore"):     # a law may end at some penetration
            pressure = OverParts(contact.parts, ContactPart.Pressure, r)
            pressed |= pressure > 0
            rubbed |= OverParts(contact.parts, ContactPart.Bound, r, pressure) > 0
    return pressed, rubbed


def FreeMotion(facets: Facets, *resistances: Array) -> str | None:
    """Words for the rigid motions that nothing of (parts, modes, modes) resists, or None."""
    # Each by its own size: they have different units.
    sizes = [np.trace(grams, axis1=1, axis2=2)[:, None, None] for grams in resistances]
    total = cast(Array, sum(grams / np.where(size > 0, size, 1) for grams, size in zip(resistances, sizes)))
    for part, gram in enumerate(total):
        # The modes are scaled to the body, so zero means zero to round-off.
        free = _Null(gram)
        if len(free):
            return _Words(free, facets, part)
    return None


def Springs(facets: Facets, space: FESpace, matrix: sp.csr_matrix) -> Array:
    """How much a matrix (scipy) on a space resists rigid motions, matrices (parts, modes, modes) of no unit."""
    dim, (centres, size) = facets.mesh.dim, _Centres(facets)
    here, grams = GridFunction(L2(facets.mesh, order=0)), []
    for part, centre in enumerate(centres):
        here.vec.FV().NumPy()[:] = facets.component == part
        modes: list[Array] = []
        rigid = [*zip(RigidMotions(dim), RigidMotionsAt(centre[None]))][facets.frame.rigid]
        for mode, shift in rigid:
            turning = len(modes) >= dim
            modes.append(Projected(space, here * ((mode - CF(tuple(shift[0]))) / size if turning else mode)))
        gram = np.array(modes) @ (matrix @ np.array(modes).T)
        values, vectors = np.linalg.eigh(gram + gram.T)
        # What pushes does not resist, and the round-off of a form that no rigid motion feels is no resistance either.
        size = np.trace(np.abs(modes) @ (abs(matrix) @ np.abs(modes).T))
        gram = (vectors * np.where(values > NOTHING * size, values, 0)) @ vectors.T
        grams.append(gram / (np.trace(gram) or 1))
    return np.array(grams)


def _Modes(facets: Facets) -> int:
    """How many rigid motions there are."""
    return len(RigidMotionsAt(np.zeros((1, facets.mesh.dim)))[facets.frame.rigid])


def _Null(gram: Array) -> Array:
    values, vectors = np.linalg.eigh(gram)
    return vectors[:, values <= 1e-10 * np.trace(gram)].T


def _CentredMotions(facets: Facets, coordinates: Array, elements: np.ndarray) -> Array:
    """Rigid motions of every connected part at points in elements, (parts, modes, n, d), scaled to the size of the body."""
    centres, size = _Centres(facets)
    parts = facets.component[elements]
    motions = RigidMotionsAt((coordinates - centres[parts]) / size)[facets.frame.rigid]
    return np.array([motions * (parts == part)[None, :, None] for part in range(len(centres))])


def _Centres(facets: Facets) -> tuple[Array, float]:
    """(centres (parts, d) of the connected parts, size of the body), from the vertices of elements: there may be others."""
    points, parts = facets.mesh.ngmesh.Coordinates()[:, :facets.mesh.dim], facets.component
    members = []
    for part in range(parts.max() + 1):
        inside = np.zeros(len(points) + 1, dtype=bool)      # the last one for the -1 that fill up
        inside[facets.vertices[parts == part]] = True
        members.append(points[inside[:-1]])
    return np.array([member.mean(axis=0) for member in members]), np.ptp(np.concatenate(members), axis=0).max()


def _Words(null: Array, facets: Facets, part: int) -> str:
    """Words for a basis of free motions, over translations and rotations."""
    dim = facets.mesh.dim
    centre = _Centres(facets)[0][part]
    modes = _Modes(facets)
    if null.shape[1] > modes:       # of all parts at once: the part that moves most
        part = int(np.argmax((null.reshape(len(null), -1, modes) ** 2).sum(axis=(0, 2))))
        null = null[:, part * modes:(part + 1) * modes]
        centre = _Centres(facets)[0][part]
    words = [f"translation along {axis}" for axis in "xyz"[:dim]]
    if facets.frame.revolved:
        words = ["translation along the axis"]
    elif dim == 2:
        words.append(f"rotation about ({centre[0]:.3g}, {centre[1]:.3g})")
    else:
        words += [f"rotation about an axis along {axis} through ({', '.join(f'{c:.3g}' for c in centre)})" for axis in "xyz"]
    basis = []
    for vector in null:
        leading = np.argsort(-np.abs(vector))
        basis.append(" with ".join(words[i] for i in leading if abs(vector[i]) > 0.1))
    where = f" in part {part + 1} of the mesh" if facets.component.max() else ""
    return " and ".join(basis) + where
