"""Problems with known solutions, to test any method, order and mesh against.

Each function returns an `Exact`: a ContactProblem on a rectangle with contact on "bottom", and its displacement.  Rectangles
come from `meshes.RectangleMesh`, whose sides are "bottom", "right", "top", "left".
"""

from dataclasses import dataclass
from typing import Any

from ngsolve import CF, Sym, exp, specialcf, x, y

from .elasticity import HookeMaterial
from .exceptions import ProblemError
from .foundation import CoulombFriction, Foundation, FrictionLaw, NormalCompliance, TrescaFriction
from .problem import ContactProblem

SIDES = "right|top|left"


@dataclass(frozen=True)
class Exact:
    """A problem and its exact displacement (CoefficientFunction, 2 components) [length]."""

    problem: ContactProblem
    displacement: Any


def ExactStrain(u):
    """eps(u) of a CoefficientFunction in x and y, by symbolic differentiation."""
    return Sym(CF((u[0].Diff(x), u[0].Diff(y), u[1].Diff(x), u[1].Diff(y)), dims=(2, 2)))


def BodyForce(material, u):
    """f_1 = -div C eps(u), for constant or varying C."""
    stress = material.Stress(ExactStrain(u))
    return CF(tuple(-stress[i, 0].Diff(x) - stress[i, 1].Diff(y) for i in range(2)))


def Traction(material, u):
    """sigma(u) n on the boundary."""
    return material.Stress(ExactStrain(u)) * specialcf.normal(2)


def AffinePatch(zone, *, material=None, stiffness=100.0, exponent=1, bound=3.0, gap=0.1, coulomb=None, sides="dirichlet"):
    """B0: u_x = c + s y, u_y = -w - e y on (0,1)^2; every consistent method returns it to round-off.

    On y = 0: u_n = w, sigma_n = -(lam + 2 mu) e, sigma_t = -mu s along x, and e = p_n(w - g)/(lam + 2 mu).  "slip" has c > 0
    and s = p_t/mu, "stick" c = 0 and |mu s| = p_t/2, "open" w < g and e = s = 0.

    `sides`: "dirichlet", u given on the other sides; "traction", on the top only, with sigma n on the left and right;
    "roller", u_n and the tangential part of sigma n on the left and right.  With `coulomb` the friction is
    p_t = coulomb p_n instead of Tresca's `bound`.
    """
    material = material or HookeMaterial(mu=1000.0, lam=1500.0)
    law = NormalCompliance(stiffness, exponent)
    friction = TrescaFriction(bound) if coulomb is None else CoulombFriction(coulomb)
    if zone not in ("slip", "stick", "open"):
        raise ProblemError(f"zone is {zone!r}; choose 'slip', 'stick' or 'open'")
    w = gap + (0.2 if zone != "open" else -0.05)
    pressure = float(law.Pressure(w - gap))
    limit = float(friction.Bound(0.0, pressure))
    e = pressure / (material.lam + 2 * material.mu)
    # Open with a constant bound: no pressure, but Tresca's friction acts wherever u_t is not zero, so c = 0 there.
    c, s = {"slip": (0.1, limit / material.mu), "stick": (0.0, limit / (2 * material.mu)), "open": (0.0, 0.0)}[zone]
    u = CF((c + s * y, -w - e * y))
    foundation = Foundation("bottom", law, friction=friction, gap=gap)
    return Exact(ContactProblem(material, foundation, **_Supports(material, u, sides)), u)


def _Supports(material, u, sides):
    stress = Traction(material, u)
    n = specialcf.normal(2)
    if sides == "dirichlet":
        return {"dirichlet": {SIDES: u}}
    if sides == "traction":
        return {"dirichlet": {"top": u}, "traction": {"left|right": stress}}
    if sides == "roller":
        return {"dirichlet": {"top": u}, "roller": {"left|right": u * n},
                "traction": {"left|right": stress - (stress * n) * n}}
    raise ProblemError(f"sides is {sides!r}; choose 'dirichlet', 'traction' or 'roller'")


def WinklerColumn(*, stiffness=100.0, exponent=1, material=None, gap=0.1, pressure=20.0, height=1.0):
    """B1: a column between rollers, its top pressed down by d; u_y is linear.

    With P = `pressure` on Gamma_C, u_n = g + (P/k)^(1/m) there and the top moves by d = u_n + P H/(lam + 2 mu).  For m = 1 the
    contraction number of the explicit iteration is k H/(lam + 2 mu).
    """
    material = material or HookeMaterial(mu=1000.0, lam=1500.0)
    depth = gap + (pressure / stiffness) ** (1 / exponent)
    u = CF((0, -depth - pressure / (material.lam + 2 * material.mu) * y))
    problem = ContactProblem(material, Foundation("bottom", NormalCompliance(stiffness, exponent), gap=gap),
                             dirichlet={"top": CF((0, -depth - pressure / (material.lam + 2 * material.mu) * height))},
                             roller={"left|right": 0})
    return Exact(problem, u)


def SmoothSlip(*, lam=1.0, mu=2.0, stiffness=1.0, exponent=1):
    """B2: smooth solution that slips everywhere, after Chouly, Ern, Pignet, SIAM J. Sci. Comput. 42 (2020).

    u = (x e^(xy) (1 + c), y e^(xy) (c - 1))/6 on (0,1)^2 with c = 1/(1 + lam).  On y = 0 u_n = 0, the pressure is the constant
    p* = lam (mu - 1)/(3 (1 + lam)) and |sigma_t| = mu x^2 (lam + 2)/(6 (1 + lam)); so g = -(p*/k)^(1/m) and Coulomb's
    coefficient is |sigma_t|/p*.
    """
    material = HookeMaterial(mu=mu, lam=lam)
    c = 1 / (1 + lam)
    u = CF((x * exp(x * y) * (1 + c), y * exp(x * y) * (c - 1))) / 6
    pressure = lam * (mu - 1) / (3 * (1 + lam))
    foundation = Foundation("bottom", NormalCompliance(stiffness, exponent), gap=-(pressure / stiffness) ** (1 / exponent),
                            friction=CoulombFriction(mu * x ** 2 * (lam + 2) / (6 * (1 + lam)) / pressure))
    problem = ContactProblem(material, foundation, dirichlet={SIDES: u}, bodyforce=BodyForce(material, u))
    return Exact(problem, u)


def CubicCompliance(*, E=12000.0, nu=0.42, alpha=0.05, friction: FrictionLaw | None = None):
    """B5: u = alpha (2xy + x y^2, -x^2 (1 + y)) on (0,2) x (0,1), after an example of the program conmech.

    u = 0 on x = 0, u_t = 0 and sigma_t = 0 on the contact side, p_n(r) = (lam + 2 mu) r with gap 0: a solution for any
    friction law, and exact for orders of at least 3.  The foundation is too stiff for an explicit iteration.
    """
    material = HookeMaterial(E=E, nu=nu)
    u = alpha * CF((2 * x * y + x * y ** 2, -x ** 2 * (1 + y)))
    foundation = Foundation("bottom", NormalCompliance(material.lam + 2 * material.mu), friction=friction)
    problem = ContactProblem(material, foundation,
                             dirichlet={"left": CF((0, 0))}, traction={"right|top": Traction(material, u)},
                             bodyforce=BodyForce(material, u))
    return Exact(problem, u)
