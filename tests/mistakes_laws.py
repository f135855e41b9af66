"""Mistakes in laws of contact and friction, as in `mistakes`, with laws that are mistaken."""

import numpy as np
from mistakes import SOFT, Disc, Friction, On
from ngsolve import x

from ngdgc import CheckLaws, ComplianceLaw, Foundation, FrictionLaw, NormalCompliance, TrescaFriction
from ngdgc.graph import ContactGraph


class Law(ComplianceLaw):
    """p_n = k r_+ with one method replaced by a mistake."""

    def Pressure(self, r):
        return np.maximum(r, 0)

    def PressureDerivative(self, r):
        return 1.0 * (r > 0)


class Attracting(Law):
    def Pressure(self, r):
        return np.maximum(r, 0) + 1


class Scattered(Law):
    def Pressure(self, r):
        return np.maximum(r, 0)[:, None] * np.ones(2) if np.any(r > 0) else 0 * r


class Pulling(Law):
    def Pressure(self, r):
        return -np.maximum(r, 0)


class Steep(Law):
    def PressureDerivative(self, r):
        return 2.0 * (r > 0)


class Negative(Friction):
    def Bound(self, r, p):
        return -1.0 * p


class Misled(Friction):
    def BoundDerivatives(self, r, p):
        return np.ones_like(r), np.ones_like(r)


class Single(Friction):
    def Coefficient(self, slip):
        return 1.0


class Below(Friction):
    def Coefficient(self, slip):
        return -np.ones_like(slip), np.zeros_like(slip)


class Faded(Friction):
    def Coefficient(self, slip):
        return np.exp(-slip), np.exp(-slip)


class Empty(ComplianceLaw):
    """A law whose methods were forgotten."""


class Unbounded(FrictionLaw):
    """A friction law whose method was forgotten."""


def Overflowing():
    """Penetrations of 1e3 where the law has no more numbers."""
    contact = Disc(foundation=On(compliance=NormalCompliance(1e300, 5))).contact
    return contact.Pressure(np.full(len(contact.weights), 1e3))


def OverflowingGraph():
    contact = Disc(foundation=On(friction=TrescaFriction(1))).contact
    return ContactGraph(contact, np.full(len(contact.weights), 1.0)).At(np.full(contact.normals.shape, np.nan))


LAWS = [
    (lambda _: NormalCompliance(1, exponent=0), "exponent is 0 | a positive number | must be"),
    (lambda _: Foundation("bottom", 450), "compliance is 450 | Pressure(r) and PressureDerivative(r) | give a law such as"),
    (lambda _: On(friction=0.3), "friction is 0.3 | an object with Bound(r, p), or None | give a law such as"),
    (lambda _: Empty().Pressure(np.ones(1)), "Empty has no method Pressure(r) | array (npoints,) | write it"),
    (lambda _: Empty().PressureDerivative(np.ones(1)),
     "Empty has no method PressureDerivative(r) | array (npoints,) | write it"),
    (lambda _: Unbounded().Check(SOFT), "Unbounded has no method Bound(r, p) | array (npoints,) | write it"),
    (lambda _: On(compliance=Attracting()),
     "foundation of 'bottom': the pressure is not zero at penetration -1 | 0 for r <= 0 | must"),
    (lambda _: On(compliance=Scattered()), "the pressure has shape (1, 2) for 1 points | one value per point | give"),
    (lambda _: On(compliance=Pulling()), "the pressure at penetration 1e-06 is negative | >= 0 | it must be"),
    (lambda _: On(compliance=Steep()), "PressureDerivative | differs from the finite difference of Pressure | mend the one"),
    (lambda _: On(friction=Negative()), "the friction bound is negative | p_t >= 0, an array (npoints,) | it must be"),
    (lambda _: On(friction=Misled()), "BoundDerivatives | finite difference of Bound by the penetration | mend one of them"),
    (lambda _: On(friction=Single()), "Coefficient(slip) returns 1.0 | the pair of the factor and its derivative | give"),
    (lambda _: On(friction=Below()), "Coefficient is negative or not finite at slip 0 | >= 0 | it must be"),
    (lambda _: On(friction=Faded()), "the derivative that Coefficient returns | its finite difference at slip | mend the one"),
    (lambda _: CheckLaws(SOFT, depth=0), "depth is 0 | a positive length | give"),
    (lambda _: CheckLaws(NormalCompliance(1 + x)),
     "data that are CoefficientFunctions | only at points of a mesh | take the laws in"),
    (lambda _: Overflowing(), "a contact law returned a value that is not finite | for the penetrations that occur | look at"),
    (lambda _: OverflowingGraph(),
     "a contact law returned a value that is not finite | for the penetrations that occur | look at")]
