"""Is there a solution, and only one?  What the theory says about a problem on a mesh.

Let two solutions have the displacement difference w, and p_n' >= -N, |dp_t/dr| <= L_t, dp_t/ds >= -M for the penetration r and
the slip s.  Testing each inequality (2.14) with the other solution, and using | |u_t| - |v_t| | <= |u_t - v_t|,

    a(w, w) <= int_GammaC N w_n^2 + L_t |w_n| |w_t| + M |w_t|^2 <= int_GammaC w.D w,
    D = (N + L_t/2) n n' + (M + L_t/2) (I - n n'),

and with the compliance operator S of Gamma_C, traction -> displacement, int w.D w <= |D^(1/2) S D^(1/2)| a(w, w).  So the
solution is unique if this norm, for a monotone p_n without slip weakening at most |S| max L_t/2, is below 1.

A solution exists under (2.13) for an elliptic A: the tractions do work >= 0, up to a constant if the gap is negative, and they
depend on u continuously, with convex values where u_t = 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..contracts import Array
from ..discretization import Discretization
from ..exceptions import ProblemError
from ..linear.equations import CheckDiscretization
from ..problem.hypotheses import CheckLaws, LawReport
from ..solvers.uzawa.contraction import LargestEigenvalue
from ..tools.calls import ByKeyword

MAXITER, TOL = 60, 1e-4     # of Lanczos' iteration for the norm


@ByKeyword
@dataclass(frozen=True, eq=False)
class UniquenessReport:
    """laws : one `LawReport` for every foundation, with constants at its points;  number : |D^(1/2) S D^(1/2)|, no unit."""

    laws: tuple[LawReport, ...]
    number: float

    @property
    def exists(self) -> bool:
        """True if the theory gives a solution: (2.13) holds."""
        return all(report.valid for report in self.laws)

    @property
    def unique(self) -> bool:
        """True if the theory gives at most one solution within the range; False says nothing."""
        return self.number < 1

    def __str__(self) -> str:
        lines = [str(report) for report in self.laws]
        lines.append("existence: " + ("by theory" if self.exists else "not covered, (2.13) is violated"))
        lines.append(f"uniqueness: |D^(1/2) S D^(1/2)| = {self.number:.4g}, " +
                     ("below 1: by theory" if self.unique else "not below 1: not covered, several solutions are possible"))
        return "\n".join(lines)


@ByKeyword
def CheckUniqueness(disc: Discretization, *, depth: float | None = None, slip: float | None = None) -> UniquenessReport:
    """The `UniquenessReport` of a Discretization, for penetrations up to `depth` and slips up to `slip` [length].

    Without a range it is that of the response to the loads without foundation, at least the length 1e-3 of the body.  The norm
    is computed to about 1e-3, by applications of A^-1.

    Raises ProblemError if A is not symmetric, or singular: a body that its foundation alone holds.

    >>> from ngsolve import CF
    >>> from ngdgc import *
    >>> from ngdgc.meshes import RectangleMesh
    >>> foundation = Foundation("bottom", NormalCompliance(100), friction=CoulombFriction(0.3))
    >>> problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, dirichlet={"top": CF((0, -0.1))})
    >>> report = CheckUniqueness(Discretization(problem, LDG(), RectangleMesh(4)))
    >>> report.exists, report.unique, round(report.number, 3)
    (True, True, 0.096)
    """
    CheckDiscretization(disc)
    if not disc.symmetric:
        raise ProblemError("the method is not symmetric; the theory of uniqueness needs a symmetric compliance operator, "
                           "take a symmetric one")
    if disc.unresisted:
        raise ProblemError(f"the body is held by its foundation alone: only contact resists {disc.unresisted}, and the theory "
                           "here needs a body that its supports hold; add dirichlet or roller")
    contact = disc.contact
    if depth is None or slip is None:
        free = contact.Displacement(disc.FreeSolution())
        least = 1e-3 * np.ptp(contact.coordinates, axis=0).max()
        depth = max(contact.Penetration(free).max(), least) if depth is None else depth
        slip = max(contact.Slip(free).max(), least) if slip is None else slip
    reports = tuple(CheckLaws(part.compliance, part.friction, depth=depth, slip=slip,
                              npoints=part.points.stop - part.points.start) for part in contact.parts)
    decrease, bound, weakening = (np.concatenate([getattr(report, name) for report in reports])
                                  for name in ("decrease", "friction", "weakening"))
    if not np.all(np.isfinite(decrease + bound + weakening)):
        return UniquenessReport(reports, np.inf)
    across, along = (np.sqrt(constant + bound / 2)[:, None] for constant in (decrease, weakening))

    def Weighted(values: Array) -> Array:
        """D^(1/2) applied to (n, d)."""
        return across * contact.Normal(values)[:, None] * contact.normals + along * contact.Tangential(values)

    def Apply(values: Array) -> Array:
        return Weighted(contact.Displacement(disc.Response(Weighted(values))))

    # Smooth and oblique, so that it has a part in every eigenvector of low frequency.
    start = Weighted(np.ones_like(contact.normals) + 0.1 * contact.coordinates)
    return UniquenessReport(reports, LargestEigenvalue(Apply, start, contact.weights[:, None], MAXITER, TOL))
