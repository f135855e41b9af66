"""Laws of what the body presses against: p_n and p_t, (2.7)-(2.9) and (4.1)-(4.2) of Xiao, Wang, Han 2018.

A law is a small frozen object whose methods act on numpy arrays with one entry per quadrature point of Gamma_C.
Data of a law that are CoefficientFunctions are evaluated at those points once, by `LawAt`.  A law of your own is any
object with the methods of `ComplianceLaw` or `FrictionLaw`, best a frozen dataclass.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from ngsolve import CoefficientFunction

from ..contracts import Array, Compliance, Datum
from ..data.coefficients import CheckNumber, CheckRange, Pointwise, Scalar, ValuesAt
from ..exceptions import ProblemError
from ..tools.calls import ByKeyword
from ..tools.formula import Described
from ..tools.values import PositiveNumber
from .hypotheses import CheckLaws, LawReport
from .userlaws import Watched

def LawAt(law: Any, points: Any, name: str = "", region: Any = None) -> Any:
    """The law with every CoefficientFunction among its attributes replaced by its values at mesh points, `Watched`.

    region : mesh.Boundaries(...), for points on it
    """
    if not Pointwise(law):
        return Watched(law)
    law = copy(law)
    for attribute, value in list(vars(law).items()):
        if isinstance(value, CoefficientFunction):
            # Laws are frozen for their users; this is a new one.
            object.__setattr__(law, attribute, ValuesAt(value, points, name + attribute, region))
    if hasattr(law, "CheckData"):
        law.CheckData(name)
    return Watched(law)


@ByKeyword
class ComplianceLaw:
    """Normal compliance -sigma_n = p_n(r), r = u_n - g the penetration [length], p_n >= 0 [stress].

    `Pressure(r)` and `PressureDerivative(r)` map arrays (npoints,) to arrays (npoints,); p_n(r) = 0 for r <= 0.

    >>> class Linear(ComplianceLaw):
    ...     def Pressure(self, r):
    ...         return 3.0 * np.maximum(r, 0)
    ...     def PressureDerivative(self, r):
    ...         return 3.0 * (r > 0)
    >>> Linear().Pressure(np.array([-1, 2]))
    array([0., 6.])
    """

    def __init__(self) -> None:
        """No data: those of a law are its own."""

    def Pressure(self, r: Array) -> Array:
        raise _Missing(self, "Pressure(r)")

    def PressureDerivative(self, r: Array) -> Array:
        raise _Missing(self, "PressureDerivative(r)")

    def Check(self, *, depth: float = 1.0) -> LawReport:
        """The `LawReport` for penetrations up to `depth` [length]: (2.13), Lipschitz constant, monotone or not.

        >>> NormalCompliance(stiffness=3, exponent=0.5).Check().problems
        ('p_n is not Lipschitz',)
        """
        return CheckLaws(self, depth=depth)


@ByKeyword
class FrictionLaw:
    """Friction bound |sigma_t| <= p_t = Bound(r, p) Coefficient(s), r the penetration, p the pressure, s = |u_t| the slip.

    In a history s is the path of the slip so far, the sum of |change of u_t| over the increments in contact.

    `Bound` [stress] maps arrays (npoints,) to an array (npoints,).  Two more methods may be given:
    `BoundDerivatives(r, p)`, the pair of its derivatives by r and p (finite differences otherwise), and `Coefficient(s)`, the
    pair of a factor >= 0 [1] and its derivative [1/length], which is (1, 0) otherwise.

    >>> class Adhesion(FrictionLaw):
    ...     def Bound(self, r, p):
    ...         return 1 + 0.3 * p
    ...     def BoundDerivatives(self, r, p):
    ...         return 0 * r, 0.3 + 0 * p
    >>> Adhesion().Bound(np.array([0.1]), np.array([10.]))
    array([4.])
    """

    def __init__(self) -> None:
        """No data: those of a law are its own."""

    def Bound(self, r: Array, p: Array) -> Array:
        raise _Missing(self, "Bound(r, p)")

    def Check(self, compliance: Compliance, *, depth: float = 1.0, slip: float = 1.0) -> LawReport:
        """The `LawReport` for penetrations up to `depth` and slips up to `slip` [length].

        The bound is a function of the penetration, as (2.13) has it, only with the pressure p_n(r) of a `compliance` law.

        >>> print(CoulombFriction(0.3).Check(NormalCompliance(10)))
        laws for penetrations up to 1 and slips up to 1:
          p_n        Lipschitz, L_n = 10, monotone
          p_t        Lipschitz, L_t = 3
          (2.13)     holds
        """
        return CheckLaws(compliance, self, depth=depth, slip=slip)


class _Ranged:
    """A law whose data have ranges: numbers are checked at once, CoefficientFunctions where `LawAt` has evaluated them."""

    _ranges: ClassVar[dict[str, dict[str, float]]]      # {name: limits of `CheckRange`}

    def __post_init__(self) -> None:
        for name, limits in self._ranges.items():
            object.__setattr__(self, name, Scalar(getattr(self, name), name))
            CheckNumber(getattr(self, name), name, **limits)

    def CheckData(self, name: str = "") -> None:
        for attribute, limits in self._ranges.items():
            CheckRange(getattr(self, attribute), name + attribute, above=limits.get("above"), least=limits.get("least"))


@ByKeyword
@dataclass(frozen=True)
class NormalCompliance(_Ranged, ComplianceLaw):
    """p_n(r) = stiffness * max(r, 0)^exponent, (4.1).

    `stiffness` [stress/length^exponent] >= 0, number or scalar CoefficientFunction; `exponent` > 0.

    >>> float(NormalCompliance(stiffness=450, exponent=1).Pressure(np.array(0.5)))
    225.0
    """

    stiffness: Any
    exponent: float = 1
    _ranges = {"stiffness": {"least": 0}}
    __repr__ = Described

    if TYPE_CHECKING:       # what is given; what is kept is a number, a CoefficientFunction or an array
        def __init__(self, stiffness: Datum, exponent: float = 1) -> None: ...

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "exponent", PositiveNumber(self.exponent, "exponent", "it must be a positive number"))

    def Pressure(self, r: Array) -> Array:
        return self.stiffness * np.maximum(r, 0) ** self.exponent

    def PressureDerivative(self, r: Array) -> Array:
        inside = r > 0
        return self.stiffness * self.exponent * np.where(inside, np.where(inside, r, 1) ** (self.exponent - 1), 0)


@ByKeyword
@dataclass(frozen=True)
class CoulombFriction(_Ranged, FrictionLaw):
    """p_t = coefficient * p_n, Coulomb's dry friction; `coefficient` >= 0 [1], number or CoefficientFunction.

    >>> float(CoulombFriction(0.5).Bound(None, np.array(8.0)))
    4.0
    """

    coefficient: Any
    _ranges = {"coefficient": {"least": 0}}
    __repr__ = Described

    if TYPE_CHECKING:
        def __init__(self, coefficient: Datum) -> None: ...

    def Bound(self, r: Array, p: Array) -> Array:
        return self.coefficient * p

    def BoundDerivatives(self, r: Array, p: Array) -> tuple[Array, Array]:
        return np.zeros_like(r), self.coefficient * np.ones_like(r)


@ByKeyword
@dataclass(frozen=True)
class SlipWeakeningFriction(_Ranged, FrictionLaw):
    """p_t = mu(s) p_n with mu(s) = dynamic + (static - dynamic) exp(-s/distance), s = |u_t|, in a history the path of the slip.

    `static`, `dynamic` >= 0 [1] and `distance` > 0 [length] are numbers or CoefficientFunctions.  Weakening (static > dynamic)
    can make several solutions possible; dynamic > static strengthens.

    >>> law = SlipWeakeningFriction(static=0.5, dynamic=0.3, distance=0.01)
    >>> law.Coefficient(np.array([0.0, 1.0]))[0]
    array([0.5, 0.3])
    """

    static: Any
    dynamic: Any
    distance: Any
    _ranges = {"static": {"least": 0}, "dynamic": {"least": 0}, "distance": {"above": 0}}
    __repr__ = Described

    if TYPE_CHECKING:
        def __init__(self, static: Datum, dynamic: Datum, distance: Datum) -> None: ...

    def Bound(self, r: Array, p: Array) -> Array:
        return 1.0 * p

    def BoundDerivatives(self, r: Array, p: Array) -> tuple[Array, Array]:
        return np.zeros_like(r), np.ones_like(r)

    def Coefficient(self, slip: Array) -> tuple[Array, Array]:
        fading = (self.static - self.dynamic) * np.exp(-slip / self.distance)
        return self.dynamic + fading, -fading / self.distance


@ByKeyword
@dataclass(frozen=True)
class PowerFriction(_Ranged, FrictionLaw):
    """p_t(r) = stiffness * max(r, 0)^exponent, (4.1); `stiffness` >= 0 [stress/length^exponent], `exponent` > 0.

    The limit exponent = 0, a constant bound on all of Gamma_C, is `TrescaFriction`.

    >>> float(PowerFriction(stiffness=2, exponent=2).Bound(np.array(3.0), None))
    18.0
    """

    stiffness: Any
    exponent: float = 1
    _ranges = {"stiffness": {"least": 0}}
    __repr__ = Described

    if TYPE_CHECKING:       # what is given; what is kept is a number, a CoefficientFunction or an array
        def __init__(self, stiffness: Datum, exponent: float = 1) -> None: ...

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "exponent", PositiveNumber(self.exponent, "exponent", "it must be a positive number"))

    def Bound(self, r: Array, p: Array) -> Array:
        return self.stiffness * np.maximum(r, 0) ** self.exponent

    def BoundDerivatives(self, r: Array, p: Array) -> tuple[Array, Array]:
        return NormalCompliance.PressureDerivative(self, r), np.zeros_like(r)    # type: ignore[arg-type]


@ByKeyword
@dataclass(frozen=True)
class TrescaFriction(_Ranged, FrictionLaw):
    """p_t = bound on all of Gamma_C, whatever the penetration: the reduced law (4.2); `bound` >= 0 [stress].

    >>> TrescaFriction(1).Bound(np.array([-1.0, 2.0]), None)
    array([1., 1.])
    """

    bound: Any
    _ranges = {"bound": {"least": 0}}
    __repr__ = Described

    if TYPE_CHECKING:
        def __init__(self, bound: Datum) -> None: ...

    def Bound(self, r: Array, p: Array) -> Array:
        return np.broadcast_to(np.asarray(self.bound, dtype=float), np.shape(r)).copy()

    def BoundDerivatives(self, r: Array, p: Array) -> tuple[Array, Array]:
        return np.zeros_like(r), np.zeros_like(r)


@ByKeyword
@dataclass(frozen=True)
class ArchardWear(_Ranged):
    """w = coefficient * int p |du_t|, what is worn off the body along its normal [length]; see wear= of `Foundation`.

    `coefficient` >= 0 [1/stress], volume worn off over force and path, number or CoefficientFunction.

    >>> ArchardWear(1e-4).Depth(np.array([50.0]), np.array([0.2]))
    array([0.001])
    """

    coefficient: Any
    _ranges = {"coefficient": {"least": 0}}
    __repr__ = Described

    if TYPE_CHECKING:
        def __init__(self, coefficient: Datum) -> None: ...

    def Depth(self, p: Array, slip: Array) -> Array:
        return self.coefficient * p * slip


def _Missing(law: Any, method: str) -> ProblemError:
    return ProblemError(f"{type(law).__name__} has no method {method}; write it, arrays (npoints,) -> array (npoints,)")
