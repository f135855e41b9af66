"""Does an iteration contract, and how fast?  The numbers that decide, estimated by a few applications of the inverse."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...contact.boundary import ContactBoundary
from ...contracts import Array
from ...discrete.problem import DiscreteProblem
from ...exceptions import ProblemError
from ...linear.equations import CheckDiscretization
from ...tools.calls import ByKeyword
from ...tools.values import Integer, IsNumber, Number, PositiveNumber, Vectors
from .steps import UzawaStep

@ByKeyword
@dataclass(frozen=True)
class Contraction:
    """Numbers that bound the Uzawa iteration at given penetrations, each computed to a few per cent, no unit.

    normal : |p_n' S_nn|, the largest eigenvalue of D^(1/2) S_nn D^(1/2) with D = p_n'(r); for p_n = k_n r the k_n |S_nn| of the
        active zone.  The normal part contracts only while it is below 1.
    friction : half the largest eigenvalue of s^(1/2) S_tt s^(1/2), s the step of the friction traction.  The iteration
        contracts if normal + friction < 1.

    S is the compliance operator of Gamma_C, traction -> displacement; S_nn and S_tt are its normal and tangential blocks.

    >>> Contraction(normal=0.13, friction=0.78).normal
    0.13
    """

    normal: float
    friction: float


@ByKeyword
def EstimateContraction(disc: DiscreteProblem, penetration: Array, *, step: float | Array = 0.0, maxiter: int = 12,
                        tol: float = 1e-3) -> Contraction:
    """Contraction numbers of a Discretization at penetrations (n,) of its contact points.

    `step` is that of the friction traction [stress/length], a number or (n,).  Costs at most 2 maxiter applications of A^-1;
    Lanczos stops when its largest eigenvalue moves by less than `tol` twice.

    >>> from ngdgc import *
    >>> from ngdgc.exact import AffinePatch
    >>> from ngdgc.meshes import RectangleMesh
    >>> exact = AffinePatch("slip")
    >>> disc = Discretization(exact.problem, LDG(), RectangleMesh(2))
    >>> EstimateContraction(disc, Solve(disc).penetration).normal < 1
    True
    """
    CheckDiscretization(disc)
    contact, maxiter = disc.contact, Integer(maxiter, "maxiter", "give a positive integer")
    tol = PositiveNumber(tol, "tol", "give a number between 0 and 1", below=1)
    count = len(contact.weights)
    penetration = Vectors(penetration, (count,), "penetration", f"give one number for each of the {count} contact points, such "
                          "as solution.penetration")
    steps = Vectors(np.full(count, float(Number(step))) if IsNumber(step) else step, (count,), "step",
                    f"give a number >= 0, or one for each of the {count} contact points")
    if np.any(steps < 0):
        raise ProblemError(f"step is {steps.min():g} at some point; give numbers >= 0")
    across = np.sqrt(np.maximum(contact.PressureDerivative(penetration), 0))[:, None]
    along = np.sqrt(steps)[:, None]

    def Normal(values: Array) -> Array:
        traction = across * values * contact.normals
        return across * contact.Normal(contact.Displacement(disc.Response(traction)))[:, None]

    def Tangential(values: Array) -> Array:
        traction = along * contact.Tangential(values)
        return along * contact.Tangential(contact.Displacement(disc.Response(traction)))

    weights = contact.weights[:, None]
    start = _Start(contact)
    normal, tangent = across * contact.Normal(start)[:, None], contact.Tangential(start)
    return Contraction(normal=LargestEigenvalue(Normal, normal, weights, maxiter, tol),
                       friction=0.5 * LargestEigenvalue(Tangential, along * tangent, weights, maxiter, tol))


def _Start(contact: ContactBoundary) -> Array:
    """A traction (n, d) with a part in every eigenvector, none excluded by a symmetry of the mesh."""
    return np.ones_like(contact.normals) + 2 * np.random.default_rng(1).standard_normal(contact.normals.shape)


def ComplianceNorm(disc: DiscreteProblem, *, maxiter: int = 12, tol: float = 1e-3) -> float:
    """|S| in L2(Gamma_C) [length/stress], from below and to about 5 %, by at most `maxiter` applications of A^-1."""
    contact = disc.contact
    return LargestEigenvalue(lambda traction: contact.Displacement(disc.Response(traction)), _Start(contact),
                              contact.weights[:, None], maxiter, tol)


def ContractionFactor(disc: DiscreteProblem, step: UzawaStep, state: Array, maxiter: int) -> float:
    """Spectral radius of the derivative of one step (a class of `steps`) at a state: the factor by which errors shrink.

    If no point of Gamma_C changes its zone, the iteration is linear with this derivative.  With Tresca's friction in 2D that is
    diag(0, I) - D^(1/2) S D^(1/2), D = diag(p_n', s), on active and sticking points for the explicit step: the factor is the
    larger of |p_n' S_nn| and 1 - s lambda_min for k_n and s that hardly interact; and I - gamma S on the sticking points of
    a stiff foundation for the implicit one, 1 - gamma lambda_min.  Arnoldi's method with the derivative in directions; it
    finds the factor from below: 1 - factor is at most a tenth too large after maxiter = 20 solves for a condition number of
    S up to 2000 (P1, n = 32).
    """
    traction, memory = step.At(state)
    scale = np.linalg.norm(step.metric * state)

    def Derivative(direction: Array) -> Array:
        # A one-sided difference: differences of the law are exact up to round-off where it is linear.
        shift = 1e-7 * scale
        moved, remembered = step.At(state + shift * direction / step.metric)
        du = -disc.contact.Displacement(disc.Response((moved - traction) / shift))
        return step.metric * step.Next((remembered - memory) / shift, du)

    # Parts of a state that rest whatever they are, such as lambda where there is no bound and tractions that no trace sees,
    # have the eigenvalue 1 and no influence; M v - v is free of them.
    start = np.random.default_rng(1).standard_normal(state.shape)
    start = Derivative(start) - start
    basis, hessenberg = [start / np.linalg.norm(start)], np.zeros((maxiter + 1, maxiter))
    for j in range(maxiter):
        image = Derivative(basis[j])
        length = np.linalg.norm(image)
        for i, vector in enumerate(basis):
            hessenberg[i, j] = np.vdot(vector, image)
            image = image - hessenberg[i, j] * vector
        hessenberg[j + 1, j] = np.linalg.norm(image)
        if hessenberg[j + 1, j] <= 1e-6 * length:
            break
        basis.append(image / hessenberg[j + 1, j])
    values, vectors = np.linalg.eig(hessenberg[:j + 1, :j + 1])
    # What round-off brings back of the resting parts has no share in the start, or is 1 as no convergent iteration's factor is.
    shares = np.abs(np.linalg.solve(vectors, np.eye(j + 1)[0]))
    return float(np.abs(values[(shares > 1e-6) & (np.abs(values - 1) > 1e-6)]).max(initial=0))


def LargestEigenvalue(Apply: Callable[[Array], Array], start: Array, weights: Array, maxiter: int, tol: float) -> float:
    """Lanczos for an operator that is self-adjoint and nonnegative in the inner product sum weights a b."""
    def Product(a: Array, b: Array) -> float:
        return float(np.sum(weights * a * b))

    length = np.sqrt(Product(start, start))
    if length == 0:
        return 0.0
    basis, largest, settled = [start / length], 0.0, False
    diagonal: list[float] = []
    offdiagonal: list[float] = []
    while len(diagonal) < maxiter:
        image = Apply(basis[-1])
        diagonal.append(Product(image, basis[-1]))
        tridiagonal = np.diag(diagonal) + np.diag(offdiagonal, 1) + np.diag(offdiagonal, -1)
        previous, largest = largest, np.linalg.eigvalsh(tridiagonal)[-1]
        for vector in basis:
            image = image - Product(image, vector) * vector
        length = np.sqrt(Product(image, image))
        # Twice in a row: next to another eigenvalue the largest one shows late.
        before, settled = settled, largest - previous <= tol * largest
        if before and settled or length <= 1e-12 * largest:
            break
        offdiagonal.append(length)
        basis.append(image / length)
    return float(largest)
