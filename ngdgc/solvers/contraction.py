"""Does an explicit iteration contract?  The numbers that decide, estimated by a few applications of the inverse."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Contraction:
    """Numbers that bound the Uzawa iteration at given penetrations, each computed to a few per cent.

    normal : |p_n' S_nn|, the largest eigenvalue of D^(1/2) S_nn D^(1/2) with D = p_n'(r), for p_n = k_n r the k_n |S_nn| of
        the active zone.  The normal part contracts only while it is below 1.
    tangential : |p_t S_tt p_t| [stress length], largest eigenvalue with the friction bound as weight.
    rho : step of the friction update; it contracts only while rho * tangential / 2 + normal < 1 (sufficient).

    S is the compliance operator of Gamma_C, traction -> displacement; S_nn and S_tt are its normal and tangential blocks.
    """

    normal: float
    tangential: float
    rho: float | None = None

    @property
    def friction(self):
        """rho |p_t S_tt p_t| / 2, which must stay below 1."""
        return 0.0 if self.rho is None else 0.5 * self.rho * self.tangential


def EstimateContraction(disc, penetration, *, rho=None, maxiter=12, tol=1e-3):
    """Contraction numbers of a Discretization at penetrations (n,) of its contact points.

    Costs at most 2 maxiter applications of A^-1; Lanczos stops when its largest eigenvalue moves by less than `tol`.

    >>> from ngdgc.solvers import Contraction
    >>> Contraction(normal=0.5, tangential=2e-3, rho=500).friction
    0.5
    """
    contact = disc.contact
    stiffness = np.sqrt(np.maximum(contact.PressureDerivative(penetration), 0))[:, None]
    bound = contact.Bound(penetration)[:, None]

    def Normal(values):
        return stiffness * contact.Normal(contact.Displacement(
            disc.Response(stiffness * values * contact.normals)))[:, None]

    def Tangential(values):
        traction = bound * contact.Tangential(values)
        return bound * contact.Tangential(contact.Displacement(disc.Response(traction)))

    weights = contact.weights[:, None]
    tangent = contact.Tangential(np.ones_like(contact.normals) + 0.1 * contact.coordinates)
    return Contraction(normal=_LargestEigenvalue(Normal, stiffness, weights, maxiter, tol),
                       tangential=_LargestEigenvalue(Tangential, bound * tangent, weights, maxiter, tol), rho=rho)


def _LargestEigenvalue(Apply, start, weights, maxiter, tol):
    """Lanczos for an operator that is self-adjoint and nonnegative in the inner product sum weights a b."""
    def Product(a, b):
        return float(np.sum(weights * a * b))

    length = np.sqrt(Product(start, start))
    if length == 0:
        return 0.0
    basis, diagonal, offdiagonal, largest = [start / length], [], [], 0.0
    while len(diagonal) < maxiter:
        image = Apply(basis[-1])
        diagonal.append(Product(image, basis[-1]))
        tridiagonal = np.diag(diagonal) + np.diag(offdiagonal, 1) + np.diag(offdiagonal, -1)
        previous, largest = largest, np.linalg.eigvalsh(tridiagonal)[-1]
        for vector in basis:
            image = image - Product(image, vector) * vector
        length = np.sqrt(Product(image, image))
        if largest - previous <= tol * largest or length <= 1e-12 * largest:
            break
        offdiagonal.append(length)
        basis.append(image / length)
    return float(largest)
