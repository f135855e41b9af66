"""Mistakes in laws of contact and friction, as in `mistakes`, with laws that are mistaken."""

import numpy as np
from mistakes import SOFT, Disc, Friction, On
from ngsolve import x

from ngdgc import CheckLaws, ComplianceLaw, Foundation, FrictionLaw, NormalCompliance, Solve, TrescaFriction
from ngdgc.contact.graph import ContactGraph


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


class Narrow(Law):
    def Pressure(self, r):
        return np.maximum(r, 0).astype(np.float32)


class Averaged(Law):
    def Pressure(self, r):
        return np.maximum(r, 0).mean()


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


class Ones(Law):
    """What is given, at all penetrations."""

    def __init__(self, one):
        self.one = one

    def Pressure(self, r):
        return np.full(r.shape, self.one) if isinstance(self.one, str) else np.where(r > 0, 1, 0) * self.one


class Short(Law):
    """A law without values above 1e-6."""

    def Pressure(self, r):
        return np.where(r > 1e-6, np.nan, np.maximum(r, 0))


class Growing:
    """A wear law that adds to the body."""

    def Depth(self, p, slip):
        return -p * slip


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
    (lambda _: On(wear=1e-6), "wear is 1e-06 | an object with Depth(p, slip), or None | give a law such as"),
    (lambda _: On(wear=Growing()), "Growing on the foundation of 'bottom': the depth that wears off | >= 0 | it must be"),
    (lambda _: Empty().Pressure(np.ones(1)), "Empty has no method Pressure(r) | array (npoints,) | write it"),
    (lambda _: Empty().PressureDerivative(np.ones(1)),
     "Empty has no method PressureDerivative(r) | array (npoints,) | write it"),
    (lambda _: Unbounded().Check(SOFT), "Unbounded has no method Bound(r, p) | array (npoints,) | write it"),
    (lambda _: On(compliance=Attracting()),
     "foundation of 'bottom': the pressure is not zero at penetration -1 | 0 for r <= 0 | must"),
    (lambda _: On(compliance=Scattered()),
     "Scattered.Pressure returns shape (1, 2) for arguments of shape (1,) | one value per point | give"),
    (lambda _: On(compliance=Pulling()), "the pressure at penetration 1e-06 is negative | >= 0 | it must be"),
    (lambda _: On(compliance=Steep()), "PressureDerivative | differs from the finite difference of Pressure | mend the one"),
    (lambda _: On(friction=Negative()), "the friction bound is negative | p_t >= 0 | it must be"),
    (lambda _: On(friction=Misled()), "BoundDerivatives | finite difference of Bound by the penetration | mend one of them"),
    (lambda _: On(friction=Single()), "Single.Coefficient returns a float | the pair of the factor and its derivative | give"),
    (lambda _: On(friction=Below()), "Coefficient is negative or not finite at slip 0 | >= 0 | it must be"),
    (lambda _: On(friction=Faded()), "the derivative that Coefficient returns | its finite difference at slip | mend the one"),
    (lambda _: CheckLaws(SOFT, depth=0), "depth is 0 | a positive length | give"),
    (lambda _: CheckLaws(NormalCompliance(1 + x)),
     "data that are CoefficientFunctions | only at points of a mesh | take the laws in"),
    (lambda _: Overflowing(),
     "NormalCompliance.Pressure is inf at penetration 1000 | not finite, where the iteration needs it | look at its exponent"),
    (lambda _: OverflowingGraph(),
     "displacement and traction of a contact point | are not finite | look for data of extreme size"),
    # What laws of users return.
    (lambda _: On(compliance=Ones(1j)), "Ones.Pressure returns complex values | real ones, an array (npoints,) | give"),
    (lambda _: On(compliance=Ones("a")), "Ones.Pressure returns an array of shape (1,) and type | of numbers | give an array"),
    (lambda _: On(compliance=Narrow()), "Narrow.Pressure returns float32 | too few for an iteration | give float64"),
    (lambda _: On(compliance=Averaged()),
     "Averaged.Pressure gives another value at a point alone | a function of its arguments at the point | use numpy's"),
    (lambda _: On(compliance=Ones({})), "Ones.Pressure raises TypeError (unsupported | called with arrays | mend the law"),
    (lambda _: Solve(Disc(foundation=On(compliance=Short()))),
     "Short.Pressure is not finite beyond penetration 1e-06 | the law ends there | give it values for larger penetrations")]
