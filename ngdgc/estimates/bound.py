"""An upper bound of the error in the energy norm, where theory has one.

`Hypercircle` bounds the error for a law that is the derivative of a convex function: without friction, or with a bound of
friction that is given (Tresca).  One that depends on the solution, p_t with |dp_t/dp_n| <= L, makes the problem
quasi-variational: the right-hand side bounds the error against the problem with the computed bound of friction, and 1/(1 - q)
times that the error itself, q = L kappa,

    kappa^2 = largest eigenvalue of (S_nn - S_nt S_tt^-1 S_tn + 1/p_n')^-1 S_tt,

S the compliance of Gamma_C, on tractions in the contact zone that are constant on a few patches (sketched, not proved): a
change of the bound by L dp does the work (L |dp|, |du_t|), and the energy of the change is at least that of dp alone.

A foundation that is much stiffer than the body makes much of a penetration beyond that of its traction: the bound is computed
with v lowered there, too, and the smaller one taken.  One that is much softer makes much of a traction that its law has not
between the contact points: where the bound with tractions of the law is less than half of it, that is taken.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..contact.parts import ContactPart, OverParts
from ..contracts import Array
from ..mesh.facets import Csr, Native
from ..tools import sparse as sp
from .equilibrated import EquilibratedStress
from .hypercircle import ElementConstants, Hypercircle
from .lawpart import Pushed
from .oscillation import Contained
from .potential import Potential
from .stressfunction import Relaxed

PATCHES = 12            # of Gamma_C, for kappa
LARGEST = 0.5           # q up to which the factor is given
SWEEPS = 4              # of the stress
SOFTER = 0.5            # of the bound, below which one with the tractions of the law is taken


def Bound(solution: Any) -> tuple[float | None, str]:
    """(an upper bound of the error in the energy norm or None, what it holds for or why there is none)."""
    with solution.state.Restored():
        q, words = _Feedback(solution)
        if q is None:
            return None, words
        stress, potential = Relaxed(EquilibratedStress(solution), SWEEPS), Potential(solution)
        reason = Contained(solution.disc, stress, potential)
        if reason:
            return None, reason
        korn = ElementConstants(solution.disc)
        found = [Hypercircle(solution, stress, potential, korn)]
        pushed = Pushed(solution, potential, stress)
        if pushed is not None:
            found.append(Hypercircle(solution, stress, pushed, korn))
        if korn.any():
            words += ", and with Korn's constants of elements where s is not symmetric, computed from below, and a quarter more"
    strict, soft = map(min, zip(*found))
    if not np.isfinite(strict):
        return None, "the body force is no polynomial of degree k on the elements"
    if soft >= SOFTER * strict:
        return strict / (1 - q), words
    return soft / (1 - q), (f"not strict: where the traction in equilibrium is none of a soft law it is moved to one, which "
                            f"counts as in the estimate; but for that {words}")


def _Feedback(solution: Any) -> tuple[float | None, str]:
    """(q, words), q None without a bound."""
    disc, contact = solution.disc, solution.disc.contact
    r = np.maximum(solution.penetration, 0)
    p = solution.pressure
    if not any(part.friction for part in contact.parts):
        return 0.0, "strict, for a law without friction"
    _, weakening = OverParts(contact.parts, ContactPart.SlipFactor, np.linalg.norm(solution.slip, axis=1))
    if np.any(weakening < 0):
        return None, "friction weakens with the slip"
    slope = contact.PressureDerivative(r)
    byr, byp = OverParts(contact.parts, ContactPart.BoundDerivatives, r, p)
    steep = np.abs(byp) + np.where(byr > 0, byr / np.where(slope > 0, slope, 1), 0)
    steep = float(steep[p > 0].max(initial=0))
    if steep == 0:
        return 0.0, "strict, for a bound of friction that is given"
    q = steep * _Kappa(disc, np.where(p > 0, slope, 0))
    if q >= LARGEST:
        return None, f"the bound of friction depends too much on the solution, q = {q:.2f}"
    return q, f"with the factor 1/(1 - q), q = {q:.2f}, for a bound of friction that depends on the solution"


def _Kappa(disc: Any, slope: Array) -> float:
    """kappa, from p_n' at the contact points, (n,), 0 off the contact zone."""
    contact, active = disc.contact, slope > 0
    patch = np.full(len(slope), -1)
    patch[active] = _Patches(contact.coordinates[active])
    directions, m = [contact.normals, *_Tangents(contact.normals)], patch.max() + 1
    tractions = np.array([direction * (patch == number)[:, None] for direction in directions for number in range(m)])
    Respond, added = _Response(disc, slope[active].min())
    moved = np.array([contact.Displacement(Respond(contact.Load(traction))) for traction in tractions])
    S = np.einsum("n,and,bnd->ab", contact.weights, tractions, moved, optimize=True)
    S, n, found = (S + S.T) / 2, slice(0, m), 0.0
    size, soft = (np.bincount(patch[active], (contact.weights * value)[active], minlength=m)
                  for value in (np.ones_like(slope), 1 / np.where(active, slope, 1)))
    for e in range(1, len(directions)):
        t = slice(e * m, (e + 1) * m)
        # As matrices of the form (p, S q) on patches, whose mass is `size`; what was added to A is taken away again.
        rest = S[n, n] - S[n, t] @ np.linalg.solve(S[t, t], S[t, n])
        if added:
            operator = rest / np.sqrt(np.outer(size, size))
            rest = np.linalg.inv(np.linalg.inv(operator) - added * np.eye(m)) * np.sqrt(np.outer(size, size))
        found = max(found, np.abs(np.linalg.eigvals(np.linalg.solve(rest + np.diag(soft), S[t, t]))).max())
    return float(np.sqrt(found))


def _Response(disc: Any, slope: float) -> tuple[Callable[[Array], Array], float]:
    """(load -> coefficients, the normal stiffness of Gamma_C that was added to A because the body is held by nothing else)."""
    if not disc.unresisted:
        return disc.SolveLinear, 0.0
    contact = disc.contact
    added = min(slope, 1 / contact.flexibility)
    rows = sp.csr_matrix((contact.normals.ravel(), np.arange(contact.normals.size),
                          np.arange(0, contact.normals.size + 1, contact.dim)))     # n, (n i): v_n
    trace = rows @ contact.trace
    inverse = disc.Factorise(Native(Csr(disc.matrix) + added * (trace.T @ sp.diags(contact.weights) @ trace)))
    return lambda load: disc.ApplyInverse(inverse, load), added


def _Patches(coordinates: Array) -> Any:
    """The patch of each point, (n,): equally many points in slices across the longest side, in 3D in slices of these."""
    order = np.argsort(np.ptp(coordinates, axis=0))[::-1]
    counts = [PATCHES] if coordinates.shape[1] == 2 else [4, 3]
    patch = np.zeros(len(coordinates), dtype=int)
    for axis, count in zip(order, counts):
        new = np.zeros_like(patch)
        for number in np.unique(patch):
            here = np.flatnonzero(patch == number)
            rank = np.argsort(np.argsort(coordinates[here, axis], kind="stable"))
            new[here] = number * count + rank * count // len(here)
        patch = np.unique(new, return_inverse=True)[1]
    return patch


def _Tangents(normals: Array) -> list[Array]:
    """Orthonormal tangents at the points, d - 1 arrays (n, d)."""
    if normals.shape[1] == 2:
        return [np.stack([-normals[:, 1], normals[:, 0]], axis=1)]
    away = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
    first = np.cross(normals, away)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return [first, np.cross(normals, first)]
