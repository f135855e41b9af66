"""What the body presses against: a boundary with its laws and a gap, (2.7)-(2.9) and (2.12) of Xiao, Wang, Han 2018."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..contracts import Compliance, Datum, Friction, VectorDatum, Wear
from ..data.coefficients import Pointwise, Scalar, Vector
from ..data.regions import RegionName
from ..exceptions import ProblemError
from ..tools.calls import ByKeyword
from ..tools.formula import Described
from .hypotheses import CheckCompliance, CheckFriction, CheckLaws, CheckWear, LawReport
from .laws import ComplianceLaw, FrictionLaw
from .punch import RigidPunch
from .userlaws import LawName, Watched

@ByKeyword
@dataclass(frozen=True)
class Foundation:
    """A deformable foundation under the boundary region `boundary` (a regular expression, as in NGSolve).

    `compliance` is a ComplianceLaw; `friction` a FrictionLaw or None for a frictionless foundation; `gap` the initial
    distance g [length] along the normal, number or scalar CoefficientFunction.  The theory wants g >= 0
    (2.12); the formulas hold for negative g, a body that starts inside its foundation, and it is accepted.

    `normal` is N, a vector of any length that points from the body into the foundation, N.n > 0, constant or a
    CoefficientFunction; None is the outward normal n of the body.  Pressure, gap and slip are along and across N:

        r = u.N - g,    t = p_n(r) N + t_t,    t_t perpendicular to N,    |t_t| <= p_t,

    t per area of the undeformed Gamma_C.  On a flat foundation a rounded body so has no horizontal force without friction.

    `wear` is a law, such as `ArchardWear`, with Depth(p, s) >= 0 [length], which in an increment of a history is worn off the
    body along the normal, p the pressure at its end and s = |change of u_t|.  What was worn off before an increment adds to its
    gap; `Solve`, one increment of the body as it is made, has none.

    `punch` is a `RigidPunch`: the foundation moves as a rigid body, where it is moved to or as far as a force presses it.

    Raises ProblemError if a derivative that a law returns is not that of its pressure, bound or slip factor, if one of these
    is negative, or if the pressure is not zero without penetration (2.13).

    >>> from ngdgc import NormalCompliance, TrescaFriction
    >>> Foundation("bottom", NormalCompliance(450), friction=TrescaFriction(1), gap=0.05).gap
    0.05
    >>> Foundation("rim", NormalCompliance(450), normal=(0, -1))
    Foundation(boundary='rim', compliance=NormalCompliance(stiffness=450.0, exponent=1), gap=0.0, normal=(0, -1))
    """

    boundary: str
    compliance: Any
    friction: Any = None
    gap: Any = 0.0
    normal: Any = None
    wear: Any = None
    punch: Any = None
    kind: ClassVar[str] = "foundation"
    tension: ClassVar[Any] = 0.0
    __repr__ = Described

    if TYPE_CHECKING:
        def __init__(self, boundary: str, compliance: Compliance, friction: Friction | None = None,
                     gap: Datum = 0.0, normal: VectorDatum | None = None, wear: Wear | None = None,
                     punch: RigidPunch | None = None) -> None: ...

    def __post_init__(self) -> None:
        object.__setattr__(self, "boundary", RegionName(self.boundary, "foundation"))
        if not _Has(self.compliance, "Pressure", "PressureDerivative"):
            raise ProblemError(f"compliance is {self.compliance!r}; give a law such as NormalCompliance(stiffness=450), an "
                               "object with Pressure(r) and PressureDerivative(r)")
        if self.friction is not None and not _Has(self.friction, "Bound"):
            raise ProblemError(f"friction is {self.friction!r}; give a law such as CoulombFriction(0.3), an object with "
                               "Bound(r, p), or None")
        if self.wear is not None and not _Has(self.wear, "Depth"):
            raise ProblemError(f"wear is {self.wear!r}; give a law such as ArchardWear(1e-6), an object with Depth(p, slip), "
                               "or None")
        if self.punch is not None and not isinstance(self.punch, RigidPunch):
            raise ProblemError(f"punch is {self.punch!r}; give a RigidPunch, such as RigidPunch(force=(None, -50)), or None")
        object.__setattr__(self, "gap", Scalar(self.gap, "gap"))
        if self.normal is not None:
            object.__setattr__(self, "normal", Vector(self.normal, f"normal of {self.kind} {self.boundary!r}"))
        where = f"on the {self.kind} of {self.boundary!r}"
        if not Pointwise(self.compliance):
            CheckCompliance(Watched(self.compliance), 1, f"{LawName(self.compliance)} {where}")
        if self.friction is not None and not Pointwise(self.friction):
            CheckFriction(Watched(self.friction), np.ones(1), np.ones(1), f"{LawName(self.friction)} {where}")
        if self.wear is not None and not Pointwise(self.wear):
            CheckWear(Watched(self.wear), np.ones(1), f"{LawName(self.wear)} {where}")

    def Check(self, *, depth: float = 1.0, slip: float = 1.0) -> LawReport:
        """The `LawReport` of both laws for penetrations up to `depth` and slips up to `slip` [length]; see `CheckLaws`."""
        return CheckLaws(self.compliance, self.friction, depth=depth, slip=slip)


def _Has(law: Any, *methods: str) -> bool:
    """True if the law has these methods of its own, not those of the base classes that only say what is missing."""
    own = [getattr(type(law), method, None) for method in methods]
    return all(callable(method) and method not in (ComplianceLaw.Pressure, ComplianceLaw.PressureDerivative, FrictionLaw.Bound)
               for method in own)
