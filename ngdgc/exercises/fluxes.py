"""Exercises of notebook 3, the four fluxes by hand."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from ngsolve import CF, BilinearForm, ds, dx

from ..contracts import Array
from ..discretization import Discretization
from ..mesh.facets import Csr
from ..meshes import RectangleMesh
from ..methods.rows import LDG, BrezziEtAl, InteriorPenalty, NonsymmetricInteriorPenalty, PenalisedRow
from ..problem.foundation import Foundation
from ..problem.laws import NormalCompliance
from ..problem.materials import HookeMaterial
from ..problem.problem import ContactProblem
from ..tools import sparse as sp
from .checker import Function, Value

MATERIAL = HookeMaterial(E=2000, nu=0.3)
TOL = 1e-8      # of matrices: round-off


@cache
def Disc(method: PenalisedRow) -> Discretization:
    problem = ContactProblem(MATERIAL, Foundation("bottom", NormalCompliance(300)), dirichlet={"top": CF((0, -0.1))})
    return Discretization(problem, method, RectangleMesh(2), order=1)


def Matrix(method: PenalisedRow) -> sp.csr_matrix:
    return Csr(Disc(method).form.Matrix())


def Nonsymmetric(penalty: float = 30) -> sp.csr_matrix:
    return Matrix(NonsymmetricInteriorPenalty(penalty=penalty))


def Penalty() -> sp.csr_matrix:
    """alpha for 30 mu: what twice the penalty adds."""
    return Matrix(InteriorPenalty(penalty=60)) - Matrix(InteriorPenalty(penalty=30))


def VectorPenalty(*, clamped: bool = True, sized: bool = True) -> sp.csr_matrix:
    """eta/h w_u.w_v on E0, with or without Gamma_D and 1/h."""
    disc = Disc(InteriorPenalty(penalty=30))
    u, v = disc.space.TnT()
    facets = disc.facets
    weight = facets.Function(30 * MATERIAL.mu / facets.diameter) if sized else 30 * MATERIAL.mu
    form = BilinearForm(disc.space)
    form += weight * (u - u.Other()) * (v - v.Other()) * dx(skeleton=True)
    if clamped:
        form += weight * u * v * ds(skeleton=True, definedon=disc.mesh.Boundaries("top"))
    return Csr(form.Assemble().mat)


def GlobalLift() -> sp.csr_matrix:
    """(C r_0, r_0): what distinguishes LDG from interior penalty."""
    return Matrix(LDG(penalty=30)) - Matrix(InteriorPenalty(penalty=30))


def Facets(rng: np.random.Generator) -> tuple[Any, ...]:
    angle = rng.uniform(0, 2 * np.pi, 15)
    normals = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return rng.standard_normal((15, 2)), rng.standard_normal((15, 2)), normals, rng.uniform(1, 9, 15)


def Flux(mean: Array, w: Array, n: Array, ratio: Array, *, sign: int = -1, normal: float = 1.0, half: float = 0.5) -> Array:
    return mean + sign * half * ratio[:, None] * (w + normal * np.sum(w * n, axis=1)[:, None] * n)


EXERCISES = {
    "03.1": Value(
        Right=Nonsymmetric, tol=TOL, hint="Three terms stay as they are; one of the two consistency terms changes its sign.",
        insight="K + X - X' + alpha.  On the diagonal v' B v the consistency terms cancel: coercive for any penalty.",
        mistakes={
            "That is interior penalty itself.": lambda: Matrix(InteriorPenalty(penalty=30)),
            "You changed the sign of the other term, the one that makes the method consistent.": lambda: Nonsymmetric().T,
            "Both consistency terms changed their sign; one of them must stay.":
                lambda: Nonsymmetric() + Nonsymmetric().T - Matrix(InteriorPenalty(penalty=30)),
            "You left the second consistency term out: that is the incomplete method, IIPG.":
                lambda: (Matrix(InteriorPenalty(penalty=30)) + Nonsymmetric()) / 2,
            "The penalty is missing.": lambda: Nonsymmetric() - Penalty()}),
    "03.2": Value(
        Right=VectorPenalty, tol=TOL, hint="One product of vectors, over interior facets and over the clamped ones.",
        insight="Between one and two times the tensor jump: |w|^2 = [u]:[u] for jumps along n, twice that for jumps across it.",
        mistakes={
            "That is the tensor jump [u]:[v].": Penalty,
            "Gamma_D belongs to E0, too.": lambda: VectorPenalty(clamped=False),
            "Divide by the length of the edge, h_e.": lambda: VectorPenalty(sized=False)}),
    "03.3": Function(
        Right=Flux, Data=Facets, hint="sigma_hat n = mean - ratio [u] n: what is the matrix [u] times the vector n?",
        insight="[u] n = (w + (w.n) n)/2: a normal jump is pulled back with full force, a tangential one with half of it.",
        mistakes={
            "Wrong sign: the penalty pulls the sides together.": lambda *data: Flux(*data, sign=1),
            "That is the vector jump w in place of the tensor jump times n.": lambda *data: Flux(*data, normal=0, half=1),
            "The half of [u] = (w n' + n w')/2 is missing.": lambda *data: Flux(*data, half=1),
            "The second half of the symmetric jump is missing: (w n' + n w') n has two terms.":
                lambda *data: Flux(*data, normal=0)}),
    "03.4": Value(
        Right=lambda: Matrix(BrezziEtAl(penalty=2)), tol=TOL, hint="K + X + X' + (C r_0, r_0) + eta sum_e (C r_e, r_e).",
        insight="Bassi et al. and the square of r_0, which makes any positive penalty enough.",
        mistakes={
            "That is Bassi et al.: (C r_0, r_0) is missing.": lambda: Matrix(BrezziEtAl(penalty=2)) - GlobalLift(),
            "That is LDG: the penalty of Brezzi et al. is made of r_e.": lambda: Matrix(LDG(penalty=2)),
            "(C r_0, r_0) has the wrong sign.": lambda: Matrix(BrezziEtAl(penalty=2)) - 2 * GlobalLift(),
            "The sum over r_e is missing its penalty factor.": lambda: Matrix(BrezziEtAl(penalty=1)),
            "The sum over r_e is missing.": lambda: 2 * Matrix(BrezziEtAl(penalty=1)) - Matrix(BrezziEtAl(penalty=2))})}
