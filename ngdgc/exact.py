"""Problems with known solutions, to test any method, order and mesh against; more, also for laws of your own, in `traces`.

Each function returns an `Exact`: a ContactProblem on a rectangle or a box with contact on "bottom", its displacement and zones.
Rectangles come from `meshes.RectangleMesh`, whose sides are "bottom", "right", "top", "left"; boxes from `meshes.BoxMesh`, with
"bottom", "top" (z = 0, 1), "back", "front" (x = 0, 1) and "left", "right" (y = 0, 1).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from ngsolve import CF, Sym, exp, specialcf, x, y, z

from .contact.graph import SEPARATION, SLIP, STICK
from .contracts import Array
from .data.derivatives import Derivative
from .exceptions import ProblemError
from .problem.foundation import Foundation
from .problem.laws import CoulombFriction, FrictionLaw, NormalCompliance, TrescaFriction
from .problem.materials import HookeMaterial
from .problem.problem import ContactProblem
from .tools.calls import ByKeyword
from .tools.values import Among, Finite, PositiveNumber

WALLS = {2: "left|right", 3: "back|left|front|right"}      # all but bottom and top
OBLIQUE = 0.6, 0.8      # direction of the tangential displacement on Gamma_C in 3D: no axis, no diagonal of a mesh


@ByKeyword
@dataclass(frozen=True)
class Exact:
    """A problem, its exact displacement (CoefficientFunction, d components) [length], and its zones.

    `zones` maps points of Gamma_C (n, d) to SEPARATION, STICK or SLIP of `ngdgc.contact.graph`, (n,), to be compared with
    `ContactSolution.zones`.

    >>> exact = SmoothSlip()
    >>> isinstance(exact, Exact), exact.problem.dim
    (True, 2)
    """

    problem: ContactProblem
    displacement: Any
    zones: Callable[[Array], Any]


def _Everywhere(zone: int) -> Callable[[Array], Any]:
    """The zones of a Gamma_C that is of one kind."""
    return lambda points: np.full(len(points), zone)


@ByKeyword
def ExactStrain(u: Any) -> Any:
    """eps(u) of a CoefficientFunction with d = 2 or 3 components, by symbolic differentiation, shape (d, d), no unit.

    GridFunctions in u are differentiated in each element.  Raises ProblemError for what has no symbolic derivative.

    >>> from ngsolve import y
    >>> from ngdgc.meshes import RectangleMesh
    >>> mesh = RectangleMesh(1)
    >>> ExactStrain(CF((y, 0)))(mesh(0.3, 0.4))
    (0.0, 0.5, 0.5, 0.0)
    """
    d = u.dim
    slopes = [Derivative(u, j, "the displacement") for j in range(d)]
    return Sym(CF(tuple(slopes[j][i] for i in range(d) for j in range(d)), dims=(d, d)))


@ByKeyword
def BodyForce(material: Any, u: Any) -> Any:
    """f_1 = -div C eps(u) [stress/length], for constant or varying C; ProblemError if u or C has no symbolic derivative.

    >>> from ngsolve import x
    >>> from ngdgc.meshes import RectangleMesh
    >>> mesh = RectangleMesh(1)
    >>> BodyForce(HookeMaterial(mu=1, lam=0), CF((x**2, 0)))(mesh(0.3, 0.4))[0]
    -4.0
    """
    stress = material.Stress(ExactStrain(u))
    return CF(tuple(-sum(Derivative(stress[i, j], j, "the stress") for j in range(u.dim)) for i in range(u.dim)))


@ByKeyword
def Traction(material: Any, u: Any) -> Any:
    """sigma(u) n on the boundary [stress].

    >>> from ngsolve import Integrate, x
    >>> from ngdgc.meshes import RectangleMesh
    >>> mesh = RectangleMesh(1)
    >>> pulled = Traction(HookeMaterial(mu=1, lam=0), CF((x, 0)))
    >>> round(Integrate(pulled[0], mesh, definedon=mesh.Boundaries("right")), 12)
    2.0
    """
    return material.Stress(ExactStrain(u)) * specialcf.normal(u.dim)


def _Plane(ut: Any, un: Any, dim: int) -> Any:
    """The vector with components ut along the contact plane, in 3D in the direction OBLIQUE, and un across it."""
    return CF((ut, un)) if dim == 2 else CF((OBLIQUE[0] * ut, OBLIQUE[1] * ut, un))


@ByKeyword
def CheckDimension(dim: int) -> None:
    """Raise ProblemError unless dim is 2 or 3.

    >>> CheckDimension(4)
    Traceback (most recent call last):
    ...
    ngdgc.exceptions.ProblemError: dim is 4; choose 2 or 3
    """
    if not Among(dim, (2, 3)):
        raise ProblemError(f"dim is {dim!r}; choose 2 or 3")


@ByKeyword
def AffinePatch(zone: str, *, material: HookeMaterial | None = None, stiffness: float = 100.0, exponent: float = 1,
                bound: float = 3.0, gap: float = 0.1, coulomb: float | None = None, sides: str = "dirichlet",
                dim: int = 2) -> Exact:
    """B0: u_t = (c + s h) e, u_h = -w - e h on (0,1)^dim, h the height; every consistent method returns it to round-off.

    On h = 0: u_n = w, sigma_n = -(lam + 2 mu) e, sigma_t = -mu s along the tangent, x in 2D and OBLIQUE in 3D, and
    e = p_n(w - g)/(lam + 2 mu).  "slip" has c > 0 and s = p_t/mu, "stick" c = 0 and |mu s| = p_t/2, "open" w < g and e = s = 0.

    `sides`: "dirichlet", u given on the other sides; "traction", on the top only, with sigma n on the walls; "roller", u_n and
    the tangential part of sigma n on the walls.  With `coulomb` the friction is p_t = coulomb p_n instead of Tresca's `bound`.

    Raises ProblemError for an unknown zone, `sides` or dimension.

    >>> AffinePatch("stick").zones(np.zeros((1, 2)))
    array([1])
    """
    CheckDimension(dim)
    material, gap = Recipe(material, mu=1000.0, lam=1500.0), Finite(gap, "gap")
    law: Any = NormalCompliance(stiffness, exponent)
    friction: Any = TrescaFriction(bound) if coulomb is None else CoulombFriction(coulomb)
    for name, value in (("stiffness", stiffness), ("bound", bound), ("coulomb", 0 if coulomb is None else coulomb)):
        Finite(value, name)     # a function would do for a law, and not here
    if not Among(zone, ("slip", "stick", "open")):
        raise ProblemError(f"zone is {zone!r}; choose 'slip', 'stick' or 'open'")
    w = gap + (0.2 if zone != "open" else -0.05)
    pressure = float(law.Pressure(w - gap))
    limit = float(friction.Bound(0.0, pressure))
    e = pressure / (material.lam + 2 * material.mu)
    # Open with a constant bound: no pressure, but Tresca's friction acts wherever u_t is not zero, so c = 0 there.
    c, s = {"slip": (0.1, limit / material.mu), "stick": (0.0, limit / (2 * material.mu)), "open": (0.0, 0.0)}[zone]
    height = y if dim == 2 else z
    u = _Plane(c + s * height, -w - e * height, dim)
    foundation = Foundation("bottom", law, friction=friction, gap=gap)
    zones = {"slip": SLIP, "stick": STICK, "open": SEPARATION}
    return Exact(ContactProblem(material, foundation, **_Supports(material, u, sides)), u, _Everywhere(zones[zone]))


@ByKeyword
def Recipe(material: Any, **default: Any) -> HookeMaterial:
    """The material, or the default for None; ProblemError for another kind than a HookeMaterial.

    >>> Recipe(None, mu=1, lam=2).lam
    2.0
    """
    if not isinstance(material, (HookeMaterial, type(None))):
        raise ProblemError(f"material is {material!r}; give a HookeMaterial, whose mu and lam the recipe needs")
    return HookeMaterial(**default) if material is None else material


def _Supports(material: HookeMaterial, u: Any, sides: str) -> dict[str, Any]:
    stress, n, walls = Traction(material, u), specialcf.normal(u.dim), WALLS[u.dim]
    if not Among(sides, ("dirichlet", "traction", "roller")):
        raise ProblemError(f"sides is {sides!r}; choose 'dirichlet', 'traction' or 'roller'")
    if sides == "dirichlet":
        return {"dirichlet": {f"{walls}|top": u}}
    if sides == "traction":
        return {"dirichlet": {"top": u}, "traction": {walls: stress}}
    return {"dirichlet": {"top": u}, "roller": {walls: u * n}, "traction": {walls: stress - (stress * n) * n}}


@ByKeyword
def WinklerColumn(*, stiffness: float = 100.0, exponent: float = 1, material: HookeMaterial | None = None, gap: float = 0.1,
                  pressure: float = 20.0, height: float = 1.0, load: str = "displacement") -> Exact:
    """B1: a column of height H between rollers, pressed down at its top; u_y is linear.

    With P = `pressure` on Gamma_C, u_n = g + (P/k)^(1/m) there and the top moves by d = u_n + P H/(lam + 2 mu).  The `load` on
    the top is "displacement", u_y = -d, for which at m = 1 the contraction number of the explicit iteration is
    k H/(lam + 2 mu), or "pressure", P, when the foundation alone holds the column and A is singular.

    Raises ProblemError for an unknown load.

    >>> from ngdgc.meshes import RectangleMesh
    >>> mesh = RectangleMesh(1)
    >>> round(WinklerColumn(stiffness=100, pressure=20, gap=0.1).displacement(mesh(0, 0))[1], 12)
    -0.3
    """
    if not Among(load, ("displacement", "pressure")):
        raise ProblemError(f"load is {load!r}; choose 'displacement' or 'pressure'")
    material, gap = Recipe(material, mu=1000.0, lam=1500.0), Finite(gap, "gap")
    stiffness, exponent, pressure, height = (PositiveNumber(value, name, "it must be a positive number") for name, value in (
        ("stiffness", stiffness), ("exponent", exponent), ("pressure", pressure), ("height", height)))
    depth = gap + float(np.float64(pressure / stiffness) ** (1 / exponent))
    rate = pressure / (material.lam + 2 * material.mu)
    top: dict[str, Any] = ({"dirichlet": {"top": CF((0, -depth - rate * height))}} if load == "displacement"
           else {"traction": {"top": CF((0, -pressure))}})
    problem = ContactProblem(material, Foundation("bottom", NormalCompliance(stiffness, exponent), gap=gap),
                             roller={"left|right": 0}, **top)
    return Exact(problem, CF((0, -depth - rate * y)), _Everywhere(SLIP))


@ByKeyword
def SmoothSlip(*, lam: float = 1.0, mu: float = 2.0, stiffness: float = 1.0, exponent: float = 1, dim: int = 2) -> Exact:
    """B2: smooth solution that slips everywhere, after Chouly, Ern, Pignet, SIAM J. Sci. Comput. 42 (2020).

    u = (s e^(sh) (1 + c), h e^(sh) (c - 1))/6 on (0,1)^dim with c = 1/(1 + lam), s the coordinate along the contact plane and h
    the height: s = x in 2D, and in 3D the plane field of the direction OBLIQUE, s = 0.6 x + 0.8 y, so that no component and no
    derivative of u vanishes.  On h = 0 u_n = 0, the pressure is the constant p* = lam (mu - 1)/(3 (1 + lam)), and friction of
    |sigma_t| = mu s^2 (lam + 2)/(6 (1 + lam)) opposes u_t; so g = -(p*/k)^(1/m) and Coulomb's coefficient is |sigma_t|/p*.

    Raises ProblemError for mu <= 1 or lam <= 0, which would need a foundation that pulls, and for an unknown dimension.

    >>> SmoothSlip(dim=3).problem.dim
    3
    """
    CheckDimension(dim)
    mu, lam = Finite(mu, "mu"), Finite(lam, "lam")
    stiffness, exponent = (PositiveNumber(value, name, "it must be a positive number") for name, value in (
        ("stiffness", stiffness), ("exponent", exponent)))
    if not (mu > 1 and lam > 0):
        raise ProblemError(f"mu is {mu:g} and lam is {lam:g}; take mu > 1 and lam > 0, else the foundation would pull")
    material = HookeMaterial(mu=mu, lam=lam)
    s, height = (x, y) if dim == 2 else (OBLIQUE[0] * x + OBLIQUE[1] * y, z)
    c = 1 / (1 + lam)
    u = _Plane(s * exp(s * height) * (1 + c) / 6, height * exp(s * height) * (c - 1) / 6, dim)
    pressure = lam * (mu - 1) / (3 * (1 + lam))
    gap = -float(np.float64(pressure / stiffness) ** (1 / exponent))
    foundation = Foundation("bottom", NormalCompliance(stiffness, exponent), gap=gap,
                            friction=CoulombFriction(mu * s ** 2 * (lam + 2) / (6 * (1 + lam)) / pressure))
    problem = ContactProblem(material, foundation, dirichlet={f"{WALLS[dim]}|top": u}, bodyforce=BodyForce(material, u))
    return Exact(problem, u, _Everywhere(SLIP))


@ByKeyword
def CubicCompliance(*, E: float = 12000.0, nu: float = 0.42, alpha: float = 0.05, friction: FrictionLaw | None = None) -> Exact:
    """B5: u = alpha (2xy + x y^2, -x^2 (1 + y)) on (0,2) x (0,1), after an example of the program conmech.

    u = 0 on x = 0, u_t = 0 and sigma_t = 0 on the contact side, p_n(r) = (lam + 2 mu) r with gap 0: a solution for any
    friction law that has a bound, and exact for orders of at least 3.  The foundation is too stiff for an explicit iteration.

    >>> CubicCompliance().zones(np.zeros((1, 2)))
    array([2])
    """
    material, alpha = HookeMaterial(E=Finite(E, "E"), nu=Finite(nu, "nu")), Finite(alpha, "alpha")
    u = alpha * CF((2 * x * y + x * y ** 2, -x ** 2 * (1 + y)))
    foundation = Foundation("bottom", NormalCompliance(material.lam + 2 * material.mu), friction=friction)
    problem = ContactProblem(material, foundation,
                             dirichlet={"left": CF((0, 0))}, traction={"right|top": Traction(material, u)},
                             bodyforce=BodyForce(material, u))
    # Without friction nothing resists a slip, and every point in contact counts as slipping.
    return Exact(problem, u, _Everywhere(SLIP if friction is None else STICK))
