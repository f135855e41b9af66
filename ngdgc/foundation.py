"""What the body presses against: laws p_n, p_t and the gap, (2.7)-(2.9) and (4.1)-(4.2) of Xiao, Wang, Han 2018.

A law is a small frozen object whose methods act on numpy arrays with one entry per quadrature point of Gamma_C.
Data of a law that are CoefficientFunctions are evaluated at those points once, by `LawAt`.  A law of your own is any
object with the methods of `ComplianceLaw` or `FrictionLaw`, best a frozen dataclass.
"""

from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
from ngsolve import CoefficientFunction

from .coefficients import CheckNumber, CheckRange, IsNumber, Pointwise, RegionName, Scalar, ValuesAt
from .exceptions import ProblemError
from .formula import Described
from .hypotheses import CheckCompliance, CheckFriction, CheckLaws


def LawAt(law, points, name=""):
    """The law with every CoefficientFunction among its attributes replaced by its values at mesh points."""
    if not Pointwise(law):
        return law
    law = copy(law)
    for attribute, value in list(vars(law).items()):
        if isinstance(value, CoefficientFunction):
            # Laws are frozen for their users; this is a new one.
            object.__setattr__(law, attribute, ValuesAt(value, points, name + attribute))
    if hasattr(law, "CheckData"):
        law.CheckData(name)
    return law


class ComplianceLaw:
    """Normal compliance -sigma_n = p_n(r), r = u_n - g the penetration [length], p_n >= 0 [stress].

    `Pressure(r)` and `PressureDerivative(r)` map arrays (npoints,) to arrays (npoints,); p_n(r) = 0 for r <= 0.
    """

    def Pressure(self, r):
        raise NotImplementedError

    def PressureDerivative(self, r):
        raise NotImplementedError

    def Check(self, *, depth=1.0):
        """The `LawReport` for penetrations up to `depth` [length]: (2.13), Lipschitz constant, monotone or not.

        >>> NormalCompliance(stiffness=3, exponent=0.5).Check().problems
        ('p_n is not Lipschitz',)
        """
        return CheckLaws(self, depth=depth)


class FrictionLaw:
    """Friction bound |sigma_t| <= p_t = Bound(r, p) Coefficient(s), r the penetration, p the pressure, s = |u_t| the slip.

    `Bound` [stress] maps arrays (npoints,) to an array (npoints,).  Two more methods may be given:
    `BoundDerivatives(r, p)`, the pair of its derivatives by r and p (finite differences otherwise), and `Coefficient(s)`, the
    pair of a factor >= 0 [1] and its derivative [1/length], which is (1, 0) otherwise.
    """

    def Bound(self, r, p):
        raise NotImplementedError

    def Check(self, compliance, *, depth=1.0, slip=1.0):
        """The `LawReport` for penetrations up to `depth` and slips up to `slip` [length].

        The bound is a function of the penetration, as (2.13) has it, only with the pressure p_n(r) of a `compliance` law.

        >>> print(CoulombFriction(0.3).Check(NormalCompliance(10)))
        laws for penetrations up to 1 and slips up to 1:
          p_n        Lipschitz, L_n = 10, monotone
          p_t        Lipschitz, L_t = 3
          (2.13)     holds
        """
        return CheckLaws(compliance, self, depth=depth, slip=slip)


@dataclass(frozen=True)
class NormalCompliance(ComplianceLaw):
    """p_n(r) = stiffness * max(r, 0)^exponent, (4.1).

    `stiffness` [stress/length^exponent] >= 0, number or scalar CoefficientFunction; `exponent` > 0.

    >>> float(NormalCompliance(stiffness=450, exponent=1).Pressure(np.array(0.5)))
    225.0
    """

    stiffness: Any
    exponent: float = 1
    __repr__ = Described

    def __post_init__(self):
        if not isinstance(self.stiffness, np.ndarray):
            object.__setattr__(self, "stiffness", Scalar(self.stiffness, "stiffness"))
        if not IsNumber(self.exponent) or not 0 < self.exponent < np.inf:
            raise ProblemError(f"exponent is {self.exponent!r}; it must be a positive number")
        CheckNumber(self.stiffness, "stiffness", least=0)

    def CheckData(self, name=""):
        CheckRange(self.stiffness, f"{name}stiffness", least=0)

    def Pressure(self, r):
        return self.stiffness * np.maximum(r, 0) ** self.exponent

    def PressureDerivative(self, r):
        inside = r > 0
        return self.stiffness * self.exponent * np.where(inside, np.where(inside, r, 1) ** (self.exponent - 1), 0)


@dataclass(frozen=True)
class CoulombFriction(FrictionLaw):
    """p_t = coefficient * p_n, Coulomb's dry friction; `coefficient` >= 0 [1], number or CoefficientFunction.

    >>> float(CoulombFriction(0.5).Bound(None, np.array(8.0)))
    4.0
    """

    coefficient: Any
    __repr__ = Described

    def __post_init__(self):
        if not isinstance(self.coefficient, np.ndarray):
            object.__setattr__(self, "coefficient", Scalar(self.coefficient, "coefficient"))
        CheckNumber(self.coefficient, "coefficient", least=0)

    def CheckData(self, name=""):
        CheckRange(self.coefficient, f"{name}coefficient", least=0)

    def Bound(self, r, p):
        return self.coefficient * p

    def BoundDerivatives(self, r, p):
        return np.zeros_like(r), self.coefficient * np.ones_like(r)


