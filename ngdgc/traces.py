"""Exact solutions made from their traces on Gamma_C: any law, any zones, a user's own ones too.

On Gamma_C = {h = 0} of (0,1)^dim, h the height, prescribe functions of x: w = u_n, s = u_t along x, the pressure p and the
shear tau, the friction on the foundation.  Then sigma n is the one the law asks for with

    u_x = s + h (tau/mu + w'),      u_h = -w + h (-p - lam s')/(lam + 2 mu),      f = -div sigma(u),

and u is an exact solution with Dirichlet values on the other sides, if the traces obey the law (2.7)-(2.9).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import CF, IfPos, x, y, z

from .contact.graph import SEPARATION, SLIP, STICK
from .contracts import Array, Datum
from .data.coefficients import Scalar, ValuesAt
from .data.derivatives import Derivative
from .exact import WALLS, BodyForce, CheckDimension, Exact, Recipe
from .exceptions import ProblemError
from .meshes import RectangleMesh
from .problem.foundation import Foundation
from .problem.hypotheses import SlipFactor
from .problem.laws import CoulombFriction, LawAt, NormalCompliance
from .problem.materials import HookeMaterial
from .problem.problem import ContactProblem
from .tools.calls import ByKeyword
from .tools.values import Finite, Integer, Vectors, PositiveNumber

SAMPLES = 2001      # points of (0,1) at which traces are held against the law
ROUNDOFF = 1e-9     # of values that a user's formula and a user's law compute in two ways


@ByKeyword
def FromTraces(foundation: Foundation, *, un: Datum, ut: Datum = 0.0, pressure: Datum, shear: Datum = 0.0,
               material: HookeMaterial | None = None, dim: int = 2) -> Exact:
    """The `Exact` problem on (0,1)^dim with these traces on Gamma_C, in 3D constant along y.

    foundation : Foundation("bottom", ...), with any laws and a gap that are functions of x
    un, ut : w = u_n, positive downward, and s = u_x on Gamma_C [length]
    pressure : p(x) = p_n(w - g) [stress];  shear : tau(x) = -sigma_t along x, tau = p_t s/|s| where s != 0 [stress]
    material : HookeMaterial, by default E = 2500, nu = 0.2

    Traces are numbers or CoefficientFunctions of x alone; (x - a)_+^3 is `Positive(x - a, 3)`.  A law's methods act on arrays,
    so p and tau are given as formulas too, and compared with the law.  So that sigma is continuous and f no measure, un and ut
    need continuous second derivatives, p and tau continuous first ones; where higher ones jump so does f, and a mesh with
    vertices there integrates it piecewise.

    Raises ProblemError, with the point x, if the traces do not obey the law, or are not that smooth.

    >>> from ngdgc import *
    >>> law = Foundation("bottom", NormalCompliance(stiffness=10, exponent=2), friction=CoulombFriction(0.5))
    >>> exact = FromTraces(law, un=0.1 * (1 + x), ut=0.2, pressure=0.1 * (1 + x)**2, shear=0.05 * (1 + x)**2)
    >>> exact.zones(np.array([[0.5, 0.0]]))      # 2 is slip
    array([2])
    """
    CheckDimension(dim)
    material = Recipe(material, E=2500, nu=0.2)
    if not isinstance(foundation, Foundation) or foundation.boundary != "bottom":
        raise ProblemError(f"foundation is {foundation!r}; give a Foundation of the region 'bottom'")
    traces = _Traces(un=un, ut=ut, pressure=pressure, shear=shear)
    traces.CheckSmooth()
    traces.CheckLaw(foundation)
    u = traces.Displacement(material, dim)
    problem = ContactProblem(material, foundation, dirichlet={f"{WALLS[dim]}|top": u}, bodyforce=BodyForce(material, u))
    return Exact(problem, u, lambda points: traces.Zones(foundation, points[:, 0]))


@ByKeyword
def ThreeZones(*, stiffness: float = 250.0, coefficient: float = 0.4, ends: tuple[float, float] = (0.25, 0.75),
               un: float = 0.02, ut: float = 0.02, reserve: float = 10.0, gap: Datum = 0.0,
               material: HookeMaterial | None = None, dim: int = 2) -> Exact:
    """B3: stick for x < a, slip for a < x < b, open for x > b, with a, b = `ends` and u a piecewise polynomial of degree 4.

        w = g + un (b - x)^3,    p = k (w - g)_+,    s = ut (x - a)_+^3,    tau = mu_c p - reserve (a - x)_+^2

    with k = `stiffness` and Coulomb's mu_c = `coefficient`; `un`, `ut` > 0 [length^-2], `reserve` [stress/length^2].
    On a mesh with vertices at a and b every consistent method of order 4 returns u to round-off; on others the ends are exact.

    Raises ProblemError unless 0 < a < b < 1 and 0 < reserve (a - x)^2 < 2 mu_c p in the stick zone.

    >>> ThreeZones().zones(np.array([[0.1, 0], [0.5, 0], [0.9, 0]]))     # stick, slip, separation
    array([1, 2, 0])
    """
    a, b = Vectors(ends, (2,), "ends", "choose 0 < a < b < 1").tolist()
    stiffness, coefficient, un, ut, reserve = (Finite(value, name) for name, value in (
        ("stiffness", stiffness), ("coefficient", coefficient), ("un", un), ("ut", ut), ("reserve", reserve)))
    gap = Scalar(gap, "gap")
    if not 0 < a < b < 1:
        raise ProblemError(f"ends is {ends!r}; choose 0 < a < b < 1")
    foundation = Foundation("bottom", NormalCompliance(stiffness), friction=CoulombFriction(coefficient), gap=gap)
    pressure = stiffness * un * Positive(b - x, 3)
    return FromTraces(foundation, un=gap + un * (b - x) ** 3, ut=ut * Positive(x - a, 3), pressure=pressure,
                      shear=coefficient * pressure - reserve * Positive(a - x, 2), material=material, dim=dim)


@ByKeyword
def RigidLimit(*, stiffness: float, load: float = 5.0, opening: float = 0.02, coefficient: float = 0.4,
               ends: tuple[float, float] = (0.25, 0.75), ut: float = 0.02, reserve: float = 10.0) -> Exact:
    """B8: the unilateral problem with Coulomb friction, approached by p_n = k r, k = `stiffness`, as k grows.

    The displacement and zones are those of k = infinity: stick for x < a, slip for a < x < b, lifted off for x > b, with

        w = -opening (x - b)_+^3,    p = load (b - x)_+^3,    s = ut (x - a)_+^3,    tau = mu_c p - reserve (a - x)_+^2,

    a piecewise polynomial of degree 4.  Loads and Dirichlet values belong to it; the displacement u_k of the problem that comes
    with it differs from it by O(1/k).

    Raises ProblemError as `ThreeZones` does, and for a stiffness that is not positive.

    >>> RigidLimit(stiffness=1e6).zones(np.array([[0.1, 0], [0.5, 0], [0.9, 0]]))     # stick, slip, separation
    array([1, 2, 0])
    """
    stiffness, load, opening = (PositiveNumber(value, name, "it must be positive") for name, value in (
        ("stiffness", stiffness), ("load", load), ("opening", opening)))
    soft = ThreeZones(stiffness=stiffness, coefficient=coefficient, ends=ends, un=load / stiffness, ut=ut, reserve=reserve)
    (foundation,), material, (a, b) = soft.problem.foundation, soft.problem.material, map(float, ends)
    pressure = load * Positive(b - x, 3)
    u = _Traces(un=-opening * Positive(x - b, 3), ut=ut * Positive(x - a, 3), pressure=pressure,
                shear=coefficient * pressure - reserve * Positive(a - x, 2)).Displacement(material, 2)
    problem = ContactProblem(material, foundation, dirichlet={f"{WALLS[2]}|top": u}, bodyforce=BodyForce(material, u))
    return Exact(problem, u, soft.zones)


@ByKeyword
def Positive(distance: Any, power: int) -> Any:
    """(distance)_+^power, an integer power of the positive part that NGSolve differentiates piece by piece.

    >>> from ngsolve import x
    >>> from ngdgc.meshes import RectangleMesh
    >>> mesh = RectangleMesh(1)
    >>> [Positive(x - 0.5, 2)(mesh(point, 0.1)) for point in (0.3, 1.0)]
    [0.0, 0.25]
    """
    distance, power = CF(Scalar(distance, "distance")), Integer(power, "power", "give an integer of at least 0", least=0)
    return IfPos(distance, distance ** power, 0)


class _Traces:
    """un, ut, pressure and shear as CoefficientFunctions of x."""

    def __init__(self, **traces: Datum) -> None:
        self.traces = {name: CF(Scalar(value, name)) for name, value in traces.items()}
        self.mesh = RectangleMesh(1)    # to evaluate them on its side y = 0; points of a mesh do not keep it alive

    def _Points(self, at: Array) -> Any:
        return self.mesh(at, np.zeros_like(at))

    def Displacement(self, material: HookeMaterial, dim: int) -> Any:
        w, s, p, tau = self.traces.values()
        height = y if dim == 2 else z
        along = s + height * (tau / material.mu + Derivative(w, 0, "un"))
        across = -w + height * (-p - material.lam * Derivative(s, 0, "ut")) / (material.lam + 2 * material.mu)
        return CF((along, across)) if dim == 2 else CF((along, 0, across))

    def CheckSmooth(self) -> None:
        """Raise ProblemError where a derivative that must be continuous jumps.

        Over an interval of length H a continuous piecewise smooth function f changes by H times the mean of f' at its ends, up
        to H max |f'|; a jump of f is what is left beyond that.
        """
        at = np.linspace(0, 1, SAMPLES)
        points, interval = self._Points(at), at[1]
        for name, trace in self.traces.items():
            for order in range(3 if name in ("un", "ut") else 2):
                slope = Derivative(trace, 0, name)
                f, df = (ValuesAt(value, points, name) for value in (trace, slope))
                jump = np.abs(np.diff(f) - interval * (df[1:] + df[:-1]) / 2)
                worst = jump.argmax()
                if jump[worst] > 5 * interval * np.abs(df).max() + ROUNDOFF * np.abs(f).max():
                    word = ("", "the first derivative of ", "the second derivative of ")[order]
                    raise ProblemError(f"{word}{name} jumps near x = {at[worst]:.4g}; then sigma is discontinuous and the "
                                       "body force no function; give a smoother one, such as Positive(x - a, 3)")
                trace = slope

    def At(self, foundation: Foundation, at: Array) -> tuple[Array, ...]:
        """r, p, s, tau at abscissas (n,) and there p_n(r), p_t: arrays (n,)."""
        points = self._Points(at)
        w, s, p, tau = (ValuesAt(value, points, name) for name, value in self.traces.items())
        r = w - ValuesAt(foundation.gap, points, "gap")
        expected, bound = LawAt(foundation.compliance, points).Pressure(r), np.zeros_like(r)
        if foundation.friction is not None:
            friction = LawAt(foundation.friction, points)
            bound = friction.Bound(r, p) * SlipFactor(friction, np.abs(s))[0]
        return r, p, s, tau, expected, bound

    def CheckLaw(self, foundation: Foundation) -> None:
        """Raise ProblemError at the first point where a trace violates (2.7)-(2.9)."""
        at = (np.arange(SAMPLES) + 0.5) / SAMPLES
        _, p, s, tau, expected, bound = self.At(foundation, at)
        tolerance = ROUNDOFF * max(np.abs(values).max() for values in (p, tau, expected, bound))
        moving = np.abs(s) > ROUNDOFF * np.abs(s).max()
        for wrong, words in ((np.abs(p - expected) > tolerance, "the pressure is {p:g} and p_n(un - gap) is {expected:g}"),
                             (np.abs(tau) > bound + tolerance, "the shear is {tau:g}, more than the friction bound {bound:g}"),
                             (moving & (np.abs(tau - bound * np.sign(s)) > tolerance),
                              "ut is {s:g}, not 0, so the shear must be the bound {bound:g} in its direction and is {tau:g}")):
            if np.any(wrong):
                i = wrong.argmax()
                found = words.format(p=p[i], s=s[i], tau=tau[i], expected=expected[i], bound=bound[i])
                raise ProblemError(f"the traces violate the law at x = {at[i]:.4g}: {found}; mend the traces or the law")

    def Zones(self, foundation: Foundation, at: Array) -> Any:
        _, p, s, tau, _, bound = self.At(foundation, at)
        return np.where(p <= 0, SEPARATION, np.where((s != 0) | (np.abs(tau) >= bound), SLIP, STICK))
