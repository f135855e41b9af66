"""The bound of an error from a stress in equilibrium and a continuous displacement.

With a = sym s - s_h, b = C eps(v) - s_h, norms |.| of C^-1, Phi the Fenchel-Young gaps of the law at (v, -s n) (`lawpart`), I
what of -s n no law can give and S the skew part of s, the error x = |C eps(u) - s_h| satisfies

    x^2 <= (|a + b| + I + S) x + Phi + (I + S) |b| - (a, b),    S^2 = sum_K c_K^2 int_K |skew s|^2/c,

because (C eps(u) - s, eps(u) - eps(v)) <= Phi for a law that is the derivative of a convex function.  Where it can be, s is
made symmetric (`symmetric`), and S is 0; elsewhere, as skew s has mean 0 on every element, int_K s:skew grad w is at most
c_K |skew s| |eps(w)| with Korn's constant c_K (`korn`); c is the smallest eigenvalue of C.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import ET

from ..blocks.integrals import ElementGroup, SymmetricBasis
from ..contracts import Array
from .equilibrated import Complementary, EquilibratedStress, Stress, StressBatch
from .korn import KornConstants
from .lawpart import LawPart
from .potential import Potential
from .symmetric import Split, Symmetrised

SHARP = 1e-10           # relative to the load: body forces that V_h contains
SYMMETRIC = {ET.TRIG, ET.QUAD, ET.TET}


def ElementConstants(disc: Any) -> Array:
    """c_K over elements, 0 where s is made symmetric."""
    found = np.zeros(disc.mesh.ne)
    for group in disc.facetform.operators.groups:
        if not _Symmetric(group):
            found[group.elements] = KornConstants(disc.mesh, group.et, group.elements)
    return found


def Hypercircle(solution: Any, stress: EquilibratedStress, potential: Potential, korn: Array) -> tuple[float, float]:
    """The bound of the problem with the computed bound of friction, infinite if s is not in equilibrium with the load, and the
    same with tractions of the graph where they cost less (`LawGaps.softgap`)."""
    disc, order = solution.disc, solution.disc.order
    plus = minus = jumps = skew = rest = size = 0.0
    for batch in stress.Batches(lambda group: group.With(lambda shape: Split(group.et, order, shape)) if _Symmetric(group)
                                else None):
        C = batch.group.Stiffness()
        s = Symmetrised(batch, order) if _Symmetric(batch.group) else batch.equilibrated
        symmetric = (s + np.swapaxes(s, 2, 3)) / 2
        a, b = symmetric - batch.computed, Stress(C, potential.Gradient(batch.group)) - batch.computed
        plus, minus, jumps = (total + batch.Integral(Complementary(C, value)).sum()
                              for total, value in ((plus, a + b), (minus, a - b), (jumps, b)))
        skew += _Skew(batch, s - symmetric, korn[batch.group.elements])
        force = batch.BodyForce(disc.problem)
        rest += batch.Integral(np.square(force + batch.divergence).sum(axis=2)).sum()
        size += batch.Integral(np.square(force).sum(axis=2)).sum()
    if rest > (SHARP ** 2 * size if size else np.inf):
        return np.inf, np.inf
    parts, found = LawPart(solution, potential, stress), []
    for ofgap, ofcut in (("gap", "cut"), ("softgap", "softcut")):
        law, cut = (sum(gaps.weights @ getattr(gaps, name) for gaps in parts) for name in (ofgap, ofcut))
        cut = np.sqrt(cut) + np.sqrt(skew)
        middle = np.sqrt(plus) + cut
        found.append(float((middle + np.sqrt(middle ** 2 + 4 * (law + cut * np.sqrt(jumps) - (plus - minus) / 4))) / 2))
    return found[0], found[1]


def _Symmetric(group: ElementGroup) -> bool:
    return group.uniform and group.et in SYMMETRIC


def _Skew(batch: StressBatch, skew: Array, korn: Array) -> float:
    """S^2 of a batch."""
    if not korn.any():
        return 0.0
    basis = SymmetricBasis(skew.shape[2])
    basis = basis / np.sqrt(np.square(basis).sum(axis=(1, 2)))[:, None, None]      # orthonormal
    C = np.einsum("cij,nqijkl,dkl->nqcd", basis, batch.group.Stiffness(), basis, optimize=True)
    smallest = np.linalg.eigvalsh(C)[..., 0].min(axis=1)
    return float(korn ** 2 / smallest @ batch.Integral(np.square(skew).sum(axis=(2, 3))))