@dataclass(frozen=True)
class SlipWeakeningFriction(FrictionLaw):
    """p_t = mu(|u_t|) p_n with mu(s) = dynamic + (static - dynamic) exp(-s/distance).

    `static`, `dynamic` >= 0 [1] and `distance` > 0 [length] are numbers or CoefficientFunctions.  Weakening (static > dynamic)
    can make several solutions possible; dynamic > static strengthens.

    >>> law = SlipWeakeningFriction(static=0.5, dynamic=0.3, distance=0.01)
    >>> law.Coefficient(np.array([0.0, 1.0]))[0]
    array([0.5, 0.3])
    """

    static: Any
    dynamic: Any
    distance: Any
    __repr__ = Described

    def __post_init__(self):
        for name in ("static", "dynamic", "distance"):
            if not isinstance(getattr(self, name), np.ndarray):
                object.__setattr__(self, name, Scalar(getattr(self, name), name))
        CheckNumber(self.static, "static", least=0)
        CheckNumber(self.dynamic, "dynamic", least=0)
        CheckNumber(self.distance, "distance", above=0)

    def CheckData(self, name=""):
        CheckRange(self.static, f"{name}static", least=0)
        CheckRange(self.dynamic, f"{name}dynamic", least=0)
        CheckRange(self.distance, f"{name}distance", above=0)

    def Bound(self, r, p):
        return 1.0 * p

    def BoundDerivatives(self, r, p):
        return np.zeros_like(r), np.ones_like(r)

    def Coefficient(self, slip):
        fading = (self.static - self.dynamic) * np.exp(-slip / self.distance)
        return self.dynamic + fading, -fading / self.distance


@dataclass(frozen=True)
class PowerFriction(FrictionLaw):
    """p_t(r) = stiffness * max(r, 0)^exponent, (4.1); `stiffness` >= 0 [stress/length^exponent], `exponent` > 0.

    The limit exponent = 0, a constant bound on all of Gamma_C, is `TrescaFriction`.

    >>> float(PowerFriction(stiffness=2, exponent=2).Bound(np.array(3.0), None))
    18.0
    """

    stiffness: Any
    exponent: float = 1
    __repr__ = Described

    def __post_init__(self):
        NormalCompliance.__post_init__(self)

    def CheckData(self, name=""):
        CheckRange(self.stiffness, f"{name}stiffness", least=0)

    def Bound(self, r, p):
        return self.stiffness * np.maximum(r, 0) ** self.exponent

    def BoundDerivatives(self, r, p):
        return NormalCompliance.PressureDerivative(self, r), np.zeros_like(r)


@dataclass(frozen=True)
class TrescaFriction(FrictionLaw):
    """p_t = bound on all of Gamma_C, whatever the penetration: the reduced law (4.2); `bound` >= 0 [stress].

    >>> TrescaFriction(1).Bound(np.array([-1.0, 2.0]), None)
    array([1., 1.])
    """

    bound: Any
    __repr__ = Described

    def __post_init__(self):
        if not isinstance(self.bound, np.ndarray):
            object.__setattr__(self, "bound", Scalar(self.bound, "bound"))
        CheckNumber(self.bound, "bound", least=0)

    def CheckData(self, name=""):
        CheckRange(self.bound, f"{name}bound", least=0)

    def Bound(self, r, p):
        return np.broadcast_to(np.asarray(self.bound, dtype=float), np.shape(r)).copy()

    def BoundDerivatives(self, r, p):
        return np.zeros_like(r), np.zeros_like(r)


@dataclass(frozen=True)
class Foundation:
    """A deformable foundation under the boundary region `boundary` (a regular expression, as in NGSolve).

    `compliance` is a ComplianceLaw; `friction` a FrictionLaw or None for a frictionless foundation; `gap` the initial
    distance g [length] along the outward normal, number or scalar CoefficientFunction.  The theory wants g >= 0
    (2.12); the formulas hold for negative g, a body that starts inside its foundation, and it is accepted.

    Raises ProblemError if a derivative that a law returns is not that of its pressure, bound or slip factor, if one of these
    is negative, or if the pressure is not zero without penetration (2.13).

    >>> Foundation("bottom", NormalCompliance(450), friction=TrescaFriction(1), gap=0.05).gap
    0.05
    """

    boundary: str
    compliance: ComplianceLaw
    friction: FrictionLaw | None = None
    gap: Any = 0.0
    __repr__ = Described

    def __post_init__(self):
        RegionName(self.boundary, "foundation")
        if not _Has(self.compliance, "Pressure", "PressureDerivative"):
            raise ProblemError(f"compliance is {self.compliance!r}; give a law such as NormalCompliance(stiffness=450), an "
                               "object with Pressure(r) and PressureDerivative(r)")
        if self.friction is not None and not _Has(self.friction, "Bound"):
            raise ProblemError(f"friction is {self.friction!r}; give a law such as CoulombFriction(0.3), an object with "
                               "Bound(r, p), or None")
        object.__setattr__(self, "gap", Scalar(self.gap, "gap"))
        if not Pointwise(self.compliance):
            CheckCompliance(self.compliance, 1, f"the foundation of {self.boundary!r}")
        if self.friction is not None and not Pointwise(self.friction):
            CheckFriction(self.friction, np.ones(1), np.ones(1), f"the foundation of {self.boundary!r}")

    def Check(self, *, depth=1.0, slip=1.0):
        """The `LawReport` of both laws for penetrations up to `depth` and slips up to `slip` [length]; see `CheckLaws`."""
        return CheckLaws(self.compliance, self.friction, depth=depth, slip=slip)


def _Has(law, *methods):
    """True if the law has these methods of its own, not those of the base classes that only say what is missing."""
    own = [getattr(type(law), method, None) for method in methods]
    return all(callable(method) and method not in (ComplianceLaw.Pressure, ComplianceLaw.PressureDerivative, FrictionLaw.Bound)
               for method in own)
